// What the declared sensors can know along the gap, and whether the filter says so truly.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "core/table.h"
#include "surrogates/estimator/observe/extended_filter.h"

namespace underbody::estimator {

struct InformationOptions {
    FilterNoise noise;
    double sample_step = 0.02;   ///< s
    double window = 5;           ///< s of measurements before the moment that is asked about
    double drag_prior = 0.3;     ///< relative deviation of the drag law before the data
    std::vector<double> gaps;    ///< m; empty: 60 over the table
    std::vector<double> speeds;  ///< m/s, amplitude of the heave velocity; empty: 0 to 30 mm/s in 13
};

/// Bounds of Cramer and Rao for the unbiased estimation of the forces at the end of the window, with the motion
/// w(t) = speed cos(2 pi t/window) about the gap: standard deviations in N. The drag law's scale is an unknown with its
/// prior. Posterior form for the random departure (Tichavsky, Muravchik and Nehorai 1998).
struct InformationMap {
    std::vector<double> gaps, speeds;
    std::vector<double> ground_sigma, drag_sigma, total_sigma;  ///< [speed * gaps + gap]
    std::vector<double> ground_force;                           ///< per gap, N
    std::vector<double> drag_force;                             ///< per speed, N
    /// Blind: the bound is above the force itself (and above 1e-4 N).
    std::vector<bool> ground_blind;
    double blind_share = 0;

    [[nodiscard]] core::Figure figure() const;
    /// The bounds of the three forces along the gap beside the size of the ground force, at the speed of `speeds` that
    /// lies nearest.
    [[nodiscard]] core::Figure along_gap(double speed) const;
    /// One row a gap and speed: the forces, their bounds, blind or not.
    [[nodiscard]] core::Table table() const;
};
InformationMap information_along_gap(const SeparatedPlant& plant, const InformationOptions& options,
                                     core::Progress& progress = core::Progress::none());

/// Observability of the extended state (gap, velocity, departure) with the named sensors and of the two separate
/// forces, along the gap: singular values and what stays hidden.
struct ObservabilityAlongGap {
    std::vector<double> gaps;
    std::vector<double>
        smallest_singular_value;             ///< of the balanced observability matrix of (gap, velocity, departure)
    std::vector<std::size_t> separate_rank;  ///< of the frozen pair (F_g, F_d): 1 of 2 everywhere
};
ObservabilityAlongGap observability_along_gap(const SeparatedPlant& plant, const std::vector<double>& gaps);

/// Normalised estimation error squared (NEES) of the extended filter on simulated runs that obey its own assumptions,
/// while a hand moves the body about the gap with a heave velocity of the given amplitude: 3 on average for a filter
/// that states its covariance truly.
struct ConsistencyOptions {
    FilterNoise noise;
    std::vector<double> gaps;                 ///< m; empty: 8 over the table
    std::vector<double> speeds{0, .01, .03};  ///< m/s
    std::size_t runs = 60;                    ///< per gap and speed
    double duration = 5, step = 0.02;         ///< s
    std::uint64_t seed = 1;
};
struct Consistency {
    std::vector<double> gaps, speeds;
    std::vector<double> nees;     ///< [speed * gaps + gap]: mean over the runs at their end
    double lower = 0, upper = 0;  ///< 95 % band of such a mean
    std::vector<double>
        coverage;  ///< likewise: share of runs whose ground force lay within 1.96 of its stated deviations
    std::vector<double> innovation;  ///< likewise: mean squared normalised innovation
    std::size_t runs = 0;
    double inside = 0;  ///< share of means within the band
    [[nodiscard]] core::Figure figure() const;
};
Consistency consistency_along_gap(const SeparatedPlant& plant, const ConsistencyOptions& options,
                                  core::Progress& progress = core::Progress::none());

void to_json(nlohmann::json& json, const InformationMap& map);
void to_json(nlohmann::json& json, const Consistency& consistency);
void to_json(nlohmann::json& json, const ObservabilityAlongGap& observability);

}  // namespace underbody::estimator
