// What the window shows, as one immutable value: only actions make a new one (actions.h), everything on screen is drawn
// from it. Numbers are SI. No Qt here: the same state is replayed without a window.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "geometry/body/body_shape.h"
#include "geometry/body/variants.h"
#include "studio/desktop/state/session.h"

namespace underbody::studio {

/// A shape with some of its parameters changed: parameter -> value as written ("2 mm").
using ShapeChanges = std::map<std::string, std::string>;

/// A shape that was made in the window: another one with changes.
struct KeptVariant {
    std::string of;
    ShapeChanges set;
    bool operator==(const KeptVariant&) const = default;
};

/// How a force table is looked at.
struct TableView {
    std::optional<double> net_weight;    ///< N; none: as the study says
    std::optional<double> virtual_mass;  ///< kg
    std::string shown;                   ///< "curve gap", "family gap pitch", "map gap pitch"; empty: the first
    std::map<std::string, double> held;  ///< axes that are not drawn
    std::optional<bool> logarithmic;     ///< none: where the axis spans decades
    std::vector<std::string> beside;     ///< other views, as `shown`, in cells of their own
    bool operator==(const TableView&) const = default;
};

/// A stability map with numbers of its model changed.
struct RegionView {
    std::map<std::string, double> set;           ///< declared parameters, SI
    int cells = 200;                             ///< starts a side
    std::string show = "ends";                   ///< "ends", "probability", "sweep", "estimator"
    std::vector<std::string> beside;             ///< other kinds of map, in cells of their own
    std::string axes;                            ///< "gap=1mm:20mm,pitch=-3deg:3deg"; empty: as the study says
    std::string feedback;                        ///< "gap_gain=10,reference=20mm": the loop closed by it; empty: open
    std::string sweep;                           ///< "jet_voltage=0:10": what the maps of a sweep differ in
    int steps = 5;                               ///< maps of the sweep
    std::optional<bool> logarithmic;             ///< gap axis; none: where it spans decades
    int draws = 30;                              ///< of the tables, for the probability
    double gap_noise = 2e-4;                     ///< m, one standard deviation of a reading: for the estimator
    double velocity_noise = 0;                   ///< m/s; 0: the heave velocity is not measured
    double drag_error = 0.2;                     ///< relative deviation of the declared drag law
    std::optional<double> duration;              ///< s; none: as the study says
    std::optional<std::array<double, 2>> start;  ///< gap (m) and heave velocity (m/s) of the motion that is shown
    std::map<std::string, double> start_of;      ///< of a map over other axes: state -> SI
    bool operator==(const RegionView&) const = default;
};

/// What somebody said of a file from outside the study that it does not say itself.
struct FileReading {
    std::string length_unit;                   ///< of its coordinates
    std::map<std::string, std::string> units;  ///< of variables by their name in the file
    std::string symmetry;                      ///< plane of a half model ("y", "y=0.1"); empty: a whole body
    std::optional<double> density;             ///< kg/m^3, of files that hold pressure over density
    std::vector<std::string> zones;            ///< patterns of the zones that are the body
    bool operator==(const FileReading&) const = default;
};

/// A 3D view as a hand turned it: from where (x, y, z, m), at what (m), what is up, half the height that is seen (m;
/// counts without perspective), in the axes of the file or shape.
using ViewPose = std::array<double, 10>;

/// How fields are looked at: one array, range, camera and set of zones for all cells.
struct FieldView {
    std::string array = "pressure";
    bool whole_range = false;
    bool edges = false;
    std::optional<bool> mirror;                  ///< none: half models are mirrored
    std::optional<std::array<double, 2>> range;  ///< of the colours; none: of what is seen
    bool difference = false;                     ///< to the first case
    std::string view = "surface";                ///< or a picture of postproc::view_kinds: planes, streamlines
    std::optional<double> time;                  ///< s, of files with several; none: the last
    std::string camera = "iso";                  ///< "bottom", "top", "side", "front", "iso"
    std::optional<ViewPose> turned;              ///< by hand; none: from `camera`, all of it
    std::map<std::string, bool> zones;           ///< ticked by hand
    std::optional<std::array<double, 3>> probe;  ///< m, file axes: where values are read off
    bool operator==(const FieldView&) const = default;
};

struct ExploreView {
    std::string x = "gap";
    std::string y = "lift_force";
    std::map<std::string, std::array<double, 2>> brush;  ///< column -> kept range, SI
    std::vector<std::string> order;                      ///< axes of the lines from the left; the others follow
    std::vector<geometry::Vary> vary;                    ///< of the shape that Design shows
    bool shapes = false;                                 ///< these shapes are explored, not the cases
    bool pictures = false;                               ///< in front of the points
    std::string picture;                                 ///< of each case, by its view; empty: the first
    bool operator==(const ExploreView&) const = default;
};

struct DesignView {
    std::string shape;
    double gap = 0.005;                           ///< m
    double pitch = 0;                             ///< rad, nose up
    double speed = 0.5;                           ///< m/s
    std::map<std::string, ShapeChanges> changes;  ///< of each shape that was changed
    std::map<std::string, KeptVariant> variants;
    ShapeChanges before;  ///< what the results are compared with, of `before_shape`
    std::string before_shape;
    bool map = false;                ///< the stability map is in front of the lift, where there is room for one of them
    bool outline = true;             ///< of the body before, around the one of now
    std::optional<ViewPose> turned;  ///< by hand; none: obliquely from below, all of it
    bool operator==(const DesignView&) const = default;
};

/// A file that was exported for a controller, and how.
struct ExportRecord {
    std::string table;    ///< [[table]] of the study
    std::string made_of;  ///< table_digest when it was written
    std::string written;  ///< hash of the file as it was written; empty: not known
    std::string format = "c", name, frame = "up", number = "double";
    std::optional<double> max_error;           ///< share of the range
    std::map<std::string, std::string> range;  ///< axis -> policy beyond its ends
    bool operator==(const ExportRecord&) const = default;
};

/// A measurement that was taken into the study.
struct MeasuredRecord {
    std::string model;                  ///< absolute
    std::vector<std::string> data;      ///< absolute: a data set's folder, logs, tables
    std::vector<std::string> channels;  ///< "gap=RFND/Dist:cm"
    std::string clock;                  ///< "t_ms:ms"; empty: the log's own time, the column time
    bool operator==(const MeasuredRecord&) const = default;
};

struct State {
    std::string study;               ///< folder, absolute; empty: none
    std::vector<std::string> files;  ///< from outside the study: "field:PATH", "shape:PATH"
    std::string workspace = "design";
    std::vector<std::string> selection;  ///< "case/NAME", "shape/NAME", "table/NAME", ...
    /// What was last selected of each kind, which a workspace shows while something of another kind is selected.
    std::map<std::string, std::vector<std::string>> last;
    std::set<std::string> stars;
    /// Workspace -> those of its views that are shown; missing: all of them.
    std::map<std::string, std::vector<std::string>> cells;
    DesignView design;
    FieldView fields;
    std::map<std::string, FileReading> readings;  ///< by path, absolute
    ExploreView explore;
    std::map<std::string, TableView> tables;
    std::map<std::string, RegionView> regions;
    std::set<std::string> accepted;               ///< measurements whose found model counts as theirs
    std::map<std::string, ExportRecord> exports;  ///< by path, absolute
    std::map<std::string, MeasuredRecord> measured;
    bool operator==(const State&) const = default;

