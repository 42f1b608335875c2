// Added mass of an ellipsoid in unbounded ideal fluid, in closed form.
#pragma once

#include <array>

namespace underbody::geometry {

/// Carlson's R_D(x, y, z) = 3/2 Int_0^inf dt / ((t+z) sqrt((t+x)(t+y)(t+z))), x, y >= 0 (not both 0), z > 0.
/// Source: B. C. Carlson, "Numerical computation of real or complex elliptic integrals", 1995: duplication.
double carlson_rd(double x, double y, double z);

/// Of the ellipsoid with semi-axes a (along x), b, c; per unit density of the fluid.
struct EllipsoidAddedMass {
    double volume = 0;                    ///< m^3
    std::array<double, 3> integral{};     ///< alpha0, beta0, gamma0; their sum is 2
    std::array<double, 3> translation{};  ///< m^3: A_x, A_y, A_z over rho
    std::array<double, 3> rotation{};     ///< m^5: B_p, B_q, B_r over rho, about the centre
};

/// Semi-axes in m, all positive: throws core::InputError otherwise.
/// Source: H. Lamb, Hydrodynamics, 6th ed., sections 114 and 115; A. I. Korotkin, Added Masses of Ship Structures,
/// 2009.
EllipsoidAddedMass ellipsoid_added_mass(double a, double b, double c);

}  // namespace underbody::geometry
