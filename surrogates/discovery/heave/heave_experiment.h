// Heave runs against a model: likelihood of any hypothesis by the filter inside the loop, with the noise it needs.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/heave/heave_filter.h"
#include "surrogates/discovery/heave/heave_record.h"
#include "surrogates/discovery/hypothesis.h"
#include "surrogates/discovery/wave_scan.h"

namespace underbody::discovery {

class HeaveExperiment {
public:
    /// `chosen` are the records that may be used; the data set's declared noise is checked against the data.
    HeaveExperiment(const dynamics::Model& model, const HeaveRecords& records, std::vector<std::size_t> chosen,
                    std::optional<double> declared_gap_noise, std::optional<double> declared_velocity_noise);

    [[nodiscard]] const HeaveNoise& noise() const { return noise_; }
    void set_noise(const HeaveNoise& noise) { noise_ = noise; }
    /// Whether the recorded input is held between samples (default) or linear.
    [[nodiscard]] bool hold() const { return hold_; }
    void set_hold(bool hold) { hold_ = hold; }
    [[nodiscard]] const std::vector<std::size_t>& chosen() const { return chosen_; }
    [[nodiscard]] const HeaveRecords& records() const { return records_; }
    [[nodiscard]] const dynamics::Model& model() const { return model_; }
    [[nodiscard]] const core::Problems& problems() const { return problems_; }
    /// "declared" or what else, by channel.
    [[nodiscard]] const std::string& gap_noise_from() const { return gap_from_; }
    [[nodiscard]] const std::string& velocity_noise_from() const { return velocity_from_; }

    /// The model of one record with further effects.
    [[nodiscard]] HeaveExplanation explanation(std::size_t record, const std::vector<dynamics::EffectUse>& uses,
                                               const FlexibleForce* flexible = nullptr) const;

    /// -2 log likelihood; innovations of all chosen records one after the other, `by_record` its parts.
    double evaluate(const std::vector<dynamics::EffectUse>& uses, const FlexibleForce* flexible,
                    const HeaveNoise& noise, std::vector<double>& innovations,
                    std::vector<double>* by_record = nullptr) const;

    /// Process noise of greatest likelihood for these effects, starting from noise.process; the cost there.
    double fit_process(const std::vector<dynamics::EffectUse>& uses, HeaveNoise& noise) const;
    /// White and coloured sensor noise as well. True if coloured noise was found to be there: it gains `colour_gain` or
    /// more in -2 log likelihood (Calibration).
    bool fit_noise(const std::vector<dynamics::EffectUse>& uses, HeaveNoise& noise, double colour_gain) const;

    struct Result {
        FittedHypothesis fitted;
        HeaveNoise noise;
    };
    /// Best numbers, process noise lowered step by step from `begin` as long as that helps: the first steps are as tame
    /// as a regression, the last as sharp as a simulation of the whole run.
    [[nodiscard]] Result fit(const Hypothesis& hypothesis, const HeaveNoise& begin) const;

    /// What a smooth force depends on, and with how many columns of each.
    struct SmoothSet {
        std::vector<FlexibleForce::Variable> variables;
        std::vector<std::size_t> columns;
        bool operator==(const SmoothSet&) const = default;
    };
    /// A smooth force over the variables on top of fixed effects; gain relative to `base_cost`.
    struct Smooth {
        SmoothSet set;
        SmoothFit fit;
        FlexibleForce force;
        HeaveNoise noise;
        double cost = 0;                ///< -2 log likelihood
        std::vector<double> held_out;   ///< by run, with coefficients from the other runs
        std::vector<double> residuals;  ///< innovations with it
    };
    [[nodiscard]] Smooth fit_smooth(const SmoothSet& set, const std::vector<dynamics::EffectUse>& uses,
                                    const HeaveNoise& begin, double base_cost) const;

