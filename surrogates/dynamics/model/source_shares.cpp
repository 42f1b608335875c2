#include "surrogates/dynamics/model/source_shares.h"

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

}  // namespace

std::vector<EffectUse> effects_on_tables(const Model& model, const std::string& quantity) {
    std::vector<EffectUse> kept;
    for (const EffectUse& use : model.effects) {
        const EffectInfo& info = effect(use.name).info();
        const bool compiled = quantity == "lift_force" && info.seen_in == SeenIn::both;
        if (!info.belongs_to_the_rig && info.seen_in != SeenIn::time_series && !compiled) {
            kept.push_back(use);
        }
    }
    return kept;
}

SourceShares::SourceShares(const Model& model, const std::string& quantity)
    : nothing_(with_only(model.resolved(), quantity, SIZE_MAX)) {
    const Model resolved = model.resolved();
    for (std::size_t i = 0; i < resolved.forces.size(); ++i) {
        if (resolved.forces[i].quantity == quantity) {
            sources_.push_back(i);
            alone_.push_back(with_only(resolved, quantity, i));
        }
    }
}

}  // namespace underbody::dynamics
