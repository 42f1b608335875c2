#include "surrogates/dynamics/heave_pitch.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "surrogates/dynamics/drag.h"

namespace underbody::dynamics {

namespace {

double needed(double value, const char* name, const Model& model) {
    if (std::isnan(value)) {
        throw core::InputError("missing", std::string("motion in pitch needs vehicle.") + name,
                               {model.name, {}, {}, {}});
    }
    return value;
}

double scale_factor(const ForceScale& scale, double value) {
    if (std::isnan(value)) {
        return 1;
    }
    const double above = std::max(0.0, std::abs(value) - scale.dead_band) / (scale.reference - scale.dead_band);
    return above > 0 ? std::pow(above, scale.exponent) : (scale.exponent == 0 ? 1.0 : 0.0);
}

}  // namespace

double HeavePitch::Source::value(double gap, double pitch) const {
    std::array<double, tables::max_axes> point = held;
    if (gap_axis >= 0) {
        point[static_cast<std::size_t>(gap_axis)] = gap;
    }
    if (pitch_axis >= 0) {
        point[static_cast<std::size_t>(pitch_axis)] = pitch;
    }
    return factor * table.value(point.data());
}

HeavePitch::HeavePitch(const Model& declared, const Conditions& given) {
    const Model model = declared.resolved();
    const Conditions held = given.over(model.conditions);
    const Vehicle& v = model.vehicle;
    mass_ = v.mass + v.added_mass_heave;
    inertia_ = needed(v.pitch_inertia, "pitch_inertia", model) + v.added_inertia_pitch;
    depth_ = needed(v.base_depth, "base_depth", model);
    half_length_ = needed(v.base_half_length, "base_half_length", model);
    weight_ = v.net_weight;
    buoyancy_ = v.mass * model.environment.gravity - v.net_weight;
    buoyancy_height_ = v.buoyancy_height;
    friction_ = model.contact.friction;
    restitution_ = model.contact.restitution;
    speed_ = held.get(Channel::speed, 0.0);
    input_ = held.get(Channel::input_force, 0.0);
    drag_heave_ = model.drag_heave;
    drag_pitch_ = model.drag_pitch;
    water_ = model.environment;
    drag_moment_ = v.drag_height * drag(model.drag_surge, water_, speed_);
    for (const ForceSource& source : model.forces) {
        if (source.quantity != "lift_force" && source.quantity != "pitch_moment") {
            continue;
        }
        Source compiled{source.table, source.factor, -1, -1, {}};
        bool jet = false;
        for (const ForceScale& scale : source.scales) {
            compiled.factor *= scale_factor(scale, held[scale.channel]);
            jet = jet || scale.channel == Channel::jet_voltage || scale.channel == Channel::jet_flow;
        }
        for (std::size_t i = 0; i < source.axes.size(); ++i) {
            const tables::TableAxis& axis = source.table.axes()[i];
            const Channel channel = source.axes[i];
            jet = jet || channel == Channel::jet_voltage || channel == Channel::jet_flow;
            if (channel == Channel::gap) {
                compiled.gap_axis = static_cast<int>(i);
                table_lower_ = std::max(table_lower_, axis.lower);
                table_upper_ = std::min(table_upper_, axis.upper);
            } else if (channel == Channel::pitch) {
                compiled.pitch_axis = static_cast<int>(i);
                pitch_lower_ = std::max(pitch_lower_, axis.lower);
                pitch_upper_ = std::min(pitch_upper_, axis.upper);
            } else if (held.has(channel)) {
                compiled.held[i] = held[channel];
            } else {
                throw core::InputError(
                    "missing",
                    std::string("nothing says the ") + channel_name(channel) + ", an axis of " + source.table_file,
                    {model.name, {}, {}, {}}, "give it as a condition, or under [conditions] in the model");
            }
        }
        if (jet && model.coupling.kind == Coupling::Kind::sheltered && speed_ != 0) {
            const double ratio = speed_ / model.coupling.limit_speed;
            compiled.factor /= 1 + ratio * ratio;
        }
        (source.quantity == "lift_force" ? lift_ : moment_).push_back(std::move(compiled));
    }
    contact_gap_ = std::isnan(model.contact.gap) ? 0.0 : model.contact.gap;
}

double HeavePitch::lift(double gap, double pitch) const {
    double sum = 0;
    for (const Source& source : lift_) {
        sum += source.value(gap, pitch);
    }
    return sum;
}

void HeavePitch::statics(double gap, double pitch, double& force, double& moment) const {
    const double up = lift(gap, pitch), st = std::sin(pitch);
    force = up - weight_ + input_;
    moment = depth_ * up * st - buoyancy_ * buoyancy_height_ * st + drag_moment_;
    for (const Source& source : moment_) {
        moment += source.value(gap, pitch);
    }
}

void HeavePitch::forces(const PitchState& y, Loads& loads) const {
    statics(y[0], y[2], loads.force, loads.moment);
    loads.force -= drag(drag_heave_, water_, y[1]);
    loads.moment -= drag(drag_pitch_, water_, y[3]);
}

void HeavePitch::accelerations(const PitchState& y, const std::array<double, 2>& normal, double& up,
                               double& turn) const {
    Loads loads;
    forces(y, loads);
    const double st = std::sin(y[2]), ct = std::cos(y[2]);
    for (std::size_t edge = 0; edge < 2; ++edge) {
        const double n = normal[edge], rx = edge == 0 ? half_length_ : -half_length_;
        if (n == 0) {
            continue;
        }
        // Sliding friction of the run over the ground, against the speed: it turns the nose down.
        const double friction = speed_ == 0 ? 0.0 : -std::copysign(friction_ * n, speed_);
        loads.force += n;
        loads.moment += n * (rx * ct + depth_ * st) + friction * (depth_ * ct - rx * st);
    }
    up = loads.force / mass_;
    turn = loads.moment / inertia_;
}

std::array<double, 2> HeavePitch::edge_gaps(const PitchState& y) const {
    const double h = y[0] - contact_gap_, rise = half_length_ * std::sin(y[2]);
    return {h + rise, h - rise};
}

std::array<double, 2> HeavePitch::edge_speeds(const PitchState& y) const {
    const double up = y[1] + depth_ * std::sin(y[2]) * y[3], turn = half_length_ * std::cos(y[2]) * y[3];
    return {up + turn, up - turn};
}

ContactProblem HeavePitch::problem(const PitchState& y) const {
    const double st = std::sin(y[2]), ct = std::cos(y[2]), q = y[3];
    const auto gaps = [&](const std::array<double, 2>& normal) {
        double up = 0, turn = 0;
        accelerations(y, normal, up, turn);
        const double common = up + depth_ * (st * turn + ct * q * q), side = half_length_ * (ct * turn - st * q * q);
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

std::array<double, 2> HeavePitch::normal_forces(const PitchState& y, ContactState bearing) const {
    return bearing == ContactState::free ? std::array<double, 2>{0, 0} : holding_forces(problem(y), bearing);
}

void HeavePitch::rate(const PitchState& y, ContactState bearing, PitchState& d) const {
    std::array<double, 2> normal{0, 0};
    if (bearing != ContactState::free) {
        ContactProblem p = problem(y);
        const std::array<double, 2> gaps = edge_gaps(y), speeds = edge_speeds(y);
        for (std::size_t i = 0; i < 2; ++i) {
            p.rest[i] += 40 * speeds[i] + 400 * gaps[i];  // draws a held edge back onto the ground
        }
        normal = holding_forces(p, bearing);
    }
    d[0] = y[1] + depth_ * std::sin(y[2]) * y[3];
    d[2] = y[3];
    accelerations(y, normal, d[1], d[3]);
}

ContactState HeavePitch::settle(const PitchState& y, ContactState touching) const {
    if (touching == ContactState::free) {
        return touching;
    }
    const std::optional<ContactState> state = contact_state(problem(y), touching);
    if (!state) {
        throw core::Error("contact", "no contact forces fit this motion (friction and tipping contradict each other)");
    }
    return *state;
}

PitchState HeavePitch::impact(const PitchState& y, ContactState touching) const {
    const double st = std::sin(y[2]), ct = std::cos(y[2]);
    ContactProblem p;
    p.rest = edge_speeds(y);
    std::array<double, 2> arm{}, lever{};
    for (std::size_t e = 0; e < 2; ++e) {
        const double rx = e == 0 ? half_length_ : -half_length_;
        arm[e] = rx * ct + depth_ * st;  // moment of a unit impulse, and how the edge moves with q
        lever[e] = arm[e];
    }
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t j = 0; j < 2; ++j) {
            p.matrix[i][j] = 1 / mass_ + arm[i] * lever[j] / inertia_;
        }
    }
    const auto impulses = impact_impulses(p, touching, restitution_);
    if (!impulses) {
        throw core::Error("contact", "no impulse fits this impact");
    }
    PitchState after = y;
    after[1] += ((*impulses)[0] + (*impulses)[1]) / mass_;
    after[3] += ((*impulses)[0] * arm[0] + (*impulses)[1] * arm[1]) / inertia_;
    return after;
}

LinearSystem HeavePitch::linearised(double gap, double pitch) const {
    const auto rate_of = [&](const double* x, const double* u, double* out) {
        const PitchState y{x[0], x[1], x[2], x[3]};
        PitchState d{};
        rate(y, ContactState::free, d);
        std::copy(d.begin(), d.end(), out);
        out[1] += u[0] / mass_;
        out[3] += u[1] / inertia_;
    };
    return linearise(rate_of, {gap, 0, pitch, 0}, {0, 0}, {"gap", "heave_velocity", "pitch", "pitch_rate"},
                     {"input_force", "input_moment"}, {1e-2, 1e-3, 1e-2, 1e-3}, {1e-2, 1e-3}, 1e-3);
}

std::vector<HeaveEquilibrium> HeavePitch::equilibria() const {
    const double low = std::max(contact_gap_, table_lower_ > -1e299 ? table_lower_ : contact_gap_),
                 high = table_upper_ < 1e299 ? table_upper_ : low + 1;
    const double left = std::max(pitch_lower_, -0.5), right = std::min(pitch_upper_, 0.5);
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
                if (!(std::abs(determinant) > 1e-300)) {
                    break;
                }
                const double sh = std::clamp((-f * mp + m * fp) / determinant, -0.1 * size_h, 0.1 * size_h);
                const double sp = std::clamp((-m * fh + f * mh) / determinant, -0.1 * size_p, 0.1 * size_p);
                h += sh;
                p += sp;
                if (h < low || h > high || p < left || p > right) {
                    break;
                }
                good = std::abs(sh) < 1e-11 * size_h && std::abs(sp) < 1e-11 * size_p;
            }
            const double rise = half_length_ * std::abs(std::sin(p));
            const bool known = std::any_of(found.begin(), found.end(), [&](const HeaveEquilibrium& e) {
                return std::abs(e.gap - h) < 1e-6 * size_h && std::abs(e.pitch - p) < 1e-6 * size_p;
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
        double worst = -1e300, slowest = 1e300, damping = 0;
        for (const Eigen1& mode : eigen(system.a)) {
            worst = std::max(worst, mode.value.real());
            if (mode.value.imag() > 0 && std::abs(mode.value) < slowest) {
                slowest = std::abs(mode.value);
                damping = -mode.value.real() / slowest;
            }
        }
        e.stable = worst < 1e-6;  // quadratic drag alone leaves the linear motion undamped, yet it settles
        e.stiffness = -system.a(1, 0) * mass_;
        e.frequency = e.stable && slowest < 1e299 ? slowest : 0;
        e.damping_ratio = e.stable ? damping : 0;
        e.growth = e.stable ? 0 : worst;
        e.name = e.stable ? std::string(1, static_cast<char>('A' + std::min(stable++, 25)))
                          : "U" + std::to_string(++unstable);
    }
    return found;
}

}  // namespace underbody::dynamics
