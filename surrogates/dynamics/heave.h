// Heave: one degree of freedom over recorded or given inputs.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/dynamics/heave_terms.h"
#include "surrogates/dynamics/model.h"

namespace underbody::dynamics {

/// Inputs on a strictly ascending time base (steps may differ), linear between samples, held beyond the ends.
struct InputSignals {
    std::vector<double> time;
    struct Signal {
        Channel channel;
        std::vector<double> values;
    };
    std::vector<Signal> signals;  ///< input_force, jet_voltage, speed, pitch, ...; none: the model's [conditions]
    Conditions held;              ///< over the whole run
};

/// The model's heave equation with all its effects, ready to run. Immutable after `prepare`, safe to use from many threads.
class HeavePlant {
public:
    /// Throws core::InputError: no lift source and no net weight is fine; a table that needs a channel nobody gives is not;
    /// virtual mass that is not positive.
    HeavePlant(const Model& model, const Conditions& held = {});

    HeaveTerms terms;  ///< may be changed between runs (discovery's inner loop); call refresh() after changing sources

    /// F(t,h,w) with inputs of the moment, M dw/dt = F - 1/2 M' w^2.
    [[nodiscard]] double acceleration(double t, double h, double w, double input, double lift_scale = 1) const;
    /// Static lift at this gap with held channels, N (includes roughness).
    [[nodiscard]] double lift(double h) const;
    [[nodiscard]] double drag(double w) const;
    [[nodiscard]] double inertia(double h, double& slope) const;
    /// True when forces do not depend on time once inputs are constant.
    [[nodiscard]] bool autonomous() const;
    /// Folds sources with constant scales into one curve.
    void refresh();

    /// The folded lift curve (constant scales), and whether that is all the lift there is.
    [[nodiscard]] const Curve& lift_curve() const { return folded_; }
    [[nodiscard]] bool single_curve() const { return single_; }
    [[nodiscard]] const Conditions& held() const { return held_; }

private:
    friend class HeaveRun;
    Curve folded_;
    bool single_ = true;
    std::vector<std::size_t> varying_;  ///< sources whose scales or axes vary
    Conditions held_;
};

/// A recorded run made ready for one plant: inputs transformed (delay, dead zone, gain, lag) and resampled to a fixed step.
class HeaveRun {
public:
    /// Steps are at most `max_step` and divide each recorded interval evenly.
    HeaveRun(const HeavePlant& plant, const InputSignals& inputs, double max_step = 0.02);

    [[nodiscard]] std::size_t samples() const { return time_.size(); }
    [[nodiscard]] const std::vector<double>& time() const { return time_; }

    /// RK4 from sample `first` to sample `last` (indices of the input's time base), starting in (gap, heave_velocity).
    /// Writes the true gap and velocity at the samples first..last, sizes last - first + 1 (`velocity` may be empty).
    /// Contact: the body stops at the contact gap (restitution) and leaves when the force lifts it.
    /// History (Basset) starts with the fluid at rest in the body's frame. Never throws; NaN out means the run blew up.
    void simulate(const HeavePlant& plant, std::size_t first, std::size_t last, double gap, double velocity,
                  std::span<double> gap_out, std::span<double> velocity_out) const;
    /// What the gap sensor would read, from true gaps on the same samples (delay by linear interpolation, bias).
    void sensor(const HeavePlant& plant, std::size_t first, std::span<const double> true_gap, std::span<double> reading) const;

private:
    std::vector<double> time_;
    std::vector<std::size_t> start_;      ///< sample -> first half-step index
    std::vector<double> step_;            ///< per sample interval
    std::vector<double> input_;           ///< transformed input force at half steps
    std::vector<std::vector<double>> scale_;  ///< per varying source: factor at half steps
    std::vector<std::vector<double>> channel_;  ///< per channel used by tables, at half steps
    std::vector<int> channel_index_;
};

/// A trajectory by CVODE with events.
struct TrajectoryOptions {
    double duration = 60;          ///< s
    double output_step = 0;        ///< 0: the integrator's own steps
    double tolerance = 1e-9;       ///< relative; absolute scaled by 1e-3 m, 1e-3 m/s
    bool stop_at_contact = false;
    bool stop_at_equilibrium = false;
    double escape_gap = 0;         ///< stop above this gap; 0: never
    double settle_speed = 1e-6;    ///< m/s, with |acceleration| small: equilibrium reached
};

struct TrajectoryEvent {
    double time = 0;
    std::string kind;   ///< contact, lift_off, escape, equilibrium
    double gap = 0;
    double velocity = 0;
};

struct Trajectory {
    std::vector<double> time, gap, heave_velocity, lift_force, drag_force, input_force;
    std::vector<bool> outside;   ///< a table was asked beyond its range there
    std::vector<TrajectoryEvent> events;
    std::string end;             ///< "time", "contact", "escape", "equilibrium"
    core::Problems remarks;
};

/// Throws core::InputError for a start inside the ground; core::Error (kind "integration") when CVODE gives up.
Trajectory simulate(const Model& model, double gap, double heave_velocity, const InputSignals& inputs,
                    const TrajectoryOptions& options, core::Progress& progress = core::Progress::none());

/// An equilibrium of the free heave motion (inputs as held).
struct HeaveEquilibrium {
    std::string name;       ///< "A", "B", ... for attractors from the ground up; "U1", ... for unstable ones
    double gap = 0;
    bool stable = false;
    double stiffness = 0;   ///< -dF/dh, N/m
    double frequency = 0;   ///< rad/s, sqrt(k/M), 0 when unstable
    double damping_ratio = 0;
    double growth = 0;      ///< 1/s of an unstable one
};
std::vector<HeaveEquilibrium> heave_equilibria(const HeavePlant& plant);

}  // namespace underbody::dynamics
