#include "surrogates/dynamics/linear/linear.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/angle.h"
#include "core/text.h"
#include "surrogates/dynamics/model/matrix_algebra.h"

namespace underbody::dynamics {

LinearSystem linearise(const std::function<void(const double* x, const double* u, double* rate)>& rate,
                       const std::vector<double>& x, const std::vector<double>& u,
                       const std::vector<std::string>& states, const std::vector<std::string>& inputs,
                       const std::vector<double>& state_scale, const std::vector<double>& input_scale, double step) {
    const std::size_t n = x.size(), m = u.size();
    LinearSystem system{Matrix(n, n), Matrix(n, m), states, inputs, x, u};
    std::vector<double> plus(n), minus(n);
    for (std::size_t j = 0; j < n + m; ++j) {
        std::vector<double> xs = x, us = u;
        const double size = step * (j < n ? state_scale[j] : input_scale[j - n]);
        double& moved = j < n ? xs[j] : us[j - n];
        const double centre = moved;
        moved = centre + size;
        rate(xs.data(), us.data(), plus.data());
        moved = centre - size;
        rate(xs.data(), us.data(), minus.data());
        for (std::size_t i = 0; i < n; ++i) {
            const double slope = (plus[i] - minus[i]) / (2 * size);
            (j < n ? system.a(i, j) : system.b(i, j - n)) = slope;
        }
    }
    return system;
}

namespace {

std::vector<double> shares_in(const std::vector<std::complex<double>>& direction) {
    std::vector<double> share;
    double sum = 0;
    for (const auto& part : direction) {
        share.push_back(std::norm(part));
        sum += share.back();
    }
    for (double& part : share) {
        part /= sum > 0 ? sum : 1;
    }
    return share;
}

/// Share of each state in a mode: |left right|; where eigenvalues coincide without as many eigenvectors (several zeros
/// of position and heading) left and right are orthogonal, and the right one alone tells.
std::vector<double> participation_of(const EigenPair& e) {
    std::vector<double> share(e.right.size());
    double sum = 0, lefts = 0;
    for (std::size_t i = 0; i < share.size(); ++i) {
        share[i] = std::abs(std::conj(e.left[i]) * e.right[i]);
        sum += share[i];
        lefts += std::norm(e.left[i]);
    }
    if (!(sum > 1e-6 * std::sqrt(lefts)) || !std::isfinite(sum)) {
        return shares_in(e.right);
    }
    for (double& part : share) {
        part /= sum;
    }
    return share;
}

/// Of two zeros that share their one right eigenvector (the place across a heading that stays) the second is the state
/// that moves along it: the smallest x with A x = that vector.
std::vector<std::complex<double>> what_feeds(const Matrix& a, const std::vector<std::complex<double>>& moved) {
    Matrix normal = a.transposed() * a, along(moved.size(), 1);
    const double small = 1e-12 * normal.largest();
    for (std::size_t i = 0; i < moved.size(); ++i) {
        normal(i, i) += small;
        along(i, 0) = moved[i].real();
    }
    const Matrix x = solve(normal, a.transposed() * along);
    std::vector<std::complex<double>> direction;
    for (std::size_t i = 0; i < moved.size(); ++i) {
        direction.emplace_back(x(i, 0));
    }
    return direction;
}

/// After the groups of the states that take part most.
std::string name_of(const std::vector<double>& participation, const std::vector<std::string>& groups) {
    std::map<std::string, double> shares;
    std::vector<std::string> order;
    for (std::size_t i = 0; i < participation.size(); ++i) {
        if (!shares.count(groups[i])) {
            order.push_back(groups[i]);
        }
        shares[groups[i]] += participation[i];
    }
    const std::string& most = *std::max_element(order.begin(), order.end(),
                                                [&](const auto& l, const auto& r) { return shares[l] < shares[r]; });
    std::string name;
    for (const std::string& group : order) {
        if (shares[group] > 0.2 || group == most) {
            name += (name.empty() ? "" : "-") + group;
        }
    }
    return name;
}

constexpr double at_rest = 1e-7;   ///< rad/s: below it a pole is 0
constexpr double undamped = 1e-7;  ///< damping ratio: below it a swing has none

}  // namespace

std::vector<Mode> modes(const LinearSystem& system, const std::vector<std::string>& groups) {
    std::vector<Mode> found;
    for (const EigenPair& e : eigen(system.a)) {
        if (e.value.imag() < 0) {
            continue;
        }
        Mode mode;
        mode.value = e.value;
        mode.participation = participation_of(e);
        mode.name = name_of(mode.participation, groups);
        const bool again = std::any_of(found.begin(), found.end(), [&](const Mode& other) {
            return other.name == mode.name && std::abs(other.value) < at_rest && std::abs(mode.value) < at_rest;
        });
        if (again) {
            mode.participation = shares_in(what_feeds(system.a, e.right));
            mode.name = name_of(mode.participation, groups);
        }
        mode.frequency = std::abs(e.value);
        mode.damping_ratio = mode.frequency > 0 ? -e.value.real() / mode.frequency : 0;
        mode.time_constant = e.value.real() != 0 ? -1 / e.value.real() : std::numeric_limits<double>::infinity();
        mode.stable = e.value.real() < 0;
        mode.neutral = mode.frequency < at_rest || std::abs(e.value.real()) < undamped * mode.frequency;
        found.push_back(std::move(mode));
    }
    return found;
}

Controllability controllability(const LinearSystem& system, double tolerance) {
    const std::size_t n = system.a.rows(), m = system.b.columns();
    Controllability result;
    if (m == 0) {  // no input moves anything
        for (const EigenPair& e : eigen(system.a)) {
            result.uncontrollable.emplace_back();
            for (const auto& part : e.left) {
                result.uncontrollable.back().push_back(part.real());
            }
        }
        return result;
    }
    Matrix all(n, n * m), power = system.b;
    for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < m; ++j) {
                all(i, k * m + j) = power(i, j);
            }
        }
        power = system.a * power;
    }
    const std::vector<double> s = singular_values(all);
    result.weakness = s.front() > 0 ? s.back() / s.front() : 0;
    result.rank = rank(all, tolerance);
    for (const EigenPair& e : eigen(system.a)) {
        double reach = 0, size = 0;
        for (std::size_t j = 0; j < m; ++j) {
            std::complex<double> product = 0;
            for (std::size_t i = 0; i < n; ++i) {
                product += std::conj(e.left[i]) * system.b(i, j);
            }
            reach = std::max(reach, std::abs(product));
        }
        std::vector<double> direction;
        for (const auto& part : e.left) {
            direction.push_back(part.real());
            size = std::max(size, std::abs(part));
        }
        if (reach <= 1e-9 * size * std::max(system.b.largest(), 1e-300)) {
            result.uncontrollable.push_back(std::move(direction));
        }
    }
    return result;
}

