#include "surrogates/tables/fit/gaussian_process.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "surrogates/tables/fit/gaussian_process_state.h"

namespace underbody::tables {

using Eigen::ArrayXd;
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

/// Correlation along one axis at these distances: a factor, and what is to be added to the exponent, so that one
/// exponential is enough for all axes.
template <class Distances, class Factor, class Exponent>
void times_correlation(Kernel kernel, double length, const Distances& distance, Factor&& factor, Exponent& exponent) {
    if (kernel == Kernel::squared_exponential) {
        exponent += (distance * (1 / length)).square() * 0.5;
        return;
    }
    const double rate = std::sqrt(5.0) / length;
    factor *= 1 + rate * distance + (rate * distance).square() * (1.0 / 3);
    exponent += rate * distance;
}

/// Correlations of all pairs of the data, by column j the rows i > j. Everything that the parameters do not change is
/// kept from one evaluation of the likelihood to the next.
class Pairs {
public:
    explicit Pairs(const GpData& data) : n_(static_cast<Eigen::Index>(data.count())), distance_(data.axes) {
        const Eigen::Index pairs = n_ * (n_ - 1) / 2;
        for (auto& d : distance_) {
            d.resize(pairs);
        }
        Eigen::Index at = 0;
        for (Eigen::Index j = 0; j < n_; ++j) {
            for (Eigen::Index i = j + 1; i < n_; ++i, ++at) {
                for (std::size_t a = 0; a < data.axes; ++a) {
                    distance_[a](at) = std::abs(data.x[i * data.axes + a] - data.x[j * data.axes + a]);
                }
            }
        }
        if (!data.amplitude.empty()) {
            amplitude_ = Eigen::Map<const ArrayXd>(data.amplitude.data(), n_);
        }
        const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> h(
            data.trend.data(), n_, static_cast<Eigen::Index>(data.trends));
        base_.noalias() = data.trend_variance * h * h.transpose();
        base_.diagonal() += Eigen::Map<const VectorXd>(data.noise.data(), n_);
    }

    /// Covariance of the process alone into the lower triangle.
    void covariance(Kernel kernel, const GpParameters& p, MatrixXd& k) {
        if (k.rows() != n_) {
            k.setZero(n_, n_);
        }
        const double variance = p.scale * p.scale;
        Eigen::Index at = 0;
        for (Eigen::Index j = 0; j < n_; ++j) {
            const Eigen::Index rows = n_ - 1 - j;
            const double own = variance * (amplitude_.size() > 0 ? amplitude_(j) : 1);
            k(j, j) = own * (amplitude_.size() > 0 ? amplitude_(j) : 1);
            auto column = k.col(j).tail(rows).array();
            sum_.setZero(rows);
            column.setConstant(own);
            for (std::size_t a = 0; a < distance_.size(); ++a) {
                times_correlation(kernel, p.length[a], distance_[a].segment(at, rows), column, sum_);
            }
            column *= (-sum_).exp();
            if (amplitude_.size() > 0) {
                column *= amplitude_.tail(rows);
            }
            at += rows;
        }
    }

    /// Sums over all pairs of weight times d log k / d log length, for every axis; `weights` in the lower triangle.
    void add_length_rates(Kernel kernel, const GpParameters& p, const MatrixXd& weights, double* sums) {
        Eigen::Index at = 0;
        for (Eigen::Index j = 0; j < n_; ++j) {
            const Eigen::Index rows = n_ - 1 - j;
            const auto weight = weights.col(j).tail(rows).array();
            for (std::size_t a = 0; a < distance_.size(); ++a) {
                const auto d = distance_[a].segment(at, rows);
                if (kernel == Kernel::squared_exponential) {
                    sums[a] += (weight * (d * (1 / p.length[a])).square()).sum();
                } else {
                    s_ = d * (std::sqrt(5.0) / p.length[a]);
                    sums[a] += (weight * s_.square() * (1 + s_) / (3 + 3 * s_ + s_.square())).sum();
                }
            }
            at += rows;
        }
    }

