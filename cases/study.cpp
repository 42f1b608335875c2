#include "cases/study.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <unordered_map>

#include "cases/asked_points.h"
#include "cases/case_names.h"
#include "cases/design_points.h"
#include "cases/percent.h"
#include "cases/study_format.h"
#include "cases/sweep.h"
#include "cases/sweep_slurm.h"
#include "core/file.h"
#include "core/mistyped.h"
#include "core/name_pattern.h"
#include "core/text.h"
#include "core/toml.h"
#include "core/units.h"
#include "geometry/cases/flow_domain.h"
#include "postproc/importers/importer.h"
#include "postproc/loads/loads.h"
#include "postproc/loads/mirror_plane.h"

namespace underbody::cases {

namespace fs = std::filesystem;
using core::TomlTable;

namespace {

/// A number, or a text that is a number with or without a unit.
bool is_number_like(const TomlTable& table, const std::string& key) {
    if (!table.is_string(key)) {
        return table.is_number(key);
    }
    try {
        (void)core::parse_quantity(table.string(key));
        return true;
    } catch (const core::InputError&) {
        return false;
    }
}

/// `{ variant = "ellipse", gap = "5 mm" }`: known quantities with units, other words as they are.
Conditions read_conditions(const TomlTable& table) {
    Conditions conditions;
    for (const auto& key : table.keys()) {
        if (const auto unit = condition_unit(key)) {
            conditions.numbers.emplace_back(key, table.quantity(key, *unit));
        } else if (const std::string meant = core::mistyped_quantity(key);
                   !meant.empty() && is_number_like(table, key)) {
            throw core::InputError("name", "there is no condition '" + table.path_of(key) + "'", table.place(key),
                                   "did you mean '" + meant + "'?");
        } else if (table.is_string(key)) {
            conditions.texts.emplace_back(key, table.string(key));
        } else {
            conditions.numbers.emplace_back(key, table.quantity(key, "1"));
        }
    }
    return conditions;
}

/// The conditions under a key, as a table or as one text: `where = "variant=ellipse, gap=5mm"`, the way of the command
/// line.
Conditions read_where(const TomlTable& table, const char* key) {
    if (!table.is_string(key)) {
        return read_conditions(table.table_or_empty(key));
    }
    try {
        return conditions_from(table.string(key));
    } catch (const core::UsageError& error) {
        throw core::InputError(error.kind(), table.path_of(key) + ": " + error.message(), table.place(key),
                               error.hint());
    }
}

std::vector<core::NamePattern::Found> find_cases(const std::string& pattern, const fs::path& folder,
                                                 const TomlTable& table) {
    std::vector<core::NamePattern::Found> found;
    try {
        found = core::NamePattern(pattern).files_and_folders(folder);
    } catch (const core::UsageError& error) {
        throw core::InputError(error.kind(), error.message(), table.place("files"), error.hint());
    }
    std::string folders;
    std::erase_if(found, [&](const auto& item) {
        const bool other = item.folder && postproc::importer_for(item.path) == nullptr;
        folders += other && folders.size() < 200 ? (folders.empty() ? "" : ", ") + item.path.string() : "";
        return other;
    });
    if (found.empty()) {
        throw core::InputError("missing", "no file fits '" + pattern + "'", table.place("files"),
                               folders.empty() ? "the pattern is relative to " + folder.string()
                                               : "what fits is a folder, and no OpenFOAM case: " + folders);
    }
    return found;
}

/// The units that the numbers in file names are written in. Throws core::InputError for one of another dimension than
/// the condition has, here or (a word of the user's own) in a pattern before: `own`, by name.
std::map<std::string, std::string> units_of(const std::string& pattern, const TomlTable& table,
                                            std::map<std::string, std::string>& own) {
    std::map<std::string, std::string> units;
    const core::NamePattern parsed(pattern);
    for (const auto& part : parsed.parts()) {
        if (part.kind != core::NamePattern::Part::Kind::number) {
            continue;
        }
        const std::string before =
            condition_unit(part.value).value_or(own.emplace(part.value, part.unit).first->second);
        if (!core::same_dimension(part.unit, before)) {
            throw core::InputError("unit",
                                   "the condition '" + part.value + "' is in " + part.unit + " in '" + pattern +
                                       "', and in " + before + " elsewhere",
                                   table.place("files"), "give one of them another name");
        }
        units[part.value] = part.unit;
    }
    return units;
}

/// A unit under a key; empty: none. Throws core::InputError for what is none.
std::string unit_of_file(const TomlTable& table, const std::string& key, const char* of = nullptr) {
    const std::string unit = table.string_or(key, "");
    if (!unit.empty() && !(core::is_unit(unit) && (of == nullptr || core::same_dimension(unit, of)))) {
        throw core::InputError("unit", table.path_of(key) + ": '" + unit + "' is no unit" + (of ? " of a length" : ""),
                               table.place(key), of ? "mm, m, inch ..." : "Pa, m/s, ...");
    }
    return unit;
}

std::vector<std::pair<std::string, std::string>> units_of_variables(const TomlTable& table) {
    const TomlTable said = table.table_or_empty("units");
    std::vector<std::pair<std::string, std::string>> units;
    for (const auto& variable : said.keys()) {
        units.emplace_back(variable, unit_of_file(said, variable));
    }
    return units;
}

void add_cases(Study& study, const TomlTable& table, std::unordered_map<std::string, std::string>& files,
               std::map<std::string, std::string>& own_units) {
    const std::string pattern = table.string("files");
    const Conditions held = read_where(table, "conditions");
    const std::vector<std::string> zones = table.strings("zones");
    const bool mean = table.boolean_or("mean", false);
    const auto length_unit = unit_of_file(table, "length_unit", "m");
    const auto file_units = units_of_variables(table);
    DesignPointCases design(table);
    auto found = find_cases(pattern, study.folder(), table);
    const auto units = units_of(pattern, table, own_units);
    study.cases.reserve(study.cases.size() + found.size());
    files.reserve(files.size() + found.size());
    for (auto& item : found) {
        Case entry;
        entry.file = std::move(item.path);
        entry.name = short_name(entry.file, study.folder(), item.folder);
        entry.conditions = held;
        entry.zones = zones;
        entry.length_unit = length_unit;
        entry.units = file_units;
        for (auto& number : item.match.numbers) {
            entry.conditions.set(number.first, number.second, units.at(number.first));
        }
        for (auto& text : item.match.texts) {
            std::erase_if(entry.conditions.texts, [&](const auto& old) { return old.first == text.first; });
            entry.conditions.texts.push_back(std::move(text));
        }
        if (!design.take(entry)) {
            continue;
        }
        entry.mean = mean;
        if (mean && !entry.conditions.number("time")) {
            throw core::InputError("missing",
                                   table.path_of("mean") + ": the time of '" + entry.name +
                                       "' is not known, so that it has no place among the others",
                                   table.place("mean"),
                                   "let the names of the files carry it: files = \"run-{time:s}.csv\"");
        }
        const auto [same, fresh] = files.emplace(entry.file.string(), pattern);
        if (!fresh) {
            throw core::InputError("duplicate",
                                   "the case '" + entry.name + "' occurs twice: " + entry.file.string() + " fits '" +
                                       same->second + "' and '" + pattern + "'",
                                   table.place("files"), "make the patterns exclude each other");
        }
        study.cases.push_back(std::move(entry));
    }
    design.finish(study.notes);
}

/// Names must be unique and fit for file names, because documents and exports carry them.
std::string unique_name(const TomlTable& table, std::set<std::string>& taken) {
    const std::string name = table.string("name");
    if (name.empty() || name.find_first_of("/\\\n\t\"<>") != std::string::npos || name.front() == '.') {
        throw core::InputError("name", "'" + name + "' cannot be a name", table.place("name"),
                               "use letters, digits, blanks, - and _");
    }
    if (!taken.insert(name).second) {
        throw core::InputError("duplicate", "the name '" + name + "' occurs twice", table.place("name"));
    }
    return name;
}

/// A list that must have an entry: without one the step would do nothing.
std::vector<std::string> required_strings(const TomlTable& table, const char* key) {
    std::vector<std::string> list = table.strings(key);
    if (list.empty()) {
        (void)table.string(key);  // throws: it is missing, with an example; or an empty list, which is no text
    }
    return list;
}

/// Names as a list or as one text with commas.
std::vector<std::string> read_names(const TomlTable& table, const char* key) {
    std::vector<std::string> names;
    for (const auto& text : required_strings(table, key)) {
        for (const auto part : core::split(text, ',')) {
            names.emplace_back(core::trimmed(part));
        }
    }
    return names;
}

MeshSpec read_mesh(const TomlTable& table, std::set<std::string>& taken) {
    MeshSpec mesh;
    mesh.name = unique_name(table, taken);
    mesh.where = read_where(table, "where");
    mesh.column = table.string_or("column", "mesh");
    mesh.quantities = required_strings(table, "quantities");
    const TomlTable cells = table.table("cells");
    for (const auto& key : cells.keys()) {
        mesh.cells.emplace_back(key, cells.quantity(key, "1"));
    }
    if (mesh.cells.size() < 2) {
        throw core::InputError("range", table.path_of("cells") + " names fewer than two meshes", table.place("cells"));
    }
    return mesh;
}

/// A share that may be per cent without their sign.
double read_share(const TomlTable& table, const char* key, double fallback, double largest, const std::string& whole,
                  core::Problems& notes) {
    const double share = table.quantity_or(key, "1", fallback);
    const std::string text =
        table.is_number(key)
            ? percent_sign_missing(table.path_of(key) + " = " + core::format_number(share), share, largest, whole)
            : std::string();
    if (!text.empty()) {
        notes.push_back({core::Problem::Severity::warning, text, table.place(key)});
    }
    return share;
}

std::vector<std::string> forces_and_moments() {
    std::vector<std::string> quantities;
    for (const auto& quantity : core::quantity_names()) {
        if (quantity.name.ends_with("_force") || quantity.name.ends_with("_moment")) {
            quantities.push_back(quantity.name);
        }
    }
    return quantities;
}

bool cancelled_by_halves(const Study& study, const std::string& quantity) {
    return !study.symmetry.empty() &&
           (quantity == "side_force" || quantity == "roll_moment" || quantity == "yaw_moment");
}

/// A table of a shape that has no cases of its own.
void read_shape_table(const TomlTable& table, TableSpec& spec, const Study& study) {
    spec.shape = table.file("shape");
    if (!study.design) {
        throw core::InputError("missing", "the table '" + spec.name + "' is of a shape, and the study has no [design]",
                               table.place("shape"), "surrogates over shapes are learned by the search of [design]");
    }
    if (!spec.mesh_uncertainty.empty()) {
        throw core::InputError("name", "the table '" + spec.name + "' is of a shape: its errors are the surrogate's",
                               table.place("mesh_uncertainty"), "relative_sigma adds to them");
    }
    if (!spec.where.texts.empty()) {
        throw core::InputError("name", spec.where.texts.front().first + " is no condition of [design]",
                               table.place("where"), "where = { pitch = 0 }");
    }
    try {
        check_asked(*study.design, {{spec.quantity}, spec.axes, spec.where});
    } catch (const core::InputError& error) {
        throw core::InputError(error.kind(), "table '" + spec.name + "': " + error.message(), table.place(),
                               error.hint());
    }
}

TableSpec read_table(const TomlTable& table, std::set<std::string>& taken, Study& study) {
    TableSpec spec;
    spec.name = unique_name(table, taken);
    spec.quantity = table.choice("quantity", forces_and_moments());
    if (cancelled_by_halves(study, spec.quantity)) {
        throw core::InputError(
            "symmetry", "the halves of a half model cancel its " + spec.quantity + ": a table of it would be nothing",
            table.place("quantity"), "whole models have it: [frame] without symmetry");
    }
    spec.axes = read_names(table, "axes");
    spec.where = read_where(table, "where");
    spec.fit = table.string_or("fit", spec.fit);
    if (!tables::fit_kind(spec.fit)) {
        throw core::InputError("name", table.path_of("fit") + ": '" + spec.fit + "' is not known", table.place("fit"),
                               core::did_you_mean(spec.fit, tables::fit_kinds()));
    }
    spec.speed_exponent = table.quantity_or("speed_exponent", "1", spec.speed_exponent);
    spec.relative_sigma = read_share(table, "relative_sigma", 0, 0.5, "each value", study.notes);
    spec.mesh_uncertainty = table.string_or("mesh_uncertainty", "");
    spec.net_weight = table.find_quantity("net_weight", "N");
    spec.virtual_mass = table.quantity_or("virtual_mass", "kg", 0);
    spec.exports = table.strings("exports");
    if (table.has("shape")) {
        read_shape_table(table, spec, study);
    } else if (study.select(spec.where).empty()) {
        throw core::InputError("missing", "no case fits 'where' of the table '" + spec.name + "'", table.place("where"),
                               "underbody study list shows the cases and their conditions");
    }
    if (!spec.mesh_uncertainty.empty()) {
        std::vector<std::string> known;
        for (const auto& mesh : study.mesh_uncertainties) {
            known.push_back(mesh.name);
        }
        if (std::find(known.begin(), known.end(), spec.mesh_uncertainty) == known.end()) {
            throw core::InputError("name", "there is no [[mesh_uncertainty]] named '" + spec.mesh_uncertainty + "'",
                                   table.place("mesh_uncertainty"), core::did_you_mean(spec.mesh_uncertainty, known));
        }
    }
    return spec;
}

void check_tables(const Study& study, const TomlTable& table, const char* key, const std::vector<std::string>& names) {
    std::vector<std::string> known;
    for (const auto& spec : study.tables) {
        known.push_back(spec.name);
    }
    for (const auto& name : names) {
        if (study.find_table(name) == nullptr) {
            throw core::InputError("name", table.path_of(key) + ": there is no [[table]] named '" + name + "'",
                                   table.place(key), core::did_you_mean(name, known));
        }
    }
}

/// Half a body has its mirror plane along its middle: one across the vertical or the way forward makes every lift or
/// drag zero.
void check_symmetry(const Study& study, const TomlTable& frame) {
    if (study.symmetry.empty()) {
        return;
    }
    postproc::MirrorPlane plane;
    try {
        plane = postproc::mirror_plane_from(study.symmetry);
    } catch (const core::Error& error) {
        throw core::InputError("range", error.message(), frame.place("symmetry"),
                               "its normal axis, with its place if that is not 0: \"y\", or \"y=0.1\"");
    }
    try {
        postproc::check_mirror_lies_along(plane, postproc::axis_from(study.forward), postproc::axis_from(study.up));
    } catch (const core::Error& error) {
        const std::string side(1, static_cast<char>('x' + 'y' + 'z' - study.up.back() - study.forward.back()));
        throw core::InputError("range", error.message(), frame.place("symmetry"),
                               "the plane of a half model lies along the vehicle: symmetry = \"" + side + "\"");
    }
}

void read_frame(Study& study, const TomlTable& root) {
    const TomlTable frame = root.table_or_empty("frame");
    const std::vector<std::string> directions = {"+x", "-x", "+y", "-y", "+z", "-z"};
    study.forward = frame.choice("forward", directions, "+x");
    study.up = frame.choice("up", directions, "+z");
    study.symmetry = frame.string_or("symmetry", "");
    if (frame.has("moments_about") && !frame.is_string("moments_about")) {
        const auto point = frame.quantities("moments_about", "m");
        if (point.size() != 3) {
            throw core::InputError("range", "frame.moments_about needs three coordinates", frame.place("moments_about"),
                                   "moments_about = [\"0 m\", \"0 m\", \"5 mm\"], or \"base_centre\"");
        }
        study.moments_about = std::array<double, 3>{point[0], point[1], point[2]};
    } else {
        (void)frame.choice("moments_about", {"base_centre"}, "base_centre");
    }
    if (study.forward.back() == study.up.back()) {
        throw core::InputError("range", "forward and up lie along one axis", frame.place("up"));
    }
    check_symmetry(study, frame);
    const TomlTable reference = root.table_or_empty("reference");
    for (const auto& [name, unit] :
         {std::pair{"length", "m"}, {"width", "m"}, {"height", "m"}, {"density", "kg/m^3"}, {"speed", "m/s"}}) {
        if (const auto value = reference.find_quantity(name, unit)) {
            const bool at_rest = *value == 0 && std::string_view(name) == "speed";
            if (!(*value > 0 || at_rest)) {
                throw core::InputError("range",
                                       reference.path_of(name) + " = " + core::format_number(*value, 6) + " " + unit +
                                           ": it must be greater than nought",
                                       reference.place(name));
            }
            study.reference.numbers.emplace_back(name, *value);
        }
    }
}

/// By the parts of their paths.
void sort_by_file(std::vector<Case>& cases) {
    std::vector<std::pair<std::string, std::size_t>> order;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        std::string path = cases[i].file.string();
        std::replace(path.begin(), path.end(), '/', '\0');
        order.emplace_back(std::move(path), i);
    }
    std::sort(order.begin(), order.end());
    std::vector<Case> sorted;
    sorted.reserve(cases.size());
    for (const auto& [path, i] : order) {
        sorted.push_back(std::move(cases[i]));
    }
    cases = std::move(sorted);
}

SlurmSpec read_slurm(const TomlTable& table) {
    SlurmSpec slurm;
    for (const auto& [key, text] : {std::pair{"partition", &slurm.partition},
                                    {"time", &slurm.time},
                                    {"memory", &slurm.memory},
                                    {"account", &slurm.account}}) {
        *text = table.string_or(key, "");
        if (!slurm_takes(*text)) {
            throw core::InputError("parse", table.path_of(key) + " is '" + *text + "': Slurm takes no blanks there",
                                   table.place(key), "time = \"02:00:00\", memory = \"4G\"");
        }
    }
    for (const auto& [key, number] : {std::pair{"throttle", &slurm.throttle}, {"max_array", &slurm.max_array}}) {
        const auto value = table.integer_or(key, 0);
        if (value < 0 || value > 4000000) {
            throw core::InputError("range",
                                   table.path_of(key) + " is " + std::to_string(value) +
                                       ": it cannot be negative, nor above Slurm's own 4000000",
                                   table.place(key));
        }
        *number = static_cast<int>(value);
    }
    for (const auto& [key, number, least, most] :
         {std::tuple{"cores", &slurm.cores, 1, 4096}, {"retries", &slurm.retries, 0, 100}}) {
        const auto value = table.integer_or(key, *number);
        if (value < least || value > most) {
            throw core::InputError("range",
                                   table.path_of(key) + " is " + std::to_string(value) + ": " + std::to_string(least) +
                                       " to " + std::to_string(most),
                                   table.place(key));
        }
        *number = static_cast<int>(value);
    }
    slurm.run_study = table.boolean_or("run_study", false);
    slurm.options = table.has("options") ? table.strings("options") : std::vector<std::string>{};
    for (const auto& option : slurm.options) {
        if (!option.starts_with("-") || option.find('\n') != std::string::npos) {
            throw core::InputError("parse", table.path_of("options") + ": '" + option + "' is no option of sbatch",
                                   table.place("options"), "options = [\"--nice=100\"]");
        }
    }
    return slurm;
}

std::optional<SweepSpec> read_sweep(const Study& study, const TomlTable& root) {
    if (!root.has("sweep")) {
        return std::nullopt;
    }
    const TomlTable table = root.table("sweep");
    SweepSpec sweep;
    sweep.folder = table.string_or("folder", "runs");
    std::vector<std::string> known;
    for (const auto& body : study.bodies) {
        known.push_back(body.name);
    }
    for (const auto& name : table.has("bodies") ? table.strings("bodies") : known) {
        const auto body =
            std::find_if(study.bodies.begin(), study.bodies.end(), [&](const BodySpec& b) { return b.name == name; });
        if (body == study.bodies.end()) {
            throw core::InputError("name", table.path_of("bodies") + ": there is no [[body]] named '" + name + "'",
                                   table.place("bodies"), core::did_you_mean(name, known));
        }
        sweep.bodies.push_back(*body);
    }
    const auto list = [&](const char* key, const char* unit, std::optional<double> fallback) {
        if (!table.has(key) && fallback) {
            return std::vector<double>{*fallback};
        }
        return table.is_array(key) ? table.quantities(key, unit) : std::vector<double>{table.quantity(key, unit)};
    };
    sweep.gaps = list("gap", "m", std::nullopt);
    sweep.pitches = list("pitch", "rad", 0.0);
    sweep.speeds = list("speed", "m/s", study.reference.number("speed"));
    sweep.jet = read_jet_axis(table);
    sweep.conditions = read_where(table, "conditions");
    sweep.kinematic_viscosity = table.quantity_or("kinematic_viscosity", "m^2/s", sweep.kinematic_viscosity);
    sweep.mesh = read_case_mesh(table);
    sweep.jet.check(sweep.mesh, table.place(sweep.jet.quantity));
    sweep.slurm = read_slurm(table.table_or_empty("slurm"));
    if (sweep.bodies.empty() || sweep.gaps.empty() || sweep.pitches.empty() || sweep.speeds.empty()) {
        throw core::InputError("missing", "a sweep needs a [[body]], a gap and a speed", table.place(),
                               "bodies = [\"ellipse\"], gap = [\"2 mm\", \"5 mm\"], speed = \"0.5 m/s\"");
    }
    return sweep;
}

PictureSpec read_picture(const TomlTable& table, std::set<std::string>& taken) {
    PictureSpec spec;
    spec.name = unique_name(table, taken);
    spec.where = read_where(table, "where");
    spec.views = table.strings("views");
    if (table.has("range")) {
        const auto range = table.quantities("range", "Pa");
        if (range.size() != 2 || !(range[0] < range[1])) {
            throw core::InputError("range", table.path_of("range") + " needs two pressures, the lower one first",
                                   table.place("range"), "range = [\"-60 Pa\", \"20 Pa\"]");
        }
        spec.range = {range[0], range[1]};
    }
    return spec;
}

RegionSpec read_region(const TomlTable& table, std::set<std::string>& taken, const Study& study) {
    RegionSpec spec;
    spec.name = unique_name(table, taken);
    spec.model = table.file("model");
    spec.forces = table.strings("forces");
    check_tables(study, table, "forces", spec.forces);
    for (const auto& axis : required_strings(table, "axes")) {
        spec.axes += (spec.axes.empty() ? "" : ",") + axis;
    }
    spec.duration = table.quantity_or("for", "s", 60);
    spec.columns = static_cast<int>(table.integer_or("columns", 400));
    spec.rows = static_cast<int>(table.integer_or("rows", 400));
    return spec;
}

VerifySpec read_verification(const TomlTable& table, std::set<std::string>& taken, core::Problems& notes) {
    VerifySpec spec;
    spec.name = unique_name(table, taken);
    spec.table = table.file("table");
    spec.where = read_where(table, "where");
    spec.quantities = required_strings(table, "quantities");
    spec.tolerance = read_share(table, "tolerance", 0.01, 0.1, "the force", notes);
    if (!(spec.tolerance > 0)) {
        throw core::InputError("range",
                               table.path_of("tolerance") + " = " + core::format_number(spec.tolerance, 4) +
                                   ": a share of the force greater than nought",
                               table.place("tolerance"), "0.01 is one per cent");
    }
    return spec;
}

/// What is made of the cases.
void read_steps(Study& study, const TomlTable& root) {
    std::set<std::string> pictures;
    for (const auto& table : root.tables("picture")) {
        study.pictures.push_back(read_picture(table, pictures));
    }
    std::set<std::string> meshes;
    for (const auto& table : root.tables("mesh_uncertainty")) {
        study.mesh_uncertainties.push_back(read_mesh(table, meshes));
    }
    std::set<std::string> tables;
    for (const auto& table : root.tables("table")) {
        study.tables.push_back(read_table(table, tables, study));
    }
    std::set<std::string> regions;
    for (const auto& table : root.tables("region")) {
        study.regions.push_back(read_region(table, regions, study));
    }
    std::set<std::string> measurements;
    for (const auto& table : root.tables("measurement")) {
        MeasurementSpec spec;
        spec.name = unique_name(table, measurements);
        spec.model = table.file("model");
        spec.data = table.file("data");
        spec.discover = table.boolean_or("discover", false);
        study.measurements.push_back(std::move(spec));
    }
    study.thesis = root.boolean_or("thesis", false);
    study.thesis_dynamics = root.boolean_or("thesis_dynamics", false);
    std::set<std::string> verifications;
    for (const auto& table : root.tables("verify")) {
        study.verifications.push_back(read_verification(table, verifications, study.notes));
    }
    std::set<std::string> comparisons;
    for (const auto& table : root.tables("compare")) {
        study.comparisons.push_back({unique_name(table, comparisons), required_strings(table, "tables")});
        check_tables(study, table, "tables", study.comparisons.back().tables);
    }
}

}  // namespace

