// Linear time-invariant systems: poles, observability, gains, exact discretisation, Riccati and Lyapunov equations.
// Continuous dx = A x + B u, y = C x unless a name says discrete. All matrices small (at most a few tens of rows).
#pragma once

#include <string>
#include <vector>

#include "surrogates/dynamics/model/matrix_algebra.h"
#include "surrogates/estimator/model/matrix.h"

namespace underbody::estimator {

using dynamics::eigenvalues;
using dynamics::exponential;
using dynamics::inverse;
using dynamics::logarithm;
using dynamics::lyapunov;
using dynamics::Poles;
using dynamics::pseudo_inverse;
using dynamics::singular_values;
using dynamics::solve;

/// Largest real part ("spectral abscissa"): negative for a Hurwitz matrix.
double spectral_abscissa(const Matrix& a);
double spectral_radius(const Matrix& a);

/// Rank of the observability matrix [C; CA; ...] and what cannot be seen.
struct Observability {
    std::size_t rank = 0;
    Vector singular_values;  ///< of the observability matrix of the pair balanced by `scale`, descending
    Matrix
        unobservable;  ///< orthonormal columns that span the unobservable subspace (state coordinates); none: 0 columns
    Poles unobservable_poles;  ///< eigenvalues of A on that subspace
    bool detectable = true;    ///< they all lie left of -1e-9
};
/// `scale` (optional) holds a typical size per state, so that the rank does not depend on units. Popov-Belevitch-Hautus
/// test at every eigenvalue decides, with relative tolerance on singular values.
Observability observability(const Matrix& a, const Matrix& c, const Vector& scale = {}, double tolerance = 1e-9);
/// Throws core::InputError (kind "unobservable") that names the first direction that cannot be seen.
[[noreturn]] void refuse_unobservable(const Observability& seen, const std::vector<std::string>& names);
/// "0.71 ground_force + 0.71 drag_force"
std::string direction_text(const Vector& direction, const std::vector<std::string>& names);

/// Gain l (n x 1) such that A - l c has the poles (Ackermann 1972). c is 1 x n.
/// Throws core::InputError naming the direction that cannot be seen when (A, c) is not observable; complex poles must
/// come in pairs.
Matrix place_single_output(const Matrix& a, const Matrix& c, const Poles& poles,
                           const std::vector<std::string>& names = {});
/// Gain L (n x p) such that A - L C has the poles: Kautsky, Nichols and Van Dooren (1985), method 0, real poles
/// repeated at most rank C times; the free vectors are chosen for well-conditioned eigenvectors.
Matrix place(const Matrix& a, const Matrix& c, const Vector& poles, const std::vector<std::string>& names = {});

/// x_{k+1} = Phi x_k + Gamma u_k, exact for u held over the step.
struct Discrete {
    Matrix phi;
    Matrix gamma;
};
Discrete discretise(const Matrix& a, const Matrix& b, double step);
/// Exact for an input that is linear over the step: x_{k+1} = Phi x_k + Gamma0 u_k + Gamma1 u_{k+1}.
struct DiscreteFirstOrderHold {
    Matrix phi;
    Matrix gamma0;
    Matrix gamma1;
};
DiscreteFirstOrderHold discretise_first_order_hold(const Matrix& a, const Matrix& b, double step);
/// Process noise of spectral density Q (dx = A x + white noise) over one step (Van Loan 1978).
Matrix discrete_noise(const Matrix& a, const Matrix& q, double step);

/// P with P = Phi P Phi' + Q (discrete). Throws core::InputError when Phi has an eigenvalue on or outside the unit
/// circle.
Matrix discrete_lyapunov(const Matrix& phi, const Matrix& q);
/// Stabilising P of P = Phi (P - P C' (C P C' + R)^-1 C P) Phi' + Q (covariance before the measurement), structured
/// doubling. Throws core::InputError when it does not exist (a mode that cannot be seen and does not decay), naming it.
Matrix discrete_riccati(const Matrix& phi, const Matrix& c, const Matrix& q, const Matrix& r,
                        const std::vector<std::string>& names = {});

}  // namespace underbody::estimator
