#include "surrogates/dynamics/model/force_points.h"

#include <algorithm>
#include <map>

#include "core/units.h"
#include "surrogates/dynamics/model/vehicle_forces.h"

namespace underbody::dynamics {

namespace {

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

}  // namespace

ForcePoints force_points(const Model& declared, const Conditions& given) {
    ForcePoints out;
    const Model model = of_the_vehicle(declared, out.remarks);
    const std::vector<std::string> quantities = model.quantities();
    Conditions held = given;
    const Axes axes = axes_of(model, held);
    std::vector<Channel> channels;
    for (const auto& [channel, points] : axes) {
        channels.push_back(channel);
    }
    hold_scales(model, channels, held, out.remarks);
    const std::size_t count = points_of(axes, 1);
    if (count > most_points) {
        throw core::InputError("range", "the tables of the model have more than a million set points together",
                               {declared.name, {}, {}, {}}, "hold one of their axes, such as option 'where speed=0.5'");
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
    add_constants(out.points, model, channels, held);
    return out;
}

}  // namespace underbody::dynamics
