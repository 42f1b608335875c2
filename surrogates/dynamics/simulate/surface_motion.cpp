#include "surrogates/dynamics/simulate/surface_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "surrogates/dynamics/model/drag.h"
#include "surrogates/dynamics/plant/acting_jets.h"

namespace underbody::dynamics {

SurfaceMotion::SurfaceMotion(const Model& declared, const Conditions& held, const std::vector<Channel>& varying)
    : model_(declared.resolved()),
      held_(held.over(declared.conditions)),
      vertical_(vertical_channel(model_, held_, varying)),
      acting_(acting_jets(model_.jets, vertical_.terms.surface)) {
    const Vehicle& v = model_.vehicle;
    if (std::isnan(v.yaw_inertia)) {
        throw core::InputError("missing", "surface motion needs vehicle.yaw_inertia", {model_.name, {}, {}, {}});
    }
    mass_x_ = v.mass + v.added_mass_surge;
    mass_y_ = v.mass + v.added_mass_sway;
    inertia_ = v.yaw_inertia + v.added_inertia_yaw;
    gap_ = vertical_.terms.contact_gap;
    base_ = v.base_centre();
    base_[2] = std::isnan(base_[2]) ? 0 : base_[2];
    const double half = std::isnan(v.base_half_length) ? std::numeric_limits<double>::infinity() : v.base_half_length;
    nose_ = base_[0] + half;
    tail_ = base_[0] - half;
    buoyancy_moment_ = (v.mass * model_.environment.gravity - v.net_weight) * v.buoyancy_centre()[0];
    held_[Channel::gap] = gap_;
    held_[Channel::pitch] = 0;
    held_[Channel::heave_velocity] = 0;
    held_[Channel::pitch_rate] = 0;
    std::vector<Channel> all = varying;
    all.push_back(Channel::speed);
    lift_ = ForceSources(model_, "lift_force", held_, all);
    drag_ = ForceSources(model_, "drag_force", held_, all);
    side_ = ForceSources(model_, "side_force", held_, all);
    pitch_moment_ = ForceSources(model_, "pitch_moment", held_, all);
    yaw_moment_ = ForceSources(model_, "yaw_moment", held_, all);
}

SurfaceMotion::Loads SurfaceMotion::loads(const SurfaceState& y, std::span<const double> thrust,
                                          const Surroundings& around) const {
    const double u = y[0], v = y[1], r = y[2];
    Conditions seen = held_;
    if (around.channels) {
        for (std::size_t c = 0; c < channel_count; ++c) {
            seen.value[c] = std::isnan(around.channels[c]) ? seen.value[c] : around.channels[c];
        }
    }
    seen[Channel::gap] = gap_;
    seen[Channel::speed] = std::abs(u);
    const HeaveMoment moment{around.t, std::isnan(around.input) ? vertical_.held_input() : around.input, nullptr,
                             seen.value.data()};
    const Wrench jets = jet_wrench(acting_, thrust);
    const SurfaceTerms& effects = vertical_.terms.surface;
    const double pull_x = effects.pull_x * std::cos(y[3]) + effects.pull_y * std::sin(y[3]),
                 pull_y = effects.pull_y * std::cos(y[3]) - effects.pull_x * std::sin(y[3]);
    const Environment& water = model_.environment;
    const double lift = vertical_.roughened(lift_(seen), gap_);
    const double table_drag = drag_.empty() ? 0.0 : drag_(seen) * u / std::sqrt(u * u + 1e-6);
    const double side = side_(seen), drag_u = drag(model_.drag_surge, water, u);
    Loads all;
    all.x = jets.force[0] - drag_u - table_drag - effects.surge * u + pull_x;
    all.y = jets.force[1] - drag(model_.drag_sway, water, v) + side - effects.sway * v + pull_y;
    all.turn = jets.moment[2] - drag(model_.drag_yaw, water, r) + yaw_moment_(seen) + base_[0] * side +
               base_[1] * table_drag + effects.moment - effects.yaw * r;
    all.up = lift + vertical_.other_force(gap_, 0, moment) + vertical_.timed_force(around.t) - jets.force[2] -
             vertical_.water_drag(-vertical_.terms.current);
    all.pitch = jets.moment[1] + pitch_moment_(seen) + base_[0] * lift - base_[2] * table_drag + buoyancy_moment_ +
                model_.vehicle.drag_height * drag_u;
    return all;
}

SurfaceMotion::Contact SurfaceMotion::contact(const SurfaceState& y, const Loads& all) const {
    Contact c;
    c.normal = -all.up;
    const double pressed = std::max(c.normal, 0.0),
                 limit = std::max(0.0, model_.contact.friction + vertical_.terms.surface.friction) * pressed,
                 width = model_.contact.slip_speed;
    // The point of the resultant and the slip there depend on each other only through sway in yaw: settled in a few
    // rounds.
    constexpr double rounding = 1e-15;
    for (int round = 0; round < 8; ++round) {
        const double sx = y[0], sy = y[1] + y[2] * c.forward, size = std::sqrt(sx * sx + sy * sy + width * width);
        c.friction_x = -limit * sx / size;
        c.friction_y = -limit * sy / size;
        // N x_n + L f_x + M = 0
        const double next = pressed > 0 ? -(all.pitch + base_[2] * c.friction_x) / pressed : 0.0;
        const double change = std::abs(next - c.forward);
        c.forward = next;
        if (change < rounding) {
            break;
        }
    }
    return c;
}

SurfaceMotion::Contact SurfaceMotion::contact(const SurfaceState& y, std::span<const double> thrust,
                                              const Surroundings& around) const {
    return contact(y, loads(y, thrust, around));
}

void SurfaceMotion::rate(const SurfaceState& y, std::span<const double> thrust, SurfaceState& d,
                         const Surroundings& around) const {
    const Loads all = loads(y, thrust, around);
    const Contact c = contact(y, all);
    const double u = y[0], v = y[1], r = y[2];
    d[0] = (all.x + c.friction_x + mass_y_ * r * v) / mass_x_;
    d[1] = (all.y + c.friction_y - mass_x_ * r * u) / mass_y_;
    d[2] = (all.turn + c.forward * c.friction_y - base_[1] * c.friction_x + (mass_x_ - mass_y_) * u * v +
            vertical_.terms.surface.mass_aside * (all.x + c.friction_x)) /
           inertia_;
    d[3] = r;
    d[4] = u * std::cos(y[3]) - v * std::sin(y[3]);
    d[5] = u * std::sin(y[3]) + v * std::cos(y[3]);
}

LinearSystem SurfaceMotion::linearised(const SurfaceState& trim, const std::vector<double>& thrust, bool by_jet) const {
    std::vector<std::string> inputs{"X", "Y", "N"};
    std::vector<double> at(3, 0.0);
    if (by_jet) {
        inputs.clear();
        for (const Jet& jet : jets()) {
            inputs.push_back(jet.name);
        }
        at = thrust;
    }
    const auto rate_of = [&](const double* x, const double* input, double* out) {
        SurfaceState y = trim, d{};
        std::copy(x, x + 4, y.begin());
        rate(y, by_jet ? std::span<const double>(input, at.size()) : std::span<const double>(thrust), d);
        if (!by_jet) {
            d[0] += input[0] / mass_x_;
            d[1] += input[1] / mass_y_;
            d[2] += input[2] / inertia_;
        }
        std::copy(d.begin(), d.begin() + 4, out);
    };
    return linearise(rate_of, {trim[0], trim[1], trim[2], trim[3]}, at, {"u", "v", "r", "psi"}, inputs,
                     {0.1, 0.01, 0.1, 0.1}, std::vector<double>(at.size(), 0.01), 1e-4);
}

std::vector<double> surface_trim_thrusts(const SurfaceMotion& motion, double speed) {
    const std::vector<Jet>& jets = motion.jets();
    std::vector<double> thrust(jets.size(), 0.0);
    const SurfaceState y{speed, 0, 0, 0, 0, 0};
    // Jets press the body down and friction grows with that: a fixed point, contracting while friction is below one.
    constexpr double least_missing = 1e-10, straight = 1e-6, turning = 1e-4;  // N, m/s^2, rad/s^2
    Wrench wanted;
    for (int round = 0; round < 200; ++round) {
        SurfaceState d{};
        motion.rate(y, thrust, d);
        const double missing = -d[0] * (motion.model().vehicle.mass + motion.model().vehicle.added_mass_surge);
        if (std::abs(missing) < least_missing) {
            break;
        }
        wanted.force[0] += missing;
        thrust = allocate(jets, wanted, {1, 1, 0, 0, 0, 10}).thrust;
    }
    SurfaceState d{};
    motion.rate(y, thrust, d);
    if (std::abs(d[0]) > straight || std::abs(d[2]) > turning) {
        throw core::InputError("range",
                               "the jets cannot drive a straight run at " + core::format_number(speed, 4) + " m/s",
                               {motion.model().name, {}, {}, {}}, "a lower speed, stronger jets, or less friction");
    }
    if (motion.contact(y, thrust).normal < 0) {
        throw core::InputError("range",
                               "the body leaves the ground at " + core::format_number(speed, 4) +
                                   " m/s: no run on the ground at this speed",
                               {motion.model().name, {}, {}, {}});
    }
    return thrust;
}

}  // namespace underbody::dynamics
