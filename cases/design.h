// A search for a better shape: the plan, its runs, what was learned, what to run next, the best. Everything that was
// decided stands in files under [design] folder, so that a search that was stopped goes on, and runs of any other
// solver can be put in:
//
// - plan.csv: one row a design, with its name, the varied numbers, fidelity, why it was taken, "planned" or why it
//   cannot be; of one that a search chose also NAME_predicted and its sigma, of each objective and limit.
// - shapes/NAME.toml: the shape of each.
// - runs/FIDELITY/: the cases of OpenFOAM.
// - results.csv: one row a run, with design, varied numbers, conditions, fidelity, water, hash of the shape that was
//   varied, how the mesh was made, loads with NAME_sigma, state.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cases/design_spec.h"
#include "cases/design_table.h"
#include "cases/study.h"
#include "core/html.h"
#include "core/progress.h"
#include "core/table.h"
#include "surrogates/tables/search/sensitivity.h"
#include "surrogates/tables/search/surrogate.h"

namespace underbody::cases {

struct PlannedDesign {
    std::string name;        ///< "design-007"
    std::vector<double> at;  ///< SI, one a variable of the shape
    std::string fidelity;
    std::string why;    ///< "plan", "expected improvement ...", "typed"
    std::string state;  ///< "planned", or why there is no such shape
    /// By response: what the surrogates said when a search chose it, before it was computed. Empty for others.
    std::map<std::string, tables::ResponseValue> predicted;
    std::string predicted_of;  ///< Design::what_is_asked() at that time
};

/// Of what a run is beside its varied numbers. What is not known is not there.
struct RunOrigin {
    std::map<std::string, double> numbers;  ///< gap, pitch, speed, jet_flow, density, kinematic_viscosity; SI
    std::string shape;                      ///< hash of the shape whose numbers were varied, without them
    std::string mesh;                       ///< "blocks draft 800 iterations": how the mesh was made and solved on
    std::string moments = {};               ///< "base_centre" or "0 0 0.005 m": the point that its moments are about
};

/// Of the study's, what the cases of a search are made with.
struct DesignWater {
    std::optional<double> density;  ///< kg/m^3
    bool half = false;
    std::optional<std::array<double, 3>> moments_about;  ///< m, file axes; none: the centre of the base
};

/// Loads of one design at one condition.
struct DesignRun {
    std::string design;
    std::vector<double> at;  ///< SI, one of DesignSpec::all_variables()
    std::string fidelity;
    std::map<std::string, double> loads, sigmas;  ///< SI; by quantity; a sigma that nobody states is not there
    std::string state;                            ///< "solved", "not settled", or what failed
    RunOrigin origin;
    std::string other;      ///< what it is of that [design] does not ask for now: "speed: 1 m/s there, 0.5 m/s now"
    bool repeated = false;  ///< another row is of the same case, and counts
    [[nodiscard]] bool counts() const { return !repeated && other.empty(); }
    [[nodiscard]] bool usable() const { return state == "solved" && counts(); }
};

/// What a sensitivity is of: a load over the shape's variables and the conditions, or an objective or limit that is a
/// number of curves, over the shape's variables.
struct LearnedNumber {
    LearnedNumber(const tables::Surrogate& surrogate);  // NOLINT(google-explicit-constructor)
    LearnedNumber() = default;
    std::string name, unit;
    bool of_curves = false;
    std::vector<tables::SearchVariable> variables;
    std::function<double(std::span<const double>)> value;  ///< SI
    std::function<tables::ResponseValue(std::span<const double>)> with_error;
};

class Design {
public:
    /// Of a study with [design]. Reads plan and results where they are. Throws core::InputError: no [design], a plan or
    /// results of other variables than the study's (with the column), an unknown fidelity.
    static Design open(const Study& study);

    [[nodiscard]] const DesignSpec& spec() const { return spec_; }
    [[nodiscard]] const std::vector<PlannedDesign>& plan() const { return plan_; }
    [[nodiscard]] const std::vector<DesignRun>& runs() const { return runs_; }
    core::Problems notes;  ///< rows left out, and why

