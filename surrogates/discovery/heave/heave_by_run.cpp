// Does a number differ from run to run, though the rig is one? A sensor's zero that was set anew for each run, a clock
// that started late in some: no effect that is the same in all runs shows it, and its mean may be nought.
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "surrogates/discovery/heave/heave_loop.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

/// Strength of one number, run by run, beside what it is in all runs together.
HeaveLoop::RunByRun HeaveLoop::run_by_run(const Hypothesis& candidate, const std::vector<double>& innovations) const {
    RunByRun out;
    const FitParameter& number = candidate.parameters.front();
    // away from a bound at which it does nothing
    const double step = 0.05 * number.typical * (number.start + 0.05 * number.typical > number.upper ? -1 : 1);
    std::vector<double> there;
    const std::vector<double> moved{number.start + step};
    experiment_->evaluate(candidate.with(moved), nullptr, null_noise_, there);
    const std::vector<std::size_t> begin = experiment_->begins();
    const std::size_t runs = begin.size() - 1;
    DesignMatrix all, each;
    all.rows = each.rows = innovations.size();
    all.columns = 1;
    each.columns = runs;
    each.values.assign(runs * each.rows, 0);
    for (std::size_t g = 0; g < runs; ++g) {
        double jj = 0, jr = 0;
        for (std::size_t i = begin[g]; i < begin[g + 1]; ++i) {
            const double slope = there[i] - innovations[i];
            each.at(i, g) = slope;
            jj += slope * slope;
            jr += slope * innovations[i];
        }
        out.value.push_back(number.start - (jj > 0 ? step * jr / jj : 0));
        out.sigma.push_back(jj > 0 ? std::abs(step) / std::sqrt(jj) : 1e300);
    }
    for (std::size_t i = 0; i < innovations.size(); ++i) {
        all.values.push_back(there[i] - innovations[i]);
    }
    if (!std::all_of(all.values.begin(), all.values.end(), [](double x) { return std::isfinite(x); })) {
        return out;
    }
    if (std::any_of(out.value.begin(), out.value.end(),
                    [&](double value) { return value < number.lower || value > number.upper; })) {
        return out;  // beyond what is possible: it stands in for something else
    }
    out.probe.columns = orthonormal_beside(orthonormal(all), each);
    out.probe.gain = explained_square(out.probe.columns, innovations);
    out.probe.surprise = surprise(out.probe.gain, static_cast<double>(out.probe.columns.columns));
    return out;
}

/// Asked where nothing was found that all runs have in common.
void HeaveLoop::look_run_by_run() {
    if (static_cast<double>(train_.size()) < calibration_.by_run_runs) {
        return;
    }
    std::vector<std::size_t> asked;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        if (candidates_[i].parameters.size() == 1) {
            asked.push_back(i);
        }
    }
    std::vector<double> innovations;
    experiment_->evaluate({}, nullptr, null_noise_, innovations);
    std::vector<RunByRun> found(asked.size());
    core::parallel_for(asked.size(), [&](std::size_t k) { found[k] = run_by_run(candidates_[asked[k]], innovations); });
    const auto best = std::max_element(found.begin(), found.end(), [](const RunByRun& a, const RunByRun& b) {
        return a.probe.surprise < b.probe.surprise;
    });
    if (best == found.end() || best->probe.surprise < calibration_.by_run_surprise) {
        return;
    }
    if (!whole_list_.empty()) {  // a law that is the same in all runs explains more: over time, say
        const SmoothFit& law = best_smooth(whole_list_).fit;
        if (surprise(law.gain, law.degrees) > best->probe.surprise) {
            return;
        }
    }
    const double middle = median(best->value);
    bool clear = false;
    for (std::size_t g = 0; g < best->value.size(); ++g) {
        clear = clear || std::abs(best->value[g] - middle) > calibration_.by_run_sigmas * best->sigma[g];
    }
    std::vector<Probe> list;
    for (const RunByRun& one : found) {
        list.push_back(one.probe);
    }
    std::vector<double> left = innovations;
    take_out(best->probe.columns, left);
    const double chance = chance_in_noise(list, left, best->probe.surprise, 2);
    if (!clear || chance >= calibration_.by_run_gate_share * calibration_.gate) {
        return;
    }
    const Hypothesis& candidate = candidates_[asked[static_cast<std::size_t>(best - found.begin())]];
    DiffersByRun& differs = result_.by_run.emplace();
    differs.name = candidate.names.front();
    differs.parameter = candidate.parameters.front().name;
    differs.unit = candidate.parameters.front().unit;
    differs.chance = chance;
    for (std::size_t g = 0; g < train_.size(); ++g) {
        differs.runs.push_back(records_.records[train_[g]].name);
        differs.value.push_back(best->value[g]);
        differs.sigma.push_back(best->sigma[g]);
    }
}

}  // namespace underbody::discovery
