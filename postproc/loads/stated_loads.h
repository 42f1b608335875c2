// Forces that a solver states of its own run - force reports, monitors, OpenFOAM's forces - and the loads against them.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "postproc/field/beside.h"
#include "postproc/loads/loads.h"
#include "postproc/loads/uncertainty.h"

namespace underbody::postproc {

enum class LoadPart { total, pressure, viscous };

/// One number that a solver states: a force along a direction, or a moment about an axis through a point.
struct StatedLoad {
    std::string file;                ///< where it stands
    std::string quantity;            ///< "lift_force", ... or "force along (1, 0, 0)": for people and for sigmas
    std::vector<std::string> zones;  ///< what it covers, by name; empty: the whole body
    bool zones_unknown = false;      ///< the file does not say what it covers: taken for the whole body
    LoadPart part = LoadPart::total;
    bool moment = false;
    Vector direction{};          ///< unit vector, file axes
    Vector centre{};             ///< m, file axes: point of a moment
    double value = 0;            ///< N or N m; of a history: its value at the field's time, or its last
    std::optional<double> time;  ///< of that value (s, or iteration), where the file says
    std::size_t earlier = 0;     ///< how often the same file stated it before, of other iterations
    std::size_t later = 0;       ///< rows of a monitor behind the field's time
    std::optional<IterationScatter> history;
};

/// A monitor that the user names: which quantity a column of which file is.
struct MonitorSource {
    std::string quantity;  ///< one of the six named loads, lift_force to yaw_moment
    bool coefficient =
        false;         ///< the column holds it over the solver's reference force (moments: times its reference length)
    std::string unit;  ///< of the column, as UDUNITS-2 reads it; empty: SI
    double scale = 1;  ///< number before the unit: "2.4 N" turns a coefficient into a force
    std::string file;
    std::string column;  ///< may be empty when there is only one
};

/// "lift_force=lift.out", "drag_force [lbf]=report.out:drag", "lift_coefficient=cl.out". Throws core::UsageError for
/// anything else, with the nearest name.
MonitorSource monitor_source(const std::string& text);

/// Every row of the force and moment reports in a text (Fluent's "Forces - Direction Vector ..."), totals and parts. Of
/// reports of the same quantity on the same zones (a transcript of a run that reports now and then) the last counts.
/// Throws core::InputError: no report in the file, a direction without length.
std::vector<StatedLoad> stated_in_report(const std::filesystem::path& path);

/// A column of a report file (.out, .csv) as one of the named loads of `result`, moments about its reference point.
/// Where the field has a time, up to that: by the monitor's column of times, or where it counts iterations by the one
/// of that number (OpenFOAM's steady time); else to the end. Coefficients become forces by the reference values in the
/// monitor's own heading (OpenFOAM), else by those that the CFD file states (Fluent). Throws core::InputError: no such
/// column, a history too short to judge, reference values of coefficients that nobody states.
StatedLoad stated_by_monitor(const MonitorSource& source, const LoadsResult& result);

/// The forces that OpenFOAM wrote beside the case (see read_openfoam_forces), as the named loads of `result` with
/// their histories up to the time of the field (the nearest row; the last where the field has no time); moments are
/// moved from OpenFOAM's centre to the reference point of `result`, one instant at a time.
std::vector<StatedLoad> stated_by_openfoam(const std::filesystem::path& case_folder, const LoadsResult& result);

/// What lies beside a CFD file and states forces: OpenFOAM's postProcessing, and texts that begin with the file's
/// stem (STEM.txt, STEM-forces.out ...), with that of no other CFD file of the folder that is longer, and hold a force
/// report. Empty when there is nothing.
std::vector<StatedLoad> stated_beside(const std::filesystem::path& file, const LoadsResult& result);

/// A load against what somebody states of it.
struct Comparison {
    std::string file;       ///< the CFD file
    std::string quantity;   ///< "lift_force", "pressure part of the force along (1, 0, 0) on 'hull'"
    std::string stated_in;  ///< the report; empty: the conditions (manifest)
    double value = 0;
    double stated = 0;    ///< of the whole body: doubled where the report is of a half model
    double of_force = 0;  ///< their deviation (deviation.h)
    std::string hint{};   ///< what may be behind a large deviation: the other sign, half a body
};

void to_json(nlohmann::json& json, const Comparison& comparison);

/// The loads against the solver's own. A half model (loads with a symmetry plane) was a half model in the solver too:
/// its numbers are doubled, and what both halves cancel is left out; `notes` says so, and which rows name zones that
/// were not integrated, how many reports of one quantity there are, where the field's time is not among those of a
/// history, and where nobody says which zones the forces are of.
std::vector<Comparison> compare_with_solver(const LoadsResult& result, const std::vector<StatedLoad>& stated,
                                            core::Problems& notes);

/// Named load -> standard uncertainty by iteration, of the whole body: from the histories among `stated`.
std::vector<std::pair<std::string, double>> iteration_sigmas(const LoadsResult& result,
                                                             const std::vector<StatedLoad>& stated);

}  // namespace underbody::postproc
