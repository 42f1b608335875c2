#include "cases/report_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <unordered_set>

#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "surrogates/dynamics/theory/theory.h"

namespace underbody::cases {

namespace {

using nlohmann::json;

/// "variant" -> "variant"; numbers with the units that people read.
struct Shown {
    std::string name, from, to, title;
};

std::string number(double value, int digits = 4) {
    return std::isfinite(value) ? core::format_number(value, digits) : "-";
}

std::optional<json> document(const StudyResults& results, const std::string& key) {
    const std::string* text = results.document(key);
    return text != nullptr ? std::optional<json>(json::parse(*text)) : std::nullopt;
}

std::vector<Shown> condition_columns(const core::Table& loads) {
    std::vector<Shown> columns;
    for (const auto& column : loads.columns()) {
        const bool measured = column.name.ends_with("_force") || column.name.ends_with("_moment");
        if (column.is_text() && column.name != "case" && column.name != "settled") {
            columns.push_back({column.name, "", "", column.name});
        } else if (!column.is_text() && core::find_quantity(column.name) != nullptr && !measured) {
            const std::string to = std::string(core::told_unit_of(column.name, column.unit));
            columns.push_back({column.name, column.unit, to, column.name + (to == "1" ? "" : " (" + to + ")")});
        }
    }
    return columns;
}

/// By words, then by numbers, then by name.
std::vector<std::size_t> ordered_rows(const core::Table& loads, const std::vector<Shown>& columns) {
    std::vector<std::size_t> rows(loads.rows());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
        for (const bool words : {true, false}) {
            for (const auto& column : columns) {
                const core::Column& c = *loads.find(column.name);
                if (c.is_text() == words && (words ? c.text[a] != c.text[b] : c.numbers[a] != c.numbers[b])) {
                    return words ? c.text[a] < c.text[b] : c.numbers[a] < c.numbers[b];
                }
            }
        }
        return loads.text("case")[a] < loads.text("case")[b];
    });
    return rows;
}

}  // namespace

std::map<std::string, double> load_errors(const Study& study, const StudyResults& results,
                                          const std::string& quantity) {
    std::map<std::string, double> errors;
    for (const auto& spec : study.tables) {
        const bool of_cases = spec.quantity == quantity && spec.shape.empty();
        const TableResult* table = of_cases ? find_result(results.tables, spec.name) : nullptr;
        if (table == nullptr) {
            continue;
        }
        const core::Column* sigma = table->points.find(quantity + "_sigma");
        for (std::size_t row = 0; sigma != nullptr && row < table->points.rows(); ++row) {
            if (std::isfinite(sigma->numbers[row])) {
                double& known = errors[table->points.text("case")[row]];
                known = std::max(known, sigma->numbers[row]);
            }
        }
    }
    return errors;
}

namespace {

/// A load of all cases and what is known of its error.
struct ShownLoad {
    Shown shown;
    std::map<std::string, double> errors;  ///< by case; empty: of none
};

/// "12.3", with its error behind it where that of any case is known.
void add_loads(const core::Table& loads, std::size_t row, const std::vector<ShownLoad>& forces,
               std::vector<std::string>& cells) {
    double size = 0;  // beside it rounding is nothing
    for (const auto& force : forces) {
        const core::Column* c = loads.find(force.shown.name);
        size = std::max(size, c == nullptr || !std::isfinite(c->numbers[row]) ? 0.0 : std::abs(c->numbers[row]));
    }
    for (const auto& [shown, errors] : forces) {
        const core::Column* c = loads.find(shown.name);
        const double value = c == nullptr ? std::nan("") : c->numbers[row];
        cells.push_back(std::abs(value) < 1e-9 * size ? "0" : number(core::convert(value, shown.from, shown.to)));
        if (!errors.empty()) {
            const auto known = errors.find(loads.text("case")[row]);
            cells.push_back(known == errors.end() ? "-"
                                                  : number(core::convert(known->second, shown.from, shown.to), 2));
        }
    }
}

/// How closed the surface was and how settled the solution.
void add_quality(const core::Table& loads, std::size_t row, std::vector<std::string>& cells) {
    const core::Column* closure = loads.find("closure");
    // Rounding is no opening.
    cells.push_back(closure == nullptr                       ? "-"
                    : std::abs(closure->numbers[row]) < 1e-9 ? "0"
                                                             : number(closure->numbers[row], 3));
    const core::Column* settled = loads.find("settled");
    cells.push_back(settled != nullptr && settled->is_text() ? settled->text[row] : "unknown");
}

}  // namespace

