#include "surrogates/dynamics/logs/log_channels.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/file.h"
#include "core/heading.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/dynamics/logs/log_rows.h"

namespace underbody::dynamics {

namespace {

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
    return rows_of(log.string(), channels, sink.readings(), window, problems);
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
    return rows_of(file.string(), own, sink.readings(), window, problems);
}

}  // namespace underbody::dynamics
