// How forces, frequencies and gaps scale with size and speed; coefficients; the linear-spring estimate of a survivable
// kick. docs/physics.md, sections 4.4 and 4.5 (thesis 4.5 to 4.15, corrected).
#pragma once

namespace underbody::dynamics {

/// Factors on each quantity when a vehicle at the same speed and the same gap in chords grows by `size`, and the speed
/// by `speed` at fixed size.
struct ScaleFactors {
    double force = 1, mass = 1, force_per_mass = 1, stiffness = 1, frequency = 1, gap = 1, kick = 1;
};
ScaleFactors scaled(double size, double speed = 1);

/// pi/4 length width (of CL and CM) and pi/4 width height (of CD).
double plan_area(double length, double width);
double cross_section(double width, double height);
/// pi/4 length^2, the area the thesis prints for C_D (1.87 times too large): only to reproduce its figures.
double printed_cross_section(double length);
double lift_coefficient(double force, double density, double speed, double area);
double reynolds_number(double speed, double length, double kinematic_viscosity);

/// sqrt(k/M), rad/s.
double spring_frequency(double stiffness, double mass);
/// Downward speed at the equilibrium gap above which a linear spring without damping lets the body touch: omega h.
double survivable_kick(double frequency, double gap);

}  // namespace underbody::dynamics