    /// What trend and known noise add; the lower triangle counts.
    [[nodiscard]] const MatrixXd& base() const { return base_; }

private:
    Eigen::Index n_;
    std::vector<ArrayXd> distance_;  ///< [axis](pair)
    ArrayXd amplitude_;              ///< empty: 1
    MatrixXd base_;
    ArrayXd sum_, s_;
};

/// Of the covariance (its lower triangle), with a jitter that grows until it works.
void factorise(MatrixXd& k, Eigen::LLT<MatrixXd>& factor) {
    double jitter = 0;
    for (int attempt = 0; attempt < 8; ++attempt) {
        factor.compute(k);
        if (factor.info() == Eigen::Success) {
            return;
        }
        const double next = jitter == 0 ? 1e-12 * k.diagonal().maxCoeff() : 10 * jitter;
        k.diagonal().array() += next - jitter;
        jitter = next;
    }
    factor.compute(MatrixXd(k.diagonal().asDiagonal()));
}

/// Lower triangle of the inverse of a factorised matrix.
void invert(const Eigen::LLT<MatrixXd>& factor, MatrixXd& lower, MatrixXd& inverse) {
    const Eigen::Index n = factor.rows();
    lower.setIdentity(n, n);
    inverse.setZero(n, n);
    if (n > 100) {
        factor.matrixL().solveInPlace(lower);
        inverse.selfadjointView<Eigen::Lower>().rankUpdate(lower.transpose());
        return;
    }
    // Of few points the zeros above the diagonal are worth leaving out.
    const MatrixXd& l = factor.matrixLLT();
    for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index k = j; k < n; ++k) {
            const double x = lower(k, j) / l(k, k);
            lower(k, j) = x;
            lower.col(j).tail(n - 1 - k) -= x * l.col(k).tail(n - 1 - k);
        }
    }
    for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index i = j; i < n; ++i) {
            inverse(i, j) = lower.col(i).tail(n - i).dot(lower.col(j).tail(n - i));
        }
    }
}

MatrixXd inverse_of(const Eigen::LLT<MatrixXd>& factor) {
    MatrixXd lower, inverse;
    invert(factor, lower, inverse);
    return inverse;
}

double log_determinant(const Eigen::LLT<MatrixXd>& factor) {
    double sum = 0;
    for (Eigen::Index i = 0; i < factor.rows(); ++i) {
        sum += 2 * std::log(factor.matrixLLT()(i, i));
    }
    return sum;
}

/// Log marginal likelihood of the data as a function of the parameters, with buffers that are used again.
class Likelihood {
public:
    Likelihood(const GpData& data, Kernel kernel) : data_(data), kernel_(kernel), pairs_(data) {}

    double value(const GpParameters& p) {
        const auto n = static_cast<Eigen::Index>(data_.count());
        const Eigen::Map<const VectorXd> y(data_.y.data(), n);
        pairs_.covariance(kernel_, p, process_);
        whole_ = process_ + pairs_.base();
        whole_.diagonal().array() += p.scatter * p.scatter;
        factorise(whole_, factor_);
        alpha_ = factor_.solve(y);
        return -0.5 *
               (alpha_.dot(y) + log_determinant(factor_) + static_cast<double>(n) * std::log(2 * std::numbers::pi));
    }
    /// By log length..., log scale, log scatter, at the parameters of the last value().
    void gradient(const GpParameters& p, std::vector<double>& g) {
        const auto n = static_cast<Eigen::Index>(data_.count());
        invert(factor_, lower_, inverse_);
        g.assign(data_.axes + 2, 0.0);
        for (Eigen::Index j = 0; j < n; ++j) {
            const double own = alpha_(j) * alpha_(j) - inverse_(j, j);
            g[data_.axes] += own * process_(j, j);
            g[data_.axes + 1] += own * p.scatter * p.scatter;
            auto weight = inverse_.col(j).tail(n - 1 - j).array();
            weight = (alpha_(j) * alpha_.tail(n - 1 - j).array() - weight) * process_.col(j).tail(n - 1 - j).array();
            g[data_.axes] += 2 * weight.sum();
        }
        pairs_.add_length_rates(kernel_, p, inverse_, g.data());
    }
    [[nodiscard]] const Eigen::LLT<MatrixXd>& factor() const { return factor_; }
    [[nodiscard]] const VectorXd& weights() const { return alpha_; }

private:
    const GpData& data_;
    Kernel kernel_;
    Pairs pairs_;
    MatrixXd process_, whole_, lower_, inverse_;
    VectorXd alpha_;
    Eigen::LLT<MatrixXd> factor_;
};

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

