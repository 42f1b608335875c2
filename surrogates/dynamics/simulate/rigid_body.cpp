#include "surrogates/dynamics/simulate/rigid_body.h"

#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/model/drag.h"
#include "surrogates/dynamics/plant/acting_jets.h"

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

RigidBody::RigidBody(const Model& declared, const Conditions& held, const std::vector<Channel>& varying)
    : model_(declared.resolved()),
      held_(held.over(declared.conditions)),
      vertical_(vertical_channel(model_, held_, varying)) {
    const Vehicle& v = model_.vehicle;
    mass_x_ = v.mass + v.added_mass_surge;
    mass_y_ = v.mass + v.added_mass_sway;
    inertia_[0][0] = needed(v.roll_inertia, "roll_inertia", model_) + v.added_inertia_roll;
    inertia_[1][1] = needed(v.pitch_inertia, "pitch_inertia", model_) + v.added_inertia_pitch;
    inertia_[2][2] = needed(v.yaw_inertia, "yaw_inertia", model_) + v.added_inertia_yaw;
    inertia_[0][1] = inertia_[1][0] = -v.inertia_product_xy;
    inertia_[0][2] = inertia_[2][0] = -v.inertia_product_xz;
    inertia_[1][2] = inertia_[2][1] = -v.inertia_product_yz;
    needed(v.base_depth, "base_depth", model_);
    base_ = v.base_centre();
    half_length_ = needed(v.base_half_length, "base_half_length", model_);
    buoyancy_ = v.mass * model_.environment.gravity - v.net_weight;
    buoyancy_centre_ = v.buoyancy_centre();
    contact_gap_ = vertical_.terms.contact_gap;
    inertia_[1][1] += vertical_.terms.pitch.inertia;
    if (!(inertia_[1][1] > 0)) {
        throw core::InputError("range", "the inertia in pitch is not positive", {model_.name, {}, {}, {}},
                               "vehicle.pitch_inertia + vehicle.added_inertia_pitch + effects must be positive");
    }
    model_.contact.friction = std::max(0.0, model_.contact.friction + vertical_.terms.surface.friction);
    acting_ = acting_jets(model_.jets, vertical_.terms.surface);
    const std::array<double, 2> offset = mass_offset();  // all places are from the centre of gravity
    for (std::size_t axis = 0; axis < offset.size(); ++axis) {
        base_[axis] -= offset[axis];
        buoyancy_centre_[axis] -= offset[axis];
        for (Jet& jet : acting_) {
            jet.position[axis] -= offset[axis];
        }
    }
    std::vector<Channel> all = varying;
    for (const Channel state :
         {Channel::gap, Channel::heave_velocity, Channel::pitch, Channel::pitch_rate, Channel::speed}) {
        all.push_back(state);
    }
    lift_ = ForceSources(model_, "lift_force", held_, all);
    drag_ = ForceSources(model_, "drag_force", held_, all);
    side_ = ForceSources(model_, "side_force", held_, all);
    roll_moment_ = ForceSources(model_, "roll_moment", held_, all);
    pitch_moment_ = ForceSources(model_, "pitch_moment", held_, all);
    yaw_moment_ = ForceSources(model_, "yaw_moment", held_, all);
}

/// Everything but contact, and the virtual mass in heave at this gap.
struct RigidBody::Loads {
    Vector3 force{}, moment{};
    double mass_z = 1;
    /// A force at a place, both in body axes.
    void add(const Vector3& at, const Vector3& f) {
        const Vector3 turn = cross(at, f);
        for (std::size_t k = 0; k < 3; ++k) {
            force[k] += f[k];
            moment[k] += turn[k];
        }
    }
};

double RigidBody::roll_rate(const BodyState& y) const { return -y[state_r] * std::tan(y[state_theta]); }

double RigidBody::kinetic_energy(const BodyState& y) const {
    const double turn[3] = {roll_rate(y), y[state_q], y[state_r]};
    double slope = 0;
    const double mass_z = vertical_.inertia(gap_at_base_centre(y), slope);
    double sum =
        mass_x_ * y[state_u] * y[state_u] + mass_y_ * y[state_v] * y[state_v] + mass_z * y[state_w] * y[state_w];
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            sum += turn[i] * inertia_[i][j] * turn[j];
        }
    }
    return 0.5 * sum;
}

