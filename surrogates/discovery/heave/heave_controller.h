// How the controller of a rig answers readings, from its logs: twins of the runs need it in their loop.
#pragma once

#include <array>
#include <vector>

#include "surrogates/discovery/heave/heave_record.h"

namespace underbody::discovery {

/// Linear answer of the input to readings before it:
/// du_k = sum input[i] du_(k-1-i) + sum reading[i] dy_(k-1-i), d: difference from what was logged.
struct ControllerAnswer {
    std::array<double, 2> input{};    ///< 1
    std::array<double, 3> reading{};  ///< N/m
};

/// Least squares over all steps of the chosen records, with a set point of its own for each; steps of the set point
/// (far off the fit) are left out and the rest fitted again. All zeros where no input was recorded.
ControllerAnswer fit_controller(const HeaveRecords& records, const std::vector<std::size_t>& chosen);

}  // namespace underbody::discovery
