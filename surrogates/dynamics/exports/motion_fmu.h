// The motion of a model as an FMU 2.0: states, derivatives, inputs, contact, for model exchange and co-simulation.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

enum class FmuMotion { heave, heave_pitch, body };

struct MotionFmuOptions {
    FmuMotion motion = FmuMotion::heave;
    Conditions held;         ///< over those of the model
    std::string name;        ///< model identifier; empty: that of the file
    bool overwrite = false;  ///< also a file that is no FMU of this program
    /// Start of the states (FmuMotion::heave: gap, heave_velocity; heave_pitch: and pitch, pitch_rate; body:
    /// BodyState).
    std::vector<double> start;
};

struct MotionFmuVariable {
    std::string name, unit, meaning;
    double start = 0;
};

struct MotionFmu {
    std::filesystem::path file;
    /// Inputs are input_force, the jets of a body, and every channel that scales a force or is an axis of its table and
    /// that the motion does not bring itself.
    std::vector<MotionFmuVariable> inputs, states, outputs;
    std::size_t start_states = 0;  ///< how many of the states have a start of their own; the rest follow from these
    core::Problems remarks;
};

/// Writes C that evaluates the equations of simulate() with the numbers of the model, compiles it (see write_fmu) and
/// packs it. Directional derivatives are exact. In co-simulation the FMU integrates by itself (Dormand and Prince,
/// relative tolerance 1e-10 or the experiment's). Throws core::InputError: what the model lacks for the motion, a start
/// in the ground, effects that C cannot carry (those are named), a file that is there and was not written by this
/// program.
MotionFmu export_motion_fmu(const Model& model, const std::filesystem::path& path, const MotionFmuOptions& options);

/// The names by which a motion's FMU is asked for: heave, heave-pitch, body.
const std::vector<std::string>& fmu_motions();

}  // namespace underbody::dynamics
