// Boundary conditions of a zone.
#include <cgnslib.h>

#include <algorithm>

#include "postproc/importers/cgns_file.h"

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
}  // namespace

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

std::vector<CgnsCondition> CgnsFile::conditions(const CgnsZone& zone) const {
    std::vector<CgnsCondition> result;
    int count = 0;
    if (cg_nbocos(file_, base_, zone.index, &count) != CG_OK) {
        return result;
    }
    for (int b = 1; b <= count; ++b) {
        std::array<char, 33> name{};
        CGNS_ENUMT(BCType_t) type{};
        CGNS_ENUMT(PointSetType_t) set{};
        CGNS_ENUMT(DataType_t) normal_type{};
        CGNS_ENUMT(GridLocation_t) location{};
        cgsize_t points = 0;
        cgsize_t normals = 0;
        int data_sets = 0;
        std::array<int, 3> normal_index{};
        if (cg_boco_info(file_, base_, zone.index, b, name.data(), &type, &set, &points, normal_index.data(), &normals,
                         &normal_type, &data_sets) != CG_OK) {
            continue;
        }
        CgnsCondition condition;
        condition.name = name.data();
        type = type == CGNS_ENUMV(FamilySpecified) ? static_cast<CGNS_ENUMT(BCType_t)>(family_type(zone, b)) : type;
        condition.type = BCTypeName[type];
        condition.kind = kind_of(condition.type);
        condition.data_sets = data_sets;
        const bool elements = set == CGNS_ENUMV(ElementRange) || set == CGNS_ENUMV(ElementList);
        if (cg_boco_gridlocation_read(file_, base_, zone.index, b, &location) != CG_OK) {
            location = CGNS_ENUMV(Vertex);
        }
        const bool edges_bound = cell_dimension_ == 2 && location == CGNS_ENUMV(EdgeCenter);
        const bool faces = elements || edges_bound || location == CGNS_ENUMV(FaceCenter);
        const int indices = zone.structured ? cell_dimension_ : 1;
        check_room(zone, static_cast<double>(points) * indices);
        std::vector<cgsize_t> raw(static_cast<std::size_t>(std::max<cgsize_t>(0, points)) *
                                  static_cast<std::size_t>(indices));
        const bool range = set == CGNS_ENUMV(PointRange) || set == CGNS_ENUMV(ElementRange);
        const bool wanted = zone.structured ? range && points == 2 : faces;
        if (wanted && !raw.empty() && cg_boco_read(file_, base_, zone.index, b, raw.data(), nullptr) == CG_OK) {
            if (zone.structured) {
                condition.range.assign(raw.begin(), raw.end());
            } else if (range && raw.size() == 2) {
                check_room(zone, static_cast<double>(raw[1]) - raw[0]);
                for (std::int64_t e = raw[0]; e <= raw[1]; ++e) {
                    condition.elements.push_back(e);
                }
            } else {
                condition.elements.assign(raw.begin(), raw.end());
            }
        }
        result.push_back(std::move(condition));
    }
    return result;
}

}  // namespace underbody::postproc
