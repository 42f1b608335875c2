#include "surrogates/tables/fit/gaussian_process.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "surrogates/tables/fit/gaussian_process_state.h"

namespace underbody::tables {

using Eigen::MatrixXd;
using Eigen::VectorXd;

KernelValue kernel_value(Kernel kernel, double a) {
    if (kernel == Kernel::squared_exponential) {
        const double e = std::exp(-0.5 * a * a);
        return {e, -a * e};
    }
    const double s = std::sqrt(5.0) * std::abs(a);
    const double e = std::exp(-s);
    return {(1 + s + s * s / 3) * e, -5.0 / 3.0 * a * (1 + s) * e};
}

namespace {

/// d log k / d log length, from the distance in lengths.
double length_rate(Kernel kernel, double a) {
    if (kernel == Kernel::squared_exponential) {
        return a * a;
    }
    const double s = std::sqrt(5.0) * std::abs(a);
    return s * s * (1 + s) / (3 + 3 * s + s * s);
}

/// Covariance of the process alone, lower triangle filled and mirrored.
MatrixXd process_covariance(const GpData& data, Kernel kernel, const GpParameters& p) {
    const auto n = static_cast<Eigen::Index>(data.count());
    MatrixXd k(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        const double own = p.scale * data.amplitude_of(static_cast<std::size_t>(j));
        k(j, j) = own * own;
        for (Eigen::Index i = j + 1; i < n; ++i) {
            // One exponential for all axes: their exponents add.
            double exponent = 0;
            double factor = own * p.scale * data.amplitude_of(static_cast<std::size_t>(i));
            for (std::size_t a = 0; a < data.axes; ++a) {
                const double d = (data.x[i * data.axes + a] - data.x[j * data.axes + a]) / p.length[a];
                if (kernel == Kernel::squared_exponential) {
                    exponent += 0.5 * d * d;
                } else {
                    const double s = std::sqrt(5.0) * std::abs(d);
                    exponent += s;
                    factor *= 1 + s + s * s / 3;
                }
            }
            k(i, j) = k(j, i) = factor * std::exp(-exponent);
        }
    }
    return k;
}

/// Adds trend, noise and scatter; factorises, with a jitter that grows until it works.
Eigen::LLT<MatrixXd> factorised(const GpData& data, const GpParameters& p, MatrixXd k) {
    const auto n = static_cast<Eigen::Index>(data.count());
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> h(
        data.trend.data(), n, static_cast<Eigen::Index>(data.trends));
    k.noalias() += data.trend_variance * h * h.transpose();
    for (Eigen::Index i = 0; i < n; ++i) {
        k(i, i) += data.noise[static_cast<std::size_t>(i)] + p.scatter * p.scatter;
    }
    double jitter = 0;
    for (int attempt = 0; attempt < 8; ++attempt) {
        Eigen::LLT<MatrixXd> factor(k);
        if (factor.info() == Eigen::Success) {
            return factor;
        }
        const double next = jitter == 0 ? 1e-12 * k.diagonal().maxCoeff() : 10 * jitter;
        k.diagonal().array() += next - jitter;
        jitter = next;
    }
    return Eigen::LLT<MatrixXd>(MatrixXd(k.diagonal().asDiagonal()));
}

MatrixXd inverse_of(const Eigen::LLT<MatrixXd>& factor) {
    const Eigen::Index n = factor.rows();
    MatrixXd lower = MatrixXd::Identity(n, n);
    factor.matrixL().solveInPlace(lower);
    MatrixXd inverse = MatrixXd::Zero(n, n);
    inverse.selfadjointView<Eigen::Lower>().rankUpdate(lower.transpose());
    inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
    return inverse;
}

double log_determinant(const Eigen::LLT<MatrixXd>& factor) {
    double sum = 0;
    for (Eigen::Index i = 0; i < factor.rows(); ++i) {
        sum += 2 * std::log(factor.matrixLLT()(i, i));
    }
    return sum;
}

std::vector<double> logs(const GpParameters& p) {
    std::vector<double> v;
    for (const double l : p.length) {
        v.push_back(std::log(l));
    }
    v.push_back(std::log(p.scale));
    v.push_back(std::log(p.scatter));
    return v;
}

GpParameters from_logs(const std::vector<double>& v) {
    GpParameters p;
    for (std::size_t i = 0; i + 2 < v.size(); ++i) {
        p.length.push_back(std::exp(v[i]));
    }
    p.scale = std::exp(v[v.size() - 2]);
    p.scatter = std::exp(v[v.size() - 1]);
    return p;
}

/// Negative log posterior of the logs of the parameters.
class Objective {
public:
    Objective(const GpData& data, const GpOptions& options) : data_(data), options_(options) {}

