#include "postproc/importers/cgns_file.h"

#include <cgns_io.h>
#include <cgnslib.h>
#include <vtkCellType.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/file.h"
#include "core/text.h"

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

ZoneKind kind_of(std::string_view name) {
    return name.starts_with("BCWall")                                   ? ZoneKind::wall
           : name.starts_with("BCInflow") || name == "BCTunnelInflow"   ? ZoneKind::inlet
           : name.starts_with("BCOutflow") || name == "BCTunnelOutflow" ? ZoneKind::outlet
           : name.starts_with("BCSymmetry")                             ? ZoneKind::symmetry
           : name == "BCFarfield"                                       ? ZoneKind::farfield
                                                                        : ZoneKind::unknown;
}

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

int CgnsSection::dimension() const {
    int most = polyhedra ? 3 : 0;
    for (const auto& element : elements) {
        const unsigned char t = element.type;
        most = std::max(most, t == VTK_VERTEX                                          ? 0
                              : t == VTK_LINE                                          ? 1
                              : t == VTK_TRIANGLE || t == VTK_QUAD || t == VTK_POLYGON ? 2
                                                                                       : 3);
    }
    return most;
}

double CgnsFile::Scales::to_si(std::string_view unit) const {
    const auto found = std::find_if(powers.begin(), powers.end(), [&](const Powers& p) { return p.unit == unit; });
    return found == powers.end() ? 1 : std::pow(mass, found->mass) * std::pow(length, found->length);
}

namespace {

/// What the library says of a link that leads nowhere is no damage.
std::string hint_for(const std::string& why, const char* otherwise) {
    return core::lower_case(why).find("linked") != std::string::npos ? "it takes a part from another file by a link: that one must lie where it did" : otherwise;
}

/// Top nodes of a CGNS file, read without a look at its version.
struct TopNodes {
    float version = 0;
    std::vector<std::string> bases;
};

TopNodes top_nodes(const std::string& path) {
    TopNodes top;
    int file = -1;
    double root = 0;
    if (cgio_open_file(path.c_str(), CGIO_MODE_READ, CGIO_FILE_NONE, &file) != CGIO_ERR_NONE) {
        return top;
    }
    int children = 0;
    if (cgio_get_root_id(file, &root) == CGIO_ERR_NONE && cgio_number_children(file, root, &children) == CGIO_ERR_NONE) {
        for (int i = 1; i <= children; ++i) {
            std::array<char, CGIO_MAX_NAME_LENGTH + 1> name{};
            std::array<char, CGIO_MAX_LABEL_LENGTH + 1> label{};
            int read = 0;
            double node = 0;
            if (cgio_children_names(file, root, i, 1, CGIO_MAX_NAME_LENGTH + 1, &read, name.data()) != CGIO_ERR_NONE ||
                cgio_get_node_id(file, root, name.data(), &node) != CGIO_ERR_NONE || cgio_get_label(file, node, label.data()) != CGIO_ERR_NONE) {
                continue;
            }
            std::array<char, CGIO_MAX_DATATYPE_LENGTH + 1> type{};
            std::array<cgsize_t, CGIO_MAX_DIMENSIONS> sizes{};
            int dimensions = 0;
            if (std::string_view(label.data()) == "CGNSBase_t") {
                top.bases.emplace_back(name.data());
            } else if (std::string_view(label.data()) == "CGNSLibraryVersion_t" && cgio_get_data_type(file, node, type.data()) == CGIO_ERR_NONE &&
                       cgio_get_dimensions(file, node, &dimensions, sizes.data()) == CGIO_ERR_NONE && std::string_view(type.data()) == "R4" && dimensions == 1 && sizes[0] == 1) {
                cgio_read_all_data(file, node, &top.version);
            }
        }
    }
    cgio_close_file(file);
    return top;
}

}  // namespace

