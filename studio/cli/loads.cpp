// underbody loads FILE...: forces and moments, and a table of many files.
#include "postproc/loads/loads.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "cases/percent.h"
#include "core/batch_problems.h"
#include "core/counted.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "core/water.h"
#include "postproc/field/beside.h"
#include "postproc/loads/declared.h"
#include "postproc/loads/loads_table.h"
#include "postproc/loads/mesh_study.h"
#include "postproc/loads/stated_loads.h"
#include "postproc/loads/transient.h"
#include "studio/cli/commands.h"
#include "studio/cli/field_options.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

struct LoadsArguments {
    std::vector<std::string> files;
    std::string manifest, out;
    std::string reference, base = "*base*", forward = "+x", up = "+z", symmetry, fluid = "automatic";
    std::string density, speed, length, width, height, reference_pressure;
    std::string mesh_study, check;
    std::vector<std::string> reports, monitors;
    int stations = 0;
    bool accept_problems = false, axisymmetric = false, keep_going = false, mean = false;
    FieldOptions field;
};

/// Nothing when the option was not given. Throws core::UsageError when it is not positive: lengths and flow that
/// coefficients refer to.
std::optional<double> positive(const char* option, const std::string& text, const char* unit) {
    if (text.empty()) {
        return {};
    }
    const double value = option_value(option, text, unit);
    if (!(value > 0)) {
        throw core::UsageError("range", std::string(option) + " is " + core::format_number(value) + " " + unit +
                                            ": it has to be positive");
    }
    return value;
}

/// A condition of a file, SI; nothing when it has none of that name or a missing value.
std::optional<double> condition_of(const ConditionedFile& file, const std::string& name) {
    const auto found =
        std::find_if(file.numbers.begin(), file.numbers.end(), [&](const auto& entry) { return entry.first == name; });
    return found == file.numbers.end() || std::isnan(found->second) ? std::nullopt
                                                                    : std::optional<double>(found->second);
}

[[noreturn]] void refuse_condition(const std::string& part, const ConditionedFile& file) {
    std::vector<std::string> names;
    for (const auto& entry : file.numbers) {
        names.push_back(entry.first);
    }
    if (std::find(names.begin(), names.end(), part) != names.end()) {
        throw core::InputError("missing", "this case has no value of '" + part + "', which --reference takes",
                               {file.path, {}, {}, {}});
    }
    throw core::UsageError("usage",
                           "'" + part + "' in --reference is neither a length nor a condition of '" + file.path + "'",
                           {}, core::did_you_mean(part, names));
}

/// The point of the moments: "x,y,z" with lengths or names of conditions ("0,0,gap"), else the manifest's columns
/// reference_x, _y, _z.
std::optional<postproc::Vector> reference_of(const std::string& text, const ConditionedFile& file) {
    const auto condition = [&](const std::string& name) { return condition_of(file, name); };
    if (text.empty()) {
        const auto x = condition("reference_x");
        const auto y = condition("reference_y");
        const auto z = condition("reference_z");
        if (!x && !y && !z) {
            return std::nullopt;
        }
        if (!x || !y || !z) {
            throw core::InputError("missing", "a reference point needs reference_x, reference_y and reference_z",
                                   {file.path, {}, {}, {}});
        }
        return postproc::Vector{*x, *y, *z};
    }
    const auto parts = core::split(text, ',');
    if (parts.size() != 3) {
        throw core::UsageError("usage", "'" + text + "' is no point", {},
                               "give x,y,z in m, or with units: \"0,0,5 mm\", or conditions: \"0,0,gap\"");
    }
    postproc::Vector point{};
    for (std::size_t k = 0; k < 3; ++k) {
        const std::string part(core::trimmed(parts[k]));
        const auto known = condition(part);
        if (!known && !part.empty() && std::isalpha(static_cast<unsigned char>(part.front())) != 0) {
            refuse_condition(part, file);
        }
        point[k] = known ? *known : option_value("--reference", part, "m");
    }
    return point;
}

