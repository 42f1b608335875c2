#include "surrogates/dynamics/model/measurements.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/mistyped.h"
#include "core/text.h"
#include "core/toml.h"
#include "core/units.h"
#include "surrogates/dynamics/logs/log_channels.h"
#include "surrogates/dynamics/model/file_formats.h"
#include "surrogates/dynamics/model/measurement_setup.h"
#include "surrogates/dynamics/model/repeated_runs.h"
#include "surrogates/dynamics/model/run_pieces.h"
#include "surrogates/dynamics/model/simulated_columns.h"

namespace underbody::dynamics {

namespace {

const core::QuantityName& known_quantity(const std::string& name, const char* what, const core::Place& place) {
    const core::QuantityName* quantity = core::find_quantity(name);
    if (quantity == nullptr) {
        throw core::InputError("name", std::string(what) + ": " + core::no_quantity(name), place,
                               core::quantity_hint(name));
    }
    return *quantity;
}

std::map<std::string, double> read_quantities(const core::TomlTable& table, const char* what) {
    std::map<std::string, double> values;
    for (const std::string& key : table.keys()) {
        values[key] = table.quantity(key, known_quantity(key, what, table.place(key)).unit);
    }
    return values;
}

/// A difference of temperature is no temperature: "0.1 degC" is 0.1 K, not 273.25 K.
double difference(const core::TomlTable& table, const std::string& key, const core::QuantityName& quantity) {
    if (table.is_string(key)) {
        const core::Quantity written = core::parse_quantity(table.string(key), table.place(key));
        if (!written.unit.empty()) {
            return written.value * core::conversion(written.unit, quantity.unit, table.place(key)).scale;
        }
    }
    return table.quantity(key, quantity.unit);
}

std::string read_clock_unit(const core::TomlTable& table, const std::string& otherwise) {
    const std::string unit = table.string_or("clock_unit", otherwise);
    if (!unit.empty() && !core::same_dimension(unit, "s")) {
        throw core::InputError("unit", "'" + unit + "' is no unit of time", table.place("clock_unit"),
                               "s, ms, us, ns, min; a clock that runs at another rate has clock_scale");
    }
    return unit;
}

LogChannel read_channel(const core::TomlTable& table, const std::string& name, const std::string& clock) {
    LogChannel channel;
    channel.place = table.place();
    channel.quantity = name;
    const core::QuantityName& quantity = known_quantity(name, "a channel", table.place());
    channel.message = table.string_or("message", {});
    channel.field = table.string("field");
    channel.unit = table.string_or("unit", {});
    if (!channel.unit.empty() && !core::is_unit(channel.unit)) {
        throw core::InputError("unit", "'" + channel.unit + "' is no unit", table.place("unit"),
                               "as UDUNITS-2 has them: cm, mm, deg, m/s, mV; a pure number is 1");
    }
    channel.scale = table.quantity_or("scale", "1", 1);
    const auto sign = table.integer_or("sign", 1);
    if (!(channel.scale != 0) || (sign != 1 && sign != -1)) {
        const char* key = sign != 1 && sign != -1 ? "sign" : "scale";
        throw core::InputError(
            "range",
            std::string(key) + " of " + name + " must be " + (key == std::string("sign") ? "1 or -1" : "other than 0"),
            table.place(key), "size in scale, direction in sign, unit in unit");
    }
    channel.scale *= static_cast<double>(sign);
    channel.offset = table.has("offset") ? difference(table, "offset", quantity) : 0;
    channel.clock = table.string_or("clock", clock);
    channel.clock_unit = read_clock_unit(table, {});
    channel.clock_scale = table.quantity_or("clock_scale", "1", 1);
    if (!(channel.clock_scale > 0)) {
        throw core::InputError("range", "clock_scale of " + name + " must be positive", table.place("clock_scale"),
                               "1.0003: its seconds are longer by 0.3 ms than those of the other channels");
    }
    channel.clock_offset = table.quantity_or("clock_offset", "s", 0);
    return channel;
}

LogChannels read_channels(const core::TomlTable& log) {
    LogChannels all;
    const std::string clock = log.string_or("clock", {});
    all.clock_unit = read_clock_unit(log, "s");
    const core::TomlTable channels = log.table_or_empty("channel");
    for (const std::string& name : channels.keys()) {
        all.channels.push_back(read_channel(channels.table(name), name, clock));
    }
    return all;
}

std::map<std::string, double> read_noise(const core::TomlTable& table) {
    std::map<std::string, double> noise = read_quantities(table, "noise");
    for (auto& [name, sigma] : noise) {
        sigma = difference(table, name, *core::find_quantity(name));
        if (!(sigma > 0)) {
            throw core::InputError("range",
                                   "the noise of " + name + " is " + core::format_number(sigma, 6) + ", not positive",
                                   table.place(name), "leave the line out and the noise is estimated from the data");
        }
    }
    return noise;
}

/// What a run of a motion needs beside its time; what else the whole body needs is asked for with its model.
struct NeededColumns {
    std::string run;
    std::vector<std::string> columns;
    std::string hint;
};
NeededColumns needed_columns(const std::string& motion) {
    if (motion == "surface") {
        return {"a run on the ground (motion = \"surface\")",
                {"time", "position_x", "position_y", "heading"},
                "time [s], position_x [m], position_y [m] and heading [rad], bow to starboard"};
    }
    if (motion == "body") {
        return {"a run of the whole body (motion = \"body\")",
                {"time", "gap", "pitch"},
                "time [s], gap [m], pitch [rad], nose up; heading or yaw_rate; position_x and position_y, or speed and "
                "sway_velocity"};
    }
    return {"a time series",
            {"time", "gap"},
            "kind = \"static\" is for set points without motion, motion = \"surface\" for runs on the ground"};
}

/// "is 'gapp' meant? ": the column of the table that was probably meant for a needed one; empty without.
std::string meant_for(const std::string& needed, const core::Table& table) {
    for (const core::Column& column : table.columns()) {
        const std::string plain = core::plain_name(column.name);
        if (core::meant_name(column, core::Likeness::possible) == needed || core::mistyped_quantity(plain) == needed ||
            plain == needed) {
            return "is its column " + column.name + " the " + needed + "? Then call it " + needed +
                   " or say so with a [log.channel]; else ";
        }
    }
    return {};
}

void check_time_series(const MeasuredRun& run, const std::string& motion) {
    const core::Place whole{run.table.source, {}, {}, {}};
    const NeededColumns needed = needed_columns(motion);
    for (const std::string& column : needed.columns) {
        if (run.table.find(column) == nullptr) {
            throw core::InputError("missing", needed.run + " needs the column " + column, whole,
                                   meant_for(column, run.table) + needed.hint);
        }
    }
    const std::vector<double>& time = run.table.numbers("time");
    if (time.size() < 3) {
        throw core::InputError("range", "a time series of " + std::to_string(time.size()) + " rows", whole,
                               "at least three rows are needed, some thousands are usual");
    }
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (std::isnan(time[i])) {
            throw core::InputError("missing", "a row without time", run.table.place(i, "time"),
                                   "leave the whole row out: gaps in time are fine");
        }
    }
}

/// The rows between begin and end. Throws core::InputError where there is none.
core::Table cut_out(const core::Table& table, const LogWindow& window, const core::TomlTable& entry) {
    std::vector<std::size_t> rows;
    const std::vector<double>& time = table.numbers("time");
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (!(time[i] < window.begin) && !(time[i] > window.end)) {
            rows.push_back(i);
        }
    }
    if (rows.empty() && !time.empty()) {
        const bool late = window.begin > time.back();
        const char* key = late || !std::isfinite(window.end) ? "begin" : "end";
        throw core::InputError("range",
                               std::string("no row of the file lies ") +
                                   (std::isfinite(window.begin) ? "after begin = " : "before end = ") +
                                   core::format_number(std::isfinite(window.begin) ? window.begin : window.end, 9) +
                                   " s" +
                                   (std::isfinite(window.begin) && std::isfinite(window.end)
                                        ? " and before end = " + core::format_number(window.end, 9) + " s"
                                        : "") +
                                   ": its time goes from " + core::format_number(time.front(), 9) + " to " +
                                   core::format_number(time.back(), 9) + " s",
                               entry.place(key), "begin and end are on the clock of the file");
    }
    return table.selected(rows);
}

