// Which of several times in a file is wanted.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace underbody::postproc {

/// Place of `wanted` [s] among `times`, to six digits; throws InputError that names the nearest when it is not there.
std::size_t step_at(const std::vector<double>& times, double wanted, const std::string& file);

}  // namespace underbody::postproc
