#include "surrogates/dynamics/simulate/trajectory_parts.h"

namespace underbody::dynamics {

void add_events(core::Figure& figure, const std::vector<TrajectoryEvent>& events,
                std::initializer_list<const char*> kinds) {
    for (const char* kind : kinds) {
        core::FigurePoints points;
        points.name = kind;
        for (const TrajectoryEvent& event : events) {
            if (event.kind == kind) {
                points.x.push_back(event.time);
                points.y.push_back(1e3 * event.gap);
            }
        }
        if (!points.x.empty()) {
            points.colour = core::palette(figure.points.size() + figure.curves.size());
            figure.points.push_back(std::move(points));
        }
    }
}

void add_thrusts(core::Table& table, const std::vector<std::string>& jets,
                 const std::vector<std::vector<double>>& thrust) {
    for (std::size_t j = 0; j < jets.size(); ++j) {
        std::vector<double> column;
        for (const std::vector<double>& one : thrust) {
            column.push_back(one[j]);
        }
        table.add_numbers(jets[j], "N", column);
    }
}

}  // namespace underbody::dynamics
