// A run whose clock was set while it was logged, or that pauses, is several runs.
#pragma once

#include <vector>

#include "surrogates/dynamics/model/measurements.h"

namespace underbody::dynamics {

/// The runs that a time series is made of, in the order of its rows; each has ascending times. It is cut
/// - where its clock goes on by more than thirty days (a record that began in 1970 until GPS or NTP set the clock) or
///   is set back: how long the rows there took is not known, so that times are counted on by the usual step;
/// - where nothing was logged for more than a minute and for a hundred of the usual steps: times stay.
/// A piece of fewer than twenty rows, or of less than a tenth of the longest, is left out; where more than a quarter of
/// the rows would be, nothing is cut at pauses. Pieces after the first are called "NAME piece 2" and so on. What was
/// done is said in `problems`, with the line. Throws core::InputError: time that stands still, or whose clock is set
/// where more than a quarter of the rows would be left out.
std::vector<MeasuredRun> pieces_of(const MeasuredRun& run, core::Problems& problems);

/// Runs on an absolute clock (it begins more than three years after its zero: seconds since 1970) are counted from the
/// first reading of the earliest of them, to a whole second: laws over time are of the time since then.
/// MeasuredRun::clock_offset has what was taken off. A note says so.
void count_from_first_reading(Measurements& data);

}  // namespace underbody::dynamics
