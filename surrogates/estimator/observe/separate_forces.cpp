// The simulator's heave equation with its forces apart, for filters, observers and control.
#include <memory>

#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/heave_step.h"
#include "surrogates/estimator/model/training.h"

namespace underbody::estimator {

double SeparatedPlant::acceleration(double gap, double velocity, double input, double time,
                                    dynamics::HeaveSlopes& slopes) const {
    dynamics::HeaveLoad load;
    DragSlopes drag_slopes;
    load.force = ground_force(gap, load.slope_h) - drag_force(gap, velocity, drag_slopes) + input + bias;
    load.slope_h -= drag_slopes.gap;
    load.slope_w -= drag_slopes.velocity;
    if (other_force) {
        const dynamics::HeaveLoad other = other_force(time, gap, velocity, input);
        load.force += other.force;
        load.slope_h += other.slope_h;
        load.slope_w += other.slope_w;
    }
    return dynamics::heave_acceleration(inertia_at(gap), velocity, load, {}, slopes);
}

namespace {

/// The law over one step with the input held.
struct HeldLaw {
    const SeparatedPlant& plant;
    double input, time, step;
    double operator()(double part, double h, double w, const double* /*memory*/, dynamics::HeaveSlopes* slopes) const {
        dynamics::HeaveSlopes unused;
        return plant.acceleration(h, w, input, time + part * step, slopes ? *slopes : unused);
    }
};

}  // namespace

void SeparatedPlant::advance(double& gap, double& velocity, double input, double step, double time) const {
    dynamics::HeaveState state{gap, velocity, {}};
    const HeldLaw law{*this, input, time, step};
    dynamics::HeaveStepper<HeldLaw>(law, 0, contact_gap, restitution)
        .advance(state, step, [this](const dynamics::HeaveState& s, double a, double dt) {
            return fastest_rate ? fastest_rate(s, a, dt) : 0.0;
        });
    gap = state.h;
    velocity = state.w;
}

namespace {

/// What neither the one table of the ground nor the drag holds: waves, growth in time, several tables, losses of
/// thrust, corrections.
void add_other_force(SeparatedPlant& plant, const std::shared_ptr<const dynamics::HeavePlant>& heave) {
    const dynamics::HeaveTerms& terms = heave->terms;
    const bool several = std::any_of(terms.corrections.begin(), terms.corrections.end(),
                                     [](const auto& correction) { return correction.curve.empty(); });
    if (terms.forced_in_time() || several || !heave->single_curve() || terms.thrust_loss != 0) {
        plant.other_force = [heave](double t, double h, double w, double u) {
            // Tables over the velocity too: what they give beside their value at rest.
            dynamics::HeaveLoad load = heave->table_lift(h, w);
            const dynamics::HeaveLoad at_rest = heave->table_lift(h, 0);
            load.force += timed_force(heave->terms, t) - at_rest.force;
            load.slope_h -= at_rest.slope_h;
            const double lost = u * heave->terms.thrust_lost(h);
            load.force -= lost;
            load.slope_h += lost / heave->terms.thrust_length;
            add_corrections(heave->terms, h, w, {t, u}, heave->held(), load);
            return load;
        };
    }
}

}  // namespace

SeparatedPlant separate(const dynamics::Model& model, const dynamics::Conditions& held) {
    const auto heave = std::make_shared<const dynamics::HeavePlant>(model, held);
    const dynamics::HeaveTerms& terms = heave->terms;
    SeparatedPlant plant;
    plant.virtual_mass =
        terms.added_mass.empty() ? terms.mass : terms.mass + terms.added_mass(terms.added_mass.upper());
    plant.bias = terms.constant;
    plant.actuator = terms.actuator;
    plant.contact_gap = terms.contact_gap;
    plant.restitution = terms.restitution;
    const bool one_curve = heave->single_curve() && !heave->lift_curve().empty();
    plant.lower = one_curve ? heave->lift_curve().lower() : terms.table_lower;
    plant.upper = one_curve ? heave->lift_curve().upper() : terms.table_upper;
    plant.ground_force = [heave](double h, double& slope) {
        dynamics::HeaveLoad load = heave->table_lift(h, 0);
        add_springs(heave->terms, h, load);
        slope = load.slope_h;
        return load.force;
    };
    plant.drag_force = [heave](double h, double w, DragSlopes& slopes) {
        dynamics::HeaveLoad load;
        add_water_drag(heave->terms, w, load);
        add_guided_resistance(heave->terms, h, w, 0, load);
        slopes = {-load.slope_h, -load.slope_w};
        return -load.force;
    };
    if (!terms.growth.empty() || !terms.added_mass.empty()) {
        plant.inertia = [heave](double h) { return heave_inertia(heave->terms, h); };
    }
    add_other_force(plant, heave);
    if (terms.film != 0 || terms.friction != 0) {
        plant.fastest_rate = [heave](const dynamics::HeaveState& state, double a, double step) {
            return dynamics::fastest_rate(heave->terms, state, a, step);
        };
    }
    if (terms.history != 0) {
        plant.remarks.push_back(
            {core::Problem::Severity::warning,
             "the memory of the history force is left out of the estimator: what it pulls is in the "
             "departure of the total force",
             {}});
    }
    return plant;
}

}  // namespace underbody::estimator
