// What may be missing from a model: one or two effects of the catalogue with their free numbers.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "surrogates/discovery/least_squares.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/simulate/measured_motion.h"

namespace underbody::discovery {

/// A set of effects whose numbers are to be fitted.
struct Hypothesis {
    std::vector<std::string> names;         ///< of the catalogue, sorted, distinct: what a verdict would say
    std::string form;                       ///< which variant of it ("lift_force only", ...), for the report
    std::vector<dynamics::EffectUse> uses;  ///< what is added to the model; numbers at their start
    std::vector<FitParameter> parameters;   ///< free numbers
    struct Slot {
        std::size_t use = 0;
        std::size_t value = 0;
    };
    std::vector<Slot> slots;  ///< where each free number belongs
    struct Copy {
        std::size_t parameter = 0;
        Slot to;
    };
    std::vector<Copy> copies;  ///< further places of a free number
    /// Other starts worth trying, each of the length of `parameters` (the first start is parameters[i].start).
    std::vector<std::vector<double>> starts;
    std::vector<std::string> depends_on;
    double prior = 1;  ///< weight before the data were seen

    /// The uses with these numbers.
    [[nodiscard]] std::vector<dynamics::EffectUse> with(std::span<const double> p) const;
    /// The free numbers as they stand.
    [[nodiscard]] std::vector<double> start() const;
    [[nodiscard]] std::string label() const;  ///< "coulomb_friction + input_delay"
};

/// A hypothesis and the numbers that suit it best.
struct FittedHypothesis {
    Hypothesis hypothesis;
    Fit fit;
    double cost = 0;                    ///< -2 log likelihood
    double occam = 0;                   ///< -2 log of the prior volume that the data leave: what free numbers cost
    std::vector<double> cost_of_group;  ///< cost by run (or group of set points)
    std::vector<double> held_out;  ///< cost of each run (group) with numbers from the other runs; empty: not computed
    bool rival = false;            ///< of more effects than the best single one and of no more free numbers
    double explained = 0;          ///< cost of the model as declared less `cost`
    std::vector<double> explained_by_group;
    /// What numbers fitted to other runs lose: 0 when nothing was held out.
    [[nodiscard]] double optimism() const {
        double sum = -cost;
        for (const double own : held_out) {
            sum += own;
        }
        return held_out.empty() ? 0 : sum;
    }
    [[nodiscard]] double score() const { return cost + optimism() + occam; }
};

/// The names that a static set with these varying channels and measured quantities can show against this model, each
/// with its variants. An effect that could change nothing there (no speed varies, no table knows of pitch, ...) is not
/// among them.
std::vector<Hypothesis> static_hypotheses(const dynamics::Model& model, const std::vector<dynamics::Channel>& varying,
                                          const std::vector<std::string>& quantities);

/// The names that heave time series can show. `varying`: conditions that differ from run to run; a declared exponent
/// over one of them may be off.
std::vector<Hypothesis> heave_hypotheses(const dynamics::Model& model, const std::vector<dynamics::Channel>& varying);

/// The names that time series of a coupled motion can show: those that act in one of its loads. `varying`: conditions
/// that differ from run to run, and inputs that vary.
std::vector<Hypothesis> motion_hypotheses(const dynamics::MotionShape& shape, const dynamics::Model& model,
                                          const std::vector<dynamics::Channel>& varying);

/// Leaves those whose every name is among `names` (empty: all). Throws core::InputError when none is left.
void keep_only(std::vector<Hypothesis>& list, const std::vector<std::string>& names);

/// Both at once. Parameters of `a` start at `start_a` (fitted), those of `b` where they stand.
Hypothesis joined(const Hypothesis& a, std::span<const double> start_a, const Hypothesis& b,
                  std::span<const double> start_b);

/// What a hypothesis does to input and reading when it is small; from its law, whatever its name.
struct Touch {
    bool input = false;         ///< the force that reaches the body is not the recorded one
    bool gain = false;          ///< ... but so many times
    bool reading_late = false;  ///< the gap's reading comes late
    bool delay = false;         ///< input or reading come late, unchanged
    bool time = false;          ///< a delay or a lag of either
};
Touch touch_of(const Hypothesis& hypothesis, const dynamics::Model& model);

/// Effects that can stand in for parts of each other (EffectSearch::kin).
bool one_kin(const std::vector<std::string>& names);

/// Where a candidate is looked at when it is small: one set of numbers for each column of its answers.
std::vector<std::vector<double>> small_steps(const Hypothesis& hypothesis);

/// A wave of which no run shows a few cycles (four of `lowest_frequency`'s two), or an inertia that grows only far
/// below every gap that was visited, is none that runs can show: it would pass for any slow change. m, Hz.
void keep_shapes_inside(std::vector<Hypothesis>& list, double lowest_gap, double lowest_frequency);

/// Frequencies that a scan asks, as if independent of each other.
constexpr double frequencies_tried = 110;
/// Amplitude, frequency and phase: begins where a scan over frequency says.
bool is_scanned(const Hypothesis& hypothesis);

/// What free numbers cost, as -2 log (Schwarz 1978): their number times log of the number of data. Laws that say the
/// same then cost the same whatever their units.
double occam_factor(const Hypothesis& hypothesis, std::size_t data);

}  // namespace underbody::discovery