    double operator()(const std::vector<double>& v, std::vector<double>& gradient) const {
        const double value = -GaussianProcess::log_posterior(data_, options_, from_logs(v), &gradient);
        for (double& g : gradient) {
            g = -g;
        }
        return value;
    }

private:
    const GpData& data_;
    const GpOptions& options_;
};

struct Optimum {
    std::vector<double> at;
    double value = 0;
};

/// BFGS with backtracking; a handful of unknowns, each evaluation dear.
Optimum minimise(const Objective& f, std::vector<double> v, int evaluations, core::Progress& progress) {
    const auto n = static_cast<Eigen::Index>(v.size());
    std::vector<double> g(v.size()), g_next(v.size()), next(v.size());
    double value = f(v, g);
    --evaluations;
    MatrixXd inverse = MatrixXd::Identity(n, n);
    while (evaluations > 0) {
        progress.check();
        const Eigen::Map<VectorXd> gradient(g.data(), n);
        VectorXd step = -inverse * gradient;
        if (step.dot(gradient) > -1e-12 * gradient.squaredNorm()) {
            inverse.setIdentity();
            step = -gradient;
        }
        const double largest = step.cwiseAbs().maxCoeff();
        step *= largest > 1.5 ? 1.5 / largest : 1;
        double share = 1;
        bool found = false;
        double next_value = value;
        for (int i = 0; i < 8 && evaluations > 0; ++i, share *= 0.35) {
            for (Eigen::Index j = 0; j < n; ++j) {
                next[j] = std::clamp(v[j] + share * step(j), -14.0, 6.0);
            }
            next_value = f(next, g_next);
            --evaluations;
            if (next_value < value + 1e-4 * share * step.dot(gradient)) {
                found = true;
                break;
            }
        }
        if (!found) {
            break;
        }
        VectorXd s(n), y(n);
        for (Eigen::Index j = 0; j < n; ++j) {
            s(j) = next[j] - v[j];
            y(j) = g_next[j] - g[j];
        }
        const double gain = value - next_value;
        v = next;
        g = g_next;
        value = next_value;
        if (const double sy = s.dot(y); sy > 1e-12) {
            const MatrixXd left = MatrixXd::Identity(n, n) - s * y.transpose() / sy;
            inverse = left * inverse * left.transpose() + s * s.transpose() / sy;
        }
        if (gain < 1e-3 && Eigen::Map<VectorXd>(g.data(), n).cwiseAbs().maxCoeff() < 0.05) {
            break;
        }
    }
    return {v, value};
}

}  // namespace

GaussianProcess::GaussianProcess(GpData data, Kernel kernel, GpParameters parameters) {
    auto state = std::make_shared<State>();
    state->data = std::move(data);
    state->kernel = kernel;
    state->parameters = std::move(parameters);
    const GpData& d = state->data;
    state->factor = factorised(d, state->parameters, process_covariance(d, kernel, state->parameters));
    const VectorXd alpha =
        state->factor.solve(Eigen::Map<const VectorXd>(d.y.data(), static_cast<Eigen::Index>(d.count())));
    state->weights.assign(alpha.data(), alpha.data() + alpha.size());
    state->coefficients.assign(d.trends, 0.0);
    for (std::size_t i = 0; i < d.count(); ++i) {
        for (std::size_t j = 0; j < d.trends; ++j) {
            state->coefficients[j] += d.trend_variance * state->weights[i] * d.trend[i * d.trends + j];
        }
    }
    state->x = Eigen::Map<const Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        d.x.data(), static_cast<Eigen::Index>(d.count()), static_cast<Eigen::Index>(d.axes));
    state_ = std::move(state);
}

