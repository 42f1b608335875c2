// The loop for heave runs: from the records to a verdict, the error before and after, and what to do next.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/random.h"
#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/heave/heave_error.h"
#include "surrogates/discovery/heave/heave_experiment.h"
#include "surrogates/discovery/input_reading.h"

namespace underbody::discovery {

/// Runs once. Steps in the order of run(); each leaves its answer in the members that the next ones read.
class HeaveLoop {
public:
    HeaveLoop(const dynamics::Model& model, const dynamics::Measurements& data, const DiscoverOptions& options,
              core::Progress& progress);
    Discovery run();

private:
    using Variable = FlexibleForce::Variable;

    // heave_discovery.cpp: the null model and every effect alone
    void split();
    void fit_null();
    void set_null(HeaveNoise noise);
    [[nodiscard]] HeaveExperiment::Result fitted(const Hypothesis& hypothesis, const HeaveNoise& begin) const;
    void list_candidates();
    void fit_singles();
    void try_hold();
    void colour_noise();
    void drop_accidents();
    void absorb_small_shift();
    [[nodiscard]] double cost_with_input(const InputReading& reading, const std::vector<std::size_t>& beside);
    void fit_again();
    void check_input();
    void change_input(double seconds, double factor);
    [[nodiscard]] dynamics::RecordReading reading_found() const;

    // heave_gate.cpp: is anything there, and is anything left?
    /// Linearised answers of one thing that may be missing.
    struct Probe {
        std::size_t candidate = 0;  ///< index into candidates_, or:
        const HeaveExperiment::SmoothSet* smooth = nullptr;
        DesignMatrix columns;  ///< orthonormal, beside what the base can already do
        double gain = 0;       ///< of the base's own innovations
        double surprise = 0;   ///< -log10 of the chance of such a gain from white noise
    };
    [[nodiscard]] std::vector<Probe> things_missing(const std::vector<dynamics::EffectUse>& uses, bool named) const;
    [[nodiscard]] DesignMatrix answers_of(const Probe& probe, const HeaveExperiment& experiment,
                                          const std::vector<dynamics::EffectUse>& uses, const HeaveNoise& noise,
                                          const std::vector<double>& innovations) const;
    [[nodiscard]] std::vector<Probe> probes(const HeaveExperiment& experiment,
                                            const std::vector<dynamics::EffectUse>& uses, const HeaveNoise& noise,
                                            const DesignMatrix& own, bool named) const;
    /// Chance that noise alone would surprise as much as `observed` in any of the probes: innovations reordered in
    /// blocks of a second with random signs, so that colour that is left survives.
    [[nodiscard]] double chance_in_noise(const std::vector<const DesignMatrix*>& columns,
                                         const std::vector<double>& noise_like, double observed,
                                         std::uint64_t stream) const;
    void open_gate();
    /// What smooth forces and further effects would still explain beside a fitted hypothesis.
    struct Rest {
        SmoothFit fit;                    ///< the best smooth force on top; p from simulation
        double share = 0;                 ///< of all structure, that is left
        std::vector<std::size_t> second;  ///< candidates that would explain most beside it, best first
    };
    [[nodiscard]] Rest rest_beside(const FittedHypothesis& base, const HeaveNoise& noise) const;
    // heave_by_run.cpp
    void look_run_by_run();
    void smooth_corrections();
    [[nodiscard]] HeaveExperiment::Smooth refined(const HeaveExperiment::Smooth& begin) const;
    [[nodiscard]] double smooth_score(const HeaveExperiment::Smooth& one) const;
    [[nodiscard]] const HeaveExperiment::Smooth& best_smooth(const std::vector<HeaveExperiment::Smooth>& list) const;

    // heave_verdict.cpp
    class PairSearch;
    void fit_pairs();
    void keep_pairs(const std::vector<FittedHypothesis>& found, const std::vector<HeaveNoise>& noises);
    void fit_both(const std::vector<std::pair<std::size_t, std::size_t>>& pairs, std::vector<FittedHypothesis>& found,
                  std::vector<HeaveNoise>& noises) const;
    void fit_further();
    [[nodiscard]] bool plausible_pair(const FittedHypothesis& pair) const;
    void tie_delays();
    void decide();
    [[nodiscard]] double stability() const;