/// One run's file, whatever it is: a table, one with headings of its own, a vehicle's log.
core::Table read_run(const std::filesystem::path& file, const LogChannels& channels, const LogWindow& window,
                     const core::TomlTable& entry, core::Problems& problems) {
    if (!log_format(file).empty()) {
        const LogChannels own = channels.of(true);
        if (own.channels.empty()) {
            throw core::InputError("missing", "this run is a vehicle's log, and nothing says which message is the gap",
                                   entry.place("file"),
                                   "add [log.channel.gap] message = ..., field = ...; `underbody info " +
                                       file.string() + "` lists messages and fields");
        }
        return read_log_channels(file, own, window, problems);
    }
    const LogChannels own = channels.of(false);
    if (!own.channels.empty()) {
        return read_csv_channels(file, own, window, problems);
    }
    core::Table table = core::read_csv(file);
    const bool whole = std::isinf(window.begin) && std::isinf(window.end);
    return whole || table.find("time") == nullptr ? std::move(table) : cut_out(table, window, entry);
}

LogWindow read_window(const core::TomlTable& entry) {
    LogWindow window;
    window.begin = entry.quantity_or("begin", "s", window.begin);
    window.end = entry.quantity_or("end", "s", window.end);
    if (!(window.begin < window.end)) {
        throw core::InputError("range", "the run ends before it begins", entry.place("end"),
                               "begin and end are times by the file's clock");
    }
    return window;
}

