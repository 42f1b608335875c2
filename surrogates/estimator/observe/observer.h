// Observers of separate and total forces. All linear ones compile to one small filter without allocation, which exports
// to C99.
//
// Split of an augmented model: x measured (heave_velocity, gap), zeta auxiliary (ground_force, drag_force ...). Source:
// thesis 8.2-8.3 with the corrections of docs/physics.md section 7. Error convention: e = truth - estimate.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "surrogates/estimator/model/augmented_model.h"

namespace underbody::estimator {

/// How a measured signal is taken between samples. Inputs are always held.
enum class Hold {
    euler,        ///< explicit Euler; only to show the identity with the thesis's recursion
    zero_order,   ///< held, matrix exponential
    first_order,  ///< linear between samples, matrix exponential (default)
};

/// s_k = phi s_{k-1} + previous y_{k-1} + present y_k + input u_{k-1} + constant,   estimates = output s_k + feed y_k +
/// output_constant. y: measured values at a sample, u: input held over the step before it.
struct LinearFilter {
    std::string name;
    double step = 0;  ///< s
    std::vector<std::string> measured, inputs, estimates;
    Matrix phi, previous, present, input;
    Vector constant;
    Matrix output, feed;
    Vector output_constant;
    Vector start;  ///< s at the first sample is start + start_feed y_0
    Matrix start_feed;
};

/// Runs a LinearFilter: no allocation, no exception in step(). At most 16 states, 8 measured, 8 inputs, 16 estimates.
class FilterRunner {
public:
    static constexpr std::size_t most_states = 16, most_signals = 8;
    /// Throws core::InputError when the filter is larger than that or its sizes disagree.
    explicit FilterRunner(const LinearFilter& filter);

    /// First sample. `estimates` receives what the start values say.
    void start(const double* measured, double* estimates) noexcept;
    /// Next sample; `input` was held since the last one.
    void step(const double* measured, const double* input, double* estimates) noexcept;
    [[nodiscard]] std::size_t estimates() const { return outputs_; }
    /// The filter's inner state (not the estimates).
    [[nodiscard]] const double* state() const { return state_; }

private:
    std::size_t states_, measured_, inputs_, outputs_;
    double phi_[most_states * most_states];
    double previous_[most_states * most_signals], present_[most_states * most_signals],
        input_[most_states * most_signals];
    double constant_[most_states];
    double output_[most_states * most_states], feed_[most_states * most_signals], output_constant_[most_states];
    double start_[most_states], start_feed_[most_states * most_signals];
    double state_[most_states], last_[most_signals];
};

/// What can be separated, and on what the split rests.
struct Separability {
    Observability reduced;   ///< of (J_zeta, A_zeta): the auxiliary variables from the measured ones
    Observability full;      ///< of (A, C)
    double determinant = 0;  ///< (j11 + j12 - j21 - j22)/S^2 for two forces
    double b_eff = 0;  ///< J_x21 / -(j21 + j22), N s/m: the drag law that the model holds at slow drift; NaN: none
    /// Per auxiliary variable: "observed", "model-dependent", "unobservable".
    std::vector<std::string> labels;
    std::string explanation;
};
/// `trusted_drag`: the user vouches for the embedded drag law; labels stay "model-dependent", which is what they are.
Separability separability(const AugmentedModel& model);

struct ObserverDesign {
    LinearFilter filter;
    Matrix gain;
    Poles poles;           ///< of the error in continuous time
    Poles discrete_poles;  ///< of the filter
    Matrix covariance;     ///< of the estimates, when noise was given; else empty
    Separability separability;
    std::vector<std::string> labels;  ///< per estimate of the filter
    core::Problems remarks;
};

/// Gain of the reduced-order observer for these poles: Ackermann on (J_zeta, row of heave_velocity in A_zeta). The
/// other columns multiply a residual that is zero (dh - w) and are 0. Throws core::InputError (kind "unobservable")
/// with the direction.
Matrix reduced_gain(const AugmentedModel& model, const Poles& poles);

/// Reduced order, xi form: needs all measured states. Estimates: auxiliary variables, then total_force where both
/// forces are there. Throws core::InputError (kind "unstable") when J_zeta - L A_zeta is not Hurwitz or the step makes
/// the filter unstable.
ObserverDesign reduced_observer(const AugmentedModel& model, const Matrix& gain, double step,
                                Hold hold = Hold::first_order, const Vector& zeta_start = {});
/// Full order on any of the states as sensors. Estimates: all states, then total_force.
ObserverDesign full_observer(const AugmentedModel& model, const std::vector<std::string>& sensors, const Matrix& gain,
                             double step, Hold hold = Hold::first_order, const Vector& start = {});
/// Poles by name of sensors: place() on (A, C).
Matrix full_gain(const AugmentedModel& model, const std::vector<std::string>& sensors, const Vector& poles);

/// The full-order observer run in rotated, normalised coordinates z = T' Sigma^-1 (x - mean), T orthonormal and square:
/// L_z = T' Sigma^-1 L. Same estimates; error norms differ (the map is no isometry in physical units).
ObserverDesign latent_observer(const AugmentedModel& model, const Matrix& rotation, const Vector& scale,
                               const Vector& centre, const std::vector<std::string>& sensors, const Matrix& gain,
                               double step, Hold hold = Hold::first_order);

/// A square orthonormal T that mixes velocity with ground force and gap with drag, by 45 degrees each: one as good as
/// any other.
Matrix usual_rotation();

/// The thesis's second latent form (8.36-8.43) with x in place of its estimate: its error matrix W (A_z - L_z V) W' for
/// a latent gain L_z, in normalised coordinates. It equals J_zeta whatever L_z is: the gain cancels.
struct LatentProjection {
    Matrix error_matrix;    ///< W (A_z - L_z V) W'
    Matrix j_zeta;          ///< normalised
    double innovation = 0;  ///< max |(I - V V') x - V W' zeta| over unit vectors: 0
};
LatentProjection latent_projection(const AugmentedModel& normalised, const Matrix& rotation, const Matrix& latent_gain);

/// Total force alone: F_T_hat = xi + l S w, dxi = -l (F_T_hat + u + bias). Needs no force model. `rate` l in 1/s.
/// Estimates: total_force.
ObserverDesign disturbance_observer(double virtual_mass, double bias, double rate, double step,
                                    Hold hold = Hold::first_order);

/// Steady-state Kalman filter of the model with random forcing: `process` spectral density per state (unit^2/s),
/// `sensor_sigma` per sensor and sample. Throws core::InputError with the direction when a mode is neither seen nor
/// decays. Estimates: all states, then total_force; `covariance` after the measurement.
ObserverDesign kalman_observer(const AugmentedModel& model, const std::vector<std::string>& sensors,
                               const Vector& process, const Vector& sensor_sigma, double step);

/// Deviation of each estimate for white sensor noise of `sensor_sigma` per sample (steady state, from the discrete
/// Lyapunov equation).
Vector noise_gain(const LinearFilter& filter, const Vector& sensor_sigma);

/// One header of C99, no heap, no library: struct NAME_state, NAME_start(), NAME_step(). Numbers with all their digits.
/// Throws core::InputError when NAME is no C identifier.
std::string export_c(const LinearFilter& filter, const std::string& name,
                     const std::vector<std::string>& made_from = {});

void to_json(nlohmann::json& json, const Separability& separability);
void to_json(nlohmann::json& json, const ObserverDesign& design);

}  // namespace underbody::estimator
