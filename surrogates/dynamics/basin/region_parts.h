// What the files of the stability region share.
#pragma once

#include <functional>

#include "surrogates/dynamics/basin/region.h"

namespace underbody::dynamics {

/// A plant with its bounds and its judge of ends.
struct HeaveRegionSetup {
    HeavePlant plant;
    double contact_gap = 0, escape_gap = 0;
    std::unique_ptr<HeaveEnds> ends;
    HeaveRegionSetup(const Model& model, const RegionOptions& options, const std::vector<double>* start_gaps = nullptr);
};

/// Ends of starts given by their values along the two axes.
using RegionBatch = std::function<void(std::span<const double> x, std::span<const double> y, std::span<End> out)>;

/// Throws core::InputError for axes, sizes or a duration that cannot be.
void check_region_options(const RegionOptions& options);
/// One start at the centre of each cell.
std::vector<End> region_grid(const RegionOptions& options, const RegionBatch& batch);
/// Fractions of the area: cells beside another class count by a finer grid of starts within them.
std::vector<double> region_fractions(const RegionOptions& options, const RegionBatch& batch,
                                     const std::vector<End>& ends, std::size_t classes);
/// Keeps attractors and the classes that occur; renumbers the cells.
void keep_seen_classes(StabilityRegion& region, const std::vector<EndClass>& all, const std::vector<double>& sums);
/// Lines that part the classes of neighbouring starts, found by bisection between them (with options.refine) and
/// joined within each square of four starts. `ends`: classes of the grid before they are renumbered.
void add_traced_boundaries(StabilityRegion& region, const RegionOptions& options, const RegionBatch& batch,
                           const std::vector<End>& ends);
/// Share of the map's area where a force table is asked beyond its range, and the warning that says so.
double outside_share(const StabilityRegion& region);
void add_outside_remark(StabilityRegion& region);

/// True when the motion asked for is that of heave and pitch together.
bool in_heave_and_pitch(const RegionOptions& options, const core::Table* starts = nullptr);
/// Regions of heave and pitch together: axes two of gap, heave_velocity, pitch, pitch_rate.
StabilityRegion pitch_region(const Model& model, const RegionOptions& options, core::Progress& progress);
std::vector<End> pitch_ends_of_starts(const Model& model, const core::Table& starts, const RegionOptions& options,
                                      std::vector<EndClass>& classes, core::Progress& progress);

}  // namespace underbody::dynamics