/// Conditions that mean something here are in a unit of theirs, and not below nothing.
void check_conditions(const Batch& batch, const LoadsArguments& given) {
    std::vector<std::pair<std::string, std::string>> units = {
        {"density", "kg/m^3"}, {"speed", "m/s"}, {"reference_x", "m"}, {"reference_y", "m"}, {"reference_z", "m"}};
    if (!given.mesh_study.empty()) {
        units.emplace_back(given.mesh_study, "1");
    }
    for (const auto& load : postproc::table_row({})) {
        units.emplace_back(load.name + "_scatter", load.unit);
    }
    for (const auto& [name, unit] : batch.number_units) {
        for (const auto& [known, si] : units) {
            if (name == known && !core::same_dimension(unit, si)) {
                throw core::InputError(
                    "unit",
                    "the condition '" + name + "' is in " + unit + ", not in " + (si == "1" ? "pure numbers" : si),
                    {given.manifest, {}, {}, {}});
            }
        }
    }
    for (const auto& file : batch.files) {
        const core::Place place = file.row.file.empty() ? core::Place{file.path, {}, {}, {}} : file.row;
        postproc::check_scatters(file.numbers, place);
        if (const auto density = condition_of(file, "density"); density && !(*density > 0)) {
            throw core::InputError("range", "the density is " + core::format_number(*density) + " kg/m^3", place);
        }
    }
}

postproc::LoadsOptions loads_options(const LoadsArguments& given) {
    postproc::LoadsOptions options;
    options.zones = given.field.zones;
    options.base = given.base;
    options.forward = postproc::axis_from(given.forward);
    options.up = postproc::axis_from(given.up);
    options.symmetry = given.symmetry;
    options.fluid = given.fluid == "automatic" ? postproc::FluidSide::automatic
                    : given.fluid == "file"    ? postproc::FluidSide::as_in_file
                                               : postproc::FluidSide::reversed;
    options.reference_pressure =
        given.reference_pressure.empty() ? 0 : option_value("--reference-pressure", given.reference_pressure, "Pa");
    options.references = {positive("--density", given.density, "kg/m^3"), positive("--speed", given.speed, "m/s"),
                          positive("--length", given.length, "m"), positive("--width", given.width, "m"),
                          positive("--height", given.height, "m")};
    options.stations = given.stations;
    options.accept_problems = given.accept_problems;
    options.axisymmetric = given.axisymmetric;
    return options;
}

std::string cell(double value) {
    std::string text = core::format_number(value, 5);
    return std::string(text.size() < 13 ? 13 - text.size() : 1, ' ') + text;
}

void print(Shell& shell, const std::vector<postproc::Comparison>& comparisons);

std::string vector(const postproc::Vector& v) {
    const auto number = [](double value) { return core::format_number(value, 6); };
    return number(v[0]) + ", " + number(v[1]) + ", " + number(v[2]);
}

void print_zones(Shell& shell, const postproc::LoadsResult& result) {
    for (const auto& zone : result.zones) {
        const auto& p = zone.pressure.force;
        const auto& v = zone.viscous.force;
        shell.print("zone '" + zone.name + "': " + core::counted(zone.faces, "face") + ", " +
                    core::format_number(zone.area, 5) + " m^2, force " +
                    vector({p[0] + v[0], p[1] + v[1], p[2] + v[2]}) + " N");
    }
    for (const auto& zone : result.left_out) {
        shell.print("not summed: zone '" + zone.name + "', " + zone.why);
    }
    if (result.coefficients) {
        const auto& c = *result.coefficients;
        const auto brief = [](double value, int digits) { return core::format_number(value, digits); };
        shell.print("C_L " + brief(c.lift, 5) + ", C_D " + brief(c.drag, 5) + ", C_M " + brief(c.pitch_moment, 5) +
                    " on " + brief(c.length, 4) + " x " + brief(c.width, 4) + " x " + brief(c.height, 4) + " m (" +
                    c.lengths_from + "), " + brief(c.density, 5) + " kg/m^3, " + brief(c.speed, 4) + " m/s");
    }
}

void print_stations(Shell& shell, const postproc::LoadsResult& result) {
    if (!result.stations.empty()) {
        shell.print(
            "what the part behind each place carries (along forward from the reference point):\n"
            "     position [m]   lift_force [N]   drag_force [N]  pitch_moment [N m]");
        for (const auto& station : result.stations) {
            shell.print("   " + cell(station.position) + "    " + cell(station.behind.lift_force) + "    " +
                        cell(station.behind.drag_force) + "       " + cell(station.behind.pitch_moment));
        }
    }
}