    /// The smooth force with its knots where the states of these effects are, all coefficients zero.
    [[nodiscard]] FlexibleForce flat_force(const SmoothSet& set, const std::vector<dynamics::EffectUse>& uses,
                                           const HeaveNoise& noise) const;
    /// What a small change of each of its numbers (FlexibleForce::set) does to the innovations, one column each.
    [[nodiscard]] DesignMatrix answers(const FlexibleForce& force, const std::vector<dynamics::EffectUse>& uses,
                                       const HeaveNoise& noise, const std::vector<double>& innovations) const;
    /// What a small change of each free number does, at these numbers.
    [[nodiscard]] DesignMatrix answers(const Hypothesis& hypothesis, std::span<const double> numbers,
                                       const HeaveNoise& noise, const std::vector<double>& innovations) const;

    /// Where the innovations of the chosen records begin, and where the last ends.
    [[nodiscard]] std::vector<std::size_t> begins() const;

    /// Frequencies at which a periodic force would explain most, with amplitude and phase: starts for the hypothesis.
    [[nodiscard]] std::vector<std::vector<double>> periodic_starts(const std::vector<dynamics::EffectUse>& uses,
                                                                   const HeaveNoise& noise, std::size_t count) const;

    /// The chosen records as a scan for waves sees them.
    [[nodiscard]] std::vector<SampledRun> sampled() const;

    /// Number of readings behind the likelihood.
    [[nodiscard]] std::size_t readings() const;

private:
    /// -2 log likelihood of one record; its innovations are appended.
    double cost_of(std::size_t record, const std::vector<dynamics::EffectUse>& uses, const FlexibleForce* flexible,
                   const HeaveNoise& noise, std::vector<double>& innovations) const;
    /// answers(), with zeros for numbers at a bound: they will not move.
    [[nodiscard]] DesignMatrix answers_inside(const Hypothesis& hypothesis, std::span<const double> numbers,
                                              const HeaveNoise& noise, const std::vector<double>& innovations) const;
    /// A fit whose runs are to be left out one by one.
    struct Left {
        const std::vector<FitParameter>& parameters;
        const std::vector<double>& numbers;  ///< that fit all runs
        double ridge = 0;                    ///< weight of (number/typical)^2
        std::function<double(std::size_t record, const std::vector<double>& numbers, const HeaveNoise&,
                             std::vector<double>& innovations)>
            cost;
        std::function<DesignMatrix(const HeaveNoise&, const std::vector<double>& innovations)>
            answers;  ///< at `numbers`
    };
    /// -2 log likelihood of each run with numbers from the other runs alone: one step of Gauss and Newton from those
    /// that fit all, within the bounds and no longer than it serves the other runs, then the filter itself; with as
    /// much process noise, from `noise` up to `most_process`, as serves the runs left out. With one run: its cost.
    [[nodiscard]] std::vector<double> held_out_cost(const Left& fit, HeaveNoise noise, double most_process) const;
    /// The same at this noise; `inside` is the cost of all runs with `numbers`.
    [[nodiscard]] std::vector<double> held_out_at(const Left& fit, const HeaveNoise& noise, double& inside) const;
    [[nodiscard]] WaveLine line_at(double frequency, const std::vector<dynamics::EffectUse>& uses,
                                   const HeaveNoise& noise, const std::vector<double>& base) const;
    void widen_for_form(Result& result, void (*other_form)(dynamics::HeaveTerms&), const DesignMatrix& columns,
                        const std::vector<double>& innovations) const;
    /// What a corrected declared number makes of the lift of the tables in this record.
    [[nodiscard]] double lift_gain_of(const dynamics::EffectUse& use, std::size_t record) const;
    const dynamics::Model& model_;
    const HeaveRecords& records_;
    std::vector<std::size_t> chosen_;
    std::vector<dynamics::HeaveTerms> bare_;  ///< per record: terms without effects
    HeaveNoise noise_;
    std::string gap_from_;
    std::string velocity_from_;
    core::Problems problems_;
    bool hold_ = true;
};

/// Names of variables as in docs/conventions.md section 1.
const char* variable_name(FlexibleForce::Variable variable);

}  // namespace underbody::discovery
