#include "surrogates/dynamics/model/drag.h"

#include <cmath>

namespace underbody::dynamics {

MixedDrag::MixedDrag(double linear_in, double quadratic_in, double length, double kinematic_viscosity)
    : w1(kinematic_viscosity / length),
      w2(1000 * kinematic_viscosity / length),
      linear(linear_in),
      quadratic(quadratic_in) {
    const double width = w2 - w1;
    const double f0 = linear * w1, d0 = linear, e0 = 0;
    const double f1 = quadratic * w2 * w2, d1 = 2 * quadratic * w2, e1 = 2 * quadratic;
    const double rise = f1 - f0;
    c[0] = f0;
    c[1] = width * d0;
    c[2] = width * width * e0 / 2;
    c[3] = 10 * rise - width * (6 * d0 + 4 * d1) - width * width * (3 * e0 - e1) / 2;
    c[4] = -15 * rise + width * (8 * d0 + 7 * d1) + width * width * (3 * e0 - 2 * e1) / 2;
    c[5] = 6 * rise - 3 * width * (d0 + d1) - width * width * (e0 - e1) / 2;
    // of the two laws at w2, up to which the quintic between them does not fall
    constexpr double monotone_ratio = 2.382;
    monotone = !(quadratic > 0) || linear / (quadratic * w2) <= monotone_ratio;
}

double MixedDrag::operator()(double w) const {
    const double a = std::abs(w);
    double force = 0;
    if (a <= w1) {
        force = linear * a;
    } else if (a >= w2) {
        force = quadratic * a * a;
    } else {
        const double s = (a - w1) / (w2 - w1);
        force = c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
    }
    return std::copysign(force, w);
}

double MixedDrag::slope(double w) const {
    const double a = std::abs(w);
    if (a <= w1) {
        return linear;
    }
    if (a >= w2) {
        return 2 * quadratic * a;
    }
    const double s = (a - w1) / (w2 - w1);
    return (c[1] + s * (2 * c[2] + s * (3 * c[3] + s * (4 * c[4] + s * 5 * c[5])))) / (w2 - w1);
}

double MixedDrag::curvature(double w) const {
    const double a = std::abs(w);
    double second = 0;
    if (a >= w2) {
        second = 2 * quadratic;
    } else if (a > w1) {
        const double s = (a - w1) / (w2 - w1);
        second = (2 * c[2] + s * (6 * c[3] + s * (12 * c[4] + s * 20 * c[5]))) / ((w2 - w1) * (w2 - w1));
    }
    return std::copysign(second, w);
}

double drag(const DragLaw& law, const Environment& environment, double w, double* slope) {
    if (law.kind == DragLaw::Kind::mixed) {
        const MixedDrag mixed(law.linear, law.quadratic, law.length, environment.kinematic_viscosity);
        if (slope) {
            *slope = mixed.slope(w);
        }
        return mixed(w);
    }
    if (slope) {
        *slope = law.linear + 2 * law.quadratic * std::abs(w);
    }
    return law.linear * w + law.quadratic * w * std::abs(w);
}

}  // namespace underbody::dynamics
