#include "surrogates/dynamics/model/force_error.h"

#include <algorithm>
#include <cmath>

namespace underbody::dynamics {

namespace {

/// A table of the same quantity over the same axes that holds one value.
tables::ForceTable flat(const tables::ForceTable& like, double value) {
    const auto& axes = like.axes();
    std::vector<std::vector<double>> columns(axes.size());
    for (std::size_t corner = 0; corner < std::size_t{1} << axes.size(); ++corner) {
        for (std::size_t k = 0; k < axes.size(); ++k) {
            columns[k].push_back((corner >> k & 1) != 0 ? axes[k].upper : axes[k].lower);
        }
    }
    core::Table points;
    tables::FitOptions options;
    options.kind = tables::FitOptions::Kind::interpolation;
    for (std::size_t k = 0; k < axes.size(); ++k) {
        points.add_numbers(axes[k].name, axes[k].unit, columns[k]);
        options.axes.push_back(axes[k].name);
    }
    points.add_numbers(like.quantity(), like.unit(), std::vector<double>(std::size_t{1} << axes.size(), value));
    return tables::ForceTable::fit(points, like.quantity(), options);
}

/// Of the sources of the quantity, only the table `one` at 1 (none: SIZE_MAX).
StaticModel with_only(Model model, const std::string& quantity, std::size_t one) {
    for (std::size_t i = 0; i < model.forces.size(); ++i) {
        if (model.forces[i].quantity == quantity) {
            model.forces[i].table = flat(model.forces[i].table, i == one ? 1 : 0);
        }
    }
    return {model, quantity};
}

std::vector<Channel> channels_of(const tables::ForceTable& table) {
    std::vector<Channel> channels;
    for (const tables::TableAxis& axis : table.axes()) {
        Channel channel{};
        find_channel(axis.name, channel);
        channels.push_back(channel);
    }
    return channels;
}

double sigma_at(const tables::ForceTable& table, const std::vector<Channel>& axes, const Conditions& at) {
    double point[tables::max_axes] = {};
    for (std::size_t k = 0; k < axes.size(); ++k) {
        point[k] = at.get(axes[k], 0);
    }
    return table.sigma(point);
}

/// Anywhere on or beyond its grid.
bool states_error(const tables::ForceTable& table) {
    double middle[tables::max_axes], beyond[tables::max_axes];
    for (std::size_t k = 0; k < table.axes().size(); ++k) {
        const auto& axis = table.axes()[k];
        middle[k] = axis.lower + 0.4567 * (axis.upper - axis.lower);
        beyond[k] = axis.upper + (axis.upper - axis.lower);
    }
    return table.sigma(middle) > 0 || table.sigma(beyond) > 0;
}

}  // namespace

ForceError::ForceError(const Model& model, const std::string& quantity)
    : model_(model, quantity), quantity_(quantity), nothing_(with_only(model.resolved(), quantity, SIZE_MAX)) {
    const Model resolved = model.resolved();
    std::vector<std::string> files;
    for (std::size_t i = 0; i < resolved.forces.size(); ++i) {
        const ForceSource& source = resolved.forces[i];
        if (source.quantity == quantity && states_error(source.table)) {
            const std::string file = source.table_path.string() + "|" + source.table_file;
            const auto group = static_cast<std::size_t>(std::find(files.begin(), files.end(), file) - files.begin());
            if (group == files.size()) {
                files.push_back(file);
            }
            sources_.push_back({i, group, with_only(resolved, quantity, i)});
        }
    }
    groups_ = files.size();
    for (std::size_t e = 0; e < model.effects.size(); ++e) {
        const EffectUse& use = model.effects[e];
        const auto& parameters = effect(use.name).info().parameters;
        if (use.table && (use.quantity.empty() ? use.table->quantity() : use.quantity) == quantity) {
            corrections_.emplace_back(*use.table, channels_of(*use.table));
        }
        for (std::size_t p = 0; p < parameters.size(); ++p) {
            const bool of_a_force =
                use.parameter.empty() || use.parameter.starts_with("force.") || use.parameter.starts_with("coupling.");
            if (!(use.sigmas[p] > 0) || !of_a_force) {
                continue;
            }
            Model above = model, below = model;
            double& high = above.effects[e].values[p];
            double& low = below.effects[e].values[p];
            high = std::min(high + use.sigmas[p], parameters[p].upper);
            low = std::max(low - use.sigmas[p], parameters[p].lower);
            if (high > low) {
                parameters_.push_back({{above, quantity}, {below, quantity}, (high - low) / (2 * use.sigmas[p])});
            }
        }
    }
}

double ForceError::operator()(const Conditions& set_point) const {
    double sum = 0;
    if (!sources_.empty()) {
        const Conditions seen = model_.seen(set_point);
        const double nothing = nothing_(set_point);
        for (std::size_t group = 0; group < groups_; ++group) {
            double sigma = 0;
            for (const Source& source : sources_) {
                const ForceSource& declared = model_.model().forces[source.index];
                sigma += source.group == group
                             ? (source.alone(set_point) - nothing) * sigma_at(declared.table, declared.axes, seen)
                             : 0;
            }
            sum += sigma * sigma;
        }
    }
    const Conditions asked = set_point.over(model_.model().conditions);
    for (const auto& [table, axes] : corrections_) {
        const double sigma = sigma_at(table, axes, asked);
        sum += sigma * sigma;
    }
    for (const Parameter& parameter : parameters_) {
        const double sigma = (parameter.above(set_point) - parameter.below(set_point)) / (2 * parameter.share);
        sum += sigma * sigma;
    }
    return std::sqrt(sum);
}

}  // namespace underbody::dynamics
