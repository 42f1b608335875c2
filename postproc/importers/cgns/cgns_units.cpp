// What the units that a CGNS file states make of its numbers.
#include <cgnslib.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/text.h"
#include "postproc/importers/cgns/cgns_file.h"

namespace underbody::postproc {

namespace {

/// Powers of mass and length in the units that the canonical quantities have.
struct Powers {
    std::string_view unit;
    int mass;
    int length;
};
constexpr std::array powers = {Powers{"Pa", 1, -1},     Powers{"m/s", 0, 1},     Powers{"kg/m^3", 1, -3},
                               Powers{"m^2/s^2", 0, 2}, Powers{"m^2/s^3", 0, 2}, Powers{"m^2/s", 0, 2},
                               Powers{"Pa s", 1, -1},   Powers{"J/kg", 0, 2},    Powers{"W/m^2", 1, 0},
                               Powers{"m", 0, 1},       Powers{"m^2", 0, 2},     Powers{"m^3", 0, 3},
                               Powers{"N", 1, 1},       Powers{"kg/s", 1, 0}};

}  // namespace

core::Conversion CgnsFile::Scales::to_si(std::string_view unit) const {
    if (unit == "K") {
        return temperature;
    }
    const auto found = std::find_if(powers.begin(), powers.end(), [&](const Powers& p) { return p.unit == unit; });
    return {found == powers.end() ? 1 : std::pow(mass, found->mass) * std::pow(length, found->length), 0};
}

/// The units and the class of data stated at a node of the file, else those above it.
CgnsFile::Scales CgnsFile::scales_at(const Scales& above, const Path& path) {
    CGNS_ENUMT(MassUnits_t) mass{};
    CGNS_ENUMT(LengthUnits_t) length{};
    CGNS_ENUMT(TimeUnits_t) time{};
    CGNS_ENUMT(TemperatureUnits_t) temperature{};
    CGNS_ENUMT(AngleUnits_t) angle{};
    auto data = CGNS_ENUMV(DataClassNull);
    Scales result = above;
    if (!go_to(path)) {
        return result;
    }
    if (cg_dataclass_read(&data) == CG_OK && data != CGNS_ENUMV(DataClassNull)) {
        result.data_class = DataClassName[data];
    }
    if (cg_units_read(&mass, &length, &time, &temperature, &angle) != CG_OK) {
        return result;
    }
    if (length > CGNS_ENUMV(LengthUnitsUserDefined)) {
        units_stated_ = true;
        const std::string unit = core::lower_case(LengthUnitsName[length]);
        result.length = unit == "centimeter"   ? 0.01
                        : unit == "millimeter" ? 0.001
                        : unit == "foot"       ? 0.3048
                        : unit == "inch"       ? 0.0254
                                               : 1;
    }
    if (mass > CGNS_ENUMV(MassUnitsUserDefined)) {
        const std::string unit = core::lower_case(MassUnitsName[mass]);
        result.mass = unit == "gram" ? 1e-3 : unit == "slug" ? 14.59390294 : unit == "poundmass" ? 0.45359237 : 1;
    }
    if (temperature > CGNS_ENUMV(TemperatureUnitsUserDefined)) {
        const std::string unit = core::lower_case(TemperatureUnitsName[temperature]);
        result.temperature = core::conversion(unit == "celsius"      ? "degC"
                                              : unit == "fahrenheit" ? "degF"
                                              : unit == "rankine"    ? "degR"
                                                                     : "K",
                                              "K");
    }
    return result;
}

void CgnsFile::read_units_of_base() { of_base_ = scales_at({}, {}); }

namespace {

/// What makes numbers with dimensions of those at the library's place, where these are normalised.
std::optional<core::Conversion> stated_conversion() {
    CGNS_ENUMT(DataType_t) type{};
    std::array<double, 2> factors{};
    std::array<float, 2> small{};
    if (cg_conversion_info(&type) != CG_OK) {
        return {};
    }
    if (type == CGNS_ENUMV(RealDouble) && cg_conversion_read(factors.data()) == CG_OK) {
        return core::Conversion{factors[0], factors[1]};
    }
    if (type == CGNS_ENUMV(RealSingle) && cg_conversion_read(small.data()) == CG_OK) {
        return core::Conversion{small[0], small[1]};
    }
    return {};
}

}  // namespace

/// What makes SI of an array, by the units and the class that it states, or what it stands in. What has no dimensions
/// stays as it is, and is told.
core::Conversion CgnsFile::to_si(const Path& array, const std::string& variable, const std::string& unit) {
    Scales own = of_base_;
    for (std::size_t depth = 1; depth <= array.size(); ++depth) {
        own = scales_at(own, {array.begin(), array.begin() + static_cast<std::ptrdiff_t>(depth)});
    }
    const core::Conversion dimensional = own.to_si(unit);
    if (own.data_class.empty() || own.data_class == "Dimensional" || own.data_class == "UserDefined") {
        return dimensional;
    }
    if (own.data_class == "NormalizedByDimensional") {
        if (const auto stated = go_to(array) ? stated_conversion() : std::nullopt) {
            return {dimensional.scale * stated->scale, dimensional(stated->offset)};
        }
    }
    if (own.data_class != "DimensionlessConstant" && !unit.empty() && unit != "1") {
        without_dimensions_[own.data_class].insert(variable);
    }
    return {};
}

}  // namespace underbody::postproc
