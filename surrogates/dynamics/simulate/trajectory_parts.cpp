#include "surrogates/dynamics/simulate/trajectory_parts.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/text.h"
#include "core/told.h"
#include "surrogates/dynamics/model/simulated_columns.h"

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

void add_outside(core::Table& table, const std::vector<bool>& outside) {
    table.add_numbers(outside_table_column, "1", std::vector<double>(outside.begin(), outside.end()));
}

void write_table(nlohmann::json& json, const std::string& end, const core::Table& table) {
    json = {{"end", end}};
    for (const core::Column& column : table.columns()) {
        json[column.name] = column.is_text() ? nlohmann::json(column.text) : nlohmann::json(column.numbers);
    }
}

double unsettled(double speeds, double turns, double settle_speed) {
    constexpr double size = 0.1;  // m, turns rad/s into the speed of the body's ends
    return (speeds + size * size * turns) / (settle_speed * settle_speed) - 1;
}

void write_events(nlohmann::json& json, const std::vector<TrajectoryEvent>& events, bool with_state) {
    json["events"] = nlohmann::json::array();
    for (const TrajectoryEvent& event : events) {
        nlohmann::json one = {{"time", event.time}, {"kind", event.kind}};
        if (with_state) {
            one["gap"] = event.gap;
            one["heave_velocity"] = event.velocity;
        }
        json["events"].push_back(std::move(one));
    }
}

void write_remarks(nlohmann::json& json, const std::vector<bool>& outside, const core::Problems& remarks) {
    json["outside_table"] = std::count(outside.begin(), outside.end(), true);
    json["remarks"] = nlohmann::json::array();
    for (const core::Problem& remark : remarks) {
        json["remarks"].push_back(remark.message);
    }
}

void remark_outside(core::Problems& remarks, const std::vector<bool>& outside, const std::string& range) {
    const auto beyond = std::count(outside.begin(), outside.end(), true);
    if (beyond > 0) {
        remarks.push_back({core::Problem::Severity::warning,
                           core::counted_of(beyond, outside.size(), "output", "lies", "lie") +
                               " outside the range of a force table" + range + ", where it holds its end value",
                           {}});
    }
}

void refuse_odd_start(std::span<const double> start) {
    if (!std::all_of(start.begin(), start.end(), [](double part) { return std::isfinite(part); })) {
        throw core::InputError("range", "the start of the motion is not a number that makes sense");
    }
}

void refuse_start_in_ground(const std::array<double, 2>& gaps) {
    if (std::min(gaps[0], gaps[1]) < -start_depth) {
        throw core::InputError("range",
                               "the start lies in the ground: gaps of nose and tail edge " +
                                   core::told(gaps[0], "m", 4) + ", " + core::told(gaps[1], "m", 4),
                               {}, "start higher or flatter, or set [contact] gap in the model");
    }
}

}  // namespace underbody::dynamics
