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

Key table_key(const std::string& kind, const TableSpec& spec, const core::Table& points) {
    Key key(kind, {"surrogates/tables"});
    key.add("quantity", spec.quantity).add("points", digest_of(points));
    key.add("net_weight", spec.net_weight.value_or(std::nan(""))).add("virtual_mass", spec.virtual_mass).add("fit", spec.fit);
    for (const auto& axis : spec.axes) {
        key.add("axis", axis);
    }
    for (const auto& name : points.text("case")) {
        key.through("loads", name);
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
    return options;
}

std::string compute_table(const TableSpec& spec, const core::Table& points, const tables::ForceTable& table) {
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

using SharedTable = Shared<tables::ForceTable>;

/// Writes the exports beside the report and names them in the document.
void write_exports(Engine& engine, const TableSpec& spec, SharedTable& table, const Key& key, nlohmann::json& document) {
    document["exports"] = nlohmann::json::array();
    for (const auto& format : spec.exports) {
        std::string file = spec.name;
        std::replace_if(file.begin(), file.end(), [](char c) { return c == ' ' || c == ','; }, '_');
        const std::string ending = ending_of(format);
        Key export_key = key;
        export_key.add("format", format).add("name", file).through("table", spec.name);
        const auto made = engine.make("export", spec.name + " as " + format, export_key, [&] {
            const Scratch folder;
            const auto path = folder.path() / (file + ending);
            tables::ExportOptions options;
            options.name = file;
            tables::export_table(table.get(), format, path, options, engine.progress);
            return core::read_file(path);
        });
        if (made) {
            const std::string relative = "exports/" + file + ending;
            if (engine.options.write_report && engine.mode == Engine::Mode::compute) {
                Engine::write_if_changed(engine.report_folder() / relative, engine.value(*made));
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
    SharedTable table(engine.states(), [&] { return fitted(spec, points); });
    Key key = table_key("table", spec, points);
    const auto made = engine.make("table", spec.name, key, [&] { return compute_table(spec, points, table.get()); });
    if (!made) {
        return;
    }
    nlohmann::json document = nlohmann::json::parse(engine.value(*made));
    try {
        write_exports(engine, spec, table, table_key("export", spec, points), document);
    } catch (const core::InputError& error) {
        engine.fail("export", spec.name, error.what());
    }
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

using Compared = std::vector<std::pair<std::string, tables::ForceTable>>;

Compared fitted_tables(const Engine& engine, const CompareSpec& spec) {
    Compared compared;
    for (const auto& name : spec.tables) {
        const TableSpec& table = *engine.study.find_table(name);
        compared.emplace_back(name, fitted(table, table_points(table, engine.results)));
        if (compared.back().second.axes().size() != 1) {
            throw core::InputError("range", "the table '" + name + "' has more than one axis: only curves can be laid over each other");
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
    const auto made = engine.make("compare", spec.name, key, [&] { return compute_comparison(spec, compared.get()); });
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
