#include "surrogates/dynamics/logs/log_channels.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/counted.h"
#include "core/file.h"
#include "core/heading.h"
#include "core/no_limit.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::dynamics {

namespace {

bool makes_rows(const std::string& quantity) { return quantity == "gap" || quantity == "heave_velocity"; }

bool is_held(const std::string& quantity) {
    return quantity == "input_force" || quantity == "jet_voltage" || quantity == "jet_flow";
}

/// A channel's number to SI.
core::Conversion to_si(const LogChannel& channel, const std::string& stated, const std::string& where) {
    const core::QuantityName& quantity = *core::find_quantity(channel.quantity);
    const std::string unit = !channel.unit.empty() ? channel.unit : !stated.empty() ? stated : quantity.unit;
    if (!core::same_dimension(unit, quantity.unit)) {
        throw core::InputError(
            "unit", where + " is in " + unit + ", and " + channel.quantity + " is a quantity in " + quantity.unit,
            channel.place, "another field, or `unit` where the log states a wrong one");
    }
    const core::Conversion conversion = core::conversion(unit, quantity.unit, channel.place);
    return {conversion.scale * channel.scale, conversion.offset + channel.offset};
}

/// Readings in ascending time; a clock that jumps and comes back loses the readings in between.
void put_in_order(ChannelReadings& readings, const std::string& quantity, const std::string& log,
                  core::Problems& problems) {
    ChannelReadings kept;
    std::size_t dropped = 0;
    for (std::size_t i = 0; i < readings.time.size(); ++i) {
        const double t = readings.time[i];
        std::size_t count = kept.time.size();
        if (!std::isfinite(t)) {
            ++dropped;
            continue;
        }
        // one reading too late among the others was the wrong one
        if (count >= 2 && t <= kept.time[count - 1] && t > kept.time[count - 2]) {
            kept.time.pop_back();
            kept.value.pop_back();
            ++dropped;
            --count;
        }
        if (count > 0 && t <= kept.time[count - 1]) {
            ++dropped;
            continue;
        }
        kept.time.push_back(t);
        kept.value.push_back(readings.value[i]);
    }
    readings = std::move(kept);
    if (dropped > 0) {
        problems.push_back({core::Problem::Severity::warning,
                            core::counted(dropped, "reading") + " of " + quantity +
                                " whose clock stands still or runs backwards " + (dropped == 1 ? "is" : "are") +
                                " left out",
                            core::Place{log, {}, {}, {}}});
    }
}

double usual_step(const std::vector<double>& time) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < time.size(); ++i) {
        steps.push_back(time[i] - time[i - 1]);
    }
    if (steps.empty()) {
        return 0;
    }
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle;
}

/// The times of the rows: every reading of gap and velocity, every change of a held input.
std::vector<double> row_times(const LogChannels& channels, const std::vector<ChannelReadings>& readings) {
    std::vector<double> times;
    double step = 0, first = -core::no_limit, last = core::no_limit;
    for (std::size_t c = 0; c < readings.size(); ++c) {
        const std::string& quantity = channels.channels[c].quantity;
        if (makes_rows(quantity)) {
            times.insert(times.end(), readings[c].time.begin(), readings[c].time.end());
        }
        if (quantity == "gap" && !readings[c].time.empty()) {
            step = usual_step(readings[c].time);
            first = readings[c].time.front();
            last = readings[c].time.back();
        }
    }
    for (std::size_t c = 0; c < readings.size(); ++c) {
        const ChannelReadings& own = readings[c];
        for (std::size_t i = 1; i < own.time.size() && is_held(channels.channels[c].quantity); ++i) {
            if (own.value[i] != own.value[i - 1] && own.time[i] > first && own.time[i] < last) {
                times.push_back(own.time[i]);
            }
        }
    }
    std::sort(times.begin(), times.end());
    constexpr double same_row = 0.01;  // of the step
    std::vector<double> rows;
    for (const double t : times) {
        if (rows.empty() || t - rows.back() > same_row * step) {
            rows.push_back(t);
        }
    }
    return rows;
}