namespace {

/// Which error the list shows where tables of one quantity take different ones for one case; empty: they do not.
std::string which_error(const Study& study, const StudyResults& results, const std::string& quantity) {
    std::map<std::string, double> first;  // by case
    std::string names;
    bool differ = false;
    for (const auto& spec : study.tables) {
        const bool of_cases = spec.quantity == quantity && spec.shape.empty();
        const TableResult* table = of_cases ? find_result(results.tables, spec.name) : nullptr;
        const core::Column* sigma = table == nullptr ? nullptr : table->points.find(quantity + "_sigma");
        if (sigma == nullptr) {
            continue;
        }
        names += (names.empty() ? "'" : ", '") + spec.name + "'";
        for (std::size_t row = 0; row < table->points.rows(); ++row) {
            const double error = sigma->numbers[row];
            const auto [known, fresh] = first.emplace(table->points.text("case")[row], error);
            differ = differ || (!fresh && std::abs(known->second - error) > 1e-6 * std::abs(error));
        }
    }
    return differ ? "The error of " + quantity + " is the largest that the tables " + names +
                        " take for the case; each has its own. "
                  : "";
}

}  // namespace

ReportTable loads_of_all_cases(const Study& study, const StudyResults& results) {
    const core::Table& loads = results.loads;
    const std::vector<Shown> conditions = condition_columns(loads);
    std::vector<ShownLoad> forces;
    ReportTable table;
    table.header = {"case"};
    for (const auto& column : conditions) {
        table.header.push_back(column.title);
    }
    for (const Shown& force : {Shown{"lift_force", "N", "N", "lift (N)"}, Shown{"drag_force", "N", "N", "drag (N)"},
                               Shown{"pitch_moment", "N m", "mN m", "pitch moment (mN m)"}}) {
        forces.push_back({force, load_errors(study, results, force.name)});
        table.caption += which_error(study, results, force.name);
        table.header.push_back(force.title);
        if (!forces.back().errors.empty()) {
            table.header.push_back("± (" + force.to + ")");
        }
    }
    table.header.insert(table.header.end(), {"closure", "solution"});
    std::unordered_set<std::string> warned;
    for (const auto& one : results.case_loads) {
        if (!one.warnings.empty()) {
            warned.insert(one.name);
        }
    }
    if (!warned.empty()) {
        table.header.emplace_back("");
    }
    for (const std::size_t row : ordered_rows(loads, conditions)) {
        const std::string& name = loads.text("case")[row];
        std::vector<std::string> cells{name};
        for (const auto& column : conditions) {
            const core::Column& c = *loads.find(column.name);
            cells.push_back(c.is_text() ? c.text[row] : number(core::convert(c.numbers[row], column.from, column.to)));
        }
        add_loads(loads, row, forces, cells);
        add_quality(loads, row, cells);
        if (!warned.empty()) {
            cells.emplace_back(warned.contains(name) ? "see the warnings" : "");
        }
        table.rows.push_back(std::move(cells));
    }
    return table;
}

ReportTable films_at_equilibria(const Study& study, const StudyResults& results, const TableSpec& table) {
    ReportTable films;
    if (table.quantity != "lift_force") {
        return films;
    }
    const auto variant = table.where.text("variant");
    std::optional<json> base;
    std::string body;
    for (const auto& spec : study.bodies) {
        const auto found = !variant || *variant == spec.name ? document(results, "body/" + spec.name) : std::nullopt;
        if (found && found->contains("elliptic_base") && (!base || variant)) {
            base = found->at("elliptic_base");
            body = spec.name;
        }
    }
    const TableResult* found = find_result(results.tables, table.name);
    if (!base || found == nullptr) {
        return films;
    }
    const std::vector<core::ClosedForm> forms = dynamics::film_forms();
    const core::ClosedForm& squeeze = core::find_closed_form(forms, "squeeze");
    for (const auto& point : found->equilibria) {
        const auto text = [](double value) { return core::format_number(value, 17); };
        std::vector<std::string> inputs = {"half_length=" + text(base->at("half_length")),
                                           "half_width=" + text(base->at("half_width")), "gap=" + text(point.gap)};
        const auto stated = range_in_cases(table, results, "density");
        if (const auto density = stated && stated->first == stated->second ? std::optional(stated->first)
                                                                           : study.reference.number("density")) {
            inputs.push_back("density=" + text(*density));
        }
        const auto values = core::closed_form_values(squeeze, inputs);
        const auto result = squeeze.evaluate(values);
        if (result.valid()) {
            films.rows.push_back({number(1e3 * point.gap, 3), point.stable ? "stable" : "unstable",
                                  number(result["damping"], 3), number(result["added_mass"], 3),
                                  number(point.stiffness, 3)});
        }
    }
    films.header = {"gap (mm)", "kind", "squeeze damping (N s/m)", "added mass of the film (kg)",
                    "stiffness out of CFD (N/m)"};
    films.caption = "Thin-film theory for the base of '" + body + "' beside the CFD: " + squeeze.formula +
                    ". Steady CFD has neither; both hold where the gap is below a tenth of the half width, other gaps "
                    "are left out.";
    return films;
}

}  // namespace underbody::cases
