#include "geometry/water/source_panels.h"

#include <algorithm>
#include <cmath>

namespace underbody::geometry {

SourcePanel::SourcePanel(const Vec3& a, const Vec3& b, const Vec3& c) : corner_{a, b, c}, centre_((a + b + c) / 3.0) {
    const Vec3 n = cross(b - a, c - a);
    area_ = 0.5 * norm(n);
    normal_ = unit(n);
    double reach = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        along_[k] = unit(corner_[(k + 1) % 3] - corner_[k]);
        out_[k] = cross(along_[k], normal_);
        const Vec3 v = corner_[k] - centre_;
        const std::array<double, 6> product{v.x * v.x, v.y * v.y, v.z * v.z, v.x * v.y, v.y * v.z, v.z * v.x};
        for (std::size_t i = 0; i < 6; ++i) {
            second_[i] += area_ / 12 * product[i];
        }
        reach = std::max(reach, dot(v, v));
    }
    far_ = 49 * reach;  // beyond seven times the reach the quadrupole errs by less than 1e-4 of the panel's own share
}

SourcePanel::Exact SourcePanel::exact(const Vec3& x) const {
    const double height = dot(normal_, x - corner_[0]), size = std::abs(height);
    Exact result;
    double angle = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 to_start = corner_[k] - x, to_end = corner_[(k + 1) % 3] - x;
        const double start = dot(along_[k], to_start), end = dot(along_[k], to_end), away = dot(out_[k], to_start);
        const double r_start = norm(to_start), r_end = norm(to_end), square = away * away + height * height;
        double logarithm = 0;
        if (square > 1e-28 * area_) {
            // The form whose sums do not cancel.
            logarithm = start + end > 0 ? std::log((r_end + end) / (r_start + start))
                                        : std::log((r_start - start) / (r_end - end));
        } else if (start * end > 0) {
            logarithm = std::abs(std::log(r_end / r_start));  // on the edge's own line, outside it
        }
        const double turn =
            size > 0 ? std::atan2(away * end, square + size * r_end) - std::atan2(away * start, square + size * r_start)
                     : 0.0;
        result.potential += away * logarithm - size * turn;
        result.gradient -= out_[k] * logarithm;
        angle += turn;
    }
    if (height != 0) {
        result.gradient -= normal_ * std::copysign(angle, height);
    }
    return result;
}

double SourcePanel::potential(const Vec3& x) const {
    const Vec3 d = x - centre_;
    const double square = dot(d, d);
    if (!far(square)) {
        return exact(x).potential;
    }
    const double inverse = 1 / std::sqrt(square), i3 = inverse / square, i5 = i3 / square;
    const double quadratic = second_[0] * d.x * d.x + second_[1] * d.y * d.y + second_[2] * d.z * d.z +
                             2 * (second_[3] * d.x * d.y + second_[4] * d.y * d.z + second_[5] * d.z * d.x);
    return area_ * inverse + 0.5 * (3 * quadratic * i5 - (second_[0] + second_[1] + second_[2]) * i3);
}

Vec3 SourcePanel::gradient(const Vec3& x) const {
    const Vec3 d = x - centre_;
    const double square = dot(d, d);
    if (!far(square)) {
        return exact(x).gradient;
    }
    const double i2 = 1 / square, inverse = std::sqrt(i2), i3 = inverse * i2, i5 = i3 * i2;
    const Vec3 q{second_[0] * d.x + second_[3] * d.y + second_[5] * d.z,
                 second_[3] * d.x + second_[1] * d.y + second_[4] * d.z,
                 second_[5] * d.x + second_[4] * d.y + second_[2] * d.z};
    const double trace = second_[0] + second_[1] + second_[2];
    const double along = -area_ * i3 + 1.5 * trace * i5 - 7.5 * dot(d, q) * i5 * i2;
    return along * d + (3 * i5) * q;
}

}  // namespace underbody::geometry
