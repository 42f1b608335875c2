// Values of a field at points, on lines and planes, and what flows through the gap.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "core/table.h"

namespace underbody::postproc {

struct Field;

struct ProbeOptions {
    std::vector<std::string> arrays;  ///< canonical names; empty: all
    std::vector<std::string> zones;   ///< surfaces to look on (no volume, or `on_surface`); empty: all
    bool on_surface = false;          ///< look on surfaces although there is a volume
};

/// Columns x, y, z [m], then each array (vectors as NAME_x, NAME_y, NAME_z), in SI; one whose unit the file does not
/// say is a column of text without a unit.
///
/// In a volume: between the nodes of the cell that holds the point; values that lie in cells are first carried to the
/// nodes along their gradients (`NodeValues`: a linear field comes out as it is, and a wall's own values hold at the
/// wall). A point outside has missing values. On surfaces: the nearest face, and a column `distance_to_surface [m]`;
/// arrays that the zone of that face does not have are missing.
/// Throws core::InputError: an array or a zone that nobody knows, a field without cells or without values;
/// core::UsageError: zones, though it is a volume that is looked into.
core::Table probe_points(const Field& field, const std::vector<std::array<double, 3>>& points,
                         const ProbeOptions& options = {}, core::Progress& progress = core::Progress::none());

/// `count` points from one end to the other, both included; with a column `distance [m]` from the first.
core::Table probe_line(const Field& field, const std::array<double, 3>& from, const std::array<double, 3>& to,
                       int count, const ProbeOptions& options = {}, core::Progress& progress = core::Progress::none());

/// A grid of points origin + i/(columns-1) across + j/(rows-1) along, row by row.
core::Table probe_plane(const Field& field, const std::array<double, 3>& origin, const std::array<double, 3>& across,
                        const std::array<double, 3>& along, int columns, int rows, const ProbeOptions& options = {},
                        core::Progress& progress = core::Progress::none());

struct GapOptions {
    std::array<double, 3> forward{1, 0, 0};  ///< file axes
    std::array<double, 3> up{0, 0, 1};
    std::string symmetry;  ///< half model: flows are those of both halves; its plane as for `loads`
    std::vector<std::string>
        zones;  ///< surfaces of the body, by which the plane is placed; empty: as `loads` chooses them
    std::string base = "*base*";    ///< zone above the gap
    int stations = 9;               ///< along the base, evenly between its ends
    std::optional<double> density;  ///< kg/m^3; default: the field's own; none: no mass flow
};

/// Flow through the gap under the base at stations from its tail to its nose. Columns: position [m] (along forward from
/// the centre of the base), width [m] and area [m^2] of the section under the base, volume_flow [m^3/s] and
/// mass_flow [kg/s] (when the density is known), positive against forward (as the stream runs), bulk_velocity [m/s] =
/// volume_flow / area, mean_speed [m/s], mean_pressure [Pa] (area means), bulk_pressure [Pa] (flow means).
/// Throws core::InputError without a volume with velocity or without a base, or for a half model on both sides of its
/// plane; core::UsageError for axes that are not perpendicular, or a symmetry plane that does not look to starboard.
core::Table gap_flow(const Field& field, const GapOptions& options = {},
                     core::Progress& progress = core::Progress::none());

/// Velocity against the forward axis over the height between ground and base, at a few stations in the middle plane.
core::Figure gap_profile_figure(const Field& field, const GapOptions& options = {},
                                core::Progress& progress = core::Progress::none());

}  // namespace underbody::postproc
