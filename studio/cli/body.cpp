// underbody body: shapes into surfaces, and what they are.
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/angle.h"
#include "core/file.h"
#include "core/table.h"
#include "core/told.h"
#include "core/units.h"
#include "geometry/body/body_figures.h"
#include "geometry/mesh/mesh_file.h"
#include "postproc/views/views.h"
#include "studio/cli/body_parts.h"
#include "studio/cli/commands.h"
#include "studio/cli/option_value.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

using core::format_number;

// m as mm; the rounding errors of symmetric bodies (1e-13 mm) are shown as 0.
std::string mm(double metres) { return rounded(std::abs(metres) < 1e-12 ? 0.0 : 1e3 * metres, 5); }
std::string degrees(double radians) { return rounded(std::abs(radians) < 1e-12 ? 0.0 : radians / core::degree, 4); }

double positive(const std::string& text, const char* unit, const char* option) {
    const double value = option_value(option, text, unit);
    if (!(value > 0) || !std::isfinite(value)) {
        throw core::UsageError("range", std::string(option) + " " + text + " is not positive", {},
                               "the nearest allowed value: above 0");
    }
    return value;
}

}  // namespace

void BodyInput::add_to(CLI::App* command, bool required) {
    command->add_option("shape", shape, "SHAPE.toml, or a surface: .stl, .obj, .ply, .vtp")->required(required);
    command->add_option("--unit", unit, "unit of length of a surface file (they state none): mm, m, in");
    command->add_option("--feature-angle", feature_angle, "degrees: sharper edges part the patches of a surface file")
        ->capture_default_str()
        ->check(CLI::Range(1.0, 179.0));
    command->add_option("--triangles", triangles, "about how many triangles")->capture_default_str();
    command->add_option("--density", density, "of the water")->capture_default_str();
}

void BodyInput::add_placement(CLI::App* command) {
    command->add_option("--gap", gap, "over the ground, under the centre of the base: 5mm");
    command->add_option("--pitch", pitch, "nose up positive: 2deg");
    command->add_option("--roll", roll, "starboard down positive");
}

std::optional<geometry::Placement> BodyInput::placement() const {
    if (gap.empty() && pitch.empty() && roll.empty()) {
        return {};
    }
    if (gap.empty()) {
        throw core::UsageError("missing", "--pitch and --roll need --gap", {}, "add --gap 5mm");
    }
    const auto angle = [](const char* option, const std::string& text) {
        const double value = text.empty() ? 0.0 : option_value(option, text, "rad");
        if (core::parse_number(text) && std::abs(value) > 1) {
            throw core::UsageError("range", std::string(option) + " " + text + " is " + degrees(value) + " deg", {},
                                   "a bare number is in radians: write " + text + "deg");
        }
        return value;
    };
    return geometry::Placement{option_value("--gap", gap, "m"), angle("--pitch", pitch), angle("--roll", roll)};
}

std::string BodyInput::doubt(const geometry::SurfaceMesh& body) const {
    const geometry::Box box = geometry::bounding_box(body);
    const double length = box.upper.x - box.lower.x, height = option_value("--gap", gap, "m");
    if (!core::parse_number(gap) || height < 2 * length) {
        return {};
    }
    return "--gap " + gap + " is " + mm(height) + " mm, " + rounded(height / length, 3) +
           " lengths of the body: a bare number is in metres; for millimetres write --gap " + gap + "mm";
}

geometry::BodyOptions BodyInput::options() const {
    if (shape.empty()) {
        throw core::UsageError("missing", "which body?", {},
                               "name a SHAPE.toml or a surface, or see underbody body --help");
    }
    if (panels != 0 && panels < 200) {
        throw core::UsageError("range", "--panels " + std::to_string(panels) + " are too few for a body", {},
                               "the nearest allowed value: 200; or 0 to leave the added mass out");
    }
    geometry::BodyOptions result;
    result.triangles = triangles;
    if (!unit.empty()) {
        result.unit = unit;
    }
    result.feature_angle = feature_angle;
    result.density = positive(density, "kg/m^3", "--density");
    result.placement = placement();
    result.panels = panels;
    return result;
}

void on(Shell& shell, BodyActions& actions, CLI::App* command, std::function<int()> action) {
    actions[command] = action;
    shell.on(command, std::move(action));
}