std::vector<std::complex<double>> zeros(const LinearSystem& system, std::size_t input, std::size_t state) {
    // Zeros are the poles under infinite feedback: eigenvalues of A - b (c A)/(c b) when c b is not zero, going on
    // through c A^k b when it is; those of the relative degree stay at the origin and are taken out.
    const std::size_t n = system.a.rows();
    Matrix b(n, 1), c(1, n);
    for (std::size_t i = 0; i < n; ++i) {
        b(i, 0) = system.b(i, input);
    }
    c(0, state) = 1;
    int degree = 1;
    Matrix row = c;
    while (degree <= static_cast<int>(n) &&
           std::abs((row * b)(0, 0)) < 1e-13 * (row.largest() * b.largest() + 1e-300)) {
        row = row * system.a;
        ++degree;
    }
    if (degree > static_cast<int>(n)) {
        return {};
    }
    const Matrix closed = system.a - (1 / (row * b)(0, 0)) * (b * (row * system.a));
    std::vector<std::complex<double>> found;
    for (const EigenPair& e : eigen(closed)) {
        found.push_back(e.value);
    }
    std::sort(found.begin(), found.end(), [](auto l, auto r) { return std::abs(l) < std::abs(r); });
    found.erase(found.begin(),
                found.begin() + std::min<std::ptrdiff_t>(degree, static_cast<std::ptrdiff_t>(found.size())));
    return found;
}

Regulator lqr(const LinearSystem& system, const Matrix& q, const Matrix& r) {
    const Matrix x = riccati(system.a, system.b, q, r);
    Regulator regulator;
    regulator.gain = solve(r, system.b.transposed() * x);
    for (const EigenPair& e : eigen(system.a - system.b * regulator.gain)) {
        regulator.poles.push_back(e.value);
    }
    return regulator;
}

SurfaceCoefficients surface_coefficients(const Model& model) {
    const Vehicle& v = model.vehicle;
    if (std::isnan(v.yaw_inertia)) {
        throw core::InputError("missing", "surface motion needs vehicle.yaw_inertia", {model.name, {}, {}, {}});
    }
    return {v.mass + v.added_mass_surge, v.mass + v.added_mass_sway, v.yaw_inertia + v.added_inertia_yaw,
            v.added_mass_surge - v.added_mass_sway, model.drag_surge.quadratic};
}

YawTransfer yaw_transfer(const SurfaceCoefficients& c, double speed, double friction_force, const EvieJets& jets) {
    const double cb = std::cos(jets.beta), sg = std::sin(jets.gamma), cg = std::cos(jets.gamma);
    YawTransfer transfer;
    transfer.side = sg * cb / c.mass_y;
    transfer.turn = -(jets.turn_y * cg + jets.turn_x * sg) * cb / c.inertia_r;
    const double a = friction_force / (speed * c.mass_y);
    transfer.zero = -a - c.munk * speed / c.inertia_r * transfer.side / transfer.turn;
    const Matrix matrix{{-a, -c.mass_x * speed / c.mass_y}, {c.munk * speed / c.inertia_r, 0}};
    for (const EigenPair& e : eigen(matrix)) {
        transfer.poles.push_back(e.value);
    }
    return transfer;
}