/// Readings at their own rows alone.
std::vector<double> at_rows(const ChannelReadings& own, const std::vector<double>& rows) {
    std::vector<double> values(rows.size(), std::nan(""));
    std::size_t row = 0;
    for (std::size_t i = 0; i < own.time.size(); ++i) {
        while (row + 1 < rows.size() && rows[row + 1] <= own.time[i]) {
            ++row;
        }
        values[row] = own.value[i];
    }
    return values;
}

/// The last reading at or before each row; the first one before there was any.
std::vector<double> held_at_rows(const ChannelReadings& own, const std::vector<double>& rows, double tolerance) {
    std::vector<double> values(rows.size(), std::nan(""));
    std::size_t i = 0;
    for (std::size_t row = 0; row < rows.size() && !own.time.empty(); ++row) {
        while (i + 1 < own.time.size() && own.time[i + 1] <= rows[row] + tolerance) {
            ++i;
        }
        values[row] = own.value[i];
    }
    return values;
}

/// Mean of the readings nearer to this row than to its neighbours; linear between readings where there are none.
std::vector<double> mean_at_rows(const ChannelReadings& own, const std::vector<double>& rows) {
    std::vector<double> values(rows.size(), std::nan(""));
    if (own.time.empty()) {
        return values;
    }
    std::size_t i = 0;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const double t = rows[row];
        const double until =
            row + 1 < rows.size() ? 0.5 * (t + rows[row + 1]) : t + (row > 0 ? 0.5 * (t - rows[row - 1]) : 0);
        const double from = row > 0 ? 0.5 * (t + rows[row - 1]) : t - (until - t);
        double sum = 0;
        std::size_t count = 0;
        for (; i < own.time.size() && own.time[i] < until; ++i) {
            if (own.time[i] >= from && std::isfinite(own.value[i])) {
                sum += own.value[i];
                ++count;
            }
        }
        if (count > 1) {
            values[row] = sum / static_cast<double>(count);
            continue;
        }
        const auto after = std::lower_bound(own.time.begin(), own.time.end(), t) - own.time.begin();
        const auto next = static_cast<std::size_t>(after);
        if (next == 0 || next == own.time.size()) {
            values[row] = next == 0 ? own.value.front() : own.value.back();
        } else {
            const double share = (t - own.time[next - 1]) / (own.time[next] - own.time[next - 1]);
            values[row] = own.value[next - 1] + share * (own.value[next] - own.value[next - 1]);
        }
    }
    return values;
}

core::Table merged(const std::string& log, const LogChannels& channels, std::vector<ChannelReadings>& readings,
                   const LogWindow& window, core::Problems& problems) {
    for (std::size_t c = 0; c < readings.size(); ++c) {
        const LogChannel& channel = channels.channels[c];
        put_in_order(readings[c], channel.quantity, log, problems);
        if (readings[c].time.empty()) {
            throw core::InputError(
                "range",
                "no reading of " + channel.quantity + " in the log" +
                    (std::isfinite(window.begin) || std::isfinite(window.end) ? " between begin and end" : ""),
                channel.place, "`underbody info` says from when to when each message was logged");
        }
    }
    const std::vector<double> rows = row_times(channels, readings);
    core::Table table;
    table.source = log;
    table.add_numbers("time", "s", rows);
    const double tolerance = rows.size() > 1 ? 0.01 * usual_step(rows) : 0;
    for (std::size_t c = 0; c < readings.size(); ++c) {
        const std::string& quantity = channels.channels[c].quantity;
        table.add_numbers(quantity, core::find_quantity(quantity)->unit,
                          makes_rows(quantity) ? at_rows(readings[c], rows)
                          : is_held(quantity)  ? held_at_rows(readings[c], rows, tolerance)
                                               : mean_at_rows(readings[c], rows));
    }
    return table;
}

std::string in_message(const LogChannel& channel) {
    return channel.message.empty() ? "'" + channel.field + "'" : channel.message + "." + channel.field;
}

}  // namespace

LogChannels LogChannels::of(bool logs) const {
    LogChannels own;
    own.clock_unit = clock_unit;
    std::copy_if(channels.begin(), channels.end(), std::back_inserter(own.channels),
                 [&](const LogChannel& one) { return one.message.empty() != logs; });
    return own;
}

ChannelSink::ChannelSink(const LogChannels& channels, const LogWindow& window)
    : channels_(channels), window_(window), found_(channels.channels.size()), readings_(channels.channels.size()) {}

