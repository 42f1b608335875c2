#include "surrogates/dynamics/simulate/heave_pitch.h"

#include <algorithm>
#include <cmath>

#include "core/no_limit.h"
#include "surrogates/dynamics/model/drag.h"
#include "surrogates/dynamics/model/matrix_algebra.h"

namespace underbody::dynamics {

namespace {

double needed(double value, const char* name, const Model& model) {
    if (std::isnan(value)) {
        throw core::InputError("missing", std::string("motion in pitch needs vehicle.") + name,
                               {model.name, {}, {}, {}});
    }
    return value;
}

double limited(double value, double limit) { return limit > 0 ? std::clamp(value, -limit, limit) : value; }

}  // namespace

HeavePitch::HeavePitch(const Model& declared, const Conditions& given, const std::vector<Channel>& varying)
    : held_(given.over(declared.conditions).over(references_of(declared))),
      vertical_(vertical_channel(declared.resolved(), held_, varying)) {
    const Model model = declared.resolved();
    const Vehicle& v = model.vehicle;
    inertia_ = needed(v.pitch_inertia, "pitch_inertia", model) + v.added_inertia_pitch;
    depth_ = needed(v.base_depth, "base_depth", model);
    forward_ = v.base_centre()[0];
    half_length_ = needed(v.base_half_length, "base_half_length", model);
    buoyancy_ = v.mass * model.environment.gravity - v.net_weight;
    buoyancy_centre_ = v.buoyancy_centre();
    friction_ = model.contact.friction;
    restitution_ = model.contact.restitution;
    speed_ = held_.get(Channel::speed, 0.0);
    const PitchTerms& effects = vertical_.terms.pitch;
    inertia_ += effects.inertia;
    if (!(inertia_ > 0)) {
        throw core::InputError("range", "the inertia in pitch is not positive", {model.name, {}, {}, {}},
                               "vehicle.pitch_inertia + vehicle.added_inertia_pitch + effects must be positive");
    }
    forward_ -= effects.mass_forward;
    buoyancy_centre_[0] -= effects.mass_forward;
    input_ = vertical_.held_input();
    drag_pitch_ = model.drag_pitch;
    water_ = model.environment;
    drag_moment_ = v.drag_height * drag(model.drag_surge, water_, speed_);
    std::vector<Channel> all = varying;
    for (const Channel state : {Channel::gap, Channel::heave_velocity, Channel::pitch, Channel::pitch_rate}) {
        all.push_back(state);
    }
    lift_ = ForceSources(model, "lift_force", held_, all);
    moment_ = ForceSources(model, "pitch_moment", held_, all);
    if (speed_ != 0) {
        drag_ = ForceSources(model, "drag_force", held_, all);
    }
    table_lower_ = std::max({-core::no_limit, lift_.lower(Channel::gap), moment_.lower(Channel::gap)});
    table_upper_ = std::min({core::no_limit, lift_.upper(Channel::gap), moment_.upper(Channel::gap)});
    pitch_lower_ = std::max({-core::no_limit, lift_.lower(Channel::pitch), moment_.lower(Channel::pitch)});
    pitch_upper_ = std::min({core::no_limit, lift_.upper(Channel::pitch), moment_.upper(Channel::pitch)});
    contact_gap_ = vertical_.terms.contact_gap;
}

Conditions HeavePitch::seen(const PitchState& y, const Surroundings& around) const {
    Conditions conditions = held_;
    if (around.channels) {
        std::copy(around.channels, around.channels + channel_count, conditions.value.begin());
    }
    conditions[Channel::gap] = y[0];
    conditions[Channel::heave_velocity] = y[1];
    conditions[Channel::pitch] = y[2];
    conditions[Channel::pitch_rate] = y[3];
    return conditions;
}

void HeavePitch::table_loads(const PitchState& y, const Surroundings& around, double& lift, double& moment) const {
    const Conditions conditions = seen(y, around);
    lift = vertical_.roughened(lift_(conditions), y[0]);
    moment = moment_(conditions);
}

void HeavePitch::forces(const PitchState& y, const Surroundings& around, bool waves, Loads& loads) const {
    const Conditions conditions = seen(y, around);
    const HeaveMoment moment{around.t, input_force(y, around), nullptr, conditions.value.data()};
    const double st = std::sin(y[2]), ct = std::cos(y[2]), reach = depth_ * st + forward_ * ct, w = centre_velocity(y);
    const double up = vertical_.roughened(lift_(conditions), y[0]);
    loads.force =
        up + vertical_.other_force(y[0], w, moment, around.memory) - vertical_.water_drag(w - vertical_.terms.current);
    loads.moment = moment_(conditions) + reach * up +
                   buoyancy_ * (buoyancy_centre_[2] * st + buoyancy_centre_[0] * ct) + drag_moment_ -
                   drag(drag_pitch_, water_, y[3]);
    if (!drag_.empty()) {
        // Tables give moments about the centre of the base: their drag, which something else balances, turns the body.
        loads.moment -= (depth_ * ct - forward_ * st) * std::copysign(drag_(conditions), speed_);
    }
    vertical_.terms.pitch.add_loads(y[0], y[2], y[3], moment.input * (1 - vertical_.terms.thrust_lost(y[0])), reach,
                                    loads.force, loads.moment);
    loads.force += around.force;
    loads.moment += around.moment;
    if (waves) {
        loads.force += vertical_.timed_force(around.t);
    }
    double slope = 0;
    loads.mass = vertical_.inertia(y[0], slope) + (around.memory ? vertical_.history_mass() : 0);
    if (slope != 0) {
        loads.force += slope * w * (0.5 * w - y[1]);
        loads.moment += 0.5 * slope * w * w * reach;
    }
    if (feedback_) {
        double turn = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            turn -= feedback_->moment_gain[i] * (y[i] - feedback_->reference[i]);
        }
        loads.moment += limited(turn, feedback_->moment_limit);
    }
}