void check_static(const MeasuredRun& run) {
    for (const std::string& channel : force_channels()) {
        if (run.table.find(channel) != nullptr) {
            return;
        }
    }
    throw core::InputError("missing", "a static set needs a measured force or moment",
                           core::Place{run.table.source, {}, {}, {}},
                           "columns such as lift_force [N], drag_force [N], pitch_moment [N m]");
}

/// Columns under names that nobody reads: what they were probably meant for. An input that vanishes leaves the run with
/// zero input, which is refused.
void check_names(const MeasuredRun& run, bool time_series, bool of_jets, core::Problems& problems) {
    for (const core::Column& column : run.table.columns()) {
        const std::string base =
            column.name.ends_with("_sigma") ? column.name.substr(0, column.name.size() - 6) : column.name;
        const std::string meant = core::meant_name(column);
        const bool lacking = !meant.empty() && run.table.find(meant) == nullptr && run.conditions.count(meant) == 0;
        if (core::find_quantity(base) != nullptr || is_simulated(column.name) || (column.is_text() && !lacking) ||
            (of_jets && column.name.starts_with("thrust_"))) {
            continue;
        }
        const core::Place place = run.table.place(0, column.name);
        if (time_series && lacking && meant == "input_force") {
            throw core::InputError(
                "name",
                "the column '" + column.name +
                    "' looks like input_force, which the run lacks: its input would be taken as zero",
                place,
                "name it " + core::heading_for(column, meant) +
                    "; if it is no input, give it a name that is less like one");
        }
        problems.push_back({core::Problem::Severity::warning,
                            "the column '" + column.name + "' is not used" +
                                (lacking ? ": if it is " + meant + ", name it " + core::heading_for(column, meant)
                                         : ", for no quantity has that name"),
                            place});
    }
}

/// Columns of known quantities in which nothing was read.
void check_empty(const MeasuredRun& run, core::Problems& problems) {
    for (const core::Column& column : run.table.columns()) {
        if (core::find_quantity(column.name) != nullptr && !empty_text(run, column.name).empty()) {
            problems.push_back({core::Problem::Severity::warning,
                                "the column '" + column.name + "' has no value: it counts as not measured",
                                run.table.place(0, column.name)});
        }
    }
}

/// The same problem in many runs is one line.
void gather(core::Problems& problems) {
    core::Problems once;
    std::vector<std::size_t> counts;
    for (const core::Problem& problem : problems) {
        const auto same = std::find_if(once.begin(), once.end(),
                                       [&](const core::Problem& other) { return other.message == problem.message; });
        if (same == once.end()) {
            once.push_back(problem);
            counts.push_back(0);
        } else {
            ++counts[static_cast<std::size_t>(same - once.begin())];
        }
    }
    for (std::size_t i = 0; i < once.size(); ++i) {
        once[i].message += counts[i] > 0 ? " (alike in " + std::to_string(counts[i]) +
                                               (counts[i] == 1 ? " other run)" : " other runs)")
                                         : "";
    }
    problems = std::move(once);
}

}  // namespace

std::vector<double> MeasuredRun::values(const std::string& quantity) const {
    const core::Column* column = table.find(quantity);
    if (column != nullptr && !column->is_text()) {
        return column->numbers;
    }
    const auto condition = conditions.find(quantity);
    if (condition != conditions.end()) {
        return std::vector<double>(table.rows(), condition->second);
    }
    return {};
}

std::string empty_text(const MeasuredRun& run, const std::string& channel) {
    const core::Column* column = run.table.find(channel);
    const bool empty =
        column != nullptr && !column->is_text() &&
        std::none_of(column->numbers.begin(), column->numbers.end(), [](double value) { return std::isfinite(value); });
    return empty ? "run " + run.name + " has no value of " + channel : "";
}

bool MeasuredRun::has(const std::string& quantity) const {
    const core::Column* column = table.find(quantity);
    return (column != nullptr && !column->is_text()) || conditions.count(quantity) > 0;
}

