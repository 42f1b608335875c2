#include "surrogates/dynamics/basin/region_pitch_ends.h"

#include <algorithm>
#include <cmath>

#include "core/no_limit.h"
#include "core/random.h"
#include "surrogates/dynamics/basin/region_parts.h"
#include "surrogates/dynamics/model/matrix_algebra.h"
#include "surrogates/dynamics/simulate/dormand_prince.h"
#include "surrogates/dynamics/simulate/heave_pitch_contact.h"

namespace underbody::dynamics {

namespace {

constexpr double settling = 1e-4;  ///< 1/s, of the slowest mode: slower ones get no set of their own
constexpr double first_radius = 1e-6, radius_ratio = 1.15,
                 radius_margin = 1.3;               ///< of that set; shells are checked at points only
constexpr double resting_speed = 1e-6;              ///< m/s, rad/s, on the ground
constexpr double at_rest = 2e-3;                    ///< swing in units of the sizes: less is rest
constexpr double shrinking = 0.97, growing = 1.03;  ///< ratio of the last two swings: to rest, a cycle, neither
constexpr double quarter = 0.25;                    ///< of a step between looks for contact; of the time for a swing
constexpr double chattering = 1e-3;                 ///< of the size of speeds, after thousands of contacts

}  // namespace

void PitchEnds::add_attractor(const HeaveEquilibrium& e) {
    Capture capture;
    capture.class_index = classes_.size();
    capture.gap = e.gap;
    capture.pitch = e.pitch;
    classes_.push_back({e.name, EndKind::attractor, e.gap, 0});
    const LinearSystem system = plant_.linearised(e.gap, e.pitch);
    double worst = -core::no_limit;
    for (const EigenPair& mode : eigen(system.a)) {
        worst = std::max(worst, mode.value.real());
    }
    const HeaveTerms& terms = plant_.vertical().terms;
    if (worst < -settling && terms.waves.empty() && terms.history == 0 && !plant_.vertical().loop_has_states()) {
        Matrix weights(4, 4);
        for (std::size_t i = 0; i < 4; ++i) {
            weights(i, i) = 1 / (sizes_[i] * sizes_[i]);
        }
        capture.p = lyapunov(system.a, weights);
        // Directions on the unit sphere of P; the level grows until the value rises somewhere on its shell.
        core::Random random(11);
        std::vector<PitchState> directions;
        for (int k = 0; k < 1500; ++k) {
            PitchState d{};
            for (std::size_t i = 0; i < 4; ++i) {
                d[i] = random.normal() * sizes_[i];
            }
            PitchState at{capture.gap + d[0], d[1], capture.pitch + d[2], d[3]};
            const double norm = std::sqrt(capture.value(at));
            for (double& part : d) {
                part /= norm;
            }
            directions.push_back(d);
        }
        const auto falls = [&](double radius) {
            return std::all_of(directions.begin(), directions.end(), [&](const PitchState& d) {
                const PitchState y{capture.gap + radius * d[0], radius * d[1], capture.pitch + radius * d[2],
                                   radius * d[3]};
                const std::array<double, 2> gaps = plant_.edge_gaps(y);
                if (std::min(gaps[0], gaps[1]) <= 0 || y[0] >= escape_) {
                    return false;
                }
                PitchState rate{};
                plant_.rate(y, ContactState::free, rate);
                const double x[4] = {y[0] - capture.gap, y[1], y[2] - capture.pitch, y[3]};
                double growth = 0;
                for (std::size_t i = 0; i < 4; ++i) {
                    for (std::size_t j = 0; j < 4; ++j) {
                        growth += 2 * x[i] * capture.p(i, j) * rate[j];
                    }
                }
                return growth < 0;
            });
        };
        double radius = first_radius;
        while (radius < 1e6 && falls(radius)) {
            radius *= radius_ratio;
        }
        radius /= radius_ratio * radius_margin;  // a margin, since shells are checked at points only
        capture.holds = radius > 2 * first_radius;
        capture.level = radius * radius;
        const Matrix reach = inverse(capture.p);
        capture.gap_reach = std::sqrt(reach(0, 0));
        capture.pitch_reach = std::sqrt(reach(2, 2));
    }
    captures_.push_back(std::move(capture));
}

bool PitchEnds::rests(const PitchState& y, ContactState bearing) const {
    if (bearing != ContactState::flat || std::abs(y[1]) > resting_speed || std::abs(y[3]) > resting_speed) {
        return false;
    }
    const std::array<double, 2> normal = plant_.normal_forces(y, bearing);
    return normal[0] > 0 && normal[1] > 0;
}

End PitchEnds::settled(const Extent& third, const Extent& fourth) const {
    double nearest = core::no_limit;
    std::size_t at = attractors_;
    double before = 0, after = 0;
    for (std::size_t k = 0; k < captures_.size(); ++k) {
        const double centre[4] = {captures_[k].gap, 0, captures_[k].pitch, 0};
        double far3 = 0, far4 = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            far3 = std::max(
                far3, std::max(std::abs(third.low[i] - centre[i]), std::abs(third.high[i] - centre[i])) / sizes_[i]);
            far4 = std::max(
                far4, std::max(std::abs(fourth.low[i] - centre[i]), std::abs(fourth.high[i] - centre[i])) / sizes_[i]);
        }
        if (far4 < nearest) {
            nearest = far4;
            at = k;
            before = far3;
            after = far4;
        }
    }
    if (at < attractors_ && after < 0.5) {
        if (after < at_rest || after < shrinking * before) {
            return {static_cast<int>(at), options_.duration};
        }
        if (after < growing * before) {
            return {static_cast<int>(attractors_ + 2 + at), options_.duration};
        }
    }
    return {undecided_class(), options_.duration};
}