Vector3 RigidBody::world_velocity(const BodyState& y) {
    const double st = std::sin(y[state_theta]), ct = std::cos(y[state_theta]);
    const double sp = std::sin(y[state_psi]), cp = std::cos(y[state_psi]);
    const double u = y[state_u], v = y[state_v], w = y[state_w];
    return {u * cp * ct - v * sp + w * cp * st, u * sp * ct + v * cp + w * sp * st, -u * st + w * ct};
}

double RigidBody::height_for_gap(double gap, double theta) const {
    return -gap + base_[0] * std::sin(theta) - base_[2] * std::cos(theta);
}
double RigidBody::gap_at_base_centre(const BodyState& y) const {
    return -y[state_z] + base_[0] * std::sin(y[state_theta]) - base_[2] * std::cos(y[state_theta]);
}

double RigidBody::rise_of_base(const BodyState& y) const {
    const double st = std::sin(y[state_theta]), ct = std::cos(y[state_theta]);
    return y[state_u] * st - y[state_w] * ct + (base_[2] * st + base_[0] * ct) * y[state_q];
}
double RigidBody::down_velocity_for(double heave_velocity, const BodyState& y) const {
    const double st = std::sin(y[state_theta]), ct = std::cos(y[state_theta]);
    const double rise = heave_velocity - (base_[2] * st + base_[0] * ct) * y[state_q];
    return (y[state_u] * st - rise) / ct;
}

std::array<double, 2> RigidBody::edge_gaps(const BodyState& y) const {
    const double h = gap_at_base_centre(y) - contact_gap_, rise = half_length_ * std::sin(y[state_theta]);
    return {h + rise, h - rise};
}

std::array<double, 2> RigidBody::edge_speeds(const BodyState& y) const {
    const double ct = std::cos(y[state_theta]);
    const double up = rise_of_base(y), turn = half_length_ * ct * y[state_q];
    return {up + turn, up - turn};
}

Conditions RigidBody::seen(const BodyState& y, const Surroundings& around) const {
    Conditions conditions = held_;
    if (around.channels) {
        std::copy(around.channels, around.channels + channel_count, conditions.value.begin());
    }
    conditions[Channel::gap] = gap_at_base_centre(y);
    conditions[Channel::pitch] = y[state_theta];
    conditions[Channel::heave_velocity] = rise_of_base(y);
    conditions[Channel::pitch_rate] = y[state_q];
    conditions[Channel::speed] = y[state_u] * std::cos(y[state_theta]) + y[state_w] * std::sin(y[state_theta]);
    return conditions;
}

RigidBody::TableLoads RigidBody::table_loads(const BodyState& y, const Surroundings& around) const {
    return table_loads(seen(y, around));
}

RigidBody::TableLoads RigidBody::table_loads(Conditions conditions) const {
    const double forward = conditions[Channel::speed];
    conditions[Channel::speed] = std::abs(forward);
    // Drag turns with the motion, smoothly through rest.
    const double sense = forward / std::sqrt(forward * forward + 1e-6);
    return {vertical_.roughened(lift_(conditions), conditions[Channel::gap]),
            drag_.empty() ? 0.0 : sense * drag_(conditions), pitch_moment_(conditions)};
}

bool RigidBody::outside_tables(const BodyState& y) const {
    const Conditions conditions = seen(y, {});
    for (const ForceSources* sources : {&lift_, &drag_, &side_, &roll_moment_, &pitch_moment_, &yaw_moment_}) {
        for (const Channel channel : {Channel::gap, Channel::pitch, Channel::speed}) {
            const double value = channel == Channel::speed ? std::abs(conditions[channel]) : conditions[channel];
            if (!sources->empty() && (value < sources->lower(channel) || value > sources->upper(channel))) {
                return true;
            }
        }
    }
    return false;
}

void RigidBody::add_effects(const BodyState& y, double input, double gap, Loads& loads) const {
    const double st = std::sin(y[state_theta]), ct = std::cos(y[state_theta]);
    const SurfaceTerms& terms = vertical_.terms.surface;
    double ahead = 0, aside = 0;
    if (terms.pull_x != 0 || terms.pull_y != 0) {
        const double cp = std::cos(y[state_psi]), sp = std::sin(y[state_psi]);
        ahead = terms.pull_x * cp + terms.pull_y * sp;
        aside = terms.pull_y * cp - terms.pull_x * sp;
    }
    loads.add({0, -terms.mass_aside, 0}, {ahead * ct - terms.surge * y[state_u], 0, ahead * st});
    loads.add({}, {0, aside - terms.sway * y[state_v], 0});
    loads.moment[2] += terms.moment - terms.yaw * y[state_r];
    double up = 0;
    vertical_.terms.pitch.add_loads(gap, y[state_theta], y[state_q], input * (1 - vertical_.terms.thrust_lost(gap)),
                                    base_[0] * ct + base_[2] * st, up, loads.moment[1]);
    loads.add({}, {up * st, 0, -up * ct});
}

