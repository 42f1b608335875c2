// modelDescription.xml of a motion. For the files of this folder only.
#pragma once

#include <string>

#include "surrogates/dynamics/exports/motion_code.h"

namespace underbody::dynamics {

/// Variables in the order of their references: inputs, states, derivatives of the states, outputs.
std::string motion_description(const MotionSource& source, const std::string& name, const std::string& guid);

}  // namespace underbody::dynamics
