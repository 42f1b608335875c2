// Gaussian-process regression with point noise, a separable kernel with one length per axis, and a linear trend.
//
// Rasmussen and Williams 2006, ch. 2 and 5 (likelihood and its gradient), Dubrule 1983 (leave-one-out in closed form).
// The trend's coefficients have a wide normal prior and are part of the covariance, so every formula is that of a
// zero-mean process.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/progress.h"

namespace underbody::tables {

enum class Kernel {
    matern52,            ///< twice differentiable
    squared_exponential  ///< infinitely smooth
};

/// Correlation of one axis at a distance of `a` lengths, and its first two derivatives by the distance in lengths.
struct KernelValue {
    double value = 1;
    double slope = 0;  ///< d value / d a, a signed
};
KernelValue kernel_value(Kernel kernel, double a);

struct GpData {
    std::size_t axes = 1;
    std::vector<double> x;      ///< [point * axes + axis], in coordinates of about unit range
    std::vector<double> y;      ///< about unit size
    std::vector<double> noise;  ///< known variance of each point
    std::size_t trends = 1;
    std::vector<double> trend;  ///< [point * trends + j], each of about unit size; the first is 1
    double trend_variance = 100;
    std::vector<double> amplitude;  ///< [point] the process is that many times larger there; empty: 1

    [[nodiscard]] double amplitude_of(std::size_t i) const { return amplitude.empty() ? 1 : amplitude[i]; }

    [[nodiscard]] std::size_t count() const { return y.size(); }
};

struct GpParameters {
    std::vector<double> length;  ///< one an axis
    double scale = 1;            ///< standard deviation of the process
    double scatter = 1e-3;       ///< standard deviation of what neither the process nor the stated noise explains
};

/// Parameters and their weight among others.
struct GpWeighted {
    GpParameters parameters;
    double weight = 1;
};

struct GpOptions {
    Kernel kernel = Kernel::matern52;
    int iterations = 60;               ///< evaluations of the likelihood a start
    double expected_scatter = 1e-2;    ///< middle of its prior
    std::vector<GpParameters> starts;  ///< empty: two standard ones
};

/// Mean and variance of the force at a point, and their derivatives by each coordinate where asked for.
struct GpPrediction {
    double mean = 0;
    double variance = 0;
    std::vector<double> mean_slope;
    std::vector<double> variance_slope;
};

/// Means of many points, and their slopes [point * axes + axis] where asked for.
struct GpMeans {
    std::vector<double> mean;
    std::vector<double> slope;
};

/// A fitted process. Immutable.
class GaussianProcess {
public:
    /// Maximises the marginal likelihood times weak log-normal priors (they matter for a handful of points only).
    static GaussianProcess fit(GpData data, const GpOptions& options,
                               core::Progress& progress = core::Progress::none());
    /// With given parameters.
    GaussianProcess(GpData data, Kernel kernel, GpParameters parameters);

    [[nodiscard]] const GpData& data() const;
    [[nodiscard]] Kernel kernel() const;
    [[nodiscard]] const GpParameters& parameters() const;
    /// Log marginal likelihood, without the priors; and its gradient by log length..., log scale, log scatter.
    [[nodiscard]] double log_likelihood() const;
    static double log_likelihood(const GpData& data, Kernel kernel, const GpParameters& parameters,
                                 std::vector<double>* gradient);

    /// The same with the priors of fit(), up to a constant: what fit() maximises.
    static double log_posterior(const GpData& data, const GpOptions& options, const GpParameters& parameters,
                                std::vector<double>* gradient);
    /// Points and weights (sum 1) that stand for the posterior of lengths and scale around its maximum `best`, which
    /// comes first; the scatter stays.
    static std::vector<GpWeighted> posterior_design(const GpData& data, const GpOptions& options,
                                                    const GpParameters& best);

    /// Standard deviation of the logarithm of the scatter about its most likely value `best`, from the curvature of the
    /// posterior there: about 2 (that of its prior) where the data do not tell it.
    static double scatter_uncertainty(const GpData& data, const GpOptions& options, const GpParameters& best);

    /// Mean of the force at a point with the trend functions and the amplitude there.
    [[nodiscard]] double mean(std::span<const double> x, std::span<const double> trend, double amplitude = 1) const;
    /// Variance of the force itself (scatter and noise not included).
    [[nodiscard]] double variance(std::span<const double> x, std::span<const double> trend, double amplitude = 1) const;
    /// Variances of many points: x [point * axes], trend [point * trends], amplitude [point] (empty: 1).
    [[nodiscard]] std::vector<double> variances(std::span<const double> x, std::span<const double> trend,
                                                std::span<const double> amplitude = {}) const;

    /// mean() and variance() at once, for processes of amplitude 1 everywhere. With `trend_slope` [trend * axes +
    /// axis], the derivatives of the trend functions by the coordinates, the slopes too.
    [[nodiscard]] GpPrediction predict(std::span<const double> x, std::span<const double> trend,
                                       std::span<const double> trend_slope = {}) const;
    /// The means of predict() alone, of several points at once: x [point * axes], trend [point * trends], trend_slope
    /// [(point * trends + trend) * axes + axis] or empty. Without variances, and coordinates that all points share are
    /// taken once: a curve costs little more than a point.
    [[nodiscard]] GpMeans means(std::span<const double> x, std::span<const double> trend,
                                std::span<const double> trend_slope = {}) const;
    /// Covariance of the force at several points, for processes of amplitude 1: x [point * axes], trend [point *
    /// trends]; the result [i * points + j].
    [[nodiscard]] std::vector<double> covariance(std::span<const double> x, std::span<const double> trend) const;

    struct LeftOut {
        std::vector<double> mean;      ///< of each point from all others
        std::vector<double> variance;  ///< of the measured value: force, scatter and noise
        double log_density = 0;        ///< sum of the log densities of the measured values
    };
    [[nodiscard]] LeftOut leave_one_out() const;

    /// (covariance of the data)^-1 times a vector over the data.
    [[nodiscard]] std::vector<double> solved(std::vector<double> values) const;

    /// Weights of the data in the mean, and the coefficients of the trend.
    [[nodiscard]] const std::vector<double>& weights() const;
    [[nodiscard]] const std::vector<double>& coefficients() const;

private:
    struct State;
    explicit GaussianProcess(std::shared_ptr<const State> state);
    std::shared_ptr<const State> state_;
};

}  // namespace underbody::tables
