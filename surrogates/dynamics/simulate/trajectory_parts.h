// What tables and figures of every kind of motion have in common.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/table.h"
#include "surrogates/dynamics/plant/heave.h"

namespace underbody::dynamics {

/// Points at the gap (mm) where events of each kind happened; a kind without events gets none.
void add_events(core::Figure& figure, const std::vector<TrajectoryEvent>& events,
                std::initializer_list<const char*> kinds);

/// One column (N) a jet; `thrust` has one row a moment.
void add_thrusts(core::Table& table, const std::vector<std::string>& jets,
                 const std::vector<std::vector<double>>& thrust);

/// One component of the states as a curve.
struct ShownState {
    const char* name;
    std::size_t index;
    double scale;  ///< from SI to what the name says
};

/// Curves over time (s), coloured in the order in which they stand in the figure.
template <typename State>
void add_states(core::Figure& figure, const std::vector<double>& time, const std::vector<State>& states,
                std::initializer_list<ShownState> shown) {
    for (const ShownState& one : shown) {
        core::FigureCurve curve{one.name, time, {}, core::palette(figure.curves.size())};
        for (const State& state : states) {
            curve.y.push_back(one.scale * state[one.index]);
        }
        figure.curves.push_back(std::move(curve));
    }
}

}  // namespace underbody::dynamics
