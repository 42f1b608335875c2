#include "geometry/body/shape_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/no_limit.h"
#include "core/text.h"
#include "geometry/body/exact_body.h"

namespace underbody::geometry {

namespace {

using core::degree;

BodyShape without_additions(BodyShape shape) {
    shape.protrusion.reset();
    shape.nozzle.reset();
    return shape;
}

// 5 mm rather than 0.005 m: what the user has before his eyes. Rounded toward the allowed side.
std::string in_millimetres(double metres, int rounding) {
    const double mm = metres * 1000, step = 0.001;
    const double rounded = rounding > 0   ? std::ceil(mm / step - 1e-6) * step
                           : rounding < 0 ? std::floor(mm / step + 1e-6) * step
                                          : mm;
    return core::format_number(rounded + 0.0, 7) + " mm";
}

class Checker {
public:
    explicit Checker(const core::TomlTable* table) : table_(table) {}

    void length(const char* section, const char* key, double value, double lower, double upper,
                const std::string& why) const {
        if (!(value >= lower)) {
            outside(section, key, in_millimetres(value, 0), "at least " + in_millimetres(lower, 1), why);
        }
        if (!(value <= upper)) {
            outside(section, key, in_millimetres(value, 0), "at most " + in_millimetres(upper, -1), why);
        }
    }
    void number(const char* section, const char* key, double value, double lower, double upper,
                const std::string& why) const {
        const auto text = [](double v, int rounding) {
            const double scaled = rounding > 0   ? std::ceil(v * 1e5 - 1e-4) / 1e5
                                  : rounding < 0 ? std::floor(v * 1e5 + 1e-4) / 1e5
                                                 : v;
            return core::format_number(scaled, 7);
        };
        if (!(value >= lower)) {
            outside(section, key, text(value, 0), "at least " + text(lower, 1), why);
        }
        if (!(value <= upper)) {
            outside(section, key, text(value, 0), "at most " + text(upper, -1), why);
        }
    }
    void angle(const char* section, const char* key, double value, double lower, double upper,
               const std::string& why) const {
        const auto text = [](double v, int rounding) {
            const double d = v / degree;
            const double scaled = rounding > 0   ? std::ceil(d * 1e3 - 1e-3) / 1e3
                                  : rounding < 0 ? std::floor(d * 1e3 + 1e-3) / 1e3
                                                 : d;
            return core::format_number(scaled, 7) + " deg";
        };
        if (!(value >= lower)) {
            outside(section, key, text(value, 0), "at least " + text(lower, 1), why);
        }
        if (!(value <= upper)) {
            outside(section, key, text(value, 0), "at most " + text(upper, -1), why);
        }
    }
    [[noreturn]] void refuse(const char* section, const char* key, const std::string& value, const std::string& limit,
                             const std::string& why) const {
        stop(section, key, section + std::string(".") + key + " is " + value + ": " + why, limit);
    }

private:
    [[noreturn]] void outside(const char* section, const char* key, const std::string& value, const std::string& limit,
                              const std::string& what) const {
        stop(section, key, section + std::string(".") + key + " is " + value + ", which is not allowed (" + what + ")",
             limit);
    }
    [[noreturn]] void stop(const char* section, const char* key, const std::string& message,
                           const std::string& limit) const {
        core::Place place;
        if (table_ != nullptr) {
            place = table_->table_or_empty(section).has(key) ? table_->table_or_empty(section).place(key)
                                                             : table_->place(section);
        }
        throw core::InputError("range", message, place, "the nearest allowed value: " + limit);
    }

