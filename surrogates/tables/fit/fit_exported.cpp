// Reads back what `export --format csv` wrote: grid, Hermite data and error, without a new fit.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "surrogates/tables/fit/fit.h"
#include "surrogates/tables/fit/force_table_impl.h"
#include "surrogates/tables/fit/hull.h"
#include "surrogates/tables/fit/support.h"

namespace underbody::tables {

namespace {

/// The line about a quantity.
nlohmann::json facts_of(const core::Table& table, const std::string& quantity) {
    for (const auto& comment : table.comments) {
        if (comment.find("\"underbody_table\"") != std::string::npos) {
            nlohmann::json facts = nlohmann::json::parse(comment, nullptr, false);
            const auto named = facts.is_object() ? facts.find("quantity") : facts.end();
            if (facts.is_object() && named != facts.end() && *named == quantity) {
                return facts;
            }
        }
    }
    return nullptr;
}

/// One word for each axis; older files have one for all.
RangePolicy exported_policy(const nlohmann::json& facts, std::size_t axis) {
    const auto range = facts.find("range");
    if (range == facts.end()) {
        return RangePolicy::clamp;
    }
    const auto& word = range->is_array() && axis < range->size() ? (*range)[axis] : *range;
    const auto policy = word.is_string() ? range_policy(word.get<std::string>()) : std::nullopt;
    if (!policy) {
        throw core::InputError(
            "range",
            "an exported table has the range policy " + word.dump() + " on its axis " + std::to_string(axis + 1), {},
            "it is clamp, refuse or extrapolate");
    }
    return *policy;
}

std::vector<std::string> slope_columns(const std::string& quantity, const std::vector<TableAxis>& axes) {
    std::vector<std::string> names{quantity};
    for (std::size_t mask = 1; mask < std::size_t{1} << axes.size(); ++mask) {
        std::string name = quantity + "_per";
        for (std::size_t k = 0; k < axes.size(); ++k) {
            name += (mask >> k & 1) != 0 ? "_" + axes[k].name : "";
        }
        names.push_back(name);
    }
    return names;
}

/// What counts as inside: the grid may reach further.
void set_known_range(std::vector<TableAxis>& axes, const nlohmann::json& facts) {
    const auto known = facts.find("known");
    if (known == facts.end()) {
        return;
    }
    const auto ranges = known->get<std::vector<std::array<double, 2>>>();
    for (std::size_t k = 0; k < axes.size(); ++k) {
        const double rounding = 1e-9 * (axes[k].upper - axes[k].lower);
        if (k >= ranges.size() || !(ranges[k][0] < ranges[k][1]) || ranges[k][0] < axes[k].lower - rounding ||
            ranges[k][1] > axes[k].upper + rounding) {
            throw core::InputError("range", "an exported table has no valid range of its axis " + axes[k].name, {},
                                   "export it again");
        }
        axes[k].lower = ranges[k][0];
        axes[k].upper = ranges[k][1];
    }
}

Support read_support(const nlohmann::json& json, std::size_t axes) {
    auto lines = json.at("lines").get<std::vector<std::vector<double>>>();
    auto cells = json.at("has_data").get<std::vector<std::uint8_t>>();
    std::size_t count = lines.size() == axes ? 1 : 0;
    for (const auto& x : lines) {
        const bool ascending = x.size() >= 2 && std::adjacent_find(x.begin(), x.end(), [](double a, double b) {
                                                    return !(a < b);
                                                }) == x.end();
        count *= ascending ? x.size() - 1 : 0;
    }
    if (count == 0 || count != cells.size()) {
        throw core::InputError("parse", "an exported table has lines and cells of its data that do not fit together",
                               {}, "export it again");
    }
    return {std::move(lines), std::move(cells)};
}

/// Values with their slopes at each node, and the stated error there.
struct NodeValues {
    std::vector<double> hermite, sigma;
};

NodeValues node_values(const SetPoints& points, const core::Table& table, const std::string& quantity,
                       const std::vector<std::string>& columns) {
    const std::size_t width = columns.size();
    std::vector<double> hermite(points.order.size() * width);
    std::vector<double> sigma(points.order.size(), 0.0);
    const core::Column* errors = table.find(quantity + "_sigma");
    for (std::size_t node = 0; node < points.order.size(); ++node) {
        const std::size_t row = points.row[points.order[node]];
        for (std::size_t m = 0; m < width; ++m) {
            const double v = points.table.numbers(columns[m])[row];
            if (!std::isfinite(v)) {
                throw core::InputError("missing", "an exported table lacks a slope",
                                       points.table.place(row, columns[m]), "export it again");
            }
            hermite[node * width + m] = v;
        }
        const double s = errors != nullptr && !errors->is_text() ? points.table.numbers(errors->name)[row] : 0;
        sigma[node] = std::isfinite(s) ? s : 0;
    }
    return {std::move(hermite), std::move(sigma)};
}

/// The error between the nodes, and how it grows beyond them.
void set_error_between(ErrorModel& error, const nlohmann::json& facts, const std::vector<std::vector<double>>& grid) {
    for (std::size_t k = 0; k < grid.size(); ++k) {
        if (facts.contains("cell_error") && facts["cell_error"].size() == grid.size() &&
            facts["cell_error"][k].size() + 1 == grid[k].size()) {
            error.set_cell_error(k, facts["cell_error"][k].get<std::vector<double>>());
        }
        if (facts.contains("growth") && facts["growth"].size() == grid.size()) {
            error.set_growth(k, facts["growth"][k].get<ErrorModel::Growth>());
        }
    }
}

/// What an export says of its table beside the values.
void take_facts(ForceTable::Impl& result, const nlohmann::json& facts, const core::Table& table,
                const SetPoints& points, const FitOptions& options) {
    result.quantity = points.quantity;
    result.unit = points.unit;
    result.source = table.source;
    result.axes = points.axes;
    result.points = points.table;
    result.constants = points.constants;
    for (std::size_t k = 0; k < result.axes.size(); ++k) {
        result.axes[k].range = options.range.of(result.axes[k].name, exported_policy(facts, k));
    }
    const nlohmann::json conditions = facts.value("conditions", nlohmann::json::object());
    for (const auto& [name, value] : conditions.items()) {
        result.constants.emplace_back(name, value.get<double>());
    }
    set_known_range(result.axes, facts);
    if (facts.contains("support")) {
        result.support = std::make_shared<Support>(read_support(facts["support"], result.axes.size()));
    }
    if (facts.contains("hull")) {
        result.hull = std::make_shared<Hull>(result.axes, facts["hull"].get<std::vector<std::vector<double>>>());
    }
    result.kind = "exported grid";
    result.remarks.push_back({core::Problem::Severity::note,
                              "an exported table: taken with its slopes and error, not fitted again",
                              {table.source, {}, {}, {}}});
    for (const auto& warning : facts.value("warnings", std::vector<std::string>{})) {
        result.remarks.push_back({core::Problem::Severity::warning, warning, {table.source, {}, {}, {}}});
    }
}

std::shared_ptr<const ForceTable::Impl> table_of_export(const nlohmann::json& facts, const core::Table& table,
                                                        const std::string& quantity, const FitOptions& options) {
    FitOptions named = options;
    named.axes = facts.value("axes", std::vector<std::string>{});
    for (const auto& name : named.axes) {
        if (table.find(name) == nullptr) {
            return nullptr;
        }
    }
    SetPoints points = set_points(table, quantity, named);
    const auto columns = slope_columns(quantity, points.axes);
    for (const auto& name : columns) {
        if (table.find(name) == nullptr || table.find(name)->is_text()) {
            return nullptr;
        }
    }
    if (!points.full_grid) {
        throw core::InputError(
            "grid",
            "an exported table has lost some of its rows" + (points.missing.empty() ? "" : ": " + points.missing),
            {table.source, {}, {}, {}}, "export it again");
    }
    auto result = std::make_shared<ForceTable::Impl>();
    take_facts(*result, facts, table, points, options);
    result->told = facts.value("told", std::vector<std::string>{});
    std::vector<std::vector<double>> grid;
    for (const auto& axis : points.axes) {
        grid.push_back(axis.points);
    }
    NodeValues nodes = node_values(points, table, quantity, columns);
    result->surface = CubicGrid(grid, std::move(nodes.hermite));
    result->error = ErrorModel(grid, std::move(nodes.sigma));
    set_error_between(result->error, facts, grid);
    return result;
}

}  // namespace

std::shared_ptr<const ForceTable::Impl> fit_exported(const core::Table& table, const std::string& quantity,
                                                     const FitOptions& options) {
    const nlohmann::json facts = facts_of(table, quantity);
    try {
        return facts.is_null() ? nullptr : table_of_export(facts, table, quantity, options);
    } catch (const nlohmann::json::exception& error) {
        throw core::InputError(
            "parse", std::string("the line of an exported table that describes it is damaged: ") + error.what(),
            {table.source, {}, {}, {}}, "export it again");
    }
}

}  // namespace underbody::tables
