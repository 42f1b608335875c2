// How evenly a plan of points fills the unit cube.
#pragma once

#include <algorithm>
#include <cmath>

#include "surrogates/tables/search/sampling.h"

namespace underbody::test {

/// Centred L2 discrepancy (Hickernell 1998): how unevenly the points fill the cube.
inline double discrepancy(const tables::Plan& plan) {
    if (plan.empty()) {
        return 0;
    }
    const auto n = static_cast<double>(plan.size());
    const std::size_t axes = plan.front().size();
    double one = 0, two = 0;
    for (const auto& x : plan) {
        double product = 1;
        for (const double c : x) {
            const double d = std::abs(c - 0.5);
            product *= 1 + 0.5 * d - 0.5 * d * d;
        }
        one += product;
        for (const auto& y : plan) {
            product = 1;
            for (std::size_t a = 0; a < axes; ++a) {
                product *= 1 + 0.5 * std::abs(x[a] - 0.5) + 0.5 * std::abs(y[a] - 0.5) - 0.5 * std::abs(x[a] - y[a]);
            }
            two += product;
        }
    }
    return std::sqrt(std::max(0.0, std::pow(13.0 / 12, static_cast<double>(axes)) - 2 / n * one + two / (n * n)));
}

}  // namespace underbody::test
