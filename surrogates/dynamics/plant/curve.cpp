#include "surrogates/dynamics/plant/curve.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace underbody::dynamics {

Curve::Curve(std::vector<double> x, std::vector<double> value, std::vector<double> slope)
    : x_(std::move(x)), value_(std::move(value)), slope_(std::move(slope)) {
    build_index();
}

void Curve::build_index() {
    const std::size_t count = x_.size() - 1;
    pieces_.resize(count);
    integral_.assign(count + 1, 0.0);
    double smallest = x_.back() - x_.front();
    for (std::size_t i = 0; i < count; ++i) {
        const double width = x_[i + 1] - x_[i];
        const double rise = (value_[i + 1] - value_[i]) / width;
        Piece& p = pieces_[i];
        p.x = x_[i];
        p.c0 = value_[i];
        p.c1 = slope_[i];
        p.c2 = (3 * rise - 2 * slope_[i] - slope_[i + 1]) / width;
        p.c3 = (slope_[i] + slope_[i + 1] - 2 * rise) / (width * width);
        integral_[i + 1] = integral_[i] + width * (p.c0 + width * (p.c1 / 2 + width * (p.c2 / 3 + width * p.c3 / 4)));
        smallest = std::min(smallest, width);
    }
    end_[0] = value_.front();
    end_[1] = value_.back();
    // As many buckets as needed for about one knot each, within the size of a first-level cache.
    const double span = x_.back() - x_.front();
    const auto buckets = static_cast<std::size_t>(std::clamp(span / smallest, 16.0, 2048.0));
    per_bucket_ = static_cast<double>(buckets) / span;
    first_.assign(buckets, 0);
    std::size_t i = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
        // A hair to the left, so that rounding in the look-up never lands right of the wanted piece.
        const double start = x_.front() + (static_cast<double>(b) - 1e-6) / per_bucket_;
        while (i + 1 < count && x_[i + 1] <= start) {
            ++i;
        }
        first_[b] = static_cast<std::uint32_t>(i);
    }
}

double Curve::value(double x, double& slope) const noexcept {
    double curvature = 0;
    return value(x, slope, curvature);
}

double Curve::value(double x, double& slope, double& curvature) const noexcept {
    slope = curvature = 0;
    if (x < x_.front()) {
        return end_[0];
    }
    if (x > x_.back()) {
        return end_[1];
    }
    const Piece& p = pieces_[piece(x)];
    const double d = x - p.x;
    slope = p.c1 + d * (2 * p.c2 + d * 3 * p.c3);
    curvature = 2 * p.c2 + d * 6 * p.c3;
    return x == x_.back() ? end_[1] : p.c0 + d * (p.c1 + d * (p.c2 + d * p.c3));
}

double Curve::integral(double x) const noexcept {
    if (x <= x_.front()) {
        return end_[0] * (x - x_.front());
    }
    if (x >= x_.back()) {
        return integral_.back() + end_[1] * (x - x_.back());
    }
    const std::size_t i = piece(x);
    const Piece& p = pieces_[i];
    const double d = x - p.x;
    return integral_[i] + d * (p.c0 + d * (p.c1 / 2 + d * (p.c2 / 3 + d * p.c3 / 4)));
}

Curve Curve::times(double factor) const {
    if (empty()) {
        return {};
    }
    std::vector<double> value = value_, slope = slope_;
    for (double& v : value) {
        v *= factor;
    }
    for (double& s : slope) {
        s *= factor;
    }
    return {x_, std::move(value), std::move(slope)};
}

namespace {

/// Slope of the piece that lies to the right (or left) of a knot; outside its knots a curve is flat.
double inner_slope(const Curve& curve, double at, double toward) {
    double slope = 0;
    if (at < curve.lower() || at > curve.upper() || (at == curve.lower() && toward < at) ||
        (at == curve.upper() && toward > at)) {
        return 0;
    }
    static_cast<void>(curve.value(at, slope));  // pieces meet with one slope, ends have that of the inside
    return slope;
}

}  // namespace

