// Runs of a coupled motion against a model: likelihood of any hypothesis by the filter, with the noise it needs.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/discovery/flexible.h"
#include "surrogates/discovery/hypothesis.h"
#include "surrogates/discovery/motion/motion_filter.h"
#include "surrogates/discovery/wave_scan.h"

namespace underbody::discovery {

/// A smooth load over these variables, with so many columns of each.
struct MotionSmooth {
    std::size_t axis = 0;  ///< of MotionShape::loads
    std::vector<std::string> variables;
    std::vector<std::size_t> columns;
};

class MotionExperiment {
public:
    /// The records are runs of `data`, all with the same model.
    MotionExperiment(const dynamics::Motion& motion, const dynamics::Model& model, const dynamics::Measurements& data,
                     std::vector<MotionRecord> records);

    [[nodiscard]] const std::vector<MotionRecord>& records() const { return records_; }
    [[nodiscard]] std::vector<MotionRecord>& records() { return records_; }
    [[nodiscard]] const dynamics::Model& model() const { return model_; }
    [[nodiscard]] const dynamics::MotionShape& shape() const { return motion_.shape(); }
    /// Number of readings behind the likelihood.
    [[nodiscard]] std::size_t readings() const;
    /// Where the innovations of the records begin, and where the last ends.
    [[nodiscard]] std::vector<std::size_t> begins() const;
    /// Channels that were measured, as states.
    [[nodiscard]] std::vector<std::size_t> channels() const;
    /// Logs are read so from now on; of what is beyond the inputs' known end nothing is used.
    void read(const dynamics::RecordReading& reading) { read(reading, reading.last_unknown()); }
    /// The same without the last `unused` s of each log: readings of the inputs are compared over the same time.
    void read(const dynamics::RecordReading& reading, double unused);
    [[nodiscard]] const dynamics::RecordReading& reading() const { return reading_; }

    /// -2 log likelihood; innovations of all records one after the other, `by_record` its parts.
    double evaluate(const std::vector<dynamics::EffectUse>& uses, const MotionNoise& noise,
                    std::vector<double>& innovations, std::vector<double>* by_record = nullptr,
                    std::vector<MotionTrace>* traces = nullptr) const;

    /// Noise of greatest likelihood for these effects, from `noise` on: white noise of the channels, the loads;
    /// coloured noise where it raises the likelihood enough. The cost of all records there.
    double fit_noise(const std::vector<dynamics::EffectUse>& uses, MotionNoise& noise) const;
    /// The loads alone.
    double fit_process(const std::vector<dynamics::EffectUse>& uses, MotionNoise& noise) const;

    struct Result {
        FittedHypothesis fitted;
        MotionNoise noise;
    };
    /// Best numbers from the likeliest of `starts`; noise of the loads fitted beside them.
    [[nodiscard]] Result fit(const Hypothesis& hypothesis, const std::vector<std::vector<double>>& starts,
                             const MotionNoise& begin) const;

    /// The likeliest, moved inside the bounds; empty where none can be.
    [[nodiscard]] std::vector<double> best_start(const Hypothesis& hypothesis,
                                                 const std::vector<std::vector<double>>& starts,
                                                 const MotionNoise& noise) const;
    /// What a small change of each number does to the innovations, one column each.
    [[nodiscard]] DesignMatrix answers(const Hypothesis& hypothesis, const std::vector<std::vector<double>>& steps,
                                       const std::vector<dynamics::EffectUse>& uses, const MotionNoise& noise,
                                       const std::vector<double>& innovations) const;
    /// What each column of a smooth load does, to first order about the motion of `traces` (motion_smooth.cpp).
    [[nodiscard]] DesignMatrix answers(const MotionSmooth& smooth, const std::vector<MotionTrace>& traces) const;

    /// The records as a scan for waves sees them.
    [[nodiscard]] std::vector<SampledRun> sampled() const;
    /// Frequencies at which a periodic force up would explain most beside the model as declared, with amplitude and
    /// phase; none where no load is one.
    [[nodiscard]] std::vector<std::vector<double>> periodic_starts(const MotionNoise& noise, std::size_t count) const;

    struct SmoothForce {
        std::optional<dynamics::EffectUse> use;  ///< nothing where no table raises the likelihood
        MotionNoise noise;
        double cost = 0;
    };
    /// The likeliest force up over the variables of `smooth` (none of them time) beside the declared model, as a table
    /// that is nowhere larger than the `reach` quantile of the force over the states seen.
    [[nodiscard]] SmoothForce fit_smooth(const MotionSmooth& smooth, const MotionNoise& begin, double reach) const;

private:
    /// loads[column][sample of all traces]
    [[nodiscard]] DesignMatrix answers(std::size_t axis, const std::vector<std::vector<double>>& loads,
                                       const std::vector<MotionTrace>& traces) const;
    double cost_of(const std::vector<std::size_t>& chosen, const std::vector<dynamics::EffectUse>& uses,
                   const MotionNoise& noise) const;
    [[nodiscard]] std::vector<LinearMotionRun> linear_runs(const std::vector<dynamics::EffectUse>& uses,
                                                           const MotionNoise& noise) const;
    /// What each direction of a search changes of the noise, by a factor.
    using Numbers = std::vector<std::function<void(MotionNoise&, double factor)>>;
    /// Pattern search over logarithms of numbers of the noise, about the path of the filter; the cost there.
    double search(const std::vector<dynamics::EffectUse>& uses, const Numbers& numbers, MotionNoise& noise) const;
    void search_about(const std::vector<LinearMotionRun>& runs, const Numbers& numbers, MotionNoise& noise,
                      double factor) const;
    [[nodiscard]] Numbers process_numbers() const;
    [[nodiscard]] Numbers white_numbers() const;
    const dynamics::Motion& motion_;
    const dynamics::Model& model_;
    const dynamics::Measurements& data_;
    std::vector<MotionRecord> records_;
    std::vector<dynamics::MotionReadings> logged_;  ///< of records_
    dynamics::RecordReading reading_;
    double unused_ = 0;
};

/// The runs as records, each cut where the body no longer moves freely; `problems` says where.
std::vector<MotionRecord> motion_records(const dynamics::Motion& motion, const dynamics::Model& model,
                                         const dynamics::Measurements& data, const std::vector<std::size_t>& runs,
                                         core::Problems& problems);

}  // namespace underbody::discovery
