// Runs of heave with pitch against a model: likelihood of any hypothesis by the filter, with the noise it needs.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/discovery/flexible.h"
#include "surrogates/discovery/heave_pitch/pitch_filter.h"
#include "surrogates/discovery/hypothesis.h"

namespace underbody::discovery {

/// A smooth force (axis 0) or moment (axis 1) over these variables, with so many columns of each.
struct PitchSmooth {
    std::size_t axis = 0;
    std::vector<std::string> variables;
    std::vector<std::size_t> columns;
};

class PitchExperiment {
public:
    /// The records are runs of `data`, all with the same model.
    PitchExperiment(const dynamics::Model& model, const dynamics::Measurements& data, std::vector<PitchRecord> records);

    [[nodiscard]] const std::vector<PitchRecord>& records() const { return records_; }
    [[nodiscard]] std::vector<PitchRecord>& records() { return records_; }
    [[nodiscard]] const dynamics::Model& model() const { return model_; }
    /// Number of readings behind the likelihood.
    [[nodiscard]] std::size_t readings() const;
    /// Where the innovations of the records begin, and where the last ends.
    [[nodiscard]] std::vector<std::size_t> begins() const;
    /// Channels that were measured, as states.
    [[nodiscard]] std::vector<std::size_t> channels() const;
    void read_input(dynamics::RecordReading::Between between) { reading_.input_between = between; }
    [[nodiscard]] const dynamics::RecordReading& reading() const { return reading_; }

    /// -2 log likelihood; innovations of all records one after the other, `by_record` its parts.
    double evaluate(const std::vector<dynamics::EffectUse>& uses, const PitchNoise& noise,
                    std::vector<double>& innovations, std::vector<double>* by_record = nullptr,
                    std::vector<PitchTrace>* traces = nullptr) const;

    /// Noise of greatest likelihood for these effects, from `noise` on: white noise of the channels, force and moment;
    /// coloured noise where it raises the likelihood enough. The cost of all records there.
    double fit_noise(const std::vector<dynamics::EffectUse>& uses, PitchNoise& noise) const;
    /// Force and moment alone.
    double fit_process(const std::vector<dynamics::EffectUse>& uses, PitchNoise& noise) const;

    struct Result {
        FittedHypothesis fitted;
        PitchNoise noise;
    };
    /// Best numbers from the likeliest of `starts`; noise of force and moment fitted beside them.
    [[nodiscard]] Result fit(const Hypothesis& hypothesis, const std::vector<std::vector<double>>& starts,
                             const PitchNoise& begin) const;

    /// What a small change of each number does to the innovations, one column each.
    [[nodiscard]] DesignMatrix answers(const Hypothesis& hypothesis, const std::vector<std::vector<double>>& steps,
                                       const std::vector<dynamics::EffectUse>& uses, const PitchNoise& noise,
                                       const std::vector<double>& innovations) const;
    /// What each column of a smooth load does, to first order about the motion of `traces`.
    [[nodiscard]] DesignMatrix answers(const PitchSmooth& smooth, const std::vector<PitchTrace>& traces) const;

private:
    double cost_of(const std::vector<std::size_t>& chosen, const std::vector<dynamics::EffectUse>& uses,
                   const PitchNoise& noise) const;
    [[nodiscard]] std::vector<LinearPitchRun> linear_runs(const std::vector<dynamics::EffectUse>& uses,
                                                          const PitchNoise& noise) const;
    /// Pattern search over logarithms of numbers of the noise, about the path of the filter; the cost there.
    using Numbers = std::vector<double PitchNoise::*>;
    double search(const std::vector<dynamics::EffectUse>& uses, const Numbers& numbers,
                  const std::vector<std::size_t>& white, PitchNoise& noise) const;
    void search_about(const std::vector<LinearPitchRun>& runs, const Numbers& numbers,
                      const std::vector<std::size_t>& white, PitchNoise& noise, double factor) const;
    const dynamics::Model& model_;
    const dynamics::Measurements& data_;
    std::vector<PitchRecord> records_;
    dynamics::RecordReading reading_;
};

/// The runs as records, each cut before the first contact; `problems` says where.
std::vector<PitchRecord> pitch_records(const dynamics::Model& model, const dynamics::Measurements& data,
                                       const std::vector<std::size_t>& runs, core::Problems& problems);

}  // namespace underbody::discovery
