// Sections of elements of an unstructured zone.
#include <cgnslib.h>
#include <vtkCellType.h>

#include <algorithm>

#include "postproc/importers/cgns_file.h"

namespace underbody::postproc {

namespace {

struct Kind {
    CGNS_ENUMT(ElementType_t) cgns;
    unsigned char type;
    int corners;
};

// Higher orders are shown by their corners.
constexpr std::array kinds = {Kind{CGNS_ENUMV(NODE), VTK_VERTEX, 1},       Kind{CGNS_ENUMV(BAR_2), VTK_LINE, 2},
                              Kind{CGNS_ENUMV(BAR_3), VTK_LINE, 2},        Kind{CGNS_ENUMV(TRI_3), VTK_TRIANGLE, 3},
                              Kind{CGNS_ENUMV(TRI_6), VTK_TRIANGLE, 3},    Kind{CGNS_ENUMV(QUAD_4), VTK_QUAD, 4},
                              Kind{CGNS_ENUMV(QUAD_8), VTK_QUAD, 4},       Kind{CGNS_ENUMV(QUAD_9), VTK_QUAD, 4},
                              Kind{CGNS_ENUMV(TETRA_4), VTK_TETRA, 4},     Kind{CGNS_ENUMV(TETRA_10), VTK_TETRA, 4},
                              Kind{CGNS_ENUMV(PYRA_5), VTK_PYRAMID, 5},    Kind{CGNS_ENUMV(PYRA_13), VTK_PYRAMID, 5},
                              Kind{CGNS_ENUMV(PYRA_14), VTK_PYRAMID, 5},   Kind{CGNS_ENUMV(PENTA_6), VTK_WEDGE, 6},
                              Kind{CGNS_ENUMV(PENTA_15), VTK_WEDGE, 6},    Kind{CGNS_ENUMV(PENTA_18), VTK_WEDGE, 6},
                              Kind{CGNS_ENUMV(HEXA_8), VTK_HEXAHEDRON, 8}, Kind{CGNS_ENUMV(HEXA_20), VTK_HEXAHEDRON, 8},
                              Kind{CGNS_ENUMV(HEXA_27), VTK_HEXAHEDRON, 8}};

const Kind* find_kind(CGNS_ENUMT(ElementType_t) type) {
    for (const auto& kind : kinds) {
        if (kind.cgns == type) {
            return &kind;
        }
    }
    return nullptr;
}

}  // namespace

int CgnsSection::Element::dimension() const {
    return type == VTK_VERTEX                                                ? 0
           : type == VTK_LINE                                                ? 1
           : type == VTK_TRIANGLE || type == VTK_QUAD || type == VTK_POLYGON ? 2
                                                                             : 3;
}

CgnsSection CgnsFile::section(const CgnsZone& zone, int index) const {
    CgnsSection result;
    std::array<char, 33> section_name{};
    CGNS_ENUMT(ElementType_t) type{};
    cgsize_t first = 0;
    cgsize_t last = 0;
    int boundary = 0;
    int parent = 0;
    ok(zone, cg_section_read(file_, base_, zone.index, index, section_name.data(), &type, &first, &last, &boundary, &parent),
       "section");
    result.name = section_name.data();
    result.first = first;
    result.last = last;
    const std::int64_t count = static_cast<std::int64_t>(last) - first + 1;
    cgsize_t data = 0;
    ok(zone, cg_ElementDataSize(file_, base_, zone.index, index, &data), "section size");
    check_room(zone, static_cast<double>(data));
    if (first < 1 || count < 1 || data < count) {
        fail(zone, "section '" + result.name + "' has elements " + std::to_string(first) + " to " + std::to_string(last) +
             " in " + std::to_string(data) + " numbers");
    }
    std::vector<cgsize_t> raw(static_cast<std::size_t>(data));
    const bool mixed = type == CGNS_ENUMV(MIXED);
    result.polygons = type == CGNS_ENUMV(NGON_n);
    result.polyhedra = type == CGNS_ENUMV(NFACE_n);
    std::vector<cgsize_t> offsets;
    if (mixed || result.polygons || result.polyhedra) {
        offsets.resize(static_cast<std::size_t>(count) + 1);
        ok(zone, cg_poly_elements_read(file_, base_, zone.index, index, raw.data(), offsets.data(), nullptr), "elements");
    } else {
        ok(zone, cg_elements_read(file_, base_, zone.index, index, raw.data(), nullptr), "elements");
    }
    result.elements.reserve(static_cast<std::size_t>(count));
    std::size_t at = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        auto kind_number = type;
        std::size_t size = 0;
        if (!offsets.empty()) {
            if (offsets[i] < 0 || offsets[i + 1] < offsets[i] || offsets[i + 1] > data) {
                fail(zone, "section '" + result.name + "': element " + std::to_string(i + 1) + " lies outside its list");
            }
            at = static_cast<std::size_t>(offsets[i]);
            size = static_cast<std::size_t>(offsets[i + 1] - offsets[i]);
        }
        if (result.polygons || result.polyhedra) {
            result.elements.push_back({static_cast<unsigned char>(result.polygons ? VTK_POLYGON : VTK_POLYHEDRON),
                                       result.nodes.size(), size});
            result.nodes.insert(result.nodes.end(), raw.begin() + static_cast<std::ptrdiff_t>(at),
                                raw.begin() + static_cast<std::ptrdiff_t>(at + size));
            continue;
        }
        if (mixed) {
            kind_number = static_cast<CGNS_ENUMT(ElementType_t)>(at < raw.size() ? raw[at] : 0);
            ++at;
        }
        const Kind* kind = find_kind(kind_number);
        int stored = 0;
        if (kind == nullptr || cg_npe(kind_number, &stored) != CG_OK ||
            at + static_cast<std::size_t>(stored) > raw.size()) {
            fail(zone, "section '" + result.name + "': element " + std::to_string(i + 1) + " is of a kind that is not read");
        }
        result.elements.push_back({kind->type, result.nodes.size(), static_cast<std::size_t>(kind->corners)});
        result.nodes.insert(result.nodes.end(), raw.begin() + static_cast<std::ptrdiff_t>(at),
                            raw.begin() + static_cast<std::ptrdiff_t>(at) + kind->corners);
        at += static_cast<std::size_t>(stored);
    }
    if (!result.polyhedra) {
        for (auto& node : result.nodes) {
            if (node < 1 || node > zone.nodes[0]) {
                fail(zone, "section '" + result.name + "' names node " + std::to_string(node) + " of " +
                     std::to_string(zone.nodes[0]));
            }
            --node;
        }
    }
    return result;
}

std::vector<CgnsSection> CgnsFile::sections(const CgnsZone& zone, core::Progress& progress) const {
    int count = 0;
    ok(zone, cg_nsections(file_, base_, zone.index, &count), "sections");
    std::vector<CgnsSection> result;
    for (int s = 1; s <= count; ++s) {
        progress.check();
        result.push_back(section(zone, s));
    }
    std::sort(result.begin(), result.end(), [](const CgnsSection& a, const CgnsSection& b) { return a.first < b.first; });
    return result;
}

}  // namespace underbody::postproc
