#include "surrogates/tables/fit/process_mixture.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "surrogates/tables/fit/error_model.h"

namespace underbody::tables {

namespace {

using Grid = ProcessMixture::Grid;

std::size_t nodes_of(const Grid& grid) {
    std::size_t count = 1;
    for (const auto& axis : grid) {
        count *= axis.size();
    }
    return count;
}

/// Coordinates of a node, last axis fastest.
void place_of(const Grid& grid, std::size_t node, std::vector<double>& x) {
    for (std::size_t k = grid.size(); k-- > 0;) {
        x[k] = grid[k][node % grid[k].size()];
        node /= grid[k].size();
    }
}

std::vector<double> knots_of(const SetPoints& points, const Form& form, double length, std::size_t k) {
    const TableAxis& axis = points.axes[k];
    static constexpr std::size_t most[] = {400, 90, 30, 15};
    const std::size_t n = points.axes.size();
    const auto wanted = static_cast<std::size_t>(std::ceil((n < 3 ? 8.0 : 5.0) / length)) + 2;
    const std::size_t count = std::clamp<std::size_t>(
        std::max(wanted, form.logarithmic[k] ? std::size_t{24} : std::size_t{8}), 6, most[n - 1]);
    std::vector<double> knots(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(count - 1);
        knots[i] = i == 0                ? axis.lower
                   : i + 1 == count      ? axis.upper
                   : form.logarithmic[k] ? axis.lower * std::pow(axis.upper / axis.lower, t)
                                         : axis.lower + t * (axis.upper - axis.lower);
    }
    if (n == 1) {
        // The third derivative of a Matern process jumps at its points.
        const double apart = 1e-3 * (axis.upper - axis.lower) / static_cast<double>(count);
        for (const double x : axis.points.size() <= 200 ? axis.points : std::vector<double>{}) {
            const auto next = std::lower_bound(knots.begin(), knots.end(), x);
            const bool near_next = next != knots.end() && *next - x < apart;
            const bool near_last = next != knots.begin() && x - *(next - 1) < apart;
            if (!near_next && !near_last) {
                knots.insert(next, x);
            }
        }
    }
    return knots;
}

/// Kernel factors of each axis and their slopes: [axis][derivative][grid line * points + point].
std::vector<std::array<std::vector<double>, 2>> kernel_factors(const GaussianProcess& process, const Form& form,
                                                               const Grid& grid) {
    const GpData& d = process.data();
    const std::size_t n = grid.size();
    const std::size_t points = d.count();
    // part[k][derivative][i * points + q]: kernel factor of grid line i and point q.
    std::vector<std::array<std::vector<double>, 2>> part(n);
    for (std::size_t k = 0; k < n; ++k) {
        for (auto& matrix : part[k]) {
            matrix.resize(grid[k].size() * points);
        }
        for (std::size_t i = 0; i < grid[k].size(); ++i) {
            const double t = form.coordinate(k, grid[k][i]);
            const double rate = form.coordinate_slope(k, grid[k][i]) / process.parameters().length[k];
            const bool decays = form.decay == k;
            const double amplitude = decays ? std::pow(grid[k][i] / form.decay_gap, -form.decay_power) : 1;
            const double amplitude_slope = decays ? -form.decay_power * amplitude / grid[k][i] : 0;
            for (std::size_t q = 0; q < points; ++q) {
                const auto v = kernel_value(process.kernel(), (t - d.x[q * n + k]) / process.parameters().length[k]);
                part[k][0][i * points + q] = amplitude * v.value;
                part[k][1][i * points + q] = amplitude * v.slope * rate + amplitude_slope * v.value;
            }
        }
    }
    return part;
}

/// Exact Hermite data of the mean on a tensor grid: the kernel is a product over the axes, so each axis has its own
/// matrices.
std::vector<double> process_hermite(const GaussianProcess& process, const Form& form, const Grid& grid) {
    const GpData& d = process.data();
    const std::size_t n = grid.size();
    const std::size_t points = d.count();
    const auto part = kernel_factors(process, form, grid);
    const std::size_t count = nodes_of(grid);
    const std::size_t width = std::size_t{1} << n;
    std::vector<double> hermite(count * width);
    // Products over all axes but the last are kept from node to node.
    std::vector<double> product(width / 2 * points);
    const double scale = process.parameters().scale * process.parameters().scale;
    const std::size_t last = grid[n - 1].size();
    for (std::size_t begin = 0; begin < count; begin += last) {
        for (std::size_t mask = 0; mask < width / 2; ++mask) {
            double* to = &product[mask * points];
            for (std::size_t q = 0; q < points; ++q) {
                to[q] = scale * process.weights()[q] * d.amplitude_of(q);
            }
            std::size_t rest = begin / last;
            for (std::size_t k = n - 1; k-- > 0;) {
                const double* from = &part[k][mask >> k & 1][(rest % grid[k].size()) * points];
                rest /= grid[k].size();
                for (std::size_t q = 0; q < points; ++q) {
                    to[q] *= from[q];
                }
            }
        }
        for (std::size_t i = 0; i < last; ++i) {
            for (std::size_t mask = 0; mask < width; ++mask) {
                const double* a = &product[(mask & (width / 2 - 1)) * points];
                const double* b = &part[n - 1][mask >> (n - 1) & 1][i * points];
                hermite[(begin + i) * width + mask] =
                    Eigen::Map<const Eigen::VectorXd>(a, static_cast<Eigen::Index>(points))
                        .dot(Eigen::Map<const Eigen::VectorXd>(b, static_cast<Eigen::Index>(points)));
            }
        }
    }
    return hermite;
}

/// Trend, size and squares on top of the process, with their own derivatives.
void add_laws(std::vector<double>& hermite, const GaussianProcess& process, const Form& form, const Grid& grid) {
    const std::size_t n = grid.size();
    const std::size_t width = std::size_t{1} << n;
    const auto& c = process.coefficients();
    for (std::size_t node = 0; node < hermite.size() / width; ++node) {
        double* data = &hermite[node * width];
        std::vector<double> x(n);
        std::size_t rest = node;
        for (std::size_t k = n; k-- > 0;) {
            x[k] = grid[k][rest % grid[k].size()];
            rest /= grid[k].size();
        }
        data[0] += c[0];
        if (form.film) {
            const double r = form.film_gap / x[*form.film];
            data[0] += c[1] * r * r + c[2] * r * r * r;
            data[std::size_t{1} << *form.film] -= (2 * c[1] * r * r + 3 * c[2] * r * r * r) / x[*form.film];
        }
        for (std::size_t m = 0; m < width; ++m) {
            data[m] *= form.size;
        }
        data[0] += form.offset;
        for (std::size_t k = 0; k < n; ++k) {
            if (!form.squared[k]) {
                continue;
            }
            const double p = std::pow(x[k] / form.reference[k], 2);
            const double slope = 2 * x[k] / (form.reference[k] * form.reference[k]);
            for (std::size_t m = 0; m < width; ++m) {
                if ((m >> k & 1) == 0) {
                    const std::size_t with = m | std::size_t{1} << k;
                    data[with] = p * data[with] + slope * data[m];
                    data[m] *= p;
                }
            }
        }
    }
}

/// Hermite data of the mean of one part, in units of the force.
std::vector<double> hermite_of(const ProcessPart& part, const Grid& grid) {
    auto hermite = process_hermite(part.process, part.form, grid);
    add_laws(hermite, part.process, part.form, grid);
    return hermite;
}

/// Every `skip`-th grid line and the last.
Grid thinned(const Grid& grid, std::size_t skip) {
    Grid coarse(grid.size());
    for (std::size_t k = 0; k < grid.size(); ++k) {
        for (std::size_t i = 0; i < grid[k].size(); i += skip) {
            coarse[k].push_back(grid[k][i]);
        }
        if (coarse[k].back() != grid[k].back()) {
            coarse[k].push_back(grid[k].back());
        }
    }
    return coarse;
}

/// Adds the weighted variance of a part at the nodes of a grid, in units of the force: its own, and widened (by the
/// square of `local`, a node) with the scatter.
void add_variance(const ProcessPart& part, const ProcessMixture& mixture, const Grid& grid,
                  const std::vector<double>& local, std::vector<double>& plain, std::vector<double>& variance) {
    const double near = mixture.widened_near, far = mixture.widened_far;
    const std::size_t n = grid.size();
    const Form& form = part.form;
    std::vector<double> t(variance.size() * n), h(variance.size() * form.trends()), factor(variance.size()),
        amplitude(variance.size());
    std::vector<double> x(n);
    for (std::size_t node = 0; node < variance.size(); ++node) {
        place_of(grid, node, x);
        for (std::size_t k = 0; k < n; ++k) {
            t[node * n + k] = form.coordinate(k, x[k]);
        }
        form.trend(x, &h[node * form.trends()]);
        factor[node] = form.factor(x) * form.size;
        amplitude[node] = form.amplitude(x);
    }
    const auto own = part.process.variances(t, h, amplitude);
    const auto& p = part.process.parameters();
    const double scatter = mixture.scatter_is_noise ? 0 : p.scatter;
    for (std::size_t node = 0; node < variance.size(); ++node) {
        const double share = std::min(1.0, own[node] / std::pow(p.scale * amplitude[node], 2));
        const double widened = local[node] * (near * near * (1 - share) + far * far * share);
        plain[node] += part.weight * factor[node] * factor[node] * own[node];
        variance[node] += part.weight * factor[node] * factor[node] * (widened * own[node] + scatter * scatter);
    }
}

}  // namespace

double ProcessMixture::local_widening(const double* coordinates, std::size_t but) const {
    const GaussianProcess& process = parts.front().process;
    const GpData& d = process.data();
    double sum = 3, weight = 3;
    for (std::size_t i = 0; i < misfit.size(); ++i) {
        double w = i == but ? 0 : 1;
        for (std::size_t k = 0; k < d.axes; ++k) {
            w *= kernel_value(process.kernel(), (coordinates[k] - d.x[i * d.axes + k]) / process.parameters().length[k])
                     .value;
        }
        sum += w * w * std::min(misfit[i], largest_square);
        weight += w * w;
    }
    return std::max(0.9, sum / weight);
}

void ProcessMixture::choose_grid(const SetPoints& points) {
    grid.clear();
    for (std::size_t k = 0; k < points.axes.size(); ++k) {
        double shortest = parts.front().process.parameters().length[k];
        for (const auto& part : parts) {
            // Lengths count in the coordinate of the first form; a form on another coordinate resolves about the same.
            if (part.weight > 0.05 && part.form.logarithmic[k] == parts.front().form.logarithmic[k]) {
                shortest = std::min(shortest, part.process.parameters().length[k]);
            }
        }
        grid.push_back(knots_of(points, parts.front().form, shortest, k));
    }
}

/// Of each axis so many lines that the variance is not computed at: it costs the square of the points a node.
std::size_t ProcessMixture::lines_to_skip() const {
    const double points = static_cast<double>(parts.front().process.data().count());
    const double work = points * points * static_cast<double>(nodes_of(grid) * parts.size());
    std::size_t skip = 1;
    while (work / std::pow(static_cast<double>(skip), static_cast<double>(grid.size())) > 2e9 && skip < 8) {
        ++skip;
    }
    return skip;
}

std::vector<double> ProcessMixture::widening_on(const Grid& nodes) const {
    std::vector<double> local(nodes_of(nodes));
    std::vector<double> x(grid.size()), t(grid.size());
    for (std::size_t node = 0; node < local.size(); ++node) {
        place_of(nodes, node, x);
        for (std::size_t k = 0; k < grid.size(); ++k) {
            t[k] = parts.front().form.coordinate(k, x[k]);
        }
        local[node] = local_widening(t.data());
    }
    return local;
}

std::vector<double> ProcessMixture::tabulate() {
    const std::size_t count = nodes_of(grid);
    const std::size_t width = std::size_t{1} << grid.size();
    std::vector<double> mean(count * width, 0.0);
    std::vector<double> square(count, 0.0);
    std::vector<double> first;
    for (const auto& part : parts) {
        const auto own = hermite_of(part, grid);
        if (first.empty()) {
            first = own;
        }
        for (std::size_t i = 0; i < mean.size(); ++i) {
            mean[i] += part.weight * own[i];
        }
        for (std::size_t node = 0; node < count; ++node) {
            square[node] += part.weight * std::pow(own[node * width] - first[node * width], 2);
        }
    }
    const std::size_t skip = lines_to_skip();
    const Grid coarse = thinned(grid, skip);
    std::vector<double> within(nodes_of(coarse), 0.0);
    std::vector<double> plain(within.size(), 0.0);
    const std::vector<double> local = widening_on(coarse);
    for (const auto& part : parts) {
        add_variance(part, *this, coarse, local, plain, within);
    }
    std::vector<double> x(grid.size());
    const auto spread_out = [&](std::vector<double>& variance) {
        for (double& v : variance) {
            v = std::sqrt(v);
        }
        if (skip > 1) {
            const ErrorModel between(coarse, std::move(variance));
            variance.resize(count);
            for (std::size_t node = 0; node < count; ++node) {
                place_of(grid, node, x);
                variance[node] = between.sigma(x.data(), nullptr);
            }
        }
        for (std::size_t node = 0; node < count; ++node) {
            // About the first part's value, so that no digits are lost.
            const double apart = square[node] - std::pow(mean[node * width] - first[node * width], 2);
            variance[node] = std::sqrt(variance[node] * variance[node] + std::max(0.0, apart));
        }
        return std::move(variance);
    };
    sigma = spread_out(within);
    own_sigma = spread_out(plain);
    return mean;
}

ProcessMixture::LeftOut ProcessMixture::leave_one_out(const SetPoints& points) const {
    const std::size_t n = points.x.size();
    LeftOut result{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
    std::vector<double> square(n, 0.0);
    for (const auto& part : parts) {
        const auto left_out = part.process.leave_one_out();
        const auto& p = part.process.parameters();
        for (std::size_t i = 0; i < n; ++i) {
            const double unit = part.form.size * part.form.factor(points.x[i]);
            const double mean = part.form.factor(points.x[i]) * (part.form.offset + part.form.size * left_out.mean[i]);
            result.mean[i] += part.weight * mean;
            square[i] += part.weight * std::pow(mean - points.value[i], 2);
            result.variance[i] += part.weight * unit * unit * left_out.variance[i];
            const double prior = std::pow(p.scale * part.process.data().amplitude_of(i), 2);
            const double own = left_out.variance[i] - part.process.data().noise[i] - p.scatter * p.scatter;
            result.share[i] += part.weight * std::clamp(own / prior, 0.0, 1.0);
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        result.variance[i] += std::max(0.0, square[i] - std::pow(result.mean[i] - points.value[i], 2));
    }
    return result;
}

}  // namespace underbody::tables
