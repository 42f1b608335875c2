#include "postproc/importers/mesh/variable_reading.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/text.h"
#include "postproc/importers/mesh/array_names.h"
#include "postproc/importers/options_used.h"

namespace underbody::postproc {

namespace {

constexpr const char* foam_pressure = "p";
constexpr const char* foam_shear = "wallShearStress";
constexpr const char* over_density = "m^2/s^2";
constexpr std::string_view unstated = " (unit not stated)";

/// The caller's word, which may be written in other letters if nothing has the very name.
const std::string* stated_unit(const ReadOptions& options, const std::string& variable) {
    if (options.asked_units != nullptr && !options.units.empty()) {
        options.asked_units->add(variable);
    }
    const auto stated = [&](const auto& same) {
        const auto found = std::find_if(options.units.begin(), options.units.end(),
                                        [&](const auto& entry) { return same(entry.first); });
        return found != options.units.end() ? &found->second : nullptr;
    };
    const std::string* exact = stated([&](const std::string& name) { return name == variable; });
    return exact != nullptr || options.units.empty()
               ? exact
               : stated([key = core::lower_case(variable)](const std::string& name) {
                     return core::lower_case(name) == key;
                 });
}

bool same_unit(const std::string& a, const std::string& b) {
    if (a == b || !core::same_dimension(a, b)) {
        return a == b;
    }
    const core::Conversion conversion = core::conversion(a, b);
    return std::abs(conversion.scale - 1) < 1e-9 && conversion.offset == 0;
}

std::string settled(const std::string* stated, const std::string& own, const std::string& in_file,
                    const core::Place& place, core::Problems& problems) {
    if (stated != nullptr && !in_file.empty() && !same_unit(*stated, in_file)) {
        say_once(problems,
                 {core::Problem::Severity::warning,
                  "the file has '" + own + "' in " + in_file + "; " + *stated + " is taken, as stated (option 'unit')",
                  place});
    }
    return stated != nullptr ? *stated : in_file;
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

bool is_unit_stated(const ReadOptions& options, const std::string& variable) {
    return stated_unit(options, variable) != nullptr;
}

std::string own_name(const std::string& own, const std::string& unit) {
    const CanonicalName canonical = canonical_name(own);
    const bool misleads = !canonical.unit.empty() && canonical.name == own;
    return !misleads ? own : unit.empty() ? unstated_name(own) : own + " [" + unit + "]";
}

VariableReading quantity_in(const std::string& own, const CanonicalName& meaning, const std::string& unit,
                            const core::Place& place) {
    const bool expected = !meaning.unit.empty() && core::same_dimension(unit, meaning.unit);
    const bool kinematic =
        core::same_dimension(unit, over_density) &&
        (meaning.name == "pressure" || meaning.name == "wall_shear" || meaning.name.starts_with("wall_shear_")) &&
        meaning.unit == "Pa";
    VariableReading reading{own,
                            meaning.name,
                            expected    ? meaning.unit
                            : kinematic ? over_density
                                        : core::si_unit(unit, place),
                            unit,
                            {}};
    if (!expected && !meaning.unit.empty()) {
        reading.name = kinematic ? "kinematic_" + meaning.name : own_name(own, reading.unit);
    }
    reading.convert = core::conversion(unit, reading.unit, place);
    return reading;
}

std::string settled_unit(const std::string& own, const std::string& in_file, const ReadOptions& options,
                         const core::Place& place, core::Problems& problems) {
    return settled(stated_unit(options, own), own, in_file, place, problems);
}

VariableReading read_variable_name(const std::string& original, const ReadOptions& options, const core::Place& place,
                                   core::Problems& problems, const std::string& in_file) {
    NameWithUnit written = parts_of(original);
    written.unit = written.unit.empty() ? in_file : written.unit;
    const CanonicalName canonical = canonical_name(written.name);
    const std::string* stated = stated_unit(options, original);  // a caller may write the name with its unit or without
    std::string unit = settled(stated != nullptr ? stated : stated_unit(options, written.name), written.name,
                               written.unit, place, problems);
    if (unit.empty() && original == foam_shear) {
        unit = unit_beside_pressure(options);
    }
    if (!unit.empty() && unit == in_file && !core::is_unit(unit)) {
        return {written.name, own_name(written.name, unit), unit, unit, {}};  // the file's own affair
    }
    VariableReading reading = unit.empty() ? VariableReading{written.name, canonical.name, canonical.unit, "", {}}
                                           : quantity_in(written.name, canonical, unit, place);
    if (original == foam_shear) {
        say_once(problems, {core::Problem::Severity::note,
                            "'" + original +
                                "' is OpenFOAM's, which acts on the fluid: turned round, wall_shear acts on the body",
                            place});
        reading.convert = {-reading.convert.scale, -reading.convert.offset};
    }
    return reading;
}

bool unit_must_be_stated(const std::string& original, const ReadOptions& options) {
    return (original == foam_pressure || (original == foam_shear && unit_beside_pressure(options).empty())) &&
           stated_unit(options, original) == nullptr;
}

std::string unstated_name(const std::string& original) { return original + std::string(unstated); }

std::string name_in_file(const std::string& name) {
    return name.ends_with(unstated) ? name.substr(0, name.size() - unstated.size()) : name;
}

core::Problem unit_is_asked_for(const std::string& original, const core::Place& place) {
    return {
        core::Problem::Severity::warning,
        "'" + original + "' is " + (original == foam_pressure ? "pressure" : "wall shear stress") +
            " [Pa], or that over density [m^2/s^2] as in OpenFOAM's incompressible cases; the file does not say which. "
            "State it: option 'unit p=Pa', or option 'unit p=m^2/s^2' and option 'density'",
        place};
}

}  // namespace underbody::postproc
