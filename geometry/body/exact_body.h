// The exact surface behind a BodyShape: pieces in closed form, of which meshes are made and against which they are
// measured.
//
// Coordinates: x forward from the axis of the ellipsoid, y to port, height u above the flat base, before or after the
// bend that makes taper, base pitch and base offset. A mesh has its origin at the centre of the base, `base_centre()`
// forward of the axis. The unbent body is the intersection of convex pieces: the ellipsoid, and the sides that cut it,
// each with its own rounded edge to the base.
#pragma once

#include <vector>

#include "geometry/body/body_shape.h"
#include "geometry/mesh/vec3.h"

namespace underbody::geometry {

/// The profile of a side in the plane across it: half width against height above the base, from the (rounded) edge at
/// the base up to the midplane, where it is vertical.
class SideProfile {
public:
    SideProfile() = default;
    /// `foot`: half width at the base; `reach`: semi-axis of the ellipsoid there; `depth`: of the base below the
    /// midplane.
    SideProfile(double foot, double reach, double depth, double edge_radius);

    /// Along the profile from the base (0) to the midplane (`length()`), metres of arc.
    struct At {
        double half = 0;
        double height = 0;
    };
    [[nodiscard]] At at_arc(double arc) const;
    [[nodiscard]] double arc_of_height(double height) const;
    [[nodiscard]] double length() const { return arcs_.back(); }
    /// Half width at a height in [0, depth].
    [[nodiscard]] double half(double height) const;
    /// Half width where the flat base ends.
    [[nodiscard]] double base_half() const { return edge_; }
    [[nodiscard]] double fillet_top() const { return fillet_top_; }
    /// Signed distance in the plane of the profile of (half, height) to the profile, positive outside.
    [[nodiscard]] double distance(double half, double height) const;

private:
    [[nodiscard]] At at_parameter(double w) const;
    double depth_ = 0;
    double radius_ = 0;       // of the edge
    double centre_ = 0;       // of the arc, at midplane height
    double semi_ = 0;         // horizontal semi-axis of the arc
    double rise_ = 0;         // vertical semi-axis of the arc
    double edge_centre_ = 0;  // of the rounding: half width; its height is radius_
    double edge_ = 0;
    double fillet_top_ = 0;
    double fillet_end_ = 0;  // angle of the rounding at its top, 0 at the base
    double arc_start_ = 0;   // angle of the arc where it begins, negative, 0 at the midplane
    std::vector<double> arcs_;
};

enum class Side { front, back, port };

/// Integrals over the volume of a body that is the same to port and to starboard (those that are odd in y vanish),
/// about the centre of its base: x forward, y to port, z up. m^3 and one or two metres more.
struct VolumeMoments {
    double one = 0, x = 0, z = 0, xx = 0, yy = 0, zz = 0, zx = 0;
    friend VolumeMoments operator+(const VolumeMoments& a, const VolumeMoments& b) {
        return {a.one + b.one, a.x + b.x, a.z + b.z, a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.zx + b.zx};
    }
    friend VolumeMoments operator*(const VolumeMoments& a, double s) {
        return {a.one * s, a.x * s, a.z * s, a.xx * s, a.yy * s, a.zz * s, a.zx * s};
    }
};

class ExactBody {
public:
    /// The shape must have passed `check`.
    explicit ExactBody(const BodyShape& shape) : ExactBody(shape, true) {}
    /// The same, to a rounding, for who asks for less than some hundred points: its rounded edge is solved for where it
    /// is asked for, and not tabulated first.
    static ExactBody of_few_points(const BodyShape& shape) { return {shape, false}; }

    [[nodiscard]] const BodyShape& shape() const { return shape_; }
    [[nodiscard]] double semi_x() const { return a_; }
    [[nodiscard]] double semi_y() const { return b_; }
    [[nodiscard]] double semi_z() const { return c_; }
    [[nodiscard]] double depth() const { return depth_; }
    [[nodiscard]] double top() const { return depth_ + c_; }
    /// x of the middle between the ends of the flat base, bent; and before it is moved by `base_offset`: 0 but for
    /// `ellipse_front`.
    [[nodiscard]] double base_centre() const { return cut_centre_ + offset_; }
    [[nodiscard]] double cut_centre() const { return cut_centre_; }

    [[nodiscard]] bool cut(Side side) const;
    [[nodiscard]] const SideProfile& profile(Side side) const { return side == Side::port ? across_ : along_; }

    /// The ellipsoid piece (with its rounded edge) at a height, by the parameter t of its outline: 0 nose, pi/2 port.
    /// The horizontal normal depends on t only.
    [[nodiscard]] Vec3 ellipsoid_point(double height, double t) const;
    /// Parameter t of a point on (or near) the ellipsoid piece, in [0, 2 pi).
    [[nodiscard]] double ellipsoid_parameter(const Vec3& p) const;
    /// Height where the rounding of the edge meets the ellipsoid.
    [[nodiscard]] double fillet_top(double t) const;
    /// Highest of them.
    [[nodiscard]] double highest_fillet() const;

    /// Bends a point of the unbent body (taper, pitch and offset of the base), and back.
    [[nodiscard]] Vec3 bent(const Vec3& p) const;
    [[nodiscard]] Vec3 unbent(const Vec3& p) const;
    [[nodiscard]] bool is_bent() const { return taper_ != 0 || slope_ != 0 || offset_ != 0; }

    /// How deep the protrusion stands below the base at a point of the (unbent) base plane; 0 outside it.
    [[nodiscard]] double protrusion_depth(double x, double y) const;
    struct Foot {
        double x = 0;          ///< of the axis
        double half_axis = 0;  ///< half length of the axis
        double radius = 0;     ///< from the axis to the foot, blend included
        double crest = 0;      ///< radius inside which nothing is left of a smooth profile: 0 unless blended
    };
    [[nodiscard]] Foot protrusion_foot() const;
    /// Depth of the profile at a distance from its axis.
    [[nodiscard]] double profile_depth(double distance) const;

    /// Volume of everything (protrusion and bore included) and its moments, by quadrature to about 1e-9 of themselves.
    [[nodiscard]] VolumeMoments moments() const;
    [[nodiscard]] double volume() const { return moments().one; }

    /// Signed distances of a bent point to pieces, positive outside, to first order near the surface.
    [[nodiscard]] double distance_to_ellipsoid(const Vec3& p) const;
    [[nodiscard]] double distance_to_side(const Vec3& p, Side side) const;
    [[nodiscard]] double distance_to_base(const Vec3& p) const;

private:
    ExactBody(const BodyShape& shape, bool tabulated);
    struct Spine {
        double x = 0, y = 0, height = 0;  // centre of the ball, height of its contact
    };
    [[nodiscard]] Spine spine(double t) const;
    [[nodiscard]] Spine solved_spine(double t) const;
    void tabulate_spine();
    // One quadrant; cubics between the entries, to rounding. Empty: each is solved for.
    struct SpineEntry {
        Spine value, slope;
    };
    std::vector<SpineEntry> spine_table_;
    BodyShape shape_;
    double a_, b_, c_, depth_;
    double cut_centre_ = 0;
    double taper_ = 0;   // d(width factor)/dx at the base
    double slope_ = 0;   // tangent of the pitch of the base
    double offset_ = 0;  // of the base
    double highest_fillet_ = 0;
    SideProfile along_, across_;
    // protrusion profile: an arc or a line for the flank, an arc of the blend
    double crest_centre_ = 0, crest_radius_ = 0, flank_end_ = 0, foot_ = 0, blend_ = 0, half_axis_ = 0;
};

}  // namespace underbody::geometry
