// What samples say against themselves.
#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "surrogates/estimator/model/augmented_model.h"

namespace underbody::estimator {

namespace {

void warn(core::Problems& problems, const std::string& text) {
    problems.push_back({core::Problem::Severity::warning, text, {}});
}

// Mean, variance and covariance of weighted sums of channels.
struct Combination {
    const Moments& m;
    [[nodiscard]] double mean(const Vector& a) const {
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            sum += a[i] * m.mean[i];
        }
        return sum;
    }
    [[nodiscard]] double covariance(const Vector& a, const Vector& b) const {
        const Vector c = m.covariance * b;
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            sum += a[i] * c[i];
        }
        return sum;
    }
};

std::size_t place(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

// dh = w. A forward difference has dh = w + dt/2 dw/dt: its trace is a slope on the acceleration.
void check_gap_row(const Moments& m, std::size_t w, std::size_t dh, std::size_t dw, core::Problems& problems) {
    const Combination of{m};
    Vector miss(m.mean.size(), 0.0), acceleration = miss;
    miss[dh] = 1;
    miss[w] = -1;
    acceleration[dw] = 1;
    const double shift = of.mean(miss), spread = of.covariance(miss, miss);
    const double size = std::sqrt(std::max(m.covariance(w, w) + m.mean[w] * m.mean[w], 0.0));
    const double off = std::sqrt(std::max(spread, 0.0) + shift * shift);
    if (!(size > 0 && off > 1e-6 * size)) {
        return;
    }
    const double strength = of.covariance(acceleration, acceleration);
    const double slope = strength > 0 ? of.covariance(miss, acceleration) / strength : 0;
    const double left = std::sqrt(std::max(spread - slope * slope * strength, 0.0));
    std::string text =
        "the derivative of the gap contradicts the velocity by " + core::format_number(off / size, 3) + " of its size";
    if (slope > 0 && left < 0.2 * off) {
        text += ", in proportion to the acceleration: forward differences with a step of " +
                core::format_number(2 * slope, 3) + " s";
    }
    warn(problems, text);
}

// S dw = F_g - F_d + u + bias.
void check_acceleration_row(const Moments& m, const Layout& layout, double virtual_mass, core::Problems& problems) {
    const std::size_t nu = layout.inputs.size(), nx = layout.states.size();
    const std::size_t u = place(layout.inputs, "input_force"), ground = place(layout.states, "ground_force"),
                      drag = place(layout.states, "drag_force"), total = place(layout.states, "total_force");
    if (u >= nu || nu != 1 || !(total < nx || (ground < nx && drag < nx))) {
        return;
    }
    const Combination of{m};
    Vector force(m.mean.size(), 0.0), acceleration = force;
    force[u] = 1;
    if (total < nx) {
        force[nu + total] = 1;
    } else {
        force[nu + ground] = 1;
        force[nu + drag] = -1;
    }
    acceleration[nu + nx + place(layout.states, "heave_velocity")] = 1;
    const double push = of.covariance(force, force), answer = of.covariance(acceleration, acceleration);
    if (!(push > 0 && answer > 0)) {
        return;
    }
    const double slope = of.covariance(force, acceleration) / push;
    const double left = std::sqrt(std::max(answer - slope * slope * push, 0.0) / answer);
    if (left > 1e-5) {
        warn(problems, "the acceleration contradicts the forces and the input by " + core::format_number(left, 3) +
                           " of its size: noise, an outlier or another force is in the samples");
    } else if (virtual_mass > 0 && std::abs(slope * virtual_mass - 1) > 1e-4) {
        warn(problems, "the accelerations belong to a virtual mass of " + core::format_number(1 / slope, 5) +
                           " kg; the model declares " + core::format_number(virtual_mass, 5) + " kg");
    }
}

// Bounded, Gaussian and pink samples stay within six deviations of their mean; a force that is steep near the ground
// does not, and among many samples its largest values weigh little.
void check_outliers(const Moments& m, const Layout& layout, core::Problems& problems) {
    const auto names = layout.names();
    for (std::size_t i = 0; i < m.lowest.size() && i < names.size(); ++i) {
        const double sigma = std::sqrt(std::max(m.covariance(i, i), 0.0));
        const double value = m.mean[i] - m.lowest[i] > m.highest[i] - m.mean[i] ? m.lowest[i] : m.highest[i];
        const double reach = std::abs(value - m.mean[i]);
        constexpr double far = 12, notable = 0.02;  // deviations; part of the variance
        const double part = reach * reach / (sigma * sigma * static_cast<double>(m.count));
        if (sigma > 1e-9 * std::abs(m.mean[i]) && reach > far * sigma && part > notable) {
            warn(problems, "channel '" + names[i] + "' holds " + core::format_number(value, 4) + ", " +
                               core::format_number(reach / sigma, 3) + " deviations from its mean: one value makes " +
                               core::format_number(100 * std::min(part, 1.0), 2) +
                               " % of the variance; leave it out if it is an outlier");
        }
    }
}

}  // namespace

core::Problems check_consistency(const Moments& m, const Layout& layout, double virtual_mass) {
    core::Problems problems;
    const std::size_t nu = layout.inputs.size(), nx = layout.states.size();
    const std::size_t w = place(layout.states, "heave_velocity"), h = place(layout.states, "gap");
    if (m.mean.size() != layout.channels() || w >= nx || h >= nx) {
        return problems;
    }
    check_gap_row(m, nu + w, nu + nx + h, nu + nx + w, problems);
    check_acceleration_row(m, layout, virtual_mass, problems);
    check_outliers(m, layout, problems);
    return problems;
}

}  // namespace underbody::estimator
