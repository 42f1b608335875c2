// Monitors that the user names: a column of a history as one of the named loads.
#include <algorithm>
#include <filesystem>

#include "core/text.h"
#include "core/units.h"
#include "postproc/field/vector_math.h"
#include "postproc/importers/reports/reports.h"
#include "postproc/loads/stated_loads.h"
#include "postproc/loads/stated_parts.h"

namespace underbody::postproc {

using core::InputError;

MonitorSource monitor_source(const std::string& text) {
    const char* example =
        "for instance option 'monitor lift_force=lift-rfile.out', or \"drag_force [N]=report.out:drag\"";
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals + 1 == text.size()) {
        throw core::UsageError("usage", "'" + text + "' is no QUANTITY=FILE", {}, example);
    }
    MonitorSource source;
    std::string head(core::trimmed(std::string_view(text).substr(0, equals)));
    if (const auto open = head.find('['); open != std::string::npos) {
        if (head.back() != ']') {
            throw core::UsageError("usage", "'" + head + "': the bracket of the unit is not closed", {}, example);
        }
        source.unit = std::string(core::trimmed(std::string_view(head).substr(open + 1, head.size() - open - 2)));
        head = std::string(core::trimmed(std::string_view(head).substr(0, open)));
        if (const auto number = source.unit.find_first_not_of("+-.0123456789eE");
            number != 0 && number != std::string::npos && source.unit[number] == ' ') {
            const core::Quantity scaled = core::parse_quantity(source.unit);
            source.scale = scaled.value;
            source.unit = scaled.unit;
        }
    }
    constexpr std::string_view over_reference = "_coefficient";
    if (head.ends_with(over_reference)) {
        source.coefficient = true;
        const std::string load = head.substr(0, head.size() - over_reference.size());
        head = load.ends_with("_moment") ? load : load + "_force";
        if (!source.unit.empty()) {
            throw core::UsageError("unit", "'" + load + "_coefficient' is a pure number, without a unit", {},
                                   "a number before a unit makes a force of it: \"" + head + " [2.4 N]=FILE\"");
        }
    }
    source.quantity = head;
    const std::vector<std::string> names = {"lift_force",   "drag_force",  "side_force",
                                            "pitch_moment", "roll_moment", "yaw_moment"};
    if (std::find(names.begin(), names.end(), head) == names.end()) {
        throw core::UsageError(
            "usage", "'" + head + "' is no load that a monitor can give", {},
            core::did_you_mean(head, names) + "; of coefficients lift_coefficient, pitch_moment_coefficient ...");
    }
    const std::string si = core::find_quantity(head)->unit;
    if (!source.unit.empty() && (!core::is_unit(source.unit) || !core::same_dimension(source.unit, si))) {
        throw core::UsageError("unit", "'" + source.unit + "' is no unit of " + head, {}, "it is measured in " + si);
    }
    source.file = text.substr(equals + 1);
    // FILE:COLUMN, unless the whole is a file.
    if (const auto colon = source.file.rfind(':');
        colon != std::string::npos && !std::filesystem::exists(source.file)) {
        source.column = source.file.substr(colon + 1);
        source.file.resize(colon);
    }
    return source;
}

