#include "surrogates/dynamics/simulate/read_records.h"

#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/plant/actuator.h"
#include "surrogates/dynamics/simulate/clean_readings.h"

namespace underbody::dynamics {

std::vector<double> as_read(const MeasuredRun& run, const std::string& channel, const RecordReading& records) {
    std::vector<double> values = run.has(channel) ? run.values(channel) : std::vector<double>{};
    const double factor = records.factor_of(channel);
    for (double& value : values) {
        value *= factor;
    }
    if (channel == "input_force" && run.table.find("time") != nullptr) {
        fill_missing(run.table.numbers("time"), values, records.input_between == RecordReading::Between::linear);
    }
    return values;
}

bool as_acted(const MeasuredRun& run, const std::string& column, const RecordReading& records,
              std::vector<double>& values) {
    const bool linear = records.input_between == RecordReading::Between::linear;
    const std::vector<double>& time = run.table.numbers("time");
    values = as_read(run, column, records);
    if (!fill_missing(time, values, linear)) {
        return false;
    }
    if (records.others_advance == 0) {
        return true;
    }
    std::vector<double> earlier(values.size());
    if (linear) {
        for (std::size_t k = 0; k < time.size(); ++k) {
            const double t = time[k] + records.others_advance;
            const auto after = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
            earlier[k] = after == 0            ? values.front()
                         : after < time.size() ? std::lerp(values[after - 1], values[after],
                                                           (t - time[after - 1]) / (time[after] - time[after - 1]))
                                               : values.back();
        }
    } else {
        Actuator clock;
        clock.delay = -records.others_advance;
        clock.mean_over_steps(time, values, true, time, earlier);  // each up to its row: held over the rows before
        earlier.erase(earlier.begin());
        earlier.push_back(values.back());
    }
    values = std::move(earlier);
    return true;
}

InputSignals signals_of(const MeasuredRun& run, const RecordReading& records) {
    InputSignals signals;
    signals.time = run.table.numbers("time");
    // A digital controller holds its command from sample to sample.
    signals.input_between = records.input_between == RecordReading::Between::linear ? InputSignals::Between::linear
                                                                                    : InputSignals::Between::held;
    signals.input_advance = records.input_advance;
    for (const auto& [name, value] : run.conditions) {
        Channel channel{};
        if (find_channel(name, channel)) {
            signals.held[channel] = value;
        }
    }
    for (const core::Column& column : run.table.columns()) {
        Channel channel{};
        if (column.is_text() || !find_channel(column.name, channel) || channel == Channel::time ||
            channel == Channel::gap || channel == Channel::heave_velocity) {
            continue;
        }
        double low = 1e300, high = -1e300;
        for (const double value : column.numbers) {
            low = std::isfinite(value) ? std::min(low, value) : low;
            high = std::isfinite(value) ? std::max(high, value) : high;
        }
        if (high < low) {
            continue;
        }
        if (high > low) {
            signals.signals.push_back({channel, as_read(run, column.name, records)});
        } else {
            signals.held[channel] = low * (channel == Channel::input_force ? records.input_factor : 1);
        }
    }
    return signals;
}

Conditions set_point_of(const MeasuredRun& run, std::size_t row) {
    Conditions point;
    for (const auto& [name, value] : run.conditions) {
        Channel channel{};
        if (find_channel(name, channel)) {
            point[channel] = value;
        }
    }
    for (const core::Column& column : run.table.columns()) {
        Channel channel{};
        if (!column.is_text() && find_channel(column.name, channel) && std::isfinite(column.numbers[row])) {
            point[channel] = column.numbers[row];
        }
    }
    return point;
}

}  // namespace underbody::dynamics
