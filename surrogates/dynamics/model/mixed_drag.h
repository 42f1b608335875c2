// The mixed drag law as plain numbers.
#pragma once

namespace underbody::dynamics {

/// The mixed law: linear below Reynolds number 1, quadratic above 1000, a quintic between that is C2 at both ends.
/// F = c0 + c1 s + ... + c5 s^5 with s = (|w| - w1)/(w2 - w1), odd extension. (docs/physics.md, section 6.2.)
struct MixedDrag {
    double w1 = 0, w2 = 0;  ///< m/s
    double c[6] = {};
    double linear = 0, quadratic = 0;
    bool monotone = true;  ///< false: the quintic falls somewhere (linear/(quadratic w2) > 2.382)
    MixedDrag() = default;
    MixedDrag(double linear, double quadratic, double length, double kinematic_viscosity);
    double operator()(double w) const;
    [[nodiscard]] double slope(double w) const;
    [[nodiscard]] double curvature(double w) const;
};

}  // namespace underbody::dynamics