GaussianProcess GaussianProcess::fit(GpData data, const GpOptions& options, core::Progress& progress) {
    const Objective objective(data, options);
    std::vector<GpParameters> starts = options.starts;
    if (starts.empty()) {
        for (const double length : {0.25, 1.0}) {
            GpParameters p;
            p.length.assign(data.axes, length);
            p.scatter = options.expected_scatter;
            starts.push_back(p);
        }
    }
    Optimum best;
    for (std::size_t i = 0; i < starts.size(); ++i) {
        const Optimum found = minimise(objective, logs(starts[i]), options.iterations, progress);
        if (i == 0 || found.value < best.value) {
            best = found;
        }
    }
    return {std::move(data), options.kernel, from_logs(best.at)};
}

const GpData& GaussianProcess::data() const { return state_->data; }
Kernel GaussianProcess::kernel() const { return state_->kernel; }
const GpParameters& GaussianProcess::parameters() const { return state_->parameters; }
const std::vector<double>& GaussianProcess::weights() const { return state_->weights; }
const std::vector<double>& GaussianProcess::coefficients() const { return state_->coefficients; }
double GaussianProcess::log_likelihood() const {
    return log_likelihood(state_->data, state_->kernel, state_->parameters, nullptr);
}

double GaussianProcess::log_likelihood(const GpData& data, Kernel kernel, const GpParameters& p,
                                       std::vector<double>* gradient) {
    const auto n = static_cast<Eigen::Index>(data.count());
    const MatrixXd k = process_covariance(data, kernel, p);
    const auto factor = factorised(data, p, k);
    const VectorXd alpha = factor.solve(Eigen::Map<const VectorXd>(data.y.data(), n));
    const double fit = alpha.dot(Eigen::Map<const VectorXd>(data.y.data(), n));
    const double value =
        -0.5 * (fit + log_determinant(factor) + static_cast<double>(n) * std::log(2 * std::numbers::pi));
    if (gradient == nullptr) {
        return value;
    }
    const MatrixXd inverse = inverse_of(factor);
    std::vector<double>& g = *gradient;
    g.assign(data.axes + 2, 0.0);
    for (Eigen::Index j = 0; j < n; ++j) {
        const double own = alpha(j) * alpha(j) - inverse(j, j);
        g[data.axes] += own * k(j, j);
        g[data.axes + 1] += own * p.scatter * p.scatter;
        for (Eigen::Index i = j + 1; i < n; ++i) {
            const double w = 2 * (alpha(i) * alpha(j) - inverse(i, j)) * k(i, j);
            g[data.axes] += w;
            for (std::size_t a = 0; a < data.axes; ++a) {
                const double d = (data.x[i * data.axes + a] - data.x[j * data.axes + a]) / p.length[a];
                g[a] += 0.5 * w * length_rate(kernel, d);
            }
        }
    }
    return value;
}

double GaussianProcess::log_posterior(const GpData& data, const GpOptions& options, const GpParameters& p,
                                      std::vector<double>* gradient) {
    double value = log_likelihood(data, options.kernel, p, gradient);
    const auto v = logs(p);
    for (std::size_t i = 0; i < v.size(); ++i) {
        const bool scatter = i + 1 == v.size();
        const bool scale = i + 2 == v.size();
        const double middle = scatter ? std::log(options.expected_scatter) : scale ? 0 : std::log(0.6);
        const double width = scatter ? 2.0 : scale ? 1.5 : 1.0;
        value -= 0.5 * std::pow((v[i] - middle) / width, 2);
        if (gradient != nullptr) {
            (*gradient)[i] -= (v[i] - middle) / (width * width);
        }
    }
    return value;
}

