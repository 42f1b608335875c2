#include "postproc/loads/loads_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/batch_problems.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/loads/deviation.h"
#include "postproc/loads/loads_parts.h"

namespace underbody::postproc {

namespace {

/// Names in the order in which they first occur.
template <typename Get>
std::vector<std::string> names_in(const std::vector<LoadsCase>& cases, Get get) {
    std::vector<std::string> names;
    for (const auto& one : cases) {
        for (const auto& entry : get(one)) {
            if (std::find(names.begin(), names.end(), entry.first) == names.end()) {
                names.push_back(entry.first);
            }
        }
    }
    return names;
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
        const LoadScale scale =
            load_scale(norm(one.loads.total.force),
                       std::hypot(stated("lift_force"), stated("drag_force"), stated("side_force")), one.loads.length);
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
void add_quantities(core::Table& table, const std::vector<LoadsCase>& cases) {
    std::vector<std::vector<LoadsColumn>> rows;
    for (const auto& one : cases) {
        rows.push_back(table_columns(one.loads));
    }
    for (const auto& column : all_columns()) {
        std::vector<double> values;
        std::vector<double> sigmas;
        bool any = false;
        for (std::size_t i = 0; i < cases.size(); ++i) {
            const auto found = std::find_if(rows[i].begin(), rows[i].end(),
                                            [&](const LoadsColumn& c) { return c.name == column.name; });
            any = any || found != rows[i].end();
            values.push_back(found != rows[i].end() ? found->value : std::numeric_limits<double>::quiet_NaN());
            sigmas.push_back(value_of(cases[i].sigmas, column.name, std::numeric_limits<double>::quiet_NaN()));
        }
        if (any) {
            table.add_numbers(column.name, column.unit, std::move(values));
        }
        if (any &&
            std::any_of(cases.begin(), cases.end(), [&](const LoadsCase& c) { return has(c.sigmas, column.name); })) {
            table.add_numbers(column.name + "_sigma", column.unit, std::move(sigmas));
        }
    }
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

core::Table loads_table(const std::vector<LoadsCase>& cases,
                        const std::vector<std::pair<std::string, std::string>>& written_units) {
    refuse_mixed_depths(cases);
    core::Table table;
    const auto free_name = [&](std::string name) {
        const auto sigma = [&] { return name.ends_with("_sigma") && is_column(name.substr(0, name.size() - 6)); };
        while (table.find(name) != nullptr || is_column(name) || sigma()) {
            name += "_stated";
        }
        return name;
    };
    for (const auto& name : names_in(
             cases, [](const LoadsCase& c) -> const auto& { return c.texts; })) {
        std::vector<std::string> values;
        for (const auto& one : cases) {
            values.push_back(value_of(one.texts, name, std::string()));
        }
        table.add_text(free_name(name), std::move(values));
    }
    for (const auto& name : names_in(
             cases, [](const LoadsCase& c) -> const auto& { return c.numbers; })) {
        std::vector<double> values;
        for (const auto& one : cases) {
            values.push_back(value_of(one.numbers, name, std::numeric_limits<double>::quiet_NaN()));
        }
        const std::string written = value_of(written_units, name, std::string());
        table.add_numbers(free_name(name), si_unit_of(name, written), std::move(values), written);
    }
    add_quantities(table, cases);
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
