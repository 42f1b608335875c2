// Our loads against the solver's own report of them.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/engine.h"

namespace underbody::cases {

namespace {

/// The row of the loads that a row of the report is about: by file name first, else by all conditions they share.
std::optional<std::size_t> find_row(const core::Table& loads, const core::Table& report, std::size_t row) {
    if (const auto* file = report.find("file"); file != nullptr && file->is_text()) {
        const std::string stem = std::filesystem::path(file->text[row]).stem().string();
        const auto& names = loads.text("case");
        const auto found = std::find(names.begin(), names.end(), stem);
        return found == names.end() ? std::nullopt : std::optional<std::size_t>(found - names.begin());
    }
    for (std::size_t i = 0; i < loads.rows(); ++i) {
        bool same = true;
        for (const auto& column : report.columns()) {
            const auto* mine = loads.find(column.name);
            if (mine == nullptr || column.name.ends_with("_force") || column.name.ends_with("_moment")) {
                continue;
            }
            same = same && (column.is_text() ? mine->is_text() && mine->text[i] == column.text[row]
                                             : !mine->is_text() && std::abs(mine->numbers[i] - column.numbers[row]) <=
                                                                       1e-6 * std::abs(column.numbers[row]) + 1e-12);
        }
        if (same) {
            return i;
        }
    }
    return std::nullopt;
}

/// The size that a force's error is measured by: the resultant of lift and drag; of a moment, that times the length.
double size_of(const core::Table& report, std::size_t row, const std::string& quantity, double length) {
    double squares = 0;
    for (const char* name : {"lift_force", "drag_force", "side_force"}) {
        if (const auto* column = report.find(name); column != nullptr && std::isfinite(column->numbers[row])) {
            squares += column->numbers[row] * column->numbers[row];
        }
    }
    if (squares == 0) {
        squares = report.numbers(quantity)[row] * report.numbers(quantity)[row];
    }
    return std::sqrt(squares) * (quantity.ends_with("_moment") ? length : 1);
}

bool fits(const Engine& engine, const std::string& name, const Conditions& where) {
    const auto chosen = engine.study.select(where);
    return std::any_of(chosen.begin(), chosen.end(), [&](const Case* entry) { return entry->name == name; });
}

nlohmann::json verify(const Engine& engine, const VerifySpec& spec, const core::Table& report) {
    const core::Table& loads = engine.results.loads;
    const double length = engine.study.reference.number("length").value_or(1);
    nlohmann::json rows = nlohmann::json::array();
    double worst = 0;
    std::string worst_case;
    std::size_t failed = 0;
    for (std::size_t row = 0; row < report.rows(); ++row) {
        const auto mine = find_row(loads, report, row);
        if (!mine || !fits(engine, loads.text("case")[*mine], spec.where)) {
            continue;
        }
        for (const auto& quantity : spec.quantities) {
            const double theirs = report.numbers(quantity)[row];
            const double ours = loads.numbers(quantity)[*mine];
            const double size = size_of(report, row, quantity, length);
            const double error = std::abs(ours - theirs) / size;
            // The field is the last iteration, the report the mean of many: what a run swings by is no error of ours.
            const auto* scatter = report.find(quantity + "_scatter");
            const double swing = scatter != nullptr && std::isfinite(scatter->numbers[row]) ? 2 * scatter->numbers[row] / size : 0;
            const std::string name = loads.text("case")[*mine];
            rows.push_back({{"case", name}, {"quantity", quantity}, {"ours", ours}, {"solver", theirs}, {"error", error}, {"swing", swing}});
            failed += error <= spec.tolerance + swing ? 0 : 1;  // NaN fails too
            if (!(error - swing <= worst)) {
                worst = error - swing;
                worst_case = name + ", " + quantity;
            }
        }
    }
    return {{"rows", rows}, {"worst", worst}, {"worst_case", worst_case}, {"failed", failed}, {"tolerance", spec.tolerance}};
}

}  // namespace

void run_verifications(Engine& engine) {
    for (const auto& spec : engine.study.verifications) {
        const std::string& name = spec.name;
        try {
            const core::Table report = core::read_csv(spec.table);
            Key key("verify", {"cases"});
            key.add(engine.hash_of(spec.table)).add(core::write_csv(engine.results.loads)).add(spec.tolerance).add(spec.where);
            for (const auto& quantity : spec.quantities) {
                key.add(quantity);
            }
            const auto made = engine.make("verify", name, key, [&] {
                const nlohmann::json document = verify(engine, spec, report);
                if (document.at("rows").empty()) {
                    throw core::InputError("missing", "no row is about a case of this study", {spec.table.string(), {}, {}, {}});
                }
                return document.dump();
            });
            if (made) {
                engine.add_document("verify/" + name, *made);
            }
        } catch (const core::InputError& error) {
            engine.fail("verify", name, error.what());
        }
    }
}

}  // namespace underbody::cases
