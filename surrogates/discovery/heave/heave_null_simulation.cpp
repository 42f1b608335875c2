// Twins of the runs: the same rig with its controller in the loop, moved by a model in which nothing is missing.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "surrogates/discovery/heave/heave_controller.h"
#include "surrogates/discovery/heave/heave_error.h"
#include "surrogates/discovery/heave/heave_loop.h"
#include "surrogates/discovery/noise_chance.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

constexpr double track_rate = 3;  ///< 1/s, of a controller that keeps a twin on the measured track
constexpr double lost = 3;        ///< of the range of the gap: a twin so far from its record has left it

/// What feeds a twin's input: the rig's own controller, or one that keeps it on the smoothed track.
struct Loop {
    const ControllerAnswer* own = nullptr;
    const SmoothedRun* track = nullptr;
};

struct Twin {
    HeaveRecord record;
    bool stayed = true;  ///< near the record's own motion
};

/// `model` moves from the state at the beginning of the track, with fresh sensor noise and process noise; its readings
/// go back to the controller.
Twin simulate(const HeaveRecord& record, const HeaveExplanation& model, const SmoothedRun& track, const Loop& loop,
              const HeaveNoise& noise, core::Random& random) {
    Twin twin{record, true};
    std::vector<double> input, answered(record.time.size(), 0), apart(record.time.size(), 0);
    transform_input(record, model, input);
    const auto [low, high] = std::minmax_element(track.gap.begin(), track.gap.end());
    const double range = std::max(*high - *low, 20 * noise.gap);
    double h = track.gap.front();
    double w = track.velocity.front();
    double slow = noise.slow * random.normal();
    for (std::size_t k = 0; k < record.time.size(); ++k) {
        if (k > 0) {
            const double dt = record.time[k] - record.time[k - 1];
            if (loop.own != nullptr) {
                for (std::size_t i = 0; i < loop.own->input.size() && i < k; ++i) {
                    answered[k] += loop.own->input[i] * answered[k - 1 - i];
                }
                for (std::size_t i = 0; i < loop.own->reading.size() && i < k; ++i) {
                    answered[k] += loop.own->reading[i] * apart[k - 1 - i];
                }
            } else {
                answered[k] = model.terms.mass * track_rate *
                              (track_rate * (track.gap[k - 1] - h) + 2 * (track.velocity[k - 1] - w));
            }
            input[k] += answered[k];
            w += std::sqrt(noise.process * dt) * random.normal();
            step_once(record, model, input, k, h, w);
            const double phi = std::exp(-dt / noise.slow_time);
            slow = phi * slow + noise.slow * std::sqrt(1 - phi * phi) * random.normal();
        }
        if (!std::isfinite(h) || h < 0 || std::abs(h - track.gap[k]) > lost * range) {
            twin.stayed = false;
            return twin;
        }
        const double reading = h + model.terms.sensor_offset(record.time[k]) - model.terms.sensor_delay * w + slow +
                               noise.gap * record.gap_share[k] * random.normal();
        twin.record.gap[k] = std::isfinite(record.gap[k]) ? reading : std::nan("");
        apart[k] = std::isfinite(record.gap[k]) ? reading - record.gap[k] : 0;
        if (!record.velocity.empty() && std::isfinite(record.velocity[k])) {
            twin.record.velocity[k] = w + noise.velocity * record.velocity_share[k] * random.normal();
        }
    }
    // as a recorded input it is held from step to step, and stands for what the body felt
    twin.record.raw_time = record.time;
    twin.record.raw_input.assign(input.begin() + 1, input.end());
    twin.record.raw_input.push_back(input.back());
    prepare_input(twin.record);
    return twin;
}

/// The input of a twin is what the body felt: the effects between command and body are in it.
std::vector<dynamics::EffectUse> without_actuator(const std::vector<dynamics::EffectUse>& uses,
                                                  const dynamics::Model& model) {
    std::vector<dynamics::EffectUse> kept;
    for (const dynamics::EffectUse& use : uses) {
        dynamics::HeaveTerms terms;
        dynamics::effect(use.name).add_to(terms, use, model);
        if (terms.actuator.ideal()) {
            kept.push_back(use);
        }
    }
    return kept;
}

}  // namespace

HeaveRecords HeaveLoop::twins_of(const HeaveExperiment& experiment, const std::vector<dynamics::EffectUse>& uses,
                                 const HeaveNoise& noise, const HeaveNoise& drawn, std::uint64_t stream) const {
    const HeaveRecords& records = experiment.records();
    HeaveRecords twins;
    twins.velocity_measured = records.velocity_measured;
    twins.input_recorded = true;
    twins.gap_noise = records.gap_noise;
    twins.velocity_noise = records.velocity_noise;
    const ControllerAnswer own = fit_controller(records, experiment.chosen());
    core::Random random(options_.seed + 77, stream);
    for (const std::size_t r : experiment.chosen()) {
        const HeaveRecord& record = records.records[r];
        const HeaveExplanation model = experiment.explanation(r, uses);
        HeaveNoise calm = noise;
        calm.process = 1e-9;
        const SmoothedRun track = smooth_with_force(record, model, calm, usual_force_walk * model.terms.mass);
        Twin twin = simulate(record, model, track, {&own, nullptr}, drawn, random);
        if (!twin.stayed) {
            twin = simulate(record, model, track, {nullptr, &track}, drawn, random);
        }
        if (twin.stayed) {  // one that is lost would hold what its record misses
            twins.records.push_back(std::move(twin.record));
        }
    }
    return twins;
}

double HeaveLoop::twins_error(const HeaveExperiment& test, const std::vector<dynamics::EffectUse>& uses,
                              const HeaveNoise& noise) const {
    constexpr std::size_t twins = 4;
    HeaveNoise drawn = noise;
    drawn.process = 0;  // a random force on the body is no noise of a sensor: it is said
    if (const std::optional<double> declared = data_.declared_noise("gap")) {
        // what the model misses passes for coloured noise of any size: no figure is overruled by that
        const double most = calibration_.most_over_declared * *declared;
        drawn.slow = std::min(drawn.slow, std::sqrt(std::max(0.0, most * most - drawn.gap * drawn.gap)));
    }
    const std::vector<dynamics::EffectUse> felt = without_actuator(uses, model_);
    HeaveNoise own = noise;  // of the filter that serves the twins: a random force is none of theirs
    double square = 0;
    std::size_t judged = 0;
    for (std::size_t t = 0; t < twins; ++t) {
        const HeaveRecords records = twins_of(test, uses, noise, drawn, 1000 + t);
        if (records.records.empty()) {
            continue;
        }
        std::vector<std::size_t> all(records.records.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
        HeaveExperiment clean(model_, records, all, test.noise().gap, {});
        clean.set_noise(test.noise());
        if (++judged == 1) {
            clean.fit_process(felt, own);
        }
        square += std::pow(window_errors(clean, felt, own, options_.horizon).by_record(all.size()).rmse(), 2);
    }
    return judged > 0 ? std::sqrt(square / static_cast<double>(judged)) : std::hypot(drawn.gap, drawn.slow);
}

void HeaveLoop::run_placebo() {
    for (std::size_t t = 0; t < options_.placebo_twins; ++t) {
        const HeaveRecords records = twins_of(*experiment_, {}, after_noise_, after_noise_, t);
        if (records.records.empty()) {
            continue;
        }
        std::vector<std::size_t> all(records.records.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
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
        result_.placebo.alarms +=
            chance_in_noise(columns_of(list), innovations, observed, 100 + t) < calibration_.gate ? 1 : 0;
    }
}

}  // namespace underbody::discovery
