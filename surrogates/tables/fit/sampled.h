// A table of a function that is known elsewhere (the forces of a model): taken at as many places as it takes to give
// the function back.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/support.h"

namespace underbody::tables {

struct SampledAxis {
    std::string name;
    std::string unit;             ///< SI
    double lower = 0, upper = 0;  ///< where the function is known; outside counts as outside
    RangePolicy range = RangePolicy::clamp;
    /// Ascending, at least two: between neighbours the function is smooth. The first and the last are the ends of the
    /// grid and may lie beyond lower and upper, where the function still changes.
    std::vector<double> lines;
    /// Lines at which its slope jumps.
    std::vector<double> kinks;
};

struct SampledFunction {
    std::string quantity, unit, kind, source;
    std::vector<SampledAxis> axes;                      ///< one to four
    std::function<double(const double*)> value, sigma;  ///< at a point, SI; sigma is one standard deviation, >= 0
    Support support;                                    ///< where it has data
    core::Table points;                                 ///< set points to show; the quantity among its columns
    std::vector<std::pair<std::string, double>> conditions;
    core::Problems remarks;
};

struct SamplingOptions {
    double tolerance = 1e-6;        ///< largest difference allowed, as a share of the range of the values
    double sigma_tolerance = 0.02;  ///< of the standard deviation, as a share of the largest
    std::size_t most_nodes = 500000;
};

/// Between its lines the function is taken at thirds; where a cubic through these misses it, or the error its straight
/// line, by more than allowed, the cells are halved. The standard deviation is never understated at the lines and in
/// the middles between them. Throws core::InputError when the lines span more than `most_nodes`. What came of it is
/// ForceTable::sampling_error(): rounding where the function is piecewise cubic along every axis (tables, sums of them,
/// times whole powers up to three) but for a width of 1e-8 of the axis beside a kink; where it is more than the
/// tolerance, a warning among the table's remarks says so.
ForceTable sampled_table(const SampledFunction& function, const SamplingOptions& options = {},
                         core::Progress& progress = core::Progress::none());

}  // namespace underbody::tables
