#include "geometry/blocks/body_section.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace underbody::geometry {

namespace {

using std::numbers::pi;
constexpr int flank_samples = 300;

}  // namespace

BodySection::BodySection(const ExactBody& body)
    : body_(body), largest_(std::sqrt(body.semi_x() * body.semi_y())), to_x_(std::sqrt(body.semi_x() / body.semi_y())) {
    front_corner_ = pi / 4;
    back_corner_ = 3 * pi / 4;
    if (!body.cut(Side::port)) {
        return;
    }
    // Where the port side of the base begins and ends: its y is the side's all along it.
    const double half = body.profile(Side::port).base_half() / to_y();
    const auto corner = [&](double end) {
        // from the end of the base (y = 0) to port: y of the rim rises until it is the side's
        double low = end, high = pi / 2;
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (low + high);
            (rim(middle) * std::sin(middle) < half * (1 - 1e-12) ? low : high) = middle;
        }
        return high;
    };
    front_corner_ = corner(0);
    back_corner_ = corner(pi);
}

double BodySection::ellipsoid_radius(double height, double azimuth) const {
    const double s = (height - body_.depth()) / body_.semi_z();
    const double sharp = largest_ * std::sqrt(std::max(0.0, 1 - s * s));
    if (body_.highest_fillet() <= height || body_.shape().edge_radius <= 0) {
        return sharp;
    }
    // In the rounding the parameter of the outline is not the azimuth.
    const auto point = [&](double t) {
        const Vec3 p = body_.ellipsoid_point(height, t);
        return Point2{p.x / to_x_, p.y / to_y()};
    };
    double low = 0, high = pi;
    double t = azimuth;
    for (int i = 0; i < 50; ++i) {
        const Point2 p = point(t);
        const double miss = std::atan2(p.y, p.x) - azimuth;
        if (std::abs(miss) < 1e-13) {
            break;
        }
        (miss < 0 ? low : high) = t;
        const double next = t - miss;
        t = next > low && next < high ? next : 0.5 * (low + high);
    }
    return geometry::length(point(t));
}

double BodySection::radius(double height, double azimuth) const {
    double r = ellipsoid_radius(height, azimuth);
    if (height >= body_.depth()) {
        return r;
    }
    const double c = std::cos(azimuth), s = std::sin(azimuth);
    if (c > 1e-9 && body_.cut(Side::front)) {
        r = std::min(r, body_.profile(Side::front).half(height) / to_x_ / c);
    }
    if (c < -1e-9 && body_.cut(Side::back)) {
        r = std::min(r, body_.profile(Side::back).half(height) / to_x_ / -c);
    }
    if (s > 1e-9 && body_.cut(Side::port)) {
        r = std::min(r, body_.profile(Side::port).half(height) / to_y() / s);
    }
    return r;
}

double BodySection::rim_azimuth(double x) const {
    double low = 0, high = pi;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (rim(middle) * std::cos(middle) > x ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

// Heights by a square: a rounding, or a side that begins level, has an infinite slope at the base.
FlankLine::FlankLine(const BodySection& section, double azimuth, double height)
    : section_(section), azimuth_(azimuth), height_(height), arcs_(flank_samples + 1, 0.0) {
    Point2 last{section.rim(azimuth), 0};
    for (int i = 1; i <= flank_samples; ++i) {
        const double w = static_cast<double>(i) / flank_samples, u = height * w * w;
        const Point2 next{section.radius(u, azimuth), u};
        arcs_[static_cast<std::size_t>(i)] = arcs_[static_cast<std::size_t>(i) - 1] + geometry::length(next - last);
        last = next;
    }
}

Point2 FlankLine::at(double arc) const {
    const auto upper = std::upper_bound(arcs_.begin() + 1, arcs_.end() - 1, arc);
    const auto i = static_cast<std::size_t>(upper - arcs_.begin());
    const double fraction = std::clamp((arc - arcs_[i - 1]) / (arcs_[i] - arcs_[i - 1]), 0.0, 1.0);
    const double w = (static_cast<double>(i - 1) + fraction) / flank_samples;
    const double u = height_ * w * w;
    return {section_.radius(u, azimuth_), u};
}

}  // namespace underbody::geometry
