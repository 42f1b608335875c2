// The volume of the exact body, section by section.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/exact_body.h"

namespace underbody::geometry {

namespace {

using std::numbers::pi;

// Gauss-Legendre on [-1, 1], 16 points (positive half).
constexpr std::array<double, 8> nodes{0.0950125098376374, 0.2816035507792589, 0.4580167776572274, 0.6178762444026438,
                                      0.7554044083550030, 0.8656312023878318, 0.9445750230732326, 0.9894009349916499};
constexpr std::array<double, 8> weights{0.1894506104550685, 0.1826034150449236, 0.1691565193950025, 0.1495959888165767,
                                        0.1246289712555339, 0.0951585116824928, 0.0622535239386479, 0.0271524594117541};

template <class F>
auto integral(const F& f, double low, double high) {
    const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
    auto sum = f(middle) * 0.0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        sum = sum + (f(middle - half * nodes[i]) + f(middle + half * nodes[i])) * (weights[i] * half);
    }
    return sum;
}

// Integrals of 1, x, x^2 over a section.
struct Moments {
    double one = 0, x = 0, xx = 0;
    friend Moments operator+(const Moments& a, const Moments& b) { return {a.one + b.one, a.x + b.x, a.xx + b.xx}; }
    friend Moments operator*(const Moments& a, double s) { return {a.one * s, a.x * s, a.xx * s}; }
};

// The volume element of the bend at (x, height) against the unbent one.
class Bend {
public:
    explicit Bend(const ExactBody& body) : depth_(body.depth()), centre_(body.base_centre()) {
        const BodyShape& shape = body.shape();
        const BodyShape::BaseExtent extent = shape.base_extent();
        taper_ = shape.taper / (extent.nose - extent.tail);
        slope_ = std::tan(shape.base_pitch);
    }
    [[nodiscard]] double of(const Moments& m, double height) const {
        if (height >= depth_) {
            return m.one;
        }
        const double v = std::min(1.0, (depth_ - height) / depth_), widening = taper_ * v * v;
        const double lifting = height < 0 ? 0 : -2 * slope_ * v / depth_;
        // about the centre of the base
        const double x = m.x - centre_ * m.one, xx = m.xx - centre_ * (2 * m.x - centre_ * m.one);
        return m.one + (widening + lifting) * x + widening * lifting * xx;
    }
    [[nodiscard]] double at(double x, double height) const { return of({1, x, x * x}, height); }

private:
    double depth_, centre_, taper_, slope_;
};

double root(const ExactBody& body, double height, double low, double high, bool of_x, double value) {
    const auto excess = [&](double t) {
        const Vec3 p = body.ellipsoid_point(height, t);
        return (of_x ? p.x : p.y) - value;
    };
    const bool rising = excess(low) < 0;
    for (int i = 0; i < 60; ++i) {
        const double mid = 0.5 * (low + high);
        ((excess(mid) < 0) == rising ? low : high) = mid;
    }
    return 0.5 * (low + high);
}

Moments section(const ExactBody& body, double height) {
    double front = 0, back = pi;                   // parameters where the ellipsoid's outline begins and ends
    double port_fore = pi / 2, port_aft = pi / 2;  // and where the port side cuts it
    double port = 0;
    const bool below = height < body.depth();
    const auto half = [&](Side side) { return body.profile(side).half(height); };
    const double reach = body.ellipsoid_point(height, 0).x, breadth = body.ellipsoid_point(height, pi / 2).y;
    if (below && body.cut(Side::front) && half(Side::front) < reach) {
        front = root(body, height, 0, pi / 2, true, half(Side::front));
    }
    if (below && body.cut(Side::back) && half(Side::back) < reach) {
        back = root(body, height, pi / 2, pi, true, -half(Side::back));
    }
    if (below && body.cut(Side::port) && half(Side::port) < breadth) {
        port = half(Side::port);
        port_fore = root(body, height, 0, pi / 2, false, port);
        port_aft = pi - port_fore;
    }
    const auto along = [&](double t) {
        constexpr double step = 2e-5;
        const Vec3 p = body.ellipsoid_point(height, t);
        const double dx =
            (body.ellipsoid_point(height, t + step).x - body.ellipsoid_point(height, t - step).x) / (2 * step);
        return Moments{1, p.x, p.x * p.x} * (-dx * p.y);
    };
    Moments sum;
    if (front < port_fore) {
        sum = sum + integral(along, front, port_fore);
    }
    if (back > port_aft) {
        sum = sum + integral(along, port_aft, back);
    }
    if (port > 0) {
        const double fore = body.ellipsoid_point(height, std::max(front, port_fore)).x;
        const double aft = body.ellipsoid_point(height, std::min(back, port_aft)).x;
        sum =
            sum + Moments{fore - aft, (fore * fore - aft * aft) / 2, (fore * fore * fore - aft * aft * aft) / 3} * port;
    }
    return sum * 2;
}

double protrusion_volume(const ExactBody& body, const Bend& bend) {
    const ExactBody::Foot foot = body.protrusion_foot();
    const auto column = [&](double x, double depth) {
        return depth > 0 ? integral([&](double u) { return bend.at(x, u); }, -depth, 0) : 0.0;
    };
    double sum = 0;
    for (const auto& [low, high] : {std::pair{0.0, foot.crest}, std::pair{foot.crest, foot.radius}}) {
        if (!(high > low)) {
            continue;
        }
        sum += integral(
            [&](double d) {
                const double depth = body.profile_depth(d);
                const double straight = 2 * foot.half_axis * (column(foot.x + d, depth) + column(foot.x - d, depth));
                const double ends =
                    2 * d * integral([&](double angle) { return column(foot.x + d * std::cos(angle), depth); }, 0, pi);
                return straight + ends;
            },
            low, high);
    }
    return sum;
}

}  // namespace

double ExactBody::volume() const {
    const Bend bend(*this);
    double sum = 0;
    // Cosine spacing in each part: sections change fast near the base and end with a vertical tangent at the top.
    for (const auto& [low, high, parts] : {std::tuple{0.0, depth_, 48}, std::tuple{depth_, top(), 6}}) {
        const auto height = [&, low = low, high = high](double w) {
            return low + (high - low) * (0.5 - 0.5 * std::cos(pi * w));
        };
        for (int i = 0; i < parts; ++i) {
            sum += integral(
                [&, low = low, high = high](double w) {
                    const double u = height(w);
                    return bend.of(section(*this, u), u) * (high - low) * 0.5 * pi * std::sin(pi * w);
                },
                static_cast<double>(i) / parts, static_cast<double>(i + 1) / parts);
        }
    }
    if (shape_.protrusion) {
        sum += protrusion_volume(*this, bend);
    }
    if (shape_.nozzle && shape_.nozzle->depth > 0) {
        const double x = shape_.base_x(shape_.nozzle->position), r = shape_.nozzle->diameter / 2;
        // x and x^2 over a disc
        const Moments disc{pi * r * r, pi * r * r * x, pi * r * r * (x * x + r * r / 4)};
        sum -= integral([&](double u) { return bend.of(disc, u); }, 0, shape_.nozzle->depth);
    }
    return sum;
}

}  // namespace underbody::geometry
