// underbody probe FILE: values at points, on a line or a plane, the flow through the gap.
#include "postproc/probe/probe.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/field/field.h"
#include "postproc/field/kinematic.h"
#include "postproc/loads/loads.h"
#include "studio/cli/commands.h"
#include "studio/cli/field_options.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

struct ProbeArguments {
    std::string file, out, line, plane, points_file, forward = "+x", up = "+z", symmetry, base = "*base*", density;
    std::vector<std::string> points, arrays;
    int count = 101, rows = 0, gap = 0;
    bool on_surface = false;
    FieldOptions field;
};

postproc::Vector point_from(std::string_view text) {
    const auto parts = core::split(text, ',');
    if (parts.size() != 3) {
        throw core::UsageError("usage", "'" + std::string(text) + "' is no point", {},
                               "give x,y,z in m, or with units: \"0,0,5 mm\"");
    }
    return {core::parse_in(parts[0], "m"), core::parse_in(parts[1], "m"), core::parse_in(parts[2], "m")};
}

std::vector<postproc::Vector> points_from(std::string_view text, std::size_t count, const char* how) {
    std::vector<postproc::Vector> points;
    for (const auto part : core::split(text, ':')) {
        points.push_back(point_from(part));
    }
    if (points.size() != count) {
        throw core::UsageError("usage", "'" + std::string(text) + "' is not " + how, {}, "points are parted by ':'");
    }
    return points;
}

core::Table look(const postproc::Field& field, const ProbeArguments& given, Shell& shell) {
    postproc::ProbeOptions options;
    options.arrays = given.arrays;
    options.zones = given.field.zones;
    options.on_surface = given.on_surface;
    const int ways = (given.points.empty() ? 0 : 1) + (given.points_file.empty() ? 0 : 1) +
                     (given.line.empty() ? 0 : 1) + (given.plane.empty() ? 0 : 1) + (given.gap > 0 ? 1 : 0);
    if (ways != 1) {
        throw core::UsageError("usage", "say where to look, in one way", {},
                               "--point, --points, --line, --plane or --gap");
    }
    if (given.gap > 0) {
        postproc::GapOptions gap;
        gap.forward = postproc::axis_from(given.forward);
        gap.up = postproc::axis_from(given.up);
        gap.symmetry = given.symmetry;
        gap.zones = given.field.zones;
        gap.base = given.base;
        gap.stations = given.gap;
        if (!given.density.empty()) {
            gap.density = option_value("--density", given.density, "kg/m^3");
        }
        return postproc::gap_flow(field, gap, shell.progress());
    }
    if (!given.line.empty()) {
        const auto ends = points_from(given.line, 2, "two points");
        return postproc::probe_line(field, ends[0], ends[1], given.count, options, shell.progress());
    }
    if (!given.plane.empty()) {
        const auto corners = points_from(given.plane, 3, "three corners");
        const auto edge = [&](const postproc::Vector& to) {
            return postproc::Vector{to[0] - corners[0][0], to[1] - corners[0][1], to[2] - corners[0][2]};
        };
        return postproc::probe_plane(field, corners[0], edge(corners[1]), edge(corners[2]), given.count,
                                     given.rows > 0 ? given.rows : given.count, options, shell.progress());
    }
    std::vector<postproc::Vector> points;
    for (const auto& text : given.points) {
        points.push_back(point_from(text));
    }
    if (!given.points_file.empty()) {
        const core::Table table = core::read_csv(std::filesystem::path(given.points_file));
        for (std::size_t i = 0; i < table.rows(); ++i) {
            points.push_back({table.numbers("x")[i], table.numbers("y")[i], table.numbers("z")[i]});
        }
    }
    return postproc::probe_points(field, points, options, shell.progress());
}