Curve Curve::plus(double a, const Curve& other, double b) const {
    if (empty()) {
        return other.times(b);
    }
    if (other.empty()) {
        return times(a);
    }
    std::vector<double> x = x_;
    x.insert(x.end(), other.x_.begin(), other.x_.end());
    std::sort(x.begin(), x.end());
    const double tiny = 1e-12 * (x.back() - x.front());
    x.erase(std::unique(x.begin(), x.end(), [tiny](double l, double r) { return r - l <= tiny; }), x.end());
    // Where one curve ends inside the other its slope jumps to zero; a Hermite piece beside the end needs its own
    // slope, so a second knot a hair away keeps the two sides apart.
    for (const Curve* curve : {this, &other}) {
        for (const double end : {curve->lower(), curve->upper()}) {
            if (end > x.front() + tiny && end < x.back() - tiny) {
                const double beside =
                    end == curve->lower() ? end - 1e-9 * (x.back() - x.front()) : end + 1e-9 * (x.back() - x.front());
                x.insert(std::lower_bound(x.begin(), x.end(), beside), beside);
            }
        }
    }
    std::vector<double> value(x.size()), slope(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        value[i] = a * (*this)(x[i]) + b * other(x[i]);
        const double toward = i == 0 ? x[1] : x[i - 1];
        const double forward = i + 1 < x.size() ? x[i + 1] : x[i - 1];
        const auto side = [&](const Curve& curve) {
            const bool starts_here = x[i] <= curve.lower() + tiny;
            return inner_slope(curve, std::clamp(x[i], std::min(x[i], curve.lower()), std::max(x[i], curve.upper())),
                               starts_here ? forward : toward);
        };
        slope[i] = a * side(*this) + b * side(other);
    }
    return {std::move(x), std::move(value), std::move(slope)};
}

namespace {

/// Where a cubic piece c0 + c1 d + c2 d^2 + c3 d^3 turns, with its ends: it is monotone between these.
std::vector<double> monotone_cuts(double c1, double c2, double c3, double width) {
    std::vector<double> cuts{0.0, width};
    const double a = 3 * c3, b = 2 * c2, c = c1;
    const double discriminant = b * b - 4 * a * c;
    if (a != 0 && discriminant > 0) {
        for (const double sign : {-1.0, 1.0}) {
            const double root = (-b + sign * std::sqrt(discriminant)) / (2 * a);
            if (root > 0 && root < width) {
                cuts.push_back(root);
            }
        }
    } else if (a == 0 && b != 0 && -c / b > 0 && -c / b < width) {
        cuts.push_back(-c / b);
    }
    std::sort(cuts.begin(), cuts.end());
    return cuts;
}

/// The last zero from `lo`, where f is not zero, to `hi`, where it has the other sign or is zero.
template <class Function>
double bisected(const Function& f, double lo, double hi) {
    double flo = f(lo);
    for (int step = 0; step < 200 && hi - lo > 0; ++step) {
        const double middle = (lo + hi) / 2;
        if (middle == lo || middle == hi) {
            break;
        }
        const double fm = f(middle);
        if ((fm > 0) == (flo > 0) && fm != 0) {
            lo = middle;
            flo = fm;
        } else {
            hi = middle;
        }
    }
    return hi;
}

}  // namespace

std::vector<double> Curve::zeros(double level) const {
    std::vector<double> found;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
        // A cubic piece: cut at its turning points, then bisect each monotone part.
        const Piece& p = pieces_[i];
        const double width = x_[i + 1] - x_[i];
        const std::vector<double> cuts = monotone_cuts(p.c1, p.c2, p.c3, width);
        const auto f = [&](double d) { return p.c0 + d * (p.c1 + d * (p.c2 + d * p.c3)) - level; };
        for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
            const double lo = cuts[k], hi = cuts[k + 1];
            const double flo = f(lo), fhi = f(hi);
            if (flo == 0 && (i > 0 || k > 0)) {
                continue;  // counted by the part to its left
            }
            if (flo == 0) {
                found.push_back(p.x + lo);
                continue;
            }
            if (fhi != 0 && (flo > 0) == (fhi > 0)) {
                continue;
            }
            found.push_back(p.x + bisected(f, lo, hi));
        }
    }
    constexpr double same_root = 1e-13;  // of the range
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end(),
                            [this](double l, double r) { return r - l < same_root * (upper() - lower()); }),
                found.end());
    return found;
}

