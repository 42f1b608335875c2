#include "surrogates/dynamics/theory/scaling.h"

#include <cmath>

namespace underbody::dynamics {

namespace {
constexpr double quarter_pi = 0.78539816339744830962;
}

ScaleFactors scaled(double size, double speed) {
    ScaleFactors f;
    f.force = size * size * speed * speed;
    f.mass = size * size * size;
    f.force_per_mass = f.force / f.mass;
    f.gap = size;
    f.stiffness = f.force / f.gap;
    f.frequency = std::sqrt(f.stiffness / f.mass);
    f.kick = f.frequency * f.gap;
    return f;
}

double plan_area(double length, double width) { return quarter_pi * length * width; }
double cross_section(double width, double height) { return quarter_pi * width * height; }
double printed_cross_section(double length) { return quarter_pi * length * length; }
double lift_coefficient(double force, double density, double speed, double area) {
    return 2 * force / (density * speed * speed * area);
}
double reynolds_number(double speed, double length, double kinematic_viscosity) {
    return speed * length / kinematic_viscosity;
}
double spring_frequency(double stiffness, double mass) { return std::sqrt(stiffness / mass); }
double survivable_kick(double frequency, double gap) { return frequency * gap; }

}  // namespace underbody::dynamics
