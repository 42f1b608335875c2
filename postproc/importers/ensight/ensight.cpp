// EnSight Gold as Fluent, CFX and OpenFOAM write it. Read by ourselves: VTK's reader crashes on a truncated geometry.
#include <algorithm>
#include <limits>
#include <map>
#include <memory>

#include "core/counted.h"
#include "core/inputs.h"
#include "core/text.h"
#include "postproc/field/times.h"
#include "postproc/importers/ensight/ensight_case.h"
#include "postproc/importers/ensight/ensight_geometry.h"
#include "postproc/importers/import_context.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/mesh/array_names.h"
#include "postproc/importers/mesh/element_zone.h"
#include "postproc/importers/mesh/face_orientation.h"
#include "postproc/importers/mesh/variable_reading.h"

namespace underbody::postproc {

namespace {

std::string first_word(const std::string& line) { return line.substr(0, line.find_first_of(" \t")); }

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Reads one variable file and gives each part its values.
class Values {
public:
    Values(const EnsightVariable& variable, EnsightGeometry& geometry,
           std::map<std::int64_t, std::vector<PartValues>>& out)
        : variable_(variable),
          geometry_(geometry),
          in_(variable.file.path, geometry.coding(), geometry.swapped()),
          out_(out) {}
    void read();
    /// Parts that got no values, by name.
    [[nodiscard]] std::string without() const;

private:
    void section(const std::string& line, const EnsightPart& part, PartValues& values);
    /// `count` values into `values` from `first` on; of a block only the `kept` ones, if these are named.
    void place(PartValues& values, std::size_t first, std::size_t count, bool keep, const std::string& line,
               const std::vector<std::size_t>* kept = nullptr);

