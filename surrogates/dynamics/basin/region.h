// Stability regions: for each start, where the motion ends.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/no_limit.h"
#include "core/progress.h"
#include "core/table.h"
#include "core/units.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave.h"

namespace underbody::dynamics {

enum class EndKind { attractor, contact, escape, cycle, undecided };
const char* end_kind_name(EndKind kind);

/// One possible end of a motion.
struct EndClass {
    std::string name;  ///< "A" (attractors, from the ground up), "contact", "escape", "about A" (cycle), "undecided"
    EndKind kind = EndKind::undecided;
    double gap = std::numeric_limits<double>::quiet_NaN();  ///< of an attractor, m
    double fraction = 0;                                    ///< of the area of starts
    double outside = 0;  ///< of the area of starts: those of them whose motion leaves the range of a force table
};

/// Where a start ends: an index into a list of classes, and when that was decided.
struct End {
    int index = 0;
    double time = 0;  ///< s: of contact or escape; for an attractor, when the motion could no longer leave its well
    bool outside = false;  ///< from its start to its end the motion was somewhere beyond the range of a force table
};

struct HeaveFeedback;  // surrogates/dynamics/simulate/feedback.h
struct PitchFeedback;  // surrogates/dynamics/simulate/heave_pitch.h

struct RegionOptions {
    std::vector<core::NamedRange> axes;  ///< two of: gap, heave_velocity, pitch, pitch_rate (SI)
    std::size_t columns = 200, rows = 200;
    Conditions held;          ///< conditions and the states that are not axes (default: pitch and velocities 0)
    double duration = 60;     ///< s
    double tolerance = 1e-8;  ///< relative to the size of the axes
    double escape_gap =
        std::numeric_limits<double>::quiet_NaN();  ///< NaN: upper end of the tables or of the axes, whichever is higher
    bool refine = true;                            ///< areas refined below the grid
    std::shared_ptr<const HeaveFeedback> feedback;        ///< heave: the loop closed by it; none: open loop
    std::shared_ptr<const PitchFeedback> pitch_feedback;  ///< heave and pitch: likewise
    /// Which equations: automatic takes heave and pitch where an axis (or a column of starts) is pitch or pitch_rate.
    enum class Motion { automatic, heave, heave_pitch };
    Motion motion = Motion::automatic;
    bool through_contact =
        false;  ///< heave and pitch: go on after a touch; contact is then to come to rest on the ground
    /// Cells along gap of equal ratio, not of equal width, for maps that are drawn over a logarithmic gap. Fractions
    /// stay shares of the area. The gap begins above nought then.
    bool gap_by_ratio = false;
};

struct RegionBoundary {
    std::string name;          ///< of the saddle whose stable manifold it is, or "A | contact"
    std::vector<double> x, y;  ///< along the two axes, SI
};

struct StabilityRegion {
    std::vector<core::NamedRange> axes;
    std::size_t columns = 0, rows = 0;
    bool gap_by_ratio = false;      ///< as in RegionOptions
    std::vector<int> index;         ///< [row * columns + column]: class of the start at the cell's centre
    std::vector<float> time;        ///< s, likewise
    std::vector<EndClass> classes;  ///< only those that occur, plus every attractor there is
    std::vector<HeaveEquilibrium> equilibria;
    std::vector<RegionBoundary> boundaries;
    double duration = 0;
    double contact_gap = 0, escape_gap = 0;
    double outside_fraction = 0;              ///< share of starts outside the range of a force table
    double path_outside_fraction = 0;         ///< share of starts whose motion is outside it anywhere
    double table_lower = 0, table_upper = 0;  ///< m, gaps that every force table covers
    double pitch_lower = -core::no_limit, pitch_upper = core::no_limit;  ///< rad, likewise
    std::string model;
    std::string rule;  ///< how the end of an attractor's starts was decided
    Conditions held;
    core::Problems remarks;
    /// Among the remarks: motions counted as escapes are pulled back; nothing where none is.
    std::optional<core::Problem> escapes_return;
    std::vector<double> flow_x, flow_y, flow_dx, flow_dy;  ///< arrows of the motion, SI

