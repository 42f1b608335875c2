// What the files of the stability region share.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/no_limit.h"
#include "surrogates/dynamics/basin/region.h"

namespace underbody::dynamics {

constexpr double first_motion_step = 0.02;  ///< s, of motions followed to their ends

/// A plant with its bounds and its judge of ends.
struct HeaveRegionSetup {
    HeavePlant plant;
    double contact_gap = 0, escape_gap = 0;
    std::unique_ptr<HeaveEnds> ends;
    HeaveRegionSetup(const Model& model, const RegionOptions& options, const std::vector<double>* start_gaps = nullptr);
};

/// The place along an axis at a share of its cells (0: lower end, 1: upper end).
double place_along(const core::NamedRange& axis, bool gap_by_ratio, double share);
/// Ends of starts given by their values along the two axes.
using RegionBatch = std::function<void(std::span<const double> x, std::span<const double> y, std::span<End> out)>;

/// Throws core::InputError for axes, sizes or a duration that cannot be.
void check_region_options(const RegionOptions& options);
/// Throws core::InputError where the axis of gaps begins below contact: such starts lie in the ground.
void check_gap_axis(const RegionOptions& options, double contact_gap);
/// One start at the centre of each cell. This and the next two ask `progress` row by row whether to go on.
std::vector<End> region_grid(const RegionOptions& options, const RegionBatch& batch,
                             const core::Progress& progress = core::Progress::none());
/// A map of these ends with the fractions of the area (cells beside another class count by a finer grid of starts
/// within them). Keeps attractors and the classes that occur; renumbers the cells.
StabilityRegion region_map(const RegionOptions& options, const RegionBatch& batch, const std::vector<End>& ends,
                           const std::vector<EndClass>& classes,
                           const core::Progress& progress = core::Progress::none());
/// Lines that part the classes of neighbouring starts, found by bisection between them (with options.refine) and
/// joined within each square of four starts. `ends`: classes of the grid before they are renumbered.
void add_traced_boundaries(StabilityRegion& region, const RegionOptions& options, const RegionBatch& batch,
                           const std::vector<End>& ends, const core::Progress& progress = core::Progress::none());
/// Share of the map's area where a force table is asked beyond its range.
double outside_share(const StabilityRegion& region);
/// The range of the force tables along the states that are axes of tables: "gap 0 to 0.1 m; pitch -4 to 4 deg".
std::string table_range_text(double gap_lower, double gap_upper, double pitch_lower = -core::no_limit,
                             double pitch_upper = core::no_limit);
/// Warning that a share of motions leaves the tables' range; nothing when none does.
void add_path_remark(core::Problems& remarks, double share, const std::string& range);
/// Warnings that starts, and motions, are beyond the force tables; from the region's fractions and ranges.
void add_outside_remarks(StabilityRegion& region);
/// Those of a motion, and how much of the map's starts and motions lies beyond a force table.
void add_model_remarks(StabilityRegion& region, const Model& model, const Conditions& held);

/// Of as many maps as `map.draws`, whose safe starts it holds the sum of: means; the area's from the sum of their safe
/// shares and of these shares' squares.
void take_mean(ProbabilityMap& map, double sum, double squares);

/// True when the motion asked for is that of heave and pitch together.
bool in_heave_and_pitch(const RegionOptions& options, const core::Table* starts = nullptr);
/// Regions of heave and pitch together: axes two of gap, heave_velocity, pitch, pitch_rate.
StabilityRegion pitch_region(const Model& model, const RegionOptions& options, core::Progress& progress);
/// Ends of given starts, the classes that they point at, and the range of the force tables in words.
struct FoundEnds {
    std::vector<End> ends;
    std::vector<EndClass> classes;
    std::string range;
};
FoundEnds pitch_ends_of_starts(const Model& model, const core::Table& starts, const RegionOptions& options,
                               core::Progress& progress);

}  // namespace underbody::dynamics
