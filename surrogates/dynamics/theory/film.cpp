#include "surrogates/dynamics/theory/film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace underbody::dynamics {

namespace {

using std::numbers::pi;

/// Gauss-Legendre, eight points, on [-1, 1].
constexpr std::array<std::array<double, 2>, 8> gauss{{{-0.9602898564975363, 0.1012285362903763},
                                                      {-0.7966664774136267, 0.2223810344533745},
                                                      {-0.5255324099163290, 0.3137066458778873},
                                                      {-0.1834346424956498, 0.3626837833783620},
                                                      {0.1834346424956498, 0.3626837833783620},
                                                      {0.5255324099163290, 0.3137066458778873},
                                                      {0.7966664774136267, 0.2223810344533745},
                                                      {0.9602898564975363, 0.1012285362903763}}};

template <class F>
double integral(const F& f, double lower, double upper) {
    double sum = 0;
    const double middle = (lower + upper) / 2, half = (upper - lower) / 2;
    for (const auto& [at, weight] : gauss) {
        sum += weight * f(middle + half * at);
    }
    return sum * half;
}

}  // namespace

SliderFilm slider_film(const std::function<double(double)>& gap, double length, const std::vector<double>& corners,
                       double speed, double viscosity, double density) {
    std::vector<double> edges{0.0};
    edges.insert(edges.end(), corners.begin(), corners.end());
    edges.push_back(length);
    SliderFilm film;
    // Fine pieces between the corners, so that pressure comes out along the way.
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        constexpr int pieces = 64;
        for (int k = 0; k < pieces; ++k) {
            film.x.push_back(edges[i] + (edges[i + 1] - edges[i]) * k / pieces);
        }
    }
    film.x.push_back(length);
    double i2 = 0, i3 = 0, widest = 0;
    for (std::size_t i = 0; i + 1 < film.x.size(); ++i) {
        i2 += integral([&](double x) { return std::pow(gap(x), -2); }, film.x[i], film.x[i + 1]);
        i3 += integral([&](double x) { return std::pow(gap(x), -3); }, film.x[i], film.x[i + 1]);
        widest = std::max(widest, gap(film.x[i]));
    }
    film.flow_per_width = speed / 2 * i2 / i3;
    const auto slope = [&](double x) {
        const double h = gap(x);
        return 6 * viscosity * speed / (h * h) - 12 * viscosity * film.flow_per_width / (h * h * h);
    };
    film.pressure.push_back(0);
    for (std::size_t i = 0; i + 1 < film.x.size(); ++i) {
        film.pressure.push_back(film.pressure.back() + integral(slope, film.x[i], film.x[i + 1]));
    }
    // Load and its moment by parts: integral of p = -integral of x p', both ends being ambient.
    double load = 0, moment = 0;
    for (std::size_t i = 0; i + 1 < film.x.size(); ++i) {
        load -= integral([&](double x) { return x * slope(x); }, film.x[i], film.x[i + 1]);
        moment -= integral([&](double x) { return x * x / 2 * slope(x); }, film.x[i], film.x[i + 1]);
    }
    film.load_per_width = load;
    film.highest = *std::max_element(film.pressure.begin(), film.pressure.end());
    film.lowest = *std::min_element(film.pressure.begin(), film.pressure.end());
    constexpr double no_load = 1e-9;
    const double size = (film.highest - film.lowest) * length;
    film.centre_of_pressure = std::abs(load) > no_load * size ? moment / load : std::nan("");
    widest = std::max({widest, gap(0), gap(length)});
    film.reduced_reynolds = std::abs(speed) * widest * widest * density / (viscosity * length);
    film.valid = film.reduced_reynolds <= 1;
    return film;
}

double slider_load_coefficient(double ratio) {
    const double k = ratio - 1;
    constexpr double nearly_parallel = 1e-4;
    if (std::abs(k) < nearly_parallel) {
        return k / 2 * (1 - 1.5 * k);  // series about parallel plates
    }
    return 6 / (k * k) * (std::log(ratio) - 2 * k / (ratio + 1));
}

double plane_slider_load(double inlet, double outlet, double length, double speed, double viscosity) {
    return viscosity * speed * length * length / (outlet * outlet) * slider_load_coefficient(inlet / outlet);
}

double plane_slider_pressure(double gap, double inlet, double outlet, double length, double speed, double viscosity) {
    return 6 * viscosity * speed * length * (inlet - gap) * (gap - outlet) /
           ((inlet * inlet - outlet * outlet) * gap * gap);
}

