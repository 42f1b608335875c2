// Binds the estimator's plant to a declared model.
#include <cmath>
#include <memory>

#include "surrogates/dynamics/heave.h"
#include "surrogates/dynamics/model.h"
#include "surrogates/estimator/training.h"

namespace underbody::estimator {

namespace {

void note(SeparatedPlant& plant, const std::string& text) {
    plant.remarks.push_back({core::Problem::Severity::warning, text, {}});
}

// What of the heave equation does not fit F_g(h) - F_d(w) + bias.
void name_the_rest(SeparatedPlant& plant, const dynamics::HeaveTerms& terms) {
    if (terms.film != 0 || terms.history != 0 || terms.friction != 0 || !terms.waves.empty() || !terms.corrections.empty() ||
        !terms.extras.empty()) {
        note(plant, "film damping, friction, history, waves and corrections of the model are no function of the gap or the velocity "
                    "alone: they are left out of the separate forces");
    }
    if (!terms.growth.empty() || !terms.added_mass.empty()) {
        note(plant, "the inertia varies with the gap; the separate forces use its value far from the ground");
    }
    if (terms.input_delay != 0 || terms.input_lag != 0 || terms.input_dead_zone != 0 || terms.input_gain != 1) {
        note(plant, "delay, lag, dead zone and gain of the input are left out: the input is taken as the force on the body");
    }
}

}  // namespace

SeparatedPlant separate(const dynamics::Model& model, const dynamics::Conditions& held) {
    auto heave = std::make_shared<dynamics::HeavePlant>(model, held);
    const dynamics::HeaveTerms& t = heave->terms;
    SeparatedPlant plant;
    plant.virtual_mass = t.added_mass.empty() ? t.mass : t.mass + t.added_mass(t.added_mass.upper());
    plant.bias = t.constant;
    name_the_rest(plant, t);
    const double stiffness = t.stiffness, stiffness_gap = t.stiffness_gap;
    if (heave->single_curve() && !heave->lift_curve().empty()) {
        plant.ground_force = [heave, stiffness, stiffness_gap](double h, double& slope) {
            const double value = heave->lift_curve().value(h, slope);
            slope -= stiffness;
            return value - stiffness * (h - stiffness_gap);
        };
        plant.lower = heave->lift_curve().lower();
        plant.upper = heave->lift_curve().upper();
    } else {
        plant.ground_force = [heave, stiffness, stiffness_gap](double h, double& slope) {
            slope = (heave->lift(h + 1e-6) - heave->lift(h - 1e-6)) / 2e-6 - stiffness;
            return heave->lift(h) - stiffness * (h - stiffness_gap);
        };
        plant.lower = t.table_lower;
        plant.upper = t.table_upper;
    }
    const double current = t.current, linear = t.linear, quadratic = t.quadratic;
    const double extra_linear = t.extra_linear, extra_quadratic = t.extra_quadratic;
    const bool mixed = t.mixed;
    const dynamics::MixedDrag law = t.mixed_law;
    plant.drag_force = [=](double w, double& slope) {
        const double v = w - current;
        slope = (mixed ? law.slope(v) : linear + 2 * quadratic * std::abs(v)) + extra_linear + 2 * extra_quadratic * std::abs(w);
        return (mixed ? law(v) : linear * v + quadratic * v * std::abs(v)) + extra_linear * w + extra_quadratic * w * std::abs(w);
    };
    plant.contact_gap = t.contact_gap;
    return plant;
}

}  // namespace underbody::estimator
