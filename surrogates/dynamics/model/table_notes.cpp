#include "surrogates/dynamics/model/table_notes.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/quantile.h"
#include "core/text.h"
#include "core/told.h"
#include "surrogates/dynamics/model/effect.h"

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
            found.push_back({core::Problem::Severity::warning,
                             axis.name + " " + core::told(held[channel], axis.unit) + " is outside the " +
                                 source.quantity + " table " + source.table_file + ", which covers " +
                                 core::told_range(axis.lower, axis.upper, axis.unit) +
                                 ": its end value is held, the force is that at " +
                                 core::told(held[channel] < axis.lower ? axis.lower : axis.upper, axis.unit),
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

bool scales_with(const Model& model, Channel channel) {
    return std::any_of(model.forces.begin(), model.forces.end(), [&](const ForceSource& source) {
        return std::any_of(source.scales.begin(), source.scales.end(),
                           [&](const ForceScale& scale) { return scale.channel == channel; });
    });
}

/// By a force table, a scale, an effect, or, of the speed, what acts along the way.
bool is_used(const Model& model, Channel channel) {
    const std::string name = channel_name(channel);
    const bool of_a_force = std::any_of(model.forces.begin(), model.forces.end(), [&](const ForceSource& source) {
        return std::find(source.axes.begin(), source.axes.end(), channel) != source.axes.end();
    });
    const bool of_an_effect = std::any_of(model.effects.begin(), model.effects.end(), [&](const EffectUse& use) {
        const auto& names = effect(use.name).info().depends_on;
        return std::find(names.begin(), names.end(), name) != names.end() ||
               (use.table && std::any_of(use.table->axes().begin(), use.table->axes().end(),
                                         [&](const tables::TableAxis& axis) { return axis.name == name; }));
    });
    const auto resists = [](const DragLaw& law) {
        return law.linear != 0 || law.quadratic != 0 || law.kind == DragLaw::Kind::mixed;
    };
    const bool along_the_way =
        channel == Channel::speed &&
        (!model.jets.empty() || resists(model.drag_surge) || model.coupling.kind == Coupling::Kind::sheltered ||
         std::any_of(model.forces.begin(), model.forces.end(),
                     [](const ForceSource& source) { return source.quantity != "lift_force"; }));
    return of_a_force || of_an_effect || along_the_way || scales_with(model, channel);
}

}  // namespace

core::Problems held_in_vain(const Model& model, const Conditions& given) {
    core::Problems found;
    const auto warn = [&](const std::string& text) {
        found.push_back({core::Problem::Severity::warning, text, {model.name, {}, {}, {}}});
    };
    for (const Channel channel : {Channel::speed, Channel::jet_voltage, Channel::jet_flow, Channel::temperature,
                                  Channel::depth, Channel::approach_direction}) {
        if (given.has(channel) && !is_used(model, channel)) {
            warn(std::string("nothing in the model depends on ") + channel_name(channel) + ": " +
                 core::format_number(given[channel], 6) + " " + channel_unit(channel) +
                 " changes no force; leave it out, or give a force an axis or a scale of that name");
        }
    }
    if (given.get(Channel::speed, 0) < 0 && scales_with(model, Channel::speed)) {
        warn("the speed is " + core::format_number(given[Channel::speed], 6) +
             " m/s, astern: forces that scale with the speed are those of the same speed ahead, nothing was measured "
             "astern");
    }
    return found;
}

core::Problems gaps_of_another_size(const Model& model) {
    constexpr double far = 10;  // lengths, where no ground is felt
    core::Problems found;
    for (const ForceSource& source : model.forces) {
        if (std::find(source.axes.begin(), source.axes.end(), Channel::gap) == source.axes.end()) {
            continue;
        }
        const core::Column* column = source.table.points().find(channel_name(Channel::gap));
        if (column == nullptr || column->numbers.empty()) {
            continue;
        }
        const std::vector<double>& gaps = column->numbers;
        if (core::median(gaps) > far * model.vehicle.length) {
            const auto [low, high] = std::minmax_element(gaps.begin(), gaps.end());
            found.push_back({core::Problem::Severity::warning,
                             "the gaps of the " + source.quantity + " table " + source.table_file + ", " +
                                 core::format_number(*low, 4) + " to " + core::format_number(*high, 4) +
                                 " m, are mostly more than " + core::format_number(far) + " lengths of the vehicle (" +
                                 core::format_number(model.vehicle.length, 4) +
                                 " m): are they millimetres? then the column's name is gap [mm]",
                             {source.table_path.string(), {}, {}, {}}});
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
