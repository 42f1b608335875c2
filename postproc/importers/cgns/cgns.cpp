// CGNS in ADF and HDF5: volumes, 2-D boundary sections, solutions at vertices and cells.
#include <vtkCellType.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "core/text.h"
#include "postproc/field/times.h"
#include "postproc/importers/cgns/cgns_block.h"
#include "postproc/importers/cgns/cgns_file.h"
#include "postproc/importers/cgns/cgns_surfaces.h"
#include "postproc/importers/hdf5/hdf5_file.h"
#include "postproc/importers/import_context.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/mesh/element_zone.h"
#include "postproc/importers/mesh/face_orientation.h"
#include "postproc/importers/sandboxed_read.h"

namespace underbody::postproc {

namespace {

class Reader {
public:
    Reader(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress)
        : file_(path, options.time, options.base), name_(path.string()), options_(options), progress_(progress) {}

    Field read();
    [[nodiscard]] std::string understood() const {
        return understood_.empty() ? "the file opens, no zone yet" : "zones " + understood_;
    }

private:
    bool is_shell();
    void add_notes(Field& field) const;
    void add_unstructured(const CgnsZone& zone, Field& field);
    void add_structured(const CgnsZone& zone, Field& field);
    /// What the surfaces of a zone have in common.
    struct Sides {
        const CgnsZone& zone;
        const Buffer<double>& points;
        const std::vector<PartValues>& values;
        const BoundaryFaces& volume;
    };
    void add_surfaces(Field& field, const CgnsZone& zone, const Buffer<double>& points,
                      const std::vector<PartValues>& values, std::vector<CgnsSurface>&& surfaces,
                      const ElementPart& volume);
    void add_sides(Field& field, const Sides& at, CgnsSurface&& surface);
    void add_surface(Field& field, const Sides& at, CgnsSurface&& surface, bool sided);
    void add_own_values(const CgnsSurface& surface, const CgnsZone& zone, const std::vector<std::int64_t>& nodes,
                        std::vector<PartValues>& values, std::set<std::string>& of_cells);
    void add_volume(const CgnsZone& zone, Field& field, ElementPart&& volume, Buffer<double>&& points,
                    std::vector<PartValues>&& values);
    [[nodiscard]] ElementPart volume_of(const CgnsZone& zone, const std::vector<CgnsSection>& sections,
                                        CellsOfPolygons& cells_of_polygons) const;
    void add_polyhedra(const CgnsZone& zone, ElementPart& volume, const CgnsSection& cells,
                       const std::map<std::int64_t, std::size_t>& polygons, const std::vector<CgnsSection>& sections,
                       CellsOfPolygons& cells_of_polygons) const;
    void tell_of(Field& field, const CgnsZone& zone, const std::string& surface, const CgnsCondition& condition,
                 const std::string& what) const;