/// The library here refuses files of a later version than its own by their number alone, and what it reads of them has not
/// changed since its own. It does follow links into them: a file of its own version, gone as soon as it is open, links to
/// their bases.
bool CgnsFile::open_newer(bool hdf5) {
    const TopNodes top = top_nodes(name_);
    if (!(top.version > static_cast<float>(CGNS_DOTVERS)) || top.bases.empty()) {
        return false;
    }
    const core::TemporaryFolder folder("underbody-cgns");
    const std::string own = (folder.path() / "links.cgns").string();
    const std::string target = std::filesystem::absolute(name_).string();
    int file = -1;
    int nodes = -1;
    double root = 0;
    double link = 0;
    cg_set_file_type(hdf5 ? CG_FILE_HDF5 : CG_FILE_ADF);
    if (cg_open(own.c_str(), CG_MODE_WRITE, &file) != CG_OK) {
        return false;
    }
    bool linked = cg_get_cgio(file, &nodes) == CG_OK && cg_root_id(file, &root) == CG_OK;
    for (const auto& base : top.bases) {
        linked = linked && cgio_create_link(nodes, root, base.c_str(), target.c_str(), ("/" + base).c_str(), &link) == CGIO_ERR_NONE;
    }
    linked = cg_close(file) == CG_OK && linked;
    version_ = top.version;
    return linked && cg_open(own.c_str(), CG_MODE_READ, &file_) == CG_OK;
}

CgnsFile::CgnsFile(const std::filesystem::path& path) : name_(path.string()) {
    std::error_code error;
    bytes_ = std::filesystem::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    std::array<char, 4> head{};
    file.read(head.data(), head.size());
    const bool hdf5 = head[0] == '\x89';
    most_values_ = hdf5 ? bytes_ * 1032 : bytes_;  // HDF5 may be deflated
    if (cg_open(name_.c_str(), CG_MODE_READ, &file_) != CG_OK && !open_newer(hdf5)) {
        const std::string why = cg_get_error();
        throw core::InputError("format", "CGNS cannot open it: " + why, {name_, {}, {}, {}}, hint_for(why, "the file is cut short or damaged; copy it again"));
    }
    try {
        std::array<char, 33> base_name{};
        const auto opened = [&](int result, const char* what) {
            if (result != CG_OK) {
                fail(std::string(what) + ": " + cg_get_error());
            }
        };
        opened(cg_nbases(file_, &bases_), "bases");
        if (bases_ < 1) {
            fail("there is no base in the file");
        }
        base_ = bases_;
        opened(cg_base_read(file_, base_, base_name.data(), &cell_dimension_, &physical_dimension_), "base");
        if (cell_dimension_ < 1 || cell_dimension_ > 3) {
            fail("its cells have " + std::to_string(cell_dimension_) + " dimensions");
        }
        opened(cg_nzones(file_, base_, &zones_), "zones");
        of_base_ = scales_at({});
        read_times();
    } catch (const core::InputError&) {
        cg_close(file_);
        throw;
    }
}

CgnsFile::~CgnsFile() { cg_close(file_); }

void CgnsFile::fail(const std::string& what) const {
    throw core::InputError("format", what, {name_, {}, {}, {}}, hint_for(what, "the file is damaged or incomplete"));
}

void CgnsFile::ok(const CgnsZone& zone, int result, const char* what) const {
    if (result != CG_OK) {
        fail(zone, std::string(what) + ": " + cg_get_error());
    }
}

