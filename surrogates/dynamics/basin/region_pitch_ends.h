// Judges where motions of heave and pitch end.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/no_limit.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/plant/loop_actuator.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"

namespace underbody::dynamics {

/// A neighbourhood x'Px < level of a linearly stable equilibrium that no motion leaves, checked at points of its
/// shells.
struct Capture {
    std::size_t class_index = 0;
    double gap = 0, pitch = 0;
    bool holds = false;
    Matrix p;
    double level = 0;
    double gap_reach = 0, pitch_reach = 0;  ///< m and rad, of the set x'Px <= 1
    [[nodiscard]] double value(const PitchState& y) const {
        const double x[4] = {y[0] - gap, y[1], y[2] - pitch, y[3]};
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                sum += x[i] * p(i, j) * x[j];
            }
        }
        return sum;
    }
};

/// Ends of starts by the explicit pair of Dormand and Prince, with contact. Immutable, safe to use from many threads;
/// plant and options must live longer.
class PitchEnds {
public:
    PitchEnds(const HeavePitch& plant, const RegionOptions& options, double escape, const PitchState& sizes)
        : plant_(plant), options_(options), escape_(escape), sizes_(sizes), equilibria_(plant.equilibria()) {
        for (const HeaveEquilibrium& e : equilibria_) {
            if (e.stable) {
                add_attractor(e);
            }
        }
        attractors_ = classes_.size();
        classes_.push_back({"contact", EndKind::contact});
        classes_.push_back({"escape", EndKind::escape});
        for (std::size_t i = 0; i < attractors_; ++i) {
            classes_.push_back({"about " + classes_[i].name, EndKind::cycle, classes_[i].gap, 0});
        }
        classes_.push_back({"undecided", EndKind::undecided});
    }

    [[nodiscard]] const std::vector<EndClass>& classes() const { return classes_; }
    [[nodiscard]] const std::vector<HeaveEquilibrium>& equilibria() const { return equilibria_; }
    [[nodiscard]] End of(const PitchState& start) const;

private:
    enum { contact_offset = 0, escape_offset = 1 };
    [[nodiscard]] int contact_class() const { return static_cast<int>(attractors_); }
    [[nodiscard]] int escape_class() const { return static_cast<int>(attractors_) + 1; }
    [[nodiscard]] int undecided_class() const { return static_cast<int>(classes_.size()) - 1; }

    void add_attractor(const HeaveEquilibrium& e);
    void hold(Capture& capture, const Matrix& a) const;
    [[nodiscard]] std::vector<PitchState> directions_of(const Capture& capture) const;
    [[nodiscard]] bool falls(const Capture& capture, const std::vector<PitchState>& directions, double radius) const;
    /// The set that holds this state, or -1; sets stand in the order of the attractors' classes.
    [[nodiscard]] int captured(const PitchState& y) const {
        for (const Capture& capture : captures_) {
            if (capture.holds && capture.value(y) < capture.level) {
                return static_cast<int>(capture.class_index);
            }
        }
        return -1;
    }

    /// The four states, the memory of the history force where the model has one, and with `Loop` the force after the
    /// lag of the closed loop's actuator.
    template <bool Memory, bool Loop>
    struct Rate {
        static constexpr std::size_t size = 4 + (Memory ? history_states : 0) + (Loop ? 1 : 0);
        const HeavePitch* plant;
        const LoopActuator<4>* actuator;
        ContactState bearing;
        void operator()(double t, const double* y, double* d) const {
            const PitchState state{y[0], y[1], y[2], y[3]};
            PitchState rate;
            plant->rate(state, bearing, rate, around(t, y));
            std::copy(rate.begin(), rate.end(), d);
            if constexpr (Memory) {
                const HistoryKernel& kernel = history_kernel();
                for (std::size_t i = 0; i < history_states; ++i) {
                    d[4 + i] = -kernel.rate[i] * (y[4 + i] + plant->centre_velocity(state));
                }
            }
            if constexpr (Loop) {
                d[size - 1] = actuator->lagged()
                                  ? (actuator->driven(t, y) - y[size - 1]) / plant->vertical().terms.actuator.lag
                                  : 0;
            }
        }
        [[nodiscard]] Surroundings around(double t, const double* y) const {
            Surroundings now;
            now.t = t;
            now.memory = Memory ? y + 4 : nullptr;
            if constexpr (Loop) {
                now.input = actuator->lagged() ? y[size - 1] : actuator->driven(t, y);
            }
            return now;
        }
    };
    template <bool Memory, bool Loop>
    struct Course;
    template <bool Memory, bool Loop>
    [[nodiscard]] End go(const PitchState& start) const;

    /// Swing about an attractor in units of the sizes, over a part of the time.
    struct Extent {
        static constexpr double none = core::no_limit;
        PitchState low{none, none, none, none}, high{-none, -none, -none, -none};
        void take(const PitchState& y) {
            for (std::size_t i = 0; i < 4; ++i) {
                low[i] = std::min(low[i], y[i]);
                high[i] = std::max(high[i], y[i]);
            }
        }
    };
    [[nodiscard]] End settled(const Extent& third, const Extent& fourth) const;
    [[nodiscard]] double margin(const PitchState& y, ContactState bearing, const Surroundings& around) const;
    [[nodiscard]] bool rests(const PitchState& y, ContactState bearing) const;
    /// Where a force table holds its end value.
    [[nodiscard]] bool outside(double gap, double pitch) const {
        return gap < plant_.table_lower() || gap > plant_.table_upper() || pitch < plant_.pitch_lower() ||
               pitch > plant_.pitch_upper();
    }
    template <class Integrator>
    [[nodiscard]] bool leaves_tables(const Integrator& ode) const;
    /// True when what the attractor holds reaches no place that a force table does not cover.
    [[nodiscard]] bool within_tables(const PitchState& y, std::size_t capture) const {
        const double gap = captures_[capture].gap, pitch = captures_[capture].pitch;
        const double value = captures_[capture].value(y);
        const double far = std::sqrt(value) * captures_[capture].gap_reach,
                     turned = std::sqrt(value) * captures_[capture].pitch_reach;
        return !outside(gap - far, pitch - turned) && !outside(gap + far, pitch + turned);
    }

    const HeavePitch& plant_;
    const RegionOptions& options_;
    double escape_;
    PitchState sizes_;
    std::vector<HeaveEquilibrium> equilibria_;
    std::vector<EndClass> classes_;
    std::vector<Capture> captures_;
    std::size_t attractors_ = 0;
};

}  // namespace underbody::dynamics
