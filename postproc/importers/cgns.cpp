// CGNS in ADF and HDF5: volumes, 2-D boundary sections, solutions at vertices and cells.
#include <vtkCellType.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <unordered_map>

#include "core/text.h"
#include "postproc/importers/cgns_file.h"
#include "postproc/importers/element_zone.h"
#include "postproc/importers/face_orientation.h"
#include "postproc/importers/hdf5_file.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/steps.h"
#include "postproc/importers/trial.h"
#include "postproc/importers/understood.h"

namespace underbody::postproc {

namespace {

class Reader {
public:
    Reader(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress)
        : file_(path), name_(path.string()), options_(options), progress_(progress) {}

    Field read();
    [[nodiscard]] std::string understood() const {
        return understood_.empty() ? "the file opens, no zone yet" : "zones " + understood_;
    }

private:
    bool is_shell();
    void add_notes(Field& field) const;
    void note_data_sets(const std::vector<CgnsCondition>& conditions) {
        for (const auto& condition : conditions) {
            if (condition.data_sets > 0) {
                with_data_.push_back(condition.name);
            }
        }
    }
    void add_unstructured(const CgnsZone& zone, Field& field);
    void add_structured(const CgnsZone& zone, Field& field);
    void add_surface(Field& field, const Buffer<double>& points, const std::vector<PartValues>& values,
                     ElementPart&& surface, const BoundaryFaces& volume);
    void add_volume(const CgnsZone& zone, Field& field, ElementPart&& volume, Buffer<double>&& points, std::vector<PartValues>&& values);
    [[nodiscard]] ElementPart volume_of(const CgnsZone& zone, const std::vector<CgnsSection>& sections) const;
    [[nodiscard]] std::vector<ElementPart> surfaces_of(const std::vector<CgnsSection>& sections, const std::vector<CgnsCondition>& conditions,
                                                       const ElementPart& volume) const;
    void add_polyhedra(const CgnsZone& zone, ElementPart& volume, const CgnsSection& cells,
                       const std::map<std::int64_t, const CgnsSection*>& faces) const;
    [[nodiscard]] ElementPart face_of_block(const CgnsZone& zone, const CgnsCondition& condition) const;

