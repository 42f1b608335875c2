// Closing the loop: measured data and a declared model -> what the model lacks, the model with it, the error before and
// after.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/figure.h"
#include "core/progress.h"
#include "core/report_table.h"
#include "core/table.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {
class Motion;
}

namespace underbody::discovery {

struct FoundParameter {
    std::string name;
    double value = 0;
    double sigma = 0;  ///< one standard deviation; 0: held at its default
    std::string unit;
};

/// One effect of the verdict, or one of its rivals.
struct FoundEffect {
    std::string name;  ///< of the catalogue, or "unknown"
    std::vector<FoundParameter> parameters;
    std::vector<std::string> depends_on;
    double probability = 0;
    std::string evidence;                   ///< a sentence with the figures
    std::string told_apart_by;              ///< rivals: what would separate it from the verdict
    double explained = 0;                   ///< fall of -2 log likelihood
    std::vector<dynamics::EffectUse> uses;  ///< what goes into the model
};

struct NoiseUsed {
    double value = 0;
    std::string unit;
    std::string from;
    double estimated = 0;
};

/// One channel's error on what was held out from every fit and choice.
struct ErrorChange {
    std::string channel;
    std::string unit;
    double horizon = 0;  ///< s; 0: static
    ErrorEstimate before;
    ErrorEstimate after;
    double noise = 0;  ///< one standard deviation of a reading
};

/// Smallest effect that would have been seen.
struct DetectionLimit {
    std::string name;
    std::string parameter;
    double value = 0;
    std::string unit;
};

struct EquilibriumPair {
    std::string name;
    bool stable = false;
    double gap_before = 0;  ///< NaN: not there
    double gap_after = 0;
};

struct Consequence {
    std::vector<EquilibriumPair> equilibria;
    std::map<std::string, double> region_before;  ///< class -> area fraction
    std::map<std::string, double> region_after;
    double estimator_before =
        0;  ///< m/s, error of the velocity that a state estimator with this model gives; 0: not computed
    double estimator_after = 0;
    std::string text;
};

/// The same procedure on twins of the data in which nothing is missing: the declared model with noise at the same set
/// points.
struct Placebo {
    std::size_t twins = 0;
    std::size_t alarms = 0;  ///< twins in which something was found
    double error_ratio = 1;  ///< their held-out error after over before, root mean square
};

/// What the model as found still leaves of the held-out runs, beside twins: the same rig with the model as found.
struct UnexplainedRest {
    double twins = 0;        ///< held-out error of the twins, in the unit of the first error; 0: not simulated
    double unexplained = 0;  ///< root of the difference of squares, in that unit
    bool is_noise = true;    ///< the error is no more than the allowed factor above the twins'
    /// Static: it may as well be noise, of a declared figure that is too small and has no repeats to be judged by.
    bool or_noise_figure = false;
    std::vector<std::string> depends_on;
};

/// A number that differs from run to run far beyond its errors, though the rig is one: a sensor's zero, a clock.
struct DiffersByRun {
    std::string name;  ///< of the catalogue: the effect that it is a number of
    std::string parameter;
    std::string unit;
    double chance = 1;  ///< that noise alone lets runs differ as much
    std::vector<std::string> runs;
    std::vector<double> value, sigma;  ///< run by run, SI
};

/// Force or moment that must be added to a model for one axis of the measured motion, over the fitted runs.
struct AxisResidual {
    std::string quantity;  ///< lift_force, pitch_moment
    std::string unit;
    double mean_before = 0, rms_before = 0;  ///< of the model as declared
    double mean_after = 0, rms_after = 0;    ///< of the model as found
    double sigma = 0;                        ///< one standard deviation of the noise that gets through the smoother
};

struct Discovery {
    std::string motion = "heave";    ///< of a time series: heave, heave_pitch, surface, body
    std::vector<AxisResidual> axes;  ///< coupled motions: one a load
    std::string verdict;             ///< none, effect, unknown
    std::string sentence;            ///< the verdict for people
    std::vector<FoundEffect> effects;
    std::vector<FoundEffect> alternatives;
    double none_probability = 0;
    std::vector<std::string> depends_on;  ///< of the residual, found without any named effect
    double gate = 1;                      ///< chance of as much structure when nothing is missing
    bool structure = false;  ///< that chance is so small that the fitted data hold more than noise, named or not
    double stability = 0;    ///< share of resampled runs with the same verdict
    std::map<std::string, NoiseUsed> noise;
    std::vector<ErrorChange> error;  ///< the first is the chief one
    std::string held_out;            ///< which data the error is from
    std::string mended;              ///< how the records are read anew ([records] of the model); empty: as logged
    UnexplainedRest rest;
    std::optional<DiffersByRun> by_run;  ///< asked where nothing was found that all runs have in common
    std::vector<DetectionLimit> limits;
    Consequence consequence;
    Placebo placebo;
    std::string next_experiment;
    core::Table next_set_points;  ///< as a file the rig can follow; empty: none
    double next_power = 0;
    core::Problems problems;
    dynamics::Model model;  ///< with the effect added
    std::vector<core::Figure> figures;
    /// Keys that a caller adds to `consequence` in discovery.json: what rooms beside this one made again with the new
    /// model (its figures go into `figures`). May be empty.
    std::shared_ptr<const nlohmann::json> made_again;
    std::vector<core::ReportTable> made_again_tables;  ///< for the report: exports before and after
    double seconds = 0;
};

/// Twins of the placebo where a user does not say how many: by the command and in a study alike.
inline constexpr std::size_t usual_placebo_twins = 4;

struct DiscoverOptions {
    double horizon = 2;  ///< s, of the windows of the time-series error
    std::uint64_t seed = 1;
    std::vector<std::string> candidates;  ///< effects to consider; empty: all that such data can show
    /// Numbers of Calibration that shall have another value, by name: for the bench that sets them.
    std::map<std::string, double> constants;
    bool consequence = true;
    bool figures = true;
    std::size_t placebo_twins =
        0;  ///< how many clean twins the placebo makes (static sets: whole procedure; time series: the gate)
};

/// The whole loop. Throws core::InputError where nothing can be said; what is doubtful but usable is in `problems`.
Discovery discover(const dynamics::Model& model, const dynamics::Measurements& data,
                   const DiscoverOptions& options = {}, core::Progress& progress = core::Progress::none());

/// `discovery.json` of docs/conventions.md section 6.
nlohmann::json to_json(const Discovery& discovery);

/// PNG bytes of a figure: the drawing library lives above this room.
using FigureRenderer = std::function<std::string(const core::Figure&)>;

/// One self-contained page.
std::string report_html(const Discovery& discovery, const dynamics::Model& before, const dynamics::Measurements& data,
                        const FigureRenderer& renderer);

/// model.toml, discovery.json, report.html and, where there is one, next-experiment.csv.
void write_discovery(const Discovery& discovery, const dynamics::Model& before, const dynamics::Measurements& data,
                     const std::filesystem::path& folder, const FigureRenderer& renderer);

// The pipelines behind discover().
Discovery discover_static(const dynamics::Model& model, const dynamics::Measurements& data,
                          const DiscoverOptions& options, core::Progress& progress);
Discovery discover_heave(const dynamics::Model& model, const dynamics::Measurements& data,
                         const DiscoverOptions& options, core::Progress& progress);
Discovery discover_motion(const dynamics::Motion& motion, const dynamics::Model& model,
                          const dynamics::Measurements& data, const DiscoverOptions& options, core::Progress& progress);

}  // namespace underbody::discovery
