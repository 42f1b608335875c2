#include "surrogates/tables/points/columns.h"

#include <algorithm>
#include <optional>

#include "core/mistyped.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/points/set_points.h"

namespace underbody::tables {

namespace {

bool holds_numbers(const core::Column& column) {
    return !column.text.empty() && std::all_of(column.text.begin(), column.text.end(),
                                               [](const std::string& s) { return core::parse_number(s).has_value(); });
}

bool varies(const core::Column& column) {
    return column.is_text()
               ? std::adjacent_find(column.text.begin(), column.text.end(), std::not_equal_to<>()) != column.text.end()
               : std::adjacent_find(column.numbers.begin(), column.numbers.end(), std::not_equal_to<>()) !=
                     column.numbers.end();
}

/// What to write instead; nothing for a column that is fine as it is, or means nothing that the table lacks. An axis is
/// lacking where something varies; the error of a force also where it is one number.
std::optional<std::string> better_heading(const core::Table& table, const core::Column& column) {
    const auto& axes = axis_names();
    const std::string axis = core::meant_quantity(column, core::Likeness::possible);
    const bool is_axis = std::find(axes.begin(), axes.end(), axis) != axes.end();
    const std::string meant = is_axis ? axis : core::meant_name(column);
    if (meant.empty() || table.find(meant) != nullptr || (is_axis && !varies(column))) {
        return std::nullopt;
    }
    return core::heading_for(column, meant);
}

}  // namespace

core::Problems unused_columns(const core::Table& table, const std::string& quantity) {
    core::Problems found;
    std::string no_set_points;
    for (const core::Column& column : table.columns()) {
        const bool text = column.is_text();
        const bool known = column.name == quantity || core::find_quantity(column.name) != nullptr ||
                           column.name.find("_per_") != std::string::npos;
        if (known || (text && !holds_numbers(column))) {
            continue;
        }
        const core::Place place{table.source, {}, {}, {}};
        if (const auto better = better_heading(table, column)) {
            found.push_back({core::Problem::Severity::warning,
                             "the column '" + column.name + "' is not understood and not used: write " + *better,
                             place});
        } else if (!text && varies(column) && !column.name.ends_with("_sigma")) {
            no_set_points += (no_set_points.empty() ? "" : ", ") + column.name;
        }
    }
    if (!no_set_points.empty()) {
        found.push_back({core::Problem::Severity::note,
                         "columns that are no set points and not used: " + no_set_points,
                         {table.source, {}, {}, {}}});
    }
    return found;
}

std::string misnamed_columns(const core::Table& table, const std::string& quantity) {
    std::string text;
    for (const core::Problem& problem : unused_columns(table, quantity)) {
        if (problem.severity != core::Problem::Severity::note) {
            text += (text.empty() ? "" : "; ") + problem.message;
        }
    }
    return text;
}

}  // namespace underbody::tables
