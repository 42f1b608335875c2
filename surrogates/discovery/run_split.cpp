#include "surrogates/discovery/run_split.h"

#include <algorithm>
#include <numeric>

#include "core/counted.h"
#include "core/random.h"

namespace underbody::discovery {

namespace {

/// True where dataset.toml or a folder says it.
bool split_as_told(const dynamics::Measurements& data, const std::vector<std::size_t>& run_of, RunSplit& split) {
    const std::size_t count = run_of.size();
    if (std::any_of(data.runs.begin(), data.runs.end(),
                    [](const auto& run) { return run.use == dynamics::RunUse::test; })) {
        for (std::size_t i = 0; i < count; ++i) {
            (data.runs[run_of[i]].use == dynamics::RunUse::test ? split.test : split.train).push_back(i);
        }
        split.held_out = "runs that dataset.toml marks for the test";
    } else if (std::filesystem::exists(data.folder / "held-out" / "dataset.toml")) {
        dynamics::Measurements other = dynamics::read_measurements(data.folder / "held-out");
        if (other.kind == dynamics::MeasurementKind::time_series) {
            split.beside = std::move(other);
            split.train.resize(count);
            std::iota(split.train.begin(), split.train.end(), std::size_t{0});
            split.held_out =
                "the runs in the folder held-out beside the data (another excitation or controller), which nothing was "
                "fitted to";
        }
    }
    return !split.train.empty();
}

}  // namespace

RunSplit split_runs(const dynamics::Measurements& data, const std::vector<std::size_t>& run_of, std::uint64_t seed) {
    RunSplit split;
    const std::size_t count = run_of.size();
    if (split_as_told(data, run_of, split)) {
        split.told = true;
        return split;
    }
    const std::size_t held = count >= 3 ? std::max<std::size_t>(1, count / 4) : 0;
    std::vector<bool> out(count, false);
    core::Random random(seed);
    for (std::size_t left = held; left > 0;) {
        const std::size_t i = random.below(count);
        left -= out[i] ? 0 : 1;
        out[i] = true;
    }
    for (std::size_t i = 0; i < count; ++i) {
        (out[i] ? split.test : split.train).push_back(i);
    }
    split.held_out = std::to_string(held) + " of " + std::to_string(count) +
                     " runs, drawn before anything was fitted (same controller)";
    for (std::size_t i = 0; i < split.test.size(); ++i) {
        split.held_out += (i == 0 ? ": " : ", ") + data.runs[run_of[split.test[i]]].name;
    }
    if (held == 0) {
        split.test = split.train;
        split.held_out = fitted_runs;
        split.problems.push_back({core::Problem::Severity::warning,
                                  "with " + core::counted(count, "run") +
                                      " nothing can be held out: the error is that of the fit, and what "
                                      "runs have in common cannot be told from chance",
                                  core::Place{data.folder.string(), {}, {}, {}}});
    }
    return split;
}

dynamics::Measurements held_out_data(const RunSplit& split, const dynamics::Measurements& data,
                                     const std::vector<std::size_t>& run_of) {
    if (split.beside) {
        return *split.beside;
    }
    dynamics::Measurements held = data;
    held.runs.clear();
    for (const std::size_t i : split.test) {
        held.runs.push_back(data.runs[run_of[i]]);
    }
    return held;
}

}  // namespace underbody::discovery
