// Does a number differ from run to run in heave? Asked where nothing was found that all runs have in common.
#include "surrogates/discovery/by_run.h"
#include "surrogates/discovery/heave/heave_loop.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

void HeaveLoop::look_run_by_run() {
    RunsInnovations runs;
    experiment_->evaluate({}, nullptr, null_noise_, runs.value);
    runs.begin = experiment_->begins();
    for (const std::size_t r : train_) {
        runs.runs.push_back(records_.records[r].name);
    }
    ByRunQuestions ask;
    ask.innovations = [&](const std::vector<dynamics::EffectUse>& uses) {
        std::vector<double> there;
        experiment_->evaluate(uses, nullptr, null_noise_, there);
        return there;
    };
    ask.chance = [&](const std::vector<const DesignMatrix*>& columns, const std::vector<double>& left,
                     double surprise) { return chance_in_noise(columns, left, surprise, 2); };
    if (!whole_list_.empty()) {
        const SmoothFit& law = best_smooth(whole_list_).fit;
        ask.law = surprise(law.gain, law.degrees);
    }
    result_.by_run = number_by_run(candidates_, runs, ask, calibration_);
}

}  // namespace underbody::discovery
