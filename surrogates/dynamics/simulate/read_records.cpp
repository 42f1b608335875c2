#include "surrogates/dynamics/simulate/read_records.h"

#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/simulate/clean_readings.h"

namespace underbody::dynamics {

std::vector<double> as_read(const MeasuredRun& run, const std::string& channel, const RecordReading& records) {
    std::vector<double> values = run.has(channel) ? run.values(channel) : std::vector<double>{};
    const double factor = channel == "input_force"      ? records.input_factor
                          : channel == "heave_velocity" ? records.velocity_factor
                                                        : 1;
    for (double& value : values) {
        value *= factor;
    }
    if (channel == "input_force" && run.table.find("time") != nullptr) {
        fill_missing(run.table.numbers("time"), values, records.input_between == RecordReading::Between::linear);
    }
    return values;
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