std::vector<double> GaussianProcess::solved(std::vector<double> values) const {
    Eigen::Map<VectorXd> vector(values.data(), static_cast<Eigen::Index>(values.size()));
    state_->factor.solveInPlace(vector);
    return values;
}

double GaussianProcess::mean(std::span<const double> x, std::span<const double> trend, double amplitude) const {
    const State& s = *state_;
    double sum = 0;
    for (std::size_t j = 0; j < s.data.trends; ++j) {
        sum += s.coefficients[j] * trend[j];
    }
    for (std::size_t i = 0; i < s.data.count(); ++i) {
        double k = s.parameters.scale * s.parameters.scale * amplitude * s.data.amplitude_of(i);
        for (std::size_t a = 0; a < s.data.axes; ++a) {
            k *= kernel_value(s.kernel, (x[a] - s.data.x[i * s.data.axes + a]) / s.parameters.length[a]).value;
        }
        sum += s.weights[i] * k;
    }
    return sum;
}

std::vector<double> GaussianProcess::variances(std::span<const double> x, std::span<const double> trend,
                                               std::span<const double> amplitude) const {
    const State& s = *state_;
    const std::size_t count = x.size() / s.data.axes;
    const auto n = static_cast<Eigen::Index>(s.data.count());
    std::vector<double> result(count);
    constexpr std::size_t block = 128;
    for (std::size_t begin = 0; begin < count; begin += block) {
        const std::size_t size = std::min(block, count - begin);
        MatrixXd k(n, static_cast<Eigen::Index>(size));
        for (std::size_t q = 0; q < size; ++q) {
            const double* at = &x[(begin + q) * s.data.axes];
            const double* h = &trend[(begin + q) * s.data.trends];
            const double own = s.parameters.scale * (amplitude.empty() ? 1 : amplitude[begin + q]);
            double prior = own * own;
            for (std::size_t j = 0; j < s.data.trends; ++j) {
                prior += s.data.trend_variance * h[j] * h[j];
            }
            result[begin + q] = prior;
            for (std::size_t i = 0; i < s.data.count(); ++i) {
                double value = own * s.parameters.scale * s.data.amplitude_of(i);
                for (std::size_t a = 0; a < s.data.axes; ++a) {
                    value *=
                        kernel_value(s.kernel, (at[a] - s.data.x[i * s.data.axes + a]) / s.parameters.length[a]).value;
                }
                for (std::size_t j = 0; j < s.data.trends; ++j) {
                    value += s.data.trend_variance * h[j] * s.data.trend[i * s.data.trends + j];
                }
                k(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(q)) = value;
            }
        }
        s.factor.matrixL().solveInPlace(k);
        for (std::size_t q = 0; q < size; ++q) {
            result[begin + q] = std::max(0.0, result[begin + q] - k.col(static_cast<Eigen::Index>(q)).squaredNorm());
        }
    }
    return result;
}

double GaussianProcess::variance(std::span<const double> x, std::span<const double> trend, double amplitude) const {
    return variances(x, trend, {&amplitude, 1}).front();
}

GaussianProcess::LeftOut GaussianProcess::leave_one_out() const {
    const State& s = *state_;
    const MatrixXd inverse = inverse_of(s.factor);
    LeftOut result;
    for (std::size_t i = 0; i < s.data.count(); ++i) {
        const auto at = static_cast<Eigen::Index>(i);
        const double variance = 1 / inverse(at, at);
        const double miss = s.weights[i] * variance;
        result.mean.push_back(s.data.y[i] - miss);
        result.variance.push_back(variance);
        result.log_density += -0.5 * (miss * miss / variance + std::log(2 * std::numbers::pi * variance));
    }
    return result;
}

}  // namespace underbody::tables
