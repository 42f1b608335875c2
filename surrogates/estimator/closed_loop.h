// The loop closed over the nonlinear plant: feedback on gap and velocity with cancellation of estimated forces.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/table.h"
#include "surrogates/estimator/observer.h"
#include "surrogates/estimator/training.h"

namespace underbody::estimator {

/// u = -k_w w - k_h (h - h_ref) - (F_g_hat - F_d_hat) - bias (thesis 8.45 with its sign mended: the drag is a resistance).
struct ControlLaw {
    double velocity_gain = 0;   ///< k_w, N s/m
    double gap_gain = 0;        ///< k_h, N/m
    double reference_gap = 0;   ///< m
    bool cancel = true;         ///< subtract the estimated total force
    bool cancel_bias = true;    ///< subtract bottom jet less net weight
    double limit = std::numeric_limits<double>::infinity();  ///< |u| at most, N
};
/// Gains for two poles of S d2h/dt2 = u.
ControlLaw hold_at(double reference_gap, double virtual_mass, double pole1, double pole2);

/// Which estimate the law cancels with.
enum class ForceSource { truth, filter, none };

struct LoopOptions {
    double duration = 60;       ///< s
    double step = 0.02;         ///< s, sample time of sensors, estimator and law
    double actuator_lag = 0;    ///< s, time constant between command and force
    double velocity_noise = 0;  ///< m/s per sample
    double gap_noise = 0;       ///< m per sample
    double gap = 0.25, velocity = 0;  ///< start
    std::function<double(double time)> disturbance;  ///< N, up; may be empty
    std::uint64_t seed = 1;
    bool noisy_feedback = true; ///< the law sees the measured values (else the true ones, for studies)
};

struct LoopRun {
    std::vector<double> time, gap, velocity, command, force, disturbance, ground_force, drag_force, ground_estimate, drag_estimate,
        total_estimate;
    double hold_error = 0;        ///< m, mean of gap - reference over the last tenth
    double hold_sigma = 0;        ///< m, deviation over the last tenth
    double total_force_error = 0; ///< N, root mean square of the estimate's error over the second half
    double saturated = 0;         ///< share of samples at the limit
    bool touched = false;         ///< reached the contact gap
    bool finite = true;

    [[nodiscard]] core::Table table() const;
};

/// The filter measures heave_velocity and/or gap by name; its estimates are found by name (total_force, or ground_force and
/// drag_force). Without a filter the law cancels the truth or nothing. Throws core::InputError for a filter at another step.
LoopRun close_loop(const SeparatedPlant& plant, const ControlLaw& law, ForceSource source, const std::optional<LinearFilter>& filter,
                   const LoopOptions& options);

/// Where the loop without cancellation parks: root of F_g(h) + bias (unless cancelled) = k_h (h - h_ref), from the start down the
/// closed-loop motion (oracle O88). All roots, ascending, with stability.
struct HoldPoint {
    double gap = 0;
    bool stable = false;
};
std::vector<HoldPoint> hold_points_without_cancellation(const SeparatedPlant& plant, const ControlLaw& law);

/// Poles of the linear loop: those of A_x - B K_x together with those of the observer (separation), when the filter's own model is
/// the plant.
struct Separation {
    Poles controller, observer, loop;
    double mismatch = 0;  ///< largest distance of a pole of the loop from the union
};
Separation separation(const AugmentedModel& model, const ControlLaw& law, const Matrix& reduced_gain);

/// Where starts of the closed loop end, on a grid of (gap, velocity): holds at the reference, parks elsewhere, touches, escapes.
struct LoopRegion {
    std::size_t columns = 0, rows = 0;
    double gap_lower = 0, gap_upper = 0, velocity_lower = 0, velocity_upper = 0;
    std::vector<int> index;  ///< [row * columns + column]: 0 holds, 1 parks elsewhere, 2 touches the ground, 3 escapes, 4 undecided
    double holds = 0;        ///< share of the area
    [[nodiscard]] core::Figure figure(const std::string& title) const;
};
LoopRegion loop_region(const SeparatedPlant& plant, const ControlLaw& law, ForceSource source,
                       const std::optional<LinearFilter>& filter, const LoopOptions& options, std::size_t columns, std::size_t rows,
                       double gap_lower, double gap_upper, double velocity_lower, double velocity_upper,
                       core::Progress& progress = core::Progress::none());

void to_json(nlohmann::json& json, const LoopRun& run);

}  // namespace underbody::estimator
