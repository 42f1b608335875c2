// The times of a field that was read from a file with several.
#pragma once

#include <vector>

namespace underbody::postproc {

struct Field;

/// s, rising; empty for a file of one time, or of several whose times it does not state. Each may be
/// ReadOptions::time.
std::vector<double> stated_times(const Field& field);

/// For importers: notes them in the metadata, as "times" for people ("12 from 0 to 0.55") and as "time_values".
void state_times(Field& field, std::vector<double> times);

}  // namespace underbody::postproc