    CgnsFile file_;
    std::string name_;
    const ReadOptions& options_;
    core::Progress& progress_;
    std::string understood_;
    bool shell_ = false;               ///< its cells are faces in space
    int solutions_left_ = 0;           ///< of other steps
    std::vector<std::string> unread_;  ///< values of boundaries' own
};

Field Reader::read() {
    Field field;
    field.format = "CGNS";
    field.files = {name_};
    shell_ = is_shell();
    field.dimension = file_.cell_dimension() == 2 && !shell_ ? 2 : 3;
    if (const auto& times = file_.times(); !times.empty()) {
        if (file_.time()) {
            field.metadata.emplace_back("time", core::format_number(*file_.time()));
        }
        state_times(field, times);
    }
    double zones_read = 0;
    for (const int index : file_.zones()) {
        progress_.check();
        progress_.report(zones_read++ / static_cast<double>(file_.zones().size()),
                         "reading zone " + std::to_string(index));
        const CgnsZone zone = file_.zone(index);
        zone.structured ? add_structured(zone, field) : add_unstructured(zone, field);
        understood_ += (understood_.empty() ? "" : ", ") + zone.name;
    }
    if (file_.units_stated()) {
        field.metadata.emplace_back("length unit", core::format_number(file_.base_length()) + " m");
    } else if (!options_.length_unit.empty()) {
        field.metadata.emplace_back("length unit", options_.length_unit);
    }
    add_notes(field);
    return field;
}

/// Faces in space are a surface, unless all of them lie in one plane across z: that is a plane flow.
bool Reader::is_shell() {
    if (file_.cell_dimension() != 2 || file_.physical_dimension() != 3) {
        return false;
    }
    std::optional<double> z;
    for (const int index : file_.zones()) {
        const auto points = file_.points(file_.zone(index), options_.length_unit);
        for (std::size_t i = 2; i < points.size(); i += 3) {
            if (points[i] != z.value_or(points[i])) {
                return true;
            }
            z = points[i];
        }
    }
    return false;
}

/// What one should know about the file as a whole.
void Reader::add_notes(Field& field) const {
    const auto add = [&](core::Problem::Severity severity, const std::string& text) {
        field.problems.push_back({severity, text, {name_, {}, {}, {}}});
    };
    if (file_.newer_version() > 0) {
        add(core::Problem::Severity::note, "written by CGNS " + core::format_number(file_.newer_version(), 3) +
                                               ", later than the library that reads it");
    }
    if (solutions_left_ > 0 && !options_.time) {
        add(core::Problem::Severity::note, "of several solutions in time the last is read");
    }
    if (!unread_.empty()) {
        add(core::Problem::Severity::warning,
            "values that boundaries hold for themselves (BCDataSet) are not read: " + listed(unread_));
    }
    if (const auto others = file_.other_bases(); !others.empty() && options_.base.empty()) {
        add(core::Problem::Severity::warning, "the file has " + std::to_string(file_.bases()) +
                                                  " bases, of which the last is read, '" + file_.base_name() +
                                                  "': what is in " + listed(others) +
                                                  " is not here (option 'cgns-base' chooses another)");
    } else if (file_.bases() > 1) {
        add(core::Problem::Severity::note,
            "of " + std::to_string(file_.bases()) + " bases '" + file_.base_name() + "' is read");
    }
    for (const auto& warning : file_.warnings()) {
        add(core::Problem::Severity::warning, warning);
    }
    for (const auto& [data, variables] : file_.without_dimensions()) {
        add(core::Problem::Severity::warning, "the file says that " + listed({variables.begin(), variables.end()}) +
                                                  (variables.size() > 1 ? " have" : " has") + " no dimensions (" +
                                                  data +
                                                  (data == "NormalizedByDimensional" ? " without a conversion" : "") +
                                                  "): taken as they stand, so that lengths and forces may not be SI");
    }
    for (const auto& [variable, unit] : file_.converted()) {
        add(core::Problem::Severity::note, variable + " stands in the units that the file states: 1 there is " + unit);
    }
    if (!file_.units_stated() && options_.length_unit.empty()) {
        add(core::Problem::Severity::note, "the file states no units; SI is taken");
    }
}

/// `polygons`: sections of polygons by their first number.
void Reader::add_polyhedra(const CgnsZone& zone, ElementPart& volume, const CgnsSection& cells,
                           const std::map<std::int64_t, std::size_t>& polygons,
                           const std::vector<CgnsSection>& sections, CellsOfPolygons& cells_of_polygons) const {
    for (const auto& cell : cells.elements) {
        std::vector<std::int64_t> corners;
        volume.polyhedra.push_back(static_cast<std::int64_t>(cell.count));
        for (std::size_t k = 0; k < cell.count; ++k) {
            const std::int64_t signed_face = cells.nodes[cell.first + k];
            const std::int64_t number = std::abs(signed_face);
            const auto after = polygons.upper_bound(number);
            const std::size_t s = after == polygons.begin() ? 0 : std::prev(after)->second;
            const auto place = static_cast<std::size_t>(number - sections[s].first);
            if (after == polygons.begin() || number < 1 || place >= sections[s].elements.size()) {
                file_.fail(zone, "a cell names face " + std::to_string(number) + ", which is not there");
            }
            const CgnsSection::Element& face = sections[s].elements[place];
            volume.polyhedra.push_back(static_cast<std::int64_t>(face.count));
            for (std::size_t i = 0; i < face.count; ++i) {
                const std::size_t turned = signed_face > 0 ? i : face.count - 1 - i;
                volume.polyhedra.push_back(sections[s].nodes[face.first + turned]);
                corners.push_back(sections[s].nodes[face.first + i]);
            }
            auto& count = cells_of_polygons[s][place];
            count = static_cast<unsigned char>(std::min(2, count + 1));
        }
        std::sort(corners.begin(), corners.end());
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        volume.add(VTK_POLYHEDRON, corners.data(), corners.size());
    }
}

ElementPart Reader::volume_of(const CgnsZone& zone, const std::vector<CgnsSection>& sections,
                              CellsOfPolygons& cells_of_polygons) const {
    ElementPart volume;
    std::map<std::int64_t, std::size_t> polygons;
    cells_of_polygons.resize(sections.size());
    const bool polyhedra =
        std::any_of(sections.begin(), sections.end(), [](const CgnsSection& section) { return section.polyhedra; });
    for (std::size_t s = 0; s < sections.size(); ++s) {
        if (sections[s].polygons && polyhedra) {
            polygons[sections[s].first] = s;
            cells_of_polygons[s].resize(sections[s].elements.size());
        }
    }
    for (const auto& section : sections) {
        if (section.polyhedra) {
            add_polyhedra(zone, volume, section, polygons, sections, cells_of_polygons);
            continue;
        }
        for (const auto& element : section.elements) {
            if (element.dimension() == file_.cell_dimension()) {
                volume.add(element.type, section.nodes.data() + element.first, element.count);
            }
        }
    }
    return volume;
}

/// Where the pressure lies in the cells alone, a surface takes that of those behind its faces; its own nodes know
/// better. Between two cells that is the one on its side, or of a surface that has no sides their mean.
std::vector<PartValues> pressure_beside(const ElementPart& surface, const Buffer<double>& points,
                                        const std::vector<PartValues>& values, const BoundaryFaces& volume,
                                        bool sided) {
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
            const auto cells = volume.cells_at(surface.nodes.data() + surface.offsets[i], count, points);
            const auto value_of = [&](std::int64_t cell) {
                return cell >= 0 && static_cast<std::size_t>(cell) < entry.values.size()
                           ? entry.values[static_cast<std::size_t>(cell)]
                           : std::numeric_limits<double>::quiet_NaN();
            };
            part.values[i] = sided || cells[1] < 0 ? value_of(cells[0]) : (value_of(cells[0]) + value_of(cells[1])) / 2;
            any = any || cells[0] >= 0;
        }
        if (any) {
            own.push_back(std::move(part));
        }
    }
    return own;
}

