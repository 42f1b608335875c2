#include "surrogates/dynamics/model/table_notes.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/text.h"

namespace underbody::dynamics {

std::vector<std::string> fit_lines(const Model& model) {
    std::vector<std::string> lines;
    for (const ForceSource& source : model.forces) {
        lines.push_back(source.quantity + " of " + source.table_file + ": " + source.table.kind() + " through " +
                        core::counted(source.table.points().rows(), "point"));
    }
    return lines;
}

nlohmann::json fits_json(const Model& model) {
    nlohmann::json list = nlohmann::json::array();
    for (const ForceSource& source : model.forces) {
        nlohmann::json remarks = nlohmann::json::array();
        for (const core::Problem& remark : source.table.remarks()) {
            remarks.push_back(remark.message);
        }
        list.push_back({{"quantity", source.quantity},
                        {"table", source.table_file},
                        {"kind", source.table.kind()},
                        {"points", source.table.points().rows()},
                        {"remarks", remarks}});
    }
    return list;
}

core::Problems held_outside(const Model& model, const Conditions& held) {
    core::Problems found;
    for (const ForceSource& source : model.forces) {
        for (std::size_t k = 0; k < source.axes.size(); ++k) {
            const Channel channel = source.axes[k];
            const tables::TableAxis& axis = source.table.axes()[k];
            if (!held.has(channel) || (held[channel] >= axis.lower && held[channel] <= axis.upper)) {
                continue;
            }
            found.push_back(
                {core::Problem::Severity::warning,
                 axis.name + " " + core::format_number(held[channel], 6) + " " + axis.unit + " is outside the " +
                     source.quantity + " table " + source.table_file + ", which covers " +
                     core::format_number(axis.lower, 6) + " to " + core::format_number(axis.upper, 6) + " " +
                     axis.unit + ": its end value is held, the force is that at " +
                     core::format_number(held[channel] < axis.lower ? axis.lower : axis.upper, 6) + " " + axis.unit,
                 {source.table_path.string(), {}, {}, {}}});
        }
    }
    return found;
}

core::Problems held_at_reference(const Model& model, const Conditions& held, const std::vector<Channel>& moving) {
    core::Problems found;
    for (const ForceSource& source : model.forces) {
        for (const ForceScale& scale : source.scales) {
            const bool moves = std::find(moving.begin(), moving.end(), scale.channel) != moving.end();
            if (!moves && !held.over(model.conditions).has(scale.channel)) {
                const std::string name(channel_name(scale.channel));
                found.push_back({core::Problem::Severity::note,
                                 name + " is not given: " + source.quantity + " is that at its reference, " + name +
                                     " " + core::format_number(scale.reference, 6) + " " + channel_unit(scale.channel),
                                 {model.name, {}, {}, {}}});
            }
        }
    }
    return found;
}

namespace {

/// The values of all runs beyond one axis of a table.
struct Beyond {
    double lowest = 0, highest = 0;
    std::size_t rows = 0, of = 0;
    std::string run;  ///< the first
};

Beyond beyond_axis(const Model& model, const Measurements& data, Channel channel, const tables::TableAxis& axis) {
    Beyond found;
    const double rounding = 1e-9 * (axis.upper - axis.lower);
    for (const MeasuredRun& run : data.runs) {
        std::vector<double> values = run.values(channel_name(channel));
        if (values.empty() && model.conditions.has(channel)) {
            values.assign(run.table.rows(), model.conditions[channel]);
        }
        for (const double value : values) {
            found.of += std::isfinite(value) ? 1 : 0;
            if (!(value < axis.lower - rounding || value > axis.upper + rounding)) {
                continue;
            }
            found.lowest = found.rows == 0 ? value : std::min(found.lowest, value);
            found.highest = found.rows == 0 ? value : std::max(found.highest, value);
            found.run = found.rows++ == 0 ? run.name : found.run;
        }
    }
    return found;
}

}  // namespace

core::Problems runs_outside(const Model& model, const Measurements& data) {
    core::Problems found;
    const auto number = [](double value) { return core::format_number(value, 6); };
    for (const ForceSource& source : model.forces) {
        for (std::size_t k = 0; k < source.axes.size(); ++k) {
            if (source.axes[k] == Channel::gap && data.kind == MeasurementKind::time_series) {
                continue;  // what becomes of its readings outside is for each use to say
            }
            const tables::TableAxis& axis = source.table.axes()[k];
            const Beyond beyond = beyond_axis(model, data, source.axes[k], axis);
            if (beyond.rows == 0) {
                continue;
            }
            found.push_back({core::Problem::Severity::warning,
                             axis.name + " is " + number(beyond.lowest) +
                                 (beyond.highest > beyond.lowest ? " to " + number(beyond.highest) : "") + " " +
                                 axis.unit + " in " + std::to_string(beyond.rows) + " of " +
                                 core::counted(beyond.of, "measured row") + " (first in run " + beyond.run +
                                 "), outside the " + source.quantity + " table " + source.table_file +
                                 ", which covers " + number(axis.lower) + " to " + number(axis.upper) + " " +
                                 axis.unit + ": its end value is held there",
                             {source.table_path.string(), {}, {}, {}}});
        }
    }
    return found;
}

}  // namespace underbody::dynamics