    /// Names of the selected things of a kind ("case"), in the order in which they were chosen.
    [[nodiscard]] std::vector<std::string> selected(const std::string& kind) const;
    /// The first of those last selected of a kind ("table", "region", ...) when it is among `known`, else the first of
    /// `known`; empty when there is none.
    [[nodiscard]] std::string current(const std::string& kind, const std::vector<std::string>& known) const;
    /// Whether a view `of` a workspace is shown.
    [[nodiscard]] bool shows(const std::string& of, const std::string& view) const;
};
using StatePointer = std::shared_ptr<const State>;

/// The six workspaces, in the order of their keys.
const std::vector<std::string>& workspace_names();

/// A view of a workspace, which has a cell there.
struct WorkspaceView {
    std::string name;   ///< as in `cells design body section`
    std::string title;  ///< for people
};
/// The views of a workspace, in the order of their cells.
const std::vector<WorkspaceView>& workspace_views(const std::string& workspace);

/// What a file that is written of the workspace may be called, without an ending: "design-ellipse", "compare-pressure".
std::string proposed_name(const State& state, const Session& session);

/// Equal for equal states.
std::string state_hash(const State& state);

/// The shape of that name with its changes, or a kept variant; checked. Throws core::InputError: no such shape, a
/// parameter that cannot be (geometry::check).
geometry::BodyShape shape_of(const State& state, const Session& session, const std::string& name);
/// The same with other changes than those of the state.
geometry::BodyShape shape_with(const State& state, const Session& session, const std::string& name,
                               const ShapeChanges& changes);
/// The shape that Design shows: the chosen one, else the first; empty when there is none.
std::string shown_shape(const State& state, const Session& session);
/// Names of all shapes: of the study, from outside, kept.
std::vector<std::string> shape_names(const State& state, const Session& session);

void to_json(nlohmann::json& json, const State& state);
/// Keys that are missing keep their defaults. Throws core::InputError for one of the wrong kind.
State state_from_json(const nlohmann::json& json);

}  // namespace underbody::studio
