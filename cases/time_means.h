// Runs in time: the loads of many instants as those of one case.
#pragma once

#include <vector>

#include "cases/study.h"

namespace underbody::cases {

/// The loads of the study's cases with one entry for each run in time (Case::mean): files that differ in their time
/// alone become their mean, in place of the first, with the error of the mean (QUANTITY_sigma) and the verdict whether
/// they drift (postproc::time_means). The others stay as they are. A run of one time, or with a file without loads,
/// stays as it is; that, and unequal steps, are told in the warnings of its first file in `loads`.
std::vector<CaseLoads> with_means_in_time(const Study& study, std::vector<CaseLoads>& loads);

}  // namespace underbody::cases
