// Measured runs made ready for the filters; for .cpp files of this room only.
#pragma once

#include <string>
#include <vector>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/estimator/observe/estimate.h"

namespace underbody::estimator::internal {

void note(core::Problems& problems, const std::string& text);

/// Largest less smallest finite value; negative when there is none.
double range_of(const std::vector<double>& values);

/// A run, the plant at its conditions, and its signals.
struct Prepared {
    const dynamics::MeasuredRun* run;
    SeparatedPlant plant;
    RunSignals signals;
};
/// Throws core::InputError: static data, no runs.
std::vector<Prepared> prepare(const dynamics::Model& model, const dynamics::Measurements& data,
                              core::Problems& remarks);

struct NoiseChoice {
    FilterNoise noise;
    bool gap_declared = false, density_chosen = false;
};
/// Given, declared unless the readings contradict it (dynamics::judged_noise()), or estimated from them; the force
/// density the likeliest unless given.
NoiseChoice noise_for(const dynamics::Model& model, const dynamics::Measurements& data, const EstimateOptions& options,
                      const std::vector<Prepared>& runs, core::Problems& remarks);

}  // namespace underbody::estimator::internal
