// Force tables out of loads: fit, equilibria, plots, exports; and tables laid over each other.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/equilibria.h"
#include "surrogates/tables/exports/export.h"
#include "surrogates/tables/figures.h"
#include "surrogates/tables/force_table.h"

namespace underbody::cases {

namespace {

Key table_key(const TableSpec& spec, const core::Table& points) {
    Key key("table", {"surrogates/tables"});
    key.add(spec.name).add(spec.quantity).add(core::write_csv(points)).add(spec.net_weight.value_or(std::nan(""))).add(spec.virtual_mass);
    for (const auto& axis : spec.axes) {
        key.add(axis);
    }
    return key;
}

tables::ForceTable fitted(const TableSpec& spec, const core::Table& points) {
    tables::FitOptions options;
    options.axes = spec.axes;
    return tables::ForceTable::fit(points, spec.quantity, options);
}

tables::EquilibriumOptions equilibrium_options(const TableSpec& spec) {
    tables::EquilibriumOptions options;
    options.net_weight = spec.net_weight.value_or(0);
    options.virtual_mass = spec.virtual_mass;
    return options;
}

std::string compute_table(const TableSpec& spec, const core::Table& points) {
    const tables::ForceTable table = fitted(spec, points);
    nlohmann::json document;
    if (spec.net_weight) {
        tables::to_json(document, tables::equilibria(table, equilibrium_options(spec)));
    }
    document["quantity"] = spec.quantity;
    document["kind"] = table.kind();
    document["points"] = core::write_csv(points);
    document["remarks"] = nlohmann::json::array({"Fitted by " + table.kind() + " through " + std::to_string(points.rows()) + " points."});
    for (const auto& remark : table.remarks()) {
        document["remarks"].push_back(remark.message);
    }
    document["axes"] = nlohmann::json::array();
    for (const auto& axis : table.axes()) {
        document["axes"].push_back({{"name", axis.name}, {"unit", axis.unit}, {"lower", axis.lower}, {"upper", axis.upper}});
    }
    return document.dump();
}

std::string ending_of(const std::string& format) {
    std::vector<std::string> known;
    for (const auto& candidate : tables::export_formats()) {
        if (candidate.name == format) {
            return candidate.ending;
        }
        known.push_back(candidate.name);
    }
    throw core::InputError("name", "unknown export format '" + format + "'", {}, core::did_you_mean(format, known));
}

/// Writes the exports beside the report and names them in the document.
void write_exports(Engine& engine, const TableSpec& spec, const core::Table& points, const Key& key, nlohmann::json& document) {
    document["exports"] = nlohmann::json::array();
    for (const auto& format : spec.exports) {
        std::string file = spec.name;
        std::replace_if(file.begin(), file.end(), [](char c) { return c == ' ' || c == ','; }, '_');
        const std::string ending = ending_of(format);
        Key export_key("export", {"surrogates/tables"});
        export_key.add(key.digest()).add(format);
        const auto bytes = engine.make("export", spec.name + " as " + format, export_key, [&] {
            const core::TemporaryFolder folder;
            const auto path = folder.path() / (file + ending);
            tables::ExportOptions options;
            options.name = file;
            tables::export_table(fitted(spec, points), format, path, options, engine.progress);
            return core::read_file(path);
        });
        if (bytes) {
            const std::string relative = "exports/" + file + ending;
            if (engine.options.write_report) {
                Engine::write_if_changed(engine.report_folder() / relative, *bytes);
            }
            document["exports"].push_back({{"format", format}, {"file", relative}});
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
    const Key key = table_key(spec, points);
    const auto made = engine.make("table", spec.name, key, [&] { return compute_table(spec, points); });
    if (!made) {
        return;
    }
    nlohmann::json document = nlohmann::json::parse(*made);
    try {
        write_exports(engine, spec, points, key, document);
    } catch (const core::InputError& error) {
        engine.fail("export", spec.name, error.what());
    }
    engine.add_document("table/" + spec.name, document.dump());
    engine.figure("table/" + spec.name, key, [&] {
        const tables::ForceTable table = fitted(spec, points);
        tables::FigureOptions options;
        if (spec.net_weight) {
            options.equilibria = equilibrium_options(spec);
        }
        options.title = spec.name + " (" + spec.where.label() + ")";
        return tables::figure(table, options);
    });
}

/// What a designer asks of underbodies that are laid over each other.
struct Measure {
    std::string name;
    std::string unit;
    double value;
};

std::vector<Measure> measures(const tables::ForceTable& table) {
    const auto& axis = table.axes().front();
    double steepest = 0;
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    constexpr int samples = 400;
    for (int i = 0; i <= samples; ++i) {
        const double h = axis.lower + (axis.upper - axis.lower) * i / samples;
        double slope = 0;
        const double value = table.value(&h, &slope);
        steepest = std::max(steepest, -slope);
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
    }
    return {{"steepest restoring slope", "N/m", steepest}, {"strongest lift", "N", highest}, {"deepest dip of lift", "N", -lowest}};
}

std::string compute_comparison(const CompareSpec& spec,
                               const std::vector<std::pair<std::string, tables::ForceTable>>& compared) {
    nlohmann::json rows = nlohmann::json::array();
    const auto first = measures(compared.front().second);
    for (std::size_t m = 0; m < first.size(); ++m) {
        std::size_t best = 0;
        for (std::size_t i = 1; i < compared.size(); ++i) {
            best = measures(compared[i].second)[m].value > measures(compared[best].second)[m].value ? i : best;
        }
        Measure measure = measures(compared[best].second)[m];
        measure.value = measure.name == "deepest dip of lift" ? -measure.value : measure.value;
        rows.push_back({{"measure", measure.name}, {"table", spec.tables[best]}, {"value", measure.value},
                        {"text", core::format_number(measure.value, 3) + " " + measure.unit}});
    }
    // Beyond their errors, over the range that both have.
    nlohmann::json remarks = nlohmann::json::array();
    for (std::size_t i = 1; i < compared.size(); ++i) {
        const auto& a = compared.front().second;
        const auto& b = compared[i].second;
        const double lower = std::max(a.axes()[0].lower, b.axes()[0].lower);
        const double upper = std::min(a.axes()[0].upper, b.axes()[0].upper);
        int beyond = 0;
        constexpr int samples = 200;
        for (int k = 0; k <= samples && upper > lower; ++k) {
            const std::array<double, 1> h = {lower + (upper - lower) * k / samples};
            const auto va = a.at(h);
            const auto vb = b.at(h);
            beyond += std::abs(va.value - vb.value) > 2 * std::hypot(va.sigma, vb.sigma) ? 1 : 0;
        }
        remarks.push_back("'" + spec.tables.front() + "' and '" + spec.tables[i] + "' differ by more than twice their errors over " +
                          std::to_string(100 * beyond / (samples + 1)) + " % of the gaps from " +
                          core::format_number(1e3 * lower, 3) + " to " + core::format_number(1e3 * upper, 3) + " mm.");
    }
    return nlohmann::json({{"rows", rows}, {"remarks", remarks}}).dump();
}

void run_comparison(Engine& engine, const CompareSpec& spec) {
    std::vector<std::pair<std::string, tables::ForceTable>> compared;
    Key key("compare", {"surrogates/tables", "cases"});
    try {
        for (const auto& name : spec.tables) {
            const TableSpec& table = *engine.study.find_table(name);
            const core::Table points = table_points(table, engine.results);
            key.add(name).add(table_key(table, points).digest());
            compared.emplace_back(name, fitted(table, points));
            if (compared.back().second.axes().size() != 1) {
                throw core::InputError("range", "the table '" + name + "' has more than one axis: only curves can be laid over each other");
            }
        }
    } catch (const core::InputError& error) {
        engine.fail("compare", spec.name, error.what());
        return;
    }
    if (compared.empty()) {
        return;
    }
    if (const auto made = engine.make("compare", spec.name, key, [&] { return compute_comparison(spec, compared); })) {
        engine.add_document("compare/" + spec.name, *made);
        engine.figure("compare/" + spec.name, key, [&] { return tables::comparison_figure(compared); });
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