void HeavePitch::close_loop(const PitchFeedback& feedback) {
    feedback_ = feedback;
    if (!vertical_.terms.actuator.ideal()) {
        vertical_.loop = HeaveFeedback{};  // inputs are commands now: the actuator acts on their sum with the feedback
        input_ = vertical_.held_input();
    }
}

double HeavePitch::force_command(const PitchState& y) const {
    double force = 0;
    for (std::size_t i = 0; feedback_ && i < 4; ++i) {
        force -= feedback_->force_gain[i] * (y[i] - feedback_->reference[i]);
    }
    return feedback_ ? limited(force, feedback_->force_limit) : 0;
}

/// What reaches the body of recorded or held input and feedback, N.
double HeavePitch::input_force(const PitchState& y, const Surroundings& around) const {
    const bool given = !std::isnan(around.input);
    if (vertical_.loop_has_states() && given) {
        return around.input;  // the integrator carries the actuator's states
    }
    const double sum = (given ? around.input : input_) + force_command(y);
    return vertical_.loop ? vertical_.terms.actuator.felt(sum) : sum;
}

void HeavePitch::statics(double gap, double pitch, double& force, double& moment) const {
    Loads loads;
    forces({gap, 0, pitch, 0}, {}, false, loads);
    force = loads.force;
    moment = loads.moment;
}

double HeavePitch::kinetic_energy(const PitchState& y) const {
    const double w = centre_velocity(y);
    return 0.5 * (virtual_mass(y[0]) * w * w + inertia_ * y[3] * y[3]);
}

void HeavePitch::accelerations(const PitchState& y, const Loads& loads, const std::array<double, 2>& normal, double& up,
                               double& turn) const {
    const double st = std::sin(y[2]), ct = std::cos(y[2]);
    double force = loads.force, moment = loads.moment;
    for (std::size_t edge = 0; edge < 2; ++edge) {
        const double n = normal[edge], rx = forward_ + (edge == 0 ? half_length_ : -half_length_);
        if (n == 0) {
            continue;
        }
        // Sliding friction of the run over the ground, against the speed: it turns the nose down.
        const double friction = speed_ == 0 ? 0.0 : -std::copysign(friction_ * n, speed_);
        force += n;
        moment += n * (rx * ct + depth_ * st) + friction * (depth_ * ct - rx * st);
    }
    up = force / loads.mass;
    turn = moment / inertia_;
}

std::array<double, 2> HeavePitch::edge_gaps(const PitchState& y) const {
    const double h = y[0] - contact_gap_, rise = half_length_ * std::sin(y[2]);
    return {h + rise, h - rise};
}

std::array<double, 2> HeavePitch::edge_speeds(const PitchState& y) const {
    const double up = y[1], turn = half_length_ * std::cos(y[2]) * y[3];
    return {up + turn, up - turn};
}

