#include "surrogates/dynamics/basin/region_pitch_ends.h"

#include <algorithm>
#include <cmath>
#include <optional>

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

/// Directions on the unit sphere of the capture's form.
std::vector<PitchState> PitchEnds::directions_of(const Capture& capture) const {
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
    return directions;
}

/// Whether the capture's form falls along the motion everywhere on a shell, checked along the directions.
bool PitchEnds::falls(const Capture& capture, const std::vector<PitchState>& directions, double radius) const {
    return std::all_of(directions.begin(), directions.end(), [&](const PitchState& d) {
        const PitchState y{capture.gap + radius * d[0], radius * d[1], capture.pitch + radius * d[2], radius * d[3]};
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
}

/// Level of the capture's form: it grows until the form rises somewhere on its shell.
void PitchEnds::hold(Capture& capture, const Matrix& a) const {
    Matrix weights(4, 4);
    for (std::size_t i = 0; i < 4; ++i) {
        weights(i, i) = 1 / (sizes_[i] * sizes_[i]);
    }
    capture.p = lyapunov(a, weights);
    const std::vector<PitchState> directions = directions_of(capture);
    double radius = first_radius;
    while (radius < 1e6 && falls(capture, directions, radius)) {
        radius *= radius_ratio;
    }
    radius /= radius_ratio * radius_margin;  // a margin, since shells are checked at points only
    capture.holds = radius > 2 * first_radius;
    capture.level = radius * radius;
    const Matrix reach = inverse(capture.p);
    capture.gap_reach = std::sqrt(reach(0, 0));
    capture.pitch_reach = std::sqrt(reach(2, 2));
}

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
    if (worst < -settling && !terms.forced_in_time() && terms.history == 0 && !plant_.vertical().loop_has_states()) {
        hold(capture, system.a);
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

/// A motion on its way: where it is, what bears it, and what it has come to so far.
template <bool Memory, bool Loop>
struct PitchEnds::Course {
    using Law = Rate<Memory, Loop>;
    static constexpr std::size_t size = Law::size;
    using State = std::array<double, size>;

    const PitchEnds& judge;
    State y, scale;
    double t = 0;
    ContactState bearing = ContactState::free;
    int changes = 0;
    End held;  ///< an attractor's set may be wider than the tables
    Extent third{}, fourth{};

    Course(const PitchEnds& ends, const PitchState& start, LoopActuator<4>& actuator)
        : judge(ends), held{-1, 0, ends.outside(start[0], start[2])} {
        y.fill(-judge.plant_.centre_velocity(start));
        scale.fill(judge.options_.tolerance * 10 * judge.sizes_[1]);
        std::copy(start.begin(), start.end(), y.begin());
        for (std::size_t i = 0; i < 4; ++i) {
            scale[i] = judge.options_.tolerance * 10 * judge.sizes_[i];
        }
        if constexpr (Loop) {
            const double still[4] = {};
            actuator.start(0, y.data(), still);
            y[size - 1] = actuator.driven(0, y.data());
            scale[size - 1] *= judge.plant_.mass();  // a force that changes the velocity so much within a second
            State begin{};
            Law{&judge.plant_, &actuator, ContactState::free}(0, y.data(), begin.data());
            actuator.accept(0, y.data(), begin.data());
        }
    }

    [[nodiscard]] static PitchState motion(const State& y) { return {y[0], y[1], y[2], y[3]}; }
    [[nodiscard]] End ended(int index) const { return held.index >= 0 ? held : End{index, t, held.outside}; }

    /// A gap has closed or a bearing force has vanished at `hit`: the motion goes on with another contact, or ends.
    std::optional<End> touch(const State& hit, const Law& rate) {
        y = hit;
        held.outside = held.outside || judge.outside(y[0], y[2]);
        if (!judge.options_.through_contact) {
            return ended(judge.contact_class());
        }
        PitchState landed = motion(y);
        try {
            land(judge.plant_, landed, bearing, rate.around(t, y.data()));
        } catch (const core::Error&) {
            return ended(judge.undecided_class());
        }
        std::copy(landed.begin(), landed.end(), y.begin());
        if (judge.rests(landed, bearing)) {
            return ended(judge.contact_class());
        }
        if (++changes > 2000) {
            const bool slow = std::abs(y[1]) < chattering * judge.sizes_[1];
            return ended(slow ? judge.contact_class() : judge.undecided_class());
        }
        return std::nullopt;
    }

    /// The end of the motion when it is decided by where it is now.
    std::optional<End> arrived() {
        if (y[0] >= judge.escape_) {
            return ended(judge.escape_class());
        }
        if (bearing == ContactState::free) {
            const int index = judge.captured(motion(y));
            if (held.index < 0 && index >= 0) {
                held = {index, t, held.outside};
            }
            if (held.index >= 0 &&
                (held.outside || judge.within_tables(motion(y), static_cast<std::size_t>(held.index)))) {
                return held;
            }
        } else if (judge.rests(motion(y), bearing)) {
            return ended(judge.contact_class());
        }
        if (t > 0.5 * judge.options_.duration) {
            (t > (1 - quarter) * judge.options_.duration ? fourth : third).take(motion(y));
        }
        return std::nullopt;
    }
};

template <bool Memory, bool Loop>
End PitchEnds::go(const PitchState& start) const {
    using Path = Course<Memory, Loop>;
    using State = typename Path::State;
    LoopActuator<4> actuator(plant_.vertical().terms, [this](double, const double* y) {
        return plant_.vertical().held_input() + plant_.force_command({y[0], y[1], y[2], y[3]});
    });
    Path path(*this, start, actuator);
    const double look_back = Loop && actuator.delayed() ? actuator.max_step() : core::no_limit;
    while (path.t < options_.duration) {
        const typename Path::Law rate{&plant_, &actuator, path.bearing};
        DormandPrince<Path::size, typename Path::Law> ode(rate, path.t, path.y, path.scale, first_motion_step);
        bool changed = false;
        while (!changed && path.t < options_.duration) {
            const bool stepped = ode.step(std::min(options_.duration, ode.t() + look_back));
            path.t = ode.t();
            if (!stepped || ode.tries() > 400000) {
                return path.ended(undecided_class());
            }
            if constexpr (Loop) {
                actuator.accept(ode.t(), ode.y().data(), ode.rate().data());
            }
            path.y = ode.y();
            const double before = ode.before_t(), width = path.t - before;
            const auto between = [&](double part) {
                State inside;
                for (std::size_t i = 0; i < Path::size; ++i) {
                    inside[i] = ode.between(part, i);
                }
                return inside;
            };
            const double hit = first_negative([&](double part) {
                const State at = part == 1.0 ? path.y : between(part);
                return margin(Path::motion(at), path.bearing, rate.around(before + part * width, at.data()));
            });
            changed = hit > 0;
            if (changed) {
                path.t = before + hit * width;
                if (const std::optional<End> end = path.touch(between(hit), rate)) {
                    return *end;
                }
            } else {  // beyond the escape gap the step went on, the motion did not
                path.held.outside =
                    path.held.outside || (path.y[0] >= escape_ ? outside(escape_, path.y[2]) : leaves_tables(ode));
            }
            if (const std::optional<End> end = path.arrived()) {
                return *end;
            }
        }
    }
    path.t = options_.duration;
    return path.ended(path.bearing == ContactState::free ? settled(path.third, path.fourth).index : contact_class());
}

}  // namespace underbody::dynamics