void print(Shell& shell, const postproc::LoadsCase& one) {
    const postproc::LoadsResult& result = one.loads;
    const auto& [total, pressure, viscous] = std::tie(result.named, result.named_pressure, result.named_viscous);
    const auto line = [&](const std::string& name, double postproc::NamedLoads::*which, const char* unit) {
        const auto sigma =
            std::find_if(one.sigmas.begin(), one.sigmas.end(), [&](const auto& entry) { return entry.first == name; });
        shell.print(name + std::string(16 - name.size(), ' ') + cell(total.*which) + cell(pressure.*which) +
                    cell(viscous.*which) +
                    (one.sigmas.empty()          ? ""
                     : sigma == one.sigmas.end() ? "            -"
                                                 : cell(sigma->second)) +
                    "  " + unit);
    };
    shell.print(result.file + (result.depth.empty() ? "" : ", " + result.depth));
    shell.print(std::string("                        total     pressure      viscous") +
                (one.sigmas.empty() ? "" : "        sigma"));
    line("lift_force", &postproc::NamedLoads::lift_force, "N, up");
    line("drag_force", &postproc::NamedLoads::drag_force, "N, against the motion");
    line("side_force", &postproc::NamedLoads::side_force, "N, to starboard");
    line("pitch_moment", &postproc::NamedLoads::pitch_moment, "N m, nose up");
    line("roll_moment", &postproc::NamedLoads::roll_moment, "N m, starboard down");
    line("yaw_moment", &postproc::NamedLoads::yaw_moment, "N m, bow to starboard");
    shell.print("force           " + vector(result.total.force) + " N, in the file's axes");
    shell.print("moment          " + vector(result.total.moment) + " N m, about " + vector(result.reference) +
                " m: " + result.reference_from);
    if (result.centre_of_pressure) {
        shell.print("acts at         " + vector(*result.centre_of_pressure) +
                    " m: the lift, on the line forward through that point");
    }
    print_zones(shell, result);
    shell.print("from values on " + result.values_from + "; closure " + core::format_number(result.closure, 3) +
                "; 1 kPa of reference pressure would add " +
                vector(postproc::plus({}, result.force_per_reference_pascal, 1000)) + " N");
    shell.print("sides: " + result.orientation);
    const std::string verdict = to_string(one.settled.verdict);
    shell.print((one.settled.verdict == postproc::SettledVerdict::unknown ? "settled: unknown: " : verdict + ": ") +
                one.settled.why);
    print_stations(shell, result);
    print(shell, one.comparisons);
}

std::string of_force(const postproc::Comparison& one) {
    return core::format_number(100 * one.of_force, 3) + " % of the force apart";
}

/// What the solver states beside what was integrated; rows of single zones and parts only with --verbose.
void print(Shell& shell, const std::vector<postproc::Comparison>& comparisons) {
    std::string file;
    for (const auto& one : comparisons) {
        if (one.stated_in != file) {
            file = one.stated_in;
            shell.print("the solver's own, in " + file + ":");
        }
        const bool zone = one.quantity.find(" on '") != std::string::npos &&
                          std::count(one.quantity.begin(), one.quantity.end(), '\'') == 2;
        const bool part = zone || one.quantity.find(" part of ") != std::string::npos;
        if (!part || shell.verbose) {
            const std::string blanks(one.quantity.size() < 14 ? 14 - one.quantity.size() : 1, ' ');
            shell.print("  " + one.quantity + blanks + cell(one.stated) + "  " + of_force(one) +
                        (one.hint.empty() ? "" : ": " + one.hint));
        }
    }
    if (!comparisons.empty()) {
        const auto worst = std::max_element(comparisons.begin(), comparisons.end(),
                                            [](const auto& a, const auto& b) { return a.of_force < b.of_force; });
        shell.print("  " + core::counted(comparisons.size(), "number") + " compared, furthest: " + worst->quantity +
                    ", " + of_force(*worst));
    }
}

