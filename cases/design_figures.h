// Pictures of a design search, for its report.
#pragma once

#include <vector>

#include "cases/design.h"
#include "core/figure.h"

namespace underbody::cases {

/// Predicted against computed, each shape left out once: with bands.
core::Figure left_out_figure(const tables::Surrogate& surrogate);
core::Figure sensitivity_figure(const LearnedNumber& number, const tables::SobolIndices& indices);

struct OneAtATime {
    double at = 0, value = 0, sigma = 0;  ///< SI
};
/// `count` points over the range of one variable, the others held at `at` (SI).
std::vector<OneAtATime> along(const LearnedNumber& number, std::vector<double> at, std::size_t variable,
                              std::size_t count);
/// The middle of every range.
std::vector<double> middle_of(const std::vector<tables::SearchVariable>& variables);
/// A curve a variable, through `at`.
core::Figure one_at_a_time_figure(const LearnedNumber& number, const std::vector<double>& at);

/// The best valid value of the first objective by the order of the runs.
core::Figure convergence_figure(const Design& design, const tables::DesignSearch& search);
/// The first two objectives against each other, with bodies drawn at their points.
core::Figure front_figure(const Design& design, const tables::DesignSearch& search,
                          const std::vector<tables::Candidate>& front, const std::vector<tables::Candidate>& known,
                          core::Progress& progress);
/// Six designs of a front, from one of its ends to the other: sections and under sides at one scale.
core::Figure bodies_figure(const Design& design, const std::vector<tables::Candidate>& designs,
                           core::Progress& progress);
/// Parallel coordinates: numbers of the shape, then objectives.
core::Figure parallel_figure(const tables::DesignSearch& search, const std::vector<tables::Candidate>& known,
                             const std::vector<tables::Candidate>& front);
/// Where the plan lies over two of the variables.
core::Figure coverage_figure(const Design& design, std::size_t x, std::size_t y);

}  // namespace underbody::cases
