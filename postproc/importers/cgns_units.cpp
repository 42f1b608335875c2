// What the units that a CGNS file states make of its numbers.
#include <cgnslib.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "postproc/importers/cgns_file.h"

namespace underbody::postproc {

namespace {

/// Powers of mass and length in the units that the canonical quantities have.
struct Powers {
    std::string_view unit;
    int mass;
    int length;
};
constexpr std::array powers = {Powers{"Pa", 1, -1},     Powers{"m/s", 0, 1},     Powers{"kg/m^3", 1, -3}, Powers{"m^2/s^2", 0, 2},
                               Powers{"m^2/s^3", 0, 2}, Powers{"m^2/s", 0, 2},   Powers{"Pa s", 1, -1},   Powers{"J/kg", 0, 2},
                               Powers{"W/m^2", 1, 0},   Powers{"m", 0, 1},       Powers{"m^2", 0, 2},     Powers{"m^3", 0, 3},
                               Powers{"N", 1, 1},       Powers{"kg/s", 1, 0}};

}  // namespace

double CgnsFile::Scales::to_si(std::string_view unit) const {
    const auto found = std::find_if(powers.begin(), powers.end(), [&](const Powers& p) { return p.unit == unit; });
    return found == powers.end() ? 1 : std::pow(mass, found->mass) * std::pow(length, found->length);
}

/// The units stated at a node of the file, else those above it.
template <typename... Node>
CgnsFile::Scales CgnsFile::scales_at(const Scales& above, Node... node) {
    CGNS_ENUMT(MassUnits_t) mass{};
    CGNS_ENUMT(LengthUnits_t) length{};
    CGNS_ENUMT(TimeUnits_t) time{};
    CGNS_ENUMT(TemperatureUnits_t) temperature{};
    CGNS_ENUMT(AngleUnits_t) angle{};
    if (cg_goto(file_, base_, node..., "end") != CG_OK ||
        cg_units_read(&mass, &length, &time, &temperature, &angle) != CG_OK) {
        return above;
    }
    Scales result = above;
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
    return result;
}

void CgnsFile::read_units_of_base() { of_base_ = scales_at({}); }

/// The units of an array of a zone: its own, or of what it stands in.
CgnsFile::Scales CgnsFile::scales_of(const CgnsZone& zone, const char* parent, int index, int array) {
    const Scales of_zone = scales_at(of_base_, "Zone_t", zone.index);
    const Scales of_parent = scales_at(of_zone, "Zone_t", zone.index, parent, index);
    return scales_at(of_parent, "Zone_t", zone.index, parent, index, "DataArray_t", array);
}

std::string CgnsFile::dimensionless_class() const {
    auto data = CGNS_ENUMV(DataClassNull);
    const bool stated = cg_goto(file_, base_, "end") == CG_OK && cg_dataclass_read(&data) == CG_OK && data != CGNS_ENUMV(DataClassNull) &&
                        data != CGNS_ENUMV(DataClassUserDefined) && data != CGNS_ENUMV(Dimensional);
    return stated ? DataClassName[data] : "";
}

}  // namespace underbody::postproc