void Reader::add_surfaces(Field& field, const CgnsZone& zone, const Buffer<double>& points,
                          const std::vector<PartValues>& values, std::vector<CgnsSurface>&& surfaces,
                          const ElementPart& volume) {
    std::vector<const ElementPart*> parts;
    for (const auto& surface : surfaces) {
        parts.push_back(&surface.part);
    }
    const BoundaryFaces faces(parts, volume);
    for (auto& surface : surfaces) {
        add_sides(field, {zone, points, values, faces}, std::move(surface));
    }
}

/// What may be a wall between two cells has two sides: two surfaces, as Fluent's wall and its shadow are. The pressure
/// of one side alone is no load.
void Reader::add_sides(Field& field, const Sides& at, CgnsSurface&& surface) {
    const ElementPart& front = surface.part;
    const bool sided = !shell_ && (front.kind == ZoneKind::wall || front.kind == ZoneKind::unknown);
    CgnsSurface back;
    if (sided) {
        back.part = at.volume.other_side(front);
    }
    if (back.part.elements() > 0 && matches_any(options_.zones, front.name)) {
        const bool on_nodes = std::any_of(at.values.begin(), at.values.end(), [](const PartValues& value) {
            return value.on_nodes && canonical_name(value.variable).name == "pressure";
        });
        field.problems.push_back(
            {core::Problem::Severity::warning,
             "'" + front.name + "' has cells on both sides of " + std::to_string(back.part.elements()) + " of its " +
                 std::to_string(front.elements()) + " faces: the other side is '" + back.part.name + "', and '" +
                 front.name + "*' are both" +
                 (on_nodes ? "; its pressure stands at nodes, so that it is the same on both" : ""),
             {name_, {}, {}, {}}});
    }
    add_surface(field, at, std::move(surface), sided);
    add_surface(field, at, std::move(back), sided);
}