    CgnsFile file_;
    std::string name_;
    const ReadOptions& options_;
    core::Progress& progress_;
    std::string understood_;
    bool shell_ = false;       ///< its cells are faces in space
    int solutions_left_ = 0;   ///< of other steps
    std::vector<std::string> with_data_;  ///< boundaries with values of their own, which are not read
};

Field Reader::read() {
    Field field;
    field.format = "CGNS";
    field.files = {name_};
    field.dimension = file_.cell_dimension() == 2 && file_.physical_dimension() == 2 ? 2 : 3;
    if (file_.units_stated()) {
        field.metadata.emplace_back("length unit", core::format_number(file_.base_length()) + " m");
    }
    shell_ = is_shell();
    if (const auto& times = file_.times(); !times.empty()) {
        const std::size_t step = options_.time ? step_at(times, *options_.time, name_) : times.size() - 1;
        file_.choose_step(step);
        field.metadata.emplace_back("time", core::format_number(times[step]));
        field.metadata.emplace_back("times", std::to_string(times.size()) + " from " + core::format_number(times.front()) + " to " + core::format_number(times.back()));
    }
    for (int index = 1; index <= file_.zones(); ++index) {
        progress_.check();
        progress_.report(static_cast<double>(index - 1) / file_.zones(), "reading zone " + std::to_string(index));
        const CgnsZone zone = file_.zone(index);
        zone.structured ? add_structured(zone, field) : add_unstructured(zone, field);
        understood_ += (understood_.empty() ? "" : ", ") + zone.name;
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
    for (int index = 1; index <= file_.zones(); ++index) {
        const auto points = file_.points(file_.zone(index));
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
    const auto add = [&](core::Problem::Severity severity, const std::string& text) { field.problems.push_back({severity, text, {name_, {}, {}, {}}}); };
    if (file_.newer_version() > 0) {
        add(core::Problem::Severity::note, "written by CGNS " + core::format_number(file_.newer_version(), 3) + ", later than the library that reads it");
    }
    if (solutions_left_ > 0 && !options_.time) {
        add(core::Problem::Severity::note, "of several solutions in time the last is read");
    }
    if (!with_data_.empty()) {
        add(core::Problem::Severity::warning, "values that boundaries hold for themselves (BCDataSet) are not read: " + listed(with_data_));
    }
    if (file_.bases() > 1) {
        add(core::Problem::Severity::note, "the last of " + std::to_string(file_.bases()) + " bases is read");
    }
    if (const std::string data = file_.dimensionless_class(); !data.empty()) {
        add(core::Problem::Severity::warning, "the file says that its values have no dimensions (" + data +
                                                  "): they are taken as they stand, so that lengths and forces are not SI");
    }
    for (const auto& [variable, unit] : file_.converted()) {
        add(core::Problem::Severity::note, variable + " stands in the units that the file states: 1 there is " + unit);
    }
    if (!file_.units_stated()) {
        add(core::Problem::Severity::note, "the file states no units; SI is taken");
    }
}

void Reader::add_polyhedra(const CgnsZone& zone, ElementPart& volume, const CgnsSection& cells,
                           const std::map<std::int64_t, const CgnsSection*>& faces) const {
    for (const auto& cell : cells.elements) {
        std::vector<std::int64_t> corners;
        volume.polyhedra.push_back(static_cast<std::int64_t>(cell.count));
        for (std::size_t k = 0; k < cell.count; ++k) {
            const std::int64_t signed_face = cells.nodes[cell.first + k];
            const std::int64_t number = std::abs(signed_face);
            auto found = faces.upper_bound(number);
            if (found == faces.begin() || number < 1) {
                file_.fail(zone, "a cell names face " + std::to_string(number) + ", which is not there");
            }
            const CgnsSection& polygons = *std::prev(found)->second;
            const auto place = static_cast<std::size_t>(number - polygons.first);
            if (place >= polygons.elements.size()) {
                file_.fail(zone, "a cell names face " + std::to_string(number) + ", which is not there");
            }
            const CgnsSection::Element& face = polygons.elements[place];
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

ElementPart Reader::volume_of(const CgnsZone& zone, const std::vector<CgnsSection>& sections) const {
    ElementPart volume;
    std::map<std::int64_t, const CgnsSection*> faces;  // by their first number
    for (const auto& section : sections) {
        if (section.polygons) {
            faces[section.first] = &section;
        }
    }
    for (const auto& section : sections) {
        if (section.polyhedra) {
            add_polyhedra(zone, volume, section, faces);
        } else if (section.dimension() == file_.cell_dimension() && !(section.polygons && file_.cell_dimension() == 3)) {
            for (const auto& element : section.elements) {
                volume.add(element.type, section.nodes.data() + element.first, element.count);
            }
        }
    }
    return volume;
}

/// Where the pressure lies in the cells alone, a surface takes that of those behind its faces; its own nodes know
/// better.
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
    Zone zone = zone_from(std::move(surface), std::move(own), shell_ ? 3 : file_.cell_dimension(), options_, name_, field.problems);
    zone.normals_into_fluid = settled;
    for (auto& info : zone.arrays) {
        info.on = of_cells && info.on == Location::faces ? Location::cells : info.on;
    }
    field.zones.push_back(std::move(zone));
}

/// Boundary conditions with the elements they name, then sections of faces that none of them names.
std::vector<ElementPart> Reader::surfaces_of(const std::vector<CgnsSection>& sections, const std::vector<CgnsCondition>& conditions,
                                             const ElementPart& volume) const {
    const int dimension = file_.cell_dimension();
    std::vector<ElementPart> surfaces;
    std::vector<bool> shown(sections.size());
    for (const auto& condition : conditions) {
        ElementPart part;
        part.name = condition.name;
        part.kind = condition.kind;
        part.original_kind = condition.type;
        for (const std::int64_t number : condition.elements) {
            for (std::size_t s = 0; s < sections.size(); ++s) {
                const CgnsSection& section = sections[s];
                if (number >= section.first && number <= section.last && !section.polyhedra &&
                    section.dimension() < dimension + (section.polygons ? 1 : 0)) {
                    const auto& element = section.elements[static_cast<std::size_t>(number - section.first)];
                    part.add(element.type, section.nodes.data() + element.first, element.count);
                    shown[s] = true;
                }
            }
        }
        surfaces.push_back(std::move(part));
    }
    for (std::size_t s = 0; s < sections.size(); ++s) {
        const CgnsSection& section = sections[s];
        // Polygons without a condition are the faces of the polyhedra.
        const bool of_polyhedra = section.polygons && dimension == 3 && !volume.polyhedra.empty();
        if (shown[s] || section.polyhedra || of_polyhedra || section.dimension() != dimension - 1) {
            continue;
        }
        ElementPart part;
        part.name = section.name;
        for (const auto& condition : conditions) {
            if (condition.name == part.name) {
                part.kind = condition.kind;
                part.original_kind = condition.type;
            }
        }
        for (const auto& element : section.elements) {
            part.add(element.type, section.nodes.data() + element.first, element.count);
        }
        surfaces.push_back(std::move(part));
    }
    return surfaces;
}

void Reader::add_volume(const CgnsZone& zone, Field& field, ElementPart&& volume, Buffer<double>&& points, std::vector<PartValues>&& values) {
    if (volume.elements() == 0 || (options_.surfaces_only && !shell_) || !matches_any(options_.zones, zone.name)) {
        return;
    }
    volume.name = zone.name;
    volume.kind = shell_ ? ZoneKind::unknown : ZoneKind::fluid;
    volume.points = std::move(points);
    const std::int64_t turned = zone.structured ? 0 : turn_inverted_cells(volume);
    if (turned > 0) {
        field.metadata.emplace_back("cells turned to VTK's order in " + zone.name, std::to_string(turned));
    }
    field.zones.push_back(
        zone_from(std::move(volume), std::move(values), shell_ ? 3 : file_.cell_dimension(), options_, name_, field.problems));
}

void Reader::add_unstructured(const CgnsZone& zone, Field& field) {
    auto points = file_.points(zone);
    auto values = file_.solutions(zone, options_, progress_, solutions_left_);
    const auto sections = file_.sections(zone, progress_);
    ElementPart volume = volume_of(zone, sections);
    if (static_cast<std::int64_t>(volume.elements()) != zone.cells[0]) {
        field.problems.push_back({core::Problem::Severity::warning,
                                  "zone '" + zone.name + "': it declares " + std::to_string(zone.cells[0]) +
                                      " cells, its sections hold " + std::to_string(volume.elements()),
                                  {name_, {}, {}, {}}});
        std::erase_if(values, [](const PartValues& v) { return !v.on_nodes; });
    }
    const auto conditions = file_.conditions(zone);
    note_data_sets(conditions);
    std::vector<ElementPart> surfaces = surfaces_of(sections, conditions, volume);
    const BoundaryFaces faces(surfaces, volume);
    for (auto& surface : surfaces) {
        add_surface(field, points, values, std::move(surface), faces);
    }
    add_volume(zone, field, std::move(volume), std::move(points), std::move(values));
}

/// The cells of a block, or of a plane one.
ElementPart cells_of_block(const CgnsZone& zone, int dimension, core::Progress& progress) {
    const std::int64_t ni = zone.nodes[0];
    const std::int64_t nj = zone.nodes[1];
    const std::int64_t nk = zone.nodes[2];
    const auto node = [&](std::int64_t i, std::int64_t j, std::int64_t k) { return (k * nj + j) * ni + i; };
    ElementPart volume;
    const std::int64_t layers = dimension == 3 ? nk - 1 : 1;
    for (std::int64_t k = 0; k < layers; ++k) {
        progress.check();
        for (std::int64_t j = 0; j + 1 < nj; ++j) {
            for (std::int64_t i = 0; i + 1 < ni; ++i) {
                std::array<std::int64_t, 8> n = {
                    node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k), 0, 0, 0, 0};
                for (std::size_t c = 0; c < 4; ++c) {
                    n[c + 4] = n[c] + ni * nj;
                }
                dimension == 3 ? volume.add(VTK_HEXAHEDRON, n.data(), 8) : volume.add(VTK_QUAD, n.data(), 4);
            }
        }
    }
    return volume;
}

/// The side of a block that a condition names; nothing if its range is none.
ElementPart Reader::face_of_block(const CgnsZone& zone, const CgnsCondition& condition) const {
    ElementPart part;
    part.name = zone.name + "/" + condition.name;
    part.kind = condition.kind;
    part.original_kind = condition.type;
    std::array<std::int64_t, 3> low{};
    std::array<std::int64_t, 3> high{};
    int flat = -1;
    for (std::size_t d = 0; d < 3; ++d) {
        low[d] = std::min(condition.range[d], condition.range[d + 3]) - 1;
        high[d] = std::max(condition.range[d], condition.range[d + 3]) - 1;
        if (low[d] < 0 || high[d] >= zone.nodes[d]) {
            file_.fail(zone, "condition '" + condition.name + "' lies outside the zone");
        }
        flat = low[d] == high[d] ? static_cast<int>(d) : flat;
    }
    if (flat < 0) {
        return part;
    }
    const auto a = static_cast<std::size_t>((flat + 1) % 3);
    const auto b = static_cast<std::size_t>((flat + 2) % 3);
    for (std::int64_t v = low[b]; v < high[b]; ++v) {
        for (std::int64_t u = low[a]; u < high[a]; ++u) {
            std::array<std::int64_t, 4> quad{};
            const std::array<std::pair<int, int>, 4> steps = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
            for (std::size_t c = 0; c < 4; ++c) {
                std::array<std::int64_t, 3> at = low;
                at[a] = u + steps[c].first;
                at[b] = v + steps[c].second;
                quad[c] = (at[2] * zone.nodes[1] + at[1]) * zone.nodes[0] + at[0];
            }
            part.add(VTK_QUAD, quad.data(), 4);
        }
    }
    return part;
}

void Reader::add_structured(const CgnsZone& zone, Field& field) {
    const int dimension = file_.cell_dimension();
    if (dimension != 3 && dimension != 2) {
        file_.fail(zone, "structured zones of " + std::to_string(dimension) + " dimensions are not read");
    }
    auto points = file_.points(zone);
    auto values = file_.solutions(zone, options_, progress_, solutions_left_);
    ElementPart volume = cells_of_block(zone, dimension, progress_);
    std::vector<ElementPart> surfaces;
    const auto conditions = file_.conditions(zone);
    note_data_sets(conditions);
    for (const auto& condition : conditions) {
        if (condition.range.size() == 6 && dimension == 3) {
            surfaces.push_back(face_of_block(zone, condition));
        }
    }
    const BoundaryFaces faces(surfaces, volume);
    for (auto& surface : surfaces) {
        add_surface(field, points, values, std::move(surface), faces);
    }
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