nlohmann::json json_of(const core::Table& table) {
    nlohmann::json columns = nlohmann::json::array();
    for (const auto& column : table.columns()) {
        nlohmann::json values = nlohmann::json::array();
        for (const auto& text : column.text) {  // numbers whose unit nobody knows
            const auto value = core::parse_number(text);
            values.push_back(value ? nlohmann::json(*value) : nlohmann::json(nullptr));
        }
        for (const double value : column.numbers) {
            values.push_back(std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr));
        }
        columns.push_back({{"name", column.name}, {"unit", column.unit}, {"values", std::move(values)}});
    }
    return {{"rows", table.rows()}, {"columns", std::move(columns)}};
}

int run_probe(Shell& shell, const ProbeArguments& o) {
    shell.list_on_stdout = o.out.empty();
    postproc::ReadOptions read = o.field.read_options();
    auto field = shell.read_field(o.file, read);
    shell.show(field.problems);
    const auto density =
        o.density.empty() ? std::nullopt : std::optional<double>(option_value("--density", o.density, "kg/m^3"));
    if (!postproc::bring_to_pascal(field, density) && o.gap > 0) {
        shell.show_warning(o.file + ": pressure is over density here: --density \"998 kg/m^3\" gives it in the gap");
    }
    core::Table table = look(field, o, shell);
    shell.comment_warnings(table);
    shell.hand_over("values", [&] { return table; });
    if (!o.out.empty()) {
        core::write_csv(o.out, table);
        shell.info("wrote " + o.out);
    }
    if (shell.json) {
        shell.print_json(json_of(table));
    } else if (o.out.empty()) {
        std::string text = core::write_csv(table);
        text.pop_back();
        shell.print(text);
    }
    return done;
}

}  // namespace

void add_probe_command(CLI::App& app, Shell& shell) {
    auto* command = app.add_subcommand("probe", "values at points, on a line or a plane; what flows through the gap");
    auto o = std::make_shared<ProbeArguments>();
    command->add_option("file", o->file, "a CFD file")->required();
    command->add_option("--point", o->points, "a point \"x,y,z\" in the file's axes; may be repeated");
    command->add_option("--points", o->points_file, "a table with columns x, y, z")->check(CLI::ExistingFile);
    command->add_option("--line", o->line, "two ends: \"x,y,z:x,y,z\"");
    command->add_option("--plane", o->plane, "three corners: the first, the end across, the end along");
    command->add_option("--count", o->count, "points on the line, or across the plane")
        ->check(CLI::Range(2, 1000000))
        ->capture_default_str();
    command->add_option("--rows", o->rows, "points along the plane (default: as across)")
        ->check(CLI::Range(2, 1000000));
    command->add_option("--gap", o->gap, "flow through the gap at so many stations along the base")
        ->check(CLI::Range(1, 1000));
    command->add_option("--arrays", o->arrays, "arrays to look at; default all")
        ->delimiter(',')
        ->transform(trimmed_name);
    command->add_flag("--on-surface", o->on_surface, "the nearest place of the surfaces, though there is a volume");
    command->add_option("--symmetry", o->symmetry,
                        "half model: flows count both halves; normal axis of its plane, with its place if that is not "
                        "where the body is open: y, or y=0.1");
    command->add_option("--base", o->base, "zone above the gap")->capture_default_str();
    command->add_option("--forward", o->forward, "axis of the file that looks forward")->capture_default_str();
    command->add_option("--up", o->up, "axis of the file that looks up")->capture_default_str();
    command->add_option("--density", o->density, "for the mass flow, and for files that hold pressure over density");
    command->add_option("-o,--out", o->out, "write the table (CSV)");
    o->field.add_to(*command);
    command->footer(
        "Examples:\n"
        "  underbody probe case.cas.gz --line \"0,0,0:0,0,5 mm\" --count 51 --arrays velocity\n"
        "  underbody probe case.cas.gz --gap 9 --symmetry y --density \"998 kg/m^3\"\n"
        "  underbody probe body.csv --point \"0,0,5 mm\" --arrays pressure");
    shell.on(command, [&shell, o] { return run_probe(shell, *o); });
}

}  // namespace underbody::studio
