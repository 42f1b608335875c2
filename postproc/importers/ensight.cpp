// EnSight Gold as Fluent, CFX and OpenFOAM write it. Read by ourselves: VTK's reader crashes on a truncated geometry.
#include <vtkCellType.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "core/text.h"
#include "postproc/importers/element_zone.h"
#include "postproc/importers/ensight_case.h"
#include "postproc/importers/ensight_input.h"
#include "postproc/importers/importer.h"

namespace underbody::postproc {

namespace {

struct Kind {
    const char* name;
    unsigned char type;
    int nodes;
};

constexpr std::array kinds = {Kind{"point", VTK_VERTEX, 1},
                              Kind{"bar2", VTK_LINE, 2},
                              Kind{"bar3", VTK_QUADRATIC_EDGE, 3},
                              Kind{"tria3", VTK_TRIANGLE, 3},
                              Kind{"tria6", VTK_QUADRATIC_TRIANGLE, 6},
                              Kind{"quad4", VTK_QUAD, 4},
                              Kind{"quad8", VTK_QUADRATIC_QUAD, 8},
                              Kind{"tetra4", VTK_TETRA, 4},
                              Kind{"tetra10", VTK_QUADRATIC_TETRA, 10},
                              Kind{"pyramid5", VTK_PYRAMID, 5},
                              Kind{"pyramid13", VTK_QUADRATIC_PYRAMID, 13},
                              Kind{"penta6", VTK_WEDGE, 6},
                              Kind{"penta15", VTK_QUADRATIC_WEDGE, 15},
                              Kind{"hexa8", VTK_HEXAHEDRON, 8},
                              Kind{"hexa20", VTK_QUADRATIC_HEXAHEDRON, 20},
                              Kind{"nsided", VTK_POLYGON, 0},
                              Kind{"nfaced", VTK_POLYHEDRON, 0}};

const Kind* find_kind(const std::string& name) {
    for (const auto& kind : kinds) {
        if (name == kind.name) {
            return &kind;
        }
    }
    return nullptr;
}

/// A run of elements of one kind within a part, in the order of the file. Ghosts are passed over.
struct Run {
    std::string kind;
    std::size_t first = 0;
    std::size_t count = 0;
    bool ghost = false;
};

struct Part {
    ElementPart elements;
    std::vector<Run> runs;
};

std::string first_word(const std::string& line) { return line.substr(0, line.find_first_of(" \t")); }

class Geometry {
public:
    Geometry(const std::filesystem::path& path, core::Progress& progress)
        : coding_(EnsightInput::coding_of(path)), in_(path, coding_, false), progress_(progress) {}

    void read();

    std::string description;
    std::map<std::int64_t, Part> parts;
    [[nodiscard]] EnsightCoding coding() const { return coding_; }
    [[nodiscard]] bool swapped() const { return in_.swapped(); }

private:
    void part(std::int64_t number);
    void elements(Part& part, const Kind& kind, bool ghost);
    void polygons(Part& part, std::uint64_t count, bool ghost);
    void polyhedra(Part& part, std::uint64_t count, bool ghost);
    void check_nodes(std::vector<std::int64_t>& nodes, const ElementPart& part);

