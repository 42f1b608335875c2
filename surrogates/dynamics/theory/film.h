// Thin films of water between base and ground: Reynolds' equation for a sliding body, the radial film of a bottom jet,
// the squeeze film. Frame: the vertical channel, forces positive up. SI. Formulas: docs/physics.md sections 4 and 5
// (thesis chapters 4 and 5, corrected).
#pragma once

#include <functional>
#include <vector>

#include "core/water.h"

namespace underbody::dynamics {

// ---- One-dimensional Reynolds film: the ground moves at +speed along x, the slider stands; pressure is ambient at
// both ends. ---- d/dx(h^3 dp/dx) = 6 mu U dh/dx (Reynolds 1886)

struct SliderFilm {
    std::vector<double> x, pressure;  ///< m, Pa
    double load_per_width = 0;        ///< N/m, up
    double centre_of_pressure = 0;    ///< m from the inlet; NaN when the load vanishes
    double highest = 0, lowest = 0;   ///< Pa
    double flow_per_width = 0;        ///< m^2/s
    double reduced_reynolds =
        0;  ///< U h^2/(nu L) with the largest gap; above about 1 inertia matters: outside validity
    bool valid = true;
};

/// `gap(x)` on [0, length] with corners at `corners` (ascending, inside). Gauss quadrature between corners.
SliderFilm slider_film(const std::function<double(double)>& gap, double length, const std::vector<double>& corners,
                       double speed, double viscosity, double density);

/// Plane slider in closed form: load per width, N/m.
double plane_slider_load(double inlet, double outlet, double length, double speed, double viscosity);
/// Its highest pressure, Pa (at h = 2 hi ho/(hi + ho)), and its pressure where the gap is h.
double plane_slider_peak(double inlet, double outlet, double length, double speed, double viscosity);
double plane_slider_pressure(double gap, double inlet, double outlet, double length, double speed, double viscosity);
/// The ratio inlet/outlet of highest load, 2.18870..., and its coefficient W ho^2/(mu U L^2) = 0.160243...
double best_slider_ratio();
double slider_load_coefficient(double ratio);

// ---- Radial film of a central jet: nozzle radius r1, plate radius r2, flow Q, parallel gap h. ----

/// Viscous pressure at the nozzle's lip, Pa: 6 mu Q/(pi h^3) ln(r2/r1).
double radial_film_pressure(double flow, double gap, double nozzle, double plate, double viscosity);
/// Viscous load, N: 3 mu Q (r2^2 - r1^2)/h^3.
double radial_film_load(double flow, double gap, double nozzle, double plate, double viscosity);
/// Load by inertia on the annulus, N, downward (negative). `factor`: 1/2 inviscid, 3/5 momentum integral, 27/35 laminar
/// to first order.
double radial_inertia_load(double flow, double gap, double nozzle, double plate, double density, double factor);
inline constexpr double inviscid_film_factor = 0.5;
inline constexpr double laminar_film_factor = 27.0 / 35.0;
/// dp/dr over rho ubar^2/r of the first-order laminar film, 54/35.
inline constexpr double laminar_film_gradient = 54.0 / 35.0;

/// Film force over an elliptic plate: F(h) = viscous/h^3 - inertial/h^2, flow held.
struct JetFilm {
    double viscous = 0;   ///< A3, N m^3
    double inertial = 0;  ///< B2, N m^2
    [[nodiscard]] double force(double gap) const;
    [[nodiscard]] double zero() const;        ///< gap of no force, A3/B2
    [[nodiscard]] double lowest_gap() const;  ///< 1.5 zero()
    [[nodiscard]] double lowest() const;      ///< -(4/27) B2/zero()^2
    [[nodiscard]] double stiffness() const;   ///< -dF/dh at zero(), N/m
};
/// Viscous load of a central source under an elliptic plate, N: 6 mu Q a^2 b^2/((a^2 + b^2) h^3), exact.
double elliptic_film_load(double flow, double gap, double half_length, double half_width, double viscosity);
/// Half axes, nozzle radius (whose area carries no film); the bracket of the inertial part takes the circle of radius^2
/// 2 a^2 b^2/(a^2 + b^2).
JetFilm jet_film(double half_length, double half_width, double nozzle, double flow, double viscosity, double density,
                 double factor = laminar_film_factor);

/// Torsion-like integral of an ellipse, pi a^3 b^3/(4 (a^2 + b^2)), m^4.
double film_integral(double half_length, double half_width);
/// Squeeze damping 12 mu G/h^3, N s/m, and the added mass of the thin gap, rho G/h, kg.
double squeeze_damping(double half_length, double half_width, double gap, double viscosity);
double gap_added_mass(double half_length, double half_width, double gap, double density);

// ---- The jet itself. ----

struct JetFlow {
    double velocity = 0;  ///< m/s
    double flow = 0;      ///< m^3/s
    double reynolds = 0;  ///< of the nozzle
};
/// F = rho Q^2/A: exhaust at ambient pressure, intake at rest.
JetFlow jet_flow(double thrust, double nozzle_diameter, double density, double kinematic_viscosity);
double ellipse_perimeter(double half_length, double half_width);
/// Q/(nu perimeter): Reynolds number of the flow under the rim; does not depend on the gap at given flow.
double rim_reynolds(double flow, double perimeter, double kinematic_viscosity);

/// Exponent through two measured thrusts.
double thrust_exponent(double low_thrust, double high_thrust, double low_voltage, double high_voltage);
/// f(h)/k_T at the equilibrium of a body whose jet balances it in free stream at `neutral` volts: (V0/V)^2 - 1.
double upwash_at_equilibrium(double neutral_voltage, double voltage);

}  // namespace underbody::dynamics
