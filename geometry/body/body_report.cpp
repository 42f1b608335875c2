#include "geometry/body/body_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/angle.h"
#include "core/error.h"
#include "core/text.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/exact_body.h"
#include "geometry/body/variants.h"
#include "geometry/mesh/mesh_reader.h"

namespace underbody::geometry {

namespace {

using core::degree;

std::string text(double value, int digits = 6) { return core::format_number(value, digits); }

void move_to_base(SurfaceMesh& mesh) {
    for (const PatchSummary& patch : patches(mesh)) {
        if (patch.name == "base") {
            const Box box = bounding_box(patch_of(mesh, "base"));
            const Vec3 middle = 0.5 * (box.lower + box.upper);
            for (Vec3& p : mesh.points) {
                p -= middle;
            }
            return;
        }
    }
}

void add_added_mass(Body& body, const BodyOptions& options, core::Progress& progress) {
    if (options.panels == 0) {
        return;
    }
    AddedMassOptions water;
    water.density = options.density;
    water.placement = options.placement;
    water.reference = body.trim ? body.trim->centre_of_gravity : body.mass.centroid;
    body.added_mass = body.shape ? added_mass(*body.shape, options.panels, water, true, progress)
                                 : added_mass(body.mesh, options.panels, water, true, progress);
}

/// Moves the ballast, then lets the body come to rest.
void add_trim(Body& body, const BodyOptions& options, const std::filesystem::path& path) {
    if (options.ballast) {
        if (!body.loading) {
            throw core::InputError("missing", "the shape has no [mass] whose ballast could be placed",
                                   {path.string(), {}, {}, {}});
        }
        const BallastWish& wish = *options.ballast;
        body.ballast = ballast_position(body.mass, *body.loading, wish.name, wish.pitch, wish.roll);
        for (PointMass& point : body.loading->points) {
            point.position = point.name == wish.name ? *body.ballast : point.position;
        }
    }
    if (!body.loading) {
        return;
    }
    body.trim = trim(body.mass, *body.loading, options.density);
    constexpr double steep = 20 * degree;
    if (body.trim->stable && std::max(std::abs(body.trim->pitch), std::abs(body.trim->roll)) > steep) {
        body.remarks.push_back("At rest the body stands at pitch " + text(body.trim->pitch / degree, 4) +
                               " deg, roll " + text(body.trim->roll / degree, 4) +
                               " deg: its base no longer lies along the ground, and force tables seldom reach so far.");
    }
}

}  // namespace

void require_clearance(const SurfaceMesh& body, const Placement& placement) {
    const Clearance clear = clearance(body, placement);
    if (clear.smallest > 0) {
        return;
    }
    std::string hint =
        "the nearest allowed gap at this pitch: above " + text(1e3 * (placement.gap - clear.smallest)) + " mm";
    if (placement.gap > 0 && placement.roll == 0) {
        const ContactAngles angles = contact_angles(body, placement.gap);
        const auto& limit = placement.pitch > 0 ? angles.nose_up : angles.nose_down;
        Placement there = placement;
        there.pitch = std::copysign(limit.value_or(0), placement.pitch);
        constexpr double rounding = 1e-6;
        if (limit && clearance(body, there).smallest > -rounding) {  // not where it lies below the ground at any pitch
            hint += "; the nearest allowed pitch at this gap: " + text(there.pitch / degree, 5) + " deg";
        }
    }
    throw core::InputError("contact",
                           "at gap " + text(1e3 * placement.gap) + " mm and pitch " + text(placement.pitch / degree) +
                               " deg the body's " + clear.patch +
                               (clear.smallest < 0 ? " lies " + text(-1e3 * clear.smallest, 4) + " mm below the ground"
                                                   : std::string(" touches the ground")) +
                               ", at x = " + text(1e3 * clear.where_on_body.x, 4) + " mm",
                           {}, hint);
}

namespace {

void make_body(Body& body, const std::filesystem::path& path, const BodyOptions& options, core::Progress& progress) {
    body.shape = read_shape(path);
    for (const auto& [name, value] : options.set) {
        set_parameter(*body.shape, name, value);
    }
    check(*body.shape);
    body.name = body.shape->name;
    body.loading = read_loading(path);
    SurfaceOptions surface;
    surface.triangles = options.triangles;
    body.origin_from_axis = base_centre(*body.shape);
    body.mesh = make_surface(*body.shape, surface, progress);
    progress.report(0.3, "certificate");
    body.certificate = certify(body.mesh, *body.shape, progress);
}

void take_surface(Body& body, const std::filesystem::path& path, const BodyOptions& options, core::Progress& progress) {
    if (!options.set.empty()) {
        throw core::InputError("set", "a surface has no parameters to set, only a SHAPE.toml has",
                               {path.string(), {}, {}, {}});
    }
    body.name = path.stem().string();
    MeshReadOptions reading;
    reading.unit = options.unit;
    reading.feature_angle = options.feature_angle * degree;
    body.mesh = read_mesh(path, reading);
    move_to_base(body.mesh);
    body.certificate = certify(body.mesh, progress);
}

}  // namespace

Body read_body(const std::filesystem::path& path, const BodyOptions& options, core::Progress& progress) {
    Body body;
    body.density = options.density;
    if (core::lower_case(path.extension().string()) == ".toml") {
        make_body(body, path, options, progress);
    } else {
        take_surface(body, path, options, progress);
    }
    require(body.certificate, "'" + path.string() + "'");
    if (body.shape) {
        body.mass = mass_properties(ExactBody(*body.shape), body.mesh);
    } else {
        body.mass = mass_properties(body.mesh);
        body.volume_left_out = volume_left_out(body.mesh);
    }
    add_trim(body, options, path);
    if (options.placement) {
        body.placement = options.placement;
        require_clearance(body.mesh, *options.placement);
        body.clearance = clearance(body.mesh, *options.placement);
        body.contact = contact_angles(body.mesh, options.placement->gap);
        const Box& box = body.mass.bounding_box;
        body.underside = underside_area(
            body.mesh, *options.placement,
            options.underside_up_to.value_or(options.placement->gap + 0.25 * (box.upper.z - box.lower.z)));
    }
    progress.report(0.5, "added mass");
    add_added_mass(body, options, progress);
    return body;
}

void to_json(nlohmann::json& json, const Body& body) {
    json = body.mass;
    json["name"] = body.name;
    json["density"] = body.density;
    json["buoyancy"] = body.mass.buoyancy(body.density);
    const Vec3 size = body.outer_size();
    json["outer_size"] = {{"length", size.x}, {"width", size.y}, {"height", size.z}};
    json["mass_from"] = body.shape ? "exact shape" : "facets";
    if (body.shape) {
        json["ellipsoid_height"] = body.shape->height;
    } else {
        json["facet_volume_error"] = -body.volume_left_out;
        json["facet_buoyancy_error"] = -body.volume_left_out * standard_gravity * body.density;
    }
    json["axes"] = "x forward, y to port, z up, origin at the centre of the flat base (mid-length, mid-width)";
    json["origin_from_axis"] = body.origin_from_axis;
    json["patches"] = nlohmann::json::array();
    for (const PatchSummary& patch : patches(body.mesh)) {
        json["patches"].push_back({{"name", patch.name}, {"area", patch.area}, {"faces", patch.faces}});
    }
    json["watertight"] = body.certificate.closed && body.certificate.oriented;
    json["quality"] = body.certificate;
    json["gap"] = nullptr;
    if (body.shape) {
        json["base_pitch"] = body.shape->base_pitch;
        json["shape_hash"] = shape_hash(*body.shape);
    }
    if (body.added_mass) {
        const nlohmann::json details = *body.added_mass;
        json["added_mass"] = details.at("added_mass");
        json["added_mass_details"] = details;
        json["added_mass_details"].erase("added_mass");
    }
    if (body.trim) {
        json["trim"] = *body.trim;
    }
    if (body.placement) {
        json["gap"] = body.placement->gap;
        json["pitch"] = body.placement->pitch;
        json["roll"] = body.placement->roll;
        json["clearance"] = *body.clearance;
        json["contact_angles"] = *body.contact;
        json["underside_area"] = *body.underside;
    }
    if (body.ballast) {
        json["ballast_position"] = {body.ballast->x, body.ballast->y, body.ballast->z};
    }
    if (!body.remarks.empty()) {
        json["remarks"] = body.remarks;
    }
}

}  // namespace underbody::geometry