    EnsightCoding coding_;
    EnsightInput in_;
    core::Progress& progress_;
    bool node_ids_ = false;
    bool element_ids_ = false;
    std::string pending_;  ///< a line that the part before did not want
};

void Geometry::read() {
    if (coding_ != EnsightCoding::text) {
        in_.line();
    }
    description = in_.line();
    const std::string second = in_.line();
    description += second.empty() ? "" : "; " + second;
    for (auto* ids : {&node_ids_, &element_ids_}) {
        const std::string line = core::lower_case(in_.line());
        if (line.find(" id") == std::string::npos) {
            in_.fail("expected 'node id' or 'element id', found '" + line.substr(0, 40) + "'");
        }
        *ids = line.find("given") != std::string::npos || line.find("ignore") != std::string::npos;
    }
    std::string line = in_.line();
    if (core::lower_case(line).starts_with("extents")) {
        std::array<double, 6> extents{};
        in_.reals(extents.data(), 6);
        line = in_.line();
    }
    while (true) {
        progress_.check();
        if (core::lower_case(first_word(line)) != "part") {
            in_.fail("expected 'part', found '" + line.substr(0, 40) + "'");
        }
        const std::int64_t number = in_.part_number(parts.empty());
        if (parts.contains(number)) {
            in_.fail("part " + std::to_string(number) + " is there twice");
        }
        pending_.clear();
        part(number);
        if (pending_.empty()) {
            return;
        }
        line = pending_;
    }
}

void Geometry::part(std::int64_t number) {
    Part& part = parts[number];
    part.elements.id = static_cast<int>(number);
    part.elements.name = in_.line();
    const std::string what = core::lower_case(in_.line());
    if (what.starts_with("block")) {
        in_.fail("part '" + part.elements.name + "' is a structured block; these are not read");
    }
    if (first_word(what) != "coordinates") {
        in_.fail("expected 'coordinates', found '" + what.substr(0, 40) + "'");
    }
    const std::uint64_t nodes = in_.count("nodes");
    in_.check_room(3 * nodes, "coordinates");
    std::vector<std::int64_t> ids;
    if (node_ids_) {
        in_.integers(ids, nodes);
    }
    part.elements.points.grow_to(3 * nodes);
    Buffer<double> column(nodes);
    for (std::size_t k = 0; k < 3; ++k) {
        in_.reals(column.data(), nodes);
        for (std::size_t i = 0; i < nodes; ++i) {
            if (!std::isfinite(column[i])) {
                in_.fail("part '" + part.elements.name + "' has a coordinate that is not a number");
            }
            part.elements.points[3 * i + k] = column[i];
        }
    }
    while (!in_.at_end()) {
        progress_.check();
        const std::string line = in_.line();
        std::string name = core::lower_case(first_word(line));
        if (name == "part") {
            pending_ = line;
            return;
        }
        const bool ghost = name.starts_with("g_");
        name = ghost ? name.substr(2) : name;
        const Kind* kind = find_kind(name);
        if (kind == nullptr) {
            in_.fail("elements of unknown kind '" + line.substr(0, 40) + "' in part '" + part.elements.name + "'");
        }
        elements(part, *kind, ghost);
    }
}

void Geometry::check_nodes(std::vector<std::int64_t>& nodes, const ElementPart& part) {
    const auto most = static_cast<std::int64_t>(part.points.size() / 3);
    for (auto& node : nodes) {
        if (node < 1 || node > most) {
            in_.fail("an element of part '" + part.name + "' names node " + std::to_string(node) + " of " +
                     std::to_string(most));
        }
        --node;
    }
}

void Geometry::elements(Part& part, const Kind& kind, bool ghost) {
    const std::uint64_t count = in_.count("elements");
    std::vector<std::int64_t> ids;
    if (element_ids_) {
        in_.integers(ids, count);
    }
    part.runs.push_back({kind.name, part.elements.elements(), count, ghost});
    if (kind.type == VTK_POLYGON) {
        return polygons(part, count, ghost);
    }
    if (kind.type == VTK_POLYHEDRON) {
        return polyhedra(part, count, ghost);
    }
    in_.check_room(count * static_cast<std::uint64_t>(kind.nodes), "corners");
    std::vector<std::int64_t> nodes;
    in_.integers(nodes, count * static_cast<std::uint64_t>(kind.nodes));
    check_nodes(nodes, part.elements);
    for (std::size_t i = 0; i < count && !ghost; ++i) {
        part.elements.add(kind.type, nodes.data() + i * static_cast<std::size_t>(kind.nodes),
                          static_cast<std::size_t>(kind.nodes));
    }
}

std::uint64_t total(const std::vector<std::int64_t>& sizes, EnsightInput& in) {
    std::uint64_t sum = 0;
    for (const std::int64_t size : sizes) {
        if (size < 1) {
            in.fail("an element with " + std::to_string(size) + " corners or faces");
        }
        sum += static_cast<std::uint64_t>(size);
    }
    return sum;
}

void Geometry::polygons(Part& part, std::uint64_t count, bool ghost) {
    std::vector<std::int64_t> sizes;
    std::vector<std::int64_t> nodes;
    in_.integers(sizes, count);
    in_.integers(nodes, total(sizes, in_));
    check_nodes(nodes, part.elements);
    std::size_t at = 0;
    for (const std::int64_t size : sizes) {
        if (!ghost) {
            part.elements.add(VTK_POLYGON, nodes.data() + at, static_cast<std::size_t>(size));
        }
        at += static_cast<std::size_t>(size);
    }
}

void Geometry::polyhedra(Part& part, std::uint64_t count, bool ghost) {
    std::vector<std::int64_t> faces;
    std::vector<std::int64_t> sizes;
    std::vector<std::int64_t> nodes;
    in_.integers(faces, count);
    in_.integers(sizes, total(faces, in_));
    in_.integers(nodes, total(sizes, in_));
    check_nodes(nodes, part.elements);
    std::size_t face = 0;
    std::size_t at = 0;
    for (const std::int64_t number : faces) {
        std::vector<std::int64_t> corners;
        std::vector<std::int64_t> stream = {number};
        for (std::int64_t f = 0; f < number; ++f, ++face) {
            stream.push_back(sizes[face]);
            for (std::int64_t k = 0; k < sizes[face]; ++k, ++at) {
                stream.push_back(nodes[at]);
                corners.push_back(nodes[at]);
            }
        }
        if (ghost) {
            continue;
        }
        std::sort(corners.begin(), corners.end());
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        part.elements.add(VTK_POLYHEDRON, corners.data(), corners.size());
        part.elements.polyhedra.insert(part.elements.polyhedra.end(), stream.begin(), stream.end());
    }
}

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Reads one variable file and gives each part its values.
class Values {
public:
    Values(const EnsightVariable& variable, Geometry& geometry, std::map<std::int64_t, std::vector<PartValues>>& out)
        : variable_(variable),
          geometry_(geometry),
          in_(variable.file, geometry.coding(), geometry.swapped()),
          out_(out) {}
    void read();
    /// Parts that got no values, by name.
    [[nodiscard]] std::string without() const;

private:
    void section(const std::string& line, const Part& part, PartValues& values);
    void place(PartValues& values, std::size_t first, std::size_t count, bool keep, const std::string& line);

