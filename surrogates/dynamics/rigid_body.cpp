#include "surrogates/dynamics/rigid_body.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "surrogates/dynamics/drag.h"

namespace underbody::dynamics {

namespace {

double needed(double value, const char* name, const Model& model) {
    if (std::isnan(value)) {
        throw core::InputError("missing", std::string("motion with pitch and yaw needs vehicle.") + name,
                               {model.name, {}, {}, {}});
    }
    return value;
}

}  // namespace

const std::vector<std::string>& body_state_names() {
    static const std::vector<std::string> names{"u", "v", "w", "q", "r", "theta", "psi", "X", "Y", "Z"};
    return names;
}

RigidBody::RigidBody(const Model& declared, const Conditions& held)
    : model_(declared.resolved()), held_(held.over(declared.conditions)) {
    const Vehicle& v = model_.vehicle;
    ax_ = v.added_mass_surge;
    ay_ = v.added_mass_sway;
    az_ = v.added_mass_heave;
    sx_ = v.mass + ax_;
    sy_ = v.mass + ay_;
    sz_ = v.mass + az_;
    sp_ = needed(v.roll_inertia, "roll_inertia", model_) + v.added_inertia_roll;
    sq_ = needed(v.pitch_inertia, "pitch_inertia", model_) + v.added_inertia_pitch;
    sr_ = needed(v.yaw_inertia, "yaw_inertia", model_) + v.added_inertia_yaw;
    depth_ = needed(v.base_depth, "base_depth", model_);
    half_length_ = needed(v.base_half_length, "base_half_length", model_);
    buoyancy_ = v.mass * model_.environment.gravity - v.net_weight;
    for (const ForceSource& source : model_.forces) {
        has_lift_ = has_lift_ || source.quantity == "lift_force";
        has_moment_ = has_moment_ || source.quantity == "pitch_moment";
        has_drag_ = has_drag_ || source.quantity == "drag_force";
    }
}

double RigidBody::roll_rate(const BodyState& y) const { return -y[state_r] * std::tan(y[state_theta]); }

double RigidBody::kinetic_energy(const BodyState& y) const {
    const double p = roll_rate(y);
    return 0.5 * (sx_ * y[state_u] * y[state_u] + sy_ * y[state_v] * y[state_v] + sz_ * y[state_w] * y[state_w] +
                  sp_ * p * p + sq_ * y[state_q] * y[state_q] + sr_ * y[state_r] * y[state_r]);
}

Vector3 RigidBody::world_velocity(const BodyState& y) {
    const double st = std::sin(y[state_theta]), ct = std::cos(y[state_theta]);
    const double sp = std::sin(y[state_psi]), cp = std::cos(y[state_psi]);
    const double u = y[state_u], v = y[state_v], w = y[state_w];
    return {u * cp * ct - v * sp + w * cp * st, u * sp * ct + v * cp + w * sp * st, -u * st + w * ct};
}

double RigidBody::height_for_gap(double gap, double theta) const { return -gap - depth_ * std::cos(theta); }
double RigidBody::gap_at_base_centre(const BodyState& y) const {
    return -y[state_z] - depth_ * std::cos(y[state_theta]);
}

std::array<double, 2> RigidBody::edge_gaps(const BodyState& y) const {
    const double h = gap_at_base_centre(y), rise = half_length_ * std::sin(y[state_theta]);
    return {h + rise, h - rise};
}

std::array<double, 2> RigidBody::edge_speeds(const BodyState& y) const {
    const double up = -world_velocity(y)[2] + depth_ * std::sin(y[state_theta]) * y[state_q];
    const double turn = half_length_ * std::cos(y[state_theta]) * y[state_q];
    return {up + turn, up - turn};
}

/// du, dv, dw, dq, dr under given normal forces.
void RigidBody::accelerations(const BodyState& y, std::span<const double> thrust, const std::array<double, 2>& normal,
                              double* out) const {
    const double u = y[state_u], v = y[state_v], w = y[state_w], q = y[state_q], r = y[state_r], theta = y[state_theta];
    const double st = std::sin(theta), ct = std::cos(theta), tt = st / ct;
    const double p = -r * tt;
    const Wrench jets = jet_wrench(model_.jets, thrust);
    Conditions seen = held_;
    seen[Channel::gap] = gap_at_base_centre(y);
    seen[Channel::pitch] = theta;
    seen[Channel::heave_velocity] = -world_velocity(y)[2];
    seen[Channel::pitch_rate] = q;
    const double forward = u * ct + w * st;
    if (!held_.has(Channel::speed)) {
        seen[Channel::speed] = std::abs(forward);
    }
    const double lift = has_lift_ ? sum_of_sources(model_, "lift_force", seen) : 0.0;
    const double trimming = has_moment_ ? sum_of_sources(model_, "pitch_moment", seen) : 0.0;
    const double ground_drag = has_drag_ ? std::copysign(sum_of_sources(model_, "drag_force", seen), forward) : 0.0;
    const Environment& water = model_.environment;
    const double drag_u = drag(model_.drag_surge, water, u);
    const double vertical = model_.vehicle.net_weight - lift;  // down
    double fx = jets.force[0] - vertical * st - drag_u - ground_drag * ct;
    double fy = jets.force[1] - drag(model_.drag_sway, water, v);
    double fz = jets.force[2] + vertical * ct - drag(model_.drag_heave, water, w) - ground_drag * st;
    double mx = jets.moment[0];
    // Lift and ground drag act at the centre of the base, depth_ below the centre of gravity.
    double my = jets.moment[1] - buoyancy_ * model_.vehicle.buoyancy_height * st - drag(model_.drag_pitch, water, q) +
                model_.vehicle.drag_height * drag_u + trimming + depth_ * (lift * st - ground_drag * ct);
    double mz = jets.moment[2] - drag(model_.drag_yaw, water, r);
    for (int edge = 0; edge < 2; ++edge) {
        const double n = normal[static_cast<std::size_t>(edge)];
        if (n == 0) {
            continue;
        }
        const double rx = edge == 0 ? half_length_ : -half_length_, rz = depth_;
        // Slip of the contact point along the ground, in the vehicle's heading.
        const double vx = u + q * rz, vy = v + r * rx - p * rz, vz = w - q * rx;
        const double sx = vx * ct + vz * st, sy = vy;
        const double size = std::sqrt(sx * sx + sy * sy + model_.contact.slip_speed * model_.contact.slip_speed);
        const double ft = -model_.contact.friction * n * sx / size, fs = -model_.contact.friction * n * sy / size;
        const double cx = n * st + ft * ct, cz = -n * ct + ft * st;
        fx += cx;
        fy += fs;
        fz += cz;
        mx += -rz * fs;
        my += rz * cx - rx * cz;
        mz += rx * fs;
    }
    out[0] = (fx + sy_ * r * v - sz_ * q * w) / sx_;
    out[1] = (fy - sx_ * r * u + sz_ * p * w) / sy_;
    out[2] = (fz + sx_ * q * u - sy_ * p * v) / sz_;
    out[3] = (my + (az_ - ax_) * u * w + (sr_ - sp_) * p * r) / sq_;
    // The moment K (1, 0, tan theta) that holds roll at zero does no work.
    const double k0 = mx + (ay_ - az_) * v * w + (sq_ - sr_) * q * r;
    const double n0 = mz + (ax_ - ay_) * u * v + (sp_ - sq_) * p * q;
    out[4] = (n0 - tt * (k0 + sp_ * r * q / (ct * ct))) / (sr_ + sp_ * tt * tt);
}

std::array<double, 2> RigidBody::gap_accelerations(const BodyState& y, const double* a) const {
    const double st = std::sin(y[state_theta]), ct = std::cos(y[state_theta]), q = y[state_q];
    const double down = -a[0] * st - y[state_u] * ct * q + a[2] * ct - y[state_w] * st * q;
    const double common = -down + depth_ * (st * a[3] + ct * q * q);
    const double turn = half_length_ * (ct * a[3] - st * q * q);
    return {common + turn, common - turn};
}

ContactProblem RigidBody::problem(const BodyState& y, std::span<const double> thrust) const {
    double free[5], pushed[5];
    ContactProblem p;
    accelerations(y, thrust, {0, 0}, free);
    p.rest = gap_accelerations(y, free);
    for (std::size_t edge = 0; edge < 2; ++edge) {
        accelerations(y, thrust, edge == 0 ? std::array<double, 2>{1, 0} : std::array<double, 2>{0, 1}, pushed);
        const std::array<double, 2> with = gap_accelerations(y, pushed);
        for (std::size_t i = 0; i < 2; ++i) {
            p.matrix[i][edge] = with[i] - p.rest[i];
        }
    }
    return p;
}

std::array<double, 2> RigidBody::normal_forces(const BodyState& y, std::span<const double> thrust,
                                               ContactState bearing) const {
    return bearing == ContactState::free ? std::array<double, 2>{0, 0} : holding_forces(problem(y, thrust), bearing);
}

void RigidBody::rate(const BodyState& y, std::span<const double> thrust, ContactState bearing, BodyState& d) const {
    double a[5];
    std::array<double, 2> normal{0, 0};
    if (bearing != ContactState::free) {
        ContactProblem p = problem(y, thrust);
        // Rounding would let a held edge drift off or into the ground: drawn back within a twentieth of a second.
        const std::array<double, 2> gaps = edge_gaps(y), speeds = edge_speeds(y);
        for (std::size_t i = 0; i < 2; ++i) {
            p.rest[i] += 40 * speeds[i] + 400 * gaps[i];
        }
        normal = holding_forces(p, bearing);
    }
    accelerations(y, thrust, normal, a);
    d[state_u] = a[0];
    d[state_v] = a[1];
    d[state_w] = a[2];
    d[state_q] = a[3];
    d[state_r] = a[4];
    d[state_theta] = y[state_q];
    d[state_psi] = y[state_r] / std::cos(y[state_theta]);
    const Vector3 velocity = world_velocity(y);
    d[state_x] = velocity[0];
    d[state_y] = velocity[1];
    d[state_z] = velocity[2];
}

ContactState RigidBody::settle(const BodyState& y, std::span<const double> thrust, ContactState touching) const {
    if (touching == ContactState::free) {
        return touching;
    }
    const std::optional<ContactState> state = contact_state(problem(y, thrust), touching);
    if (!state) {
        throw core::Error("contact", "no contact forces fit this motion (friction and tipping contradict each other)",
                          {}, "less friction, a lower centre of gravity, or a longer base");
    }
    return *state;
}

BodyState RigidBody::impact(const BodyState& y, ContactState touching) const {
    // Impulses act as forces do, without friction: the speeds of the gaps jump by the same matrix.
    BodyState still = y;
    for (const BodyStateIndex i : {state_u, state_v, state_w, state_q, state_r}) {
        still[i] = 0;
    }
    Model smooth = model_;
    smooth.contact.friction = 0;
    RigidBody frictionless(smooth, held_);
    const std::vector<double> none(model_.jets.size(), 0.0);
    ContactProblem p = frictionless.problem(still, none);
    double free[5], pushed[5];
    frictionless.accelerations(still, none, {0, 0}, free);
    p.rest = edge_speeds(y);
    const auto impulses = impact_impulses(p, touching, model_.contact.restitution);
    if (!impulses) {
        throw core::Error("contact", "no impulse fits this impact");
    }
    frictionless.accelerations(still, none, *impulses, pushed);
    BodyState after = y;
    after[state_u] += pushed[0] - free[0];
    after[state_v] += pushed[1] - free[1];
    after[state_w] += pushed[2] - free[2];
    after[state_q] += pushed[3] - free[3];
    after[state_r] += pushed[4] - free[4];
    return after;
}

LinearSystem linearise_body(const RigidBody& body, const BodyState& trim, const std::vector<double>& thrust) {
    std::vector<std::string> inputs;
    for (const Jet& jet : body.jets()) {
        inputs.push_back(jet.name);
    }
    const auto rate = [&](const double* x, const double* u, double* out) {
        BodyState y{}, d{};
        std::copy(x, x + y.size(), y.begin());
        body.rate(y, {u, thrust.size()}, ContactState::free, d);
        std::copy(d.begin(), d.end(), out);
    };
    return linearise(rate, {trim.begin(), trim.end()}, thrust, body_state_names(), inputs,
                     {0.3, 0.1, 0.05, 0.1, 0.1, 0.1, 0.1, 1, 1, 0.01}, std::vector<double>(thrust.size(), 0.05));
}

}  // namespace underbody::dynamics
