#include "postproc/loads/loads_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "core/batch_problems.h"
#include "core/units.h"
#include "postproc/loads/deviation.h"
#include "postproc/loads/loads_parts.h"

namespace underbody::postproc {

namespace {

/// Names in the order in which they first occur.
template <typename T>
std::vector<std::string> names_in(const std::vector<LoadsRow>& rows,
                                  std::vector<std::pair<std::string, T>> LoadsRow::*list) {
    std::vector<std::string> names;
    std::unordered_set<std::string> known;
    for (const auto& row : rows) {
        for (const auto& entry : row.*list) {
            if (known.insert(entry.first).second) {
                names.push_back(entry.first);
            }
        }
    }
    return names;
}

/// What each row has under a name.
template <typename T>
std::vector<T> column_of(const std::vector<LoadsRow>& rows, std::vector<std::pair<std::string, T>> LoadsRow::*list,
                         const std::string& name, const T& missing) {
    std::vector<T> values;
    values.reserve(rows.size());
    for (const auto& row : rows) {
        values.push_back(value_of(row.*list, name, missing));
    }
    return values;
}

std::string si_unit_of(const std::string& name, const std::string& written) {
    if (const auto* known = core::find_quantity(name)) {
        return known->unit;
    }
    if (name == "first_time" || name == "last_time") {
        return "s";
    }
    return written.empty() ? "1" : core::si_unit(written);
}

/// Every column that a table of loads may have.
const std::vector<LoadsColumn>& all_columns() {
    static const std::vector<LoadsColumn> columns = [] {
        LoadsResult whole;
        whole.coefficients.emplace();
        return table_columns(whole);
    }();
    return columns;
}

bool is_column(const std::string& name) {
    return name == "file" || name == "values_from" || name == "settled" || name == "depth" ||
           std::any_of(all_columns().begin(), all_columns().end(),
                       [&](const LoadsColumn& c) { return c.name == name; });
}

/// What means_in_time says of a mean.
constexpr std::array<std::string_view, 4> of_a_mean = {"samples", "first_time", "last_time", "correlation_time"};

/// Forces per metre and forces have no column in common.
void refuse_mixed_depths(const std::vector<LoadsCase>& cases) {
    for (const auto& one : cases) {
        if (one.loads.depth != cases.front().loads.depth) {
            const auto shown = [](const LoadsCase& c) {
                return "'" + c.file + "' " + (c.loads.depth.empty() ? "of a body" : c.loads.depth);
            };
            throw core::InputError(
                "mismatch",
                "the forces are those " + shown(cases.front()) + " and " + shown(one) + ": one table cannot hold both",
                {}, "make a table of each");
        }
    }
}

}  // namespace

bool is_result(std::string name) {
    for (bool cut = true; cut;) {
        cut = false;
        for (const std::string_view ending : {"_stated", "_sigma", "_scatter"}) {
            if (name.ends_with(ending)) {
                name.resize(name.size() - ending.size());
                cut = true;
            }
        }
    }
    return name != "file" &&
           (is_column(name) || std::find(of_a_mean.begin(), of_a_mean.end(), name) != of_a_mean.end());
}

std::vector<Comparison> compare_with_stated(const std::vector<LoadsCase>& cases, core::Problems& notes) {
    std::vector<Comparison> result;
    for (const auto& one : cases) {
        const auto stated = [&](const std::string& name) {
            const double value = value_of(one.numbers, name, 0.0);
            return std::isfinite(value) ? value : 0;
        };
        const LoadScale scale = load_scale(norm(one.loads.total.force), resultant(stated), one.loads.length);
        std::vector<std::string> missing;
        for (const auto& load : table_row(one.loads)) {
            if (!has(one.numbers, load.name) || load.name == "closure") {
                continue;
            }
            const double other = value_of(one.numbers, load.name, 0.0);
            if (!std::isfinite(other)) {
                missing.push_back(load.name);
                continue;
            }
            result.push_back({one.file,
                              load.name,
                              {},
                              load.value,
                              other,
                              deviation(load.value, other, load.unit == "N m", scale),
                              {}});
        }
        if (!missing.empty()) {
            notes.push_back({core::Problem::Severity::warning,
                             quoted(missing) + " is not stated of this case: not compared",
                             {one.file, {}, {}, {}}});
        }
    }
    return result;
}

/// Quantities that some case has, each with its sigma where one is stated.
std::vector<LoadsColumn> columns_of(const std::vector<LoadsRow>& rows) {
    std::unordered_set<std::string> there;
    for (const auto& name : names_in(rows, &LoadsRow::values)) {
        there.insert(name);
    }
    std::vector<LoadsColumn> columns;
    for (const auto& column : all_columns()) {
        if (there.count(column.name) == 0) {
            continue;
        }
        columns.push_back(column);
        if (there.count(column.name + "_sigma") != 0) {
            columns.push_back({column.name + "_sigma", column.unit});
        }
    }
    return columns;
}

/// A case as a row: its loads, each with its sigma where one is stated.
LoadsRow row_of(const LoadsCase& one) {
    LoadsRow row{one.texts, one.numbers, {}};
    for (const auto& column : table_columns(one.loads)) {
        row.values.emplace_back(column.name, column.value);
    }
    for (const auto& [name, sigma] : one.sigmas) {
        row.values.emplace_back(name + "_sigma", sigma);
    }
    return row;
}

/// Depth, solver or file that the numbers come from, how settled they are, and the file.
void add_origins(core::Table& table, const std::vector<LoadsCase>& cases) {
    std::vector<std::string> files;
    std::vector<std::string> origins;
    for (const auto& one : cases) {
        files.push_back(one.file);
        origins.push_back(one.loads.values_from);
        std::replace(origins.back().begin(), origins.back().end(), ',', ' ');
    }
    if (!cases.empty() && !cases.front().loads.depth.empty()) {
        table.add_text("depth", std::vector<std::string>(cases.size(), cases.front().loads.depth));
    }
    table.add_text("values_from", std::move(origins));
    if (!cases.empty()) {
        std::vector<std::string> verdicts;
        for (const auto& one : cases) {
            verdicts.push_back(to_string(one.settled.verdict));
        }
        table.add_text("settled", std::move(verdicts));
    }
    table.add_text("file", std::move(files));
}

/// What makes numbers less than they seem goes with them.
void add_warnings(core::Table& table, const std::vector<LoadsCase>& cases) {
    core::BatchProblems warnings(false);  // what makes numbers less than they seem goes with them
    for (const auto& one : cases) {
        warnings.add(one.file, one.loads.problems);
    }
    for (const auto& problem : warnings.gathered()) {
        if (problem.severity != core::Problem::Severity::note) {
            table.comments.push_back("warning: " + problem.place.file + ": " + problem.message);
        }
    }
}

void add_loads_rows(core::Table& table, const std::vector<LoadsRow>& rows, const LoadsColumns& columns) {
    constexpr double missing = std::numeric_limits<double>::quiet_NaN();
    const auto free_name = [&](std::string name) {
        while (table.find(name) != nullptr || columns.is_found(name)) {
            name += "_stated";
        }
        return name;
    };
    for (const auto& name : names_in(rows, &LoadsRow::texts)) {
        table.add_text(free_name(name), column_of(rows, &LoadsRow::texts, name, std::string()));
    }
    for (const auto& name : names_in(rows, &LoadsRow::numbers)) {
        const auto [unit, written] = columns.units(name);
        table.add_numbers(free_name(name), unit, column_of(rows, &LoadsRow::numbers, name, missing), written);
    }
    for (const auto& column : columns.values) {
        if (table.find(column.name) == nullptr) {
            table.add_numbers(column.name, column.unit, column_of(rows, &LoadsRow::values, column.name, missing));
        }
    }
}

core::Table loads_table(const std::vector<LoadsCase>& cases,
                        const std::vector<std::pair<std::string, std::string>>& written_units) {
    refuse_mixed_depths(cases);
    std::vector<LoadsRow> rows;
    rows.reserve(cases.size());
    std::transform(cases.begin(), cases.end(), std::back_inserter(rows), row_of);
    LoadsColumns columns;
    columns.values = columns_of(rows);
    columns.units = [&](const std::string& name) {
        const std::string written = value_of(written_units, name, std::string());
        return std::pair(si_unit_of(name, written), written);
    };
    columns.is_found = [](const std::string& name) {
        return is_column(name) || (name.ends_with("_sigma") && is_column(name.substr(0, name.size() - 6)));
    };
    core::Table table;
    add_loads_rows(table, rows, columns);
    add_origins(table, cases);
    add_warnings(table, cases);
    return table;
}

nlohmann::json loads_table_json(const std::vector<LoadsCase>& cases) {
    nlohmann::json files = nlohmann::json::array();
    for (const auto& one : cases) {
        nlohmann::json entry = one.loads;
        entry["conditions"] = nlohmann::json::object();
        for (const auto& [name, value] : one.texts) {
            entry["conditions"][name] = value;
        }
        for (const auto& [name, value] : one.numbers) {
            entry["conditions"][name] = value;
        }
        if (!one.sigmas.empty()) {
            entry["sigma"] = nlohmann::json::object();
            for (const auto& [name, value] : one.sigmas) {
                entry["sigma"][name] = value;
            }
        }
        for (const auto& [name, study] : one.meshes) {
            entry["mesh_uncertainty"][name] = study;
        }
        entry["settled"] = one.settled;
        if (!one.comparisons.empty()) {
            entry["comparison"] = one.comparisons;
        }
        files.push_back(std::move(entry));
    }
    return {{"files", std::move(files)}};
}

}  // namespace underbody::postproc
