// The loop for runs of a coupled motion, whichever it is: from the runs to a verdict, the error before and after of
// each axis.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/random.h"
#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/guards.h"
#include "surrogates/discovery/heave/heave_error.h"
#include "surrogates/discovery/input_reading.h"
#include "surrogates/discovery/motion/motion_controller.h"
#include "surrogates/discovery/motion/motion_experiment.h"
#include "surrogates/discovery/motion/motion_experiment_design.h"
#include "surrogates/dynamics/simulate/motion_predict.h"

namespace underbody::discovery {

/// Runs once. Steps in the order of run(); each leaves its answer in the members that the next ones read.
class MotionLoop {
public:
    MotionLoop(const dynamics::Motion& motion, const dynamics::Model& model, const dynamics::Measurements& data,
               const DiscoverOptions& options, core::Progress& progress);
    Discovery run();

private:
    // motion_discovery.cpp: the null model and every effect alone
    void split();
    void fit_null();
    void set_null(const MotionNoise& noise);
    void try_between();
    void list_candidates();
    [[nodiscard]] double lowest_gap() const;
    [[nodiscard]] bool needs_unread(const Hypothesis& hypothesis) const;
    [[nodiscard]] MotionExperiment::Result fitted(const Hypothesis& hypothesis,
                                                  const std::vector<std::vector<double>>& starts,
                                                  const MotionNoise& begin) const;
    void fit_singles();
    [[nodiscard]] bool noise_given_to_loads() const;
    void noise_beside_best();
    // motion_input.cpp: late, turned or scaled inputs are no effect
    [[nodiscard]] dynamics::RecordReading with_inputs(dynamics::RecordReading reading,
                                                      const InputReading& inputs) const;
    [[nodiscard]] double latest_looked_for() const;
    [[nodiscard]] double cost_alone(std::size_t single) const;
    [[nodiscard]] double cost_with_input(const std::vector<std::size_t>& beside, const std::vector<double>& before);
    [[nodiscard]] InputReading likeliest_inputs();
    void fit_again();
    void check_input();
    [[nodiscard]] MotionNoise noise_at_first() const;
    void warn(const std::string& text);

    // motion_significance.cpp: is anything there, and is anything left?
    /// Linearised answers of one thing that may be missing.
    struct Probe {
        std::size_t candidate = 0;  ///< index into candidates_, or:
        std::optional<MotionSmooth> smooth;
        DesignMatrix columns;         ///< orthonormal, beside what the base can already do
        double gain = 0;              ///< of the base's innovations
        double surprise = 0;          ///< -log10 of the chance of such a gain from white noise
        std::vector<double> numbers;  ///< a candidate's best, to first order
    };
    [[nodiscard]] std::vector<Probe> probes(const std::vector<dynamics::EffectUse>& uses, const MotionNoise& noise,
                                            const DesignMatrix& own) const;
    [[nodiscard]] double chance_in_noise(const std::vector<const DesignMatrix*>& columns,
                                         const std::vector<double>& noise_like, double observed,
                                         std::uint64_t stream) const;
    void open_gate();
    /// Asked where nothing was found that all runs have in common.
    void look_run_by_run();
    struct Rest {
        SmoothFit fit;                    ///< the best smooth load on top; p from simulation
        double share = 0;                 ///< of all structure, that is left
        std::vector<std::size_t> second;  ///< candidates that would explain most beside it, best first
    };
    [[nodiscard]] Rest rest_beside(const FittedHypothesis& base, const MotionNoise& noise) const;
    void fit_further();