/// The loads against those that somebody states; exit code 4 when one is further off than allowed.
int check(Shell& shell, const std::vector<postproc::LoadsCase>& cases, const std::string& share) {
    const double allowed = option_value("--check", share, "1");
    if (const std::string missing =
            underbody::cases::percent_sign_missing("--check " + share, allowed, 0.1, "the force");
        !missing.empty() && share.find('%') == std::string::npos) {
        shell.show_warning(missing);
    }
    core::Problems notes;
    auto comparisons = postproc::compare_with_stated(cases, notes);
    shell.show(notes);
    std::vector<std::string> unchecked;
    std::set<std::string> checked;
    for (const auto& stated : comparisons) {
        checked.insert(stated.file);
    }
    for (const auto& one : cases) {
        if (one.comparisons.empty() && !checked.contains(one.file)) {
            unchecked.push_back(one.file);
        }
    }
    for (const auto& one : cases) {
        comparisons.insert(comparisons.end(), one.comparisons.begin(), one.comparisons.end());
    }
    if (comparisons.empty()) {
        throw core::InputError("missing",
                               "nothing to check against: no report beside the file and no loads in a manifest", {},
                               "give a force report with --report, a monitor with --monitor, or a manifest with "
                               "columns such as lift_force, "
                               "drag_force, pitch_moment");
    }
    for (const auto& file : unchecked) {
        shell.show_warning(file + ": compared with nothing: no report, monitor or manifest states its loads");
    }
    double worst = 0;
    int failed = 0;
    for (const auto& one : comparisons) {
        worst = std::max(worst, one.of_force);
        if (!(one.of_force <= allowed)) {
            ++failed;
            shell.show_warning(one.file + ": " + one.quantity + " is " + core::format_number(one.value, 5) +
                               ", stated " + core::format_number(one.stated, 5) +
                               (one.stated_in.empty() ? "" : " in " + one.stated_in) + ": " + of_force(one) +
                               (one.hint.empty() ? "" : "; " + one.hint));
        }
    }
    shell.info(core::counted(comparisons.size(), "load") + " compared with those stated: at most " +
               core::format_number(100 * worst, 3) + " % of the force apart, " + std::to_string(failed) + " beyond " +
               core::format_number(100 * allowed, 3) + " %");
    return failed > 0 ? check_failed : done;
}

/// "{stem}" in a report's name is the name of the CFD file without its ending; the report then lies relative to that
/// file.
std::string beside(const std::string& report, const std::string& file) {
    const auto at = report.find("{stem}");
    if (at == std::string::npos) {
        return report;
    }
    std::string name = report;
    name.replace(at, 6, postproc::case_stem(file));
    return (std::filesystem::path(file).parent_path() / name).string();
}

/// The same of the file in a monitor's QUANTITY=FILE.
std::string monitor_beside(const std::string& monitor, const std::string& file) {
    const std::size_t name = monitor.find('=') + 1;  // without one: from the beginning, to be refused as it is
    return monitor.substr(0, name) + beside(std::string(core::trimmed(monitor.substr(name))), file);
}

/// Adds what no file states that was there before: a report that lies beside the CFD file and is named as well counts
/// once.
void add_new(std::vector<postproc::StatedLoad>& stated, const std::vector<postproc::StatedLoad>& more) {
    std::vector<std::string> before;
    for (const auto& load : stated) {
        if (before.empty() || before.back() != load.file) {
            before.push_back(load.file);
        }
    }
    for (const auto& load : more) {
        std::error_code ignored;
        const auto same = [&](const std::string& file) {
            return file == load.file || std::filesystem::equivalent(file, load.file, ignored);
        };
        if (std::none_of(before.begin(), before.end(), same)) {
            stated.push_back(load);
        }
    }
}

