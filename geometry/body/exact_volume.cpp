// The volume of the exact body and its moments, section by section.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/body/exact_body.h"

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

// Integrals of x^k and x^k y^2, k = 0 ... 4, over a section; x from the centre of the base.
struct Section {
    std::array<double, 5> x{}, xyy{};
    friend Section operator+(Section a, const Section& b) {
        for (std::size_t k = 0; k < 5; ++k) {
            a.x[k] += b.x[k];
            a.xyy[k] += b.xyy[k];
        }
        return a;
    }
    friend Section operator*(Section a, double s) {
        for (std::size_t k = 0; k < 5; ++k) {
            a.x[k] *= s;
            a.xyy[k] *= s;
        }
        return a;
    }
    /// The integrals over the line x = const from y = 0 to y = half.
    static Section line(double x, double half) {
        Section s;
        double power = 1;
        for (std::size_t k = 0; k < 5; ++k, power *= x) {
            s.x[k] = power * half;
            s.xyy[k] = power * half * half * half / 3;
        }
        return s;
    }
};

// What the bend (x by offset g, y by 1 + taper x g, height by slope x g) makes of the moments of a thin section at a
// height; x counts from the centre of the base, before the bend of the cut one, after it of the one that was moved.
class Bend {
public:
    explicit Bend(const ExactBody& body) : depth_(body.depth()) {
        const BodyShape& shape = body.shape();
        const BodyShape::BaseExtent extent = shape.base_extent();
        taper_ = shape.taper / (extent.nose - extent.tail);
        slope_ = std::tan(shape.base_pitch);
        offset_ = shape.base_offset;
    }
    [[nodiscard]] VolumeMoments of(const Section& s, double height) const {
        const double v = std::clamp((depth_ - height) / depth_, 0.0, 1.0);
        const double widening = taper_ * v * v, lift = slope_ * v * v;
        const double rate = height < 0 ? 0 : -2 * v / depth_;  // of g by the height
        const double lifting = slope_ * rate, along = offset_ * (v * v - 1);
        // A point that goes along the tilted base rises with it: the part of the volume element that has no x.
        const double even = 1 - offset_ * rate * slope_ * v * v;
        // Integral of x^n (1 + widening x)^m (even + lifting x): the volume element is m = 1, y^2 of the bent body m
        // = 3.
        const auto with = [&](const std::array<double, 5>& of, std::size_t n, int m) {
            std::array<double, 5> factor{even, lifting, 0, 0, 0};
            for (int i = 0; i < m; ++i) {
                for (std::size_t k = 4; k > 0; --k) {
                    factor[k] += widening * factor[k - 1];
                }
            }
            double sum = 0;
            for (std::size_t k = 0; k + n < 5; ++k) {
                sum += factor[k] * of[k + n];
            }
            return sum;
        };
        VolumeMoments m;
        m.one = with(s.x, 0, 1);
        m.x = with(s.x, 1, 1);
        m.xx = with(s.x, 2, 1);
        m.yy = with(s.xyy, 0, 3);
        m.z = height * m.one + lift * m.x;
        m.zz = height * height * m.one + 2 * height * lift * m.x + lift * lift * m.xx;
        m.zx = height * m.x + lift * m.xx;
        // Moved along: x + along.
        m.zx += along * m.z;
        m.xx += along * (2 * m.x + along * m.one);
        m.x += along * m.one;
        return m;
    }

private:
    double depth_, taper_, slope_, offset_;
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

Section section(const ExactBody& body, double height) {
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
    const double centre = body.cut_centre();
    const auto along = [&](double t) {
        constexpr double step = 2e-5;
        const Vec3 p = body.ellipsoid_point(height, t);
        const double dx =
            (body.ellipsoid_point(height, t + step).x - body.ellipsoid_point(height, t - step).x) / (2 * step);
        return Section::line(p.x - centre, p.y) * -dx;
    };
    Section sum;
    if (front < port_fore) {
        sum = sum + integral(along, front, port_fore);
    }
    if (back > port_aft) {
        sum = sum + integral(along, port_aft, back);
    }
    if (port > 0) {
        const double fore = body.ellipsoid_point(height, std::max(front, port_fore)).x - centre;
        const double aft = body.ellipsoid_point(height, std::min(back, port_aft)).x - centre;
        sum = sum + integral([&](double x) { return Section::line(x, port); }, aft, fore);
    }
    return sum * 2;
}

// What stands below the base: columns of water displaced, each down to the depth of the profile.
VolumeMoments protrusion_moments(const ExactBody& body, const Bend& bend) {
    const ExactBody::Foot foot = body.protrusion_foot();
    const double centre = body.cut_centre();
    const auto columns = [&](const Section& over, double depth) {
        return integral([&](double u) { return bend.of(over, u); }, -depth, 0);
    };
    VolumeMoments sum;
    for (const auto& [low, high] : {std::pair{0.0, foot.crest}, std::pair{foot.crest, foot.radius}}) {
        if (!(high > low)) {
            continue;
        }
        sum = sum + integral(
                        [&](double d) {
                            Section over = (Section::line(foot.x - centre + d, foot.half_axis) +
                                            Section::line(foot.x - centre - d, foot.half_axis)) *
                                           2;
                            over = over + integral(
                                              [&](double angle) {
                                                  const double y = foot.half_axis + d * std::sin(angle);
                                                  Section ring =
                                                      Section::line(foot.x - centre + d * std::cos(angle), 1);
                                                  for (std::size_t k = 0; k < 5; ++k) {
                                                      ring.xyy[k] = ring.x[k] * y * y;
                                                  }
                                                  return ring * (2 * d);
                                              },
                                              0, pi);
                            return columns(over, body.profile_depth(d));
                        },
                        low, high);
    }
    return sum;
}

// The integrals over a disc of radius r about (x, 0).
Section disc(double x, double r) {
    return integral(
               [&](double angle) {
                   const double half = r * std::sin(angle);
                   return Section::line(x + r * std::cos(angle), half) * half;  // dx = -r sin(angle) d angle
               },
               0, pi) *
           2;
}

}  // namespace

VolumeMoments ExactBody::moments() const {
    const Bend bend(*this);
    VolumeMoments sum;
    // Cosine spacing in each part: sections change fast near the base and end with a vertical tangent at the top.
    for (const auto& [low, high, parts] : {std::tuple{0.0, depth_, 48}, std::tuple{depth_, top(), 6}}) {
        const auto height = [&, low = low, high = high](double w) {
            return low + (high - low) * (0.5 - 0.5 * std::cos(pi * w));
        };
        for (int i = 0; i < parts; ++i) {
            sum = sum + integral(
                            [&, low = low, high = high](double w) {
                                const double u = height(w);
                                return bend.of(section(*this, u), u) * ((high - low) * 0.5 * pi * std::sin(pi * w));
                            },
                            static_cast<double>(i) / parts, static_cast<double>(i + 1) / parts);
        }
    }
    if (shape_.protrusion) {
        sum = sum + protrusion_moments(*this, bend);
    }
    if (shape_.nozzle && shape_.nozzle->depth > 0) {
        const Section bore = disc(shape_.base_x(shape_.nozzle->position) - cut_centre_, shape_.nozzle->diameter / 2);
        sum = sum + integral([&](double u) { return bend.of(bore, u); }, 0, shape_.nozzle->depth) * -1;
    }
    return sum;
}

}  // namespace underbody::geometry
