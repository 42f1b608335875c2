// A study: a folder with `study.toml`, the CFD files of its cases, models and measurements, and a store of results.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cases/design_spec.h"
#include "cases/step_results.h"
#include "cases/study_spec.h"
#include "core/error.h"
#include "core/figure.h"
#include "core/progress.h"
#include "core/table.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::core {
class TomlTable;
}

namespace underbody::cases {

/// What `study.toml` says, checked. Immutable.
class Study {
public:
    /// `folder` holds study.toml (or is its path). Throws core::InputError: file, line, column, hint.
    static Study open(const std::filesystem::path& folder);
    /// The same of a text that is not written yet; `file` is where it will stand.
    static Study from_text(const std::string& text, const std::filesystem::path& file);

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    std::string title;
    std::string summary;
    std::string origin;  ///< where the data come from, printed in the report
    std::string forward = "+x";
    std::string up = "+z";
    std::string symmetry;                                ///< "" or an axis: half models
    Conditions reference;                                ///< density, length, width, height, speed for coefficients
    std::optional<std::array<double, 3>> moments_about;  ///< m, file axes; none: the centre of the base
    std::vector<Case> cases;
    std::vector<BodySpec> bodies;
    std::vector<PictureSpec> pictures;
    std::vector<MeshSpec> mesh_uncertainties;
    std::vector<TableSpec> tables;
    std::vector<RegionSpec> regions;
    std::vector<MeasurementSpec> measurements;
    std::vector<VerifySpec> verifications;
    bool thesis = false;           ///< redraw the thesis's figures of chapters 7 and 8 and check its statements
    bool thesis_dynamics = false;  ///< check its statements on springs, sizes, voltages, releases and heading
    std::vector<CompareSpec> comparisons;
    std::optional<SweepSpec> sweep;
    std::optional<DesignSpec> design;
    core::Problems notes;  ///< what was left out on opening: cases of the sweep that are stale

    [[nodiscard]] std::vector<const Case*> select(const Conditions& where) const;
    /// kg/m^3 and m/s: the case's own, else those of [reference].
    [[nodiscard]] std::optional<double> density_of(const Case& entry) const;
    [[nodiscard]] std::optional<double> speed_of(const Case& entry) const;
    [[nodiscard]] const TableSpec* find_table(const std::string& name) const;

private:
    static Study read(const core::TomlTable& root, const std::filesystem::path& file);
    std::filesystem::path folder_;
};

/// The folder of the study at a path, which may be that of its study.toml.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// Draws a figure to PNG bytes; given by the program, so that this library needs no window system.
using FigureRenderer = std::function<std::string(const core::Figure&)>;

struct RunOptions {
    std::filesystem::path store;   ///< SQLite file; empty: STUDY/.underbody/store.sqlite
    std::filesystem::path report;  ///< HTML file; empty: STUDY/report/index.html
    FigureRenderer renderer;       ///< without one the report has no plots
    bool pictures = true;          ///< 3D pictures (need Xvfb)
    bool write_report = true;      ///< also exports and models, beside it
    bool as_stored = false;  ///< stored_results: also what files, options or code have made stale (StepState::changed)
};

enum class StepState {
    computed,
    unchanged,  ///< out of the store: what it rests on is as it was
    failed,
    changed,  ///< the store has an earlier one; what it rests on has changed since (stored_results only)
    missing,  ///< never made (stored_results only)
};
/// "computed", "unchanged", "failed", "changed", "not run"
std::string to_string(StepState state);

/// How far a step came.
struct StepResult {
    std::string kind;  ///< "loads", "table", "region", ...
    std::string name;
    StepState state = StepState::computed;
    std::string error;  ///< empty: done
};

/// A load, a moment or what goes with them, SI.
struct LoadValue {
    std::string name;  ///< "lift_force", "closure", ...
    std::string unit;
    double value = 0;
};

/// What is known of the loads of one case.
struct CaseLoads {
    std::size_t entry = 0;  ///< in Study::cases
    std::string name;       ///< of the case
    std::string file;       ///< relative to the study
    StepState state = StepState::missing;
    std::string error;                ///< of a failed one
    std::vector<LoadValue> values;    ///< empty unless computed or unchanged
    std::string settled = "unknown";  ///< "settled", "not settled", "unknown": postproc::Settled
    std::string settled_why;
    double base_pitch = NAN;                      ///< rad, how far the base is pitched in the file
    double body_length = NAN, body_height = NAN;  ///< m, of the body in the file; NaN: not known
    core::Problems warnings;  ///< what makes the numbers less than they seem: an open surface, no wall shear, ...
    std::int64_t id = 0;      ///< in the store
    std::string origin;       ///< digest over all that it was made from