/// What the solver states of a case: beside the file, in the reports and monitors that were named; the later counts.
void take_stated(Shell& shell, const LoadsArguments& given, postproc::LoadsCase& one, core::Problems& problems) {
    auto stated = postproc::stated_beside(one.file, one.loads);
    for (const auto& report : given.reports) {
        const std::string path = beside(report, one.file);
        const auto more = std::filesystem::is_directory(path) ? postproc::stated_by_openfoam(path, one.loads)
                                                              : postproc::stated_in_report(path);
        if (more.empty()) {
            throw core::InputError("missing", "no forces in '" + path + "'", {},
                                   "an OpenFOAM case keeps them under postProcessing");
        }
        add_new(stated, more);
    }
    for (const auto& text : given.monitors) {
        stated.push_back(
            postproc::stated_by_monitor(postproc::monitor_source(monitor_beside(text, one.file)), one.loads));
    }
    for (const auto& load : stated) {
        if (load.history && load.part == postproc::LoadPart::total) {
            shell.detail(load.file + ": " + load.quantity + " " + load.history->text);
        }
    }
    core::Problems notes;
    one.settled = postproc::settled_by(one.loads, stated, one.file, notes);
    if (one.settled.verdict == postproc::SettledVerdict::not_settled) {
        notes.push_back({core::Problem::Severity::warning,
                         "the solution has not settled: " + one.settled.why,
                         {one.file, {}, {}, {}}});
    }
    one.comparisons = postproc::compare_with_solver(one.loads, stated, notes);
    for (const auto& load : one.settled.loads) {
        if (load.sigma > 0) {
            one.scatters.emplace_back(load.quantity, load.sigma);
        }
    }
    problems.insert(problems.end(), notes.begin(), notes.end());
}

/// The zones that were asked for; all of them when there are none of some name, for the error to know what there is.
postproc::Field field_of(Shell& shell, const LoadsArguments& given, const std::string& path) {
    postproc::ReadOptions read = given.field.read_options();
    read.zones = given.field.zones;
    read.surfaces_only = true;
    postproc::Field field = shell.read_field(path, read);
    const bool all_there = std::all_of(read.zones.begin(), read.zones.end(), [&](const std::string& pattern) {
        return std::any_of(field.zones.begin(), field.zones.end(),
                           [&](const postproc::Zone& zone) { return postproc::matches(pattern, zone.name); });
    });
    if (!all_there) {
        read.zones.clear();
        field = {};
        field = shell.read_field(path, read);
    }
    return field;
}

/// Those that were read already as the other file of a pair (a case and its data) count once.
class Seen {
public:
    /// The file that the same files were read by before; nothing when this is the first.
    const ConditionedFile* before(const ConditionedFile& file, std::vector<std::string> files) {
        for (auto& name : files) {
            std::error_code ignored;
            name = std::filesystem::weakly_canonical(name, ignored).string();
        }
        std::sort(files.begin(), files.end());
        const auto [place, is_new] = by_files_.try_emplace(std::move(files), &file);
        return is_new ? nullptr : place->second;
    }

private:
    std::map<std::vector<std::string>, const ConditionedFile*> by_files_;
};

/// Throws core::InputError when one case has conditions of two kinds.
void check_same(const ConditionedFile& file, const ConditionedFile& before) {
    if (file.numbers != before.numbers || file.texts != before.texts) {
        throw core::InputError(
            "manifest",
            "'" + file.path + "' and '" + before.path + "' are the files of one case, with different conditions",
            {file.path, {}, {}, {}}, "name one of them");
    }
}

/// `read_from`: the files that it was read from.
postproc::LoadsCase case_of(Shell& shell, const LoadsArguments& given, const ConditionedFile& file,
                            postproc::LoadsOptions options, core::Problems& problems,
                            std::vector<std::string>& read_from) {
    const postproc::Field field = field_of(shell, given, file.path);
    problems = field.problems;
    read_from = field.files;
    options.reference = reference_of(given.reference, file);
    if (!options.references.speed) {
        options.references.speed = condition_of(file, "speed");
    }
    if (!options.references.density) {
        options.references.density = condition_of(file, "density");
    }
    // Who gives a speed asks for coefficients; a condition of that name alone does not.
    const bool fresh_water = !given.speed.empty() && !options.references.density && !field.density;
    if (fresh_water) {
        options.references.density = core::default_water_density;
    }
    postproc::LoadsCase one{file.path, file.numbers, file.texts, postproc::loads(field, options, shell.progress()), {},
                            {}};
    if (fresh_water) {
        one.loads.problems.push_back({core::Problem::Severity::warning,
                                      "no density is given: coefficients are for " +
                                          core::format_number(core::default_water_density) +
                                          " kg/m^3, fresh water at 20 degC (--density)",
                                      {}});
    }
    const auto driven = [&](const char* jet) { return condition_of(file, jet).value_or(0) != 0; };
    const core::Problems faults =
        postproc::declared_faults(field, one.loads,
                                  {condition_of(file, "gap").value_or(NAN), condition_of(file, "pitch").value_or(NAN),
                                   options.base, !options.zones.empty(), driven("jet_flow") || driven("jet_voltage"),
                                   condition_of(file, "speed").value_or(NAN)});
    one.loads.problems.insert(one.loads.problems.end(), faults.begin(), faults.end());
    std::erase_if(one.numbers, [](const auto& entry) {
        return entry.first == "reference_x" || entry.first == "reference_y" || entry.first == "reference_z" ||
               entry.first == "reference_length";
    });
    problems.insert(problems.end(), one.loads.problems.begin(), one.loads.problems.end());
    take_stated(shell, given, one, problems);
    return one;
}

