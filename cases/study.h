// A study: a folder with `study.toml`, the CFD files of its cases, models and measurements, and a store of results.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cases/case_mesh.h"
#include "cases/design_spec.h"
#include "cases/step_results.h"
#include "core/error.h"
#include "core/figure.h"
#include "core/progress.h"
#include "core/table.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::core {
class TomlTable;
}

namespace underbody::cases {

/// Conditions of a case or a selection: numbers in SI, and words ("variant" = "ellipse").
struct Conditions {
    std::vector<std::pair<std::string, double>> numbers;
    std::vector<std::pair<std::string, std::string>> texts;
    /// Of numbers that are no quantity the program knows: the user's own words.
    struct OwnUnit {
        std::string name;
        std::string si;       ///< of the number
        std::string written;  ///< as the user wrote it
    };
    std::vector<OwnUnit> own_units;

    /// Sets a number, in place of one of that name; `written`: the unit that it was written in, of a word of the
    /// user's own.
    void set(const std::string& name, double value, const std::string& written = {});
    /// SI unit of a number of that name: the known quantity's, the one that the user gave it, else "1".
    [[nodiscard]] std::string unit(const std::string& name) const;
    /// The unit to show it in: gap in mm, pitch in deg, the user's own words as written.
    [[nodiscard]] std::string shown_unit(const std::string& name) const;
    [[nodiscard]] std::optional<double> number(const std::string& name) const;
    [[nodiscard]] std::optional<std::string> text(const std::string& name) const;
    /// True if every condition of `wanted` holds here (numbers to 1e-9 relative); a text with a unit ("3 mm") is held
    /// against a number in its unit.
    [[nodiscard]] bool satisfies(const Conditions& wanted) const;
    /// "ellipse, gap 5 mm, pitch 0 deg" for people.
    [[nodiscard]] std::string label() const;
};

/// SI unit of a number in the conditions of a case: of a known quantity, and of the density of its water; none: a word
/// of the user's own.
std::optional<std::string> condition_unit(const std::string& name);

/// "variant=ellipse, gap=5mm", as on the command line: known quantities with units (SI without), other words as they
/// are. Throws core::UsageError: a part that is not name=value, a unit of another dimension, a name given twice.
Conditions conditions_from(const std::string& text);

/// One CFD case of the study.
struct Case {
    /// File name without folder and ending, of an OpenFOAM case its folder's; where several would be called so, with as
    /// many folders before it as tell them apart. Unique in the study.
    std::string name;
    std::filesystem::path file;  ///< or the folder of an OpenFOAM case
    Conditions conditions;
    std::vector<std::string> zones;  ///< patterns of the zones that are the body; empty: all walls
    /// What the file does not say, by whoever knows: unit of its coordinates, and of variables by their name there.
    std::string length_unit;
    std::vector<std::pair<std::string, std::string>> units;
    bool mean = false;  ///< one instant of a run in time: the files that differ in their time alone count as their mean
};

/// [[body]]
struct BodySpec {
    std::string name;
    std::filesystem::path shape;  ///< SHAPE.toml
};

/// [[picture]]: views of some cases.
struct PictureSpec {
    std::string name;
    Conditions where;
    std::vector<std::string> views;  ///< as postproc::possible_views names them: "pressure-underbody", ...; empty: all
    std::optional<std::pair<double, double>>
        range;  ///< Pa, of the colours of pressure, so that pictures can be compared
};

/// [[mesh_uncertainty]]: cases that differ in their mesh only.
struct MeshSpec {
    std::string name;
    Conditions where;                                   ///< selects the group
    std::string column = "mesh";                        ///< the word that tells the meshes apart
    std::vector<std::pair<std::string, double>> cells;  ///< cells of each mesh
    std::vector<std::string> quantities;
};

/// [[table]]: a force table made of cases.
struct TableSpec {
    std::string name;
    std::string quantity;           ///< lift_force, ...
    std::vector<std::string> axes;  ///< gap, pitch, ...
    Conditions where;
    std::string fit = "automatic";  ///< how the table is fitted (tables::fit_kind), here, in its exports and in the
                                    ///< maps of [[region]]
    double speed_exponent =
        2;  ///< of the force in a [[region]], when all its cases have one speed: (speed / that speed)^exponent
    double relative_sigma = 0;         ///< of the value, added in squares
    std::string mesh_uncertainty;      ///< name of the [[mesh_uncertainty]] whose standard uncertainty the points carry
    std::optional<double> net_weight;  ///< N: equilibria are found for it
    double virtual_mass = 0;           ///< kg, for frequency and kick
    std::vector<std::string> exports;  ///< formats
};

/// [[region]]
struct RegionSpec {
    std::string name;
    std::filesystem::path model;
    std::vector<std::string>
        forces;  ///< names of [[table]]: added to the model as force sources with their axes, fit and speed_exponent
    std::string axes;      ///< as on the command line: "gap=1mm:100mm,heave_velocity=-0.1:0.1"
    double duration = 60;  ///< s
    int columns = 400;
    int rows = 400;
};

/// [[measurement]]
struct MeasurementSpec {
    std::string name;
    std::filesystem::path model;
    std::filesystem::path data;
    bool discover = false;  ///< close the loop, not only the residual
};

/// [[compare]]: tables over one axis, laid over each other.
struct CompareSpec {
    std::string name;
    std::vector<std::string> tables;
};

/// [[verify]]: a table of the solver's own forces, one row a case.
struct VerifySpec {
    std::string name;
    std::filesystem::path table;
    Conditions where;  ///< only cases that fit
    std::vector<std::string> quantities;
    double tolerance =
        0.01;  ///< of the force's size; a column QUANTITY_scatter of the report widens it by twice itself
};

/// [sweep.slurm]: how the site wants its jobs. Texts are Slurm's own, empty ones leave it to the site.
struct SlurmSpec {
    std::string partition;
    std::string time;    ///< "02:00:00", "1-12"
    std::string memory;  ///< "4G"
    std::string account;
    int throttle = 0;                  ///< tasks at a time; 0: as many as there is room for
    int max_array = 0;                 ///< tasks in one array; 0: ask scontrol
    int cores = 1;                     ///< of one case, by MPI
    int retries = 0;                   ///< of a case whose solver was ended or failed
    bool run_study = false;            ///< a job that runs the study when the arrays have ended
    std::vector<std::string> options;  ///< further ones, "--nice=100"
};

/// [sweep]: cases to be made by CFD, every body at every gap, pitch and speed.
struct SweepSpec {
    std::string folder;             ///< of the cases, relative to the study
    std::vector<BodySpec> bodies;   ///< those of [[body]] that are named, or all
    std::vector<double> gaps;       ///< m
    std::vector<double> pitches;    ///< rad
    std::vector<double> speeds;     ///< m/s
    std::vector<double> jet_flows;  ///< m^3/s through the nozzle; empty: no jet
    Conditions conditions;          ///< further conditions of these cases (mesh = "coarse")
    double kinematic_viscosity = 1e-6;
    CaseMesh mesh;
    SlurmSpec slurm;
};

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
    std::vector<TableResult> tables;    ///< one a step that gave one; likewise the others
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
/// `case_loads` of that, without the table: for lists of many cases.
StudyResults stored_case_loads(const Study& study, const RunOptions& options);

/// How a [[table]] is fitted, wherever it is.
tables::FitOptions fit_options(const TableSpec& spec);

/// The points of a [[table]], one row a case of `results.loads` that fits `where`: its axes, its quantity, the
/// conditions that all of them share, `case` and `settled`; and `QUANTITY_sigma` where an error is known of any point:
/// the standard uncertainty of the mesh study that the table names, the relative error that it states and the case's
/// own scatter from iteration to iteration (postproc::Settled), added in squares; empty (NaN) for a point of which none
/// is known. Throws core::InputError (missing): there are no loads, no case fits, a case lacks an axis or the quantity,
/// the mesh study failed or does not cover the quantity.
core::Table table_points(const TableSpec& spec, const StudyResults& results);
/// Smallest and largest value that a condition has in the cases of a table; nothing when none states it.
std::optional<std::pair<double, double>> range_in_cases(const TableSpec& spec, const StudyResults& results,
                                                        const std::string& condition);
/// Sentences about density and speed where they differ among the cases of a table that has no such axis.
std::vector<std::string> mixed_conditions(const TableSpec& spec, const StudyResults& results);
/// The speed that all these points have, m/s; nothing where it is an axis, differs or is not known.
std::optional<double> speed_of(const TableSpec& spec, const core::Table& points);

void to_json(nlohmann::json& json, const StudyResults& results);

}  // namespace underbody::cases
