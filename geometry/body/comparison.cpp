// Two shapes against each other.
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/exact_body.h"
#include "geometry/body/variants.h"

namespace underbody::geometry {

namespace {

std::string value_text(const BodyShape& shape, const ParameterName& name) {
    if (name.name == "body.base") {
        return name_of(shape.base);
    }
    if (name.name == "protrusion.profile") {
        return shape.protrusion ? name_of(shape.protrusion->profile) : "-";
    }
    if (!has_part_of(shape, name.name)) {
        return "-";
    }
    return core::format_number(parameter(shape, name.name), 12);
}

double base_area(const SurfaceMesh& mesh) {
    double sum = 0;
    for (const PatchSummary& patch : patches(mesh)) {
        sum += patch.name == "base" ? patch.area : 0.0;
    }
    return sum;
}

// Distance of the points of a mesh from another body's exact pieces, the ellipsoids' axes on each other.
struct Farthest {
    double distance = 0;
    Vec3 where;  // from the axis
};

Farthest farthest(const SurfaceMesh& mesh, const ExactBody& own, const ExactBody& other) {
    Farthest result;
    for (Vec3 p : mesh.points) {
        p.x += own.base_centre();
        // Signed distance of the whole: the largest over its pieces (an intersection of convex ones, with additions
        // below).
        double d = std::max(other.distance_to_ellipsoid(p), other.distance_to_base(p));
        if (p.z < other.depth()) {
            for (const Side side : {Side::front, Side::back, Side::port}) {
                if (other.cut(side)) {
                    d = std::max(d, other.distance_to_side(p, side));
                }
            }
        }
        if (std::abs(d) > result.distance) {
            result = {std::abs(d), p};
        }
    }
    return result;
}

}  // namespace

Comparison compare(const BodyShape& a, const BodyShape& b, std::size_t triangles, core::Progress& progress) {
    Comparison result;
    result.equal = shape_hash(a) == shape_hash(b);
    if (!result.equal) {
        for (const ParameterName& name : parameter_names()) {
            const std::string in_a = value_text(a, name), in_b = value_text(b, name);
            if (in_a != in_b) {
                result.differences.push_back({name.name, name.unit, in_a, in_b});
            }
        }
    }
    SurfaceOptions options;
    options.triangles = triangles;
    const SurfaceMesh mesh_a = make_surface(a, options, progress), mesh_b = make_surface(b, options, progress);
    result.base_area_a = base_area(mesh_a);
    result.base_area_b = base_area(mesh_b);
    const ExactBody exact_a(a), exact_b(b);
    result.mass_a = mass_properties(exact_a, mesh_a);
    result.mass_b = mass_properties(exact_b, mesh_b);
    result.volume_a = result.mass_a.volume;
    result.volume_b = result.mass_b.volume;
    const Farthest of_a = farthest(mesh_a, exact_a, exact_b), of_b = farthest(mesh_b, exact_b, exact_a);
    result.largest_distance = std::max(of_a.distance, of_b.distance);
    result.where = of_a.distance > of_b.distance ? of_a.where : of_b.where;
    result.where.x -= exact_a.base_centre();
    return result;
}

void to_json(nlohmann::json& json, const Comparison& c) {
    json = {{"equal", c.equal},
            {"differences", nlohmann::json::array()},
            {"a", c.mass_a},
            {"b", c.mass_b},
            {"exact_volume", {c.volume_a, c.volume_b}},
            {"base_area", {c.base_area_a, c.base_area_b}},
            {"largest_distance", c.largest_distance},
            {"where", {c.where.x, c.where.y, c.where.z}}};
    for (const Comparison::Difference& d : c.differences) {
        json["differences"].push_back({{"parameter", d.name}, {"unit", d.unit}, {"a", d.a}, {"b", d.b}});
    }
}

}  // namespace underbody::geometry
