// Boundary conditions of a zone.
#include <cgnslib.h>

#include <algorithm>
#include <cmath>

#include "postproc/importers/cgns/cgns_file.h"
#include "postproc/importers/mesh/variable_reading.h"

namespace underbody::postproc {

namespace {

ZoneKind kind_of(std::string_view name) {
    return name.starts_with("BCWall")                                   ? ZoneKind::wall
           : name.starts_with("BCInflow") || name == "BCTunnelInflow"   ? ZoneKind::inlet
           : name.starts_with("BCOutflow") || name == "BCTunnelOutflow" ? ZoneKind::outlet
           : name.starts_with("BCSymmetry")                             ? ZoneKind::symmetry
           : name == "BCFarfield"                                       ? ZoneKind::farfield
                                                                        : ZoneKind::unknown;
}

constexpr std::array across = {CGNS_ENUMV(IFaceCenter), CGNS_ENUMV(JFaceCenter), CGNS_ENUMV(KFaceCenter)};

bool across_an_index(CGNS_ENUMT(GridLocation_t) location) {
    return std::find(across.begin(), across.end(), location) != across.end();
}

/// The index across the faces of a structured zone, by their location, else by the normal into it; -1: neither says.
int index_across(CGNS_ENUMT(GridLocation_t) location, const std::array<int, 3>& inward) {
    if (across_an_index(location)) {
        return static_cast<int>(std::find(across.begin(), across.end(), location) - across.begin());
    }
    const auto stated = std::find_if(inward.begin(), inward.end(), [](int k) { return k != 0; });
    return stated == inward.end() ? -1 : static_cast<int>(stated - inward.begin());
}

}  // namespace

double CgnsCondition::named() const {
    const auto each = static_cast<std::size_t>(indices);
    if (!range) {
        return static_cast<double>(numbers.size() / each);
    }
    double count = 1;
    for (std::size_t k = 0; k < each && numbers.size() == 2 * each; ++k) {
        count *= std::abs(static_cast<double>(numbers[each + k]) - static_cast<double>(numbers[k])) + 1;
    }
    return count;
}

/// The condition that the family of a boundary has.
int CgnsFile::family_type(const CgnsZone& zone, int condition) const {
    auto type = CGNS_ENUMV(FamilySpecified);
    std::array<char, 33 * 21> wanted{};
    int families = 0;
    if (cg_goto(file_, base_, "Zone_t", zone.index, "ZoneBC_t", 1, "BC_t", condition, "end") != CG_OK ||
        cg_famname_read(wanted.data()) != CG_OK || cg_nfamilies(file_, base_, &families) != CG_OK) {
        return type;
    }
    for (int f = 1; f <= families; ++f) {
        std::array<char, 33> name{};
        int conditions = 0;
        int geometries = 0;
        if (cg_family_read(file_, base_, f, name.data(), &conditions, &geometries) == CG_OK && conditions > 0 &&
            std::string_view(name.data()) == wanted.data()) {
            cg_fambc_read(file_, base_, f, 1, name.data(), &type);
        }
    }
    return type;
}

CgnsCondition CgnsFile::condition(const CgnsZone& zone, int index) const {
    std::array<char, 33> name{};
    CGNS_ENUMT(BCType_t) type{};
    CGNS_ENUMT(PointSetType_t) set{};
    CGNS_ENUMT(DataType_t) normal_type{};
    CGNS_ENUMT(GridLocation_t) location{};
    cgsize_t points = 0;
    cgsize_t normals = 0;
    std::array<int, 3> inward{};
    CgnsCondition condition;
    condition.index = index;
    ok(zone,
       cg_boco_info(file_, base_, zone.index, index, name.data(), &type, &set, &points, inward.data(), &normals,
                    &normal_type, &condition.data_sets),
       "condition");
    condition.name = name.data();
    type = type == CGNS_ENUMV(FamilySpecified) ? static_cast<CGNS_ENUMT(BCType_t)>(family_type(zone, index)) : type;
    condition.type = BCTypeName[type];
    condition.kind = kind_of(condition.type);
    if (cg_boco_gridlocation_read(file_, base_, zone.index, index, &location) != CG_OK) {
        location = CGNS_ENUMV(Vertex);
    }
    condition.normal = zone.structured ? index_across(location, inward) : -1;
    const bool elements = set == CGNS_ENUMV(ElementRange) || set == CGNS_ENUMV(ElementList);
    const bool faces = location == CGNS_ENUMV(FaceCenter) ||
                       (cell_dimension_ == 2 && location == CGNS_ENUMV(EdgeCenter)) ||
                       (zone.structured ? across_an_index(location) : elements);
    condition.indices = zone.structured ? cell_dimension_ : 1;
    check_room(zone, static_cast<double>(points) * condition.indices);
    std::vector<cgsize_t> raw(static_cast<std::size_t>(std::max<cgsize_t>(0, points)) *
                              static_cast<std::size_t>(condition.indices));
    const bool known = faces || (location == CGNS_ENUMV(Vertex) && !elements);
    if (known && !raw.empty() && cg_boco_read(file_, base_, zone.index, index, raw.data(), nullptr) == CG_OK) {
        condition.where = faces ? CgnsCondition::Where::faces : CgnsCondition::Where::vertices;
        condition.range = set == CGNS_ENUMV(PointRange) || set == CGNS_ENUMV(ElementRange);
        condition.numbers.assign(raw.begin(), raw.end());
    }
    return condition;
}

std::vector<CgnsCondition> CgnsFile::conditions(const CgnsZone& zone) const {
    std::vector<CgnsCondition> result;
    int count = 0;
    if (cg_nbocos(file_, base_, zone.index, &count) != CG_OK) {
        return result;
    }
    for (int b = 1; b <= count; ++b) {
        result.push_back(condition(zone, b));
    }
    return result;
}

namespace {

/// What stands under the name of a variable in Neumann data is its gradient, but for what a wall has of its own.
bool is_of_walls(const std::string& canonical) {
    return canonical.starts_with("wall_") || canonical.starts_with("kinematic_wall_") ||
           canonical.starts_with("skin_friction") || canonical.starts_with("y_plus");
}

}  // namespace

/// Values at the library's place may be those of other faces or vertices than their condition names.
std::optional<CgnsCondition> CgnsFile::places_of_values(const CgnsZone& zone, const CgnsCondition& condition) const {
    CGNS_ENUMT(PointSetType_t) set{};
    CGNS_ENUMT(GridLocation_t) location{};
    cgsize_t count = 0;
    if (cg_ptset_info(&set, &count) != CG_OK) {
        return {};
    }
    CgnsCondition places = condition;
    places.where = CgnsCondition::Where::nowhere;
    places.range = set == CGNS_ENUMV(PointRange) || set == CGNS_ENUMV(ElementRange);
    places.numbers.clear();
    check_room(zone, static_cast<double>(count) * places.indices);
    std::vector<cgsize_t> raw(static_cast<std::size_t>(std::max<cgsize_t>(0, count)) *
                              static_cast<std::size_t>(places.indices));
    if (!raw.empty() && cg_ptset_read(raw.data()) == CG_OK && cg_gridlocation_read(&location) == CG_OK) {
        const bool elements = set == CGNS_ENUMV(ElementRange) || set == CGNS_ENUMV(ElementList);
        const bool vertices = location == CGNS_ENUMV(Vertex) && !elements;
        const bool faces = elements || location == CGNS_ENUMV(FaceCenter) || location == CGNS_ENUMV(EdgeCenter) ||
                           across_an_index(location);
        places.where = vertices ? CgnsCondition::Where::vertices
                       : faces  ? CgnsCondition::Where::faces
                                : CgnsCondition::Where::nowhere;
        places.normal = across_an_index(location) ? index_across(location, {}) : places.normal;
        places.numbers.assign(raw.begin(), raw.end());
    }
    return places;
}

void CgnsFile::read_boundary_values(const CgnsZone& zone, const Path& data, bool neumann, bool at_faces,
                                    const ReadOptions& options, std::vector<CgnsBoundaryValues>& result,
                                    std::vector<std::string>& unread) {
    int arrays = 0;
    if (!go_to(data) || cg_narrays(&arrays) != CG_OK) {
        return;
    }
    for (int a = 1; a <= arrays; ++a) {
        std::array<char, 33> name{};
        CGNS_ENUMT(DataType_t) type{};
        int dimensions = 0;
        std::array<cgsize_t, 12> sizes{};
        ok(zone, go_to(data) ? cg_array_info(a, name.data(), &type, &dimensions, sizes.data()) : CG_ERROR,
           "values of a boundary");
        double count = 1;
        for (int d = 0; d < dimensions; ++d) {
            count *= static_cast<double>(sizes[static_cast<std::size_t>(d)]);
        }
        check_room(zone, count);
        const CanonicalName canonical = canonical_name(name.data());
        if (type == CGNS_ENUMV(Character) || count < 1 || (neumann && !is_of_walls(canonical.name))) {
            unread.emplace_back(name.data());
            continue;
        }
        CgnsBoundaryValues own{name.data(), at_faces, Buffer<double>(static_cast<std::size_t>(count)), {}};
        ok(zone, cg_array_read_as(a, CGNS_ENUMV(RealDouble), own.values.data()), "values of a boundary");
        Path array = data;
        array.emplace_back("DataArray_t", a);
        // What the caller states of a variable replaces what the file says of it.
        const core::Conversion convert =
            is_unit_stated(options, own.variable) ? core::Conversion{} : to_si(array, own.variable, canonical.unit);
        std::for_each(own.values.begin(), own.values.end(), [&](double& value) { value = convert(value); });
        result.push_back(std::move(own));
    }
}

std::vector<CgnsBoundaryValues> CgnsFile::boundary_values(const CgnsZone& zone, const CgnsCondition& condition,
                                                          const ReadOptions& options,
                                                          std::vector<std::string>& unread) {
    std::vector<CgnsBoundaryValues> result;
    for (int set = 1; set <= condition.data_sets; ++set) {
        const Path path = {{"Zone_t", zone.index}, {"ZoneBC_t", 1}, {"BC_t", condition.index}, {"BCDataSet_t", set}};
        std::array<char, 33> name{};
        CGNS_ENUMT(BCType_t) type{};
        CGNS_ENUMT(GridLocation_t) location{};
        int dirichlet = 0;
        int neumann = 0;
        if (cg_dataset_read(file_, base_, zone.index, condition.index, set, name.data(), &type, &dirichlet, &neumann) !=
                CG_OK ||
            !go_to(path)) {
            continue;
        }
        const auto places = places_of_values(zone, condition);
        const bool at_faces = cg_gridlocation_read(&location) == CG_OK && location != CGNS_ENUMV(Vertex);
        std::vector<CgnsBoundaryValues> own;
        for (const auto& [there, kind] :
             {std::pair{dirichlet, CGNS_ENUMV(Dirichlet)}, std::pair{neumann, CGNS_ENUMV(Neumann)}}) {
            Path data = path;
            data.emplace_back("BCData_t", static_cast<int>(kind));
            if (there != 0) {
                read_boundary_values(zone, data, kind == CGNS_ENUMV(Neumann), at_faces, options, own, unread);
            }
        }
        for (auto& values : own) {
            values.places = places;
            result.push_back(std::move(values));
        }
    }
    return result;
}

}  // namespace underbody::postproc