bool ChannelSink::begin(std::size_t series, const LogSeries& description) {
    seen_.push_back(description);
    for (std::size_t c = 0; c < channels_.channels.size(); ++c) {
        if (channels_.channels[c].message == description.name) {
            use(c, series, description);
        }
    }
    return uses_.count(series) > 0;
}

void ChannelSink::use(std::size_t index, std::size_t series, const LogSeries& description) {
    const LogChannel& channel = channels_.channels[index];
    std::vector<std::string> names;
    for (const LogField& field : description.fields) {
        names.push_back(field.name);
    }
    const auto find = [&](const std::string& name, const char* key) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) {
            throw core::InputError("name",
                                   description.name + (description.type.empty() ? "" : " (" + description.type + ")") +
                                       " has no number '" + name + "', which is asked for as the " + key + " of " +
                                       channel.quantity,
                                   channel.place, core::did_you_mean(name, names));
        }
        return static_cast<std::size_t>(found - names.begin());
    };
    Use own;
    own.channel = index;
    own.field = find(channel.field, "field");
    const core::Conversion si = to_si(channel, description.fields[own.field].unit, in_message(channel));
    own.factor = si.scale;
    own.offset = si.offset;
    if (!channel.clock.empty()) {
        own.clock = find(channel.clock, "clock");
        const std::string& stated = description.fields[*own.clock].unit;
        const std::string& otherwise = channel.clock_unit.empty() ? channels_.clock_unit : channel.clock_unit;
        own.clock_factor = core::conversion(stated.empty() ? otherwise : stated, "s", channel.place).scale;
    }
    own.clock_factor *= channel.clock_scale;
    own.clock_offset = channel.clock_offset;
    uses_[series].push_back(own);
    found_[index] = true;
}

void ChannelSink::row(std::size_t series, double time, std::span<const double> values) {
    for (const Use& one : uses_[series]) {
        const double t = one.clock_factor * (one.clock ? values[*one.clock] : time) + one.clock_offset;
        const double value = values[one.field];
        if (t >= window_.begin && t <= window_.end && std::isfinite(value)) {
            reading(one.channel, t, one.factor * value + one.offset);
        }
    }
}

void ChannelSink::reading(std::size_t channel, double time, double value) {
    readings_[channel].time.push_back(time);
    readings_[channel].value.push_back(value);
}

void ChannelSink::check_all_found(const std::string& log, const LogEnd& end) const {
    std::vector<std::string> names;
    for (const LogSeries& one : seen_) {
        names.push_back(one.name);
    }
    for (std::size_t c = 0; c < found_.size(); ++c) {
        if (found_[c]) {
            continue;
        }
        const LogChannel& channel = channels_.channels[c];
        for (const UnreadMessages& unread : end.unread) {
            if (unread.name == channel.message) {
                throw core::InputError("type",
                                       "the messages of " + unread.name +
                                           (unread.type.empty() ? "" : " (" + unread.type + ")") + ", asked for as " +
                                           channel.quantity + ", cannot be read: " + unread.reason,
                                       channel.place, log);
            }
        }
        throw core::InputError(
            "name",
            "the log has no message '" + channel.message + "', which is asked for as " + channel.quantity + ": " + log,
            channel.place, core::did_you_mean(channel.message, names));
    }
}

core::Table read_log_channels(const std::filesystem::path& log, const LogChannels& channels, const LogWindow& window,
                              core::Problems& problems, core::Progress& progress) {
    ChannelSink sink(channels, window);
    const LogEnd end = read_log(log, sink, progress);
    problems.insert(problems.end(), end.problems.begin(), end.problems.end());
    sink.check_all_found(log.string(), end);
    return merged(log.string(), channels, sink.readings(), window, problems);
}

namespace {

/// A column's numbers as they stand in the file, before any unit.
std::vector<double> plain_numbers(const core::Table& table, const core::Column& column) {
    std::vector<double> numbers;
    if (!column.is_text()) {
        const core::Conversion back = core::conversion(column.unit, column.written_unit);
        for (const double value : column.numbers) {
            numbers.push_back(back(value));
        }
        return numbers;
    }
    for (std::size_t i = 0; i < column.text.size(); ++i) {
        const std::string_view text = core::trimmed(column.text[i]);
        const auto number = text.empty() ? std::optional<double>(std::nan("")) : core::parse_number(text);
        if (!number) {
            throw core::InputError("parse", "'" + std::string(text) + "' is no number", table.place(i, column.name),
                                   "a channel of a run is a column of numbers; an empty field is a missing one");
        }
        numbers.push_back(*number);
    }
    return numbers;
}

}  // namespace

