// The Gaussian process against OpenTURNS: same kernel, same parameters, same points.
#include <gtest/gtest.h>

#include <cmath>
#include <openturns/ConstantBasisFactory.hxx>
#include <openturns/KrigingAlgorithm.hxx>
#include <openturns/MaternModel.hxx>
#include <openturns/ResourceMap.hxx>
#include <openturns/SquaredExponential.hxx>

#include "core/random.h"
#include "surrogates/tables/fit/gaussian_process.h"

namespace underbody {
namespace {

using tables::GaussianProcess;
using tables::GpData;
using tables::GpParameters;
using tables::Kernel;

struct Both {
    GpData data;
    OT::Sample x, y;
    OT::Point noise;

    Both(unsigned count, unsigned axes) : x(count, axes), y(count, 1), noise(count) {
        core::Random random(77);
        data.axes = axes;
        data.trends = 1;
        data.trend_variance = 1e6;  // theirs is a constant without a prior; more would cost digits
        for (unsigned i = 0; i < count; ++i) {
            double sum = 0;
            for (unsigned k = 0; k < axes; ++k) {
                x(i, k) = random.uniform();
                data.x.push_back(x(i, k));
                sum += std::sin(4 * x(i, k) + k);
            }
            noise[i] = random.uniform(0.001, 0.01);
            y(i, 0) = sum + random.normal(0, std::sqrt(noise[i]));
            data.y.push_back(y(i, 0));
            data.noise.push_back(noise[i]);
            data.trend.push_back(1);
        }
    }
};

OT::KrigingAlgorithm algorithm(const Both& both, const OT::CovarianceModel& kernel) {
    OT::KrigingAlgorithm kriging(both.x, both.y, kernel, OT::ConstantBasisFactory(kernel.getInputDimension()).build());
    kriging.setNoise(both.noise);
    kriging.setOptimizeParameters(false);
    return kriging;
}

void expect_the_same(const Both& both, const OT::CovarianceModel& kernel, const GaussianProcess& ours) {
    auto kriging = algorithm(both, kernel);
    kriging.run();
    const auto result = kriging.getResult();
    core::Random random(5);
    const double one = 1;
    for (int i = 0; i < 40; ++i) {
        OT::Point at(kernel.getInputDimension());
        for (unsigned k = 0; k < at.getSize(); ++k) {
            at[k] = random.uniform(-0.1, 1.1);
        }
        const std::vector<double> x(at.begin(), at.end());
        const double mean = result.getConditionalMean(at)[0];
        const double variance = result.getConditionalMarginalVariance(at);
        EXPECT_NEAR(ours.mean(x, {&one, 1}), mean, 1e-5 * (1 + std::abs(mean)));
        EXPECT_NEAR(ours.variance(x, {&one, 1}), variance, 1e-5 * (1 + variance));
    }
}

TEST(OpenTurns, HasTheSameMeanAndVarianceByMatern) {
    const Both both(25, 1);
    const OT::MaternModel kernel(OT::Point(1, 0.4), OT::Point(1, 1.3), 2.5);
    expect_the_same(both, kernel, GaussianProcess(both.data, Kernel::matern52, GpParameters{{0.4}, 1.3, 1e-9}));
}

TEST(OpenTurns, HasTheSameMeanAndVarianceBySquaredExponentialOnThreeAxes) {
    const Both both(60, 3);
    OT::Point lengths(3);
    lengths[0] = 0.5;
    lengths[1] = 0.9;
    lengths[2] = 1.4;
    const OT::SquaredExponential kernel(lengths, OT::Point(1, 1.1));
    expect_the_same(both, kernel,
                    GaussianProcess(both.data, Kernel::squared_exponential, GpParameters{{0.5, 0.9, 1.4}, 1.1, 1e-9}));
}

TEST(OpenTurns, HasTheSameRatiosOfLikelihood) {
    OT::ResourceMap::SetAsBool("GeneralLinearModelAlgorithm-UseAnalyticalAmplitudeEstimate", false);
    Both both(25, 1);
    const OT::MaternModel kernel(OT::Point(1, 0.4), OT::Point(1, 1.3), 2.5);
    auto kriging = algorithm(both, kernel);
    kriging.setOptimizeParameters(true);
    const auto theirs = kriging.getReducedLogLikelihoodFunction();
    const auto at = [&](double length, double scale) {
        OT::Point p(theirs.getInputDimension());
        p[0] = length;
        if (p.getSize() > 1) {
            p[1] = scale;
        }
        return theirs(p)[0];
    };
    if (theirs.getInputDimension() != 2) {
        GTEST_SKIP() << "skipped: this OpenTURNS takes the scale out of its likelihood";
    }
    // They maximise over the constant, we integrate over it: the ratios differ by the determinant of its variance only.
    const auto ours = [&](double length, double scale) {
        const GpParameters p{{length}, scale, 1e-9};
        const GaussianProcess process(both.data, Kernel::matern52, p);
        const double one = 1;
        const std::vector<double> far{1e9};
        const double of_constant = process.variance(far, {&one, 1}) - scale * scale;
        return process.log_likelihood() - 0.5 * std::log(of_constant);
    };
    for (const double length : {0.2, 0.6, 1.5}) {
        for (const double scale : {0.7, 2.0}) {
            EXPECT_NEAR(ours(length, scale) - ours(0.4, 1.3), at(length, scale) - at(0.4, 1.3), 1e-4)
                << length << " " << scale;
        }
    }
}

}  // namespace
}  // namespace underbody