fs::path folder_of(const fs::path& path) {
    return fs::is_directory(path) ? path : path.has_parent_path() ? path.parent_path() : fs::path(".");
}

Study Study::open(const fs::path& path) {
    const fs::path file = fs::is_directory(path) ? path / "study.toml" : path;
    if (!fs::exists(file)) {
        throw core::InputError("missing",
                               fs::exists(path) ? "there is no study.toml in this folder" : "there is no such folder",
                               {path.string(), {}, {}, {}}, "a study is a folder with a study.toml; see cases/evie");
    }
    return read(core::read_toml(file, study_format()), file);
}

Study Study::from_text(const std::string& text, const fs::path& file) {
    return read(core::read_toml_text(text, file.string(), file.has_parent_path() ? file.parent_path() : fs::path("."),
                                     study_format()),
                file);
}

Study Study::read(const TomlTable& root, const fs::path& file) {
    Study study;
    study.folder_ = file.has_parent_path() ? file.parent_path() : fs::path(".");
    study.title = root.string("title");
    study.summary = root.string_or("summary", "");
    study.origin = root.string_or("origin", "");
    read_frame(study, root);
    std::unordered_map<std::string, std::string> files;  // and the pattern that found them
    std::map<std::string, std::string> own_units;        // of words of the user's own in patterns
    for (const auto& table : root.tables("case")) {
        add_cases(study, table, files, own_units);
    }
    std::set<std::string> bodies;
    for (const auto& table : root.tables("body")) {
        study.bodies.push_back({unique_name(table, bodies), table.file("shape")});
    }
    study.sweep = read_sweep(study, root);
    if (root.has("design")) {
        study.design = read_design(root.table("design"), study.folder_);
    }
    for (auto& solved : solved_cases(study, study.notes)) {
        if (files.emplace(solved.file.lexically_normal().string(), "[sweep]")
                .second) {  // a [[case]] may name them itself
            study.cases.push_back(std::move(solved));
        }
    }
    tell_names_apart(study.cases, study.folder());
    sort_by_file(study.cases);
    read_steps(study, root);
    root.finish();
    return study;
}

std::vector<std::string> table_quantities(const Study& study) {
    std::vector<std::string> quantities = forces_and_moments();
    std::erase_if(quantities, [&study](const std::string& one) { return cancelled_by_halves(study, one); });
    return quantities;
}

std::vector<const Case*> Study::select(const Conditions& where) const {
    std::vector<const Case*> chosen;
    for (const auto& entry : cases) {
        if (entry.conditions.satisfies(where)) {
            chosen.push_back(&entry);
        }
    }
    return chosen;
}

std::optional<double> Study::density_of(const Case& entry) const {
    const auto own = entry.conditions.number("density");
    return own ? own : reference.number("density");
}

std::optional<double> Study::speed_of(const Case& entry) const {
    const auto own = entry.conditions.number("speed");
    return own ? own : reference.number("speed");
}

const TableSpec* Study::find_table(const std::string& name) const {
    for (const auto& table : tables) {
        if (table.name == name) {
            return &table;
        }
    }
    return nullptr;
}

}  // namespace underbody::cases