End PitchEnds::of(const PitchState& start) const {
    const std::array<double, 2> gaps = plant_.edge_gaps(start);
    const double least = std::min(gaps[0], gaps[1]);
    if (least < 0 || (least <= 0 && !options_.through_contact)) {
        return {contact_class(), 0, outside(start[0], start[2])};
    }
    if (start[0] >= escape_) {
        return {escape_class(), 0, outside(start[0], start[2])};
    }
    if (plant_.vertical().loop_has_states()) {
        return plant_.remembers() ? go<true, true>(start) : go<false, true>(start);
    }
    return plant_.remembers() ? go<true, false>(start) : go<false, false>(start);
}

/// The smaller of the gaps of free edges and the forces of bearing ones: below zero the contact changes.
double PitchEnds::margin(const PitchState& y, ContactState bearing, const Surroundings& around) const {
    std::array<double, 2> value = plant_.edge_gaps(y);
    if (bearing != ContactState::free) {
        const std::array<double, 2> normal = plant_.normal_forces(y, bearing, around);
        for (std::size_t e = 0; e < 2; ++e) {
            value[e] = (static_cast<int>(bearing) >> e & 1) ? normal[e] : value[e];
        }
    }
    return std::min(value[0], value[1]);
}

/// The last step, its ends and where gap or pitch turned round within it.
template <class Integrator>
bool PitchEnds::leaves_tables(const Integrator& ode) const {
    const auto farthest = [&](std::size_t i) {
        const double rate = ode.y()[i + 1], before = ode.before()[i + 1];
        const bool turned = before != 0 && (before < 0) != (rate < 0);
        return turned ? ode.between(before / (before - rate), i) : ode.y()[i];
    };
    return outside(ode.y()[0], ode.y()[2]) || outside(farthest(0), ode.y()[2]) || outside(ode.y()[0], farthest(2));
}

namespace {

/// The earliest part of a step, of four, in which `value` falls below zero, and where in it; negative when it does not.
template <class Value>
double first_negative(const Value& value) {
    for (double part = quarter; part <= 1; part += quarter) {
        if (value(part) < 0) {
            double lo = part - quarter, hi = part;
            for (int i = 0; i < 40; ++i) {
                const double middle = (lo + hi) / 2;
                (value(middle) < 0 ? hi : lo) = middle;
            }
            return hi;
        }
    }
    return -1;
}

}  // namespace