/// Adds the log of the priors of fit() to value and gradient (may be null), up to a constant.
double with_priors(double value, const GpOptions& options, const GpParameters& p, std::vector<double>* gradient) {
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

/// Negative log posterior of the logs of the parameters.
class Objective {
public:
    Objective(const GpData& data, const GpOptions& options) : likelihood_(data, options.kernel), options_(options) {}

    double value(const std::vector<double>& v) {
        at_ = from_logs(v);
        return -with_priors(likelihood_.value(at_), options_, at_, nullptr);
    }
    /// At the place of the last value().
    void gradient(std::vector<double>& gradient) {
        likelihood_.gradient(at_, gradient);
        with_priors(0, options_, at_, &gradient);
        for (double& g : gradient) {
            g = -g;
        }
    }

private:
    Likelihood likelihood_;
    const GpOptions& options_;
    GpParameters at_;
};

struct Optimum {
    std::vector<double> at;
    double value = 0;
};

/// The inverse Hessian after a step s that changed the gradient by y.
void update(MatrixXd& inverse, const std::vector<double>& v, const std::vector<double>& next,
            const std::vector<double>& g, const std::vector<double>& g_next) {
    const auto n = static_cast<Eigen::Index>(v.size());
    VectorXd s(n), y(n);
    for (Eigen::Index j = 0; j < n; ++j) {
        s(j) = next[j] - v[j];
        y(j) = g_next[j] - g[j];
    }
    if (const double sy = s.dot(y); sy > 1e-12) {
        const MatrixXd left = MatrixXd::Identity(n, n) - s * y.transpose() / sy;
        inverse = left * inverse * left.transpose() + s * s.transpose() / sy;
    }
}

/// BFGS with backtracking; a handful of unknowns, each evaluation expensive.
Optimum minimise(Objective& f, std::vector<double> v, int evaluations, core::Progress& progress) {
    const auto n = static_cast<Eigen::Index>(v.size());
    std::vector<double> g(v.size()), g_next(v.size()), next(v.size());
    double value = f.value(v);
    f.gradient(g);
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
            next_value = f.value(next);
            --evaluations;
            if (next_value < value + 1e-4 * share * step.dot(gradient)) {
                f.gradient(g_next);
                found = true;
                break;
            }
        }
        if (!found) {
            break;
        }
        update(inverse, v, next, g, g_next);
        const double gain = value - next_value;
        v = next;
        g = g_next;
        value = next_value;
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
    Likelihood likelihood(d, kernel);
    state->log_likelihood = likelihood.value(state->parameters);
    state->factor = likelihood.factor();
    const VectorXd& alpha = likelihood.weights();
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
    Objective objective(data, options);
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
double GaussianProcess::log_likelihood() const { return state_->log_likelihood; }

double GaussianProcess::log_likelihood(const GpData& data, Kernel kernel, const GpParameters& p,
                                       std::vector<double>* gradient) {
    Likelihood likelihood(data, kernel);
    const double value = likelihood.value(p);
    if (gradient != nullptr) {
        likelihood.gradient(p, *gradient);
    }
    return value;
}

double GaussianProcess::log_posterior(const GpData& data, const GpOptions& options, const GpParameters& p,
                                      std::vector<double>* gradient) {
    return with_priors(log_likelihood(data, options.kernel, p, gradient), options, p, gradient);
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
    const std::size_t axes = s.data.axes;
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> trends(
        s.data.trend.data(), n, static_cast<Eigen::Index>(s.data.trends));
    ArrayXd distance(n), exponent(n);
    MatrixXd k;
    for (std::size_t begin = 0; begin < count; begin += block) {
        const std::size_t size = std::min(block, count - begin);
        k.resize(n, static_cast<Eigen::Index>(size));
        for (std::size_t q = 0; q < size; ++q) {
            const double* at = &x[(begin + q) * axes];
            const Eigen::Map<const VectorXd> h(&trend[(begin + q) * s.data.trends],
                                               static_cast<Eigen::Index>(s.data.trends));
            const double own = s.parameters.scale * (amplitude.empty() ? 1 : amplitude[begin + q]);
            result[begin + q] = own * own + s.data.trend_variance * h.squaredNorm();
            auto column = k.col(static_cast<Eigen::Index>(q)).array();
            column.setConstant(own * s.parameters.scale);
            exponent.setZero();
            for (std::size_t a = 0; a < axes; ++a) {
                distance = (s.x.col(static_cast<Eigen::Index>(a)) - at[a]).abs();
                times_correlation(s.kernel, s.parameters.length[a], distance, column, exponent);
            }
            column *= (-exponent).exp();
            if (!s.data.amplitude.empty()) {
                column *= Eigen::Map<const ArrayXd>(s.data.amplitude.data(), n);
            }
            column += s.data.trend_variance * (trends * h).array();
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