    const core::TomlTable* table_;
};

bool edge_is_regular(const BodyShape& shape, double radius) {
    BodyShape trial = without_additions(shape);
    trial.edge_radius = 0;
    const BodyShape::BaseExtent sharp = trial.base_extent();
    const double depth = shape.base_depth();
    if (radius > 0.5 * depth) {
        return false;
    }
    trial.edge_radius = radius;
    const ExactBody body = ExactBody::of_few_points(trial);
    const double ratio = 0.2;
    const Vec3 nose = body.ellipsoid_point(0, 0), port = body.ellipsoid_point(0, std::numbers::pi / 2);
    const double ellipse_nose = std::sqrt(1 - shape.base_cut * shape.base_cut) * shape.length / 2;
    const double ellipse_port = std::sqrt(1 - shape.base_cut * shape.base_cut) * shape.width / 2;
    if (nose.x < ratio * ellipse_nose || port.y < ratio * ellipse_port || body.highest_fillet() > 0.9 * depth) {
        return false;
    }
    // The inset outline turns everywhere in the same sense (else the ball does not fit the nose).
    Vec3 before = body.ellipsoid_point(0, 0);
    for (int i = 1; i <= 64; ++i) {
        const double t = i * std::numbers::pi / 2 / 64;
        const Vec3 next = body.ellipsoid_point(0, t);
        if (next.x >= before.x || next.y <= before.y) {
            return false;
        }
        before = next;
    }
    if (shape.base == BaseKind::ellipse) {
        return true;
    }
    const auto side_fits = [&](const SideProfile& side, double foot, double reach) {
        // Where the ball rests on the arc it must not have passed the foot's own side of it.
        return side.base_half() >= ratio * foot && side.base_half() <= foot + 1e-12 &&
               side.fillet_top() <= 0.9 * depth && reach > foot;
    };
    return side_fits(body.profile(Side::back), -sharp.tail, shape.length / 2) &&
           side_fits(body.profile(Side::port), sharp.half_width, shape.width / 2);
}

void check_base(const BodyShape& shape, const Checker& checker) {
    const double scale = std::sqrt(1 - shape.base_cut * shape.base_cut);
    const double smallest = 0.05;  // of the ellipse's own axis
    const auto sides = [&](const char* key, const std::optional<double>& value, double axis) {
        if (!value) {
            return;
        }
        if (shape.base == BaseKind::ellipse) {
            checker.refuse("body", key, in_millimetres(*value, 0),
                           "leave it out, or take base = \"rectangle\" or \"ellipse_front\"",
                           "a base of the kind \"ellipse\" has the size that the cut gives it");
        }
        checker.length("body", key, *value, smallest * scale * axis, 0.999 * scale * axis,
                       "the base lies inside the ellipse that the cut leaves, " + in_millimetres(scale * axis, 0) +
                           " long on this axis");
    };
    sides("base_length", shape.base_length, shape.length);
    sides("base_width", shape.base_width, shape.width);
    const bool fits = shape.edge_radius == 0 || (shape.edge_radius > 0 && edge_is_regular(shape, shape.edge_radius));
    checker.length("body", "edge_radius", shape.edge_radius, 0, fits ? shape.edge_radius : largest_edge_radius(shape),
                   "a rounding that the edge has room for: it leaves a fifth of the base and stays below the midplane");
    checker.number("body", "taper", shape.taper, -0.8, 0.8, "the fraction by which the base narrows from nose to tail");
    // d(height')/d(height) = 1 - 2 tan(pitch) x (depth - u)/depth^2 must stay positive on the whole lower hull.
    const double bend = std::atan(0.4 * shape.base_depth() / shape.length);
    const double limit = std::min(15 * degree, bend);
    checker.angle("body", "base_pitch", shape.base_pitch, -limit, limit,
                  "the pitch of the base, which the hull below the midplane can follow without a fold");
    // The hull leans by 2 base_offset / depth at the base: 58 degrees at this limit.
    const double most = 0.8 * shape.base_depth();
    checker.length("body", "base_offset", shape.base_offset, -most, most,
                   "how far the base may lie forward of where the cut leaves it: four fifths of its depth");
}

void check_protrusion(const BodyShape& shape, const Checker& checker) {
    const Protrusion& p = *shape.protrusion;
    const BodyShape::BaseExtent extent = shape.base_extent();
    const double base_length = extent.nose - extent.tail;
    checker.length("protrusion", "length", p.length, 1e-3 * base_length, 0.5 * base_length,
                   "its length along the base");
    checker.length("protrusion", "height", p.height, 1e-4 * base_length,
                   p.profile == ProtrusionProfile::rounded ? 0.45 * p.length : 2 * p.length,
                   p.profile == ProtrusionProfile::rounded ? "a rounded profile is flatter than a half circle"
                                                           : "a protrusion that leaves a mesh of sound triangles");
    checker.length("protrusion", "blend_radius", p.blend_radius, 0,
                   p.profile == ProtrusionProfile::rounded
                       ? (p.length * p.length / 4 + p.height * p.height) / (2 * p.height) * 0.5
                       : 0.4 * std::hypot(p.length / 2, p.height) / std::tan(std::atan2(p.height, p.length / 2) / 2),
                   "a blend for which the flank has room");
    const double foot = protrusion_foot_radius(p);
    const InsideDistance inside(flat_base_outline(without_additions(shape)));
    const double margin = 0.02 * extent.half_width;
    const auto fits = [&](double fraction) { return inside(extent.nose - fraction * base_length, 0) >= foot + margin; };
    if (!(p.position >= 0 && p.position <= 1) || !fits(p.position)) {
        double nearest = 0.5, best = 1e9;
        for (int i = 0; i <= 10000; ++i) {
            const double fraction = i / 10000.0;
            if (std::abs(fraction - p.position) < best && fits(fraction)) {
                best = std::abs(fraction - p.position);
                nearest = fraction;
            }
        }
        if (best > 1e8) {
            checker.refuse("protrusion", "length", in_millimetres(p.length, 0), "a shorter one",
                           "no place on the flat base is wide enough for it");
        }
        checker.refuse(
            "protrusion", "position", core::format_number(p.position, 7), core::format_number(nearest, 7),
            "the protrusion (" + in_millimetres(2 * foot, 0) + " along the base) stands beyond the flat base");
    }
    BodyShape widest = shape;
    widest.protrusion->width.reset();
    if (p.width) {
        checker.length("protrusion", "width", *p.width, 2 * foot, protrusion_width(widest),
                       "tip to tip, inside the flat base");
    }
}

void check_nozzle(const BodyShape& shape, const Checker& checker) {
    const Nozzle& n = *shape.nozzle;
    const BodyShape::BaseExtent extent = shape.base_extent();
    const double base_length = extent.nose - extent.tail, radius = n.diameter / 2;
    const InsideDistance inside(flat_base_outline(without_additions(shape)));
    const double margin = 0.02 * extent.half_width;
    checker.number("nozzle", "position", n.position, 0, 1, "along the base from its nose end");
    checker.length("nozzle", "depth", n.depth, 0, 0.9 * shape.base_depth(), "the bore ends inside the body");
    const double axis = shape.protrusion ? shape.protrusion->position : 0;
    const double foot = shape.protrusion ? protrusion_foot_radius(*shape.protrusion) + margin : 0;
    // Largest radius at a place: up to the edge of the flat base and to the foot of the protrusion.
    const auto room = [&](double fraction) {
        const double edge = inside(extent.nose - fraction * base_length, 0) - margin;
        return shape.protrusion ? std::min(edge, std::abs(fraction - axis) * base_length - foot) : edge;
    };
    checker.length("nozzle", "diameter", n.diameter, 1e-3 * base_length, base_length,
                   "the nozzle lies inside the base");
    if (room(n.position) >= radius) {
        return;
    }
    double nearest = -1, widest = 0;
    for (int i = 0; i <= 2000; ++i) {
        const double fraction = i / 2000.0, here = room(fraction);
        widest = std::max(widest, here);
        if (here >= radius && (nearest < 0 || std::abs(fraction - n.position) < std::abs(nearest - n.position))) {
            nearest = fraction;
        }
    }
    checker.length("nozzle", "diameter", n.diameter, 0, std::max(2 * widest, 0.0),
                   "the nozzle lies inside the flat base");
    const bool in_protrusion = shape.protrusion && std::abs(n.position - axis) * base_length < foot + radius;
    checker.refuse("nozzle", "position", core::format_number(n.position, 7), core::format_number(nearest, 5),
                   in_protrusion
                       ? "the nozzle lies in the protrusion"
                       : "the nozzle (" + in_millimetres(n.diameter, 0) + " wide) stands beyond the flat base");
}

}  // namespace

double protrusion_foot_radius(const Protrusion& p) {
    const double half = p.length / 2, r = p.blend_radius;
    if (p.profile == ProtrusionProfile::rounded) {
        const double arc = (half * half + p.height * p.height) / (2 * p.height), centre = p.height - arc;
        return std::sqrt((arc + r) * (arc + r) - (r - centre) * (r - centre));
    }
    return half + r * std::tan(std::atan2(p.height, half) / 2);
}

std::vector<OutlinePoint> flat_base_outline(const BodyShape& shape, std::size_t points) {
    const ExactBody body = ExactBody::of_few_points(without_additions(shape));
    std::vector<OutlinePoint> outline;
    for (std::size_t i = 0; i <= points; ++i) {
        const double t = std::numbers::pi * static_cast<double>(i) / static_cast<double>(points);
        const Vec3 p = body.ellipsoid_point(0, t);
        OutlinePoint q{p.x, i == 0 || i == points ? 0.0 : p.y};
        if (body.cut(Side::front)) {
            q.x = std::min(q.x, body.profile(Side::front).base_half());
        }
        if (body.cut(Side::back)) {
            q.x = std::max(q.x, -body.profile(Side::back).base_half());
            q.y = std::min(q.y, body.profile(Side::port).base_half());
        }
        outline.push_back(q);
    }
    return outline;
}

InsideDistance::InsideDistance(const std::vector<OutlinePoint>& outline) {
    for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
        const OutlinePoint &a = outline[i], &b = outline[i + 1];
        const double ex = b.x - a.x, ey = b.y - a.y, length = std::hypot(ex, ey);
        if (length > 1e-9) {
            edges_.push_back({a, ex, ey, length});
        }
    }
}

