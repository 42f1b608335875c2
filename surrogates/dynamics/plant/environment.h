// What the outside brings to a moving body at a moment: recorded inputs, conditions, the memory of the water.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "surrogates/dynamics/plant/heave.h"

namespace underbody::dynamics {

struct Surroundings {
    double t = 0;
    double input = std::numeric_limits<double>::quiet_NaN();  ///< N up at the centre of gravity; NaN: as held
    const double* channels = nullptr;                         ///< channel_count values; nullptr: as held
    const double* memory = nullptr;                           ///< history_states values of the history force
    double force = 0;   ///< N up at the centre of gravity, beside everything else: heave with pitch alone
    double moment = 0;  ///< N m nose up, beside everything else (a recorded input_moment): heave with pitch alone
};

/// The model's heave channel without its force tables: weight, drag in heave, effects. What coupled motions share with
/// heave alone.
HeavePlant vertical_channel(const Model& resolved, const Conditions& held, const std::vector<Channel>& varying);

/// Recorded inputs of a coupled motion; none: everything held. The plant and the signals must live longer.
class RecordedInputs {
public:
    RecordedInputs(const HeavePlant& vertical, const InputSignals& inputs);
    /// Valid until the next call. `memory` is handed through.
    [[nodiscard]] Surroundings at(double t, const double* memory = nullptr);
    /// Longest step that misses no corner of the inputs and no wave, s; 0: any.
    [[nodiscard]] double max_step() const;

private:
    const HeavePlant& vertical_;
    std::unique_ptr<HeaveRun> run_;
    std::vector<double> buffer_;
};

/// Channels that the signals vary.
std::vector<Channel> varying_channels(const InputSignals& inputs);

/// Effects of the model that change what instruments of a static set read, and so leave a motion as it is.
core::Problems effects_without_motion(const Model& model);
/// Remarks of the model, on such effects, and on conditions held beyond a table.
core::Problems motion_remarks(const Model& model, const Conditions& held);

}  // namespace underbody::dynamics