void show_studies(Shell& shell, const std::vector<postproc::LoadsCase>& cases) {
    for (const auto& one : cases) {
        for (const auto& [name, study] : one.meshes) {
            if (study.verdict != postproc::MeshVerdict::same) {
                shell.info(one.file + ": " + name + ": " + study.text);
            }
        }
    }
}

/// Copies of one file under several names, one in another unit, pitches that do not agree.
void show_odd_ones(Shell& shell, const std::vector<postproc::LoadsCase>& cases, const std::string& base) {
    std::vector<postproc::ConditionedLoads> all;
    for (const auto& one : cases) {
        const postproc::NamedLoads& loads = one.loads.named;
        all.push_back({one.file,
                       one.texts,
                       {loads.lift_force, loads.drag_force, loads.side_force, one.loads.area},
                       postproc::base_tilt(one.loads, base)});
        for (const auto& [name, value] : one.numbers) {
            if (!postproc::is_result(name)) {
                all.back().conditions.emplace_back(name, core::format_number(value));
            }
        }
    }
    for (const auto& [problem, last] : postproc::odd_loads(all)) {
        shell.show_warning(problem.message);
    }
}

struct Failure {
    std::string file, message;
};

/// The loads of every file that can be used. All files are tried, so that one run names all that is wrong; unless
/// asked to keep going, one that is wrong is an error then.
std::vector<postproc::LoadsCase> cases_of(Shell& shell, const LoadsArguments& given, const Batch& batch,
                                          std::vector<Failure>& failures) {
    const postproc::LoadsOptions options = loads_options(given);
    std::vector<postproc::LoadsCase> cases;
    core::BatchProblems said(shell.verbose);
    Seen seen;
    for (std::size_t i = 0; i < batch.files.size(); ++i) {
        shell.progress().check();
        shell.progress().report(static_cast<double>(i) / static_cast<double>(batch.files.size()), batch.files[i].path);
        core::Problems problems;
        std::vector<std::string> read_from;
        try {
            auto one = case_of(shell, given, batch.files[i], options, problems, read_from);
            if (const auto* before = seen.before(batch.files[i], read_from)) {
                check_same(batch.files[i], *before);
                shell.info(batch.files[i].path + ": the same case as '" + before->path + "', counted once");
                continue;
            }
            cases.push_back(std::move(one));
            said.add(batch.files[i].path, problems);
        } catch (const core::InputError& error) {
            if (batch.files.size() == 1) {
                std::erase_if(problems, [](const core::Problem& problem) {
                    return problem.severity == core::Problem::Severity::error;
                });  // that is what it says
                shell.show(problems);
                throw;
            }
            const bool named = std::string(error.what()).find(batch.files[i].path) != std::string::npos;
            failures.push_back({batch.files[i].path, (named ? "" : batch.files[i].path + ": ") + error.what()});
            shell.warn(failures.back().message);
        }
        if (batch.files.size() == 1) {
            shell.show(problems);
        }
    }
    if (batch.files.size() > 1) {
        shell.show(said.gathered());
    }
    if (!failures.empty() && (cases.empty() || !given.keep_going)) {
        throw core::InputError("file",
                               std::to_string(failures.size()) + " of " + core::counted(batch.files.size(), "file") +
                                   " cannot be used (the first: '" + failures.front().file + "'); nothing was written",
                               {}, cases.empty() ? "" : "mend them, or take the others alone with --keep-going");
    }
    return cases;
}

