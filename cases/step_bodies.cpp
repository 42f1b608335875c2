// The bodies of the study: surface, mass, picture.
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "geometry/body/body_shape.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/exact_body.h"
#include "geometry/body/mass_properties.h"
#include "geometry/water/placement.h"
#include "postproc/views/views.h"

namespace underbody::cases {

namespace {

std::string compute_body(Engine& engine, const BodySpec& spec) {
    const auto shape = geometry::read_shape(spec.shape);
    const auto mesh = geometry::make_surface(shape, {}, engine.progress);
    const auto mass = geometry::mass_properties(geometry::ExactBody(shape), mesh);
    nlohmann::json document;
    geometry::to_json(document, mass);
    document["buoyancy"] =
        mass.buoyancy(engine.study.reference.number("density").value_or(geometry::default_water_density));
    document["watertight"] = geometry::is_watertight(mesh);
    if (shape.base == geometry::BaseKind::ellipse) {
        const auto base = shape.base_extent();
        document["elliptic_base"] = {{"half_length", (base.nose - base.tail) / 2}, {"half_width", base.half_width}};
    }
    document["patches"] = nlohmann::json::array();
    for (const auto& patch : geometry::patches(mesh)) {
        document["patches"].push_back({{"name", patch.name}, {"area", patch.area}, {"faces", patch.faces}});
    }
    return document.dump();
}

std::string draw_body(Engine& engine, const BodySpec& spec) {
    const auto mesh = geometry::make_surface(geometry::read_shape(spec.shape), {}, engine.progress);
    postproc::Scene scene;
    postproc::DrawnSurface surface;
    for (const auto& point : mesh.points) {
        surface.points.push_back({point.x, point.y, point.z});
    }
    for (const auto& triangle : mesh.triangles) {
        surface.triangles.push_back({triangle[0], triangle[1], triangle[2]});
    }
    scene.surfaces.push_back(std::move(surface));
    scene.title = spec.name;
    scene.subtitle = "seen from below";
    scene.camera.towards = {-1, 0.8, 0.9};
    return nlohmann::json({{"caption", "The body '" + spec.name + "' from below."}}).dump() + "\n" +
           postproc::draw_png(scene);
}

}  // namespace

void run_bodies(Engine& engine) {
    for (const auto& spec : engine.study.bodies) {
        const std::string shape = engine.path_in_study(spec.shape);
        Key key("body", {"geometry"});
        key.add("shape", shape);
        key.add("density", engine.study.reference.number("density").value_or(geometry::default_water_density));
        if (const auto made = engine.make("body", spec.name, key, [&] { return compute_body(engine, spec); })) {
            engine.add_document("body/" + spec.name, engine.value(*made));
            engine.picture("body picture", spec.name, Key("body picture", {"geometry", "postproc"}).add("shape", shape),
                           [&] { return draw_body(engine, spec); });
        }
    }
}

}  // namespace underbody::cases
