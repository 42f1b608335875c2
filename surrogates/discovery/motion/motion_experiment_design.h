// Which runs of a coupled motion would separate what its data leave tied.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/motion/motion_filter.h"

namespace underbody::discovery {

/// What the runs were made with.
struct MotionRig {
    const dynamics::Motion& motion;
    dynamics::Model model;  ///< as declared, with its logs as they are read
    const dynamics::Measurements& data;
    const std::vector<MotionRecord>& records;
    std::vector<std::string> inputs;  ///< columns that move
    std::vector<std::size_t> channels;
    MotionNoise noise;
};

/// The longest run once more, with steps or a sine added to one of its inputs.
struct MotionTrial {
    std::string text;
    std::string input, unit;
    std::vector<double> time, added;  ///< s; of what acts, N or N m
    double separation = 0;  ///< of two explanations: root of the summed squares of their difference over the noise
};

/// What an experiment is to decide between.
struct MotionQuestion {
    std::string purpose;
    std::size_t one = 0;               ///< index into the fitted hypotheses
    std::optional<std::size_t> rival;  ///< another one; nothing: the model as declared
    std::vector<dynamics::EffectUse> one_uses, rival_uses;
};

/// How often an experiment settles a question, done so many times (MotionLoop::chance_to_settle_by).
struct MotionPromise {
    double chance = 0;
    std::string controller;  ///< what is said of who answers the wave
};
using MotionPromises = std::function<MotionPromise(const MotionTrial& trial, std::size_t repeats)>;

/// The run of the experiment.
const MotionRecord& longest_record(const MotionRig& rig);

/// The one in which two explanations differ most first, by windows of 2 s that begin where the run was: what a
/// controller does about the wave within a window is not in it. Nothing where the inputs do not move.
std::vector<MotionTrial> motion_trials(const MotionRig& rig, const std::vector<dynamics::EffectUse>& one,
                                       const std::vector<dynamics::EffectUse>& other);

/// One sentence on it.
std::string motion_told_apart(const MotionRig& rig, const FittedHypothesis& chosen, const FittedHypothesis& rival);

/// What the next experiment is to decide; nothing where there is nothing to ask.
std::optional<MotionQuestion> motion_question(const MotionRig& rig, const std::vector<FittedHypothesis>& fitted,
                                              const Attribution& attribution, const Discovery& result);

/// Fills next_experiment, next_set_points (time, what is added to the input) and next_power.
void next_motion_experiment(const MotionRig& rig, const std::optional<MotionQuestion>& question,
                            const MotionPromises& promised, Discovery& result);

}  // namespace underbody::discovery