void check_files(const Batch& batch, const LoadsArguments& given) {
    if (batch.files.empty()) {
        throw core::UsageError("usage", "no files", {}, "name files, a pattern, or a --manifest");
    }
    for (const auto& file : batch.files) {
        std::error_code ignored;
        if (!given.out.empty() && std::filesystem::equivalent(file.path, given.out, ignored)) {
            throw core::UsageError("usage", "--out '" + given.out + "' is one of the files to read, and would be lost",
                                   {}, "write the table to a file of its own");
        }
    }
}

int run_loads(Shell& shell, const LoadsArguments& given) {
    const Batch batch = find_files(given.files, given.manifest, given.field.zones);
    shell.list_on_stdout = given.out.empty() && (batch.files.size() > 1 || !given.manifest.empty());
    shell.show(batch.problems);
    check_files(batch, given);
    check_conditions(batch, given);
    std::vector<Failure> failures;
    std::vector<postproc::LoadsCase> cases = cases_of(shell, given, batch, failures);
    const int verdict = given.check.empty() ? static_cast<int>(done) : check(shell, cases, given.check);
    show_odd_ones(shell, cases, given.base);
    core::Problems notes;
    if (given.mean) {
        cases = postproc::means_in_time(cases, notes);
    }
    cases = given.mesh_study.empty() ? postproc::with_iteration_sigmas(cases)
                                     : postproc::mesh_studies(cases, given.mesh_study, notes);
    shell.show(notes);
    if (!failures.empty()) {
        shell.show_warning("without " + std::to_string(failures.size()) + " of " +
                           core::counted(batch.files.size(), "file") + ", which cannot be used");
    }
    show_studies(shell, cases);
    const bool several = cases.size() + failures.size() > 1 || (given.files.empty() && !given.manifest.empty());
    shell.hand_over("loads", [&] { return postproc::loads_table(cases, batch.number_units); });
    const auto table_of_all = [&] {
        core::Table table = postproc::loads_table(cases, batch.number_units);
        shell.comment_warnings(table);
        return table;
    };
    const bool table = several || !given.manifest.empty() || !given.out.empty();
    if (!given.out.empty()) {
        core::write_csv(given.out, table_of_all());
        shell.info("wrote " + given.out);
    }
    if (shell.json) {
        nlohmann::json all = postproc::loads_table_json(cases);
        for (const auto& failure : failures) {
            all["failed"].push_back({{"file", failure.file}, {"message", failure.message}});
        }
        shell.print_json(several ? all : all["files"].front());
    } else if (!table) {
        print(shell, cases.front());
    } else if (given.out.empty()) {
        std::string text = core::write_csv(table_of_all());
        text.pop_back();
        shell.print(text);
    }
    return failures.empty() ? verdict : static_cast<int>(wrong_input);
}

