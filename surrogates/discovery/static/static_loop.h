// The loop for forces at set points: from the readings to a verdict, the error before and after, and what to do next.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "surrogates/discovery/attribution.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/guards.h"
#include "surrogates/discovery/static/static_experiment.h"
#include "surrogates/discovery/static/static_structure.h"

namespace underbody::discovery {

/// Runs once. Steps in the order of run(); each leaves its answer in the members that the next ones read.
class StaticLoop {
public:
    StaticLoop(const dynamics::Model& model, const dynamics::Measurements& data, const DiscoverOptions& options,
               core::Progress& progress);
    Discovery run();

private:
    // static_discovery.cpp: what is held out, every effect alone, accidents, colour
    void split();
    void estimate_noise();
    void fit_singles();
    /// A change over the gap at a length that was not measured is no such change: it would pass for a gain.
    void keep_lengths_inside(std::vector<Hypothesis>& candidates) const;
    [[nodiscard]] FittedHypothesis fitted(const Hypothesis& hypothesis) const;
    /// Whether a channel changes little from one reading to the next, in the order of measurement, as time does.
    [[nodiscard]] bool is_slow(dynamics::Channel channel) const;
    /// What neither the best single effect nor a smooth function of one channel explains; of a slow one only what is
    /// far too much for colour.
    [[nodiscard]] std::vector<double> left_over() const;
    /// One bad reading would pass for an effect, or for more noise than there is.
    void leave_accidents_out();
    /// Noise whose neighbours in time go together would pass for drift and the like: what the best effect and a smooth
    /// function of time leave is looked at, and if it is coloured everything is judged again after whitening.
    void whiten();

    // static_verdict.cpp: is anything there, pairs of effects, what goes into the model
    /// What each effect does to the residuals when it is small.
    [[nodiscard]] std::vector<DesignMatrix> directions() const;
    void open_gate();
    /// The best five singles, each with every other; without those that undo each other.
    [[nodiscard]] std::vector<FittedHypothesis> pairs_of_leaders() const;
    [[nodiscard]] bool does_as_much(const FittedHypothesis& form, const FittedHypothesis& richer) const;
    [[nodiscard]] bool earns_its_place(const FittedHypothesis& pair) const;
    /// What one of two effects leaves would pass for accidents and coloured noise: the best pair beside the singles,
    /// for left_over() alone.
    void try_two();
    /// A second effect is looked for only where the best single one leaves structure, and stays only when it earns its
    /// place; or, as a rival, where the best single one has two free numbers and the two together no more.
    void fit_pairs();
    void add_rivals(std::vector<FittedHypothesis>& found, bool explained);
    /// Two laws of which each does far more than both together (a gain of seven beside a power that undoes it) are no
    /// two effects: they bend into a law that neither has.
    [[nodiscard]] bool cancels(const FittedHypothesis& pair) const;
    void decide();
    /// Quantities in which structure was seen.
    [[nodiscard]] std::vector<std::size_t> quantities_to_correct() const;
    /// Smooth corrections of these quantities over the variables of whole_, fitted to the chosen readings.
    [[nodiscard]] std::vector<dynamics::EffectUse> correction_on(const std::vector<std::size_t>& chosen,
                                                                 const std::vector<std::size_t>& quantities) const;
    /// Whether the verdict stands when each set point counts with its weight.
    [[nodiscard]] bool same_verdict(const std::vector<double>& weight) const;
    [[nodiscard]] double stability() const;

    // static_guards.cpp: what the verdict may say
    [[nodiscard]] const StaticExperiment& held_out_experiment() const;
    [[nodiscard]] std::vector<std::size_t> held_out_readings() const;
    /// In units of the noise, by set point, all measured quantities together.
    [[nodiscard]] BlockErrors held_out_errors(const std::vector<dynamics::EffectUse>& uses) const;
    /// The same of what is in the model (`whole`), then that of the other set points, each with what a fit to the rest
    /// of them gives.
    using FitOn = std::function<std::vector<dynamics::EffectUse>(const std::vector<std::size_t>& chosen)>;
    [[nodiscard]] BlockErrors unseen_errors(const std::vector<dynamics::EffectUse>& whole, const FitOn& fit_on) const;
    /// Of one explanation; nullptr: the model as declared.
    [[nodiscard]] BlockErrors unseen_errors(const FittedHypothesis* one) const;
    /// Whether the error of set points that nothing was fitted to falls from one explanation to another.
    [[nodiscard]] bool falls(const FittedHypothesis* before, const FittedHypothesis& after) const;
    [[nodiscard]] bool rest_is_noise(const BlockErrors& errors) const;
    /// Puts a smooth correction in the place of uses_ where the error of set points that it was not fitted to falls
    /// with it from that of `before` (nullptr: the model as declared); false: leaves them.
    bool correct(const FittedHypothesis* before);
    /// Whether nothing is missing once a declared noise figure that only repeats of set points could overrule is taken
    /// to be too small: the same readings judged again with what smooth laws leave as their noise.
    [[nodiscard]] bool noise_figure_may_be_wrong() const;
    void guard();

    // static_null_simulation.cpp
    /// The data with what the declared model says at every set point, and noise.
    [[nodiscard]] dynamics::Measurements twin(std::uint64_t seed) const;
    void run_placebo();

    // static_describe.cpp
    void measure_error();
    void describe();
    [[nodiscard]] std::string evidence(const FittedHypothesis& one) const;

    const dynamics::Model& model_;
    const dynamics::Measurements& data_;
    const DiscoverOptions& options_;
    core::Progress& progress_;
    Calibration calibration_;
    StaticExperiment experiment_;
    std::optional<StaticExperiment> test_experiment_;
    std::vector<std::size_t> train_;
    std::vector<std::size_t> test_;
    std::vector<double> null_residuals_;
    double null_cost_ = 0;
    std::vector<FittedHypothesis> fitted_;
    std::size_t singles_ = 0;
    std::size_t best_single_ = 0;
    std::optional<StaticStructure> structure_;
    SmoothFit whole_;  ///< structure of the residuals as declared
    SmoothFit rest_;   ///< and of what the best explanation leaves
    double gate_ = 1;
    double rest_in_noise_ = 0;
    bool overrule_noise_ = false;  ///< of a second look: noise_figure_may_be_wrong()
    Attribution attribution_;
    std::vector<dynamics::EffectUse> uses_;  ///< what goes into the model
    Discovery result_;
};

}  // namespace underbody::discovery
