// Clean twins of the runs: the same motion by the declared model alone, to see how often this procedure finds what is
// not there.
#include <algorithm>
#include <cmath>

#include "surrogates/discovery/heave/heave_loop.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

constexpr double track_rate = 3;  ///< 1/s, of the controller that keeps a twin on the measured track

/// The declared model on the smoothed track of a record, with the input that this takes and fresh sensor noise.
HeaveRecord twin_of(const HeaveRecord& record, const HeaveExplanation& best, const HeaveExplanation& declared,
                    const HeaveNoise& noise, core::Random& random) {
    HeaveNoise calm = noise;
    calm.process = 1e-9;
    const SmoothedRun track = smooth_with_force(record, best, calm, 0.001 * best.terms.mass);
    const double mass = declared.terms.mass;
    HeaveRecord twin = record;
    std::vector<double> input;
    transform_input(record, declared, input);
    double h = track.gap.front();
    double w = track.velocity.front();
    double slow = noise.slow * random.normal();
    const std::size_t n = record.time.size();
    for (std::size_t k = 0; k < n; ++k) {
        if (k > 0) {
            input[k] += mass * track_rate * (track_rate * (track.gap[k - 1] - h) + 2 * (track.velocity[k - 1] - w));
            step_once(record, declared, input, k, h, w);
            const double phi = std::exp(-(record.time[k] - record.time[k - 1]) / noise.slow_time);
            slow = phi * slow + noise.slow * std::sqrt(1 - phi * phi) * random.normal();
        }
        twin.gap[k] =
            std::isfinite(record.gap[k]) ? h + slow + noise.gap * record.gap_share[k] * random.normal() : std::nan("");
        if (!record.velocity.empty() && std::isfinite(record.velocity[k])) {
            twin.velocity[k] = w + noise.velocity * record.velocity_share[k] * random.normal();
        }
    }
    // as a recorded input it is held from step to step
    twin.raw_time = record.time;
    twin.raw_input.assign(input.begin() + 1, input.end());
    twin.raw_input.push_back(input.back());
    prepare_input(twin);
    return twin;
}

}  // namespace

void HeaveLoop::run_placebo() {
    for (std::size_t t = 0; t < options_.placebo_twins; ++t) {
        HeaveRecords records;
        records.velocity_measured = records_.velocity_measured;
        records.input_recorded = true;
        core::Random random(options_.seed + 77, t);
        for (const std::size_t r : train_) {
            records.records.push_back(twin_of(records_.records[r], experiment_->explanation(r, uses_),
                                              experiment_->explanation(r, {}), after_noise_, random));
        }
        std::vector<std::size_t> all(records.records.size());
        for (std::size_t k = 0; k < all.size(); ++k) {
            all[k] = k;
        }
        HeaveExperiment clean(model_, records, all, {}, {});
        HeaveNoise noise = after_noise_;
        clean.fit_process({}, noise);
        std::vector<double> innovations;
        clean.evaluate({}, nullptr, noise, innovations);
        const std::vector<Probe> list = probes(clean, {}, noise, {}, true);
        double observed = 0;
        for (const Probe& probe : list) {
            observed = std::max(observed, probe.surprise);
        }
        ++result_.placebo.twins;
        result_.placebo.alarms += chance_in_noise(list, innovations, observed, 100 + t) < calibration_.gate ? 1 : 0;
    }
}

}  // namespace underbody::discovery
