// What is odd about a static data set: said before anybody trusts a verdict from it.
#pragma once

#include <vector>

#include "core/error.h"
#include "surrogates/discovery/static/static_experiment.h"

namespace underbody::discovery {

/// Throws core::InputError when every reading lies outside the range of a declared table: there is nothing to compare.
void refuse_outside_tables(const StaticExperiment& experiment, const dynamics::Measurements& data);

/// Remarks on the readings and the set points: sensors that stand still or are clipped, columns that look swapped,
/// forces or gaps that look wrong by a unit, set points outside the declared tables, readings that stand there twice,
/// channels that did not vary or ran together.
core::Problems check_static_data(const StaticExperiment& experiment, const dynamics::Measurements& data);

/// Runs whose readings at the same set points disagree by more than their noise, `residuals` being what the best
/// explanation leaves of the chosen observations, in noise.
core::Problems check_runs_agree(const StaticExperiment& experiment, const dynamics::Measurements& data,
                                const std::vector<std::size_t>& chosen, const std::vector<double>& residuals);

/// Readings far from everything else: beyond six standard deviations of what the best explanation and a smooth law
/// leave (`residuals`, in noise), at most one in fifty; more than that is no accident and stays in.
std::vector<std::size_t> accidents(const std::vector<double>& residuals);

}  // namespace underbody::discovery
