// CGNS through libcgns, in ADF and HDF5: volumes, 2-D boundary sections, solutions at vertices and cells.
#include <cgnslib.h>
#include <vtkCellType.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

#include "core/text.h"
#include "postproc/importers/element_zone.h"
#include "postproc/importers/face_orientation.h"
#include "postproc/importers/hdf5_file.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/trial.h"
#include "postproc/importers/understood.h"

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

ZoneKind kind_of(CGNS_ENUMT(BCType_t) type) {
    const std::string name = BCTypeName[type];
    return name.starts_with("BCWall")                                   ? ZoneKind::wall
           : name.starts_with("BCInflow") || name == "BCTunnelInflow"   ? ZoneKind::inlet
           : name.starts_with("BCOutflow") || name == "BCTunnelOutflow" ? ZoneKind::outlet
           : name.starts_with("BCSymmetry")                             ? ZoneKind::symmetry
           : name == "BCFarfield"                                       ? ZoneKind::farfield
                                                                        : ZoneKind::unknown;
}

/// A boundary condition that names faces.
struct Condition {
    std::string name;
    std::string type;
    ZoneKind kind = ZoneKind::unknown;
    bool faces = false;                  ///< its points are faces (element numbers), else vertices
    std::vector<std::int64_t> elements;  ///< element numbers, from 1
    std::vector<cgsize_t> range;         ///< structured: low and high corner
};

/// Elements of the zone: number from 1 -> its type and nodes (from 0).
struct Element {
    unsigned char type = 0;
    std::size_t first = 0;
    std::size_t count = 0;
};

struct Section {
    std::string name;
    std::int64_t first = 1;
    std::int64_t last = 0;
    bool polygons = false;   ///< NGON
    bool polyhedra = false;  ///< NFACE
    std::vector<Element> elements;
    std::vector<std::int64_t> nodes;  ///< NFACE: signed face numbers

