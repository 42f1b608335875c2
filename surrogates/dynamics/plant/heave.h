// Heave: one degree of freedom over recorded or given inputs.
#pragma once

#include <algorithm>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave_equation.h"

namespace underbody::dynamics {

/// Inputs on a strictly ascending time base (steps may differ), held beyond the ends.
struct InputSignals {
    /// What the input force does between samples: `held` is what a digital controller does (a record of its commands).
    enum class Between { linear, held };
    Between input_between = Between::linear;
    double input_advance = 0;  ///< s: the input is recorded so long after it acts
    std::vector<double> time;
    struct Signal {
        Channel channel;
        std::vector<double> values;
    };
    std::vector<Signal> signals;  ///< input_force, jet_voltage, speed, pitch, ...; none: the model's [conditions]
    Conditions held;              ///< over the whole run
};

/// u = -velocity_gain w - gap_gain (h - reference), up, limited to +-limit (0: no limit).
struct HeaveFeedback {
    double gap_gain = 0;       ///< N/m
    double velocity_gain = 0;  ///< N s/m
    double reference = 0;      ///< m
    double limit = 0;          ///< N
    /// What the controller asks for, N.
    [[nodiscard]] double command(double h, double w) const {
        const double u = -velocity_gain * w - gap_gain * (h - reference);
        return limit > 0 ? std::clamp(u, -limit, limit) : u;
    }
};

/// The model's heave equation with all its effects, ready to run. Safe to use from many threads while nobody changes
/// it.
class HeavePlant {
public:
    /// `varying`: channels that a run will supply as signals (their sources are not folded into one curve).
    /// Throws core::InputError: a table that needs a channel nobody gives; virtual mass that is not positive.
    explicit HeavePlant(const Model& model, const Conditions& held = {}, const std::vector<Channel>& varying = {});

    HeaveTerms terms;  ///< numbers may be changed between runs; after sources or corrections: refresh()

    /// Folds the sources whose scales and axes are constant into one curve.
    void refresh();

    /// Feedback whose command passes the actuator of the model (delay, dead zone, gain, lag); see close_loop().
    /// With it HeaveMoment::input is what else is commanded, before the actuator, unless loop_has_states().
    std::optional<HeaveFeedback> loop;
    /// True when the actuator in the loop has states of its own (delay or lag): integrators carry them and bring the
    /// force that reaches the body as HeaveMoment::input.
    [[nodiscard]] bool loop_has_states() const { return loop && terms.actuator.has_states(); }
    /// The force that reaches the body at rest in this state, N, with what else is commanded.
    [[nodiscard]] HeaveLoad closed_input(double h, double w, double given) const;