namespace {

// ---- body SHAPE ----

struct MakeOptions {
    BodyInput input;
    std::vector<std::string> set;
    std::string as, out, out_unit = "m", picture, section, underside, gap_picture, area_curve, area_up_to, ballast,
                         trim_pitch = "0 deg", trim_roll = "0 deg";
    bool ascii = false;
};

std::string picture_of(const geometry::Body& body, const geometry::SurfaceMesh& mesh) {
    postproc::Scene scene;
    scene.title = body.name;
    scene.subtitle = rounded(1e6 * body.mass.volume, 5) + " cm^3, from below";
    scene.camera.towards = {-0.9, -0.8, 0.75};
    constexpr std::array<std::array<double, 3>, 5> colours{
        {{0.90, 0.62, 0.0}, {0.72, 0.75, 0.78}, {0.84, 0.37, 0.0}, {0.0, 0.45, 0.70}, {0.34, 0.71, 0.91}}};
    for (std::size_t k = 0; k < mesh.patch_names.size(); ++k) {
        const geometry::SurfaceMesh patch = geometry::patch_of(mesh, mesh.patch_names[k]);
        postproc::DrawnSurface surface;
        for (const geometry::Vec3& p : patch.points) {
            surface.points.push_back({p.x, p.y, p.z});
        }
        for (const geometry::Triangle& t : patch.triangles) {
            surface.triangles.push_back({t[0], t[1], t[2]});
        }
        surface.colour = colours[k % colours.size()];
        surface.edges = mesh.triangles.size() <= 30000;
        scene.surfaces.push_back(std::move(surface));
    }
    return postproc::draw_png(scene);
}

// The facets of a surface file hold less than the smooth surface that they stand for.
std::string facet_error(const geometry::Body& body) {
    const double share = body.volume_left_out / body.mass.volume;
    if (std::abs(share) < 1e-6) {
        return {};
    }
    return ", of its facets; a smooth surface through their corners holds about " + rounded(100 * share, 2) + " % (" +
           rounded(geometry::standard_gravity * body.density * body.volume_left_out, 2) + " N) more";
}

void print_trim(const geometry::Trim& t, Shell& shell) {
    shell.print("trim        mass " + rounded(t.mass, 5) + " kg, net weight " + rounded(t.net_weight, 4) + " N, " +
                (t.stable ? "pitch " + degrees(t.pitch) + " deg, roll " + degrees(t.roll) + " deg, righting " +
                                core::told(t.righting_stiffness, "N m/rad", 4)
                 : t.neutral ? std::string("neutral: the centre of gravity is the centre of buoyancy, it stays as "
                                           "it is turned")
                             : std::string("not stable: the centre of gravity lies above the centre of buoyancy")));
}

void print_added_mass(const geometry::Body& body, Shell& shell) {
    const auto& a = body.added_mass->matrix;
    shell.print("added mass  surge " + rounded(a[0][0], 4) + ", sway " + rounded(a[1][1], 4) + ", heave " +
                rounded(a[2][2], 4) + " kg; roll " + rounded(a[3][3], 4) + ", pitch " + rounded(a[4][4], 4) + ", yaw " +
                rounded(a[5][5], 4) + " kg m^2" +
                (body.placement ? " at a gap of " + rounded(1e3 * body.placement->gap, 4) + " mm" : " in free water"));
    const geometry::Vec3& about = body.added_mass->reference;
    std::string line = "            moments about the " +
                       std::string(body.trim ? "centre of gravity" : "centroid of the volume") + " (" + mm(about.x) +
                       ", " + mm(about.y) + ", " + mm(about.z) + ") mm; " + std::to_string(body.added_mass->panels) +
                       " panels";
    if (body.added_mass->fit) {
        line += " made from the triangles, off them by " + rounded(1e3 * body.added_mass->fit->distance_rms, 3) +
                " mm (RMS), " + rounded(1e3 * body.added_mass->fit->distance_largest, 3) + " mm at most";
    }
    shell.print(line);
}

void print_body(const geometry::Body& body, Shell& shell) {
    const geometry::MassProperties& mass = body.mass;
    const geometry::Certificate& quality = body.certificate;
    shell.print(body.name + ": " + std::to_string(body.mesh.triangles.size()) +
                " triangles, closed, free of self-intersection");
    const geometry::Vec3 size = body.outer_size();
    shell.print("size        length " + rounded(1e3 * size.x) + ", width " + rounded(1e3 * size.y) + ", height " +
                rounded(1e3 * size.z) + " mm over all" +
                (body.shape ? " (body.height, " + mm(body.shape->height) +
                                  " mm, is that of the whole ellipsoid before its base is cut)"
                            : ""));
    shell.print("volume      " + rounded(mass.volume * 1e6) + " cm^3, buoyancy " +
                rounded(mass.buoyancy(body.density)) + " N" +
                (body.shape ? ", of the exact shape" : facet_error(body)));
    shell.print("area        " + rounded(mass.area * 1e4) + " cm^2");
    shell.print("centroid    " + mm(mass.centroid.x) + ", " + mm(mass.centroid.y) + ", " + mm(mass.centroid.z) +
                " mm from the centre of the base (x forward, y to port, z up)");
    for (const geometry::PatchSummary& patch : geometry::patches(body.mesh)) {
        shell.print("patch       " + patch.name + ": " + std::to_string(patch.faces) + " triangles, " +
                    rounded(patch.area * 1e4, 5) + " cm^2");
    }
    std::string line = "quality     smallest angle " + rounded(quality.smallest_angle / core::degree, 3) +
                       " deg, largest aspect ratio " + rounded(quality.largest_aspect_ratio, 3);
    if (quality.exact) {
        line += ", off the exact shape by " + rounded(quality.exact->distance_rms * 1e6, 3) + " um (RMS), " +
                rounded(quality.exact->distance_largest * 1e6, 3) + " um at most; volume " +
                rounded(100 * quality.exact->volume_error, 3) + " %";
    }
    shell.print(line);
    if (body.ballast) {
        shell.print("ballast     moved to " + mm(body.ballast->x) + ", " + mm(body.ballast->y) + ", " +
                    mm(body.ballast->z) + " mm; the trim below is with it there");
    }
    if (body.trim) {
        print_trim(*body.trim, shell);
    }
    if (body.added_mass) {
        print_added_mass(body, shell);
    }
    for (const std::string& remark : body.remarks) {
        shell.print("remark      " + remark);
    }
    if (body.clearance) {
        shell.print("clearance   " + rounded(1e3 * body.clearance->smallest, 4) +
                    " mm at x = " + rounded(1e3 * body.clearance->where.x, 4) +
                    ", y = " + rounded(1e3 * body.clearance->where.y, 4) + " mm (" + body.clearance->patch + ")");
        const auto angle = [](const std::optional<double>& v) {
            return v ? degrees(*v) + " deg" : std::string("none");
        };
        shell.print("contact     at this gap: nose up " + angle(body.contact->nose_up) + ", nose down " +
                    angle(body.contact->nose_down) + ", roll " + angle(body.contact->roll));
    }
}

void write_pictures(const MakeOptions& o, const geometry::Body& body) {
    const geometry::SurfaceMesh& made = body.mesh;
    if (!o.picture.empty()) {
        core::write_file(o.picture, picture_of(body, made));
    }
    if (!o.section.empty()) {
        write_picture(geometry::section_figure(made, body.name), o.section);
    }
    if (!o.underside.empty()) {
        write_picture(geometry::underbody_figure(made, body.name), o.underside);
    }
    if (!o.gap_picture.empty()) {
        write_picture(geometry::gap_figure(made, *body.placement), o.gap_picture);
    }
    if (!o.area_curve.empty()) {
        if (core::lower_case(std::filesystem::path(o.area_curve).extension().string()) == ".csv") {
            core::write_csv(o.area_curve, geometry::table(*body.underside));
        } else {
            write_picture(geometry::figure(*body.underside), o.area_curve);
        }
    }
}

geometry::BodyOptions options_of(const MakeOptions& o) {
    geometry::BodyOptions options = o.input.options();
    for (const auto& [option, value] : {std::pair{"--gap-picture", &o.gap_picture}, {"--area-curve", &o.area_curve}}) {
        if (!value->empty() && !options.placement) {
            throw core::UsageError("missing", std::string(option) + " needs a height over the ground", {},
                                   "add --gap 5mm");
        }
    }
    if (!o.area_up_to.empty()) {
        options.underside_up_to = positive(o.area_up_to, "m", "--area-up-to");
    }
    if (!o.ballast.empty()) {
        options.ballast = geometry::BallastWish{o.ballast, option_value("--trim-pitch", o.trim_pitch, "rad"),
                                                option_value("--trim-roll", o.trim_roll, "rad")};
    }
    for (const auto& assignment : o.set) {
        options.set.push_back(name_and_value("--set", assignment));
    }
    return options;
}

void write_shape_as(const std::string& file, const geometry::Body& body) {
    if (!body.shape) {
        throw core::UsageError("shape", "--as writes a SHAPE.toml, and a surface is none");
    }
    geometry::BodyShape shape = *body.shape;
    shape.name = std::filesystem::path(file).stem().string();
    core::write_file(file, geometry::write_shape(shape));
}

int make_body(const MakeOptions& o, Shell& shell) {
    if (!o.out.empty()) {
        geometry::mesh_format_of(o.out);  // a wrong ending is told before the work
    }
    for (const std::string& file : {o.as, o.out, o.picture, o.section, o.underside, o.gap_picture, o.area_curve}) {
        Shell::will_write(file);
    }
    const geometry::BodyOptions options = options_of(o);
    geometry::Body body = geometry::read_body(o.input.shape, options, shell.progress());
    if (!o.as.empty()) {
        write_shape_as(o.as, body);
    }
    if (const std::string doubt = options.placement ? o.input.doubt(body.mesh) : std::string(); !doubt.empty()) {
        body.remarks.push_back(doubt);
    }
    shell.progress().report(1, "done");
    const geometry::SurfaceMesh& made = body.mesh;
    const geometry::SurfaceMesh placed =
        body.placement ? geometry::placed(made, *body.placement) : geometry::SurfaceMesh{};
    const geometry::SurfaceMesh& shown = body.placement ? placed : made;
    shell.hand_over(shown);
    nlohmann::json document = body;
    if (!o.out.empty()) {
        const geometry::MeshFormat format = geometry::mesh_format_of(o.out);
        const bool ascii = o.ascii && format == geometry::MeshFormat::stl_binary;
        geometry::write_mesh(shown, o.out, ascii ? geometry::MeshFormat::stl_ascii : format,
                             1 / core::convert(1, o.out_unit, "m"));
        document["file"] = o.out;
    }
    write_pictures(o, body);
    if (shell.json) {
        shell.print_json(document);
    } else {
        print_body(body, shell);
    }
    return done;
}

void add_make(CLI::App* command, Shell& shell, const std::shared_ptr<BodyActions>& actions) {
    auto o = std::make_shared<MakeOptions>();
    o->input.add_to(command, false);
    o->input.add_placement(command);
    command->add_option("--set", o->set,
                        "a parameter other than in the file, such as protrusion.height=2mm (repeatable)");
    command->add_option("--as", o->as, "SHAPE.toml to write, of the shape with what was set (without its [mass])");
    command->add_option("--out", o->out, "surface to write: .stl, .obj, .ply or .vtp");
    command->add_option("--out-unit", o->out_unit, "unit of length in that file")->capture_default_str();
    command->add_flag("--ascii", o->ascii, "STL as text, one solid a patch");
    command->add_option("--panels", o->input.panels, "panels of the added mass; 0: leave it out")
        ->capture_default_str();
    command->add_option("--picture", o->picture, "PNG of the body from below");
    command->add_option("--section", o->section, "PNG or PDF of the section with dimensions");
    command->add_option("--underbody", o->underside, "PNG or PDF of the under side with dimensions");
    command->add_option("--gap-picture", o->gap_picture, "PNG or PDF of the gap under the base (with --gap)");
    command->add_option("--area-curve", o->area_curve,
                        "PNG, PDF or CSV: how much of the under side lies lower than a height (with --gap)");
    command->add_option("--area-up-to", o->area_up_to, "height where that curve ends (default: a quarter of the body)");
    auto* ballast = command->add_option(
        "--ballast", o->ballast,
        "name of the point mass that is moved for the wanted trim; mass, trim and added mass are then with it there");
    command->add_option("--trim-pitch", o->trim_pitch, "wanted pitch at rest")->capture_default_str()->needs(ballast);
    command->add_option("--trim-roll", o->trim_roll, "wanted roll at rest")->capture_default_str()->needs(ballast);
    shell.on(command, [o, actions, command, &shell] {
        const auto chosen = command->get_subcommands();
        return chosen.empty() ? make_body(*o, shell) : actions->at(chosen.front())();
    });
}

}  // namespace

void add_body_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand(
        "body", "make the body that a SHAPE.toml describes: surface, mass, added mass, pictures, solver cases");
    command->footer(
        "Examples:\n"
        "  underbody body cases/evie/shapes/ellipse.toml --out evie.stl\n"
        "  underbody body shape.toml --out placed.vtp --gap 5mm --pitch 2deg --json\n"
        "  underbody body shape.toml --set protrusion.height=2mm --set protrusion.length=10mm --as bumped.toml\n"
        "  underbody body hull.stl --unit mm --section hull.png\n"
        "  underbody body compare a.toml b.toml\n"
        "  underbody body added-mass shape.toml --gap 1mm:100mm --out added-mass.csv\n"
        "  underbody body sweep bumps.toml --out bumps\n"
        "  underbody body domain shape.toml --gap 10mm --out case");
    const auto actions = std::make_shared<BodyActions>();
    add_body_compare(command, shell, *actions);
    add_body_added_mass(command, shell, *actions);
    add_body_sweep(command, shell, *actions);
    add_body_domain(command, shell, *actions);
    add_make(command, shell, actions);
}

}  // namespace underbody::studio
