// Is there structure in static residuals, and over which variables? Tested against resampled noise.
#pragma once

#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/flexible.h"
#include "surrogates/discovery/static/static_experiment.h"

namespace underbody::discovery {

/// Smooth functions of every varying channel, of every pair of them, and of one times a power of speed or voltage; for
/// each measured quantity its own.
class StaticStructure {
public:
    StaticStructure(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen);

    struct Test {
        std::vector<dynamics::Channel> variables;
        std::size_t quantity = 0;
        DesignMatrix basis;  ///< orthonormal
    };
    [[nodiscard]] const std::vector<Test>& tests() const { return tests_; }

    /// For each measured quantity the smooth correction of least Bayesian information criterion, those that are real
    /// together; p by chi-squared with Bonferroni.
    [[nodiscard]] SmoothFit best(const std::vector<double>& residuals) const;

private:
    struct OfQuantity {
        SmoothFit fit;
        const Test* test = nullptr;
    };
    [[nodiscard]] OfQuantity best_of(std::size_t quantity, const std::vector<double>& residuals) const;

    std::size_t quantities_ = 1;
    std::vector<Test> tests_;
};

/// Chance that noise like `noise_like` (whitened residuals of the best explanation, in the order of measurement) shows
/// as much structure as `residuals` of the model as declared. Blocks of noise are reordered and their signs drawn; the
/// statistic is the least tail probability over all smooth tests and all linearised effects (`directions`).
double simulated_gate(const StaticStructure& structure, const std::vector<DesignMatrix>& directions,
                      const std::vector<double>& residuals, const std::vector<double>& noise_like, std::uint64_t seed,
                      core::Progress& progress);

/// A table of corrections over the variables for one measured quantity, from unwhitened residuals by ridge regression.
dynamics::EffectUse smooth_correction(const StaticExperiment& experiment, const std::vector<std::size_t>& chosen,
                                      const std::vector<dynamics::Channel>& variables, std::size_t quantity,
                                      const std::vector<double>& residuals);

}  // namespace underbody::discovery
