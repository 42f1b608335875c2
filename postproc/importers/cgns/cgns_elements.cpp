// Sections of elements of an unstructured zone.
#include <cgnslib.h>
#include <vtkCellType.h>

#include <algorithm>

#include "postproc/importers/cgns/cgns_file.h"

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

/// By the number in the file, which need be none of the library's.
const Kind* find_kind(std::int64_t type) {
    for (const auto& kind : kinds) {
        if (static_cast<std::int64_t>(kind.cgns) == type) {
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

namespace {

/// The numbers of a section as they stand in the file; with lists of different lengths, where each begins.
struct RawElements {
    CGNS_ENUMT(ElementType_t) type{};
    std::vector<cgsize_t> numbers;
    std::vector<cgsize_t> offsets;
};

class Decoder {
public:
    Decoder(const CgnsFile& file, const CgnsZone& zone, const RawElements& raw, CgnsSection& section)
        : file_(file), zone_(zone), raw_(raw), section_(section) {}

    void decode() {
        const auto count = static_cast<std::size_t>(section_.last - section_.first + 1);
        section_.elements.reserve(count);
        std::size_t at = 0;
        for (std::size_t i = 0; i < count; ++i) {
            at = raw_.offsets.empty() ? at : list_of(i);
            if (section_.polygons || section_.polyhedra) {
                add(section_.polygons ? VTK_POLYGON : VTK_POLYHEDRON, at,
                    static_cast<std::size_t>(raw_.offsets[i + 1]) - at);
            } else {
                at = add_of_kind(i, at);
            }
        }
        if (!section_.polyhedra) {
            count_nodes_from_zero();
        }
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        file_.fail(zone_, "section '" + section_.name + "'" + what);
    }

    [[nodiscard]] std::size_t list_of(std::size_t element) const {
        const auto& offsets = raw_.offsets;
        if (offsets[element] < 0 || offsets[element + 1] < offsets[element] ||
            static_cast<std::size_t>(offsets[element + 1]) > raw_.numbers.size()) {
            fail(": element " + std::to_string(element + 1) + " lies outside its list");
        }
        return static_cast<std::size_t>(offsets[element]);
    }

    void add(unsigned char type, std::size_t at, std::size_t count) {
        section_.elements.push_back({type, section_.nodes.size(), count});
        const auto first = raw_.numbers.begin() + static_cast<std::ptrdiff_t>(at);
        section_.nodes.insert(section_.nodes.end(), first, first + static_cast<std::ptrdiff_t>(count));
    }

    /// An element at `at`, with its kind in front where they are mixed; says where the next one is.
    std::size_t add_of_kind(std::size_t element, std::size_t at) {
        std::int64_t type = raw_.type;
        if (raw_.type == CGNS_ENUMV(MIXED)) {
            type = at < raw_.numbers.size() ? raw_.numbers[at] : 0;
            ++at;
        }
        const Kind* kind = find_kind(type);
        int stored = 0;
        if (kind == nullptr || cg_npe(kind->cgns, &stored) != CG_OK ||
            at + static_cast<std::size_t>(stored) > raw_.numbers.size()) {
            fail(": element " + std::to_string(element + 1) + " is of a kind that is not read");
        }
        add(kind->type, at, static_cast<std::size_t>(kind->corners));
        return at + static_cast<std::size_t>(stored);
    }

    void count_nodes_from_zero() {
        for (auto& node : section_.nodes) {
            if (node < 1 || node > zone_.nodes[0]) {
                fail(" names node " + std::to_string(node) + " of " + std::to_string(zone_.nodes[0]));
            }
            --node;
        }
    }

    const CgnsFile& file_;
    const CgnsZone& zone_;
    const RawElements& raw_;
    CgnsSection& section_;
};

}  // namespace

CgnsSection CgnsFile::section(const CgnsZone& zone, int index) const {
    CgnsSection result;
    std::array<char, 33> section_name{};
    CGNS_ENUMT(ElementType_t) type{};
    cgsize_t first = 0;
    cgsize_t last = 0;
    int boundary = 0;
    int parent = 0;
    ok(zone,
       cg_section_read(file_, base_, zone.index, index, section_name.data(), &type, &first, &last, &boundary, &parent),
       "section");
    result.name = section_name.data();
    result.first = first;
    result.last = last;
    const std::int64_t count = static_cast<std::int64_t>(last) - first + 1;
    cgsize_t data = 0;
    ok(zone, cg_ElementDataSize(file_, base_, zone.index, index, &data), "section size");
    check_room(zone, static_cast<double>(data));
    if (first < 1 || count < 1 || data < count) {
        fail(zone, "section '" + result.name + "' has elements " + std::to_string(first) + " to " +
                       std::to_string(last) + " in " + std::to_string(data) + " numbers");
    }
    RawElements raw{type, std::vector<cgsize_t>(static_cast<std::size_t>(data)), {}};
    result.polygons = type == CGNS_ENUMV(NGON_n);
    result.polyhedra = type == CGNS_ENUMV(NFACE_n);
    if (type == CGNS_ENUMV(MIXED) || result.polygons || result.polyhedra) {
        raw.offsets.resize(static_cast<std::size_t>(count) + 1);
        ok(zone,
           cg_poly_elements_read(file_, base_, zone.index, index, raw.numbers.data(), raw.offsets.data(), nullptr),
           "elements");
    } else {
        ok(zone, cg_elements_read(file_, base_, zone.index, index, raw.numbers.data(), nullptr), "elements");
    }
    Decoder(*this, zone, raw, result).decode();
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
    std::sort(result.begin(), result.end(),
              [](const CgnsSection& a, const CgnsSection& b) { return a.first < b.first; });
    return result;
}

}  // namespace underbody::postproc
