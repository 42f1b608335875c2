// What of a run's readings a model is judged by: one rule for predictions and discovery, so that both give one error.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "surrogates/dynamics/plant/contact_gap.h"

namespace underbody::dynamics {

/// Readings far from the middle of their neighbours (8 `sigma` and twice the neighbours' spread) become missing; how
/// many.
std::size_t drop_outliers(std::vector<double>& values, double sigma);

/// Readings at the ends of a sensor's range become missing: many at exactly one value, several in one piece, and hardly
/// any beyond (outliers may be). How many.
std::size_t drop_saturated(const std::vector<double>& time, std::vector<double>& values);

/// The longest stretch [first, last) of a run in which no reading lies outside the tables; beyond them nothing is known
/// of the force. Missing readings count as inside.
struct InsideTables {
    std::size_t first = 0, last = 0;
    double outside = 0;  ///< share of the readings that lie outside, 0..1
};
/// `gap` in m; `noise` is one standard deviation of a reading, m: a reading within six of them of a table is inside.
InsideTables longest_inside(std::span<const double> gap, const GapRange& tables, double noise);

/// Of a recorded input: rows of other sensors that stand between its samples say nothing of it, there it acts as
/// between samples, held or linear; before its first value it is that. False where it has no value at all.
bool fill_missing(const std::vector<double>& time, std::vector<double>& values, bool linear);

/// A heading that jumps by a turn goes on.
void unwrap(std::vector<double>& angle);

/// "(0.001 to 0.04 m)"
std::string range_text(const GapRange& tables);

/// What is said of readings that are not used; `time` (s) holds those of the stretch that is.
std::string outliers_text(const std::string& run, std::size_t count, const std::string& channel = "gap");
std::string saturated_text(const std::string& run, std::size_t count);
std::string outside_text(const std::string& run, const InsideTables& inside, const GapRange& tables);
std::string unused_text(const std::string& run, const InsideTables& inside, const GapRange& tables,
                        std::span<const double> time);

}  // namespace underbody::dynamics