void RigidBody::free_loads(const BodyState& y, std::span<const double> thrust, const Surroundings& around,
                           Loads& loads) const {
    const double u = y[state_u], v = y[state_v], w = y[state_w], q = y[state_q], r = y[state_r];
    const double st = std::sin(y[state_theta]), ct = std::cos(y[state_theta]);
    // Forces along the ground in the heading, and up, in body axes.
    const auto along = [&](double f) { return Vector3{f * ct, 0, f * st}; };
    const auto up = [&](double f) { return Vector3{f * st, 0, -f * ct}; };
    const Wrench jets = jet_wrench(acting_, thrust);
    loads.force = jets.force;
    loads.moment = jets.moment;
    Conditions conditions = seen(y, around);
    const TableLoads tables = table_loads(conditions);
    conditions[Channel::speed] = std::abs(conditions[Channel::speed]);
    loads.add(base_, up(tables.lift));
    loads.add(base_, along(-tables.drag));
    loads.add(base_, {0, side_(conditions), 0});
    loads.moment[0] += roll_moment_(conditions);
    loads.moment[1] += tables.moment;
    loads.moment[2] += yaw_moment_(conditions);
    // Weight less buoyancy and the effects act at the centre of gravity; buoyancy off it turns the body.
    const double gap = conditions[Channel::gap], rise = u * st - w * ct;
    const HeaveMoment moment{around.t, std::isnan(around.input) ? vertical_.held_input() : around.input, nullptr,
                             conditions.value.data()};
    loads.add({}, up(vertical_.other_force(gap, rise, moment, around.memory) + vertical_.timed_force(around.t)));
    const Vector3 upright = cross(buoyancy_centre_, up(buoyancy_));
    for (std::size_t k = 0; k < 3; ++k) {
        loads.moment[k] += upright[k];
    }
    // Water that rises with its current moves past the body along both of its axes.
    const Environment& water = model_.environment;
    const double current = vertical_.terms.current;
    const double drag_u = drag(model_.drag_surge, water, u - current * st);
    loads.add({0, -mass_offset()[1], 0}, {-drag_u, 0, 0});
    loads.add({}, {0, -drag(model_.drag_sway, water, v), -vertical_.water_drag(w + current * ct)});
    loads.moment[1] += model_.vehicle.drag_height * drag_u - drag(model_.drag_pitch, water, q);
    loads.moment[2] -= drag(model_.drag_yaw, water, r);
    add_effects(y, moment.input, gap, loads);
    // Added mass over the gap: its momentum changes with the gap, and the body is pushed where it is larger.
    double slope = 0;
    loads.mass_z = vertical_.inertia(gap, slope) + (around.memory ? vertical_.history_mass() : 0);
    if (slope != 0) {
        loads.force[2] -= slope * conditions[Channel::heave_velocity] * w;
        loads.add(base_, up(0.5 * slope * w * w));
    }
}

/// Slip of an edge along the ground, in the vehicle's heading: forward, to starboard.
std::array<double, 2> RigidBody::slip(const BodyState& y, std::size_t edge) const {
    const double u = y[state_u], v = y[state_v], w = y[state_w], q = y[state_q], r = y[state_r], p = roll_rate(y);
    const Vector3 at = edge_place(edge);
    const double vx = u + q * at[2] - r * at[1], sy = v + r * at[0] - p * at[2], vz = w + p * at[1] - q * at[0];
    return {vx * std::cos(y[state_theta]) + vz * std::sin(y[state_theta]), sy};
}

void RigidBody::add_contact(const BodyState& y, const std::array<double, 2>& normal, double friction,
                            Loads& loads) const {
    const double st = std::sin(y[state_theta]), ct = std::cos(y[state_theta]);
    for (std::size_t edge = 0; edge < 2; ++edge) {
        const double n = normal[edge];
        if (n == 0) {
            continue;
        }
        const Vector3 at = edge_place(edge);
        const auto [sx, sy] = slip(y, edge);
        const double size = std::sqrt(sx * sx + sy * sy + model_.contact.slip_speed * model_.contact.slip_speed);
        const double ft = -friction * n * sx / size, fs = -friction * n * sy / size;
        loads.add(at, {n * st + ft * ct, fs, -n * ct + ft * st});
    }
}

