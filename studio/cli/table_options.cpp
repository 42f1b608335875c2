#include "studio/cli/table_options.h"

#include <CLI/CLI.hpp>
#include <filesystem>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/shell.h"
#include "surrogates/dynamics/force_points.h"
#include "surrogates/tables/figures.h"
#include "surrogates/tables/select.h"

namespace underbody::studio {

void TableOptions::add_to(CLI::App& command) {
    command.add_option("table", file, "points as CSV: gap [mm], pitch [deg], ..., lift_force [N], lift_force_sigma [N], ...; or a JSON that 'export' wrote; or a model.toml: its forces, with the effects that change them")->required();
    command.add_option("--quantity", quantity, "column to use (default: lift_force, or the first force of the table)");
    command.add_option("--where", where, "rows to use, such as \"variant=ellipse, mesh=medium, speed=0.5\"; a|b takes either; of a model: what is held, such as speed=0.5m/s");
    command.add_option("--axes", axes, "columns that are axes, such as gap,pitch (default: all known ones that vary)");
    command.add_option("--kind", kind, "automatic | interpolation | gaussian_process | spline (auto, gp for short)")->capture_default_str();
    command.add_option("--range", range, "outside the points: clamp | refuse | extrapolate, for all axes or one by one: gap=refuse,pitch=clamp (default clamp, or what an exported table says)");
}

tables::FitOptions TableOptions::fit_options() const {
    tables::FitOptions options;
    const auto known = tables::fit_kind(kind);
    if (!known) {
        throw core::UsageError("kind", "there is no kind of table '" + kind + "'", {}, core::did_you_mean(kind, tables::fit_kinds()));
    }
    options.kind = *known;
    options.range = tables::parse_range_policies(range);
    for (const auto name : core::split(axes, ',')) {
        if (!core::trimmed(name).empty()) {
            options.axes.emplace_back(core::trimmed(name));
        }
    }
    return options;
}

namespace {

std::vector<std::string> quantities_of(const core::Table& table, const std::string& asked) {
    std::vector<std::string> names;
    for (const auto name : core::split(asked, ',')) {
        if (!core::trimmed(name).empty()) {
            names.emplace_back(core::trimmed(name));
        }
    }
    if (names.empty()) {
        names = tables::force_columns(table);
    }
    if (names.empty()) {
        throw core::InputError("missing", "the table has no force and no other column to fit", {table.source, {}, {}, {}},
                               "a force column is named lift_force [N], drag_force [N], pitch_moment [N m], ...");
    }
    return names;
}

}  // namespace

core::Table TableOptions::points(Shell& shell) const {
    if (std::filesystem::path(file).extension() != ".toml") {
        return tables::selected_rows(tables::read_points(file), where);
    }
    dynamics::Conditions held;
    for (const auto& [name, value] : read_assignments(where)) {
        held.set(name, value);
    }
    auto found = dynamics::force_points(dynamics::read_model(file), held);
    shell.show(found.remarks);
    return std::move(found.points);
}

tables::ForceTable TableOptions::fit(Shell& shell) const {
    const auto table = points(shell);
    auto fitted = tables::ForceTable::fit(table, quantities_of(table, quantity).front(), fit_options());
    shell.show(fitted.remarks());
    return fitted;
}

std::vector<tables::ForceTable> TableOptions::fit_all(Shell& shell, bool remarks) const {
    const auto table = points(shell);
    std::vector<tables::ForceTable> all;
    for (const auto& name : quantities_of(table, quantity)) {
        all.push_back(tables::ForceTable::fit(table, name, fit_options()));
        if (remarks) {
            shell.show(all.back().remarks());
        }
    }
    return all;
}

std::string shown(const tables::ForceTable& table, const std::string& quantity, const std::string& si, double value, int digits) {
    const std::string unit = tables::shown_unit(table, quantity);
    return core::format_number(core::convert(value, si, unit), digits) + " " + unit;
}

std::vector<std::pair<std::string, double>> read_assignments(const std::string& text) {
    std::vector<std::pair<std::string, double>> values;
    if (core::trimmed(text).empty()) {
        return values;
    }
    for (const auto& v : core::parse_assignments(text)) {
        values.emplace_back(v.name, v.value);
    }
    return values;
}

}  // namespace underbody::studio
