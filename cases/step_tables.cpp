// Force tables out of loads: fit, equilibria, plots, exports; and tables laid over each other.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "cases/export_files.h"
#include "core/counted.h"
#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/analysis/compare.h"
#include "surrogates/tables/analysis/equilibria.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/exports/export.h"
#include "surrogates/tables/fit/exact_points.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/points/set_points.h"

namespace underbody::cases {

namespace {

namespace fs = std::filesystem;

Key table_key(const std::string& kind, const TableSpec& spec, const core::Table& points) {
    Key key(kind, {"surrogates/tables"});
    key.add("quantity", spec.quantity).add("points", digest_of(points));
    for (const std::string& comment : points.comments) {
        key.add("said of its points", comment);
    }
    key.add("net_weight", spec.net_weight.value_or(std::nan("")))
        .add("virtual_mass", spec.virtual_mass)
        .add("fit", spec.fit);
    for (const auto& axis : spec.axes) {
        key.add("axis", axis);
    }
    if (!spec.shape.empty()) {
        key.through("shape loads", spec.name);
    } else {
        for (const auto& name : points.text("case")) {
            key.through("loads", name);
        }
    }
    if (!spec.mesh_uncertainty.empty()) {
        key.through("mesh", spec.mesh_uncertainty);
    }
    return key;
}

tables::ForceTable fitted(const TableSpec& spec, const core::Table& points) {
    return tables::ForceTable::fit(points, spec.quantity, fit_options(spec));
}

tables::EquilibriumOptions equilibrium_options(const TableSpec& spec) {
    tables::EquilibriumOptions options;
    options.net_weight = spec.net_weight.value_or(0);
    options.virtual_mass = spec.virtual_mass;
    options.draws = tables::usual_draws;
    return options;
}

/// A study has no place for the value of another axis: `where` of a table over the gap alone says it.
tables::Equilibria balance(const TableSpec& spec, const tables::ForceTable& table) {
    try {
        return tables::equilibria(table, equilibrium_options(spec));
    } catch (const core::UsageError& error) {
        if (table.axes().size() < 2) {
            throw;
        }
        throw core::UsageError(error.kind(), error.message(), error.place(),
                               "this table without net_weight, and one over " + table.axes().front().name +
                                   " alone with it, whose where says the rest");
    }
}

std::string compute_table(const TableSpec& spec, const core::Table& points, const tables::ForceTable& table,
                          const std::vector<std::string>& mixed) {
    nlohmann::json document;
    core::Problems of_equilibria;
    if (spec.net_weight) {
        const tables::Equilibria found = balance(spec, table);
        tables::to_json(document, found);
        of_equilibria = found.remarks;
    }
    document["quantity"] = spec.quantity;
    document["kind"] = table.kind();
    document["points"] = core::write_csv(points);
    document["remarks"] = nlohmann::json::array(
        {"Fitted by " + table.kind() + " through " + core::counted(points.rows(), "point") + "."});
    for (const auto& remark : mixed) {
        document["remarks"].push_back(remark);
    }
    for (const auto& remark : of_equilibria) {
        if (remark.severity != core::Problem::Severity::note) {
            document["remarks"].push_back(remark.message);
        }
    }
    bool says_exact = false;
    for (const auto& remark : table.remarks()) {
        document["remarks"].push_back(remark.message);
        says_exact = says_exact || tables::says_exact(remark.message);
    }
    if (const std::string text = tables::unstated_errors(table);
        !text.empty() && !(says_exact && tables::says_exact(text))) {
        document["remarks"].push_back(text);
    }
    document["axes"] = nlohmann::json::array();
    for (const auto& axis : table.axes()) {
        document["axes"].push_back(
            {{"name", axis.name}, {"unit", axis.unit}, {"lower", axis.lower}, {"upper", axis.upper}});
    }
    return document.dump();
}

using SharedTable = Shared<tables::ForceTable>;

/// The files of an export as one value (exported_files).
std::string packed(const std::vector<fs::path>& files) {
    nlohmann::json head = nlohmann::json::array();
    std::string bytes;
    for (const auto& file : files) {
        const std::string content = core::read_file(file);
        head.push_back({{"file", file.filename().string()}, {"size", content.size()}});
        bytes += content;
    }
    return head.dump() + "\n" + bytes;
}

/// Their names; with `folder`, each is written there.
std::vector<std::string> unpacked(const std::string& value, const std::optional<fs::path>& folder) {
    std::vector<std::string> names;
    for (const auto& [name, bytes] : exported_files(value)) {
        names.push_back(name);
        if (folder) {
            Engine::write_if_changed(*folder / name, std::string(bytes));
        }
    }
    return names;
}

std::string compute_export(const TableSpec& spec, const std::string& format, const tables::ForceTable& table,
                           const Made& made, core::Progress& progress) {
    const Scratch folder;
    tables::ExportOptions options;
    options.name = export_name(spec.name);
    options.provenance = {made.origin_line()};
    const auto path = folder.path() / export_file(spec.name, format);
    return packed(tables::export_table(table, format, path, options, progress).files);
}

/// Writes the exports beside the report and names them in the document. `table`: the result that they hold.
void write_exports(Engine& engine, const TableSpec& spec, SharedTable& fit, const Made& table,
                   nlohmann::json& document) {
    document["exports"] = nlohmann::json::array();
    for (const auto& format : spec.exports) {
        Key key("export", {"surrogates/tables"});
        key.from(table).add("format", format).add("name", export_file(spec.name, format));
        const auto made = engine.make("export", spec.name + " as " + format, key,
                                      [&] { return compute_export(spec, format, fit.get(), table, engine.progress); });
        if (!made) {
            continue;
        }
        const bool written = engine.options.write_report && engine.mode == Engine::Mode::compute;
        const auto names =
            unpacked(engine.value(*made), written ? std::optional(engine.report_folder() / "exports") : std::nullopt);
        for (const auto& name : names) {
            document["exports"].push_back({{"format", format}, {"file", "exports/" + name}});
        }
    }
}

void run_table(Engine& engine, const TableSpec& spec) {
    core::Table points;
    try {
        points = table_points(spec, engine.results);
    } catch (const core::InputError& error) {
        engine.fail("table", spec.name, error.what());
        return;
    }
    SharedTable table(engine.states(), [&] { return fitted(spec, points); });
    Key key = table_key("table", spec, points);
    auto mixed = mixed_conditions(spec, engine.results);
    for (const std::string& comment : points.comments) {  // warnings among them are remarks of the table itself
        if (!comment.starts_with(tables::warning_comment)) {
            mixed.push_back(comment);
        }
    }
    for (const auto& remark : mixed) {
        key.add("remark", remark);
    }
    const auto made =
        engine.make("table", spec.name, key, [&] { return compute_table(spec, points, table.get(), mixed); });
    if (!made) {
        return;
    }
    nlohmann::json document = nlohmann::json::parse(engine.value(*made));
    try {
        write_exports(engine, spec, table, *made, document);
    } catch (const core::InputError& error) {
        engine.fail("export", spec.name, error.what());
    }
    engine.results.tables.push_back(table_result(spec.name, document));
    engine.add_document("table/" + spec.name, document.dump());
    key.from(*made).add("where", spec.where.label());
    engine.figure("table/" + spec.name, key, [&] {
        tables::FigureOptions options;
        if (spec.net_weight) {
            options.equilibria = equilibrium_options(spec);
        }
        options.title = spec.name + " (" + spec.where.label() + ")";
        return tables::figure(table.get(), options);
    });
}

/// What a designer asks of underbodies that are laid over each other.
std::vector<tables::Measure> measures_of(const tables::ForceTable& table) {
    using tables::Measure;
    if (tables::restores_along(table.quantity(), table.axes().front().name)) {
        return {Measure::restoring_slope, Measure::restoring_width, Measure::largest, Measure::smallest};
    }
    return {Measure::smallest, Measure::largest, Measure::lowest};
}

std::string shown_at(const tables::ForceTable& table, double value) {
    const auto& axis = table.axes().front();
    const std::string unit = tables::shown_unit(table, axis.name);
    return core::format_number(core::convert(value, axis.unit, unit), 4) + " " + unit;
}

/// "'B' less 'A': at most 0.12 +- 0.01 N, at 5 mm; beyond twice the joint error at 3 mm to 8 mm."
std::string difference_text(const tables::ForceTable& table, const tables::Difference& d) {
    std::string where;
    for (const auto& [from, to] : d.beyond_error) {
        where += (where.empty() ? "" : ", ") + shown_at(table, from) + (to > from ? " to " + shown_at(table, to) : "");
    }
    return "'" + d.second + "' less '" + d.first + "': at most " + core::format_number(d.largest, 3) + " ± " +
           (std::isfinite(d.sigma) ? core::format_number(d.sigma, 2) : "(no error known)") + " " + table.unit() +
           ", at " + shown_at(table, d.at) +
           (!std::isfinite(d.sigma) ? "; without errors of their points nothing says where they differ."
            : where.empty()         ? "; nowhere more than twice the joint error of the two."
                                    : "; more than twice the joint error of the two at " + where + ".");
}

std::string compute_comparison(const std::vector<std::pair<std::string, tables::ForceTable>>& compared) {
    const tables::ForceTable& first = compared.front().second;
    const std::string& axis = first.axes().front().name;
    const std::string noun = tables::noun_of(first.quantity());
    nlohmann::json document = {{"quantity", first.quantity()},
                               {"axis", axis},
                               {"rows", nlohmann::json::array()},
                               {"remarks", nlohmann::json::array()}};
    for (const auto measure : measures_of(first)) {
        tables::ComparisonOptions options;
        options.measure = measure;
        const auto result = tables::compare_tables(compared, options);
        const auto best = result.winner.empty() ? result.names.begin()
                                                : std::find(result.names.begin(), result.names.end(), result.winner);
        const auto i = static_cast<std::size_t>(best - result.names.begin());
        const bool slope = measure == tables::Measure::restoring_slope,
                   width = measure == tables::Measure::restoring_width;
        const bool restores = !(slope || width) || result.values[i] > 0;
        const std::string value =
            width ? shown_at(first, result.values[i]) : core::format_number(result.values[i], 3) + " " + result.unit;
        nlohmann::json row = {
            {"measure", slope || width ? result.measure : result.measure + " of the " + noun},
            {"table", restores ? nlohmann::json(*best) : nlohmann::json("none")},
            {"value", restores ? nlohmann::json(result.values[i]) : nlohmann::json()},
            {"sigma", result.errors[i]},
            {"unit", result.unit},
            {"beyond_error", result.beyond_error},
            {"text", !restores              ? "none restores"
                     : compared.size() == 1 ? value
                                            : value + (result.beyond_error ? "" : ", within the errors")}};
        for (std::size_t k = 0; k < result.names.size(); ++k) {
            row["values"].push_back(
                {{"table", result.names[k]}, {"value", result.values[k]}, {"sigma", result.errors[k]}});
        }
        document["rows"].push_back(row);
        if (document["rows"].size() == 1) {
            document["range"] = {result.lower, result.upper};
            document["remarks"].push_back("Compared over the " + axis + " that all of them have, " +
                                          shown_at(first, result.lower) + " to " + shown_at(first, result.upper) + ".");
            for (const auto& difference : result.differences) {
                document["remarks"].push_back(difference_text(first, difference));
            }
        }
    }
    return document.dump();
}

using Compared = std::vector<std::pair<std::string, tables::ForceTable>>;

Compared fitted_tables(const Engine& engine, const CompareSpec& spec) {
    Compared compared;
    for (const auto& name : spec.tables) {
        const TableSpec& table = *engine.study.find_table(name);
        compared.emplace_back(name, fitted(table, table_points(table, engine.results)));
        if (compared.back().second.axes().size() != 1) {
            throw core::InputError(
                "range", "the table '" + name + "' has more than one axis: only curves can be laid over each other");
        }
    }
    return compared;
}

void run_comparison(Engine& engine, const CompareSpec& spec) {
    if (spec.tables.empty()) {
        return;
    }
    Key key("compare", {"surrogates/tables"});
    try {
        for (const auto& name : spec.tables) {
            const TableSpec& table = *engine.study.find_table(name);
            key.add("table", name).add("of", table_key("table", table, table_points(table, engine.results)).digest());
            key.through("table", name);
        }
    } catch (const core::InputError& error) {
        engine.fail("compare", spec.name, error.what());
        return;
    }
    Shared<Compared> compared(engine.states(), [&] { return fitted_tables(engine, spec); });
    const auto made = engine.make("compare", spec.name, key, [&] { return compute_comparison(compared.get()); });
    if (made) {
        engine.add_document("compare/" + spec.name, engine.value(*made));
        key.from(*made);
        engine.figure("compare/" + spec.name, key, [&] { return tables::comparison_figure(compared.get()); });
    }
}

}  // namespace

void run_tables(Engine& engine) {
    for (const auto& spec : engine.study.tables) {
        run_table(engine, spec);
    }
}

void run_comparisons(Engine& engine) {
    for (const auto& spec : engine.study.comparisons) {
        run_comparison(engine, spec);
    }
}

}  // namespace underbody::cases
