// The loads of a run in time: means, with errors that know how the values hang together.
#pragma once

#include <string>
#include <vector>

#include "postproc/loads/loads_table.h"

namespace underbody::postproc {

/// One load along a run in time, in the order of the times.
struct TimeHistory {
    std::string quantity;
    std::string unit;  ///< "N" or "N m"
    std::vector<double> values;
};

/// What the means of these loads are worth.
struct TimeMeans {
    std::vector<std::pair<std::string, double>> sigmas;  ///< standard uncertainty of each mean (mean_in_time)
    double correlation_time = 1;                         ///< of the lift, in samples
    Settled settled;                                     ///< do the values drift?
};

/// `force` (N), `length` (m): what a drift counts against. `file`: that of the run, for the verdict. Throws
/// core::InputError: values that are not finite, fewer than two.
TimeMeans time_means(const std::vector<TimeHistory>& loads, double force, double length, const std::string& file);

/// Throws core::InputError (duplicate) when two of the `times` (ascending) are one; warns of unequal steps. `files`: of
/// each.
void check_times(const std::vector<double>& times, const std::vector<std::string>& files, core::Problems& notes);

/// Cases that differ in their time alone (the field's own, else the condition `time`) become one, in place of the
/// first: its loads are the means over the times, the standard uncertainty of each (LoadsCase::sigmas) that of the
/// mean, with as many independent values as the correlation along the run leaves (mean_in_time); the verdict says
/// whether the values drift. The conditions `samples`, `first_time`, `last_time` and `correlation_time` (of the lift,
/// in samples) are added. Cases that stand alone stay as they are. Runs are told apart by all conditions but
/// the time and loads that somebody states (is_result). Throws core::InputError: a case among others that has no time,
/// two of one time.
std::vector<LoadsCase> means_in_time(const std::vector<LoadsCase>& cases, core::Problems& notes);

}  // namespace underbody::postproc
