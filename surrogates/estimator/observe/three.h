// Three-by-three algebra of the extended filter; for .cpp files of this room only.
#pragma once

#include <array>
#include <cstddef>

namespace underbody::estimator::internal {

using State = std::array<double, 3>;   // gap, velocity, departure
using Square = std::array<double, 9>;  // row-major

inline Square product(const Square& a, const Square& b) {
    Square c{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t j = 0; j < 3; ++j) {
                c[3 * i + j] += a[3 * i + k] * b[3 * k + j];
            }
        }
    }
    return c;
}

inline Square transposed(const Square& a) { return {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]}; }

inline Square inverse_of(const Square& a) {
    Square c{a[4] * a[8] - a[5] * a[7], a[2] * a[7] - a[1] * a[8], a[1] * a[5] - a[2] * a[4],
             a[5] * a[6] - a[3] * a[8], a[0] * a[8] - a[2] * a[6], a[2] * a[3] - a[0] * a[5],
             a[3] * a[7] - a[4] * a[6], a[1] * a[6] - a[0] * a[7], a[0] * a[4] - a[1] * a[3]};
    const double determinant = a[0] * c[0] + a[1] * c[3] + a[2] * c[6];
    for (double& v : c) {
        v /= determinant;
    }
    return c;
}

}  // namespace underbody::estimator::internal