/// du, dv, dw, dq, dr.
void RigidBody::accelerations(const BodyState& y, const Loads& loads, double* out) const {
    const double u = y[state_u], v = y[state_v], w = y[state_w], theta = y[state_theta];
    const double tt = std::tan(theta), ct = std::cos(theta);
    const Vector3 turn{-y[state_r] * tt, y[state_q], y[state_r]};
    const Vector3 momentum{mass_x_ * u, mass_y_ * v, loads.mass_z * w};
    const Vector3 swept = cross(turn, momentum);
    out[0] = (loads.force[0] - swept[0]) / mass_x_;
    out[1] = (loads.force[1] - swept[1]) / mass_y_;
    out[2] = (loads.force[2] - swept[2]) / loads.mass_z;
    Vector3 spin{};
    for (std::size_t i = 0; i < 3; ++i) {
        spin[i] = inertia_[i][0] * turn[0] + inertia_[i][1] * turn[1] + inertia_[i][2] * turn[2];
    }
    const Vector3 gyration = cross(turn, spin), munk = cross({u, v, w}, momentum);
    // p' = -r' tan(theta) - r q/cos^2(theta): what roll held at zero adds of itself.
    const double own = -turn[2] * turn[1] / (ct * ct);
    Vector3 rest{};
    for (std::size_t i = 0; i < 3; ++i) {
        rest[i] = loads.moment[i] - gyration[i] - munk[i] - inertia_[i][0] * own;
    }
    // Along the motions (0, 1, 0) and (-tan(theta), 0, 1) the moment K (1, 0, tan(theta)) that holds roll does no work.
    const double a11 = inertia_[1][1], a12 = inertia_[1][2] - tt * inertia_[0][1],
                 a22 = inertia_[2][2] - 2 * tt * inertia_[0][2] + tt * tt * inertia_[0][0];
    const double b1 = rest[1], b2 = rest[2] - tt * rest[0], determinant = a11 * a22 - a12 * a12;
    out[3] = (b1 * a22 - a12 * b2) / determinant;
    out[4] = (a11 * b2 - a12 * b1) / determinant;
}

std::array<double, 5> RigidBody::answer(const BodyState& y, const Wrench& wrench) const {
    BodyState still = y;
    for (const BodyStateIndex i : {state_u, state_v, state_w, state_q, state_r}) {
        still[i] = 0;
    }
    Loads loads;
    double slope = 0;
    loads.force = wrench.force;
    loads.moment = wrench.moment;
    loads.mass_z = vertical_.inertia(gap_at_base_centre(y), slope);
    std::array<double, 5> out{};
    accelerations(still, loads, out.data());
    return out;
}

std::array<double, 2> RigidBody::gap_accelerations(const BodyState& y, const double* a) const {
    const double st = std::sin(y[state_theta]), ct = std::cos(y[state_theta]), q = y[state_q];
    const double down = -a[0] * st - y[state_u] * ct * q + a[2] * ct - y[state_w] * st * q;
    const double common = -down + (base_[2] * st + base_[0] * ct) * a[3] + (base_[2] * ct - base_[0] * st) * q * q;
    const double turn = half_length_ * (ct * a[3] - st * q * q);
    return {common + turn, common - turn};
}

ContactProblem RigidBody::problem(const BodyState& y, const Loads& loads, double friction) const {
    double a[5];
    ContactProblem p;
    accelerations(y, loads, a);
    p.rest = gap_accelerations(y, a);
    for (std::size_t edge = 0; edge < 2; ++edge) {
        Loads pushed = loads;
        add_contact(y, edge == 0 ? std::array<double, 2>{1, 0} : std::array<double, 2>{0, 1}, friction, pushed);
        accelerations(y, pushed, a);
        const std::array<double, 2> with = gap_accelerations(y, a);
        for (std::size_t i = 0; i < 2; ++i) {
            p.matrix[i][edge] = with[i] - p.rest[i];
        }
    }
    return p;
}

std::array<double, 2> RigidBody::normal_forces(const BodyState& y, std::span<const double> thrust, ContactState bearing,
                                               const Surroundings& around) const {
    if (bearing == ContactState::free) {
        return {0, 0};
    }
    Loads loads;
    free_loads(y, thrust, around, loads);
    return holding_forces(problem(y, loads, model_.contact.friction), bearing);
}