template <bool Memory, bool Loop>
End PitchEnds::go(const PitchState& start) const {
    using Law = Rate<Memory, Loop>;
    constexpr std::size_t N = Law::size;
    using State = std::array<double, N>;
    const auto motion = [](const State& y) { return PitchState{y[0], y[1], y[2], y[3]}; };
    LoopActuator<4> actuator(plant_.vertical().terms, [this](double, const double* y) {
        return plant_.vertical().held_input() + plant_.force_command({y[0], y[1], y[2], y[3]});
    });
    State y, scale;
    y.fill(-plant_.centre_velocity(start));
    scale.fill(options_.tolerance * 10 * sizes_[1]);
    std::copy(start.begin(), start.end(), y.begin());
    for (std::size_t i = 0; i < 4; ++i) {
        scale[i] = options_.tolerance * 10 * sizes_[i];
    }
    if constexpr (Loop) {
        const double still[4] = {};
        actuator.start(0, y.data(), still);
        y[N - 1] = actuator.driven(0, y.data());
        scale[N - 1] *= plant_.mass();  // a force that changes the velocity so much within a second
        State begin{};
        Law{&plant_, &actuator, ContactState::free}(0, y.data(), begin.data());
        actuator.accept(0, y.data(), begin.data());
    }
    const double look_back = Loop && actuator.delayed() ? actuator.max_step() : core::no_limit;
    ContactState bearing = ContactState::free;
    double t = 0;
    Extent third, fourth;
    int changes = 0;
    End held{-1, 0, outside(start[0], start[2])};  // an attractor's set may be wider than the tables
    const auto ends = [&](int index, double when) { return held.index >= 0 ? held : End{index, when, held.outside}; };
    while (t < options_.duration) {
        const Law rate{&plant_, &actuator, bearing};
        DormandPrince<N, Law> ode(rate, t, y, scale, first_motion_step);
        bool changed = false;
        while (!changed && t < options_.duration) {
            if (!ode.step(std::min(options_.duration, ode.t() + look_back)) || ode.tries() > 400000) {
                return ends(undecided_class(), ode.t());
            }
            if constexpr (Loop) {
                actuator.accept(ode.t(), ode.y().data(), ode.rate().data());
            }
            t = ode.t();
            y = ode.y();
            const double before = ode.before_t(), width = t - before;
            const auto between = [&](double part) {
                State inside;
                for (std::size_t i = 0; i < N; ++i) {
                    inside[i] = ode.between(part, i);
                }
                return inside;
            };
            const auto value = [&](double part) {
                const State at = part == 1.0 ? y : between(part);
                return margin(motion(at), bearing, rate.around(before + part * width, at.data()));
            };
            // A gap that closes or a bearing force that vanishes.
            const double hit = first_negative(value);
            if (hit > 0) {
                t = before + hit * width;
                held.outside = held.outside || outside(between(hit)[0], between(hit)[2]);
                if (!options_.through_contact) {
                    return ends(contact_class(), t);
                }
                y = between(hit);
                PitchState landed = motion(y);
                try {
                    land(plant_, landed, bearing, rate.around(t, y.data()));
                } catch (const core::Error&) {
                    return ends(undecided_class(), t);
                }
                std::copy(landed.begin(), landed.end(), y.begin());
                if (rests(landed, bearing)) {
                    return ends(contact_class(), t);
                }
                if (++changes > 2000) {
                    return ends(std::abs(y[1]) < chattering * sizes_[1] ? contact_class() : undecided_class(), t);
                }
                changed = true;
            } else {  // beyond the escape gap the step went on, the motion did not
                held.outside = held.outside || (y[0] >= escape_ ? outside(escape_, y[2]) : leaves_tables(ode));
            }
            if (y[0] >= escape_) {
                return ends(escape_class(), t);
            }
            if (bearing == ContactState::free) {
                const int index = captured(motion(y));
                if (held.index < 0 && index >= 0) {
                    held = {index, t, held.outside};
                }
                if (held.index >= 0 &&
                    (held.outside || within_tables(motion(y), static_cast<std::size_t>(held.index)))) {
                    return held;
                }
            } else if (rests(motion(y), bearing)) {
                return ends(contact_class(), t);
            }
            if (t > 0.5 * options_.duration) {
                (t > (1 - quarter) * options_.duration ? fourth : third).take(motion(y));
            }
        }
    }
    return ends(bearing == ContactState::free ? settled(third, fourth).index : contact_class(), options_.duration);
}

}  // namespace underbody::dynamics
