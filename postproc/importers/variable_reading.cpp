#include "postproc/importers/variable_reading.h"

#include <algorithm>
#include <cctype>

#include "core/text.h"

namespace underbody::postproc {

namespace {

constexpr const char* foam_pressure = "p";
constexpr const char* foam_shear = "wallShearStress";
constexpr const char* over_density = "m^2/s^2";
constexpr std::string_view unstated = " (unit not stated)";

const std::string* stated_unit(const ReadOptions& options, const std::string& variable) {
    const auto found = std::find_if(options.units.begin(), options.units.end(), [&](const auto& stated) { return stated.first == variable; });
    return found != options.units.end() ? &found->second : nullptr;
}

/// OpenFOAM's numbers are SI: where p is over density, so is the shear.
std::string unit_beside_pressure(const ReadOptions& options) {
    const std::string* pressure = stated_unit(options, foam_pressure);
    return pressure == nullptr ? "" : core::same_dimension(*pressure, over_density) ? over_density : "Pa";
}

struct NameWithUnit {
    std::string name;
    std::string unit;
};

/// "Pressure [ Pa ]": the name without its unit, where the brackets hold one.
NameWithUnit parts_of(const std::string& original) {
    const std::size_t open = original.rfind('[');
    if (original.empty() || original.back() != ']' || open == std::string::npos || open == 0) {
        return {original, ""};
    }
    const std::string unit(core::trimmed(std::string_view(original).substr(open + 1, original.size() - open - 2)));
    if (std::none_of(unit.begin(), unit.end(), [](unsigned char c) { return std::isalpha(c) != 0 || c == '%'; })) {
        return {original, ""};  // an index, "species[2]": no factor of 2
    }
    try {
        (void)core::si_unit(unit);
        return {std::string(core::trimmed(std::string_view(original).substr(0, open))), unit};
    } catch (const core::InputError&) {
        return {original, ""};  // brackets of another meaning
    }
}

}  // namespace

VariableReading read_variable_name(const std::string& original, const ReadOptions& options, const core::Place& place) {
    const NameWithUnit stated = parts_of(original);
    const CanonicalName canonical = canonical_name(stated.name);
    const std::string* own = stated_unit(options, original);
    const std::string unit = own != nullptr ? *own : original == foam_shear ? unit_beside_pressure(options) : stated.unit;
    VariableReading reading{canonical.name, canonical.unit, unit, {}};
    if (!unit.empty()) {
        const bool expected = !canonical.unit.empty() && core::same_dimension(unit, canonical.unit);
        const bool kinematic = core::same_dimension(unit, over_density) &&
                               (canonical.name == "pressure" || canonical.name == "wall_shear" || canonical.name.starts_with("wall_shear_"));
        reading.unit = expected ? canonical.unit : kinematic ? over_density : core::si_unit(unit, place);
        reading.name = expected || canonical.unit.empty() ? canonical.name : kinematic ? "kinematic_" + canonical.name : stated.name;
        reading.convert = core::conversion(unit, reading.unit, place);
    }
    if (original == foam_shear) {
        reading.convert = {-reading.convert.scale, -reading.convert.offset};
    }
    return reading;
}

bool unit_must_be_stated(const std::string& original, const ReadOptions& options) {
    return (original == foam_pressure || (original == foam_shear && unit_beside_pressure(options).empty())) &&
           stated_unit(options, original) == nullptr;
}

std::string unstated_name(const std::string& original) { return original + std::string(unstated); }

std::string name_in_file(const std::string& name) { return name.ends_with(unstated) ? name.substr(0, name.size() - unstated.size()) : name; }

core::Problem unit_is_asked_for(const std::string& original, const core::Place& place) {
    return {core::Problem::Severity::warning,
            "'" + original + "' is " + (original == foam_pressure ? "pressure" : "wall shear stress") +
                " [Pa], or that over density [m^2/s^2] as in OpenFOAM's incompressible cases; the file does not say which. "
                "State it: --unit p=Pa, or --unit p=m^2/s^2 and --density",
            place};
}

}  // namespace underbody::postproc