    const EnsightVariable& variable_;
    EnsightGeometry& geometry_;
    EnsightInput in_;
    std::map<std::int64_t, std::vector<PartValues>>& out_;
};

void Values::read() {
    if (variable_.file.step >= 0) {
        in_.to_step(variable_.file.step);
    }
    in_.line_as_it_is();
    const EnsightPart* part = nullptr;
    PartValues* values = nullptr;
    while (!in_.at_end()) {
        const std::string line = in_.line();
        const std::string word = core::lower_case(first_word(line));
        if (core::lower_case(line).starts_with("end time step")) {
            return;
        }
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

void Values::section(const std::string& line, const EnsightPart& part, PartValues& values) {
    const std::string word = core::lower_case(first_word(line));
    if (part.block) {
        if (word != "block") {
            in_.fail("expected 'block', found '" + line.substr(0, 40) + "'");
        }
        const std::size_t nodes = part.elements.points.size() / 3;
        place(values, 0, variable_.on_nodes ? nodes : part.block_elements, true, line,
              variable_.on_nodes ? nullptr : &part.kept);
        return;
    }
    if (variable_.on_nodes) {
        if (word != "coordinates") {
            in_.fail("expected 'coordinates', found '" + line.substr(0, 40) + "'");
        }
        place(values, 0, part.elements.points.size() / 3, true, line);
        return;
    }
    const bool ghost = word.starts_with("g_");
    for (const EnsightRun& run : part.runs) {
        if (run.kind == (ghost ? word.substr(2) : word) && run.ghost == ghost) {
            place(values, run.first, run.count, !ghost, line);
            return;
        }
    }
    in_.fail("values for elements '" + line.substr(0, 40) + "', which part '" + part.elements.name + "' does not have");
}

void Values::place(PartValues& values, std::size_t first, std::size_t count, bool keep, const std::string& line,
                   const std::vector<std::size_t>* kept) {
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
    // Where a value of the file goes; nowhere for cells that are left out of a block.
    constexpr auto nowhere = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> moved;
    if (kept != nullptr && !kept->empty()) {
        moved.assign(count, nowhere);
        for (std::size_t i = 0; i < kept->size(); ++i) {
            moved[(*kept)[i]] = i;
        }
    } else if (kept != nullptr && count != values.values.size() / static_cast<std::size_t>(variable_.components)) {
        moved.assign(count, nowhere);  // all of them are left out
    }
    const auto n = static_cast<std::size_t>(variable_.components);
    Buffer<double> column(stored);
    // Symmetric tensors stand as xx yy zz xy xz yz; here, as in VTK, as xx yy zz xy yz xz.
    static constexpr std::array<std::size_t, 6> symmetric = {0, 1, 2, 3, 5, 4};
    for (std::size_t written = 0; written < n; ++written) {
        const std::size_t k = n == symmetric.size() ? symmetric[written] : written;
        in_.reals(column.data(), stored);
        for (std::size_t i = 0; i < stored && keep; ++i) {
            const std::size_t place = partial ? static_cast<std::size_t>(places[i] - 1) : i;
            const std::size_t at = moved.empty() ? first + place : moved[place];
            if (at != nowhere) {
                values.values[at * n + k] = column[i] == undefined ? missing : column[i];
            }
        }
    }
}

/// Do lines go round, so that they bound something?
bool goes_round(const ElementPart& part) {
    std::vector<int> lines_at(part.points.size() / 3);
    for (const std::int64_t node : part.nodes) {
        ++lines_at[static_cast<std::size_t>(node)];
    }
    return part.dimension() == 1 &&
           std::all_of(lines_at.begin(), lines_at.end(), [](int lines) { return lines == 2 || lines == 0; });
}

/// 2-D cases have no cells but elements in one plane, and lines for boundaries. These may be all that was exported:
/// then one of them has to go round, for lines through a flow lie in a plane too.
int volume_dimension(const EnsightGeometry& geometry) {
    int highest = 0;
    bool plane = true;
    bool round = false;
    for (const auto& [number, part] : geometry.parts) {
        highest = std::max(highest, part.elements.dimension());
        round = round || goes_round(part.elements);
        for (std::size_t i = 2; i < part.elements.points.size() && plane; i += 3) {
            plane = part.elements.points[i] == 0;
        }
    }
    return plane && (highest == 2 || (highest == 1 && round)) ? 2 : 3;
}

bool recognises(std::string_view head, const std::filesystem::path& /*path*/) { return is_ensight_case(head); }

/// A geometry that ends before its elements looks whole: nodes that belong to none give it away.
void mind_unused_nodes(const EnsightPart& whole, const std::string& file, core::Problems& problems) {
    const ElementPart& part = whole.elements;
    if (whole.block) {
        return;
    }
    std::vector<bool> used(part.points.size() / 3);
    for (const std::int64_t node : part.nodes) {
        used[static_cast<std::size_t>(node)] = true;
    }
    const auto unused = std::count(used.begin(), used.end(), false);
    if (unused > 0 || part.elements() == 0) {
        problems.push_back({core::Problem::Severity::warning,
                            core::counted(unused, "node") + " of part " + part.name +
                                (unused == 1 ? " belongs" : " belong") + " to no element: is the geometry cut short?",
                            {file, {}, {}, {}}});
    }
}

/// Variables whose meaning hangs on a unit that nobody states go by another name.
void ask_for_units(const ReadOptions& options, std::vector<EnsightVariable>& variables, Field& field) {
    for (auto& variable : variables) {
        if (unit_must_be_stated(variable.name, options)) {
            field.problems.push_back(unit_is_asked_for(variable.name, {variable.file.path.string(), {}, {}, {}}));
            variable.name = unstated_name(variable.name);
        }
    }
}

/// How many nodes the files of a case can have values for: a uniform block states them in nine numbers.
std::uint64_t most_nodes(const EnsightCase& files) {
    std::uint64_t bytes = std::uint64_t{1} << 18;
    std::error_code error;
    for (const auto& variable : files.variables) {
        const auto size = std::filesystem::file_size(variable.file.path, error);
        bytes += error ? 0 : size;
    }
    return bytes;
}

/// With coordinates that change under elements that do not, the elements stand in one step only.
void take_elements(EnsightGeometry& geometry, const EnsightFile& from, std::uint64_t most, core::Progress& progress) {
    EnsightGeometry base(from.path, from.step, most, progress);
    base.read();
    for (auto& [number, part] : geometry.parts) {
        const auto found = base.parts.find(number);
        if (part.elements.elements() > 0 || found == base.parts.end()) {
            continue;
        }
        if (found->second.elements.points.size() != part.elements.points.size()) {
            throw core::InputError(
                "format",
                "part " + part.elements.name + " has " + std::to_string(part.elements.points.size() / 3) +
                    " nodes, in the step with its elements " + std::to_string(found->second.elements.points.size() / 3),
                {from.path.string(), {}, {}, {}});
        }
        found->second.elements.points = std::move(part.elements.points);
        part = std::move(found->second);
    }
}

class Reader {
public:
    Reader(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress)
        : path_(path), options_(options), progress_(progress) {}

    Field read();
    [[nodiscard]] std::string understood() const {
        std::string text = geometry_ ? geometry_->understood() : "the case file";
        for (const auto& name : variables_) {
            text += (&name == &variables_.front() ? "; variables " : ", ") + name;
        }
        return text;
    }

private:
    void read_variable(const EnsightVariable& variable);
    void add_zones();
    std::vector<bool> turn_walls(std::vector<ElementPart>& parts);

    const std::filesystem::path& path_;
    const ReadOptions& options_;
    core::Progress& progress_;
    std::unique_ptr<EnsightGeometry> geometry_;
    std::vector<std::string> variables_;
    std::map<std::int64_t, std::vector<PartValues>> values_;
    Field field_;
};

void Reader::read_variable(const EnsightVariable& variable) {
    progress_.check();
    const CanonicalName canonical = canonical_name(variable.name);
    if (!is_wanted(options_, variable.name, canonical.name)) {
        return;
    }
    const core::Place place{variable.file.path.string(), {}, {}, {}};
    std::error_code error;
    core::note_presence(variable.file.path);
    if (!std::filesystem::is_regular_file(variable.file.path, error)) {
        field_.problems.push_back(
            {core::Problem::Severity::warning, "the file of variable '" + variable.name + "' is not there", place});
        return;
    }
    variables_.push_back(variable.name);
    Values reader(variable, *geometry_, values_);
    reader.read();
    if (const std::string names = reader.without(); !names.empty()) {
        field_.problems.push_back({core::Problem::Severity::note,
                                   "'" + variable.name + "' has no values on " + names +
                                       " (unless it lives on some parts only, the file is cut short)",
                                   place});
    }
    field_.files.push_back(variable.file.path.string());
}

void Reader::add_zones() {
    const auto is_line = [](const auto& part) { return part.second.elements.dimension() < 2; };
    if (field_.dimension == 2 && std::all_of(geometry_->parts.begin(), geometry_->parts.end(), is_line)) {
        field_.problems.push_back(
            {core::Problem::Severity::note,
             "there are lines in one plane alone: they are taken for the boundaries of a plane case",
             {path_.string(), {}, {}, {}}});
    }
    std::vector<ElementPart> parts;
    for (auto& [number, part] : geometry_->parts) {
        mind_unused_nodes(part, field_.files[1], field_.problems);
        parts.push_back(std::move(part.elements));
    }
    scale_parts(parts, options_, field_);
    const std::vector<bool> settled = turn_walls(parts);
    for (std::size_t p = 0; p < parts.size(); ++p) {
        auto& part = parts[p];
        const bool volume = part.dimension() == field_.dimension;
        if (!matches_any(options_.zones, part.name) || (volume && options_.surfaces_only)) {
            continue;
        }
        auto& own = values_[part.id];
        field_.zones.push_back(
            zone_from(std::move(part), std::move(own), field_.dimension, options_, path_.string(), field_.problems));
        field_.zones.back().normals_into_fluid = settled[p];
        for (auto& info : field_.zones.back().arrays) {
            info.original_name = name_in_file(info.original_name);
        }
    }
}

/// Where the volume is in the file too, its cells say on which side of a wall the fluid is. True for the parts that are
/// turned that way.
std::vector<bool> Reader::turn_walls(std::vector<ElementPart>& parts) {
    std::vector<ElementPart*> surfaces;
    std::vector<const ElementPart*> volumes;
    std::vector<std::size_t> places;
    for (std::size_t p = 0; p < parts.size() && field_.dimension == 3; ++p) {
        const int dimension = parts[p].dimension();
        if (dimension == 2 && matches_any(options_.zones, parts[p].name)) {
            surfaces.push_back(&parts[p]);
            places.push_back(p);
        } else if (dimension == 3) {
            volumes.push_back(&parts[p]);
        }
    }
    const auto turned = turn_into_one_volume(surfaces, volumes, progress_);
    std::vector<bool> settled(parts.size(), false);
    for (std::size_t s = 0; s < places.size(); ++s) {
        settled[places[s]] = turned[s];
    }
    return settled;
}

Field Reader::read() {
    EnsightCase files = read_ensight_case(path_, options_.time);
    field_.format = "EnSight Gold";
    field_.files = {path_.string(), files.geometry.path.string()};
    field_.problems = files.problems;
    std::error_code error;
    core::note_presence(files.geometry.path);
    if (!std::filesystem::is_regular_file(files.geometry.path, error)) {
        throw core::InputError(
            "missing", "the geometry '" + files.geometry.path.filename().string() + "' of this case is not there",
            {path_.string(), {}, {}, {}});
    }
    progress_.report(0.1, "reading " + files.geometry.path.filename().string());
    const std::uint64_t most = most_nodes(files);
    geometry_ = std::make_unique<EnsightGeometry>(files.geometry.path, files.geometry.step, most, progress_);
    geometry_->read();
    if (files.connectivity) {
        take_elements(*geometry_, *files.connectivity, most, progress_);
    }
    field_.writer = geometry_->description;
    field_.dimension = volume_dimension(*geometry_);
    ask_for_units(options_, files.variables, field_);
    for (const auto& variable : files.variables) {
        read_variable(variable);
    }
    for (const auto& [name, value] : files.constants) {
        field_.metadata.emplace_back(name, value);
    }
    if (files.time) {
        field_.metadata.emplace_back("time", core::format_number(*files.time));
    }
    if (files.steps > 1 && files.times.empty()) {
        field_.metadata.emplace_back("times", std::to_string(files.steps) + " steps");
    } else if (files.steps > 1) {
        state_times(field_, files.times);
    }
    if (files.steps > 1 && !options_.time) {
        field_.problems.push_back({core::Problem::Severity::note,
                                   "the last of " + std::to_string(files.steps) + " time steps is read",
                                   {path_.string(), {}, {}, {}}});
    }
    add_zones();
    return std::move(field_);
}

Field read(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress) {
    Reader reader(path, options, progress);
    return telling([&] { return reader.read(); }, [&] { return reader.understood(); });
}

}  // namespace

Importer ensight_importer() { return {"EnSight Gold", recognises, read}; }

}  // namespace underbody::postproc
