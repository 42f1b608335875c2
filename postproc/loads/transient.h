// The loads of a run in time: means, with errors that know how the values hang together.
#pragma once

#include <string>
#include <vector>

#include "postproc/loads/loads_table.h"

namespace underbody::postproc {

/// Cases that differ in their time alone (the field's own, else the condition `time`) become one, in place of the
/// first: its loads are the means over the times, the standard uncertainty of each (LoadsCase::sigmas) that of the
/// mean, with as many independent values as the correlation along the run leaves (mean_in_time); the verdict says
/// whether the values drift. The conditions `samples`, `first_time`, `last_time` and `correlation_time` (of the lift,
/// in samples) are added. Cases that stand alone stay as they are. Conditions that tell runs apart are those of
/// mesh_studies. Throws core::InputError: a case among others that has no time, two of one time.
std::vector<LoadsCase> means_in_time(const std::vector<LoadsCase>& cases, core::Problems& notes);

}  // namespace underbody::postproc
