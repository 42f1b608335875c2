// Training data for the augmented model, from any heave plant: on a grid of the region, or along trajectories.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/dynamics/plant/heave_equation.h"
#include "surrogates/estimator/model/augmented_model.h"

namespace underbody::dynamics {
struct Model;
struct HeaveState;
}  // namespace underbody::dynamics

namespace underbody::estimator {

/// Slopes of a resistance along gap and velocity.
struct DragSlopes {
    double gap = 0, velocity = 0;
};
using ResistanceLaw = std::function<double(double gap, double velocity, DragSlopes& slopes)>;

/// The heave plant with its forces apart:
///   M(h) dw/dt + 1/2 M'(h) w^2 = F_g(h) - F_d(h, w) + u + bias + other(t, h, w, u), dh/dt = w.   SI, gap up, F_d a
///   resistance.
struct SeparatedPlant {
    double virtual_mass = 1;  ///< S = mass + added mass far from the ground, kg
    double bias = 0;          ///< bottom jet less net weight, N
    /// F_g(h) and its slope dF_g/dh: tables, springs, corrections over the gap. Called from several threads.
    std::function<double(double gap, double& slope)> ground_force;
    /// F_d(h, w): drag of the water, film, friction of a guide, corrections over the velocity.
    ResistanceLaw drag_force;
    std::function<dynamics::HeaveInertia(double gap)> inertia;  ///< empty: virtual_mass everywhere
    /// Waves and corrections over several variables, which are neither; empty: none.
    std::function<dynamics::HeaveLoad(double time, double gap, double velocity, double input)> other_force;
    /// The largest rate, 1/s, that the law can show over a step, beside its slopes where the step begins; empty: those
    /// say all.
    std::function<double(const dynamics::HeaveState& state, double acceleration, double step)> fastest_rate;
    dynamics::Actuator actuator;                                    ///< between the commanded input and u
    double contact_gap = -std::numeric_limits<double>::infinity();  ///< the body cannot go below
    double restitution = 0;                                         ///< of the velocity there
    double lower = 0, upper = 1;                                    ///< gaps that the force table covers
    core::Problems remarks;                                         ///< what the separation leaves out

    [[nodiscard]] dynamics::HeaveInertia inertia_at(double gap) const {
        return inertia ? inertia(gap) : dynamics::HeaveInertia{virtual_mass, 0, 0};
    }
    /// kg, M(gap).
    [[nodiscard]] double mass_at(double gap) const { return inertia_at(gap).mass; }
    [[nodiscard]] double acceleration(double gap, double velocity, double input, double time = 0) const {
        dynamics::HeaveSlopes slopes;
        return acceleration(gap, velocity, input, time, slopes);
    }
    double acceleration(double gap, double velocity, double input, double time, dynamics::HeaveSlopes& slopes) const;
    /// F_d(h, w) alone.
    [[nodiscard]] double drag(double gap, double velocity) const {
        DragSlopes slopes;
        return drag_force(gap, velocity, slopes);
    }
    /// Over one step with the input held; bounces or stops at the contact gap.
    void advance(double& gap, double& velocity, double input, double step, double time = 0) const;
};

/// linear w + quadratic w|w|
ResistanceLaw quadratic_drag(double linear, double quadratic);

/// The heave plant of a declared model at held conditions: the simulator's own equation with its forces apart. Only the
/// memory of a history force is left out, and named in `remarks`.
SeparatedPlant separate(const dynamics::Model& model, const dynamics::Conditions& held);

enum class Excitation { none, white, pink, pulses };

struct TrainingOptions {
    enum class Method { grid, time } method = Method::grid;
    std::vector<std::string> auxiliaries = {"ground_force", "drag_force"};  ///< see known_auxiliaries()
    std::size_t samples = 50000;
    double gap_lower = 0, gap_upper = 1.2;                 ///< m
    double velocity_lower = -0.03, velocity_upper = 0.03;  ///< m/s
    bool start_at_rest = false;                            ///< time: every trajectory starts with w = 0
    Excitation excitation = Excitation::pink;
    double input_sigma = 0.01;  ///< N
    /// Grid on a deterministic mesh, inclusive of its ends: inputs +/- input_sigma, velocities, gaps. All zero: random.
    std::size_t mesh_inputs = 0, mesh_velocities = 0, mesh_gaps = 0;
    /// This share of samples (starts) is drawn from the band of gaps [focus_lower, focus_upper].
    double focus_share = 0, focus_lower = 0, focus_upper = 0;
    double duration = 10;        ///< time: s of each trajectory
    double interval = 0.1;       ///< time: s between samples; the input is held over it
    double largest_step = 0.02;  ///< time: s, of the integrator
    /// 0: derivatives exact at the sample; else forward differences over this step (to show what they leave in the
    /// model).
    double difference_step = 0;
    std::uint64_t seed = 1;
};

/// Samples in rows: inputs, states, derivatives, as layout.names().
struct TrainingSet {
    Layout layout;
    std::size_t count = 0;
    std::vector<double> values;
    double outside = 0;  ///< share of samples beyond the table's range (end values held there)
    core::Problems remarks;

    [[nodiscard]] SampleView view() const {
        return SampleView::samples_in_rows(values.data(), count, layout.channels());
    }
    [[nodiscard]] double at(std::size_t sample, std::size_t channel) const {
        return values[sample * layout.channels() + channel];
    }
};

/// ground_force, drag_force, total_force (F_g - F_d), ground_slope (dF_g/dh), drag_slope (dF_d/dw), gap_squared,
/// gap_cubed, velocity_squared (w|w|).
const std::vector<std::string>& known_auxiliaries();

/// Deterministic for its seed whatever the number of threads. Throws core::InputError: unknown auxiliary (nearest
/// name), empty region, below the contact gap, more than 4,000,000 samples, steps that are not positive.
TrainingSet training_set(const SeparatedPlant& plant, const TrainingOptions& options,
                         core::Progress& progress = core::Progress::none());

/// One sample at (u, w, h) as the training set holds it; `row` has layout.channels() entries.
void sample_at(const SeparatedPlant& plant, const Layout& layout, double input, double velocity, double gap,
               double* row);

/// (inputs, states) at the lowest stable rest point within the gaps, no input: the point of OffsetMode::equilibrium.
/// Throws core::InputError when there is none.
Vector equilibrium_point(const SeparatedPlant& plant, const Layout& layout, double gap_lower, double gap_upper);

/// The plant's own linearisation at a point (frozen): rows F_g'(h) w and F_d'(w) dw (thesis 8.51 with its 1/S and
/// signs).
AugmentedModel frozen_model(const SeparatedPlant& plant, double gap, double velocity);

/// d(w, h) linear in (w, h): tangent at a point, or with equivalent drag damping for a root-mean-square velocity
/// (Gaussian: sqrt(8/pi) D w_rms, sinusoid: 8 sqrt(2)/(3 pi) D w_rms; thesis 7.10 has factor 1). Offset included.
struct PlaneModel {
    Matrix A;       ///< 2 x 2 over (w, h): 1/s and 1/s^2, 1 and 0
    Vector B;       ///< 2, over the input: 1/kg and 0
    Vector offset;  ///< 2: m/s^2 and 0
};
PlaneModel tangent_model(const SeparatedPlant& plant, double gap, double velocity);
enum class MotionShape { gaussian, sinusoid };
double equivalent_drag_factor(MotionShape shape);  ///< of quadratic drag: damping = factor * D * w_rms
PlaneModel equivalent_model(const SeparatedPlant& plant, double gap, double velocity_rms, MotionShape shape);

}  // namespace underbody::estimator
