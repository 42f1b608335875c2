#include "surrogates/dynamics/simulate/horizon.h"

#include <algorithm>
#include <limits>

#include "core/text.h"

namespace underbody::dynamics {

double longest_run(const Measurements& data) {
    double longest = 0;
    for (const MeasuredRun& run : data.runs) {
        const std::vector<double>& time = run.table.numbers("time");
        longest = std::max(longest, time.back() - time.front());
    }
    return longest;
}

double time_before(const PredictOptions& options) {
    constexpr double most = 2;  // s
    return options.past > 0 ? options.past : std::min(options.horizon, most);
}

void remark_long_horizon(const Measurements& data, const PredictOptions& options, Prediction& out) {
    const double longest = longest_run(data);
    if (longest < options.horizon) {
        out.remarks.push_back({core::Problem::Severity::warning,
                               "every run is shorter than the horizon of " + core::format_number(options.horizon, 4) +
                                   " s: a prediction ends with its run, after " +
                                   core::format_number(longest - time_before(options), 4) + " s at most",
                               {}});
    }
}

namespace {

/// Shorter than the horizon, or sampled too coarsely for it.
core::InputError no_prediction(const Measurements& data, const PredictOptions& options) {
    constexpr double samples = 3;  // before a window, that its state is estimated from
    double step = std::numeric_limits<double>::infinity();
    for (const MeasuredRun& run : data.runs) {
        const std::vector<double>& time = run.table.numbers("time");
        step = std::min(step, (time.back() - time.front()) / static_cast<double>(time.size() - 1));
    }
    const std::string horizon = core::format_number(options.horizon) + " s";
    if (time_before(options) < samples * step) {
        return {"range",
                "a prediction over " + horizon + " is too short for these runs: their samples lie " +
                    core::format_number(step, 3) + " s apart, and a start is estimated from more than two of them",
                {},
                "a longer horizon, " + core::format_number((samples + 1) * step, 2) + " s or more"};
    }
    return {"range",
            "no run is long enough for a prediction over " + horizon + ": the longest lasts " +
                core::format_number(longest_run(data), 4) + " s",
            {},
            "a shorter horizon"};
}

}  // namespace

Prediction predict_shorter(const Measurements& data, const PredictOptions& options,
                           const std::function<Prediction(const PredictOptions&)>& predict) {
    const double shorter = 0.25 * longest_run(data);
    if (!(shorter > 0 && shorter < options.horizon)) {
        throw no_prediction(data, options);
    }
    PredictOptions short_runs = options;
    short_runs.horizon = shorter;
    Prediction out = predict(short_runs);
    out.remarks.push_back({core::Problem::Severity::warning,
                           "no run is long enough for a prediction over " + core::format_number(options.horizon, 4) +
                               " s: predicted over " + core::format_number(shorter, 4) + " s",
                           {}});
    return out;
}

}  // namespace underbody::dynamics
