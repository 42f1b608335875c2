// Does a number differ from run to run, though the rig is one? A sensor's zero that was set anew for each run, a clock
// that started late in some: no effect that is the same in all runs shows it, and its mean may be nought.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "surrogates/discovery/calibration.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/flexible.h"
#include "surrogates/discovery/hypothesis.h"

namespace underbody::discovery {

/// Innovations of the model as declared, of all runs one after the other.
struct RunsInnovations {
    std::vector<double> value;
    std::vector<std::size_t> begin;  ///< of each run, and the end of the last
    std::vector<std::string> runs;
};

/// What a loop gives.
struct ByRunQuestions {
    /// Innovations with an effect.
    std::function<std::vector<double>(const std::vector<dynamics::EffectUse>&)> innovations;
    /// Chance that noise alone, which is like `left`, surprises as much in any of the columns.
    std::function<double(const std::vector<const DesignMatrix*>&, const std::vector<double>& left, double surprise)>
        chance;
    double law = 0;  ///< surprise of a law that is the same in all runs: over time, say
};

/// The number that differs most beside what all runs have in common, of every candidate that has one number: none where
/// noise makes as much often enough, or no run is far from the others.
std::optional<DiffersByRun> number_by_run(const std::vector<Hypothesis>& candidates, const RunsInnovations& runs,
                                          const ByRunQuestions& ask, const Calibration& calibration);

}  // namespace underbody::discovery