LogChannels channels_by_name(const core::Table& table) {
    LogChannels all;
    for (const core::Column& column : table.columns()) {
        if (core::find_quantity(column.name) != nullptr && !column.is_text() && column.name != "time") {
            LogChannel channel;
            channel.quantity = column.name;
            channel.field = column.name;
            channel.clock = "time";
            channel.place = table.place(0, column.name);
            all.channels.push_back(std::move(channel));
        }
    }
    return all;
}

void send_csv(const core::Table& table, const LogChannels& channels, bool first, ChannelSink& sink) {
    LogSeries description;
    std::set<std::string> asked;
    for (const LogChannel& channel : channels.channels) {
        asked.insert({channel.field, channel.clock});
    }
    std::vector<std::vector<double>> columns;
    for (const core::Column& column : table.columns()) {
        description.fields.push_back({column.name, column.is_text() ? "" : column.written_unit});
        columns.push_back(asked.count(column.name) > 0 ? plain_numbers(table, column)
                                                       : std::vector<double>(table.rows(), std::nan("")));
    }
    if (first) {
        sink.begin(0, description);
    }
    std::vector<double> row(columns.size());
    for (std::size_t i = 0; i < table.rows(); ++i) {
        for (std::size_t c = 0; c < columns.size(); ++c) {
            row[c] = columns[c][i];
        }
        sink.row(0, 0, row);
    }
}

LogChannels LogChannels::with_csv_clock() const {
    LogChannels own = *this;
    for (LogChannel& channel : own.channels) {
        channel.clock = channel.clock.empty() ? "time" : channel.clock;
    }
    return own;
}

namespace {

/// The unit that the data set states for a column: of a channel, or of a clock; empty: none.
std::string stated_unit(const LogChannels& channels, const std::string& column) {
    for (const LogChannel& channel : channels.channels) {
        if (channel.field == column && !channel.unit.empty()) {
            return channel.unit;
        }
        if (channel.clock == column) {
            return channel.clock_unit.empty() ? channels.clock_unit : channel.clock_unit;
        }
    }
    return {};
}

/// The header's line of a table, from where to where.
std::pair<std::size_t, std::size_t> header_line(std::string_view text) {
    std::size_t begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::string_view line = core::trimmed(text.substr(begin, end - begin));
        if (!line.empty() && line.front() != '#') {
            return {begin, end};
        }
        begin = end + 1;
    }
    return {text.size(), text.size()};
}

/// A table whose columns are called by quantities without a unit ("gap, input_force"), which a table of ours may not
/// have: those whose unit the data set states are read with it.
core::Table read_with_stated_units(const std::filesystem::path& file, const LogChannels& channels) {
    const core::MappedFile mapped(file);
    const std::string_view text = mapped.bytes();
    const auto [begin, end] = header_line(text);
    std::string header;
    bool changed = false;
    for (const std::string_view cell : core::split(core::trimmed(text.substr(begin, end - begin)), ',')) {
        const auto heading = core::heading_text(cell);
        const bool bare = heading && !heading->unit && core::find_quantity(heading->name) != nullptr;
        const std::string unit = bare ? stated_unit(channels, heading->name) : "";
        header += (header.empty() ? "" : ",") + std::string(cell) + (unit.empty() ? "" : " [" + unit + "]");
        changed = changed || !unit.empty();
    }
    return changed ? core::read_csv(std::string(text.substr(0, begin)) + header + std::string(text.substr(end)),
                                    file.string())
                   : core::read_csv(text, file.string());
}

}  // namespace

core::Table read_csv_channels(const std::filesystem::path& file, const LogChannels& channels, const LogWindow& window,
                              core::Problems& problems) {
    const LogChannels own = channels.with_csv_clock();
    ChannelSink sink(own, window);
    send_csv(read_with_stated_units(file, own), own, true, sink);
    return merged(file.string(), own, sink.readings(), window, problems);
}

}  // namespace underbody::dynamics
