// What the water is where nobody says.
#pragma once

namespace underbody::core {

/// kg/m^3: fresh water at 20 degC (998.2, ITTC 7.5-02-01-03), the default of every room. Files, models and options
/// state their own.
constexpr double default_water_density = 998;

}  // namespace underbody::core
