// Regions of any motion in a plane: for systems that are not a vehicle's heave (tests, controllers, reduced models).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/dynamics/basin/region.h"

namespace underbody::dynamics {

/// x' = f(x, y), y' = g(x, y). `rate` is called from many threads.
struct PlanarSystem {
    std::function<void(const double* state, double* rate)> rate;
    std::vector<std::array<double, 2>> seeds;  ///< where to look for equilibria (Newton); none: a grid over the bounds
    double x_lower = 0, x_upper = 0, y_lower = 0, y_upper = 0;  ///< leaving these bounds is escape
};

struct PlanarRegion {
    std::vector<core::NamedRange> axes;
    std::size_t columns = 0, rows = 0;
    std::vector<int> index;
    std::vector<EndClass> classes;  ///< attractors "A", "B", ...; cycles "cycle 1", ...; escape; undecided
    std::vector<std::array<double, 2>> attractors;           ///< in the order of their classes
    std::vector<std::vector<std::array<double, 2>>> cycles;  ///< one turn of each limit cycle found
    [[nodiscard]] double fraction(const std::string& name) const;
};

/// Ends of starts on a grid over `axes` (two ranges), each followed for `duration` at most. An attractor's starts are
/// taken once inside a level set of a Lyapunov function of its linear motion that falls on every shell (checked at
/// points); a cycle is one that comes back to its own Poincare section within 1e-6 of the bounds three times running.
PlanarRegion planar_region(const PlanarSystem& system, const std::vector<core::NamedRange>& axes, std::size_t columns,
                           std::size_t rows, double duration, double tolerance = 1e-8,
                           core::Progress& progress = core::Progress::none());

/// Area enclosed by a closed line, by the trapezium rule.
double enclosed_area(const std::vector<std::array<double, 2>>& line);

}  // namespace underbody::dynamics
