// underbody body: shapes into surfaces.
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "core/units.h"
#include "geometry/body_shape.h"
#include "geometry/body_surface.h"
#include "geometry/mass_properties.h"
#include "geometry/mesh_file.h"
#include "geometry/placement.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

struct BodyOptions {
    std::string shape;
    std::string out;
    std::string gap;
    std::string pitch;
    std::string roll;
    std::string out_unit = "m";
    std::size_t triangles = 20000;
};

nlohmann::json patches_json(const geometry::SurfaceMesh& mesh) {
    nlohmann::json list = nlohmann::json::array();
    for (const geometry::PatchSummary& patch : geometry::patches(mesh)) {
        list.push_back({{"name", patch.name}, {"area", patch.area}, {"faces", patch.faces}});
    }
    return list;
}

int make_body(const BodyOptions& options, Shell& shell) {
    const geometry::BodyShape shape = geometry::read_shape(options.shape);
    geometry::SurfaceOptions surface;
    surface.triangles = options.triangles;
    geometry::SurfaceMesh mesh = geometry::make_surface(shape, surface, shell.progress());
    const geometry::MassProperties mass = geometry::mass_properties(mesh);
    nlohmann::json document = mass;
    document["name"] = shape.name;
    document["patches"] = patches_json(mesh);
    document["watertight"] = true;
    document["axes"] = "x forward, y to port, z up, origin at the centre of the base";
    if (!options.gap.empty()) {
        geometry::Placement placement;
        placement.gap = core::parse_in(options.gap, "m");
        placement.pitch = options.pitch.empty() ? 0.0 : core::parse_in(options.pitch, "rad");
        placement.roll = options.roll.empty() ? 0.0 : core::parse_in(options.roll, "rad");
        document["gap"] = placement.gap;
        mesh = geometry::placed(mesh, placement);
    }
    if (!options.out.empty()) {
        geometry::write_mesh(mesh, options.out, core::convert(1, "m", options.out_unit));
        document["file"] = options.out;
    }
    if (shell.json) {
        shell.print_json(document);
        return done;
    }
    const auto number = [](double v) { return core::format_number(v, 6); };
    shell.print(shape.name + ": " + std::to_string(mesh.triangles.size()) + " triangles" +
                (options.out.empty() ? std::string() : " in " + options.out));
    shell.print("volume    " + number(mass.volume * 1e6) + " cm^3, buoyancy " + number(mass.buoyancy()) + " N");
    shell.print("area      " + number(mass.area * 1e4) + " cm^2");
    shell.print("centroid  " + number(mass.centroid.x * 1e3) + ", " + number(mass.centroid.y * 1e3) + ", " +
                number(mass.centroid.z * 1e3) + " mm from the centre of the base");
    for (const geometry::PatchSummary& patch : geometry::patches(mesh)) {
        shell.print("patch     " + patch.name + ": " + std::to_string(patch.faces) + " triangles, " +
                    number(patch.area * 1e4) + " cm^2");
    }
    return done;
}

}  // namespace

void add_body_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("body", "make the body that a SHAPE.toml describes");
    auto options = std::make_shared<BodyOptions>();
    command->add_option("shape", options->shape, "SHAPE.toml")->required();
    command->add_option("--out", options->out, "surface to write: .stl, .obj, .ply or .vtp");
    command->add_option("--out-unit", options->out_unit, "unit of length in that file")->capture_default_str();
    command->add_option("--triangles", options->triangles, "about how many triangles")->capture_default_str();
    command->add_option("--gap", options->gap,
                        "place it over the ground z = 0 with this gap under the centre of its base");
    command->add_option("--pitch", options->pitch, "nose up positive");
    command->add_option("--roll", options->roll, "starboard down positive");
    command->footer(
        "Examples:\n"
        "  underbody body cases/evie/shapes/ellipse.toml --out evie.stl\n"
        "  underbody body shape.toml --out placed.vtp --gap 5mm --pitch 2deg\n"
        "  underbody body shape.toml --json");
    shell.on(command, [options, &shell] { return make_body(*options, shell); });
}

}  // namespace underbody::studio