    /// NaN when it is not known.
    [[nodiscard]] double value(const std::string& quantity) const;
};

class Store;

/// Everything a run made, for the report, the desktop and JSON.
struct StudyResults {
    std::vector<StepResult> steps;
    std::vector<CaseLoads> case_loads;  ///< one a case, in the order of the study
    core::Table loads;                  ///< one row a case that has loads: conditions, forces, moments, closure
    std::vector<std::pair<std::string, core::Table>> shape_loads;  ///< points by [[table]] of a shape
    std::vector<TableResult> tables;                               ///< one a step that gave one; likewise the others
    std::vector<MeshResult> meshes;
    std::vector<RegionResult> regions;
    std::vector<VerifyResult> verifications;
    std::vector<std::pair<std::string, std::string>> documents;  ///< "table/NAME" -> JSON text, "region/NAME" -> ...
    std::vector<std::pair<std::string, std::string>> pictures;   ///< "picture/NAME" -> PNG bytes
    std::filesystem::path report;
    std::size_t computed = 0;
    std::size_t reused = 0;
    std::size_t failed = 0;
    std::size_t changed = 0;
    std::size_t missing = 0;
    std::vector<std::string> notes;  ///< about the run as a whole: why all was computed again, ...
    std::shared_ptr<Store> store;    ///< nullptr when there is none

    [[nodiscard]] const std::string* document(const std::string& key) const;
    [[nodiscard]] const std::string* picture(const std::string& key) const;
    /// All that is known of the loads of a case, as JSON; empty when there are none.
    [[nodiscard]] std::string loads_document(const CaseLoads& loads) const;
    /// The warnings of all loads; those that many cases have alike once, unless `each`.
    [[nodiscard]] core::Problems gathered_warnings(bool each = false) const;
};

/// Runs what changed, reuses the rest, writes the report. A failed case does not stop the others: it is in `steps`.
StudyResults run_study(const Study& study, const RunOptions& options,
                       core::Progress& progress = core::Progress::none());

/// Only what the store holds already and what is still true (nothing is computed, nothing written): for opening a study
/// in the desktop.
StudyResults stored_results(const Study& study, const RunOptions& options);
/// The same of the loads alone.
StudyResults stored_loads(const Study& study, const RunOptions& options);
/// The study at a path and `case_loads` of that, without the table, and of their values the forces and their errors
/// alone: for lists of many cases, whose store is read while their folders are.
std::pair<Study, StudyResults> listed(const std::filesystem::path& path, const RunOptions& options);

/// How a [[table]] is fitted, wherever it is.
tables::FitOptions fit_options(const TableSpec& spec);

/// What a [[table]] of the study can be of: lift_force, pitch_moment ...; of half models what their halves do not
/// cancel.
std::vector<std::string> table_quantities(const Study& study);

/// The points of a [[table]], one row a case of `results.loads` that fits `where`: its axes, its quantity, the
/// conditions that all of them share, `case` and `settled`; and `QUANTITY_sigma` where an error is known of any point:
/// the standard uncertainty of the mesh study that the table names, the relative error that it states and the case's
/// own scatter from iteration to iteration (postproc::Settled), added in squares; empty (NaN) for a point of which none
/// is known. Of a table of a shape: the points that the surrogates gave, with their errors, and no `case`. Throws
/// core::InputError (missing): there are no loads, no case fits, a case lacks an axis or the quantity, the mesh study
/// failed or does not cover the quantity.
core::Table table_points(const TableSpec& spec, const StudyResults& results);
/// What a [[table]] is made of is there: loads of cases, or those of its shape.
bool has_loads(const TableSpec& spec, const StudyResults& results);
/// Of a table of a shape what its points rest on: "loads of 'x' by a surrogate over the 28 shapes of the search; not
/// CFD of this one", then how the surrogate does on shapes left out. Empty for a table of cases.
std::vector<std::string> basis_of(const TableSpec& spec, const StudyResults& results);
/// Smallest and largest value that a condition has in the cases of a table; nothing when none states it.
std::optional<std::pair<double, double>> range_in_cases(const TableSpec& spec, const StudyResults& results,
                                                        const std::string& condition);
/// Sentences about density and speed where they differ among the cases of a table that has no such axis.
std::vector<std::string> mixed_conditions(const TableSpec& spec, const StudyResults& results);
/// The speed that all these points have, m/s; nothing where it is an axis, differs or is not known.
std::optional<double> speed_of(const TableSpec& spec, const core::Table& points);

void to_json(nlohmann::json& json, const StudyResults& results);

}  // namespace underbody::cases