    /// Adds the first plan's designs that are not there yet (`points` of [design]; the sequence goes on where it was),
    /// writes their shapes and plan.csv. Returns how many are new.
    std::size_t make_plan(core::Progress& progress = core::Progress::none());
    /// Adds designs that a search chose, with what it predicts of them. One that is planned or computed on that
    /// fidelity already is not added again. Returns the names of all of them, in their order.
    std::vector<std::string> add(const std::vector<tables::Candidate>& candidates, const std::string& why);
    /// Adds the best designs on the finest fidelity, whatever the surrogates learned from: what they say there is a
    /// prediction, and this asks for its proof (verified_designs).
    std::vector<std::string> add_for_proof(std::vector<tables::Candidate> best);
    /// Solves what is planned and has no result with OpenFOAM here, `jobs` at a time, and reads loads into results.csv.
    /// A case that fails is kept as failed with its reason and the others go on; one whose loads have not settled is
    /// kept as "not settled". results.csv grows after each case. Rows that are there without a case in runs/FIDELITY
    /// stay as they are, and so do columns that the program does not know. Throws core::InputError (kind "changed")
    /// when results.csv was changed meanwhile.
    void solve(const Study& study, int jobs, core::Progress& progress = core::Progress::none());

    /// Throws core::InputError when there are too few runs, or [design] does not compute the quantity.
    [[nodiscard]] tables::Surrogate surrogate(const std::string& quantity,
                                              core::Progress& progress = core::Progress::none()) const;
    /// One a quantity.
    [[nodiscard]] std::map<std::string, tables::Surrogate> surrogates(
        core::Progress& progress = core::Progress::none()) const;
    /// The search that [design] asks for. Throws core::InputError without an objective.
    [[nodiscard]] tables::DesignSearch search(std::map<std::string, tables::Surrogate> surrogates) const;
    /// What was run, what failed, and what is planned and has no result, for the search.
    [[nodiscard]] tables::DesignSearch::NextOptions known() const;
    /// The box that a search in more than tables::trust_region_from variables keeps to: how the designs that it chose
    /// did, one after the other as they stand in the plan. None with fewer variables.
    [[nodiscard]] std::optional<tables::TrustRegion> trust_region(const tables::DesignSearch& search) const;
    /// The shape at a design. Throws core::InputError where there is none.
    [[nodiscard]] geometry::BodyShape shape_at(const std::vector<double>& at) const;
    /// Indices over its variables, of the mean.
    [[nodiscard]] tables::SobolIndices sensitivity(const LearnedNumber& number) const;

    /// Hash of the shape that is varied, of water, conditions, jet and the point of the moments, and of what objectives
    /// and limits are of: a prediction of others is no prediction of these.
    [[nodiscard]] std::string what_is_asked() const;

    [[nodiscard]] core::Table plan_table() const;
    [[nodiscard]] core::Table results_table(std::size_t first = 0) const;

private:
    void read_plan(const std::filesystem::path& file);
    void write_plan();
    void add_predictions(core::Table& table) const;
    bool write_shapes();  ///< true where a planned one turns out to be no shape
    [[nodiscard]] DesignRun* find(const DesignRun& run);
    void keep(const DesignRun& run);
    void write_results();
    void note_unknown_sigmas();
    void note_unsettled();
    void read_results(const std::filesystem::path& file);
    /// Of what a run at this place is that [design] asks for now.
    [[nodiscard]] RunOrigin origin_now(const std::vector<double>& at, const std::string& fidelity) const;
    DesignSpec spec_;
    geometry::BodyShape base_;
    DesignWater water_;
    std::vector<PlannedDesign> plan_;
    std::vector<DesignRun> runs_;
    DesignTable plan_file_, results_file_;
    bool rows_changed_ = false;  ///< results.csv has rows that say otherwise than runs_
};

/// Of all loads and all numbers of curves that [design] asks for. They point to nothing.
std::vector<LearnedNumber> learned_numbers(const Design& design,
                                           const std::map<std::string, tables::Surrogate>& surrogates);

/// The report: plan, fits with their check, sensitivities, the best, the front. `renderer` may be empty: no pictures.
std::string design_report(const Design& design, const FigureRenderer& renderer,
                          core::Progress& progress = core::Progress::none());

}  // namespace underbody::cases
