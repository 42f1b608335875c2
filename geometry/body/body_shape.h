// The parameters of a body: an ellipsoid with a flat base, its cuts and additions (SHAPE.toml, docs/files/shape.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/toml.h"

namespace underbody::geometry {

enum class BaseKind { ellipse, rectangle, ellipse_front };
enum class ProtrusionProfile { rounded, sharp };

/// A ridge across the base. Its axis runs to port and starboard; it falls to the base over `length` / 2 on all sides,
/// so that its ends are half bodies of revolution about the vertical through the ends of the axis.
struct Protrusion {
    double position = 0.85;  ///< of its axis, along the base from its nose end, as a fraction of the base length
    double height = 0.002;   ///< m, below the base
    double length = 0.010;   ///< m, along x, foot to foot without the blend
    ProtrusionProfile profile =
        ProtrusionProfile::rounded;  ///< circular arc, or two straight flanks with a sharp crest
    double blend_radius = 0;         ///< m, of the concave fillet between flank and base; widens the foot
    std::optional<double> width;     ///< m, tip to tip; default: as wide as the base allows at that place
    friend bool operator==(const Protrusion&, const Protrusion&) = default;
};

/// A round opening in the base: a patch of its own for the jet.
struct Nozzle {
    double diameter = 0.005;  ///< m
    double position = 0.5;    ///< of its centre, along the base from its nose end, as a fraction of the base length
    double depth = 0;         ///< m, of the bore above the base; 0: flush
    friend bool operator==(const Nozzle&, const Nozzle&) = default;
};

/// A level plate without thickness on the stern: it leaves the hull at the midplane of the ellipsoid and ends where an
/// ellipse `chord` longer on each side (and wider in proportion) does, between two rays from the body's upright axis.
/// Blocks alone have it: the body's surface, volume and added mass leave it out.
struct TailPlate {
    double chord = 0.05;                ///< m, at the tail; 0: no plate
    double half_angle = 1.04719755119;  ///< rad, of the rays from the tail, seen from above
    double inner_angle = 0;  ///< rad, where it begins: above 0 there are two fins with a clear tail between them
    friend bool operator==(const TailPlate&, const TailPlate&) = default;
};

/// Metres and radians.
///
/// The body is the ellipsoid with the axes `length`, `width`, `height`, cut by the plane `base_cut` semi-heights below
/// its centre. `rectangle`: four sides cut it below the midplane, each an arc (in the plane across the side) that meets
/// the side of the base rectangle and is tangent to the ellipsoid at the midplane: a circle where one exists, that is
/// when the ellipsoid stands out beyond the rectangle by no more than the depth of the base, else a quarter of an
/// ellipse, which runs smoothly into the base. `ellipse_front`: the same without the cut in front. `taper` and
/// `base_pitch`, both about the centre of the flat base, and `base_offset` then move the part below the midplane, by
/// the square of the depth: at the base in full, at the midplane nothing, with no kink there. What stands below the
/// base (a protrusion) moves with the base and keeps its shape.
struct BodyShape {
    std::string name = "body";
    double length = 0.2032;
    double width = 0.152;
    double height = 0.145;   ///< of the whole ellipsoid
    double base_cut = 0.75;  ///< how far below the centre the flat base lies, in semi-heights
    BaseKind base = BaseKind::ellipse;
    std::optional<double>
        base_length;  ///< of the rectangle (of its sides, for ellipse_front: twice the distance to the back)
    std::optional<double> base_width;  ///< default: the largest rectangle inside the base ellipse
    double edge_radius = 0;  ///< of the rounding between base and hull (rolling ball on each piece of the hull)
    double taper = 0;        ///< the base narrows by this fraction of its width at its centre, from nose to tail
    double base_pitch = 0;   ///< nose up positive, about the centre of the base
    double base_offset = 0;  ///< m, forward positive: how far the base lies from where the cut leaves it
    std::optional<Protrusion> protrusion;
    std::optional<Nozzle> nozzle;
    std::optional<TailPlate> tail_plate;
    friend bool operator==(const BodyShape&, const BodyShape&) = default;

    /// m, below the centre of the ellipsoid
    [[nodiscard]] double base_depth() const { return 0.5 * base_cut * height; }
    /// m, of the base as cut, before its edge is rounded: forward and aft end, largest half width.
    struct BaseExtent {
        double nose = 0;  ///< x of the nose end, from the axis of the ellipsoid
        double tail = 0;
        double half_width = 0;
    };
    [[nodiscard]] BaseExtent base_extent() const;
    /// x of a fraction along the base from its nose end.
    [[nodiscard]] double base_x(double fraction) const;
};

/// Names as they stand in files.
const std::vector<std::string>& base_names();
std::string name_of(BaseKind base);
std::string name_of(ProtrusionProfile profile);

/// Reads [body], [protrusion], [nozzle], [tail_plate] of a SHAPE.toml. All lengths with units; every limit is checked
/// (see `check`). The name of the body is the file's name unless [body] has `name`. Throws core::InputError that names
/// key, line, value and the nearest allowed value.
BodyShape read_shape(const std::filesystem::path& path);
BodyShape parse_shape(std::string_view text, const std::string& source = "shape");
/// The same from a table that holds [body] and the rest; the caller calls `finish()`.
BodyShape shape_from(const core::TomlTable& root, const std::string& name);

/// Throws core::InputError (kind "range") when the shape cannot be made: names the key as in the file, the value and
/// the nearest allowed one. `table` (may be null) gives the places of the keys.
void check(const BodyShape& shape, const core::TomlTable* table = nullptr);

/// m, from the axis of the ellipsoid forward to the centre of the flat base (the origin of its meshes): `base_offset`,
/// and for `ellipse_front` where its cut leaves the base. The shape must have passed `check`.
double base_centre(const BodyShape& shape);

/// m^2, of one side of the plate, both halves; 0 when there is none.
double tail_plate_area(const BodyShape& shape);
/// The plate where it is one (a chord above 0).
inline const TailPlate* tail_plate(const BodyShape& shape) {
    return shape.tail_plate && shape.tail_plate->chord > 0 ? &*shape.tail_plate : nullptr;
}

/// Tip to tip width of the protrusion: as written, or as wide as the flat base allows at its place (less 2 % of the
/// base's half width at each end). 0 when there is none.
double protrusion_width(const BodyShape& shape);

/// The shape as SHAPE.toml; reads back to an equal shape.
std::string write_shape(const BodyShape& shape);

/// Equal for shapes that are equal in everything but the name, whatever the units and the order of keys they were
/// written with, and whether a default was written or left out. Lengths count to 1e-12 relative.
std::string shape_hash(const BodyShape& shape);

}  // namespace underbody::geometry