    // motion_guards.cpp: what the verdict may say
    /// What a model predicts of the held-out runs.
    struct Answer {
        std::vector<dynamics::EffectUse> uses;
        dynamics::RecordReading reading;
        const dynamics::Measurements* data = nullptr;
        double horizon = 0;
        std::vector<dynamics::MotionRunPrediction> runs;
        std::vector<WindowSquares> windows;  ///< by channel of channels_, SI
        [[nodiscard]] double error(std::size_t channel, std::size_t count) const {
            return windows[channel].by_record(count).rmse();
        }
    };
    [[nodiscard]] dynamics::Model model_with(const std::vector<dynamics::EffectUse>& uses) const;
    [[nodiscard]] Answer answer_of(const std::vector<dynamics::EffectUse>& uses, double horizon) const;
    /// The same of other held-out data, whose logs are read so.
    [[nodiscard]] Answer answer_of(const std::vector<dynamics::EffectUse>& uses, double horizon,
                                   const dynamics::RecordReading& reading, const dynamics::Measurements& data) const;
    /// Of all channels together, in units of their noise.
    [[nodiscard]] WindowSquares together(const Answer& answer) const;
    [[nodiscard]] PairedFall fall(const Answer& before, const Answer& after, double tail) const;
    [[nodiscard]] bool falls(const Answer& before, const Answer& after) const;
    /// Twins of the held-out windows: the model with these effects and the noise of the sensors alone. By channel of
    /// channels_, in SI.
    struct Twins {
        std::vector<std::vector<std::vector<double>>> square;  ///< sum of a window's, by channel, window and draw
        std::vector<double> count;                             ///< readings of one draw
        [[nodiscard]] double error(std::size_t channel) const;
        /// How often such twins have this error or a larger one: each window with one of its draws.
        [[nodiscard]] double chance(std::size_t channel, double error, std::uint64_t seed) const;
    };
    [[nodiscard]] Twins twins_of(const Answer& answer, std::size_t draws) const;
    /// By channel: errors of a window predicted again from readings that noise was drawn for; false where no state
    /// fits.
    [[nodiscard]] bool twin_errors(dynamics::MeasuredMotion& run, const dynamics::MotionWindow& window,
                                   core::Random& random, std::vector<std::vector<double>>& errors) const;
    /// Compares with the twins, and keeps what is unexplained.
    bool rest_is_noise(const Answer& answer);
    [[nodiscard]] double share_left(const Answer& declared, const Answer& answer) const;
    /// A smooth force up in the place of a law without a name, where the likeliest smooth load is one.
    [[nodiscard]] std::optional<dynamics::EffectUse> smooth_force() const;
    /// Puts it (fitted once) into the model where the held-out error falls by it.
    bool correct(const Answer& before);
    void call_runs_unlike();
    void decide();
    void guard();

    // motion_describe.cpp
    void measure_error();
    void measure_axes();
    void describe();
    [[nodiscard]] Consequence consequence() const;

    // motion_promise.cpp: how often a next experiment settles what it is for
    /// Runs of the experiment by one explanation, and what they say.
    struct Repeats {
        std::vector<dynamics::MeasuredRun> runs;
        double apart = 0;      ///< squared distance of the rival from the truth in one run, its numbers fitted to all
        double explained = 0;  ///< the same of the declared model
    };
    [[nodiscard]] Repeats repeats_of(const MotionRig& rig, const MotionTrial& trial,
                                     const std::vector<InputAnswer>& answers,
                                     const std::vector<dynamics::EffectUse>& truth, const FittedHypothesis* rival,
                                     std::size_t repeats) const;
    [[nodiscard]] double chance_to_settle_by(const MotionRig& rig, const MotionTrial& trial,
                                             const std::vector<InputAnswer>& answers, const FittedHypothesis& truth,
                                             const FittedHypothesis* rival, std::size_t repeats) const;
    [[nodiscard]] MotionPromise promise_of(const MotionRig& rig, const MotionTrial& trial,
                                           const std::vector<InputAnswer>& answers, const MotionQuestion& question,
                                           std::size_t repeats) const;
    [[nodiscard]] double stability() const;

    [[nodiscard]] const dynamics::MotionShape& shape() const { return motion_.shape(); }
    [[nodiscard]] std::vector<MotionSmooth> smooth_loads() const;

    const dynamics::Motion& motion_;
    const dynamics::Model& model_;
    const dynamics::Measurements& data_;
    const DiscoverOptions& options_;
    core::Progress& progress_;
    Calibration calibration_;
    std::optional<MotionExperiment> experiment_;
    dynamics::Measurements test_data_;  ///< the held-out runs
    bool held_out_is_told_ = false;     ///< by who made the data: runs that are added are none of it
    std::vector<std::size_t> channels_;
    MotionNoise null_noise_;
    double null_cost_ = 0;
    std::vector<double> null_innovations_, null_by_record_;
    std::vector<std::string> inputs_;  ///< columns of recorded inputs that move
    std::ptrdiff_t problems_before_fit_ = 0;
    std::vector<Hypothesis> candidates_;
    std::vector<Probe> probes_;  ///< beside the model as declared
    std::vector<FittedHypothesis> fitted_;
    std::vector<MotionNoise> noises_;        ///< of fitted_
    std::vector<std::size_t> candidate_of_;  ///< of the single ones among fitted_
    std::size_t best_single_ = 0;
    SmoothFit whole_;
    std::optional<MotionSmooth> likeliest_smooth_;                    ///< that whole_ is of
    std::optional<std::optional<dynamics::EffectUse>> smooth_force_;  ///< once it was asked for
    Rest rest_;
    double gate_ = 1;
    Attribution attribution_;
    std::vector<dynamics::EffectUse> uses_;
    Discovery result_;
};

}  // namespace underbody::discovery