    using Moment = HeaveMoment;
    /// The constant input of the conditions: as it reaches the body, or before the actuator of a closed loop, N.
    [[nodiscard]] double held_input() const {
        const double u = held_.get(Channel::input_force, 0.0);
        return loop ? u : terms.actuator.felt(u);
    }
    /// The moment with inputs as held.
    [[nodiscard]] Moment held_moment(double t = 0) const { return {t, held_input(), nullptr, nullptr}; }
    /// Lift of the tables at this gap, N (includes roughness); w: where a table has an axis of it.
    [[nodiscard]] double lift(double h, const Moment& moment = {}, double w = 0) const;
    /// The same with its slopes.
    [[nodiscard]] HeaveLoad table_lift(double h, double w, const Moment& moment = {}) const;
    /// Resistance of the water and everything else that follows the velocity, N, sign of w. Without history.
    [[nodiscard]] double resistance(double h, double w) const;
    /// What resists a small motion at rest, N s/m. Coulomb friction has no such slope (its force does not go to nought
    /// with the velocity) and is left out.
    [[nodiscard]] double damping(double h) const;
    /// What is said where numbers rest on small motions; empty without Coulomb friction.
    [[nodiscard]] core::Problems left_out_of_small_motions() const;
    /// The part of the water's drag law, at a velocity through the water; the rest is of the guide and the film
    /// (friction, squeeze film, corrections over the velocity).
    [[nodiscard]] double water_drag(double relative) const;
    /// Everything up but lift, the water's drag and waves, N: weight, input, guide, film, springs, corrections, memory.
    [[nodiscard]] double other_force(double h, double w, const Moment& moment, const double* memory = nullptr) const;
    [[nodiscard]] double timed_force(double t) const;
    /// Lift of tables as the roughness of the ground changes it.
    [[nodiscard]] double roughened(double lift, double h) const;
    /// Mass that the history force adds by its fastest part; 0 without one.
    [[nodiscard]] double history_mass() const { return terms.history != 0 ? terms.history * history_kernel().mass : 0; }
    /// Has runs supply every channel with every moment, for motions whose tables live outside this plant.
    void keep_channels() { keeps_channels_ = needs_channels_ = true; }
    /// M(h) without the history's share, and its slope dM/dh.
    [[nodiscard]] double inertia(double h, double& slope) const;
    /// dw/dt. `memory`: history_states states y_i with y_i' = -rate_i (y_i + w), or nullptr.
    [[nodiscard]] double acceleration(double h, double w, const Moment& moment, const double* memory = nullptr) const;
    /// The same with its slopes along gap and velocity (memory held).
    double acceleration(double h, double w, const Moment& moment, const double* memory, HeaveSlopes& slopes) const;
    /// Force at rest with inputs held: all that depends on the gap alone, N.
    [[nodiscard]] double static_force(double h) const { return static_force(h, held_moment()); }
    [[nodiscard]] double static_force(double h, const Moment& moment) const;
    /// True when forces depend on gap and velocity alone once inputs are held.
    [[nodiscard]] bool autonomous() const;

    /// Sum of the constant sources (without roughness); `single_curve`: that is all the lift there is.
    [[nodiscard]] const Curve& lift_curve() const { return folded_; }
    [[nodiscard]] bool single_curve() const { return varying_.empty(); }
    [[nodiscard]] const Conditions& held() const { return held_; }
    [[nodiscard]] double contact_gap() const { return terms.contact_gap; }

private:
    friend class HeaveRun;
    Curve folded_;
    std::vector<std::size_t> varying_;  ///< indices of sources that vary
    std::vector<Channel> varying_channels_;
    bool needs_channels_ = false, keeps_channels_ = false;
    Conditions held_;
    std::shared_ptr<const StaticModel> seen_by_tables_;  ///< where effects change what the tables are asked at
    [[nodiscard]] HeaveLoad varying_lift(double h, double w, const Moment& moment) const;
    template <bool Slopes>
    double evaluate(double h, double w, const Moment& moment, const double* memory, HeaveSlopes& slopes) const;
};

/// A recorded run made ready for one plant: inputs transformed (delay, dead zone, gain, lag) and resampled to a fixed
/// step. Make a new one when the plant's sources or input transforms change; other numbers of the plant may change
/// freely.
class HeaveRun {
public:
    /// Steps are at most `max_step` and divide each recorded interval evenly.
    /// Throws core::InputError when a signal was not announced to the plant as varying.
    HeaveRun(const HeavePlant& plant, const InputSignals& inputs, double max_step = 0.02);

    [[nodiscard]] std::size_t samples() const { return time_.size(); }
    [[nodiscard]] const std::vector<double>& time() const { return time_; }

