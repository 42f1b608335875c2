#include "surrogates/tables/points/columns.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <utility>
#include <vector>

#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/points/set_points.h"

namespace underbody::tables {

namespace {

/// Other words for set points, as people and solvers write them.
constexpr std::array<std::pair<const char*, const char*>, 24> other_words{{{"height", "gap"},
                                                                           {"ride_height", "gap"},
                                                                           {"clearance", "gap"},
                                                                           {"ground_clearance", "gap"},
                                                                           {"distance", "gap"},
                                                                           {"h", "gap"},
                                                                           {"angle", "pitch"},
                                                                           {"trim", "pitch"},
                                                                           {"trim_angle", "pitch"},
                                                                           {"pitch_angle", "pitch"},
                                                                           {"angle_of_attack", "pitch"},
                                                                           {"aoa", "pitch"},
                                                                           {"alpha", "pitch"},
                                                                           {"theta", "pitch"},
                                                                           {"velocity", "speed"},
                                                                           {"u", "speed"},
                                                                           {"v", "speed"},
                                                                           {"flow_speed", "speed"},
                                                                           {"voltage", "jet_voltage"},
                                                                           {"flow", "jet_flow"},
                                                                           {"flow_rate", "jet_flow"},
                                                                           {"sink_rate", "heave_velocity"},
                                                                           {"vertical_velocity", "heave_velocity"},
                                                                           {"temp", "temperature"}}};

/// "Gap (mm)" -> "gap" and "mm"; "trim angle" -> "trim_angle" and nothing.
std::pair<std::string, std::string> taken_apart(const std::string& heading) {
    const std::size_t bracket = heading.find('(');
    const std::size_t close = bracket == std::string::npos ? bracket : heading.find(')', bracket);
    std::string name(core::trimmed(std::string_view(heading).substr(0, bracket)));
    for (char& c : name) {
        c = c == ' ' || c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return {name, close == std::string::npos ? "" : heading.substr(bracket + 1, close - bracket - 1)};
}

/// The axis that a word means.
std::optional<std::string> axis_meant(const std::string& word) {
    if (std::find(axis_names().begin(), axis_names().end(), word) != axis_names().end()) {
        return word;
    }
    for (const auto& [other, axis] : other_words) {
        if (word == other) {
            return axis;
        }
    }
    const std::string near = word.size() >= 4 ? core::nearest_name(word, axis_names()) : "";
    return near.empty() ? std::nullopt : std::optional(near);
}

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

/// What to write instead; nothing for a column that is fine as it is, or no axis.
std::optional<std::string> better_heading(const core::Table& table, const core::Column& column) {
    const auto [word, bracketed] = taken_apart(column.name);
    const auto axis = axis_meant(word);
    if (!axis || *axis == column.name || table.find(*axis) != nullptr) {
        return std::nullopt;
    }
    const std::string unit = !column.written_unit.empty() ? column.written_unit
                             : !bracketed.empty()         ? bracketed
                                                          : core::find_quantity(*axis)->unit;
    return *axis + " [" + unit + "]";
}

}  // namespace

core::Problems unused_columns(const core::Table& table, const std::string& quantity) {
    core::Problems found;
    for (const core::Column& column : table.columns()) {
        const bool text = column.is_text();
        const bool known = column.name == quantity || core::find_quantity(column.name) != nullptr ||
                           column.name.ends_with("_sigma") || column.name.find("_per_") != std::string::npos;
        if (known || !varies(column) || (text && !holds_numbers(column))) {
            continue;
        }
        const core::Place place{table.source, {}, {}, {}};
        if (const auto better = better_heading(table, column)) {
            found.push_back({core::Problem::Severity::warning,
                             "the column '" + column.name + "' is not understood and not used: write " + *better,
                             place});
        } else if (!text) {
            found.push_back({core::Problem::Severity::note,
                             "the column '" + column.name + "' is not a set point and not used", place});
        }
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
