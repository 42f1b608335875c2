// The units in which texts and pictures tell lengths and angles. Inside the program, in JSON and in tables all is SI.
#pragma once

#include <string>
#include <string_view>

namespace underbody::core {

/// The unit in which people are told what is in the SI unit `si`: "mm" for m, "deg" for rad, "N/deg" for a force's
/// slope over an angle, every other as it is.
std::string_view told_unit(std::string_view si);

/// "5 mm", "-2 deg", "0.4 m/s"; of a pure number (unit "1" or "") the number alone. `value` is in the SI unit `si`.
std::string told(double value, std::string_view si, int digits = 6);

/// "5.25 +- 0.1 mm"
std::string told(double value, double sigma, std::string_view si, int digits);

/// The unit in which the quantity of this name (core::find_quantity) is told, of whatever else that of its SI unit
/// `si`: a depth in m, other lengths in mm.
std::string_view told_unit_of(std::string_view quantity, std::string_view si);

/// "gap 5 mm", "depth 3 m", "wheels 3": a condition by its name, SI; without a unit where the name is none of the
/// known.
std::string told_condition(const std::string& name, double value, int digits = 6);

/// "1 to 100 mm", of two numbers in the SI unit `si`.
std::string told_range(double lower, double upper, std::string_view si, int digits = 6);

}  // namespace underbody::core
