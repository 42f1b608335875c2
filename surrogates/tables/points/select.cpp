#include "surrogates/tables/points/select.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/points/set_points.h"

namespace underbody::tables {

namespace {

struct Condition {
    const core::Column* column;
    std::vector<std::string> texts;
    std::vector<double> numbers;

    [[nodiscard]] bool holds(std::size_t row) const {
        if (column->is_text()) {
            return std::find(texts.begin(), texts.end(), column->text[row]) != texts.end();
        }
        return std::any_of(numbers.begin(), numbers.end(), [&](double v) {
            return std::abs(column->numbers[row] - v) <=
                   1e-9 * std::max(std::abs(v), std::abs(column->numbers[row])) + 1e-15;
        });
    }
};

std::string values_of(const core::Column& column) {
    std::set<std::string> values;
    if (column.is_text()) {
        values.insert(column.text.begin(), column.text.end());
    } else {
        const auto shown = core::conversion(column.unit, column.written_unit);
        for (const double v : column.numbers) {
            values.insert(core::format_number(shown(v), 6) + " " + column.written_unit);
        }
    }
    std::string list;
    std::size_t count = 0;
    for (const auto& v : values) {
        if (count++ == 12) {
            return list + ", ...";
        }
        list += (list.empty() ? "" : ", ") + v;
    }
    return list;
}

/// A text without the quotes around it.
std::string_view unquoted(std::string_view text) {
    text = core::trimmed(text);
    const bool quoted =
        text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.back() == text.front();
    return quoted ? core::trimmed(text.substr(1, text.size() - 2)) : text;
}

/// Without the braces of a table in TOML.
std::string_view unbraced(std::string_view text) {
    text = core::trimmed(text);
    return text.starts_with('{') && text.ends_with('}') ? core::trimmed(text.substr(1, text.size() - 2)) : text;
}

/// column=value or column=a|b of a list of conditions; `before` are those that stand before it.
Condition condition_of(std::string_view part, const core::Table& table, const std::vector<Condition>& before,
                       const std::string& conditions) {
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos) {
        throw core::UsageError("parse", "'" + std::string(core::trimmed(part)) + "' is not of the form column=value");
    }
    const std::string name(core::trimmed(part.substr(0, equals)));
    Condition condition{table.find(name), {}, {}};
    if (condition.column != nullptr &&
        std::any_of(before.begin(), before.end(), [&](const Condition& c) { return c.column == condition.column; })) {
        throw core::UsageError("parse", "'" + name + "' is given twice: " + conditions, {table.source, {}, {}, {}},
                               name + "=a|b takes either");
    }
    if (condition.column == nullptr) {
        std::vector<std::string> names;
        for (const auto& column : table.columns()) {
            names.push_back(column.name);
        }
        throw core::UsageError("missing", "there is no column '" + name + "' to select by", {table.source, {}, {}, {}},
                               core::did_you_mean(name, names));
    }
    for (const auto one : core::split(unquoted(part.substr(equals + 1)), '|')) {
        const std::string_view value = unquoted(one);
        if (condition.column->is_text()) {
            condition.texts.emplace_back(core::trimmed(value));
        } else {
            condition.numbers.push_back(core::parse_in(value, condition.column->unit));
        }
    }
    return condition;
}

}  // namespace

core::Table selected_rows(const core::Table& table, const std::string& given) {
    const std::string conditions(unbraced(given));
    if (conditions.empty()) {
        return table;
    }
    std::vector<Condition> wanted;
    for (const auto part : core::split(conditions, ',')) {
        wanted.push_back(condition_of(part, table, wanted, conditions));
    }
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < table.rows(); ++i) {
        if (std::all_of(wanted.begin(), wanted.end(), [i](const Condition& c) { return c.holds(i); })) {
            rows.push_back(i);
        }
    }
    if (rows.empty()) {
        std::string hint;
        for (const auto& c : wanted) {
            hint += (hint.empty() ? "" : "; ") + c.column->name + " is one of: " + values_of(*c.column);
        }
        throw core::UsageError("empty", "no row fits '" + conditions + "'", {table.source, {}, {}, {}}, hint);
    }
    return table.selected(rows);
}

std::vector<std::string> force_columns(const core::Table& table) {
    // x_force to z_force: as an export in body axes (z down) names them.
    static const std::vector<std::string> forces = {"lift_force",   "drag_force",  "side_force",
                                                    "pitch_moment", "roll_moment", "yaw_moment",
                                                    "x_force",      "y_force",     "z_force"};
    std::vector<std::string> found;
    std::vector<std::string> others;
    for (const auto& column : table.columns()) {
        if (column.is_text()) {
            continue;
        }
        const auto& axes = axis_names();
        if (std::find(forces.begin(), forces.end(), column.name) != forces.end()) {
            found.push_back(column.name);
        } else if (std::find(axes.begin(), axes.end(), column.name) == axes.end() && !column.name.ends_with("_sigma") &&
                   column.name.find("_per_") == std::string::npos) {
            others.push_back(column.name);
        }
    }
    return found.empty() ? others : found;
}

}  // namespace underbody::tables