ContactProblem HeavePitch::problem(const PitchState& y, const Loads& loads) const {
    const double st = std::sin(y[2]), ct = std::cos(y[2]), q = y[3];
    const auto gaps = [&](const std::array<double, 2>& normal) {
        double up = 0, turn = 0;
        accelerations(y, loads, normal, up, turn);
        const double common = up + arm(y[2]) * turn + arm_slope(y[2]) * q * q,
                     side = half_length_ * (ct * turn - st * q * q);
        return std::array<double, 2>{common + side, common - side};
    };
    ContactProblem p;
    p.rest = gaps({0, 0});
    for (std::size_t edge = 0; edge < 2; ++edge) {
        const std::array<double, 2> with = gaps(edge == 0 ? std::array<double, 2>{1, 0} : std::array<double, 2>{0, 1});
        for (std::size_t i = 0; i < 2; ++i) {
            p.matrix[i][edge] = with[i] - p.rest[i];
        }
    }
    return p;
}

std::array<double, 2> HeavePitch::normal_forces(const PitchState& y, ContactState bearing,
                                                const Surroundings& around) const {
    if (bearing == ContactState::free) {
        return {0, 0};
    }
    Loads loads;
    forces(y, around, true, loads);
    return holding_forces(problem(y, loads), bearing);
}

void HeavePitch::rate(const PitchState& y, ContactState bearing, PitchState& d, const Surroundings& around) const {
    Loads loads;
    forces(y, around, true, loads);
    std::array<double, 2> normal{0, 0};
    if (bearing != ContactState::free) {
        ContactProblem p = problem(y, loads);
        const std::array<double, 2> gaps = edge_gaps(y), speeds = edge_speeds(y);
        for (std::size_t i = 0; i < 2; ++i) {
            p.rest[i] += 40 * speeds[i] + 400 * gaps[i];  // draws a held edge back onto the ground
        }
        normal = holding_forces(p, bearing);
    }
    d[0] = y[1];
    d[2] = y[3];
    accelerations(y, loads, normal, d[1], d[3]);
    d[1] += arm(y[2]) * d[3] + arm_slope(y[2]) * y[3] * y[3];
}

ContactState HeavePitch::settle(const PitchState& y, ContactState touching, const Surroundings& around) const {
    if (touching == ContactState::free) {
        return touching;
    }
    Loads loads;
    forces(y, around, true, loads);
    const std::optional<ContactState> state = contact_state(problem(y, loads), touching);
    if (!state) {
        throw core::Error("contact", "no contact forces fit this motion (friction and tipping contradict each other)",
                          {}, "less friction, a lower centre of gravity, or a longer base");
    }
    return *state;
}

PitchState HeavePitch::impact(const PitchState& y, ContactState touching) const {
    const double st = std::sin(y[2]), ct = std::cos(y[2]), mass = virtual_mass(y[0]);
    // The run over the ground goes on through the impact: it slides, and friction turns the nose down as in contact.
    for (const double friction : {speed_ == 0 ? 0.0 : -std::copysign(friction_, speed_), 0.0}) {
        ContactProblem p;
        p.rest = edge_speeds(y);
        std::array<double, 2> lever{}, turn{};  // how an edge moves with q; moment of a unit impulse at it
        for (std::size_t e = 0; e < 2; ++e) {
            const double rx = forward_ + (e == 0 ? half_length_ : -half_length_);
            lever[e] = rx * ct + depth_ * st;
            turn[e] = lever[e] + friction * (depth_ * ct - rx * st);
        }
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t j = 0; j < 2; ++j) {
                p.matrix[i][j] = 1 / mass + lever[i] * turn[j] / inertia_;
            }
        }
        if (const auto impulses = impact_impulses(p, touching, restitution_)) {
            PitchState after = y;
            const double spin = ((*impulses)[0] * turn[0] + (*impulses)[1] * turn[1]) / inertia_;
            after[1] += ((*impulses)[0] + (*impulses)[1]) / mass + arm(y[2]) * spin;
            after[3] += spin;
            return after;
        }
    }
    throw core::Error("contact", "no impulse fits this impact");
}

