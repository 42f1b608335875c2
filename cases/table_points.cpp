// The points of a force table out of the loads of the cases.
#include <algorithm>
#include <cmath>

#include "cases/doubts.h"
#include "cases/study.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/points/set_points.h"

namespace underbody::cases {

namespace {

/// The standard uncertainty that the mesh study found for the quantity; 0 when none is named.
double mesh_sigma(const TableSpec& spec, const StudyResults& results) {
    if (spec.mesh_uncertainty.empty()) {
        return 0;
    }
    const MeshResult* mesh = find_result(results.meshes, spec.mesh_uncertainty);
    if (mesh == nullptr) {
        throw core::InputError("missing",
                               "the mesh uncertainty '" + spec.mesh_uncertainty + "' that the table '" + spec.name +
                                   "' names is not among the results: its step has failed or not run yet",
                               {}, "compute the study; where the step fails, see why");
    }
    const auto* found = mesh->find(spec.quantity);
    if (found == nullptr) {
        throw core::InputError("missing",
                               "the mesh uncertainty '" + spec.mesh_uncertainty + "' does not cover " + spec.quantity,
                               {}, "add it to its list of quantities");
    }
    return found->standard_uncertainty;
}

/// What each case's quantity scatters by from iteration to iteration; 0 where its solver left no history.
std::vector<double> scatter_of(const TableSpec& spec, const core::Table& loads) {
    const auto* column = loads.find(spec.quantity + "_sigma");
    std::vector<double> scatter(loads.rows(), 0);
    for (std::size_t i = 0; column != nullptr && i < scatter.size(); ++i) {
        scatter[i] = std::isfinite(column->numbers[i]) ? column->numbers[i] : 0;
    }
    return scatter;
}

bool row_fits(const core::Table& loads, std::size_t row, const Conditions& where) {
    Conditions mine;
    const auto take = [&](const std::string& name) {
        if (const auto* column = loads.find(name); column != nullptr && column->is_text()) {
            mine.texts.emplace_back(name, column->text[row]);
        } else if (column != nullptr) {
            mine.set(name, column->numbers[row], column->unit);
        }
    };
    for (const auto& [name, value] : where.numbers) {
        take(name);
    }
    for (const auto& [name, value] : where.texts) {
        take(name);
    }
    return mine.satisfies(where);
}

std::vector<std::size_t> rows_of(const TableSpec& spec, const core::Table& loads) {
    std::vector<std::size_t> rows;
    if (!spec.shape.empty()) {
        return rows;  // of no case
    }
    for (std::size_t row = 0; row < loads.rows(); ++row) {
        if (row_fits(loads, row, spec.where)) {
            rows.push_back(row);
        }
    }
    return rows;
}

/// What is the same in all these cases: the speed, the pitch, the variant. An exported table says it in its head, and a
/// model scales its force from that speed.
void add_held(const TableSpec& spec, const core::Table& chosen, core::Table& points) {
    for (const auto& name : tables::axis_names()) {
        const auto* column = chosen.find(name);
        if (column == nullptr || column->is_text() || points.find(name) != nullptr || name == spec.quantity) {
            continue;
        }
        const auto& numbers = column->numbers;
        if (std::isfinite(numbers.front()) &&
            std::all_of(numbers.begin(), numbers.end(), [&](double v) { return v == numbers.front(); })) {
            points.add_numbers(name, column->unit, numbers, column->written_unit);
        }
    }
    for (const char* name : {"variant", "mesh"}) {
        const auto* column = chosen.find(name);
        if (column != nullptr && column->is_text() && !column->text.front().empty() &&
            std::all_of(column->text.begin(), column->text.end(),
                        [&](const std::string& text) { return text == column->text.front(); })) {
            points.add_text(name, column->text);
        }
    }
}

}  // namespace

std::optional<double> speed_of(const TableSpec& spec, const core::Table& points) {
    const auto* speed = points.find("speed");
    const bool axis = std::find(spec.axes.begin(), spec.axes.end(), "speed") != spec.axes.end();
    if (axis || speed == nullptr || speed->is_text() || !(speed->numbers.front() > 0)) {
        return {};
    }
    return speed->numbers.front();
}

std::optional<std::pair<double, double>> range_in_cases(const TableSpec& spec, const StudyResults& results,
                                                        const std::string& condition) {
    std::optional<std::pair<double, double>> range;
    const auto* column = results.loads.find(condition);
    if (column == nullptr || column->is_text()) {
        return range;
    }
    for (const std::size_t row : rows_of(spec, results.loads)) {
        const double value = column->numbers[row];
        if (std::isfinite(value)) {
            range = {range ? std::min(range->first, value) : value, range ? std::max(range->second, value) : value};
        }
    }
    return range;
}

std::vector<std::string> mixed_conditions(const TableSpec& spec, const StudyResults& results) {
    std::vector<std::string> remarks;
    for (const char* name : {"density", "speed"}) {
        const auto range = range_in_cases(spec, results, name);
        const bool axis = std::find(spec.axes.begin(), spec.axes.end(), name) != spec.axes.end();
        if (range && !axis && range->second - range->first > 1e-9 * std::abs(range->second)) {
            remarks.push_back("Its cases have no one " + std::string(name) + " (" +
                              core::format_number(range->first, 6) + " to " + core::format_number(range->second, 6) +
                              " " + condition_unit(name).value_or("1") +
                              "), and it is no axis of the table: what it changes is taken for scatter.");
        }
    }
    return remarks;
}

tables::FitOptions fit_options(const TableSpec& spec) {
    tables::FitOptions options;
    options.axes = spec.axes;
    options.kind = tables::fit_kind(spec.fit).value_or(tables::FitOptions::Kind::automatic);
    if (!spec.shape.empty() && options.kind == tables::FitOptions::Kind::automatic) {
        options.kind = tables::FitOptions::Kind::interpolation;  // the surrogate is smooth: nothing scatters
    }
    return options;
}

namespace {

const core::Table* loads_of_shape(const TableSpec& spec, const StudyResults& results) {
    const auto found = std::find_if(results.shape_loads.begin(), results.shape_loads.end(),
                                    [&](const auto& one) { return one.first == spec.name; });
    return found == results.shape_loads.end() ? nullptr : &found->second;
}

core::Table points_of_shape(const TableSpec& spec, const StudyResults& results) {
    const core::Table* found = loads_of_shape(spec, results);
    if (found == nullptr) {
        throw core::InputError("missing", "the loads of the shape of the table '" + spec.name + "' are not there", {},
                               "run the study: underbody study run; where that failed, see why its step did");
    }
    core::Table points = *found;
    points.source = "table '" + spec.name + "'";
    return points;
}

}  // namespace

bool has_loads(const TableSpec& spec, const StudyResults& results) {
    return spec.shape.empty() ? results.loads.rows() > 0 : loads_of_shape(spec, results) != nullptr;
}

std::vector<std::string> basis_of(const TableSpec& spec, const StudyResults& results) {
    const core::Table* found = spec.shape.empty() ? nullptr : loads_of_shape(spec, results);
    std::vector<std::string> lines = found == nullptr ? std::vector<std::string>() : found->comments;
    for (std::string& line : lines) {
        line.erase(0, line.starts_with(tables::warning_comment) ? tables::warning_comment.size() : 0);
    }
    return lines;
}

core::Table table_points(const TableSpec& spec, const StudyResults& results) {
    if (!spec.shape.empty()) {
        return points_of_shape(spec, results);
    }
    const core::Table& loads = results.loads;
    if (loads.rows() == 0) {
        throw core::InputError("missing", "there are no loads yet", {}, "run the study first: underbody study run");
    }
    const std::vector<std::size_t> rows = rows_of(spec, loads);
    if (rows.empty()) {
        throw core::InputError("missing", "no case with loads fits the table '" + spec.name + "'");
    }
    const core::Table chosen = loads.selected(rows);
    core::Table points;
    points.source = "table '" + spec.name + "'";
    for (const auto& axis : spec.axes) {
        const auto* column = chosen.find(axis);
        points.add_numbers(axis, column != nullptr ? column->unit : "1", chosen.numbers(axis),
                           column != nullptr ? column->written_unit : "");
    }
    const auto* quantity = core::find_quantity(spec.quantity);
    const std::string unit = quantity != nullptr ? quantity->unit : "1";
    const auto& values = chosen.numbers(spec.quantity);
    points.add_numbers(spec.quantity, unit, values);
    const double mesh = mesh_sigma(spec, results);
    const std::vector<double> scatter = scatter_of(spec, chosen);
    const bool scatters = std::any_of(scatter.begin(), scatter.end(), [](double s) { return s > 0; });
    if (mesh > 0 || spec.relative_sigma > 0 || scatters) {
        std::vector<double> sigma;
        for (std::size_t i = 0; i < values.size(); ++i) {
            // An error that nobody knows is an empty field: none is 0.
            const double known = std::hypot(mesh, spec.relative_sigma * values[i], scatter[i]);
            sigma.push_back(known > 0 ? known : std::nan(""));
        }
        points.add_numbers(spec.quantity + "_sigma", unit, std::move(sigma));
    }
    add_held(spec, chosen, points);
    for (const std::string& doubt : doubts_of_mesh(spec, results)) {
        points.comments.push_back(std::string(tables::warning_comment) + doubt);
    }
    points.add_text("case", chosen.text("case"));
    if (chosen.find("settled") != nullptr) {
        points.add_text("settled", chosen.text("settled"));
    }
    return points;
}

}  // namespace underbody::cases