namespace {

/// "flow-time", "time [s]": a column of times.
bool is_time(const std::string& name) {
    std::string plain = core::lower_case(name);
    std::replace_if(
        plain.begin(), plain.end(), [](char c) { return c == '-' || c == '_'; }, ' ');
    return plain == "time" || plain == "flow time" || plain == "physical time" || plain.starts_with("time [") ||
           plain.starts_with("time (");
}

/// A column that counts, and is no quantity.
bool is_clock(const std::string& name) {
    const std::string plain = core::lower_case(name);
    return is_time(name) || plain == "delta-time" || plain == "time-step" || plain == "time step";
}

struct FieldRow {
    std::size_t index = 0;
    double time = 0;
};

/// The row of the field's time: the nearest by a column of times; else the one of that iteration, when it is there.
/// Nothing where the field has no time, or the monitor counts something else.
std::optional<FieldRow> row_of_field(const Monitor& monitor, const LoadsResult& result) {
    if (!result.time) {
        return {};
    }
    const auto column = std::find_if(monitor.columns.begin(), monitor.columns.end(), is_time);
    if (column != monitor.columns.end()) {
        const auto& times = monitor.values[static_cast<std::size_t>(column - monitor.columns.begin())];
        const std::size_t row = nearest_row(times, *result.time);
        return FieldRow{row, times[row]};
    }
    if (!core::lower_case(monitor.columns.front()).starts_with("iter")) {
        return {};
    }
    const auto& iterations = monitor.values.front();
    const auto row = std::find(iterations.begin(), iterations.end(), *result.time);
    const auto index = static_cast<std::size_t>(row - iterations.begin());
    // Seconds are no iterations: a field of 2 s is not one of the first two.
    return row == iterations.end() || index + 1 < shortest_history ? std::nullopt
                                                                   : std::optional(FieldRow{index, *row});
}

/// N (moments: N m) that a coefficient of 1 stands for.
double reference_of(const MonitorSource& source, const Monitor& monitor, const LoadsResult& result, bool moment) {
    const auto& own = monitor.coefficients;
    const SolverReferences& solver = result.solver_references;
    const auto density = own && own->density ? own->density : solver.density;
    const auto speed = own ? own->speed : solver.speed;
    const auto area = own ? own->area : solver.area;
    const auto length = own ? own->length : solver.length;
    const std::string missing = !density            ? "density"
                                : !speed            ? "speed"
                                : !area             ? "area"
                                : moment && !length ? "length"
                                                    : "";
    if (!missing.empty()) {
        throw InputError("missing", "coefficients, and the reference " + missing + " that they refer to is not given",
                         {monitor.file, {}, {}, {}},
                         missing == "density" ? "give it: option 'density'"
                                              : "state the force that 1 stands for: \"" + source.quantity + " [2.4 " +
                                                    (moment ? "N m" : "N") + "]=FILE\"");
    }
    return 0.5 * *density * *speed * *speed * *area * (moment ? *length : 1);
}

/// OpenFOAM states in its table which way its coefficients count; another program's are taken the vehicle's way.
void take_direction(const Monitor& monitor, StatedLoad& load) {
    if (!monitor.coefficients) {
        return;
    }
    const std::string name = load.quantity.substr(0, load.quantity.find('_')) + (load.moment ? "Axis" : "Dir");
    for (const auto& [own, direction] : monitor.coefficients->directions) {
        if (const double size = norm(direction); own == name && size > 0) {
            load.direction = plus({}, direction, 1 / size);
        }
    }
    load.centre = monitor.coefficients->centre.value_or(load.centre);
}

/// The only column of values, when none is named.
std::string only_column(const Monitor& monitor, const MonitorSource& source) {
    std::vector<std::string> candidates(monitor.columns.begin() + 1, monitor.columns.end());
    std::erase_if(candidates, [](const std::string& name) { return is_clock(name); });
    if (candidates.empty()) {
        throw InputError("missing", "the monitor has no column of values, only '" + monitor.columns.front() + "'",
                         {monitor.file, {}, {}, {}});
    }
    if (candidates.size() > 1) {
        throw InputError("missing", "the monitor has several columns: which one is " + source.quantity + "?",
                         {monitor.file, {}, {}, {}},
                         core::did_you_mean("", candidates) + "; say option 'monitor " + source.quantity + "=" +
                             source.file + ":COLUMN'");
    }
    return candidates.front();
}

/// Direction and centre of the load that a quantity is.
void take_axis(const std::string& quantity, const LoadsResult& result, StatedLoad& load) {
    const auto axes = named_axes(result);
    const auto& axis = *std::find_if(axes.begin(), axes.end(), [&](const NamedAxis& a) { return a.name == quantity; });
    load.moment = axis.moment;
    load.direction = axis.direction;
    load.centre = result.reference;
}

void take_scatter(const Monitor& monitor, const std::string& column, const std::vector<double>& history,
                  StatedLoad& load) {
    try {
        if (load.later == 0 || history.size() >= shortest_history) {
            load.history = iteration_scatter(history);
        }
    } catch (const InputError& error) {
        throw InputError(error.kind(), "column '" + column + "': " + error.message(), {monitor.file, {}, {}, {}},
                         error.hint());
    }
}

}  // namespace

StatedLoad stated_by_monitor(const MonitorSource& source, const LoadsResult& result) {
    const Monitor monitor = read_monitor(source.file);
    std::string column = source.column;
    if (column.empty()) {
        column = only_column(monitor, source);
    }
    const auto* values = monitor.find(column);
    if (values == nullptr) {
        throw InputError("missing", "the monitor has no column '" + column + "'", {monitor.file, {}, {}, {}},
                         core::did_you_mean(column, monitor.columns));
    }
    std::vector<double> history = *values;
    if (!source.unit.empty()) {
        const auto to_si = core::conversion(source.unit, core::find_quantity(source.quantity)->unit);
        std::transform(history.begin(), history.end(), history.begin(),
                       [&](double value) { return to_si(source.scale * value); });
    }
    StatedLoad load;
    load.file = monitor.file;
    load.quantity = source.quantity;
    take_axis(source.quantity, result, load);
    if (source.coefficient) {
        const double reference = reference_of(source, monitor, result, load.moment);
        std::for_each(history.begin(), history.end(), [&](double& value) { value *= reference; });
        take_direction(monitor, load);
    }
    if (const auto row = row_of_field(monitor, result)) {
        load.time = row->time;
        load.later = history.size() - row->index - 1;
        history.resize(row->index + 1);
    }
    take_scatter(monitor, column, history, load);
    load.value = history.back();
    return load;
}

}  // namespace underbody::postproc