void RigidBody::rate(const BodyState& y, std::span<const double> thrust, ContactState bearing, BodyState& d,
                     const Surroundings& around) const {
    double a[5];
    Loads loads;
    free_loads(y, thrust, around, loads);
    if (bearing != ContactState::free) {
        ContactProblem p = problem(y, loads, model_.contact.friction);
        // Rounding would let a held edge drift off or into the ground: drawn back within a twentieth of a second.
        const std::array<double, 2> gaps = edge_gaps(y), speeds = edge_speeds(y);
        for (std::size_t i = 0; i < 2; ++i) {
            p.rest[i] += 40 * speeds[i] + 400 * gaps[i];
        }
        add_contact(y, holding_forces(p, bearing), model_.contact.friction, loads);
    }
    accelerations(y, loads, a);
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

ContactState RigidBody::settle(const BodyState& y, std::span<const double> thrust, ContactState touching,
                               const Surroundings& around) const {
    if (touching == ContactState::free) {
        return touching;
    }
    Loads loads;
    free_loads(y, thrust, around, loads);
    const std::optional<ContactState> state = contact_state(problem(y, loads, model_.contact.friction), touching);
    if (!state) {
        throw core::Error("contact", "no contact forces fit this motion (friction and tipping contradict each other)",
                          {}, "less friction, a lower centre of gravity, or a longer base");
    }
    return *state;
}

std::optional<BodyState> RigidBody::struck(const BodyState& y, ContactState touching, double friction) const {
    // Impulses act as forces do: the speeds jump by the same matrix, friction along the slip before the impact.
    BodyState still = y;
    for (const BodyStateIndex i : {state_u, state_v, state_w, state_q, state_r}) {
        still[i] = 0;
    }
    Loads none;
    double slope = 0, jump[5];
    none.mass_z = vertical_.inertia(gap_at_base_centre(y), slope) + vertical_.history_mass();
    ContactProblem p;
    p.rest = edge_speeds(y);
    for (std::size_t edge = 0; edge < 2; ++edge) {
        Loads pushed = none;
        add_contact(y, edge == 0 ? std::array<double, 2>{1, 0} : std::array<double, 2>{0, 1}, friction, pushed);
        accelerations(still, pushed, jump);
        const std::array<double, 2> opened = gap_accelerations(still, jump);
        p.matrix[0][edge] = opened[0];
        p.matrix[1][edge] = opened[1];
    }
    const auto impulses = impact_impulses(p, touching, model_.contact.restitution);
    if (!impulses) {
        return {};
    }
    add_contact(y, *impulses, friction, none);
    accelerations(still, none, jump);
    BodyState after = y;
    for (const auto& [state, change] :
         {std::pair{state_u, jump[0]}, std::pair{state_v, jump[1]}, std::pair{state_w, jump[2]},
          std::pair{state_q, jump[3]}, std::pair{state_r, jump[4]}}) {
        after[state] += change;
    }
    for (std::size_t edge = 0; edge < 2; ++edge) {
        const std::array<double, 2> was = slip(y, edge), is = slip(after, edge);
        if ((*impulses)[edge] > 0 && friction > 0 && was[0] * is[0] + was[1] * is[1] < 0) {
            return {};  // friction stops a slip, it does not turn it round
        }
    }
    return after;
}

BodyState RigidBody::impact(const BodyState& y, ContactState touching) const {
    const double full = model_.contact.friction;
    if (const auto slides = struck(y, touching, full)) {
        return *slides;
    }
    // An edge sticks: the most friction that stops its slip and does not turn it.
    std::optional<BodyState> after = struck(y, touching, 0);
    if (!after) {
        throw core::Error("contact", "no impulse fits this impact");
    }
    double least = 0, most = full;
    for (int i = 0; i < 60 && most - least > 1e-12 * full; ++i) {
        const double middle = (least + most) / 2;
        const auto sticks = struck(y, touching, middle);
        (sticks ? least : most) = middle;
        after = sticks ? sticks : after;
    }
    return *after;
}

LinearSystem linearise_body(const RigidBody& body, const BodyState& trim, const std::vector<double>& thrust) {
    if (body.vertical().terms.friction != 0) {
        RigidBody without = body;
        without.leave_friction_out();
        return linearise_body(without, trim, thrust);
    }
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