double InsideDistance::operator()(double x, double y) const {
    double nearest = core::no_limit;
    for (const Edge& edge : edges_) {  // from the nose over port to the tail: inside is on their left
        nearest =
            std::min(nearest, (edge.along_x * (y - edge.from.y) - edge.along_y * (x - edge.from.x)) / edge.length);
    }
    return nearest;
}

double largest_edge_radius(const BodyShape& shape) {
    double low = 0, high = 0.5 * shape.base_depth();
    if (edge_is_regular(shape, high)) {
        return high;
    }
    for (int i = 0; i < 40; ++i) {
        const double mid = 0.5 * (low + high);
        (edge_is_regular(shape, mid) ? low : high) = mid;
    }
    return low;
}

double protrusion_width(const BodyShape& shape) {
    if (!shape.protrusion) {
        return 0;
    }
    if (shape.protrusion->width) {
        return *shape.protrusion->width;
    }
    const InsideDistance inside(flat_base_outline(without_additions(shape)));
    const double foot = protrusion_foot_radius(*shape.protrusion), half_width = shape.base_extent().half_width;
    const double x = shape.base_x(shape.protrusion->position), margin = 0.02 * half_width;
    double low = 0, high = half_width;
    for (int i = 0; i < 60; ++i) {
        const double mid = 0.5 * (low + high);
        (inside(x, mid) >= foot + margin ? low : high) = mid;
    }
    return 2 * (low + foot);
}

