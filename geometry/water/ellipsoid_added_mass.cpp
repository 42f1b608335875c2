#include "geometry/water/ellipsoid_added_mass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace underbody::geometry {

double carlson_rd(double x, double y, double z) {
    double sum = 0, power = 1;
    double mean = (x + y + 3 * z) / 5;
    const double largest = std::max({std::abs(mean - x), std::abs(mean - y), std::abs(mean - z)});
    double distance = largest * std::pow(1e-16 / 4, -1.0 / 6);
    while (power * distance > std::abs(mean)) {
        const double rx = std::sqrt(x), ry = std::sqrt(y), rz = std::sqrt(z);
        const double lambda = rx * ry + ry * rz + rz * rx;
        sum += power / (rz * (z + lambda));
        power /= 4;
        x = (x + lambda) / 4, y = (y + lambda) / 4, z = (z + lambda) / 4;
        mean = (mean + lambda) / 4;
    }
    const double X = (mean - x) / mean, Y = (mean - y) / mean, Z = -(X + Y) / 3;
    const double xy = X * Y, zz = Z * Z;
    const double e2 = xy - 6 * zz, e3 = (3 * xy - 8 * zz) * Z, e4 = 3 * (xy - zz) * zz, e5 = xy * zz * Z;
    const double series = 1 - 3 * e2 / 14 + e3 / 6 + 9 * e2 * e2 / 88 - 3 * e4 / 22 - 9 * e2 * e3 / 52 + 3 * e5 / 26;
    return power * series / (mean * std::sqrt(mean)) + 3 * sum;
}

EllipsoidAddedMass ellipsoid_added_mass(double a, double b, double c) {
    if (!(a > 0 && b > 0 && c > 0) || !std::isfinite(a * b * c)) {
        throw core::InputError("range", "the semi-axes of an ellipsoid are positive lengths");
    }
    EllipsoidAddedMass result;
    result.volume = 4.0 / 3 * std::numbers::pi * a * b * c;
    const std::array<double, 3> axis{a, b, c};
    for (std::size_t i = 0; i < 3; ++i) {
        const double x = axis[(i + 1) % 3], y = axis[(i + 2) % 3], z = axis[i];
        result.integral[i] = 2.0 / 3 * a * b * c * carlson_rd(x * x, y * y, z * z);
        result.translation[i] = result.volume * result.integral[i] / (2 - result.integral[i]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const double x = axis[(i + 1) % 3], y = axis[(i + 2) % 3];
        const double difference = x * x - y * y, sum = x * x + y * y;
        // Equal axes: nothing turns with the body. Nearly equal ones lose no digits that matter: the value is tiny.
        const double integrals = result.integral[(i + 2) % 3] - result.integral[(i + 1) % 3];
        const double denominator = 2 * difference - sum * integrals;
        result.rotation[i] = std::abs(difference) < 1e-12 * sum
                                 ? 0.0
                                 : result.volume / 5 * difference * difference * integrals / denominator;
    }
    return result;
}

}  // namespace underbody::geometry