/// So many numbers of at least 4 bytes must be in the file.
void CgnsFile::check_room(const CgnsZone& zone, double count) const {
    if (!(count >= 0) || count * 4 > static_cast<double>(most_values_)) {
        fail(zone, "it claims " + core::format_number(count) + " numbers but the file has " + std::to_string(bytes_) + " bytes");
    }
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

CgnsZone CgnsFile::zone(int index) const {
    CgnsZone zone;
    zone.index = index;
    std::array<char, 33> name{};
    std::array<cgsize_t, 9> size{};
    if (cg_zone_read(file_, base_, index, name.data(), size.data()) != CG_OK) {
        fail("zone " + std::to_string(index) + ": " + cg_get_error());
    }
    zone.name = name.data();
    CGNS_ENUMT(ZoneType_t) type{};
    ok(zone, cg_zone_type(file_, base_, index, &type), "zone type");
    zone.structured = type == CGNS_ENUMV(Structured);
    const int indices = zone.structured ? cell_dimension_ : 1;
    for (int k = 0; k < std::min(indices, 3); ++k) {
        zone.nodes[static_cast<std::size_t>(k)] = size[static_cast<std::size_t>(k)];
        zone.cells[static_cast<std::size_t>(k)] = std::max<cgsize_t>(0, size[static_cast<std::size_t>(indices + k)]);
    }
    check_room(zone, zone.all_cells() / 8);
    return zone;
}

Buffer<double> CgnsFile::points(const CgnsZone& zone) {
    double count = 1;
    const std::array<cgsize_t, 3> low = {1, 1, 1};
    std::array<cgsize_t, 3> high = {1, 1, 1};
    for (std::size_t k = 0; k < 3; ++k) {
        high[k] = static_cast<cgsize_t>(zone.nodes[k]);
        count *= static_cast<double>(std::max<cgsize_t>(0, high[k]));
    }
    check_room(zone, count);
    if (count < 1 || count > 2147483647.0) {
        fail(zone, "it has " + core::format_number(count) + " nodes");
    }
    const auto nodes = static_cast<std::size_t>(count);
    Buffer<double> points(3 * nodes);
    points.fill(0);
    Buffer<double> column(nodes);
    int coordinates = 0;
    ok(zone, cg_ncoords(file_, base_, zone.index, &coordinates), "coordinates");
    for (int c = 1; c <= coordinates; ++c) {
        std::array<char, 33> coordinate{};
        CGNS_ENUMT(DataType_t) type{};
        ok(zone, cg_coord_info(file_, base_, zone.index, c, &type, coordinate.data()), "coordinate");
        const std::string_view word(coordinate.data());
        const int axis = word.starts_with("Coordinate") && word.size() == 11 ? word[10] - 'X' : -1;
        if (axis < 0 || axis > 2) {
            fail(zone, "coordinates '" + std::string(word) + "' are not read (cylindrical and others)");
        }
        ok(zone, cg_coord_read(file_, base_, zone.index, coordinate.data(), CGNS_ENUMV(RealDouble), low.data(), high.data(),
                         column.data()),
           "coordinates");
        const double scale = scales_of(zone, "GridCoordinates_t", 1, c).length;
        for (std::size_t i = 0; i < nodes; ++i) {
            if (!std::isfinite(column[i])) {
                fail(zone, "a coordinate that is not a number");
            }
            points[3 * i + static_cast<std::size_t>(axis)] = scale * column[i];
        }
    }
    return points;
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

void CgnsFile::read_times() {
    std::array<char, 33> name{};
    int steps = 0;
    int arrays = 0;
    if (cg_biter_read(file_, base_, name.data(), &steps) != CG_OK || steps < 1 || static_cast<std::uint64_t>(steps) > most_values_ ||
        cg_goto(file_, base_, "BaseIterativeData_t", 1, "end") != CG_OK || cg_narrays(&arrays) != CG_OK) {
        return;
    }
    for (int a = 1; a <= arrays; ++a) {
        CGNS_ENUMT(DataType_t) type{};
        int dimensions = 0;
        std::array<cgsize_t, 12> sizes{};
        if (cg_array_info(a, name.data(), &type, &dimensions, sizes.data()) == CG_OK && std::string_view(name.data()) == "TimeValues" && dimensions == 1 &&
            sizes[0] == steps) {
            times_.resize(static_cast<std::size_t>(steps));
            if (cg_array_read_as(a, CGNS_ENUMV(RealDouble), times_.data()) != CG_OK) {
                times_.clear();
            }
        }
    }
    step_ = times_.empty() ? 0 : times_.size() - 1;
}

/// Names of the solutions of a zone, one a step; empty where the zone does not say.
std::vector<std::string> CgnsFile::solutions_of_steps(const CgnsZone& zone) const {
    std::array<char, 33> name{};
    int arrays = 0;
    if (times_.empty() || cg_ziter_read(file_, base_, zone.index, name.data()) != CG_OK ||
        cg_goto(file_, base_, "Zone_t", zone.index, "ZoneIterativeData_t", 1, "end") != CG_OK || cg_narrays(&arrays) != CG_OK) {
        return {};
    }
    for (int a = 1; a <= arrays; ++a) {
        CGNS_ENUMT(DataType_t) type{};
        int dimensions = 0;
        std::array<cgsize_t, 12> sizes{};
        const bool found = cg_array_info(a, name.data(), &type, &dimensions, sizes.data()) == CG_OK && std::string_view(name.data()) == "FlowSolutionPointers";
        if (!found || type != CGNS_ENUMV(Character) || dimensions != 2 || sizes[0] != 32 || sizes[1] != static_cast<cgsize_t>(times_.size())) {
            continue;
        }
        std::string text(32 * times_.size(), ' ');
        if (cg_array_read(a, text.data()) != CG_OK) {
            return {};
        }
        std::vector<std::string> names;
        for (std::size_t step = 0; step < times_.size(); ++step) {
            const std::string_view padded = std::string_view(text).substr(32 * step, 32);
            names.emplace_back(core::trimmed(padded.substr(0, padded.find('\0'))));
        }
        return names;
    }
    return {};
}

std::vector<PartValues> CgnsFile::solutions(const CgnsZone& zone, const ReadOptions& options, core::Progress& progress, int& left) {
    std::vector<PartValues> result;
    const std::vector<std::string> steps = solutions_of_steps(zone);
    int count = 0;
    if (cg_nsols(file_, base_, zone.index, &count) != CG_OK) {
        return result;
    }
    for (int s = 1; s <= count; ++s) {
        std::array<char, 33> solution{};
        CGNS_ENUMT(GridLocation_t) location{};
        int fields = 0;
        if (cg_sol_info(file_, base_, zone.index, s, solution.data(), &location) != CG_OK ||
            cg_nfields(file_, base_, zone.index, s, &fields) != CG_OK ||
            (location != CGNS_ENUMV(Vertex) && location != CGNS_ENUMV(CellCenter))) {
            continue;
        }
        const bool of_a_step = std::find(steps.begin(), steps.end(), solution.data()) != steps.end();
        if (of_a_step && steps[step_] != solution.data()) {
            ++left;
            continue;
        }
        const bool nodal = location == CGNS_ENUMV(Vertex);
        std::array<cgsize_t, 3> low = {1, 1, 1};
        std::array<cgsize_t, 3> high = {1, 1, 1};
        double size = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            high[k] = static_cast<cgsize_t>(nodal ? zone.nodes[k] : zone.cells[k]);
            size *= static_cast<double>(high[k]);
        }
        check_room(zone, size);
        for (int f = 1; f <= fields; ++f) {
            progress.check();
            std::array<char, 33> name{};
            CGNS_ENUMT(DataType_t) type{};
            ok(zone, cg_field_info(file_, base_, zone.index, s, f, &type, name.data()), "field");
            const CanonicalName canonical = canonical_name(name.data());
            const auto component = vector_component(canonical.name);
            if (!options.arrays.empty() && !matches_any(options.arrays, name.data()) &&
                !matches_any(options.arrays, canonical.name) &&
                !(component && matches_any(options.arrays, component->vector))) {
                continue;
            }
            PartValues values{name.data(), nodal, 1, Buffer<double>(static_cast<std::size_t>(size))};
            ok(zone, cg_field_read(file_, base_, zone.index, s, name.data(), CGNS_ENUMV(RealDouble), low.data(), high.data(),
                             values.values.data()),
               "field");
            if (const double scale = scales_of(zone, "FlowSolution_t", s, f).to_si(canonical.unit); scale != 1) {
                converted_[name.data()] = core::format_number(scale) + " " + canonical.unit;
                std::for_each(values.values.begin(), values.values.end(), [&](double& value) { value *= scale; });
            }
            const auto before = std::find_if(result.begin(), result.end(), [&](const PartValues& v) { return v.variable == values.variable && v.on_nodes == nodal; });
            if (before != result.end()) {
                ++left;
                *before = std::move(values);
            } else {
                result.push_back(std::move(values));
            }
        }
    }
    return result;
}

}  // namespace underbody::postproc
