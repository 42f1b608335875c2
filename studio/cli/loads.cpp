// underbody loads FILE...: forces and moments, and a table of many files.
#include "postproc/loads.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/loads_table.h"
#include "studio/cli/commands.h"
#include "studio/cli/field_options.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

struct Options {
    std::vector<std::string> files;
    std::string manifest, out;
    std::string reference, base = "*base*", forward = "+x", up = "+z", symmetry, fluid = "automatic";
    std::string density, speed, length, width, height, reference_pressure;
    std::string mesh_study, check;
    int stations = 0;
    bool accept_problems = false;
    FieldOptions field;
};

std::optional<double> optional_quantity(const std::string& text, const char* unit) {
    return text.empty() ? std::nullopt : std::optional<double>(core::parse_in(text, unit));
}

postproc::Vector point_from(const std::string& text) {
    const auto parts = core::split(text, ',');
    if (parts.size() != 3) {
        throw core::UsageError("usage", "'" + text + "' is no point", {}, "give x,y,z in m, or with units: \"0,0,5 mm\"");
    }
    return {core::parse_in(parts[0], "m"), core::parse_in(parts[1], "m"), core::parse_in(parts[2], "m")};
}

postproc::LoadsOptions loads_options(const Options& given) {
    postproc::LoadsOptions options;
    options.zones = given.field.zones;
    if (!given.reference.empty()) {
        options.reference = point_from(given.reference);
    }
    options.base = given.base;
    options.forward = postproc::axis_from(given.forward);
    options.up = postproc::axis_from(given.up);
    options.symmetry = given.symmetry;
    options.fluid = given.fluid == "automatic" ? postproc::FluidSide::automatic : given.fluid == "file" ? postproc::FluidSide::as_in_file : postproc::FluidSide::reversed;
    options.reference_pressure = optional_quantity(given.reference_pressure, "Pa").value_or(0);
    options.references = {optional_quantity(given.density, "kg/m^3"), optional_quantity(given.speed, "m/s"), optional_quantity(given.length, "m"),
                          optional_quantity(given.width, "m"), optional_quantity(given.height, "m")};
    options.stations = given.stations;
    options.accept_problems = given.accept_problems;
    return options;
}

std::string cell(double value) {
    std::string text = core::format_number(value, 5);
    return std::string(text.size() < 13 ? 13 - text.size() : 1, ' ') + text;
}

void print(Shell& shell, const postproc::LoadsResult& result) {
    const auto& [total, pressure, viscous] = std::tie(result.named, result.named_pressure, result.named_viscous);
    const auto line = [&](const std::string& name, double postproc::NamedLoads::*which, const char* unit) {
        shell.print(name + std::string(16 - name.size(), ' ') + cell(total.*which) + cell(pressure.*which) + cell(viscous.*which) + "  " + unit);
    };
    shell.print(result.file);
    shell.print("                        total     pressure      viscous");
    line("lift_force", &postproc::NamedLoads::lift_force, "N, up");
    line("drag_force", &postproc::NamedLoads::drag_force, "N, against the motion");
    line("side_force", &postproc::NamedLoads::side_force, "N, to starboard");
    line("pitch_moment", &postproc::NamedLoads::pitch_moment, "N m, nose up");
    line("roll_moment", &postproc::NamedLoads::roll_moment, "N m, starboard down");
    line("yaw_moment", &postproc::NamedLoads::yaw_moment, "N m, bow to starboard");
    const auto vector = [](const postproc::Vector& v) { return core::format_number(v[0], 6) + ", " + core::format_number(v[1], 6) + ", " + core::format_number(v[2], 6); };
    shell.print("force           " + vector(result.total.force) + " N, in the file's axes");
    shell.print("moment          " + vector(result.total.moment) + " N m, about " + vector(result.reference) + " m: " + result.reference_from);
    for (const auto& zone : result.zones) {
        const auto& p = zone.pressure.force;
        const auto& v = zone.viscous.force;
        shell.print("zone '" + zone.name + "': " + std::to_string(zone.faces) + " faces, " + core::format_number(zone.area, 5) + " m^2, force " +
                    vector({p[0] + v[0], p[1] + v[1], p[2] + v[2]}) + " N");
    }
    if (result.coefficients) {
        const auto& c = *result.coefficients;
        shell.print("C_L " + core::format_number(c.lift, 5) + ", C_D " + core::format_number(c.drag, 5) + ", C_M " + core::format_number(c.pitch_moment, 5) + " on " +
                    core::format_number(c.length, 4) + " x " + core::format_number(c.width, 4) + " x " + core::format_number(c.height, 4) + " m (" + c.lengths_from + "), " +
                    core::format_number(c.density, 5) + " kg/m^3, " + core::format_number(c.speed, 4) + " m/s");
    }
    shell.print("from values on " + result.values_from + "; closure " + core::format_number(result.closure, 3) + "; 1 kPa of reference pressure would add " +
                vector({1000 * result.force_per_reference_pascal[0], 1000 * result.force_per_reference_pascal[1], 1000 * result.force_per_reference_pascal[2]}) + " N");
    shell.print("sides: " + result.orientation);
}

/// The loads against those that the manifest states; exit code 4 when one is further off than allowed.
int check(Shell& shell, const std::vector<postproc::LoadsCase>& cases, double allowed) {
    const auto comparisons = postproc::compare_with_stated(cases);
    if (comparisons.empty()) {
        throw core::InputError("missing", "nothing to check against: the manifest states no loads", {}, "columns such as lift_force, drag_force, pitch_moment");
    }
    double worst = 0;
    int failed = 0;
    for (const auto& one : comparisons) {
        worst = std::max(worst, one.of_force);
        if (one.of_force > allowed) {
            ++failed;
            shell.warn(one.file + ": " + one.quantity + " is " + core::format_number(one.value, 5) + ", stated " + core::format_number(one.stated, 5) + ": " +
                       core::format_number(100 * one.of_force, 3) + " % of the force apart");
        }
    }
    shell.info(std::to_string(comparisons.size()) + " loads compared with those stated: at most " + core::format_number(100 * worst, 3) + " % of the force apart, " +
               std::to_string(failed) + " beyond " + core::format_number(100 * allowed, 3) + " %");
    return failed > 0 ? check_failed : done;
}

