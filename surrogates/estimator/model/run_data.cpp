#include "surrogates/estimator/model/run_data.h"

#include <algorithm>
#include <cmath>

#include "core/counted.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/estimator/observe/prepared_runs.h"

namespace underbody::estimator {

using internal::note;
using internal::Prepared;

RunSplit split_runs(const dynamics::Measurements& data, bool hold_out) {
    RunSplit split{data, data, ""};
    split.train.runs.clear();
    split.test.runs.clear();
    const bool marked =
        std::any_of(data.runs.begin(), data.runs.end(), [](const auto& r) { return r.use == dynamics::RunUse::test; });
    for (std::size_t i = 0; i < data.runs.size(); ++i) {
        const bool test = marked ? data.runs[i].use == dynamics::RunUse::test
                                 : hold_out && data.runs.size() > 1 &&
                                       (i % 4 == 3 || (data.runs.size() < 4 && i + 1 == data.runs.size()));
        (test ? split.test : split.train).runs.push_back(data.runs[i]);
    }
    if (split.train.runs.empty()) {
        throw core::InputError("empty", "every run is marked for tests: there is none to learn from",
                               {data.folder.string(), {}, {}, {}});
    }
    if (split.test.runs.empty()) {
        split.how = core::counted(split.train.runs.size(), "run") + " to learn from";
        if (hold_out) {
            split.test = split.train;
            split.how = "one run to learn from and to test on: its errors are too good";
        }
        return split;
    }
    split.how = core::counted(split.train.runs.size(), "run") + " to learn from, " +
                std::to_string(split.test.runs.size()) + " to test on, " +
                (marked ? "as the data set says" : "by the program's choice");
    return split;
}

namespace {

struct Smoothed {
    Prepared prepared;
    FilterResult result;
    double step = 0;  ///< s, usual
};

std::vector<Smoothed> smooth_runs(const dynamics::Model& model, const dynamics::Measurements& data,
                                  const EstimateOptions& options, core::Problems& remarks, core::Progress& progress) {
    std::vector<Prepared> runs = internal::prepare(model, data, remarks);
    const FilterNoise noise = internal::noise_for(model, data, options, runs, remarks).noise;
    std::vector<Smoothed> all;
    for (auto& run : runs) {
        progress.check();
        FilterResult result = extended_filter(run.plant, run.signals, noise, true);
        if (result.outliers > 0) {
            note(remarks, "run '" + run.run->name + "': " +
                              core::counted(result.outliers, "outlier of the gap was", "outliers of the gap were") +
                              " left out");
        }
        const double step = usual_step(run.signals);
        all.push_back({std::move(run), std::move(result), step});
    }
    return all;
}

// The plant whose table carries the departure of a moment.
SeparatedPlant departed(const SeparatedPlant& plant, const double& departure) {
    SeparatedPlant p = plant;
    p.ground_force = [f = plant.ground_force, &departure](double h, double& slope) { return f(h, slope) + departure; };
    return p;
}

double input_at(const RunSignals& s, std::size_t k) { return s.input.empty() ? 0 : s.input[k]; }

// Motion of a run between two samples, on a uniform step.
TestMotion motion_between(const Smoothed& s, std::size_t first, std::size_t last) {
    const RunSignals& signals = s.prepared.signals;
    TestMotion m;
    m.step = s.step;
    const auto count = static_cast<std::size_t>(std::floor((signals.time[last] - signals.time[first]) / s.step + 1e-6));
    std::size_t a = first;
    for (std::size_t k = 0; k <= count; ++k) {
        const double t = signals.time[first] + s.step * static_cast<double>(k);
        while (a + 1 < last && signals.time[a + 1] <= t + 1e-9) {
            ++a;
        }
        const std::size_t b = std::min(a + 1, last);
        const double part =
            b == a ? 0 : std::clamp((t - signals.time[a]) / (signals.time[b] - signals.time[a]), 0.0, 1.0);
        const FilterEstimate &ea = s.result.estimates[a], &eb = s.result.estimates[b];
        m.gap.push_back(ea.gap + part * (eb.gap - ea.gap));
        m.velocity.push_back(ea.velocity + part * (eb.velocity - ea.velocity));
        m.total_force.push_back(ea.total_force + part * (eb.total_force - ea.total_force));
        m.input.push_back(signals.held ? input_at(signals, a)
                                       : input_at(signals, a) + part * (input_at(signals, b) - input_at(signals, a)));
    }
    for (std::size_t k = 0; k <= count; ++k) {
        const std::size_t before = k > 0 ? k - 1 : 0, after = std::min(k + 1, count);
        m.total_rate.push_back(after > before ? (m.total_force[after] - m.total_force[before]) /
                                                    (static_cast<double>(after - before) * s.step)
                                              : 0);
    }
    return m;
}

}  // namespace

TrainingSet training_from_runs(const dynamics::Model& model, const dynamics::Measurements& data,
                               const std::vector<std::string>& auxiliaries, const EstimateOptions& options,
                               core::Progress& progress) {
    TrainingSet set;
    set.layout = {{"input_force"}, {"heave_velocity", "gap"}, 2};
    set.layout.states.insert(set.layout.states.end(), auxiliaries.begin(), auxiliaries.end());
    const auto runs = smooth_runs(model, data, options, set.remarks, progress);
    if (std::none_of(runs.begin(), runs.end(),
                     [](const Smoothed& s) { return internal::range_of(s.prepared.signals.gap) > 0; })) {
        throw core::InputError("constant", "the gap does not vary in any run: there is nothing to learn",
                               {data.folder.string(), {}, {}, {}});
    }
    std::vector<double> row(set.layout.channels());
    std::size_t outside = 0;
    for (const Smoothed& s : runs) {
        double departure = 0;
        const SeparatedPlant plant = departed(s.prepared.plant, departure);
        const auto& time = s.prepared.signals.time;
        for (std::size_t k = 1; k + 1 < time.size(); ++k) {
            const double span = time[k + 1] - time[k - 1];
            if (span > 6 * s.step) {
                continue;
            }
            const FilterEstimate& e = s.result.estimates[k];
            departure = e.departure;
            sample_at(plant, set.layout, input_at(s.prepared.signals, k), e.velocity, e.gap, row.data());
            const double rate = (s.result.estimates[k + 1].departure - s.result.estimates[k - 1].departure) / span;
            for (std::size_t i = 0; i < set.layout.states.size(); ++i) {
                const bool moved = set.layout.states[i] == "ground_force" || set.layout.states[i] == "total_force";
                row[1 + set.layout.states.size() + i] += moved ? rate : 0;
            }
            set.values.insert(set.values.end(), row.begin(), row.end());
            ++set.count;
            outside += e.outside ? 1U : 0U;
        }
    }
    if (set.count == 0) {
        throw core::InputError("few", "the runs hold no three samples in a row", {data.folder.string(), {}, {}, {}});
    }
    set.outside = static_cast<double>(outside) / static_cast<double>(set.count);
    if (outside > 0) {
        note(set.remarks, std::to_string(outside) + " of " + core::counted(set.count, "sample lies", "samples lie") +
                              " beyond the force table, where it holds its end value");
    }
    return set;
}

std::vector<TestMotion> motions_from_runs(const dynamics::Model& model, const dynamics::Measurements& data,
                                          double horizon, const EstimateOptions& options, core::Progress& progress) {
    core::Problems remarks;
    std::vector<TestMotion> motions;
    for (const Smoothed& s : smooth_runs(model, data, options, remarks, progress)) {
        const auto plant = std::make_shared<const SeparatedPlant>(s.prepared.plant);
        const auto& time = s.prepared.signals.time;
        for (std::size_t first = 0; first + 1 < time.size();) {
            std::size_t last = first;
            while (last + 1 < time.size() && time[last + 1] - time[last] < 5.5 * s.step &&
                   time[last + 1] - time[first] <= horizon + 1e-9) {
                ++last;
            }
            if (last > first && time[last] - time[first] >= 0.5 * horizon) {
                motions.push_back(motion_between(s, first, last));
                motions.back().plant = plant;
            }
            first = std::max(last, first + 1);
        }
    }
    if (motions.empty()) {
        throw core::InputError("few", "no run is long enough to predict over half of the horizon",
                               {data.folder.string(), {}, {}, {}}, "take a shorter option 'horizon'");
    }
    return motions;
}

SnapshotPairs snapshot_pairs(const std::vector<TestMotion>& motions, const std::vector<std::string>& auxiliaries,
                             double step) {
    SnapshotPairs pairs;
    pairs.layout = {{"input_force"}, {"heave_velocity", "gap"}, 2};
    pairs.layout.states.insert(pairs.layout.states.end(), auxiliaries.begin(), auxiliaries.end());
    const std::size_t n = pairs.layout.states.size();
    std::vector<double> row(pairs.layout.channels()), next(row.size());
    for (const TestMotion& m : motions) {
        if (!m.plant) {
            throw core::InputError("missing", "snapshots of a motion need its plant");
        }
        const auto stride = static_cast<std::size_t>(std::max(1.0, std::round(step / m.step)));
        const double own = m.step * static_cast<double>(stride);
        if (pairs.step > 0 && std::abs(own - pairs.step) > 1e-6 * own) {
            continue;  // another sample time: its snapshots do not belong to the same step
        }
        pairs.step = own;
        for (std::size_t k = 0; k + stride < m.gap.size(); ++k) {
            double mean = 0;
            for (std::size_t i = 0; i < stride; ++i) {
                mean += m.input[k + i] / static_cast<double>(stride);
            }
            sample_at(*m.plant, pairs.layout, mean, m.velocity[k], m.gap[k], row.data());
            sample_at(*m.plant, pairs.layout, mean, m.velocity[k + stride], m.gap[k + stride], next.data());
            std::copy(next.begin() + 1, next.begin() + 1 + static_cast<std::ptrdiff_t>(n),
                      row.begin() + 1 + static_cast<std::ptrdiff_t>(n));
            pairs.values.insert(pairs.values.end(), row.begin(), row.end());
            ++pairs.count;
        }
    }
    return pairs;
}

}  // namespace underbody::estimator
