// Estimators for the closed loop, by name.
#include <algorithm>
#include <cmath>

#include "surrogates/estimator/control/closed_loop.h"

namespace underbody::estimator {

namespace {

AugmentedModel learned_model(const SeparatedPlant& plant) {
    TrainingOptions t;
    t.gap_lower = std::max(plant.lower, plant.contact_gap);
    t.gap_upper = plant.upper;
    t.samples = 20000;
    const TrainingSet set = training_set(plant, t);
    return corrected(learn(moments(set.view()), set.layout), Correction::p3,
                     heave_rows(set.layout, plant.mass_at(0.5 * (t.gap_lower + t.gap_upper)), plant.bias));
}

// A departure that wanders by a third of the largest force in a second.
double wandering_density(const SeparatedPlant& plant) {
    double largest = 1e-6, slope = 0;
    for (int i = 0; i <= 200; ++i) {
        largest =
            std::max(largest, std::abs(plant.ground_force(plant.lower + (plant.upper - plant.lower) * i / 200, slope)));
    }
    return 0.01 * largest * largest;
}

}  // namespace

const std::vector<std::string>& loop_estimators() {
    static const std::vector<std::string> names{"disturbance", "reduced",  "full",  "latent",
                                                "kalman",      "extended", "truth", "none"};
    return names;
}

namespace {

/// Observers of the linear model that is learned from the plant.
LinearFilter filter_of_model(const std::string& name, const SeparatedPlant& plant, const LoopDesign& d) {
    const AugmentedModel model = learned_model(plant);
    const double r = d.rate;
    const std::vector<std::string> sensors =
        d.velocity_measured ? std::vector<std::string>{"heave_velocity", "gap"} : std::vector<std::string>{"gap"};
    if (name == "reduced") {
        return reduced_observer(model, reduced_gain(model, {{-r, 0}, {-1.3 * r, 0}}), d.step).filter;
    }
    if (name == "kalman") {
        const double rate = model.sigma[7] * model.sigma[7] + model.sigma[8] * model.sigma[8];
        Vector sigma{std::max(d.gap_noise, 1e-6)};
        if (d.velocity_measured) {
            sigma.insert(sigma.begin(), std::max(d.velocity_noise, 1e-6));
        }
        return kalman_observer(model, sensors, {0, 0, rate, rate}, sigma, d.step).filter;
    }
    const Matrix gain = full_gain(model, sensors, {-r, -1.2 * r, -1.4 * r, -1.6 * r});
    return name == "full" ? full_observer(model, sensors, gain, d.step).filter
                          : latent_observer(model, usual_rotation(), {model.sigma.begin() + 1, model.sigma.begin() + 5},
                                            {model.mean.begin() + 1, model.mean.begin() + 5}, sensors, gain, d.step)
                                .filter;
}

}  // namespace

LoopEstimator design_loop_estimator(const std::string& name, const SeparatedPlant& plant, const LoopDesign& d) {
    const auto& known = loop_estimators();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
        throw core::InputError("name", "there is no estimator '" + name + "' for the loop", {},
                               core::did_you_mean(name, known));
    }
    LoopEstimator e;
    e.name = name;
    if (name == "none" || name == "truth") {
        e.source = name == "none" ? ForceSource::none : ForceSource::truth;
        return e;
    }
    if (!(d.rate > 0)) {
        throw core::InputError("unstable", "the rate of the estimator must be positive");
    }
    if (!d.velocity_measured && (name == "disturbance" || name == "reduced")) {
        throw core::InputError("missing", "the " + name + " observer needs measured heave_velocity", {},
                               "take extended, kalman, full or latent: they need the gap alone");
    }
    if (name == "extended") {
        e.source = ForceSource::extended;
        e.noise.gap = std::max(d.gap_noise, 1e-6);
        e.noise.velocity = d.velocity_measured ? std::max(d.velocity_noise, 1e-6) : 0;
        e.noise.force_density = wandering_density(plant);
        e.noise.gate = 0;
        return e;
    }
    e.source = ForceSource::filter;
    if (name == "disturbance") {
        e.filter = disturbance_observer(plant.virtual_mass, plant.bias, d.rate, d.step).filter;
        return e;
    }
    e.filter = filter_of_model(name, plant, d);
    return e;
}

}  // namespace underbody::estimator
