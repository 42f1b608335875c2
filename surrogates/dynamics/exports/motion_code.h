// The numbers of a motion as C: what stands between the parts in exports/c. For the files of this folder only.
#pragma once

#include <string>
#include <vector>

#include "surrogates/dynamics/exports/motion_fmu.h"
#include "surrogates/dynamics/plant/heave.h"

namespace underbody::dynamics {

/// Parts of the C by their file names (exports/c), compiled into the library.
const std::string& c_part(const std::string& name);

/// A motion with all that its C needs.
struct MotionSource {
    const Model& model;  ///< resolved
    FmuMotion motion;
    Conditions held;
    std::vector<Channel> own;      ///< channels that the motion itself brings
    std::vector<Channel> varying;  ///< channels that are inputs
    const HeavePlant& vertical;    ///< heave: with its force tables; else the vertical channel without them
    MotionFmu& fmu;                ///< inputs and states stand in it

    [[nodiscard]] bool moves(Channel channel) const;  ///< own or varying
};

/// Everything but the GUID.
std::string motion_code(const MotionSource& source);

}  // namespace underbody::dynamics
