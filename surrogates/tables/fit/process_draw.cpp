// Draws from the joint posterior of a mixture of Gaussian processes.
//
// A random function of the process as a sum of cosines (Rahimi and Recht 2008), then conditioned on the points: f + k
// K^-1 (0 - f(points) - noise) (Matheron's rule; Wilson and others, Efficiently sampling functions from Gaussian
// process posteriors, 2020).
#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/random.h"
#include "surrogates/tables/fit/process_mixture.h"

namespace underbody::tables {

namespace {

/// Frequencies (in lengths) and phases of a random function with the kernel; its trend.
struct RandomFunction {
    std::size_t features = 0;
    std::vector<double> frequency;  ///< [feature * axes + axis]
    std::vector<double> phase;
    std::vector<double> trend;

    RandomFunction(const ProcessPart& part, core::Random& random) : features(part.process.data().axes > 2 ? 128 : 256) {
        const GpData& d = part.process.data();
        for (std::size_t j = 0; j < features; ++j) {
            for (std::size_t k = 0; k < d.axes; ++k) {
                double stretch = 1;
                if (part.process.kernel() == Kernel::matern52) {
                    // Its spectrum is Student's t with five degrees of freedom.
                    double square = 0;
                    for (int i = 0; i < 5; ++i) {
                        square += std::pow(random.normal(), 2);
                    }
                    stretch = std::sqrt(5 / square);
                }
                frequency.push_back(random.normal() * stretch / part.process.parameters().length[k]);
            }
            phase.push_back(random.uniform(0, 2 * std::numbers::pi));
        }
        for (std::size_t j = 0; j < d.trends; ++j) {
            trend.push_back(std::sqrt(d.trend_variance) * random.normal());
        }
    }
    [[nodiscard]] double size(const GpParameters& p) const {
        return p.scale * std::sqrt(2.0 / static_cast<double>(features));
    }
    [[nodiscard]] double operator()(const GpParameters& p, const double* x, std::size_t axes) const {
        double sum = 0;
        for (std::size_t j = 0; j < features; ++j) {
            double angle = phase[j];
            for (std::size_t k = 0; k < axes; ++k) {
                angle += frequency[j * axes + k] * x[k];
            }
            sum += std::cos(angle);
        }
        return size(p) * sum;
    }
};

/// Sum over rows of products over the axes of factors [axis][line * rows + row], at every node of the grid (last axis
/// fastest); real part.
template <class Number>
std::vector<double> sums_of_products(const std::vector<std::vector<Number>>& factors, const std::vector<Number>& start,
                                     const std::vector<std::size_t>& sizes) {
    const std::size_t n = sizes.size();
    const std::size_t rows = start.size();
    std::size_t count = 1;
    for (const std::size_t size : sizes) {
        count *= size;
    }
    std::vector<double> sums(count);
    std::vector<Number> product(rows);
    const std::size_t last = sizes[n - 1];
    for (std::size_t begin = 0; begin < count; begin += last) {
        product = start;
        std::size_t rest = begin / last;
        for (std::size_t k = n - 1; k-- > 0;) {
            const Number* from = &factors[k][(rest % sizes[k]) * rows];
            rest /= sizes[k];
            for (std::size_t j = 0; j < rows; ++j) {
                product[j] *= from[j];
            }
        }
        for (std::size_t i = 0; i < last; ++i) {
            const Number* from = &factors[n - 1][i * rows];
            double sum = 0;
            for (std::size_t j = 0; j < rows; ++j) {
                sum += std::real(product[j] * from[j]);
            }
            sums[begin + i] = sum;
        }
    }
    return sums;
}

/// What is left of the values without a draw of the prior, solved for the weights of the kernel.
std::vector<double> weights_beside(const ProcessPart& part, const RandomFunction& prior, std::size_t n,
                                   core::Random& random) {
    const GpData& d = part.process.data();
    const GpParameters& p = part.process.parameters();
    std::vector<double> rest(d.count());
    for (std::size_t i = 0; i < d.count(); ++i) {
        double value = d.amplitude_of(i) * prior(p, &d.x[i * n], n);
        for (std::size_t j = 0; j < d.trends; ++j) {
            value += prior.trend[j] * d.trend[i * d.trends + j];
        }
        rest[i] = d.y[i] - value - std::sqrt(d.noise[i] + p.scatter * p.scatter) * random.normal();
    }
    return part.process.solved(std::move(rest));
}

/// One draw from the posterior of a part at the nodes, in units of the force.
std::vector<double> drawn_values(const ProcessPart& part, const ProcessMixture::Grid& grid, core::Random& random) {
    const GpData& d = part.process.data();
    const GpParameters& p = part.process.parameters();
    const Form& form = part.form;
    const std::size_t n = grid.size();
    const RandomFunction prior(part, random);
    const auto weights = weights_beside(part, prior, n, random);
    std::vector<double> trend = prior.trend;
    for (std::size_t i = 0; i < d.count(); ++i) {
        for (std::size_t j = 0; j < d.trends; ++j) {
            trend[j] += d.trend_variance * weights[i] * d.trend[i * d.trends + j];
        }
    }
    std::vector<std::size_t> sizes;
    std::vector<std::vector<double>> kernel(n);
    std::vector<std::vector<std::complex<double>>> waves(n);
    for (std::size_t k = 0; k < n; ++k) {
        sizes.push_back(grid[k].size());
        for (const double x : grid[k]) {
            const double t = form.coordinate(k, x);
            for (std::size_t i = 0; i < d.count(); ++i) {
                kernel[k].push_back(kernel_value(part.process.kernel(), (t - d.x[i * n + k]) / p.length[k]).value);
            }
            for (std::size_t j = 0; j < prior.features; ++j) {
                waves[k].push_back(std::polar(1.0, prior.frequency[j * n + k] * t));
            }
        }
    }
    std::vector<double> kernel_start;
    for (std::size_t i = 0; i < d.count(); ++i) {
        kernel_start.push_back(p.scale * p.scale * weights[i] * d.amplitude_of(i));
    }
    std::vector<std::complex<double>> wave_start;
    for (const double phase : prior.phase) {
        wave_start.push_back(std::polar(prior.size(p), phase));
    }
    auto values = sums_of_products(kernel, kernel_start, sizes);
    const auto wave = sums_of_products(waves, wave_start, sizes);
    std::vector<double> x(n);
    for (std::size_t node = 0; node < values.size(); ++node) {
        std::size_t index = node;
        for (std::size_t k = n; k-- > 0;) {
            x[k] = grid[k][index % sizes[k]];
            index /= sizes[k];
        }
        double h[3];
        form.trend(x, h);
        double value = form.amplitude(x) * (values[node] + wave[node]);
        for (std::size_t j = 0; j < d.trends; ++j) {
            value += trend[j] * h[j];
        }
        values[node] = form.factor(x) * (form.offset + form.size * value);
    }
    return values;
}

}  // namespace

std::vector<double> ProcessMixture::deviation(const std::vector<double>& mean, std::uint64_t seed) const {
    core::Random random(seed);
    std::size_t chosen = 0;
    for (double left = random.uniform() - parts[0].weight; left > 0 && chosen + 1 < parts.size();
         left -= parts[chosen].weight) {
        ++chosen;
    }
    auto values = drawn_values(parts[chosen], grid, random);
    for (std::size_t node = 0; node < values.size(); ++node) {
        const double widened = own_sigma[node] > 0 ? sigma[node] / own_sigma[node] : 1;
        values[node] = widened * (values[node] - mean[node << grid.size()]);
    }
    return values;
}

}  // namespace underbody::tables
