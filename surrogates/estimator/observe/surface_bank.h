// Which surface is under the vehicle: a bank of filters, one per surface, weighed by their innovations (thesis figure
// 7-2).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/figure.h"
#include "surrogates/estimator/observe/extended_filter.h"

namespace underbody::dynamics {
struct Model;
struct Measurements;
}  // namespace underbody::dynamics

namespace underbody::estimator {

/// A surface under the vehicle: its plant.
struct Surface {
    std::string name;
    SeparatedPlant plant;
};

struct SurfaceOptions {
    FilterNoise noise;
    /// N^2/s: how fast the force may depart from a surface's table; each is as likely as the next beforehand, and the
    /// data weigh them together with the surfaces. Empty: noise.force_density alone.
    std::vector<double> densities;
    double switching = 0;       ///< chance per second that the surface changes; 0: one surface for the whole run
    std::vector<double> prior;  ///< per surface; empty: all alike
};

/// Probability of each surface by Bayes' rule over the bank. It is calibrated when one of the surfaces is the true one
/// and the noise is what the options say: of all runs given 0.8, eight in ten are that surface.
struct SurfaceProbability {
    std::vector<std::string> names;
    std::vector<double> time;
    std::vector<std::vector<double>> probability;  ///< [surface][sample]
    std::size_t best = 0;
    double force_density = 0;  ///< N^2/s, the likeliest with the best surface
    double mean_squared_innovation =
        0;  ///< of that member of the bank: about 1 when the surface fits, more when none does
};
/// Throws core::InputError: fewer than two surfaces, a prior of another length, a run that check_run refuses.
SurfaceProbability identify_surface(const std::vector<Surface>& surfaces, const RunSignals& run,
                                    const SurfaceOptions& options);

/// The bank over measured runs, each surface a declared model at the run's own conditions.
struct SurfaceReport {
    std::vector<std::string> runs;
    std::vector<SurfaceProbability> of_run;
    [[nodiscard]] std::string text() const;     ///< one line a run
    [[nodiscard]] core::Figure figure() const;  ///< probabilities over the runs, one after another
};
/// `noise`: of the sensors; the densities of the force are weighed by the data (usual_densities).
SurfaceReport identify_surfaces(const std::vector<std::pair<std::string, dynamics::Model>>& surfaces,
                                const dynamics::Measurements& data, const FilterNoise& noise, double switching = 0);
void to_json(nlohmann::json& json, const SurfaceReport& report);

/// Densities from next to none to one that follows anything, for noise in a table of this largest force, N.
std::vector<double> usual_densities(double largest_force);

}  // namespace underbody::estimator
