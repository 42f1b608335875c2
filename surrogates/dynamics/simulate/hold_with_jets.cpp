#include "surrogates/dynamics/simulate/hold_with_jets.h"

#include <cmath>
#include <numbers>

#include "surrogates/dynamics/model/drag.h"
#include "surrogates/dynamics/model/force_sources.h"

namespace underbody::dynamics {

VehicleHold::VehicleHold()
    : heading_gain(std::nan("")),
      yaw_rate_gain(std::nan("")),
      speed_gain(std::nan("")),
      gap_gain(std::nan("")),
      heave_gain(std::nan("")),
      pitch_gain(std::nan("")),
      pitch_rate_gain(std::nan("")) {}

JetHold::JetHold(const Model& model, const VehicleHold& hold, const Conditions& held)
    : model_(model.resolved()), hold_(hold), base_(model.vehicle.base_centre()) {
    if (model_.jets.empty()) {
        throw core::InputError("missing", "the model has no jets to hold it with", {model.name, {}, {}, {}},
                               "declare them: [[jet]] name, position, direction, maximum");
    }
    if (!hold.heading && !hold.speed && !hold.gap && !hold.pitch) {
        throw core::InputError("missing", "nothing to hold: name a heading, a speed, a gap or a pitch");
    }
    complete(model_, held.over(model_.conditions));
}

/// Gains for what was left open: critically damped at 1 rad/s in heave and surge, at 2 rad/s in pitch and yaw, on top
/// of what Munk's moment takes in yaw.
void JetHold::complete(const Model& model, const Conditions& given) {
    const Vehicle& v = model.vehicle;
    const auto fill = [](double& gain, double value) { gain = std::isnan(gain) ? value : gain; };
    const double speed = hold_.speed.value_or(given.get(Channel::speed, 0.0));
    const double heave = model.heave_mass(), surge = v.mass + v.added_mass_surge, sway = v.mass + v.added_mass_sway;
    const double turn = std::isnan(v.yaw_inertia) ? 0 : v.yaw_inertia + v.added_inertia_yaw;
    const double tip = std::isnan(v.pitch_inertia) ? 0 : v.pitch_inertia + v.added_inertia_pitch;
    const double munk = std::abs(v.added_mass_surge - v.added_mass_sway) * speed * speed * surge / sway;
    fill(hold_.heading_gain, munk + 4 * turn);
    fill(hold_.yaw_rate_gain, 4 * turn + 2 * std::sqrt(munk * turn));
    fill(hold_.speed_gain, surge);
    fill(hold_.gap_gain, heave);
    fill(hold_.heave_gain, 2 * heave);
    fill(hold_.pitch_gain, 4 * tip);
    fill(hold_.pitch_rate_gain, 4 * tip);
    Conditions at = given;
    at[Channel::gap] = hold_.gap.value_or(given.get(Channel::gap, 0.0));
    at[Channel::pitch] = hold_.pitch.value_or(0.0);
    at[Channel::heave_velocity] = at[Channel::pitch_rate] = 0;
    at[Channel::speed] = std::abs(speed);
    const double lift = ForceSources(model, "lift_force", at, {})(at),
                 table_drag = ForceSources(model, "drag_force", at, {})(at);
    drag_at_speed_ =
        drag(model.drag_surge, model.environment, speed) + std::copysign(speed == 0 ? 0.0 : table_drag, speed);
    weight_ = v.net_weight - lift;
    const double depth = std::isnan(v.base_depth) ? 0 : v.base_depth, st = std::sin(at[Channel::pitch]),
                 ct = std::cos(at[Channel::pitch]);
    const Vector3 buoyancy = v.buoyancy_centre();
    trim_moment_ = -(ForceSources(model, "pitch_moment", at, {})(at) + lift * (depth * st + base_[0] * ct) +
                     (v.mass * model.environment.gravity - v.net_weight) * (buoyancy[2] * st + buoyancy[0] * ct) +
                     v.drag_height * drag(model.drag_surge, model.environment, speed) -
                     (speed == 0 ? 0.0 : std::copysign(table_drag, speed)) * (depth * ct - base_[0] * st));
}

Wrench JetHold::wanted(const BodyState& y) const {
    const double st = std::sin(y[state_theta]), ct = std::cos(y[state_theta]);
    const double rise = -RigidBody::world_velocity(y)[2] + (base_[2] * st + base_[0] * ct) * y[state_q];  // of the base
    Wrench want;
    double along = 0, up = 0;
    if (hold_.speed) {
        along = drag_at_speed_ + hold_.speed_gain * (*hold_.speed - (y[state_u] * ct + y[state_w] * st));
    }
    if (hold_.gap) {
        const double gap = -y[state_z] + base_[0] * st - base_[2] * ct;
        up = weight_ - hold_.gap_gain * (gap - *hold_.gap) - hold_.heave_gain * rise;
    }
    want.force = {along * ct + up * st, 0, along * st - up * ct};
    if (hold_.pitch) {
        want.moment[1] =
            trim_moment_ - hold_.pitch_gain * (y[state_theta] - *hold_.pitch) - hold_.pitch_rate_gain * y[state_q];
    }
    if (hold_.heading) {
        const double error = std::remainder(*hold_.heading - y[state_psi], 2 * std::numbers::pi);
        want.moment[2] = hold_.heading_gain * error - hold_.yaw_rate_gain * y[state_r];
    }
    return want;
}

std::vector<double> JetHold::thrusts(const BodyState& y) const {
    // What nobody holds weighs little: it may take what the jets leave.
    constexpr double loose = 0.03;
    const bool up = hold_.gap.has_value(), along = hold_.speed.has_value();
    const std::array<double, 6> weights{along ? 1 : 0.1, 1, up ? 1 : loose, 0, hold_.pitch ? 10 : loose, 10};
    return allocate(model_.jets, wanted(y), weights).thrust;
}

}  // namespace underbody::dynamics