    /// RK4 from sample `first` to sample `last` (indices of the input's time base), starting in (gap, velocity).
    /// Writes the true gap and velocity at the samples first..last, last - first + 1 of them (`velocity_out` may be
    /// empty). Contact: the body stops at the contact gap (restitution) and leaves when the force lifts it. History
    /// (Basset) starts with the fluid moving with the body. Never throws; NaN out means the run blew up.
    void simulate(const HeavePlant& plant, std::size_t first, std::size_t last, double gap, double velocity,
                  std::span<double> gap_out, std::span<double> velocity_out) const;
    /// What the gap sensor would read, from true gaps at the samples first, first + 1, ... (delay by linear
    /// interpolation, bias).
    void sensor(const HeavePlant& plant, std::size_t first, std::span<const double> true_gap,
                std::span<double> reading) const;
    /// The input force as it reaches the body, at sample i.
    [[nodiscard]] double input(std::size_t sample) const { return input_[start_[sample]]; }
    /// What the outside brings at sample i.
    [[nodiscard]] HeavePlant::Moment moment(std::size_t sample) const {
        return moment_at(start_[sample], time_[sample]);
    }
    /// The same between samples: everything linear in time.
    void moment(double t, HeavePlant::Moment& out, std::vector<double>& buffer) const;

private:
    [[nodiscard]] HeavePlant::Moment moment_at(std::size_t half, double t) const;
    void transform_linear(const Actuator& actuator, const std::vector<double>& values);
    void transform_held(const Actuator& actuator, std::vector<double> values);
    std::vector<double> time_;
    std::vector<std::size_t> start_;  ///< sample -> index of its half step
    std::vector<double> half_time_;
    std::vector<double> input_;      ///< per half step: at the start (from the right) and in the middle of each step
    std::vector<double> input_end_;  ///< per half step that ends a step: from the left
    std::vector<double> factors_;    ///< per half step and varying source
    std::vector<double> channels_;   ///< per half step: channel_count values; empty when nobody needs them
    std::size_t factor_count_ = 0;
};

/// A trajectory by CVODE with events.
struct TrajectoryOptions {
    double duration = 60;     ///< s
    double output_step = 0;   ///< 0: the integrator's own steps
    double tolerance = 1e-9;  ///< relative; absolute: times 1 mm and 1 mm/s
    bool stop_at_contact = false;
    bool stop_at_equilibrium = false;
    double escape_gap = 0;  ///< stop above this gap; 0: never
    double settle_speed =
        1e-6;  ///< m/s: at equilibrium when slower, and the force too small to exceed it within a second
};

struct TrajectoryEvent {
    double time = 0;
    std::string kind;  ///< contact, lift_off, escape, equilibrium
    double gap = 0;
    double velocity = 0;  ///< just before
};

struct Trajectory {
    std::vector<double> time, gap, heave_velocity, lift_force, heave_drag, input_force;
    std::vector<bool> outside;  ///< a table was asked beyond its range there
    std::vector<TrajectoryEvent> events;
    std::string end;  ///< "time", "contact", "escape", "equilibrium"
    core::Problems remarks;
    [[nodiscard]] core::Table table() const;
};

/// The motion from (gap, heave_velocity). `inputs` may be empty (no signals, no times): everything held.
/// `feedback` (surrogates/dynamics/simulate/feedback.h) closes the loop; nullptr: open.
/// Throws core::InputError for a start inside the ground; core::Error (kind "integration") when CVODE gives up.
Trajectory simulate(const Model& model, double gap, double heave_velocity, const InputSignals& inputs,
                    const TrajectoryOptions& options, core::Progress& progress = core::Progress::none(),
                    const struct HeaveFeedback* feedback = nullptr);

/// A plant for a run with these inputs: what varies in them is not folded.
HeavePlant plant_for(const Model& model, const InputSignals& inputs);

/// Gap and velocity against time with events and equilibria.
core::Figure trajectory_figure(const Trajectory& trajectory, const std::vector<struct HeaveEquilibrium>& equilibria);
void to_json(nlohmann::json& json, const Trajectory& trajectory);

/// An equilibrium of the free heave motion (inputs as held).
struct HeaveEquilibrium {
    std::string name;  ///< "A", "B", ... for attractors from the ground up; "U1", ... for unstable ones
    double gap = 0;
    double pitch = 0;  ///< rad, of heave and pitch together; 0 in heave alone
    bool stable = false;
    double stiffness = 0;  ///< -dF/dh, N/m
    double frequency = 0;  ///< rad/s, sqrt(k/M), 0 when unstable
    double damping_ratio = 0;
    double growth = 0;  ///< 1/s of an unstable one
};
std::vector<HeaveEquilibrium> heave_equilibria(const HeavePlant& plant);

}  // namespace underbody::dynamics
