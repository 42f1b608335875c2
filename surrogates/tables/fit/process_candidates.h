// Which coordinates, known laws and kernel suit the points of a table best. For the files of this room only.
#pragma once

#include <cmath>
#include <vector>

#include "surrogates/tables/fit/process_form.h"

namespace underbody::tables {

/// A form with a kernel, fitted to the points (or a share of them).
struct ProcessCandidate {
    Form form;
    GpOptions options;  ///< starts with the fitted parameters
    double score = -INFINITY;
};

/// All candidates, the best by leave-one-out score first.
std::vector<ProcessCandidate> ranked_candidates(const SetPoints& points);

/// Middle of the prior of the scatter. Points without stated errors are mostly computed ones: little is expected beside
/// the stated error.
inline double expected_scatter(const SetPoints& points) { return points.has_sigma() ? 1e-3 : 1e-2; }

/// The numbers 0 to count - 1.
std::vector<std::size_t> all_rows(std::size_t count);

}  // namespace underbody::tables
