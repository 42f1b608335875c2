#include "surrogates/dynamics/logs/log_rows.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/counted.h"
#include "core/no_limit.h"
#include "core/quantile.h"
#include "core/units.h"

namespace underbody::dynamics {

namespace {

bool makes_rows(const std::string& quantity) { return quantity == "gap" || quantity == "heave_velocity"; }

bool is_held(const std::string& quantity) {
    return quantity == "input_force" || quantity == "jet_voltage" || quantity == "jet_flow";
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
            step = core::usual_step(readings[c].time);
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

/// Readings of one clock: rows of all channels.
core::Table merged_piece(const std::string& log, const LogChannels& channels, std::vector<ChannelReadings>& readings,
                         core::Problems& problems) {
    for (std::size_t c = 0; c < readings.size(); ++c) {
        put_in_order(readings[c], channels.channels[c].quantity, log, problems);
    }
    const std::vector<double> rows = row_times(channels, readings);
    core::Table table;
    table.source = log;
    table.add_numbers("time", "s", rows);
    const double tolerance = rows.size() > 1 ? 0.01 * core::usual_step(rows) : 0;
    for (std::size_t c = 0; c < readings.size(); ++c) {
        const std::string& quantity = channels.channels[c].quantity;
        table.add_numbers(quantity, core::find_quantity(quantity)->unit,
                          makes_rows(quantity) ? at_rows(readings[c], rows)
                          : is_held(quantity)  ? held_at_rows(readings[c], rows, tolerance)
                                               : mean_at_rows(readings[c], rows));
    }
    return table;
}

/// Where a clock was set back for good: twenty readings follow that ascend and are all earlier than the one before.
std::vector<std::size_t> set_backs(const std::vector<double>& time) {
    constexpr std::size_t follow = 20;
    std::vector<std::size_t> places;
    for (std::size_t i = 1; i + follow <= time.size(); ++i) {
        const auto next = time.begin() + static_cast<std::ptrdiff_t>(i);
        if (time[i] < time[i - 1] && std::is_sorted(next, next + follow) && time[i + follow - 1] < time[i - 1]) {
            places.push_back(i);
        }
    }
    return places;
}

/// The same of a channel that is read too seldom for twenty readings to follow: in each piece of the gap's clock those
/// that ascend and are not later than its end. Nothing where they do not all have a place.
std::optional<std::vector<std::size_t>> seldom_set_backs(const std::vector<double>& time,
                                                         const std::vector<double>& end_of_piece) {
    std::vector<std::size_t> places;
    double last = -core::no_limit;
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (time[i] < last || (places.size() < end_of_piece.size() && time[i] > end_of_piece[places.size()])) {
            if (places.size() == end_of_piece.size()) {
                return {};  // set back more often than the gap
            }
            places.push_back(i);
        }
        last = time[i];
    }
    places.resize(end_of_piece.size(), time.size());  // not read after the last ones
    return places;
}

/// The readings of each clock, where all channels can have been set back as often as the gap; else all of them, as they
/// are.
std::vector<std::vector<ChannelReadings>> by_clock(const LogChannels& channels, std::vector<ChannelReadings> readings) {
    std::vector<std::vector<std::size_t>> places;
    std::optional<std::size_t> gap;
    for (std::size_t c = 0; c < readings.size(); ++c) {
        places.push_back(set_backs(readings[c].time));
        gap = channels.channels[c].quantity == "gap" ? std::optional(c) : gap;
    }
    if (places.empty()) {
        return {std::move(readings)};
    }
    const std::vector<std::size_t> chief = places[gap.value_or(0)];
    std::vector<double> ends;  // of the pieces but the last
    for (const std::size_t place : chief) {
        ends.push_back(readings[gap.value_or(0)].time[place - 1]);
    }
    for (std::size_t c = 0; c < readings.size(); ++c) {
        if (places[c].size() != chief.size()) {
            const auto seldom = seldom_set_backs(readings[c].time, ends);
            if (!seldom || makes_rows(channels.channels[c].quantity)) {
                return {std::move(readings)};
            }
            places[c] = *seldom;
        }
    }
    if (chief.empty()) {
        return {std::move(readings)};
    }
    std::vector<std::vector<ChannelReadings>> pieces(chief.size() + 1);
    for (std::size_t c = 0; c < readings.size(); ++c) {
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            const std::size_t first = p == 0 ? 0 : places[c][p - 1];
            const std::size_t last = p + 1 < pieces.size() ? places[c][p] : readings[c].time.size();
            const auto part = [&](const std::vector<double>& of) {
                return std::vector<double>(of.begin() + static_cast<std::ptrdiff_t>(first),
                                           of.begin() + static_cast<std::ptrdiff_t>(last));
            };
            pieces[p].push_back({part(readings[c].time), part(readings[c].value)});
            if (ChannelReadings& own = pieces[p].back();
                own.time.empty() && p > 0 && !pieces[p - 1][c].time.empty() && gap) {
                // not read since: what was read before still holds
                own.time.push_back(readings[*gap].time[chief[p - 1]]);
                own.value.push_back(pieces[p - 1][c].value.back());
            }
        }
    }
    return pieces;
}

/// The rows of one table after those of another with the same columns.
core::Table joined(const core::Table& first, const core::Table& then) {
    core::Table all;
    all.source = first.source;
    for (const core::Column& column : first.columns()) {
        std::vector<double> numbers = column.numbers;
        const std::vector<double>& more = then.numbers(column.name);
        numbers.insert(numbers.end(), more.begin(), more.end());
        all.add_numbers(column.name, column.unit, std::move(numbers));
    }
    return all;
}

}  // namespace

core::Table rows_of(const std::string& log, const LogChannels& channels, const std::vector<ChannelReadings>& readings,
                    const LogWindow& window, core::Problems& problems) {
    for (std::size_t c = 0; c < readings.size(); ++c) {
        const LogChannel& channel = channels.channels[c];
        if (std::none_of(readings[c].time.begin(), readings[c].time.end(), [](double t) { return std::isfinite(t); })) {
            throw core::InputError(
                "range",
                "no reading of " + channel.quantity + " in the log" +
                    (std::isfinite(window.begin) || std::isfinite(window.end) ? " between begin and end" : ""),
                channel.place, "`underbody info` says from when to when each message was logged");
        }
    }
    std::optional<core::Table> table;
    for (std::vector<ChannelReadings>& piece : by_clock(channels, readings)) {
        const core::Table own = merged_piece(log, channels, piece, problems);
        table = table ? joined(*table, own) : own;
    }
    return *table;
}

}  // namespace underbody::dynamics
