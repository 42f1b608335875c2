// The loop closed over the nonlinear plant: feedback on gap and velocity with cancellation of estimated forces.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/table.h"
#include "surrogates/estimator/model/training.h"
#include "surrogates/estimator/observe/extended_filter.h"
#include "surrogates/estimator/observe/observer.h"

namespace underbody::estimator {

/// u = -k_w w - k_h (h - h_ref) - (F_g_hat - F_d_hat) - bias (thesis 8.45 with its sign mended: the drag is a
/// resistance).
struct ControlLaw {
    double velocity_gain = 0;                                ///< k_w, N s/m
    double gap_gain = 0;                                     ///< k_h, N/m
    double reference_gap = 0;                                ///< m
    bool cancel = true;                                      ///< subtract the estimated total force
    bool cancel_bias = true;                                 ///< subtract bottom jet less net weight
    double limit = std::numeric_limits<double>::infinity();  ///< |u| at most, N
};
/// Gains for two poles of S d2h/dt2 = u.
ControlLaw hold_at(double reference_gap, double virtual_mass, double pole1, double pole2);

/// Which estimate the law cancels with.
enum class ForceSource { truth, filter, extended, none };

/// The estimator in the loop.
struct LoopEstimator {
    std::string name = "none";
    ForceSource source = ForceSource::none;
    std::optional<LinearFilter> filter;  ///< of ForceSource::filter
    /// Of ForceSource::extended: what the filter takes sensors and force for. Its velocity 0: the gap alone is
    /// measured.
    FilterNoise noise;
    /// Of ForceSource::extended: the plant that the filter believes in; none: the true one.
    std::optional<SeparatedPlant> believed;

    static LoopEstimator nothing() { return {}; }  ///< no cancellation
    static LoopEstimator true_force() { return {"truth", ForceSource::truth, {}, {}, {}}; }
    static LoopEstimator with(const LinearFilter& f) { return {f.name, ForceSource::filter, f, {}, {}}; }
};

/// Names that design_loop_estimator knows: disturbance, reduced, full, latent, kalman, extended, truth, none.
const std::vector<std::string>& loop_estimators();

struct LoopDesign {
    double rate = 4;               ///< 1/s: the slowest pole of the error (linear observers but kalman)
    double step = 0.02;            ///< s
    double gap_noise = 2e-4;       ///< m per sample, for kalman and extended
    double velocity_noise = 1e-4;  ///< m/s per sample, likewise
    bool velocity_measured = true;
};
/// An estimator for this plant, its linear law learned from 20,000 samples over the table with known rows (correction
/// p3: no fictitious force of the gap). Throws core::InputError: unknown name (with the nearest), an estimator that
/// needs a velocity sensor where there is none, poles that make it unstable.
LoopEstimator design_loop_estimator(const std::string& name, const SeparatedPlant& plant, const LoopDesign& design);

/// What the feedback on gap and velocity sees.
enum class Feedback {
    measured,   ///< the sensors' values with their noise
    estimated,  ///< the estimator's, where it gives them; else the sensors'
    truth,      ///< for studies
};

struct LoopOptions {
    double duration = 60;                            ///< s
    double step = 0.02;                              ///< s, sample time of sensors, estimator and law
    double actuator_lag = 0;                         ///< s, time constant between command and force
    double velocity_noise = 0;                       ///< m/s per sample
    double gap_noise = 0;                            ///< m per sample
    double gap = 0.25, velocity = 0;                 ///< start
    std::function<double(double time)> disturbance;  ///< N, up; may be empty
    std::uint64_t seed = 1;
    Feedback feedback = Feedback::measured;
    bool velocity_measured =
        true;  ///< without a velocity sensor the feedback needs an estimator that gives heave_velocity
};

/// For the sample time and the sensors of a loop; a sensor without noise is taken as LoopDesign says.
LoopDesign design_for(const LoopOptions& loop, double rate);

struct LoopRun {
    std::vector<double> time, gap, velocity, command, force, disturbance, ground_force, drag_force, ground_estimate,
        drag_estimate, total_estimate;
    double hold_error = 0;  ///< m, mean of gap - reference over the last tenth
    double hold_sigma = 0;  ///< m, deviation over the last tenth
    /// N, rms over the second half, against F_g - F_d with the disturbance: all that acts unknown; none: nothing is
    /// estimated.
    std::optional<double> total_force_error;
    double saturated = 0;  ///< share of samples at the limit
    bool touched = false;  ///< reached the contact gap
    bool finite = true;

    [[nodiscard]] core::Table table() const;
};

/// A linear filter measures heave_velocity and/or gap by name; its estimates are found by name (total_force, or
/// ground_force and drag_force; gap and heave_velocity for Feedback::estimated). Throws core::InputError: a filter at
/// another step, a filter that measures what the loop does not, feedback without a velocity.
LoopRun close_loop(const SeparatedPlant& plant, const ControlLaw& law, const LoopEstimator& estimator,
                   const LoopOptions& options);

/// The loop a sample at a time, for maps of many starts.
class Loop {
public:
    /// All must outlive the loop. `stream`: of the noise.
    Loop(const SeparatedPlant& plant, const ControlLaw& law, const LoopEstimator& estimator, const LoopOptions& options,
         double gap, double velocity, std::uint64_t stream = 0);
    ~Loop();
    /// Senses, estimates, commands and moves by one step.
    void advance();
    [[nodiscard]] double gap() const;       ///< m, true
    [[nodiscard]] double velocity() const;  ///< m/s, true
    struct Impl;
    [[nodiscard]] const Impl& parts() const { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

/// Steps of the plant over one sample of the loop.
int loop_substeps(double step);

/// The controller of the loop as one header of C99, no heap, no library: the law with its limit, its estimator where it
/// is a linear filter, and what the model's actuator and `options.actuator_lag` make of the commands. struct
/// NAME_state, NAME_start(state), then at every sample NAME_step(state, gap, heave_velocity), which gives the force to
/// command (N, up); without a velocity sensor NAME_step(state, gap). NAME_step_with takes the mean force of the
/// actuator over the sample before as a last argument, where that is measured. Throws core::InputError: NAME is no C
/// identifier; an estimator that is no linear filter (extended, truth); what close_loop would refuse.
std::string export_controller_c(const SeparatedPlant& plant, const ControlLaw& law, const LoopEstimator& estimator,
                                const LoopOptions& options, const std::string& name,
                                const std::vector<std::string>& made_from = {});

/// Where the loop without cancellation parks: root of F_g(h) + bias (unless cancelled) = k_h (h - h_ref), from the
/// start down the closed-loop motion (oracle O88). All roots, ascending, with stability.
struct HoldPoint {
    double gap = 0;
    bool stable = false;
};
std::vector<HoldPoint> hold_points_without_cancellation(const SeparatedPlant& plant, const ControlLaw& law);

/// Poles of the linear loop: those of A_x - B K_x together with those of the observer (separation), when the filter's
/// own model is the plant.
struct Separation {
    Poles controller, observer, loop;
    double mismatch = 0;  ///< largest distance of a pole of the loop from the union
};
Separation separation(const AugmentedModel& model, const ControlLaw& law, const Matrix& reduced_gain);

void to_json(nlohmann::json& json, const LoopRun& run);

}  // namespace underbody::estimator