std::optional<double> Measurements::declared_noise(const std::string& channel) const {
    const auto found = noise.find(channel);
    return found == noise.end() ? std::nullopt : std::optional<double>(found->second);
}

bool Measurements::all_have(const std::string& quantity) const {
    return std::all_of(runs.begin(), runs.end(), [&](const MeasuredRun& run) { return run.has(quantity); });
}

const std::vector<std::string>& force_channels() {
    static const std::vector<std::string> names{"lift_force",   "drag_force",  "side_force",
                                                "pitch_moment", "roll_moment", "yaw_moment"};
    return names;
}

namespace {

/// The file itself, or the one in a folder.
std::filesystem::path dataset_file(const std::filesystem::path& folder) {
    if (!std::filesystem::is_directory(folder)) {
        return folder;
    }
    if (!std::filesystem::exists(folder / "dataset.toml")) {
        throw core::InputError("missing", "no dataset.toml in this folder", core::Place{folder.string(), {}, {}, {}},
                               "a data set is a folder with dataset.toml, which names its runs");
    }
    return folder / "dataset.toml";
}

std::string read_motion(const core::TomlTable& root) {
    return root.choice("motion", {"heave", "heave_pitch", "surface", "body"}, "");
}

}  // namespace

MeasurementSetup read_measurement_setup(const std::filesystem::path& path) {
    const core::TomlTable root = core::read_toml(dataset_file(path), dataset_format());
    MeasurementSetup setup;
    setup.motion = read_motion(root);
    setup.noise = read_noise(root.table_or_empty("noise"));
    setup.conditions = read_quantities(root.table_or_empty("conditions"), "condition");
    setup.channels = read_channels(root.table_or_empty("log"));
    return setup;
}

Measurements read_measurements(const std::filesystem::path& folder) {
    const std::filesystem::path file = dataset_file(folder);
    const core::TomlTable root = core::read_toml(file, dataset_format());
    Measurements data;
    data.folder = file.parent_path();
    data.kind = root.choice("kind", {"time_series", "static"}) == "static" ? MeasurementKind::steady
                                                                           : MeasurementKind::time_series;
    data.title = root.string_or("title", {});
    data.motion = read_motion(root);
    data.noise = read_noise(root.table_or_empty("noise"));
    const std::map<std::string, double> conditions = read_quantities(root.table_or_empty("conditions"), "condition");
    const LogChannels channels = read_channels(root.table_or_empty("log"));
    std::vector<LogWindow> windows;
    std::set<std::string> names;
    for (const core::TomlTable& entry : root.tables("run")) {
        MeasuredRun run;
        run.file = entry.file("file");
        run.name = run.file.stem().string();
        for (int copy = 2; !names.insert(run.name).second; ++copy) {
            run.name = run.file.stem().string() + "-" + std::to_string(copy);
        }
        const LogWindow window = read_window(entry);
        for (std::size_t i = 0; i < data.runs.size(); ++i) {
            const bool apart = window.end <= windows[i].begin || window.begin >= windows[i].end;
            if (!apart &&
                std::filesystem::weakly_canonical(data.runs[i].file) == std::filesystem::weakly_canonical(run.file)) {
                throw core::InputError("duplicate", "the run " + run.file.string() + " is named twice",
                                       entry.place("file"),
                                       "a run counted twice makes everything look twice as certain");
            }
        }
        run.conditions = conditions;
        for (const auto& [name, value] : read_quantities(entry.table_or_empty("conditions"), "condition")) {
            run.conditions[name] = value;
        }
        const std::string use = entry.choice("use", {"train", "test"}, "automatic");
        run.use = use == "train" ? RunUse::train : use == "test" ? RunUse::test : RunUse::automatic;
        run.table = read_run(run.file, channels, window, entry, data.problems);
        const bool time_series = data.kind == MeasurementKind::time_series,
                   of_jets = time_series && (data.motion == "surface" || data.motion == "body");
        time_series ? check_time_series(run, data.motion) : check_static(run);
        check_names(run, time_series, of_jets, data.problems);
        check_empty(run, data.problems);
        for (MeasuredRun& piece : time_series ? pieces_of(run, data.problems) : std::vector{run}) {
            windows.push_back(window);
            data.runs.push_back(std::move(piece));
        }
    }
    if (data.kind == MeasurementKind::time_series) {
        count_from_first_reading(data);
    }
    gather(data.problems);
    drop_repeated_runs(data);
    root.finish();
    if (data.runs.empty()) {
        throw core::InputError("missing", "a data set without a run", core::Place{file.string(), {}, {}, {}},
                               "name each file: [[run]] file = \"run-01.csv\"");
    }
    return data;
}

}  // namespace underbody::dynamics
