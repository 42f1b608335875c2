// What a further run is worth: expected improvement and the chance that limits hold, as logarithms, so that a search
// still has a slope where both are tiny.
#pragma once

namespace underbody::tables {

/// log E max(best - f, 0) for f ~ N(mean, sigma^2): Jones, Schonlau and Welch 1998, computed as Ament et al. 2023, with
/// the derivatives by mean and by sigma. sigma = 0: log of the improvement itself (-infinity when there is none).
struct LogImprovement {
    double value = 0;
    double by_mean = 0;
    double by_sigma = 0;
};
LogImprovement log_expected_improvement(double mean, double sigma, double best);

/// log P(f <= limit) for f ~ N(mean, sigma^2), with derivatives.
struct LogChance {
    double value = 0;
    double by_mean = 0;
    double by_sigma = 0;
};
LogChance log_chance_below(double mean, double sigma, double limit);

}  // namespace underbody::tables