    // heave_guards.cpp: what the verdict may say
    /// What a model predicts of the held-out runs, over each of the horizons.
    struct Answer {
        std::vector<dynamics::EffectUse> uses;
        HeaveNoise noise;
        std::vector<WindowSquares> windows;
        std::vector<std::string> variables;  ///< of a smooth correction
    };
    const HeaveExperiment& held_out_runs();
    [[nodiscard]] std::vector<double> horizons() const;
    [[nodiscard]] Answer answer_of(const std::vector<dynamics::EffectUse>& uses, const HeaveNoise& noise);
    [[nodiscard]] Answer declared_answer(const HeaveNoise& other);
    [[nodiscard]] Answer best_answer();
    [[nodiscard]] double held_out_error(const Answer& answer) const;  ///< m, over the first horizon
    [[nodiscard]] bool falls(const Answer& before, const Answer& after) const;
    [[nodiscard]] bool falls_in_few_blocks(const Answer& before, const Answer& after);
    [[nodiscard]] bool rest_is_noise(const Answer& answer);
    /// Share of what the declared model misses beyond the twins that an answer leaves.
    [[nodiscard]] double share_left(const Answer& declared, const Answer& answer) const;
    [[nodiscard]] std::optional<Answer> smooth_answer();
    void guard();
    void refuse(const std::string& reason);
    void call_runs_unlike();
    void call_rest_unknown(Answer& kept, Answer& declared);
    /// N: as far as the residual force of the runs goes that a correction explains.
    [[nodiscard]] double largest_force(const HeaveExperiment::Smooth& smooth) const;

    // heave_null_simulation.cpp
    /// Twins of an experiment's runs: the model with `uses` moves, `noise` is the filter's, `drawn` what is drawn.
    [[nodiscard]] HeaveRecords twins_of(const HeaveExperiment& experiment, const std::vector<dynamics::EffectUse>& uses,
                                        const HeaveNoise& noise, const HeaveNoise& drawn, std::uint64_t stream) const;
    /// m: error of the held-out runs' twins over the first horizon.
    [[nodiscard]] double twins_error(const HeaveExperiment& test, const std::vector<dynamics::EffectUse>& uses,
                                     const HeaveNoise& noise) const;
    void run_placebo();

    // heave_describe.cpp
    void measure_error();
    void describe();
    void check_excitation();
    void check_runs_agree();
    bool runs_agree_on(std::size_t index);
    void warn(const std::string& text);

    const dynamics::Model& model_;
    const dynamics::Measurements& data_;
    const DiscoverOptions& options_;
    core::Progress& progress_;
    Calibration calibration_;
    HeaveRecords records_;
    std::optional<HeaveRecords> test_records_;
    dynamics::Measurements test_data_;  ///< the held-out runs as they were read
    std::vector<std::size_t> train_, test_;
    std::optional<HeaveExperiment> experiment_;
    std::optional<HeaveExperiment> held_out_;
    HeaveNoise null_noise_, after_noise_;
    HeaveNoise declared_noise_;  ///< of the filter that serves the model as declared best on the held-out runs
    double null_cost_ = 0;
    std::vector<double> null_innovations_, null_by_record_;
    std::vector<Hypothesis> candidates_;
    std::vector<FittedHypothesis> fitted_;  ///< of the candidates, then of pairs
    std::vector<HeaveNoise> noises_;        ///< of fitted_
    std::size_t singles_ = 0;
    std::size_t best_single_ = 0;
    std::vector<HeaveExperiment::Smooth> whole_list_;  ///< smooth forces on the model as declared
    SmoothFit whole_;
    Rest rest_;
    double gate_ = 1;
    double named_gate_ = 1;  ///< chance that noise alone would give as much to any named effect
    Attribution attribution_;
    dynamics::RecordReading
        records_read_;  ///< how the logs are to be read: as declared, and what was found wrong with them
    std::vector<dynamics::EffectUse> uses_;
    Discovery result_;
};

}  // namespace underbody::discovery