    [[nodiscard]] int dimension() const {
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
};

/// What makes SI of the file's units of mass and length (CGNS knows no time but the second).
struct Scales {
    double mass = 1;
    double length = 1;
};

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

double to_si(const Scales& scales, std::string_view unit) {
    const auto found = std::find_if(powers.begin(), powers.end(), [&](const Powers& p) { return p.unit == unit; });
    return found == powers.end() ? 1 : std::pow(scales.mass, found->mass) * std::pow(scales.length, found->length);
}

class Reader {
public:
    Reader(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress)
        : name_(path.string()), options_(options), progress_(progress) {
        std::error_code error;
        bytes_ = std::filesystem::file_size(path, error);
        std::ifstream file(path, std::ios::binary);
        std::array<char, 4> head{};
        file.read(head.data(), head.size());
        most_values_ = head[0] == '\x89' ? bytes_ * 1032 : bytes_;
        if (cg_open(name_.c_str(), CG_MODE_READ, &file_) != CG_OK) {
            throw core::InputError("format", std::string("CGNS cannot open it: ") + cg_get_error(), {name_, {}, {}, {}},
                                   "the file is cut short or damaged; copy it again");
        }
    }
    ~Reader() { cg_close(file_); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    Field read();
    [[nodiscard]] std::string understood() const {
        return understood_.empty() ? "the file opens, no zone yet" : "zones " + understood_;
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw core::InputError("format", where_ + what, {name_, {}, {}, {}}, "the file is damaged or incomplete");
    }
    void ok(int result, const char* what) const {
        if (result != CG_OK) {
            fail(std::string(what) + ": " + cg_get_error());
        }
    }
    /// So many numbers of at least 4 bytes must be in the file.
    void check_room(double count) const {
        if (!(count >= 0) || count * 4 > static_cast<double>(most_values_)) {
            fail("it claims " + core::format_number(count) + " numbers but the file has " + std::to_string(bytes_) +
                 " bytes");
        }
    }
    void read_units(Field& field);
    template <typename... Node>
    [[nodiscard]] Scales scales_at(const Scales& above, Node... node);
    void read_zone(int zone, Field& field);
    Buffer<double> coordinates(int zone);
    std::vector<Section> sections(int zone);
    Section section(int zone, int index);
    std::vector<Condition> conditions(int zone);
    [[nodiscard]] CGNS_ENUMT(BCType_t) family_type(int zone, int condition) const;
    std::vector<PartValues> solutions(int zone, std::size_t cells);
    void add_unstructured(int zone, const std::string& zone_name, Buffer<double>&& points,
                          std::vector<PartValues>&& values, Field& field);
    void add_structured(int zone, const std::string& zone_name, Buffer<double>&& points,
                        std::vector<PartValues>&& values, Field& field);
    void add_surface(Field& field, const Buffer<double>& points, const std::vector<PartValues>& values,
                     ElementPart&& surface, const BoundaryFaces& volume);
    ElementPart volume_of(const std::vector<Section>& sections, std::int64_t nodes);
    void add_polyhedra(ElementPart& volume, const Section& cells,
                       const std::map<std::int64_t, std::pair<const Section*, std::size_t>>& faces);

    std::string name_;
    const ReadOptions& options_;
    core::Progress& progress_;
    int file_ = -1;
    int base_ = 1;
    int cell_dimension_ = 3;
    std::uint64_t bytes_ = 0;
    std::uint64_t most_values_ = 0;
    std::string where_;
    std::string understood_;
    CGNS_ENUMT(ZoneType_t) type_ = CGNS_ENUMV(Unstructured);
    std::array<cgsize_t, 9> size_{};
    Scales of_base_;
    bool units_stated_ = false;
    std::map<std::string, std::string> converted_;  ///< variable -> what one of the file's units is
};

Field Reader::read() {
    Field field;
    field.format = "CGNS";
    field.files = {name_};
    int bases = 0;
    ok(cg_nbases(file_, &bases), "bases");
    if (bases < 1) {
        fail("there is no base in the file");
    }
    base_ = bases;
    if (bases > 1) {
        field.problems.push_back({core::Problem::Severity::note,
                                  "the last of " + std::to_string(bases) + " bases is read",
                                  {name_, {}, {}, {}}});
    }
    std::array<char, 33> base_name{};
    int physical = 3;
    ok(cg_base_read(file_, base_, base_name.data(), &cell_dimension_, &physical), "base");
    field.dimension = cell_dimension_ == 2 && physical == 2 ? 2 : 3;
    read_units(field);
    int zones = 0;
    ok(cg_nzones(file_, base_, &zones), "zones");
    for (int zone = 1; zone <= zones; ++zone) {
        progress_.check();
        progress_.report(static_cast<double>(zone - 1) / zones, "reading zone " + std::to_string(zone));
        read_zone(zone, field);
    }
    for (const auto& [variable, unit] : converted_) {
        field.problems.push_back({core::Problem::Severity::note,
                                  variable + " stands in the units that the file states: 1 there is " + unit,
                                  {name_, {}, {}, {}}});
    }
    if (!units_stated_) {
        field.problems.push_back(
            {core::Problem::Severity::note, "the file states no units; SI is taken", {name_, {}, {}, {}}});
    }
    return field;
}

/// The units stated at a node of the file, else those above it.
template <typename... Node>
Scales Reader::scales_at(const Scales& above, Node... node) {
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

void Reader::read_units(Field& field) {
    of_base_ = scales_at({});
    if (units_stated_) {
        field.metadata.emplace_back("length unit", core::format_number(of_base_.length) + " m");
    }
    auto data = CGNS_ENUMV(DataClassNull);
    if (cg_goto(file_, base_, "end") == CG_OK && cg_dataclass_read(&data) == CG_OK &&
        data != CGNS_ENUMV(DataClassNull) && data != CGNS_ENUMV(DataClassUserDefined) && data != CGNS_ENUMV(Dimensional)) {
        field.problems.push_back({core::Problem::Severity::warning,
                                  std::string("the file says that its values have no dimensions (") + DataClassName[data] +
                                      "): they are taken as they stand, so that lengths and forces are not SI",
                                  {name_, {}, {}, {}}});
    }
}

void Reader::read_zone(int zone, Field& field) {
    std::array<char, 33> zone_name{};
    ok(cg_zone_read(file_, base_, zone, zone_name.data(), size_.data()), "zone");
    where_ = "zone '" + std::string(zone_name.data()) + "': ";
    ok(cg_zone_type(file_, base_, zone, &type_), "zone type");
    auto points = coordinates(zone);
    double cells = size_[1];
    if (type_ == CGNS_ENUMV(Structured)) {
        cells = 1;
        for (int k = 0; k < cell_dimension_; ++k) {
            cells *= std::max<cgsize_t>(0, size_[static_cast<std::size_t>(cell_dimension_ + k)]);
        }
    }
    check_room(cells / 8);
    auto values = solutions(zone, static_cast<std::size_t>(std::max(0.0, cells)));
    if (type_ == CGNS_ENUMV(Structured)) {
        add_structured(zone, zone_name.data(), std::move(points), std::move(values), field);
    } else {
        add_unstructured(zone, zone_name.data(), std::move(points), std::move(values), field);
    }
    where_.clear();
    understood_ += (understood_.empty() ? "" : ", ") + std::string(zone_name.data());
}

Buffer<double> Reader::coordinates(int zone) {
    double count = 1;
    const int indices = type_ == CGNS_ENUMV(Structured) ? cell_dimension_ : 1;
    std::array<cgsize_t, 3> low = {1, 1, 1};
    std::array<cgsize_t, 3> high = {1, 1, 1};
    for (int k = 0; k < indices; ++k) {
        high[static_cast<std::size_t>(k)] = size_[static_cast<std::size_t>(k)];
        count *= static_cast<double>(std::max<cgsize_t>(0, high[static_cast<std::size_t>(k)]));
    }
    check_room(count);
    if (count < 1 || count > 2147483647.0) {
        fail("it has " + core::format_number(count) + " nodes");
    }
    const auto nodes = static_cast<std::size_t>(count);
    Buffer<double> points(3 * nodes);
    points.fill(0);
    Buffer<double> column(nodes);
    int coordinates = 0;
    ok(cg_ncoords(file_, base_, zone, &coordinates), "coordinates");
    for (int c = 1; c <= coordinates; ++c) {
        std::array<char, 33> coordinate{};
        CGNS_ENUMT(DataType_t) type{};
        ok(cg_coord_info(file_, base_, zone, c, &type, coordinate.data()), "coordinate");
        const std::string_view word(coordinate.data());
        const int axis = word.starts_with("Coordinate") && word.size() == 11 ? word[10] - 'X' : -1;
        if (axis < 0 || axis > 2) {
            fail("coordinates '" + std::string(word) + "' are not read (cylindrical and others)");
        }
        ok(cg_coord_read(file_, base_, zone, coordinate.data(), CGNS_ENUMV(RealDouble), low.data(), high.data(),
                         column.data()),
           "coordinates");
        const double scale = scales_at(scales_at(scales_at(of_base_, "Zone_t", zone), "Zone_t", zone, "GridCoordinates_t", 1),
                                       "Zone_t", zone, "GridCoordinates_t", 1, "DataArray_t", c)
                                 .length;
        for (std::size_t i = 0; i < nodes; ++i) {
            if (!std::isfinite(column[i])) {
                fail("a coordinate that is not a number");
            }
            points[3 * i + static_cast<std::size_t>(axis)] = scale * column[i];
        }
    }
    return points;
}

Section Reader::section(int zone, int index) {
    Section result;
    std::array<char, 33> section_name{};
    CGNS_ENUMT(ElementType_t) type{};
    cgsize_t first = 0;
    cgsize_t last = 0;
    int boundary = 0;
    int parent = 0;
    ok(cg_section_read(file_, base_, zone, index, section_name.data(), &type, &first, &last, &boundary, &parent),
       "section");
    result.name = section_name.data();
    result.first = first;
    result.last = last;
    const std::int64_t count = static_cast<std::int64_t>(last) - first + 1;
    cgsize_t data = 0;
    ok(cg_ElementDataSize(file_, base_, zone, index, &data), "section size");
    check_room(static_cast<double>(data));
    if (first < 1 || count < 1 || data < count) {
        fail("section '" + result.name + "' has elements " + std::to_string(first) + " to " + std::to_string(last) +
             " in " + std::to_string(data) + " numbers");
    }
    std::vector<cgsize_t> raw(static_cast<std::size_t>(data));
    const bool mixed = type == CGNS_ENUMV(MIXED);
    result.polygons = type == CGNS_ENUMV(NGON_n);
    result.polyhedra = type == CGNS_ENUMV(NFACE_n);
    std::vector<cgsize_t> offsets;
    if (mixed || result.polygons || result.polyhedra) {
        offsets.resize(static_cast<std::size_t>(count) + 1);
        ok(cg_poly_elements_read(file_, base_, zone, index, raw.data(), offsets.data(), nullptr), "elements");
    } else {
        ok(cg_elements_read(file_, base_, zone, index, raw.data(), nullptr), "elements");
    }
    result.elements.reserve(static_cast<std::size_t>(count));
    std::size_t at = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        auto kind_number = type;
        std::size_t size = 0;
        if (!offsets.empty()) {
            if (offsets[i] < 0 || offsets[i + 1] < offsets[i] || offsets[i + 1] > data) {
                fail("section '" + result.name + "': element " + std::to_string(i + 1) + " lies outside its list");
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
            fail("section '" + result.name + "': element " + std::to_string(i + 1) + " is of a kind that is not read");
        }
        result.elements.push_back({kind->type, result.nodes.size(), static_cast<std::size_t>(kind->corners)});
        result.nodes.insert(result.nodes.end(), raw.begin() + static_cast<std::ptrdiff_t>(at),
                            raw.begin() + static_cast<std::ptrdiff_t>(at) + kind->corners);
        at += static_cast<std::size_t>(stored);
    }
    if (!result.polyhedra) {
        for (auto& node : result.nodes) {
            if (node < 1 || node > size_[0]) {
                fail("section '" + result.name + "' names node " + std::to_string(node) + " of " +
                     std::to_string(size_[0]));
            }
            --node;
        }
    }
    return result;
}

std::vector<Section> Reader::sections(int zone) {
    int count = 0;
    ok(cg_nsections(file_, base_, zone, &count), "sections");
    std::vector<Section> result;
    for (int s = 1; s <= count; ++s) {
        progress_.check();
        result.push_back(section(zone, s));
    }
    std::sort(result.begin(), result.end(), [](const Section& a, const Section& b) { return a.first < b.first; });
    return result;
}

/// The condition that the family of a boundary has.
CGNS_ENUMT(BCType_t) Reader::family_type(int zone, int condition) const {
    auto type = CGNS_ENUMV(FamilySpecified);
    std::array<char, 33 * 21> wanted{};
    int families = 0;
    if (cg_goto(file_, base_, "Zone_t", zone, "ZoneBC_t", 1, "BC_t", condition, "end") != CG_OK ||
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

std::vector<Condition> Reader::conditions(int zone) {
    std::vector<Condition> result;
    int count = 0;
    if (cg_nbocos(file_, base_, zone, &count) != CG_OK) {
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
        if (cg_boco_info(file_, base_, zone, b, name.data(), &type, &set, &points, normal_index.data(), &normals,
                         &normal_type, &data_sets) != CG_OK) {
            continue;
        }
        Condition condition;
        condition.name = name.data();
        type = type == CGNS_ENUMV(FamilySpecified) ? family_type(zone, b) : type;
        condition.type = BCTypeName[type];
        condition.kind = kind_of(type);
        const bool elements = set == CGNS_ENUMV(ElementRange) || set == CGNS_ENUMV(ElementList);
        if (cg_boco_gridlocation_read(file_, base_, zone, b, &location) != CG_OK) {
            location = CGNS_ENUMV(Vertex);
        }
        const bool edges_bound = cell_dimension_ == 2 && location == CGNS_ENUMV(EdgeCenter);
        condition.faces = elements || edges_bound || location == CGNS_ENUMV(FaceCenter);
        const int indices = type_ == CGNS_ENUMV(Structured) ? cell_dimension_ : 1;
        check_room(static_cast<double>(points) * indices);
        std::vector<cgsize_t> raw(static_cast<std::size_t>(std::max<cgsize_t>(0, points)) *
                                  static_cast<std::size_t>(indices));
        const bool range = set == CGNS_ENUMV(PointRange) || set == CGNS_ENUMV(ElementRange);
        const bool wanted = type_ == CGNS_ENUMV(Structured) ? range && points == 2 : condition.faces;
        if (wanted && !raw.empty() && cg_boco_read(file_, base_, zone, b, raw.data(), nullptr) == CG_OK) {
            if (type_ == CGNS_ENUMV(Structured)) {
                condition.range = raw;
            } else if (range && raw.size() == 2) {
                check_room(static_cast<double>(raw[1]) - raw[0]);
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

std::vector<PartValues> Reader::solutions(int zone, std::size_t cells) {
    std::vector<PartValues> result;
    int count = 0;
    if (cg_nsols(file_, base_, zone, &count) != CG_OK) {
        return result;
    }
    const int indices = type_ == CGNS_ENUMV(Structured) ? cell_dimension_ : 1;
    for (int s = 1; s <= count; ++s) {
        std::array<char, 33> solution{};
        CGNS_ENUMT(GridLocation_t) location{};
        int fields = 0;
        if (cg_sol_info(file_, base_, zone, s, solution.data(), &location) != CG_OK ||
            cg_nfields(file_, base_, zone, s, &fields) != CG_OK ||
            (location != CGNS_ENUMV(Vertex) && location != CGNS_ENUMV(CellCenter))) {
            continue;
        }
        const bool nodal = location == CGNS_ENUMV(Vertex);
        std::array<cgsize_t, 3> low = {1, 1, 1};
        std::array<cgsize_t, 3> high = {1, 1, 1};
        double size = 1;
        for (int k = 0; k < indices; ++k) {
            high[static_cast<std::size_t>(k)] = size_[static_cast<std::size_t>(nodal ? k : indices + k)];
            size *= static_cast<double>(high[static_cast<std::size_t>(k)]);
        }
        if (!nodal && size != static_cast<double>(cells)) {
            continue;
        }
        check_room(size);
        for (int f = 1; f <= fields; ++f) {
            progress_.check();
            std::array<char, 33> name{};
            CGNS_ENUMT(DataType_t) type{};
            ok(cg_field_info(file_, base_, zone, s, f, &type, name.data()), "field");
            const CanonicalName canonical = canonical_name(name.data());
            const auto component = vector_component(canonical.name);
            if (!options_.arrays.empty() && !matches_any(options_.arrays, name.data()) &&
                !matches_any(options_.arrays, canonical.name) &&
                !(component && matches_any(options_.arrays, component->vector))) {
                continue;
            }
            PartValues values{name.data(), nodal, 1, Buffer<double>(static_cast<std::size_t>(size))};
            ok(cg_field_read(file_, base_, zone, s, name.data(), CGNS_ENUMV(RealDouble), low.data(), high.data(),
                             values.values.data()),
               "field");
            const Scales scales = scales_at(scales_at(scales_at(of_base_, "Zone_t", zone), "Zone_t", zone, "FlowSolution_t", s),
                                            "Zone_t", zone, "FlowSolution_t", s, "DataArray_t", f);
            if (const double scale = to_si(scales, canonical.unit); scale != 1) {
                converted_[name.data()] = core::format_number(scale) + " " + canonical.unit;
                std::for_each(values.values.begin(), values.values.end(), [&](double& value) { value *= scale; });
            }
            result.push_back(std::move(values));
        }
    }
    return result;
}

void Reader::add_polyhedra(ElementPart& volume, const Section& cells,
                           const std::map<std::int64_t, std::pair<const Section*, std::size_t>>& faces) {
    for (const auto& cell : cells.elements) {
        std::vector<std::int64_t> corners;
        volume.polyhedra.push_back(static_cast<std::int64_t>(cell.count));
        for (std::size_t k = 0; k < cell.count; ++k) {
            const std::int64_t signed_face = cells.nodes[cell.first + k];
            const std::int64_t number = std::abs(signed_face);
            auto found = faces.upper_bound(number);
            if (found == faces.begin() || number < 1) {
                fail("a cell names face " + std::to_string(number) + ", which is not there");
            }
            const auto& [first, home] = *std::prev(found);
            const Section& polygons = *home.first;
            const auto place = static_cast<std::size_t>(number - first);
            if (place >= polygons.elements.size()) {
                fail("a cell names face " + std::to_string(number) + ", which is not there");
            }
            const Element& face = polygons.elements[place];
            volume.polyhedra.push_back(static_cast<std::int64_t>(face.count));
            for (std::size_t i = 0; i < face.count; ++i) {
                const std::size_t turned = signed_face > 0 ? i : face.count - 1 - i;
                volume.polyhedra.push_back(polygons.nodes[face.first + turned]);
                corners.push_back(polygons.nodes[face.first + i]);
            }
        }
        std::sort(corners.begin(), corners.end());
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        volume.add(VTK_POLYHEDRON, corners.data(), corners.size());
    }
}

ElementPart Reader::volume_of(const std::vector<Section>& all, std::int64_t /*nodes*/) {
    ElementPart volume;
    std::map<std::int64_t, std::pair<const Section*, std::size_t>> faces;
    for (const auto& section : all) {
        if (section.polygons) {
            faces[section.first] = {&section, 0};
        }
    }
    for (const auto& section : all) {
        if (section.polyhedra) {
            add_polyhedra(volume, section, faces);
        } else if (section.dimension() == cell_dimension_ && !(section.polygons && cell_dimension_ == 3)) {
            for (const auto& element : section.elements) {
                volume.add(element.type, section.nodes.data() + element.first, element.count);
            }
        }
    }
    return volume;
}

/// Where the pressure lies in the cells alone, a surface takes that of those behind its faces; its own nodes know better.
std::vector<PartValues> pressure_beside(const ElementPart& surface, const std::vector<PartValues>& values,
                                        const BoundaryFaces& volume) {
    std::vector<PartValues> own;
    for (const auto& entry : values) {
        const std::string name = canonical_name(entry.variable).name;
        const bool on_nodes = std::any_of(values.begin(), values.end(), [&](const PartValues& other) {
            return other.on_nodes && canonical_name(other.variable).name == name;
        });
        if (on_nodes || (name != "pressure" && name != "pressure_absolute")) {
            continue;
        }
        PartValues part{entry.variable, false, 1, Buffer<double>(surface.elements())};
        bool any = false;
        for (std::size_t i = 0; i < surface.elements(); ++i) {
            const auto count = static_cast<std::size_t>(surface.offsets[i + 1] - surface.offsets[i]);
            const std::int64_t cell = volume.cell_behind(surface.nodes.data() + surface.offsets[i], count);
            const bool found = cell >= 0 && static_cast<std::size_t>(cell) < entry.values.size();
            part.values[i] = found ? entry.values[static_cast<std::size_t>(cell)] : std::numeric_limits<double>::quiet_NaN();
            any = any || found;
        }
        if (any) {
            own.push_back(std::move(part));
        }
    }
    return own;
}

/// A surface gets the points it uses, and their values.
void Reader::add_surface(Field& field, const Buffer<double>& points, const std::vector<PartValues>& values,
                         ElementPart&& surface, const BoundaryFaces& volume) {
    if (surface.elements() == 0 || !matches_any(options_.zones, surface.name)) {
        return;
    }
    const bool settled = volume.turn_into_volume(surface, points);
    std::vector<PartValues> own = pressure_beside(surface, values, volume);
    const bool of_cells = !own.empty();
    std::unordered_map<std::int64_t, std::int64_t> places;
    std::vector<std::int64_t> used(surface.nodes);
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    places.reserve(used.size());
    surface.points.grow_to(3 * used.size());
    for (std::size_t i = 0; i < used.size(); ++i) {
        places[used[i]] = static_cast<std::int64_t>(i);
        std::copy_n(points.data() + 3 * used[i], 3, surface.points.data() + 3 * i);
    }
    for (auto& node : surface.nodes) {
        node = places[node];
    }
    for (const auto& entry : values) {
        if (entry.on_nodes) {
            PartValues part{entry.variable, true, 1, Buffer<double>(used.size())};
            for (std::size_t i = 0; i < used.size(); ++i) {
                part.values[i] = entry.values[static_cast<std::size_t>(used[i])];
            }
            own.push_back(std::move(part));
        }
    }
    Zone zone = zone_from(std::move(surface), std::move(own), cell_dimension_, options_, name_, field.problems);
    zone.normals_into_fluid = settled;
    for (auto& info : zone.arrays) {
        info.on = of_cells && info.on == Location::faces ? Location::cells : info.on;
    }
    field.zones.push_back(std::move(zone));
}

void Reader::add_unstructured(int zone, const std::string& zone_name, Buffer<double>&& points,
                              std::vector<PartValues>&& values, Field& field) {
    const auto all = sections(zone);
    const auto bounds = conditions(zone);
    ElementPart volume = volume_of(all, size_[0]);
    if (volume.elements() != static_cast<std::size_t>(std::max<cgsize_t>(0, size_[1]))) {
        field.problems.push_back({core::Problem::Severity::warning,
                                  where_ + "it declares " + std::to_string(size_[1]) + " cells, its sections hold " +
                                      std::to_string(volume.elements()),
                                  {name_, {}, {}, {}}});
        std::erase_if(values, [](const PartValues& v) { return !v.on_nodes; });
    }
    std::vector<ElementPart> surfaces;
    std::vector<bool> shown(all.size());
    for (const auto& condition : bounds) {
        ElementPart part;
        part.name = condition.name;
        part.kind = condition.kind;
        part.original_kind = condition.type;
        for (const std::int64_t number : condition.elements) {
            for (std::size_t s = 0; s < all.size(); ++s) {
                if (number >= all[s].first && number <= all[s].last && !all[s].polyhedra &&
                    all[s].dimension() < cell_dimension_ + (all[s].polygons ? 1 : 0)) {
                    const Element& element = all[s].elements[static_cast<std::size_t>(number - all[s].first)];
                    part.add(element.type, all[s].nodes.data() + element.first, element.count);
                    shown[s] = true;
                }
            }
        }
        surfaces.push_back(std::move(part));
    }
    for (std::size_t s = 0; s < all.size(); ++s) {
        if (shown[s] || all[s].polyhedra || all[s].dimension() != cell_dimension_ - 1) {
            continue;
        }
        // Polygons without a condition are the faces of the polyhedra.
        if (all[s].polygons && cell_dimension_ == 3 && volume.polyhedra.size() > 0) {
            continue;
        }
        ElementPart part;
        part.name = all[s].name;
        for (const auto& condition : bounds) {
            if (condition.name == part.name) {
                part.kind = condition.kind;
                part.original_kind = condition.type;
            }
        }
        for (const auto& element : all[s].elements) {
            part.add(element.type, all[s].nodes.data() + element.first, element.count);
        }
        surfaces.push_back(std::move(part));
    }
    const BoundaryFaces faces(surfaces, volume);
    for (auto& surface : surfaces) {
        add_surface(field, points, values, std::move(surface), faces);
    }
    if (volume.elements() > 0 && !options_.surfaces_only && matches_any(options_.zones, zone_name)) {
        volume.name = zone_name;
        volume.kind = ZoneKind::fluid;
        volume.points = std::move(points);
        const std::int64_t turned = turn_inverted_cells(volume);
        if (turned > 0) {
            field.metadata.emplace_back("cells turned to VTK's order in " + zone_name, std::to_string(turned));
        }
        field.zones.push_back(
            zone_from(std::move(volume), std::move(values), cell_dimension_, options_, name_, field.problems));
    }
}

void Reader::add_structured(int zone, const std::string& zone_name, Buffer<double>&& points,
                            std::vector<PartValues>&& values, Field& field) {
    if (cell_dimension_ != 3 && cell_dimension_ != 2) {
        fail("structured zones of " + std::to_string(cell_dimension_) + " dimensions are not read");
    }
    const std::int64_t ni = size_[0];
    const std::int64_t nj = size_[1];
    const std::int64_t nk = cell_dimension_ == 3 ? size_[2] : 1;
    const auto node = [&](std::int64_t i, std::int64_t j, std::int64_t k) { return (k * nj + j) * ni + i; };
    ElementPart volume;
    for (std::int64_t k = 0; k < std::max<std::int64_t>(1, nk - 1); ++k) {
        progress_.check();
        for (std::int64_t j = 0; j + 1 < nj; ++j) {
            for (std::int64_t i = 0; i + 1 < ni; ++i) {
                std::array<std::int64_t, 8> n = {
                    node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k), 0, 0, 0, 0};
                if (cell_dimension_ == 3) {
                    for (std::size_t c = 0; c < 4; ++c) {
                        n[c + 4] = n[c] + ni * nj;
                    }
                    if (nk > 1) {
                        volume.add(VTK_HEXAHEDRON, n.data(), 8);
                    }
                } else {
                    volume.add(VTK_QUAD, n.data(), 4);
                }
            }
        }
    }
    std::vector<ElementPart> surfaces;
    for (const auto& condition : conditions(zone)) {
        if (condition.range.size() != 6 || cell_dimension_ != 3) {
            continue;
        }
        std::array<std::int64_t, 3> low{};
        std::array<std::int64_t, 3> high{};
        const std::array<std::int64_t, 3> most = {ni, nj, nk};
        int flat = -1;
        for (std::size_t d = 0; d < 3; ++d) {
            low[d] = std::min(condition.range[d], condition.range[d + 3]) - 1;
            high[d] = std::max(condition.range[d], condition.range[d + 3]) - 1;
            if (low[d] < 0 || high[d] >= most[d]) {
                fail("condition '" + condition.name + "' lies outside the zone");
            }
            flat = low[d] == high[d] ? static_cast<int>(d) : flat;
        }
        if (flat < 0) {
            continue;
        }
        const auto a = static_cast<std::size_t>((flat + 1) % 3);
        const auto b = static_cast<std::size_t>((flat + 2) % 3);
        ElementPart part;
        part.name = condition.name;
        part.kind = condition.kind;
        part.original_kind = condition.type;
        for (std::int64_t v = low[b]; v < high[b]; ++v) {
            for (std::int64_t u = low[a]; u < high[a]; ++u) {
                std::array<std::int64_t, 4> quad{};
                const std::array<std::pair<int, int>, 4> steps = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
                for (std::size_t c = 0; c < 4; ++c) {
                    std::array<std::int64_t, 3> at = low;
                    at[a] = u + steps[c].first;
                    at[b] = v + steps[c].second;
                    quad[c] = node(at[0], at[1], at[2]);
                }
                part.add(VTK_QUAD, quad.data(), 4);
            }
        }
        surfaces.push_back(std::move(part));
    }
    const BoundaryFaces faces(surfaces, volume);
    for (auto& surface : surfaces) {
        surface.name = zone_name + "/" + surface.name;
        add_surface(field, points, values, std::move(surface), faces);
    }
    if (volume.elements() > 0 && !options_.surfaces_only && matches_any(options_.zones, zone_name)) {
        volume.name = zone_name;
        volume.kind = ZoneKind::fluid;
        volume.points = std::move(points);
        field.zones.push_back(
            zone_from(std::move(volume), std::move(values), cell_dimension_, options_, name_, field.problems));
    }
}

bool recognises(std::string_view head, const std::filesystem::path& path) {
    if (head.substr(0, 32).find("ADF Database") != std::string_view::npos) {
        return true;
    }
    if (!head.starts_with(std::string_view("\x89HDF\r\n\x1a\n", 8))) {
        return false;
    }
    try {
        return Hdf5File(path).has("/CGNSLibraryVersion");
    } catch (const core::InputError&) {
        return core::lower_case(path.extension().string()) == ".cgns";
    }
}

Field read(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress) {
    // libcgns trusts what it reads: a damaged file is its end, and not to be that of the program.
    try_in_child(path, [&] { Reader(path, options, core::Progress::none()).read(); });
    Reader reader(path, options, progress);
    return telling([&] { return reader.read(); }, [&] { return reader.understood(); });
}

}  // namespace

Importer cgns_importer() { return {"CGNS", recognises, read}; }

}  // namespace underbody::postproc