    const EnsightVariable& variable_;
    Geometry& geometry_;
    EnsightInput in_;
    std::map<std::int64_t, std::vector<PartValues>>& out_;
};

void Values::read() {
    in_.line();
    const Part* part = nullptr;
    PartValues* values = nullptr;
    while (!in_.at_end()) {
        const std::string line = in_.line();
        const std::string word = core::lower_case(first_word(line));
        if (word == "part") {
            const std::int64_t number = in_.part_number(false);
            const auto found = geometry_.parts.find(number);
            if (found == geometry_.parts.end()) {
                in_.fail("values for part " + std::to_string(number) + ", which the geometry does not have");
            }
            part = &found->second;
            const std::size_t items = variable_.on_nodes ? part->elements.points.size() / 3 : part->elements.elements();
            PartValues fresh{variable_.name, variable_.on_nodes, variable_.components, {}};
            fresh.values.grow_to(items * static_cast<std::size_t>(variable_.components));
            fresh.values.fill(missing);
            auto& list = out_[number];
            list.push_back(std::move(fresh));
            values = &list.back();
            continue;
        }
        if (part == nullptr) {
            in_.fail("expected 'part', found '" + line.substr(0, 40) + "'");
        }
        section(line, *part, *values);
    }
}

std::string Values::without() const {
    std::string names;
    for (const auto& [number, part] : geometry_.parts) {
        const auto found = out_.find(number);
        const bool has =
            found != out_.end() && std::any_of(found->second.begin(), found->second.end(),
                                               [&](const PartValues& v) { return v.variable == variable_.name; });
        names += has ? "" : (names.empty() ? "" : ", ") + part.elements.name;
    }
    return names;
}

void Values::section(const std::string& line, const Part& part, PartValues& values) {
    const std::string word = core::lower_case(first_word(line));
    if (variable_.on_nodes) {
        if (word != "coordinates") {
            in_.fail("expected 'coordinates', found '" + line.substr(0, 40) + "'");
        }
        place(values, 0, part.elements.points.size() / 3, true, line);
        return;
    }
    const bool ghost = word.starts_with("g_");
    for (const Run& run : part.runs) {
        if (run.kind == (ghost ? word.substr(2) : word) && run.ghost == ghost) {
            place(values, run.first, run.count, !ghost, line);
            return;
        }
    }
    in_.fail("values for elements '" + line.substr(0, 40) + "', which part '" + part.elements.name + "' does not have");
}

void Values::place(PartValues& values, std::size_t first, std::size_t count, bool keep, const std::string& line) {
    const std::string lower = core::lower_case(line);
    double undefined = missing;
    if (lower.find("undef") != std::string::npos) {
        in_.reals(&undefined, 1);
    }
    std::vector<std::int64_t> places;
    const bool partial = lower.find("partial") != std::string::npos;
    if (partial) {
        in_.integers(places, in_.count("values"));
        for (const std::int64_t p : places) {
            if (p < 1 || p > static_cast<std::int64_t>(count)) {
                in_.fail("a value for place " + std::to_string(p) + " of " + std::to_string(count));
            }
        }
    }
    const std::size_t stored = partial ? places.size() : count;
    const auto n = static_cast<std::size_t>(variable_.components);
    Buffer<double> column(stored);
    for (std::size_t k = 0; k < n; ++k) {
        in_.reals(column.data(), stored);
        for (std::size_t i = 0; i < stored && keep; ++i) {
            const std::size_t at = first + (partial ? static_cast<std::size_t>(places[i] - 1) : i);
            values.values[at * n + k] = column[i] == undefined ? missing : column[i];
        }
    }
}

/// 2-D cases have no cells but elements in one plane, and lines for boundaries.
int volume_dimension(const Geometry& geometry) {
    int highest = 0;
    bool plane = true;
    for (const auto& [number, part] : geometry.parts) {
        highest = std::max(highest, part.elements.dimension());
        for (std::size_t i = 2; i < part.elements.points.size() && plane; i += 3) {
            plane = part.elements.points[i] == 0;
        }
    }
    return highest == 2 && plane ? 2 : 3;
}

bool recognises(std::string_view head, const std::filesystem::path& /*path*/) { return is_ensight_case(head); }

/// A geometry that ends before its elements looks whole: nodes that belong to none give it away.
void mind_unused_nodes(const ElementPart& part, const std::filesystem::path& file, core::Problems& problems) {
    std::vector<bool> used(part.points.size() / 3);
    for (const std::int64_t node : part.nodes) {
        used[static_cast<std::size_t>(node)] = true;
    }
    const auto unused = std::count(used.begin(), used.end(), false);
    if (unused > 0 || part.elements() == 0) {
        problems.push_back({core::Problem::Severity::warning,
                            std::to_string(unused) + " nodes of part " + part.name +
                                " belong to no element: is the geometry cut short?",
                            {file.string(), {}, {}, {}}});
    }
}

/// OpenFOAM writes p over density in incompressible cases and pressure in compressible ones, both as "p".
void mind_openfoam(const Geometry& geometry, const ReadOptions& options, std::vector<EnsightVariable>& variables,
                   Field& field) {
    if (geometry.description.find("OpenFOAM") == std::string::npos) {
        return;
    }
    field.writer = geometry.description;
    for (auto& variable : variables) {
        const bool stated =
            std::any_of(options.units.begin(), options.units.end(), [](const auto& unit) { return unit.first == "p"; });
        if (variable.name == "p" && !stated) {
            variable.name = "p (unit not stated)";
            field.problems.push_back(
                {core::Problem::Severity::warning,
                 "OpenFOAM's p is pressure [Pa] or pressure over density [m^2/s^2]; the file does not say which. "
                 "State the unit of 'p' to use it",
                 {variable.file.string(), {}, {}, {}}});
        }
    }
}

Field read(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress) {
    EnsightCase files = read_ensight_case(path);
    Field field;
    field.format = "EnSight Gold";
    field.files = {path.string(), files.geometry.string()};
    field.problems = files.problems;
    std::error_code error;
    if (!std::filesystem::is_regular_file(files.geometry, error)) {
        throw core::InputError("missing",
                               "the geometry '" + files.geometry.filename().string() + "' of this case is not there",
                               {path.string(), {}, {}, {}});
    }
    progress.report(0.1, "reading " + files.geometry.filename().string());
    Geometry geometry(files.geometry, progress);
    geometry.read();
    field.writer = geometry.description;
    field.dimension = volume_dimension(geometry);
    mind_openfoam(geometry, options, files.variables, field);
    std::map<std::int64_t, std::vector<PartValues>> values;
    for (const auto& variable : files.variables) {
        progress.check();
        const CanonicalName canonical = canonical_name(variable.name);
        if (!options.arrays.empty() && !matches_any(options.arrays, variable.name) &&
            !matches_any(options.arrays, canonical.name)) {
            continue;
        }
        if (!std::filesystem::is_regular_file(variable.file, error)) {
            field.problems.push_back({core::Problem::Severity::warning,
                                      "the file of variable '" + variable.name + "' is not there",
                                      {variable.file.string(), {}, {}, {}}});
            continue;
        }
        Values reader(variable, geometry, values);
        reader.read();
        if (const std::string names = reader.without(); !names.empty()) {
            field.problems.push_back({core::Problem::Severity::note,
                                      "'" + variable.name + "' has no values on " + names +
                                          " (unless it lives on some parts only, the file is cut short)",
                                      {variable.file.string(), {}, {}, {}}});
        }
        field.files.push_back(variable.file.string());
    }
    for (const auto& [name, value] : files.constants) {
        field.metadata.emplace_back(name, value);
    }
    if (!files.time.empty()) {
        field.metadata.emplace_back("time", files.time);
    }
    if (files.steps > 1) {
        field.problems.push_back({core::Problem::Severity::note,
                                  "the last of " + std::to_string(files.steps) + " time steps is read",
                                  {path.string(), {}, {}, {}}});
    }
    std::vector<ElementPart> parts;
    for (auto& [number, part] : geometry.parts) {
        mind_unused_nodes(part.elements, files.geometry, field.problems);
        parts.push_back(std::move(part.elements));
    }
    scale_parts(parts, options, field);
    for (auto& part : parts) {
        const bool volume = part.dimension() == field.dimension;
        if (!matches_any(options.zones, part.name) || (volume && options.surfaces_only)) {
            continue;
        }
        auto& own = values[part.id];
        field.zones.push_back(
            zone_from(std::move(part), std::move(own), field.dimension, options, path.string(), field.problems));
    }
    return field;
}

}  // namespace

Importer ensight_importer() { return {"EnSight Gold", recognises, read}; }

}  // namespace underbody::postproc