int run(Shell& shell, const Options& given) {
    const Batch batch = find_files(given.files, given.manifest);
    if (batch.files.empty()) {
        throw core::UsageError("usage", "no files", {}, "name files, a pattern, or a --manifest");
    }
    const postproc::LoadsOptions options = loads_options(given);
    std::vector<postproc::LoadsCase> cases;
    for (std::size_t i = 0; i < batch.files.size(); ++i) {
        const auto& file = batch.files[i];
        shell.progress().report(static_cast<double>(i) / static_cast<double>(batch.files.size()), file.path);
        postproc::ReadOptions read = given.field.read_options();
        read.zones = given.field.zones;
        read.surfaces_only = true;
        const postproc::Field field = postproc::read_field(file.path, read, shell.progress());
        shell.show(field.problems);
        cases.push_back({file.path, file.numbers, file.texts, postproc::loads(field, options, shell.progress()), {}, {}});
        shell.show(cases.back().loads.problems);
    }
    const int verdict = given.check.empty() ? static_cast<int>(done) : check(shell, cases, core::parse_in(given.check, "1"));
    if (!given.mesh_study.empty()) {
        cases = postproc::mesh_studies(cases, given.mesh_study);
        for (const auto& one : cases) {
            for (const auto& [name, study] : one.meshes) {
                shell.detail(one.file + ": " + name + ": " + study.text);
            }
        }
    }
    const bool table = batch.files.size() > 1 || !given.manifest.empty() || !given.out.empty();
    if (!given.out.empty()) {
        core::write_csv(given.out, postproc::loads_table(cases, batch.number_units));
        shell.info("wrote " + given.out);
    }
    if (shell.json) {
        shell.print_json(table ? postproc::loads_table_json(cases) : nlohmann::json(cases.front().loads));
    } else if (!table) {
        print(shell, cases.front().loads);
    } else if (given.out.empty()) {
        std::string text = core::write_csv(postproc::loads_table(cases, batch.number_units));
        text.pop_back();
        shell.print(text);
    }
    return verdict;
}

}  // namespace

void add_loads_command(CLI::App& app, Shell& shell) {
    auto* command = app.add_subcommand("loads", "forces and moments on a body, pressure and viscous part, per zone");
    auto o = std::make_shared<Options>();
    command->add_option("files", o->files, "CFD files, or patterns such as 'fields/{variant}-h{gap:mm}-p{pitch:deg}.csv'");
    command->add_option("--manifest", o->manifest, "table with a column `file`; its other columns are the conditions")->check(CLI::ExistingFile);
    command->add_option("-o,--out", o->out, "write a table (CSV) with one row a file");
    command->add_option("--reference", o->reference, "point of the moments \"x,y,z\" in the file's axes (default: the centre of the base)");
    command->add_option("--base", o->base, "zone whose centre is the default reference")->capture_default_str();
    command->add_option("--symmetry", o->symmetry, "half model: normal axis of its plane, with its place if not 0: y, or y=0.1");
    command->add_option("--forward", o->forward, "axis of the file that looks forward")->capture_default_str();
    command->add_option("--up", o->up, "axis of the file that looks up")->capture_default_str();
    command->add_option("--fluid", o->fluid, "where normals point: automatic, file (into the fluid), reversed")->check(CLI::IsMember({"automatic", "file", "reversed"}))->capture_default_str();
    command->add_option("--reference-pressure", o->reference_pressure, "taken from all pressures (\"101325 Pa\")");
    command->add_option("--density", o->density, "for coefficients, and for files that hold p/rho");
    command->add_option("--speed", o->speed, "for coefficients");
    command->add_option("--length", o->length, "for coefficients (default: of the bounding box)");
    command->add_option("--width", o->width, "for coefficients");
    command->add_option("--height", o->height, "for coefficients");
    command->add_option("--mesh-study", o->mesh_study, "condition with the number of cells: cases that differ in it alone become one, with NAME_sigma")->type_name("COLUMN");
    command->add_option("--check", o->check, "compare with the loads that the manifest states; exit code 4 when further apart than this share of the force (0.01, \"1 %\")");
    command->add_option("--stations", o->stations, "running integral along the body in so many steps (--json)")->check(CLI::Range(0, 10000));
    command->add_flag("--accept-problems", o->accept_problems, "go on although the file has errors such as faces without area");
    o->field.add_to(*command);
    command->footer(
        "Examples:\n"
        "  underbody loads body.csv --symmetry y\n"
        "  underbody loads body.csv --zones 'hull*,base' --reference \"0,0,5 mm\" --json\n"
        "  underbody loads case.cas.h5 --density \"998 kg/m^3\" --speed \"0.5 m/s\" --length \"203.2 mm\"\n"
        "  underbody loads 'fields/{variant}-h{gap:mm}-p{pitch:deg}.csv' --symmetry y --out loads.csv\n"
        "  underbody loads --manifest forces.csv --symmetry y --check 0.01\n"
        "  underbody loads --manifest forces.csv --symmetry y --mesh-study cells --out loads.csv");
    shell.on(command, [&shell, o] { return run(shell, *o); });
}

}  // namespace underbody::studio
