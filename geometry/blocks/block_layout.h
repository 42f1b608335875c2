// Lines of the block mesh in planes through the axis: gap, flank, far field. Internal to the block mesher.
#pragma once

#include <functional>
#include <vector>

#include "geometry/blocks/base_grid.h"
#include "geometry/blocks/block_mesh.h"
#include "geometry/blocks/body_section.h"
#include "geometry/blocks/grading.h"

namespace underbody::geometry {

/// Counts and sizes for one body, m.
struct BlockCounts {
    DiscCounts base;
    int flank = 18;                            ///< lines from the rim up to the equator
    int layers = 12;                           ///< cells on a line from the hull that are laid along its normals
    int to_ground = 13;                        ///< further cells down to the ground
    int outward = 28;                          ///< further cells out to the far field
    int upper = 18, rings = 4;                 ///< lines over the upper hull, and around its top
    double first = 7e-5, first_ground = 9e-5;  ///< m, first cell at the body and at the ground
    [[nodiscard]] int down() const { return layers + to_ground; }
};

/// Points (distance from the axis, height over the ground) of the lines of all blocks.
class BlockLayout {
public:
    /// `gap` without pitch. `scale`: the body's size over that of EVIE, for which the sizes were found.
    /// Throws core::InputError (kind "mesh") where a tail plate leaves no room for lines below it.
    BlockLayout(const BodySection& section, BlockCounts counts, double gap, double scale);

    [[nodiscard]] const BlockCounts& counts() const { return counts_; }
    [[nodiscard]] double gap() const { return gap_; }
    /// Depths below the base of the columns' points, 0 to gap.
    [[nodiscard]] std::vector<double> column() const;
    /// Lines from the flank at one azimuth to the ground, the first at the rim.
    [[nodiscard]] std::vector<Line2> flank(double azimuth) const;
    /// Polar angles of the lines over the upper hull, from the equator's to the top's.
    [[nodiscard]] std::vector<double> upper_angles() const;
    /// A line from the hull at a polar angle of its ellipsoid (0 below, pi on top) to the far field.
    [[nodiscard]] Line2 outward(double angle) const;
    /// Between the outermost flank line, the lowest outward one, far field and ground: [outward][to_ground].
    [[nodiscard]] std::vector<Line2> outer_block() const;
    /// The tail plate lies on the lines of this number of upper_angles(), from the hull to this point of them; -1:
    /// none.
    [[nodiscard]] int plate_line() const { return plate_ == nullptr ? -1 : lines_below_plate(); }
    [[nodiscard]] int plate_end() const { return plate_end_; }
    [[nodiscard]] double top_angle() const { return top_angle_; }

    double far_radius, far_height, dome_height;  ///< m: cylinder, and half of an ellipsoid on it
    [[nodiscard]] double far_volume() const;

private:
    [[nodiscard]] Point2 ellipsoid(double angle) const;
    [[nodiscard]] Point2 normal(double angle) const;
    [[nodiscard]] int lines_below_plate() const { return (2 * counts_.upper + 2) / 3; }
    [[nodiscard]] std::vector<double> angles_between(double from, double to, const std::vector<double>& arcs) const;
    [[nodiscard]] double arc_between(double from, double to) const;
    [[nodiscard]] Line2 free_outward(double angle) const;
    [[nodiscard]] Line2 beside_plate(Line2 line, const std::function<double(int)>& share) const;
    void make_room_for_plate();
    [[nodiscard]] Line2 flank_line(const Point2& from, double share, double rim, double flank_length) const;

    const BodySection& section_;
    BlockCounts counts_;
    double gap_, scale_, largest_, centre_height_, semi_z_;
    double equator_angle_, top_angle_, foot_radius_;
    Line2 equator_;               // line from the equator to the ground
    std::vector<double> layers_;  // distances along its normals
    const TailPlate* plate_ = nullptr;
    double plate_radius_ = 0;
    int plate_end_ = 0;
    Line2 beside_plate_;  // the line from the midplane as it would be without one
};

}  // namespace underbody::geometry
