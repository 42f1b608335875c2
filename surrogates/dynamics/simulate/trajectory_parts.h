// What tables and figures of every kind of motion have in common.
#pragma once

#include <array>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/table.h"
#include "surrogates/dynamics/plant/heave.h"

namespace underbody::dynamics {

constexpr double start_depth = 1e-9;  ///< m, below the ground: a start that was meant on it

/// Points at the gap (mm) where events of each kind happened; a kind without events gets none.
void add_events(core::Figure& figure, const std::vector<TrajectoryEvent>& events,
                std::initializer_list<const char*> kinds);

/// One column (N) a jet; `thrust` has one row a moment.
void add_thrusts(core::Table& table, const std::vector<std::string>& jets,
                 const std::vector<std::vector<double>>& thrust);

/// One column a component of the states.
template <typename State>
void add_states(core::Table& table, const std::vector<State>& states, std::span<const std::string> names,
                std::span<const char* const> units) {
    for (std::size_t i = 0; i < names.size(); ++i) {
        std::vector<double> column;
        for (const State& state : states) {
            column.push_back(state[i]);
        }
        table.add_numbers(names[i], units[i], column);
    }
}

/// The column "outside_table".
void add_outside(core::Table& table, const std::vector<bool>& outside);

/// The key "end" and one for each column.
void write_table(nlohmann::json& json, const std::string& end, const core::Table& table);
/// The keys "events" (with gap and velocity where the motion has them), "outside_table" and "remarks".
void write_events(nlohmann::json& json, const std::vector<TrajectoryEvent>& events, bool with_state);
void write_remarks(nlohmann::json& json, const std::vector<bool>& outside, const core::Problems& remarks);

/// Says how many rows lie beyond a force table; `range`: its range in words, or "".
void remark_outside(core::Problems& remarks, const std::vector<bool>& outside, const std::string& range = "");

/// Throw core::InputError: a start that is not finite; edges of the base (nose, tail) below the ground.
void refuse_odd_start(std::span<const double> start);
void refuse_start_in_ground(const std::array<double, 2>& gaps);

/// Above zero while the motion goes on: how much the squares of its speeds, accelerations (`speeds`; m/s, m/s^2) and
/// turning rates (`turns`; rad/s, rad/s^2) exceed that of `settle_speed`.
double unsettled(double speeds, double turns, double settle_speed);

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
