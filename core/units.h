// Quantities with units, on UDUNITS-2. Inside the program every number is SI and every angle a radian.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace underbody::core {

/// True if the text names a unit that UDUNITS-2 reads; also "1" and "" (pure number), "degC", "deg".
bool is_unit(std::string_view unit);

/// True if values can be converted between the two units.
bool same_dimension(std::string_view unit_a, std::string_view unit_b);

/// The value in `to` of `value` given in `from` ("25 degC" is 298.15 K; 1 atm is 101325 Pa).
/// Throws InputError (kind "unit") for an unknown unit or a different dimension; `place` goes into the error.
double convert(double value, std::string_view from, std::string_view to, const Place& place = {});

/// value_to = scale * value_from + offset; for columns of values.
struct Conversion {
    double scale = 1;
    double offset = 0;
    [[nodiscard]] double operator()(double value) const { return scale * value + offset; }
    [[nodiscard]] bool is_identity() const { return scale == 1 && offset == 0; }
};
Conversion conversion(std::string_view from, std::string_view to, const Place& place = {});

/// The coherent SI unit of the same dimension: "mm" -> "m", "bar" -> "Pa", "km/h" -> "m/s", "deg" -> "rad", "degC" ->
/// "K". Common derived units come out under their own names (N, Pa, N m, N s/m ...), others as products of base units.
std::string si_unit(std::string_view unit, const Place& place = {});

/// A number with its unit, as it stands in files and on the command line.
struct Quantity {
    double value = 0;
    std::string unit;
};

/// "5 mm", "0.5 m/s", "20 degC", "3": the number and the rest as the unit ("" when there is none).
/// Throws InputError (kind "parse" or "unit").
Quantity parse_quantity(std::string_view text, const Place& place = {});

/// The value in `unit_si` of a text that may carry its own unit; a bare number is SI.
/// Throws InputError if it does not parse, is not finite, or has another dimension.
double parse_in(std::string_view text, std::string_view unit_si, const Place& place = {});

/// One of the quantity names that interfaces, files, options and JSON share.
struct QuantityName {
    std::string name;
    std::string unit;     ///< SI
    std::string meaning;  ///< one line, with its sign
    std::string symbol;   ///< for plots
};
/// time, gap, pitch, speed, heave_velocity, ... with SI units and signs.
const std::vector<QuantityName>& quantity_names();
/// nullptr when the name is not one of them.
const QuantityName* find_quantity(std::string_view name);

/// A list such as "gap=5mm,speed=0.5 m/s": name -> SI value. Known quantity names are converted from their unit;
/// unknown names are refused with the nearest one. `extra` adds names with SI units that the caller knows.
struct NamedValue {
    std::string name;
    double value = 0;
};
std::vector<NamedValue> parse_assignments(std::string_view text, const std::vector<QuantityName>& extra = {});

/// A list such as "gap=0:1,heave_velocity=-0.1:0.1": name -> SI range, lower < upper.
struct NamedRange {
    std::string name;
    double lower = 0;
    double upper = 0;
};
std::vector<NamedRange> parse_ranges(std::string_view text, const std::vector<QuantityName>& extra = {});

}  // namespace underbody::core