/// A boundary's own values are its where the solution at nodes has none of that variable; one for each face is better
/// than the pressure of the cells behind (`of_cells`).
void Reader::add_own_values(const CgnsSurface& surface, const CgnsZone& zone, const std::vector<std::int64_t>& nodes,
                            std::vector<PartValues>& values, std::set<std::string>& of_cells) {
    if (surface.condition == nullptr || surface.condition->data_sets == 0) {
        return;
    }
    std::vector<std::string> unread;
    for (const auto& stated : file_.boundary_values(zone, *surface.condition, options_, unread)) {
        auto own = values_on(file_, surface, nodes, zone, stated);
        if (!own) {
            unread.push_back(stated.variable);
            continue;
        }
        const std::string name = canonical_name(stated.variable).name;
        const auto before = std::find_if(values.begin(), values.end(), [&](const PartValues& value) {
            return canonical_name(value.variable).name == name;
        });
        if (before == values.end()) {
            values.push_back(std::move(*own));
        } else if (of_cells.contains(name) && stated.values.size() > 1) {
            of_cells.erase(name);
            *before = std::move(*own);
        }
    }
    for (const auto& variable : unread) {
        unread_.push_back(variable + " of '" + surface.part.name + "'");
    }
}

/// A surface gets the points it uses, and their values.
void Reader::add_surface(Field& field, const Sides& at, CgnsSurface&& one, bool sided) {
    ElementPart& surface = one.part;
    if (surface.elements() == 0 || !matches_any(options_.zones, surface.name)) {
        return;
    }
    const bool settled = at.volume.turn_into_volume(surface, at.points, sided);
    std::vector<PartValues> own = pressure_beside(surface, at.points, at.values, at.volume, sided);
    std::set<std::string> of_cells;
    for (const auto& value : own) {
        of_cells.insert(canonical_name(value.variable).name);
    }
    std::unordered_map<std::int64_t, std::int64_t> places;
    std::vector<std::int64_t> used(surface.nodes);
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    places.reserve(used.size());
    surface.points.grow_to(3 * used.size());
    for (std::size_t i = 0; i < used.size(); ++i) {
        places[used[i]] = static_cast<std::int64_t>(i);
        std::copy_n(at.points.data() + 3 * used[i], 3, surface.points.data() + 3 * i);
    }
    for (auto& node : surface.nodes) {
        node = places[node];
    }
    for (const auto& entry : at.values) {
        if (entry.on_nodes) {
            PartValues part{entry.variable, true, 1, Buffer<double>(used.size())};
            for (std::size_t i = 0; i < used.size(); ++i) {
                part.values[i] = entry.values[static_cast<std::size_t>(used[i])];
            }
            own.push_back(std::move(part));
        }
    }
    add_own_values(one, at.zone, used, own, of_cells);
    Zone zone = zone_from(std::move(surface), std::move(own), shell_ ? 3 : file_.cell_dimension(), options_, name_,
                          field.problems);
    zone.normals_into_fluid = settled;
    for (auto& info : zone.arrays) {
        info.on = info.on == Location::faces && of_cells.contains(info.name) ? Location::cells : info.on;
    }
    field.zones.push_back(std::move(zone));
}

