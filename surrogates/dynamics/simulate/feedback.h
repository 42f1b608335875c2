// Feedback on heave, and equilibria against a condition: what closed-loop maps and design plots need.
#pragma once

#include <array>
#include <complex>
#include <string>
#include <vector>

#include "core/figure.h"
#include "surrogates/dynamics/linear/linear.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"

namespace underbody::dynamics {

/// Closes the loop through the actuator that the model declares (input_delay, input_dead_zone, input_gain,
/// actuator_lag). With neither limit nor delay, dead zone or lag it is a spring and a damper, so that the energy
/// argument of the region still holds.
void close_loop(HeavePlant& plant, const HeaveFeedback& feedback);

/// A number that a text may set by its name.
struct NamedNumber {
    const char* name;
    const char* unit;  ///< SI, of the number and of a text without one
    double* value;
};
/// "gap_gain=10,reference=20mm" onto numbers. Throws core::UsageError for a name that is none of them, with the
/// nearest.
void assign(const std::string& text, const std::vector<NamedNumber>& numbers);
/// "gap_gain=10,velocity_gain=9,reference=20mm,limit=0.05N". Throws core::UsageError.
HeaveFeedback heave_feedback(const std::string& gains);
/// Also pitch_gain, pitch_rate_gain, pitch_reference, moment_limit.
PitchFeedback pitch_feedback(const std::string& gains);

/// LQR gains of heave at a gap: states (heave_velocity, gap), weights q = (q_w, q_h), r, on M dw/dt = -k (h - h0) - d w
/// + g u with the gain g of the actuator that the model declares (input_gain, thrust_by_gap) there; 0 where nothing of
/// the input reaches the body. Its delay, lag and dead zone are not known to the gains: loop_remarks().
HeaveFeedback heave_lqr(const HeavePlant& plant, double gap, double velocity_weight, double gap_weight,
                        double input_weight);

/// Weights of the regulator of heave and pitch: of the square of each state (gap, heave_velocity, pitch, pitch_rate) in
/// SI, and of the force and the moment.
struct PitchWeights {
    std::array<double, 4> state{100, 1, 10, 0.1};
    double force = 1, moment = 100;
};
/// LQR about a gap and a pitch, both inputs, the force as the actuator's gain passes it on. Throws core::Error (kind
/// "control") when there is none.
PitchFeedback pitch_lqr(const HeavePitch& plant, double gap, double pitch, const PitchWeights& weights);
/// Poles of the loop closed, about the reference, without the actuator's delay and lag.
std::vector<std::complex<double>> closed_poles(const HeavePitch& plant, const PitchFeedback& feedback);

/// Rightmost pole of dx/dt = a x - b f, where f is k x after a delay (s) and a first-order lag (s): what decides
/// whether a loop is stable. By collocation over the delay (Breda, Maset and Vermiglio 2005).
std::complex<double> rightmost_pole(const Matrix& a, const Matrix& b, const Matrix& k, double delay, double lag);

/// Warnings on a loop: a reference outside the force tables or in the ground, gains that drive away from it, and what
/// delay, lag and dead zone of the declared actuator make of gains that do not know them (`designed`: by LQR).
core::Problems loop_remarks(const HeavePlant& plant, const HeaveFeedback& feedback, bool designed);
core::Problems loop_remarks(const HeavePitch& plant, const PitchFeedback& feedback, bool designed);

/// Equilibria for a range of one condition (jet_voltage, speed, ...).
struct EquilibriumSweep {
    Channel channel = Channel::jet_voltage;
    std::vector<double> value;
    std::vector<std::vector<HeaveEquilibrium>> equilibria;
};
EquilibriumSweep equilibrium_sweep(const Model& model, const Conditions& held, Channel channel, double lower,
                                   double upper, std::size_t count);
core::Figure equilibrium_figure(const EquilibriumSweep& sweep);

}  // namespace underbody::dynamics