    [[nodiscard]] double fraction(const std::string& class_name) const;
    [[nodiscard]] std::size_t count(EndKind kind) const;
};

/// Decides ends in heave for one plant. Immutable, safe to use from many threads. The plant must live longer.
///
/// With inputs held and forces that depend on gap and velocity, E = 1/2 M(h) w^2 - integral of the static force dh
/// never grows where the resistance opposes the motion (dE/dt = -w R(w)). A motion with less energy than the lower rim
/// of the well it is in can never leave it and ends at the well's equilibrium (LaSalle): it is decided then. Otherwise
/// an explicit Runge-Kutta pair (Dormand and Prince 1980) goes on to contact, escape or the end of the time. Where the
/// well is wider than the force tables, the motion is followed until it left them or lacks the energy to.
class HeaveEnds {
public:
    HeaveEnds(const HeavePlant& plant, double contact_gap, double escape_gap, double duration, double tolerance,
              double gap_size, double velocity_size);
    ~HeaveEnds();
    [[nodiscard]] End of(double gap, double velocity) const;
    /// Starts in parallel; out has one End a start.
    void of(std::span<const double> gap, std::span<const double> velocity, std::span<End> out,
            core::Progress& progress = core::Progress::none()) const;
    /// All classes this plant can show; End::index points here.
    [[nodiscard]] const std::vector<EndClass>& classes() const;
    [[nodiscard]] const std::vector<HeaveEquilibrium>& equilibria() const;
    /// "energy" when the argument above holds, else "settled".
    [[nodiscard]] const std::string& rule() const;

    struct Impl;

private:
    std::unique_ptr<Impl> impl_;
};

/// Throws core::InputError: axes that are not two known states, an axis outside sense, a model without what the motion
/// needs.
StabilityRegion stability_region(const Model& model, const RegionOptions& options,
                                 core::Progress& progress = core::Progress::none());

/// Regions for a range of one condition or held state (jet_voltage, speed, pitch, heave_velocity, ...).
struct RegionSweep {
    std::string name;
    std::vector<double> value;
    std::vector<StabilityRegion> regions;
};
RegionSweep swept_regions(const Model& model, const RegionOptions& options, const core::NamedRange& range,
                          std::size_t count, core::Progress& progress = core::Progress::none());
/// Area of each kind of end against what was swept.
core::Figure sweep_figure(const RegionSweep& sweep);

/// Where given starts end.
struct StartEnds {
    /// Columns of the starts that are states (others kept), plus `class`, `kind`, `time` and `outside_table` (1: the
    /// motion is at some time beyond the range of a force table).
    core::Table table;
    std::vector<EndClass> classes;  ///< fractions are those of the starts
    core::Problems remarks;         ///< of the motion, and how many starts leave the force tables
};
StartEnds ends_of_starts(const Model& model, const core::Table& starts, const RegionOptions& options,
                         core::Progress& progress = core::Progress::none());

/// One row a start of the map: its two states, class, kind, time.
core::Table region_table(const StabilityRegion& region);

/// The map: classes, boundary, flow, equilibria, in mm and mm/s.
core::Figure region_figure(const StabilityRegion& region);
/// Boundaries of several variants on one plot; all must have the same axes.
core::Figure region_overlay_figure(const std::vector<StabilityRegion>& regions, const std::vector<std::string>& names);
void to_json(nlohmann::json& json, const StabilityRegion& region);

/// Chance that a start is safe when the force tables are uncertain: the share of `draws` of the tables
/// (ForceTable::drawn) after which it ends at an attractor.
struct ProbabilityMap {
    std::vector<core::NamedRange> axes;
    std::size_t columns = 0, rows = 0;
    std::vector<float> safe;               ///< [row * columns + column], 0 to 1
    double area_mean = 0, area_sigma = 0;  ///< safe fraction of the area over the draws
    double path_outside_fraction = 0;      ///< share of the motions of all draws that leave the range of a force table
    std::size_t draws = 0;
    bool gap_by_ratio = false;  ///< as in RegionOptions
    core::Problems remarks;
};
ProbabilityMap probability_map(const Model& model, const RegionOptions& options, std::size_t draws, std::uint64_t seed,
                               core::Progress& progress = core::Progress::none());
core::Figure probability_figure(const ProbabilityMap& map);
void to_json(nlohmann::json& json, const ProbabilityMap& map);

/// The largest axis-parallel ellipse about an equilibrium in which every start of the map ends there, and the largest
/// box; centred on the equilibrium, SI, along the first and second axis of the map.
struct SafeSet {
    std::string equilibrium;
    std::array<std::string, 2> axes;
    std::array<double, 2> centre{}, ellipse{}, box{};  ///< half lengths of ellipse and box
};
SafeSet largest_safe_set(const StabilityRegion& region, const std::string& equilibrium);
void to_json(nlohmann::json& json, const SafeSet& set);

}  // namespace underbody::dynamics
