// Columns of a measured run as the model's [records] say that they are to be read.
#pragma once

#include <string>
#include <vector>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave.h"

namespace underbody::dynamics {

/// Known inputs and conditions of a run: columns that vary become signals, constant ones and conditions are held. The
/// input as `records` says that it is to be read; held between samples where they do not say.
InputSignals signals_of(const MeasuredRun& run, const RecordReading& records = {});
/// A measured column as `records` says that it is to be read; empty when there is none. Where input_force has no value
/// (rows of other sensors) it is held from the value before, or linear to the next one, as between its samples.
std::vector<double> as_read(const MeasuredRun& run, const std::string& channel, const RecordReading& records);
/// A recorded input that is a column alone (input_moment, thrust_NAME) as it acted, sample by sample: where the records
/// come late, each value is the mean of what was held from its sample to the next, or what the line between the samples
/// has. False where it has no value at all.
bool as_acted(const MeasuredRun& run, const std::string& column, const RecordReading& records,
              std::vector<double>& values);
/// The set point of row `row` of a static run.
Conditions set_point_of(const MeasuredRun& run, std::size_t row);

}  // namespace underbody::dynamics