double plane_slider_peak(double inlet, double outlet, double length, double speed, double viscosity) {
    if (inlet == outlet) {
        return 0;  // parallel plates make no pressure
    }
    return plane_slider_pressure(2 * inlet * outlet / (inlet + outlet), inlet, outlet, length, speed, viscosity);
}

double best_slider_ratio() {
    double lo = 1.5, hi = 4;
    const auto slope = [](double k) {
        const double c = k - 1, s = k + 1;
        return -2 / c * (std::log(k) - 2 * c / s) + 1 / k - 4 / (s * s);
    };
    for (int i = 0; i < 100; ++i) {
        const double middle = (lo + hi) / 2;
        (slope(middle) > 0 ? lo : hi) = middle;
    }
    return (lo + hi) / 2;
}

double radial_film_pressure(double flow, double gap, double nozzle, double plate, double viscosity) {
    return 6 * viscosity * flow / (pi * gap * gap * gap) * std::log(plate / nozzle);
}

double radial_film_load(double flow, double gap, double nozzle, double plate, double viscosity) {
    return 3 * viscosity * flow * (plate * plate - nozzle * nozzle) / (gap * gap * gap);
}

double radial_inertia_load(double flow, double gap, double nozzle, double plate, double density, double factor) {
    const double bracket = std::log(plate / nozzle) - (1 - nozzle * nozzle / (plate * plate)) / 2;
    return -factor * density * flow * flow / (2 * pi * gap * gap) * bracket;
}

double JetFilm::force(double gap) const { return viscous / (gap * gap * gap) - inertial / (gap * gap); }
double JetFilm::zero() const { return viscous / inertial; }
double JetFilm::lowest_gap() const { return 1.5 * zero(); }
double JetFilm::lowest() const { return -4.0 / 27 * inertial / (zero() * zero()); }
double JetFilm::stiffness() const { return viscous / std::pow(zero(), 4); }

double elliptic_film_load(double flow, double gap, double half_length, double half_width, double viscosity) {
    const double a2 = half_length * half_length, b2 = half_width * half_width;
    return 6 * viscosity * flow * a2 * b2 / ((a2 + b2) * gap * gap * gap);
}

JetFilm jet_film(double half_length, double half_width, double nozzle, double flow, double viscosity, double density,
                 double factor) {
    const double a2 = half_length * half_length, b2 = half_width * half_width;
    JetFilm film;
    film.viscous =
        elliptic_film_load(flow, 1.0, half_length, half_width, viscosity) - 3 * viscosity * flow * nozzle * nozzle;
    film.inertial = -radial_inertia_load(flow, 1.0, nozzle, std::sqrt(2 * a2 * b2 / (a2 + b2)), density, factor);
    return film;
}

double film_integral(double half_length, double half_width) {
    return pi * std::pow(half_length * half_width, 3) / (4 * (half_length * half_length + half_width * half_width));
}

double squeeze_damping(double half_length, double half_width, double gap, double viscosity) {
    return 12 * viscosity * film_integral(half_length, half_width) / (gap * gap * gap);
}

double gap_added_mass(double half_length, double half_width, double gap, double density) {
    return density * film_integral(half_length, half_width) / gap;
}

JetFlow jet_flow(double thrust, double nozzle_diameter, double density, double kinematic_viscosity) {
    const double area = pi / 4 * nozzle_diameter * nozzle_diameter;
    JetFlow jet;
    jet.velocity = std::sqrt(thrust / (density * area));
    jet.flow = jet.velocity * area;
    jet.reynolds = jet.velocity * nozzle_diameter / kinematic_viscosity;
    return jet;
}

double ellipse_perimeter(double half_length, double half_width) {
    // Periodic integrand: the trapezium rule converges exponentially.
    constexpr int points = 256;
    double sum = 0;
    for (int i = 0; i < points; ++i) {
        const double angle = 2 * pi * i / points;
        sum += std::hypot(half_length * std::sin(angle), half_width * std::cos(angle));
    }
    return sum * 2 * pi / points;
}

double rim_reynolds(double flow, double perimeter, double kinematic_viscosity) {
    return flow / (kinematic_viscosity * perimeter);
}

double thrust_exponent(double low_thrust, double high_thrust, double low_voltage, double high_voltage) {
    return std::log(high_thrust / low_thrust) / std::log(high_voltage / low_voltage);
}

double upwash_at_equilibrium(double neutral_voltage, double voltage) {
    const double ratio = neutral_voltage / voltage;
    return ratio * ratio - 1;
}

}  // namespace underbody::dynamics