HeadingBounds heading_bounds(const SurfaceCoefficients& c, double speed, double friction_force) {
    HeadingBounds bounds;
    bounds.a = friction_force / (speed * c.mass_y);
    bounds.omega_squared = c.mass_x * std::abs(c.munk) * speed * speed / (c.mass_y * c.inertia_r);
    bounds.least_k2_without_friction = c.inertia_r * bounds.omega_squared;
    return bounds;
}

bool HeadingBounds::stable(double k1_torque, double k2_torque, double inertia_r) const {
    const double k1 = k1_torque / inertia_r, k2 = k2_torque / inertia_r;
    if (a == 0) {
        return k2 > omega_squared && k1 > 0;  // beside one pole at zero, the constant that no jet moves
    }
    return a * k2 > 0 && k2 > omega_squared - a * k1 && (a + k1) * (a * k1 + k2 - omega_squared) > a * k2;
}

GammaChart gamma_chart(const SurfaceCoefficients& c, const EvieJets& jets, double speed, double sideslip,
                       double friction_force, double friction_offset) {
    GammaChart chart;
    constexpr double right_angle = std::numbers::pi / 2;
    chart.best_gamma = std::atan2(jets.turn_x, jets.turn_y);
    chart.needed = needed_yaw_torque(c.munk, speed, sideslip, friction_force, friction_offset);
    chart.least_gamma = std::nan("");
    for (int i = 0; i <= 180; ++i) {
        const double gamma = right_angle * i / 180;
        const double beta = pitch_free_elevation(jets.turn_x, jets.turn_z, gamma);
        chart.gamma.push_back(gamma);
        chart.torque.push_back(pair_yaw_torque(jets.maximum, beta, gamma, jets.turn_x, jets.turn_y));
        chart.surge.push_back(std::cos(gamma) * std::cos(beta));
        if (std::isnan(chart.least_gamma) && chart.torque.back() >= chart.needed) {
            chart.least_gamma = gamma;
        }
    }
    chart.beta = pitch_free_elevation(jets.turn_x, jets.turn_z,
                                      std::isnan(chart.least_gamma) ? chart.best_gamma : chart.least_gamma);
    return chart;
}

core::Figure gamma_figure(const GammaChart& chart) {
    core::Figure figure;
    figure.title = "Jet angle: yaw torque against thrust lost";
    figure.x = {"jet angle gamma", "deg"};
    figure.y = {"yaw torque of a pair", "N m"};
    core::FigureCurve torque{"yaw torque at full thrust", {}, chart.torque, core::palette(0)};
    core::FigureCurve surge{
        "forward thrust left (1: the height of the largest torque)", {}, {}, core::palette(1), 2, true};
    const double most = *std::max_element(chart.torque.begin(), chart.torque.end());
    for (std::size_t i = 0; i < chart.gamma.size(); ++i) {
        torque.x.push_back(chart.gamma[i] / core::degree);
        surge.x.push_back(chart.gamma[i] / core::degree);
        surge.y.push_back(chart.surge[i] * most);
    }
    figure.curves = {torque, surge};
    figure.lines.push_back({false, chart.needed, "needed: sideslip and friction on one side"});
    if (!std::isnan(chart.least_gamma)) {
        figure.lines.push_back({true, chart.least_gamma / core::degree, "least angle"});
    }
    figure.caption = "Elevation beta nulls the thrust's pitch moment at each angle (" +
                     core::format_number(chart.beta / core::degree, 4) + " deg at the chosen one). Needed torque " +
                     core::format_number(chart.needed, 4) + " N m.";
    return figure;
}

double held_gap(const std::function<double(double)>& force, double gain, double reference, double bias) {
    const auto surplus = [&](double h) { return force(h) + bias - gain * (h - reference); };
    // Outward from the reference until the sign changes.
    double step = 1e-4;
    const double at = surplus(reference);
    if (at == 0) {
        return reference;
    }
    double lo = reference, hi = reference;
    const double side = at > 0 ? 1.0 : -1.0;
    while ((surplus(hi) > 0) == (at > 0)) {
        lo = hi;
        hi = reference + side * step;
        step *= 1.5;
        if (step > 100) {
            throw core::InputError("range", "no gap balances the feedback");
        }
    }
    for (int i = 0; i < 200; ++i) {
        const double middle = (lo + hi) / 2;
        ((surplus(middle) > 0) == (at > 0) ? lo : hi) = middle;
    }
    return (lo + hi) / 2;
}

}  // namespace underbody::dynamics
