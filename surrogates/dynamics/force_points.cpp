#include "surrogates/dynamics/force_points.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/text.h"
#include "core/units.h"
#include "surrogates/dynamics/effects/effect.h"

namespace underbody::dynamics {

namespace {

void remark(ForcePoints& out, const Model& model, std::string text) {
    out.remarks.push_back({core::Problem::Severity::warning, std::move(text), {model.name, {}, {}, {}}});
}

/// Keeps the static effects of the vehicle; the others are named in the remarks.
Model of_the_vehicle(const Model& model, ForcePoints& out) {
    Model kept = model.resolved();
    std::string left;
    std::erase_if(kept.effects, [&left](const EffectUse& use) {
        const EffectInfo& info = effect(use.name).info();
        const bool goes = info.belongs_to_the_rig || info.seen_in == SeenIn::time_series;
        if (goes) {
            left += (left.empty() ? "" : ", ") + use.name;
        }
        return goes;
    });
    if (!left.empty()) {
        remark(out, model, "left out of the force, because it belongs to the rig or to the motion: " + left);
    }
    return kept;
}

using Axes = std::map<Channel, std::vector<double>>;

void take(Axes& axes, const tables::ForceTable& table) {
    for (const tables::TableAxis& axis : table.axes()) {
        Channel channel{};
        if (find_channel(axis.name, channel)) {
            std::vector<double>& points = axes[channel];
            points.insert(points.end(), axis.points.begin(), axis.points.end());
        }
    }
}

/// A spline, or an exported table: it goes through its points by slopes that a new fit through them would not take.
bool has_slopes_of_its_own(const tables::ForceTable& table) {
    for (std::size_t k = 0; k < table.axes().size(); ++k) {
        if (table.knots(k) != table.axes()[k].points) {
            return false;  // smoothed: it does not go through them
        }
    }
    return !table.is_monotone_interpolation();
}

constexpr std::size_t most_points = 1000000;

std::size_t points_of(const Axes& axes, std::size_t parts) {
    std::size_t count = 1;
    for (const auto& [channel, points] : axes) {
        count *= std::min(most_points + 1, parts * (points.size() - 1) + 1);
        count = std::min(count, most_points + 1);
    }
    return count;
}

std::vector<double> divided(const std::vector<double>& points, std::size_t parts) {
    std::vector<double> out;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        for (std::size_t part = 0; part < parts; ++part) {
            out.push_back(points[i] +
                          (points[i + 1] - points[i]) * static_cast<double>(part) / static_cast<double>(parts));
        }
    }
    out.push_back(points.back());
    return out;
}

/// The axes of all tables, without those that are held.
Axes axes_of(const Model& model, const Conditions& held) {
    Axes axes;
    for (const ForceSource& source : model.forces) {
        take(axes, source.table);
    }
    for (const EffectUse& use : model.effects) {
        if (use.table) {
            take(axes, *use.table);
        }
    }
    std::erase_if(axes, [&held](const auto& axis) { return held.has(axis.first); });
    for (auto& [channel, points] : axes) {
        std::sort(points.begin(), points.end());
        points.erase(std::unique(points.begin(), points.end()), points.end());
    }
    const bool bent = !model.effects.empty() ||
                      std::any_of(model.forces.begin(), model.forces.end(),
                                  [](const ForceSource& source) { return has_slopes_of_its_own(source.table); });
    std::size_t parts = bent ? 4 : 1;
    while (parts > 1 && points_of(axes, parts) > most_points) {
        --parts;
    }
    for (auto& [channel, points] : axes) {
        points = divided(points, parts);
    }
    return axes;
}

/// What scales and is no axis: held somewhere, and said.
void hold_scales(const Model& model, const Axes& axes, Conditions& held, ForcePoints& out) {
    for (const ForceSource& source : model.forces) {
        for (const ForceScale& scale : source.scales) {
            if (axes.contains(scale.channel) || held.has(scale.channel)) {
                continue;
            }
            held[scale.channel] = model.conditions.get(scale.channel, scale.reference);
            remark(
                out, model,
                std::string(channel_name(scale.channel)) + " is held at " +
                    core::format_number(held[scale.channel], 6) + " " + channel_unit(scale.channel) +
                    (model.conditions.has(scale.channel) ? ", the model's condition" : ", the reference of its scale"));
        }
    }
}

/// What the forces were computed for, one value a column: held channels, and the vehicle they belong to.
void add_constants(core::Table& points, const Model& model, const Axes& axes, const Conditions& held) {
    const auto add = [&](const char* name, const char* unit, double value) {
        if (points.find(name) == nullptr && std::isfinite(value)) {  // what the model does not state is not stated here
            points.add_numbers(name, unit, std::vector<double>(points.rows(), value));
        }
    };
    for (std::size_t i = 0; i < channel_count; ++i) {
        const auto channel = static_cast<Channel>(i);
        if (held.has(channel) && !axes.contains(channel)) {
            add(channel_name(channel), channel_unit(channel), held[channel]);
        }
    }
    add("mass", "kg", model.vehicle.mass);
    add("added_mass_heave", "kg", model.vehicle.added_mass_heave);
    add("net_weight", "N", model.vehicle.net_weight);
    add("length", "m", model.vehicle.length);
    add("width", "m", model.vehicle.width);
    add("density", "kg/m^3", model.environment.density);
}

}  // namespace

ForcePoints force_points(const Model& declared, const Conditions& given) {
    ForcePoints out;
    const std::vector<std::string> quantities = declared.quantities();
    if (quantities.empty()) {
        throw core::InputError("missing", "the model has no force source", {declared.name, {}, {}, {}},
                               "declare it: [[force]] quantity = \"lift_force\", table = ...");
    }
    const Model model = of_the_vehicle(declared, out);
    Conditions held = given;
    const Axes axes = axes_of(model, held);
    hold_scales(model, axes, held, out);
    const std::size_t count = points_of(axes, 1);
    if (count > most_points) {
        throw core::InputError("range", "the tables of the model have more than a million set points together",
                               {declared.name, {}, {}, {}}, "hold one of their axes, such as --where \"speed=0.5\"");
    }
    std::vector<std::vector<double>> columns(axes.size()), forces(quantities.size());
    std::vector<StaticModel> models;
    for (const std::string& quantity : quantities) {
        models.emplace_back(model, quantity);
    }
    for (std::size_t row = 0; row < count; ++row) {
        Conditions point = held;
        std::size_t rest = row, k = axes.size();
        for (auto axis = axes.rbegin(); axis != axes.rend(); ++axis) {
            const double value = axis->second[rest % axis->second.size()];
            rest /= axis->second.size();
            point[axis->first] = value;
            columns[--k].push_back(value);
        }
        for (std::size_t q = 0; q < quantities.size(); ++q) {
            forces[q].push_back(models[q](point));
        }
    }
    out.points.source = declared.name;
    std::size_t k = 0;
    for (const auto& [channel, points] : axes) {
        out.points.add_numbers(channel_name(channel), channel_unit(channel), std::move(columns[k++]));
    }
    for (std::size_t q = 0; q < quantities.size(); ++q) {
        out.points.add_numbers(quantities[q], core::find_quantity(quantities[q])->unit, std::move(forces[q]));
    }
    add_constants(out.points, model, axes, held);
    return out;
}

}  // namespace underbody::dynamics
