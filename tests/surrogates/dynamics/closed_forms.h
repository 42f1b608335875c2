// What tests hold the linear motion and the jets against.
#pragma once

#include <Eigen/LU>
#include <vector>

#include "surrogates/dynamics/linear/linear.h"
#include "surrogates/dynamics/model/jets.h"

namespace underbody::dynamics::test {

/// Rank of the map from thrusts to the named components (0..2 force, 3..5 moment).
inline Eigen::Index rank_of(const std::vector<Jet>& jets, const std::vector<int>& components) {
    Eigen::MatrixXd map(components.size(), jets.size());
    for (std::size_t j = 0; j < jets.size(); ++j) {
        std::vector<double> thrust(jets.size(), 0.0);
        thrust[j] = 1;
        const Wrench wrench = jet_wrench(jets, thrust);
        for (std::size_t i = 0; i < components.size(); ++i) {
            const auto k = static_cast<std::size_t>(components[i]);
            map(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
                k < 3 ? wrench.force[k] : wrench.moment[k - 3];
        }
    }
    return Eigen::FullPivLU<Eigen::MatrixXd>(map).setThreshold(1e-10).rank();
}

/// Sliding ahead, about a trim (docs/physics.md section 3).
inline LinearSystem surface_system(const SurfaceCoefficients& c, double speed, double friction_force) {
    LinearSystem system;
    system.states = {"u", "v", "r", "psi"};
    system.inputs = {"X", "Y", "N"};
    system.a = Matrix{{-2 * c.drag_x * speed / c.mass_x, 0, 0, 0},
                      {0, -friction_force / (speed * c.mass_y), -c.mass_x * speed / c.mass_y, 0},
                      {0, c.munk * speed / c.inertia_r, 0, 0},
                      {0, 0, 1, 0}};
    system.b = Matrix{{1 / c.mass_x, 0, 0}, {0, 1 / c.mass_y, 0}, {0, 0, 1 / c.inertia_r}, {0, 0, 0}};
    system.state_trim = {speed, 0, 0, 0};
    system.input_trim = {c.drag_x * speed * speed + friction_force, 0, 0};
    return system;
}

}  // namespace underbody::dynamics::test
