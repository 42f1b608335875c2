// What answers the readings of a coupled motion, from its logs, and runs once more with it in the loop.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/random.h"
#include "surrogates/discovery/motion/motion_experiment_design.h"

namespace underbody::discovery {

/// Linear answer of one logged input to readings: with d the difference from what was logged,
/// du_k = sum own[i] du_(k-1-i) + sum reading[c][i] dy_c,(k-first-i).
struct InputAnswer {
    std::string input;
    enum class Found {
        answers,  ///< as below
        none,     ///< the input does not follow the readings
        unread    ///< it does, but not so
    } found = Found::none;
    std::array<double, 2> own{};
    std::vector<std::array<double, 3>> reading;  ///< by channel of the rig
    /// 0: a reading acts on the input of its own row, held from there on; 1: of inputs linear between their rows.
    std::size_t first = 0;
};

/// Least squares over second differences, so that set points and what is slow do not matter; rows far off
/// (a step of a set point) are left out and the rest fitted again. One for each input of the rig.
std::vector<InputAnswer> read_controllers(const MotionRig& rig);

/// The run once more by this model: from the state at its begin, with the wave added to what its controllers command,
/// fresh noise of the sensors and random loads, and the controllers answering the readings that come of it.
dynamics::MeasuredRun run_again(const MotionRig& rig, const dynamics::Model& model, const MotionRecord& record,
                                const MotionTrial& trial, const std::vector<InputAnswer>& answers,
                                core::Random& random);

}  // namespace underbody::discovery