namespace {

std::vector<double> knots_with_ends(const tables::ForceTable& table, std::size_t axis) {
    const tables::TableAxis& along = table.axes()[axis];
    std::vector<double> x = table.knots(axis);
    if (x.empty() || x.front() > along.lower) {
        x.insert(x.begin(), along.lower);
    }
    if (x.back() < along.upper) {
        x.push_back(along.upper);
    }
    return x;
}

}  // namespace

Curve Curve::along(const tables::ForceTable& table, std::size_t axis, std::span<const double> held) {
    double point[tables::max_axes] = {};
    std::copy(held.begin(), held.end(), point);
    double slopes[tables::max_axes] = {};
    const auto value_at = [&](double x, double* slope = nullptr) {
        point[axis] = x;
        const double value = table.value(point, slope ? slopes : nullptr);
        if (slope) {
            *slope = slopes[axis];
        }
        return value;
    };
    const std::vector<double> x = knots_with_ends(table, axis);
    if (x.size() < 2) {
        const double flat = value_at(x.front());
        return {{x.front() - 1, x.front() + 1}, {flat, flat}, {0, 0}};
    }
    double low = value_at(x.front()), high = low;
    for (const double at : x) {
        low = std::min(low, value_at(at));
        high = std::max(high, value_at(at));
    }
    const double allowed = 1e-10 * std::max(high - low, 1e-12 * std::max(std::abs(high), std::abs(low)));
    // At its ends a clamped table may already call itself flat: take the slope from inside the last interval, exact for
    // a cubic.
    const auto end_slope = [&](double end, double inner) {
        const double d = (inner - end) / 3;
        return (-11 * value_at(end) + 18 * value_at(end + d) - 9 * value_at(end + 2 * d) + 2 * value_at(inner)) /
               (6 * d);
    };
    std::vector<double> value, slope, knots;
    const auto add = [&](double at) {
        double s = 0;
        knots.push_back(at);
        value.push_back(value_at(at, &s));
        slope.push_back(s);
    };
    const double first_slope = end_slope(x.front(), x[1]);
    const double last_slope = end_slope(x.back(), x[x.size() - 2]);
    constexpr std::array<double, 3> checked_at{0.2, 0.5, 0.8};
    // Depth first, so that knots come out in order.
    const auto refine = [&](auto&& self, double l, double r, int depth) -> void {
        double sl = 0, sr = 0;
        const double vl = value_at(l, &sl), vr = value_at(r, &sr);
        sl = l == x.front() ? first_slope : sl;
        sr = r == x.back() ? last_slope : sr;
        const double width = r - l;
        bool good = true;
        for (const double t : checked_at) {
            const double h00 = (1 + 2 * t) * (1 - t) * (1 - t), h10 = t * (1 - t) * (1 - t);
            const double h01 = t * t * (3 - 2 * t), h11 = t * t * (t - 1);
            const double hermite = h00 * vl + h10 * width * sl + h01 * vr + h11 * width * sr;
            good = good && std::abs(hermite - value_at(l + t * width)) <= allowed;
        }
        if (!good && depth < 7) {
            self(self, l, (l + r) / 2, depth + 1);
            self(self, (l + r) / 2, r, depth + 1);
        } else {
            add(l);
        }
    };
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
        refine(refine, x[i], x[i + 1], 0);
    }
    add(x.back());
    slope.front() = first_slope;
    slope.back() = last_slope;
    return {std::move(knots), std::move(value), std::move(slope)};
}

}  // namespace underbody::dynamics
