#include "surrogates/discovery/by_run.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

struct RunByRun {
    const Hypothesis* candidate = nullptr;
    std::vector<double> value, sigma;
    DesignMatrix columns;  ///< what it shows beside its mean, orthonormal
    double surprise = 0;
};

/// Strength of one number, run by run, beside what it is in all runs together.
RunByRun run_by_run(const Hypothesis& candidate, const RunsInnovations& innovations, const ByRunQuestions& ask) {
    RunByRun out;
    out.candidate = &candidate;
    const FitParameter& number = candidate.parameters.front();
    // away from a bound at which it does nothing
    const double step = 0.05 * number.typical * (number.start + 0.05 * number.typical > number.upper ? -1 : 1);
    const std::vector<double> there = ask.innovations(candidate.with(std::vector<double>{number.start + step}));
    const std::vector<std::size_t>& begin = innovations.begin;
    const std::size_t runs = begin.size() - 1;
    DesignMatrix all, each;
    all.rows = each.rows = innovations.value.size();
    all.columns = 1;
    each.columns = runs;
    each.values.assign(runs * each.rows, 0);
    for (std::size_t g = 0; g < runs; ++g) {
        double jj = 0, jr = 0;
        for (std::size_t i = begin[g]; i < begin[g + 1]; ++i) {
            const double slope = there[i] - innovations.value[i];
            each.at(i, g) = slope;
            jj += slope * slope;
            jr += slope * innovations.value[i];
        }
        out.value.push_back(number.start - (jj > 0 ? step * jr / jj : 0));
        out.sigma.push_back(jj > 0 ? std::abs(step) / std::sqrt(jj) : 1e300);
    }
    for (std::size_t i = 0; i < innovations.value.size(); ++i) {
        all.values.push_back(there[i] - innovations.value[i]);
    }
    if (!std::all_of(all.values.begin(), all.values.end(), [](double x) { return std::isfinite(x); })) {
        return out;
    }
    if (std::any_of(out.value.begin(), out.value.end(),
                    [&](double value) { return value < number.lower || value > number.upper; })) {
        return out;  // beyond what is possible: it stands in for something else
    }
    out.columns = orthonormal_beside(orthonormal(all), each);
    const double gain = explained_square(out.columns, innovations.value);
    out.surprise = surprise(gain, static_cast<double>(out.columns.columns));
    return out;
}

}  // namespace

std::optional<DiffersByRun> number_by_run(const std::vector<Hypothesis>& candidates, const RunsInnovations& runs,
                                          const ByRunQuestions& ask, const Calibration& calibration) {
    std::vector<const Hypothesis*> asked;
    for (const Hypothesis& candidate : candidates) {
        if (candidate.parameters.size() == 1) {
            asked.push_back(&candidate);
        }
    }
    if (asked.empty() || static_cast<double>(runs.runs.size()) < calibration.by_run_runs) {
        return {};
    }
    std::vector<RunByRun> found(asked.size());
    core::parallel_for(asked.size(), [&](std::size_t k) { found[k] = run_by_run(*asked[k], runs, ask); });
    const auto best = std::max_element(found.begin(), found.end(),
                                       [](const RunByRun& a, const RunByRun& b) { return a.surprise < b.surprise; });
    if (best->surprise < calibration.by_run_surprise || ask.law > best->surprise) {
        return {};
    }
    const double middle = median(best->value);
    bool clear = false;
    for (std::size_t g = 0; g < best->value.size(); ++g) {
        clear = clear || std::abs(best->value[g] - middle) > calibration.by_run_sigmas * best->sigma[g];
    }
    std::vector<const DesignMatrix*> columns;
    for (const RunByRun& one : found) {
        columns.push_back(&one.columns);
    }
    std::vector<double> left = runs.value;
    take_out(best->columns, left);
    const double chance = ask.chance(columns, left, best->surprise);
    if (!clear || chance >= calibration.by_run_gate_share * calibration.gate) {
        return {};
    }
    const FitParameter& number = best->candidate->parameters.front();
    return DiffersByRun{
        best->candidate->names.front(), number.name, number.unit, chance, runs.runs, best->value, best->sigma};
}

}  // namespace underbody::discovery
