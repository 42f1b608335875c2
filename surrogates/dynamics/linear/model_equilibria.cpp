#include "surrogates/dynamics/linear/model_equilibria.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "surrogates/dynamics/linear/trim_error.h"
#include "surrogates/dynamics/model/effect.h"
#include "surrogates/dynamics/plant/resting_gaps.h"
#include "surrogates/tables/analysis/balances.h"
#include "surrogates/tables/fit/line.h"
#include "surrogates/tables/fit/sampled.h"

namespace underbody::dynamics {

namespace {

Model asked_for(Model model, const BalanceOptions& options) {
    for (ForceSource& source : model.forces) {
        source.factor *= source.quantity == "lift_force" ? options.scale : 1;
    }
    if (options.net_weight) {
        std::erase_if(model.effects, [](const EffectUse& use) { return use.parameter == "vehicle.net_weight"; });
        model.vehicle.net_weight = *options.net_weight;
    }
    return model;
}

/// To show what the force is made of: at the set points of the lift.
core::Table points_of(const HeavePlant& plant, const std::string& source, double net_weight) {
    std::vector<double> gaps, forces;
    const auto [lower, upper] = resting_range(plant);
    for (const double gap : plant.lift_curve().empty() ? std::vector<double>{} : plant.lift_curve().knots()) {
        if (gap >= lower && gap <= upper) {
            gaps.push_back(gap);
            forces.push_back(plant.static_force(gap) + net_weight);
        }
    }
    core::Table points;
    points.source = source;
    points.add_numbers("gap", "m", std::move(gaps));
    points.add_numbers("lift_force", "N", std::move(forces));
    return points;
}

tables::ForceTable force_at_rest(const Model& model, const HeavePlant& plant, const Conditions& held,
                                 core::Progress& progress) {
    const double weight = model.resolved().vehicle.net_weight;
    tables::SampledFunction f;
    f.quantity = "lift_force";
    f.unit = "N";
    f.kind = "force of a model at rest";
    f.source = model.name;
    const auto [lower, upper] = resting_range(plant);
    f.axes = {{"gap", "m", lower, upper, tables::RangePolicy::clamp, bracketing_gaps(plant), {}}};
    f.value = [&plant, weight](const double* gap) { return plant.static_force(*gap) + weight; };
    f.sigma = [error = HeaveForceError(model, held)](const double* gap) { return error(*gap); };
    f.points = points_of(plant, model.name, weight);
    tables::SamplingOptions fine;
    fine.tolerance = 1e-9;
    return tables::sampled_table(f, fine, progress);
}

void set_errors(tables::Equilibria& found, const Model& model, const BalanceOptions& options) {
    std::vector<BalancedGap> gaps;
    for (const tables::Equilibrium& e : found.all) {
        gaps.push_back({e.gap, tables::reach_of(found, e), e.stability == tables::Stability::stable});
    }
    const auto errors = heave_trim_errors(model, options.held, gaps, static_cast<std::size_t>(options.draws));
    for (std::size_t i = 0; i < errors.size(); ++i) {
        tables::Equilibrium& e = found.all[i];
        if (e.stability == tables::Stability::marginal) {
            continue;
        }
        e.probability = errors[i].exists;
        if (errors[i].stated) {
            e.stiffness_sigma = errors[i].stiffness;
            if (e.frequency > 0) {  // of a mass that is given in the same proportion
                const double own = 2 * std::numbers::pi * e.frequency, mass = e.stiffness / (own * own);
                double slope = 0;
                const double of_model = HeavePlant(model, options.held).inertia(e.gap, slope);
                e.frequency_sigma = errors[i].swing / (2 * std::numbers::pi) * std::sqrt(of_model / mass);
            }
        }
    }
}

}  // namespace

bool ModelEquilibria::one_mass() const {
    const auto ends = std::minmax_element(virtual_mass.begin(), virtual_mass.end());
    return virtual_mass.empty() || *ends.second - *ends.first <= 1e-9 * *ends.second;
}

ModelEquilibria model_equilibria(const Model& declared, const BalanceOptions& options, core::Progress& progress) {
    if (!(options.virtual_mass.value_or(0) >= 0) || !(options.damping.value_or(0) >= 0) ||
        !std::isfinite(options.net_weight.value_or(0)) || !std::isfinite(options.scale)) {
        throw core::UsageError("range", "mass and damping must not be negative, weight and scale must be finite");
    }
    const Model model = asked_for(declared, options);
    const HeavePlant plant(model, options.held);
    ModelEquilibria result{
        {}, {}, force_at_rest(model, plant, options.held, progress), model.resolved().vehicle.net_weight};
    const auto mass_at = [&](double gap) {
        double slope = 0;
        return options.virtual_mass.value_or(plant.inertia(gap, slope));
    };
    const HeaveForceError error(model, options.held);
    tables::Equilibria& found = result.found;
    found.axis = "gap";
    found.axis_unit = "m";
    found.net_weight = result.net_weight;
    found.scale = options.scale;
    found.quantity = "lift_force";
    found.source = model.name;
    tables::set_balances(found, tables::Line(result.at_rest, 0, {0.0}).scaled(1, -result.net_weight), [&](double gap) {
        return tables::AtBalance{error(gap), mass_at(gap), options.damping.value_or(plant.damping(gap))};
    });
    for (const tables::Equilibrium& e : found.all) {
        result.virtual_mass.push_back(mass_at(e.gap));
    }
    found.virtual_mass = result.virtual_mass.empty() ? mass_at(found.lower) : result.virtual_mass.front();
    if (options.draws > 0) {
        set_errors(found, model, options);
    }
    return result;
}

Model with_effects_on_forces(Model model) {
    std::erase_if(model.effects,
                  [](const EffectUse& use) { return effect(use.name).info().seen_in == SeenIn::time_series; });
    return model;
}

}  // namespace underbody::dynamics