void add_options(CLI::App* command, const std::shared_ptr<LoadsArguments>& o) {
    command->add_option("files", o->files,
                        "CFD files, or patterns such as 'fields/{variant}-h{gap:mm}-p{pitch:deg}.csv'");
    command->add_option("--manifest", o->manifest, "table with a column `file`; its other columns are the conditions")
        ->check(CLI::ExistingFile);
    command->add_option("-o,--out", o->out, "write a table (CSV) with one row a file");
    command->add_option("--reference", o->reference,
                        "point of the moments \"x,y,z\" in the file's axes, also by conditions: \"0,0,gap\" (default: "
                        "the centre of the base)");
    command->add_option("--base", o->base, "zone whose centre is the default reference")->capture_default_str();
    command->add_option("--symmetry", o->symmetry,
                        "half model: normal axis of its plane, with its place if not 0: y, or y=0.1");
    command->add_option("--forward", o->forward, "axis of the file that looks forward")->capture_default_str();
    command->add_option("--up", o->up, "axis of the file that looks up")->capture_default_str();
    command->add_option("--fluid", o->fluid, "where normals point: automatic, file (into the fluid), reversed")
        ->check(CLI::IsMember({"automatic", "file", "reversed"}))
        ->capture_default_str();
    command->add_option("--reference-pressure", o->reference_pressure, "taken from all pressures (\"101325 Pa\")");
    command->add_option(
        "--density", o->density,
        "for coefficients, and for files that hold p/rho (default: the file's, or the condition of that name; with "
        "--speed else 998 kg/m^3)");
    command->add_option("--speed", o->speed, "for coefficients (default: the condition of that name)");
    command->add_option("--length", o->length, "for coefficients (default: of the bounding box)");
    command->add_option("--width", o->width, "for coefficients");
    command->add_option("--height", o->height, "for coefficients");
    command
        ->add_option(
            "--mesh-study", o->mesh_study,
            "condition with the number of cells, or faces: cases that differ in it alone become one, with NAME_sigma")
        ->type_name("COLUMN");
    command->add_flag("--mean", o->mean,
                      "files of one run at several times become one: means in time, NAME_sigma by their correlation "
                      "(the time is the field's own, or {time:s} of the name)");
    command->add_option("--report", o->reports,
                        "the solver's force report (Fluent's text, CFX's .out), or the OpenFOAM case, to compare with "
                        "({stem}: the file's name "
                        "without ending, beside that file); found by itself when it lies beside the file");
    command->add_option("--monitor", o->monitors,
                        "history of a load, QUANTITY=FILE:COLUMN or \"QUANTITY [UNIT]=FILE\" ({stem} in FILE: as for "
                        "--report): its value at the "
                        "field's time, or its last, is compared, its scatter becomes NAME_sigma");
    command->add_option("--check", o->check,
                        "exit code 4 when the loads are further from those stated (report, monitor, manifest) than "
                        "this share of the force (0.01, \"1 %\")");
    command->add_flag(
        "--axisymmetric", o->axisymmetric,
        "a plane case is half the section of a body of revolution about x (Fluent cases say so themselves)");
    command->add_option("--stations", o->stations, "running integral along the body in so many steps")
        ->check(CLI::Range(0, 10000));
    command->add_flag("--accept-problems", o->accept_problems,
                      "go on although the file has errors such as faces without area");
    command->add_flag("--keep-going", o->keep_going,
                      "of several files, give the table of those that can be used; exit code 3 all the same");
    o->field.add_to(*command);
}

}  // namespace

void add_loads_command(CLI::App& app, Shell& shell) {
    auto* command = app.add_subcommand("loads", "forces and moments on a body, pressure and viscous part, per zone");
    auto o = std::make_shared<LoadsArguments>();
    add_options(command, o);
    command->footer(
        "Without --zones the walls of the body are summed. A wall that cannot be part of it (a ground, a tunnel) is "
        "left out, and said to be,\n"
        "if the others close without it; if they do not, the zones have to be named. --zones '*' sums over every "
        "wall.\n\n"
        "Examples:\n"
        "  underbody loads body.csv --symmetry y\n"
        "  underbody loads body.csv --zones 'hull*,base' --reference \"0,0,5 mm\" --json\n"
        "  underbody loads case.cas.h5 --density \"998 kg/m^3\" --speed \"0.5 m/s\" --length \"203.2 mm\"\n"
        "  underbody loads body.csv --symmetry y --stations 20\n"
        "  underbody loads 'fields/{variant}-h{gap:mm}-p{pitch:deg}.csv' --symmetry y --out loads.csv\n"
        "  underbody loads case.cas.gz --report forces.txt --check \"0.1 %\"\n"
        "  underbody loads case.dat.h5 --monitor lift_force=lift-rfile.out --monitor \"drag_force "
        "[N]=report.out:drag\"\n"
        "  underbody loads 'wake-{time:s}.csv' --mean\n"
        "  underbody loads --manifest forces.csv --symmetry y --reference \"0,0,gap\" --check 0.01\n"
        "  underbody loads --manifest forces.csv --symmetry y --mesh-study cells --out loads.csv");
    shell.on(command, [&shell, o] { return run_loads(shell, *o); });
}

}  // namespace underbody::studio
