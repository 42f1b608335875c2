// Linear analysis about a trim: system matrices, named modes, controllability, poles and zeros, LQR, PD bounds.
#pragma once

#include <complex>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/figure.h"
#include "surrogates/dynamics/model/jets.h"
#include "surrogates/dynamics/model/matrix.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// dx/dt = A dx + B du about a trim.
struct LinearSystem {
    Matrix a, b;
    std::vector<std::string> states, inputs;
    std::vector<double> state_trim, input_trim;
};

/// Central differences with steps of `step` times the scale of each variable. `rate(x, u, dxdt)`.
LinearSystem linearise(const std::function<void(const double* x, const double* u, double* rate)>& rate,
                       const std::vector<double>& x, const std::vector<double>& u,
                       const std::vector<std::string>& states, const std::vector<std::string>& inputs,
                       const std::vector<double>& state_scale, const std::vector<double>& input_scale,
                       double step = 1e-5);

struct Mode {
    std::string name;            ///< after the states that take part most: "heave", "sway-yaw", "pitch"
    std::complex<double> value;  ///< 1/s; one of a complex pair (the upper)
    double damping_ratio = 0;    ///< -cos of the angle of the pole
    double frequency = 0;        ///< rad/s, natural
    double time_constant = 0;    ///< s, of decay or (negative) of growth
    bool stable = false;
    /// Neither decays nor grows, to rounding: a state that nothing brings back, such as heading or place, or a swing
    /// without damping.
    bool neutral = false;
    std::vector<double> participation;  ///< one per state, sums to 1
};
/// `groups`: for each state the word its motion is called by ("sway", "yaw", ...); states of one word count together.
std::vector<Mode> modes(const LinearSystem& system, const std::vector<std::string>& groups);

struct Controllability {
    int rank = 0;
    double weakness = 0;  ///< smallest over largest singular value of [B AB ...]: near zero is weak
    std::vector<std::vector<double>> uncontrollable;  ///< left eigenvectors that no input moves
};
Controllability controllability(const LinearSystem& system, double tolerance = 1e-10);

/// Zeros of the transfer from one input to one state: finite generalised eigenvalues of the system pencil.
std::vector<std::complex<double>> zeros(const LinearSystem& system, std::size_t input, std::size_t state);

/// u = -K x of least cost integral x'Qx + u'Ru.
struct Regulator {
    Matrix gain;
    std::vector<std::complex<double>> poles;  ///< of A - B K
};
Regulator lqr(const LinearSystem& system, const Matrix& q, const Matrix& r);

// ---- Surface motion, states u, v, r, psi about a steady run at speed U (docs/physics.md section 3.5). ----

struct SurfaceCoefficients {
    double mass_x = 0, mass_y = 0, inertia_r = 0;  ///< S_x, S_y, S_r
    double munk = 0;                               ///< C_mm = A_x - A_y, kg
    double drag_x = 0;                             ///< D_u, N s^2/m^2
};
/// Throws core::InputError when the model lacks the yaw inertia.
SurfaceCoefficients surface_coefficients(const Model& model);
/// Yaw rate and thrust difference d = F1 - F2: A of (v, r), b = (sin(gamma) cos(beta)/S_y, -(L_tv cos(gamma) + L_tu
/// sin(gamma)) cos(beta)/S_r).
struct YawTransfer {
    std::vector<std::complex<double>> poles;
    double zero = 0;            ///< 1/s; positive: non-minimum phase
    double side = 0, turn = 0;  ///< b_y, b_r
};
YawTransfer yaw_transfer(const SurfaceCoefficients& c, double speed, double friction_force, const EvieJets& jets);

/// Heading by M_z = K2 (psi_d - psi) + K1 d/dt(psi_d - psi): bounds of the gains with sway included.
struct HeadingBounds {
    double a = 0;              ///< mu N/(U S_y), 1/s
    double omega_squared = 0;  ///< S_x |C_mm| U^2/(S_y S_r), 1/s^2
    [[nodiscard]] bool stable(double k1, double k2, double inertia_r) const;
    double least_k2_without_friction = 0;  ///< S_r Om^2, N m/rad (for a = 0; K1 > 0)
};
HeadingBounds heading_bounds(const SurfaceCoefficients& c, double speed, double friction_force);

/// Yaw torque that the turning jets give against their angle gamma, with the torque that sideslip (Munk) and one-sided
/// friction ask for, and what it costs in surge thrust.
struct GammaChart {
    std::vector<double> gamma, torque, surge;  ///< rad, N m, share of thrust left forward
    double best_gamma = 0;                     ///< most torque: tan = L_tu/L_tv
    double needed = 0;                         ///< N m
    double least_gamma = 0;                    ///< smallest angle that gives the needed torque; NaN when none does
    double beta = 0;                           ///< that nulls thrust pitch at that angle (or at the best)
};
GammaChart gamma_chart(const SurfaceCoefficients& c, const EvieJets& jets, double speed, double sideslip,
                       double friction_force, double friction_offset);
core::Figure gamma_figure(const GammaChart& chart);

// ---- Heave about a gap, with feedback u = -k_w w - k_h (h - h_ref). ----

/// Gap where feedback and ground effect balance, nearest to the reference: F_g(h) + bias = k_h (h - h_ref).
double held_gap(const std::function<double(double)>& force, double gain, double reference, double bias = 0);

}  // namespace underbody::dynamics
