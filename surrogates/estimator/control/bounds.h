// How much a Hurwitz matrix may change and stay Hurwitz, and what its blocks promise.
#pragma once

#include "surrogates/estimator/model/matrix.h"

namespace underbody::estimator {

/// From P A + A' P + 2 I = 0.
struct RobustnessBounds {
    bool hurwitz = false;
    double stability_degree = 0;  ///< -max Re lambda
    Matrix p;
    double patel_toda = 0;  ///< 1/sigma_max(P): bound on the spectral norm of a perturbation (Patel and Toda 1980)
    double patel_toda_element = 0;  ///< patel_toda / n: bound on every entry
    double yedavalli = 0;           ///< 1/sigma_max([|P| U]_s): bound on every entry that may change (Yedavalli 1985)
};
/// `structure`: ones where an entry may change (default: everywhere). Bounds are 0 when the matrix is not Hurwitz.
RobustnessBounds robustness_bounds(const Matrix& a, const Matrix& structure = {});

/// Largest eigenvalue of (A + A')/2; negative: uniformly negative definite (thesis 8.67 with its missing transpose).
double symmetric_part_abscissa(const Matrix& a);
/// ||J_zeta|| / ||J_x|| in the spectral norm (thesis 8.68).
double performance_ratio(const Matrix& j_zeta, const Matrix& j_x);

/// Where zeta goes with x held at x_ss, no input, no innovation: -J_zeta^-1 J_x x_ss (thesis 8.65).
struct SteadyState {
    bool converges = false;   ///< J_zeta Hurwitz
    Vector limit;             ///< fictitious forces, N
    double slowest_time = 0;  ///< s, 1/|max Re lambda|
};
SteadyState steady_state(const Matrix& j_x, const Matrix& j_zeta, const Vector& x_ss);

}  // namespace underbody::estimator