LinearSystem HeavePitch::linearised(double gap, double pitch) const {
    if (vertical_.terms.friction != 0) {
        HeavePitch without = *this;
        without.vertical_.terms.friction = 0;
        return without.linearised(gap, pitch);
    }
    const auto rate_of = [&](const double* x, const double* u, double* out) {
        const PitchState y{x[0], x[1], x[2], x[3]};
        PitchState d{};
        rate(y, ContactState::free, d);
        std::copy(d.begin(), d.end(), out);
        const double turn = vertical_.terms.pitch.moment_gain * u[1] / inertia_;
        out[1] += u[0] / virtual_mass(x[0]) + arm(x[2]) * turn;
        out[3] += turn;
    };
    return linearise(rate_of, {gap, 0, pitch, 0}, {0, 0}, {"gap", "heave_velocity", "pitch", "pitch_rate"},
                     {"input_force", "input_moment"}, {1e-2, 1e-3, 1e-2, 1e-3}, {1e-2, 1e-3}, 1e-3);
}

std::vector<HeaveEquilibrium> HeavePitch::equilibria() const {
    const double low = std::max(contact_gap_, core::is_limit(table_lower_) ? table_lower_ : contact_gap_),
                 high = core::is_limit(table_upper_) ? table_upper_ : low + 1;
    const double left = std::max(pitch_lower_, -0.5), right = std::min(pitch_upper_, 0.5);
    constexpr double found_to = 1e-11, same_place = 1e-6;  // of the ranges
    std::vector<HeaveEquilibrium> found;
    const double size_h = high - low, size_p = right - left;
    // Newton from a grid of starts; steps kept within the tables.
    for (int i = 0; i <= 60; ++i) {
        for (int j = 0; j <= 12; ++j) {
            double h = low + size_h * std::pow(i / 60.0, 2), p = left + size_p * j / 12;
            bool good = false;
            for (int step = 0; step < 40 && !good; ++step) {
                const double dh = 1e-6 * size_h, dp = 1e-6 * size_p;
                double f = 0, m = 0, fh = 0, mh = 0, fp = 0, mp = 0, f2 = 0, m2 = 0;
                statics(h, p, f, m);
                statics(h + dh, p, fh, mh);
                statics(h - dh, p, f2, m2);
                fh = (fh - f2) / (2 * dh);
                mh = (mh - m2) / (2 * dh);
                statics(h, p + dp, fp, mp);
                statics(h, p - dp, f2, m2);
                fp = (fp - f2) / (2 * dp);
                mp = (mp - m2) / (2 * dp);
                const double determinant = fh * mp - fp * mh;
                if (!(std::abs(determinant) > core::least_divisor)) {
                    break;
                }
                const double sh = std::clamp((-f * mp + m * fp) / determinant, -0.1 * size_h, 0.1 * size_h);
                const double sp = std::clamp((-m * fh + f * mh) / determinant, -0.1 * size_p, 0.1 * size_p);
                h += sh;
                p += sp;
                if (h < low || h > high || p < left || p > right) {
                    break;
                }
                good = std::abs(sh) < found_to * size_h && std::abs(sp) < found_to * size_p;
            }
            const double rise = half_length_ * std::abs(std::sin(p));
            const bool known = std::any_of(found.begin(), found.end(), [&](const HeaveEquilibrium& e) {
                return std::abs(e.gap - h) < same_place * size_h && std::abs(e.pitch - p) < same_place * size_p;
            });
            if (good && !known && h - contact_gap_ > rise) {
                HeaveEquilibrium e;
                e.gap = h;
                e.pitch = p;
                found.push_back(e);
            }
        }
    }
    std::sort(found.begin(), found.end(),
              [](const HeaveEquilibrium& l, const HeaveEquilibrium& r) { return l.gap < r.gap; });
    int stable = 0, unstable = 0;
    for (HeaveEquilibrium& e : found) {
        const LinearSystem system = linearised(e.gap, e.pitch);
        double worst = -core::no_limit, slowest = core::no_limit, damping = 0;
        for (const EigenPair& mode : eigen(system.a)) {
            worst = std::max(worst, mode.value.real());
            if (mode.value.imag() > 0 && std::abs(mode.value) < slowest) {
                slowest = std::abs(mode.value);
                damping = -mode.value.real() / slowest;
            }
        }
        e.stable = worst < no_growth;
        e.stiffness = -system.a(1, 0) * virtual_mass(e.gap);
        e.frequency = e.stable && core::is_limit(slowest) ? slowest : 0;
        e.damping_ratio = e.stable ? damping : 0;
        e.growth = e.stable ? 0 : worst;
        e.name = e.stable ? std::string(1, static_cast<char>('A' + std::min(stable++, 25)))
                          : "U" + std::to_string(++unstable);
    }
    return found;
}

}  // namespace underbody::dynamics