void Reader::tell_of(Field& field, const CgnsZone& zone, const std::string& surface, const CgnsCondition& condition,
                     const std::string& what) const {
    // Points and lines are all that degenerate ones have.
    if (!condition.type.starts_with("BCDegenerate") && matches_any(options_.zones, surface)) {
        field.problems.push_back(
            {core::Problem::Severity::warning,
             "zone '" + zone.name + "': boundary condition '" + condition.name + "' (" + condition.type + ") " + what,
             {name_, {}, {}, {}}});
    }
}

void Reader::add_volume(const CgnsZone& zone, Field& field, ElementPart&& volume, Buffer<double>&& points,
                        std::vector<PartValues>&& values) {
    if (volume.elements() == 0 || (options_.surfaces_only && !shell_) || !matches_any(options_.zones, zone.name)) {
        return;
    }
    volume.name = zone.name;
    volume.kind = shell_ ? ZoneKind::unknown : ZoneKind::fluid;
    volume.points = std::move(points);
    field.zones.push_back(zone_from(std::move(volume), std::move(values), shell_ ? 3 : file_.cell_dimension(), options_,
                                    name_, field.problems));
}

void Reader::add_unstructured(const CgnsZone& zone, Field& field) {
    auto points = file_.points(zone, options_.length_unit);
    auto values = file_.solutions(zone, options_, progress_, solutions_left_);
    const auto sections = file_.sections(zone, progress_);
    CellsOfPolygons cells_of_polygons;
    ElementPart volume = volume_of(zone, sections, cells_of_polygons);
    if (static_cast<std::int64_t>(volume.elements()) != zone.cells[0]) {
        field.problems.push_back({core::Problem::Severity::warning,
                                  "zone '" + zone.name + "': it declares " + std::to_string(zone.cells[0]) +
                                      " cells, its sections hold " + std::to_string(volume.elements()),
                                  {name_, {}, {}, {}}});
        std::erase_if(values, [](const PartValues& v) { return !v.on_nodes; });
    }
    const auto conditions = file_.conditions(zone);
    CgnsSurfaces surfaces = surfaces_of(sections, conditions, cells_of_polygons, file_.cell_dimension());
    for (const auto& [condition, what] : surfaces.told) {
        tell_of(field, zone, condition->name, *condition, what);
    }
    add_surfaces(field, zone, points, values, std::move(surfaces.parts), volume);
    add_volume(zone, field, std::move(volume), std::move(points), std::move(values));
}

void Reader::add_structured(const CgnsZone& zone, Field& field) {
    const int dimension = file_.cell_dimension();
    if (dimension != 3 && dimension != 2) {
        file_.fail(zone, "structured zones of " + std::to_string(dimension) + " dimensions are not read");
    }
    auto points = file_.points(zone, options_.length_unit);
    auto values = file_.solutions(zone, options_, progress_, solutions_left_);
    ElementPart volume = cells_of_block(zone, dimension, progress_);
    std::vector<CgnsSurface> surfaces;
    const auto conditions = file_.conditions(zone);
    for (const auto& condition : conditions) {
        BlockFaces faces = faces_of_block(file_, zone, condition);
        if (!faces.told.empty()) {
            tell_of(field, zone, faces.surface.part.name, condition, faces.told);
        }
        surfaces.push_back(std::move(faces.surface));
    }
    add_surfaces(field, zone, points, values, std::move(surfaces), volume);
    add_volume(zone, field, std::move(volume), std::move(points), std::move(values));
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
