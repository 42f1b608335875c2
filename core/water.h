// Water, and what things weigh in it, where nobody says.
#pragma once

namespace underbody::core {

/// kg/m^3: fresh water at 20 degC (998.2, ITTC 7.5-02-01-03), the default of every room. Files, models and options
/// state their own.
constexpr double default_water_density = 998;

/// m/s^2 (ISO 80000-3).
constexpr double standard_gravity = 9.80665;

}  // namespace underbody::core