void check(const BodyShape& shape, const core::TomlTable* table) {
    const Checker checker(table);
    const double smallest = 1e-4, largest = 1e3;
    checker.length("body", "length", shape.length, smallest, largest, "the length of the ellipsoid");
    checker.length("body", "width", shape.width, std::max(smallest, shape.length / 10), 10 * shape.length,
                   "the width of the ellipsoid, from a tenth to ten times its length");
    checker.length("body", "height", shape.height, std::max(smallest, shape.length / 20), 5 * shape.length,
                   "the height of the ellipsoid, from a twentieth to five times its length");
    checker.number("body", "base_cut", shape.base_cut, 0.05, 0.98,
                   "how far below the centre the base lies, in semi-heights");
    check_base(shape, checker);
    if (shape.protrusion) {
        check_protrusion(shape, checker);
    }
    if (shape.nozzle) {
        check_nozzle(shape, checker);
    }
    if (shape.tail_plate) {
        checker.length("tail_plate", "chord", shape.tail_plate->chord, 0, 0.45 * shape.length,
                       "a plate that moves with the body in its mesh: up to 0.45 body lengths");
        checker.angle("tail_plate", "half_angle", shape.tail_plate->half_angle, 10 * degree, 90 * degree,
                      "from the tail as far as the widest place of the body");
        checker.angle("tail_plate", "inner_angle", shape.tail_plate->inner_angle, 0,
                      shape.tail_plate->half_angle - 10 * degree, "it begins nearer to the tail than it ends");
    }
}

}  // namespace underbody::geometry
