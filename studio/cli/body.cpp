// underbody body: shapes into surfaces, and what they are.
#include <CLI/CLI.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/added_mass.h"
#include "geometry/body_figures.h"
#include "geometry/body_report.h"
#include "geometry/flow_domain.h"
#include "geometry/mesh_file.h"
#include "geometry/variants.h"
#include "postproc/views.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

using core::format_number;

std::string number(double v, int digits = 6) { return format_number(v, digits); }

// What all sub-commands that take one body share.
struct Input {
    std::string shape, unit, gap, pitch, roll, density = "1000 kg/m^3";
    double feature_angle = 20;
    std::size_t triangles = 20000;
    std::size_t panels = 1200;

    void add_to(CLI::App* command, bool placed) {
        // Not required: the command has sub-commands that take other words.
        command->add_option("shape", shape, "SHAPE.toml, or a surface: .stl, .obj, .ply, .vtp");
        command->add_option("--unit", unit, "unit of length of a surface file (they state none): mm, m, in");
        command
            ->add_option("--feature-angle", feature_angle, "degrees: sharper edges part the patches of a surface file")
            ->capture_default_str();
        command->add_option("--triangles", triangles, "about how many triangles")->capture_default_str();
        command->add_option("--density", density, "of the water")->capture_default_str();
        if (placed) {
            command->add_option("--gap", gap, "over the ground, under the centre of the base: 5mm");
            command->add_option("--pitch", pitch, "nose up positive: 2deg");
            command->add_option("--roll", roll, "starboard down positive");
        }
    }
    [[nodiscard]] std::optional<geometry::Placement> placement() const {
        if (gap.empty() && pitch.empty() && roll.empty()) {
            return {};
        }
        if (gap.empty()) {
            throw core::UsageError("missing", "--pitch and --roll need --gap", {}, "add --gap 5mm");
        }
        const auto angle = [](const std::string& text) { return text.empty() ? 0.0 : core::parse_in(text, "rad"); };
        return geometry::Placement{core::parse_in(gap, "m"), angle(pitch), angle(roll)};
    }
    [[nodiscard]] geometry::BodyOptions options() const {
        if (shape.empty()) {
            throw core::UsageError("missing", "which body?", {},
                                   "name a SHAPE.toml or a surface, or see underbody body --help");
        }
        geometry::BodyOptions result;
        result.triangles = triangles;
        if (!unit.empty()) {
            result.unit = unit;
        }
        result.feature_angle = feature_angle;
        result.density = core::parse_in(density, "kg/m^3");
        result.placement = placement();
        result.panels = panels;
        return result;
    }
};

// ---- body SHAPE ----

struct MakeOptions {
    Input input;
    std::string out, out_unit = "m", picture, section, underside, gap_picture, ballast, trim_pitch = "0 deg",
                     trim_roll = "0 deg";
    bool ascii = false;
};

std::string picture_of(const geometry::Body& body, const geometry::SurfaceMesh& mesh) {
    postproc::Scene scene;
    scene.title = body.name;
    scene.subtitle = number(1e6 * body.mass.volume, 5) + " cm^3, from below";
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

void print_body(const geometry::Body& body, Shell& shell) {
    const geometry::MassProperties& mass = body.mass;
    const geometry::Certificate& quality = body.certificate;
    shell.print(body.name + ": " + std::to_string(body.mesh.triangles.size()) +
                " triangles, closed, free of self-intersection");
    shell.print("volume      " + number(mass.volume * 1e6) + " cm^3, buoyancy " + number(mass.buoyancy(body.density)) +
                " N");
    shell.print("area        " + number(mass.area * 1e4) + " cm^2");
    shell.print("centroid    " + number(mass.centroid.x * 1e3, 5) + ", " + number(mass.centroid.y * 1e3, 5) + ", " +
                number(mass.centroid.z * 1e3, 5) + " mm from the centre of the base (x forward, y to port, z up)");
    for (const geometry::PatchSummary& patch : geometry::patches(body.mesh)) {
        shell.print("patch       " + patch.name + ": " + std::to_string(patch.faces) + " triangles, " +
                    number(patch.area * 1e4, 5) + " cm^2");
    }
    std::string line = "quality     smallest angle " + number(quality.smallest_angle * 57.29578, 3) +
                       " deg, largest aspect ratio " + number(quality.largest_aspect_ratio, 3);
    if (quality.exact) {
        line += ", off the exact shape by " + number(quality.exact->distance_rms * 1e6, 3) + " um (RMS), " +
                number(quality.exact->distance_largest * 1e6, 3) + " um at most; volume " +
                number(100 * quality.exact->volume_error, 3) + " %";
    }
    shell.print(line);
    if (body.trim) {
        const geometry::Trim& t = *body.trim;
        shell.print("trim        mass " + number(t.mass, 5) + " kg, net weight " + number(t.net_weight, 4) + " N, " +
                    (t.stable
                         ? "pitch " + number(t.pitch * 57.29578, 4) + " deg, roll " + number(t.roll * 57.29578, 4) +
                               " deg, righting " + number(t.righting_stiffness, 4) + " N m/rad"
                         : std::string("not stable: the centre of gravity lies above the centre of buoyancy")));
    }
    if (body.added_mass) {
        const auto& a = body.added_mass->matrix;
        shell.print(
            "added mass  surge " + number(a[0][0], 4) + ", sway " + number(a[1][1], 4) + ", heave " +
            number(a[2][2], 4) + " kg; roll " + number(a[3][3], 4) + ", pitch " + number(a[4][4], 4) + ", yaw " +
            number(a[5][5], 4) + " kg m^2" +
            (body.placement ? " at a gap of " + number(1e3 * body.placement->gap, 4) + " mm" : " in free water"));
    }
    if (body.clearance) {
        shell.print("clearance   " + number(1e3 * body.clearance->smallest, 4) +
                    " mm at x = " + number(1e3 * body.clearance->where.x, 4) + " mm (" + body.clearance->patch + ")");
    }
}

int make_body(const MakeOptions& o, Shell& shell) {
    if (!o.out.empty()) {
        geometry::mesh_format_of(o.out);  // a wrong ending is told before the work
    }
    geometry::Body body = geometry::read_body(o.input.shape, o.input.options(), shell.progress());
    shell.progress().report(1, "done");
    const geometry::SurfaceMesh& made = body.mesh;
    const geometry::SurfaceMesh placed =
        body.placement ? geometry::placed(made, *body.placement) : geometry::SurfaceMesh{};
    const geometry::SurfaceMesh& shown = body.placement ? placed : made;
    nlohmann::json document = body;
    if (!o.ballast.empty()) {
        if (!body.loading) {
            throw core::InputError("missing", "the shape has no [mass] whose ballast could be placed",
                                   {o.input.shape, {}, {}, {}});
        }
        const geometry::Vec3 at =
            geometry::ballast_position(body.mass, *body.loading, o.ballast, core::parse_in(o.trim_pitch, "rad"),
                                       core::parse_in(o.trim_roll, "rad"));
        document["ballast_position"] = {at.x, at.y, at.z};
        shell.print("ballast     '" + o.ballast + "' at " + number(1e3 * at.x, 5) + ", " + number(1e3 * at.y, 5) +
                    ", " + number(1e3 * at.z, 5) + " mm");
    }
    if (!o.out.empty()) {
        const geometry::MeshFormat format = geometry::mesh_format_of(o.out);
        const bool ascii = o.ascii && format == geometry::MeshFormat::stl_binary;
        geometry::write_mesh(shown, o.out, ascii ? geometry::MeshFormat::stl_ascii : format,
                             1 / core::convert(1, o.out_unit, "m"));
        document["file"] = o.out;
    }
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
        if (!body.placement) {
            throw core::UsageError("missing", "--gap-picture needs --gap");
        }
        write_picture(geometry::gap_figure(made, *body.placement), o.gap_picture);
    }
    if (!body.remark.empty()) {
        shell.warn(body.remark);
    }
    if (shell.json) {
        shell.print_json(document);
    } else {
        print_body(body, shell);
    }
    return done;
}

// The sub-commands' actions: CLI11 calls back the parent too, which must then stand back.
using Actions = std::map<CLI::App*, std::function<int()>>;

void on(Shell& shell, Actions& actions, CLI::App* command, std::function<int()> action) {
    actions[command] = action;
    shell.on(command, std::move(action));
}

void add_make(CLI::App* command, Shell& shell, const std::shared_ptr<Actions>& actions) {
    auto o = std::make_shared<MakeOptions>();
    o->input.add_to(command, true);
    command->add_option("--out", o->out, "surface to write: .stl, .obj, .ply or .vtp");
    command->add_option("--out-unit", o->out_unit, "unit of length in that file")->capture_default_str();
    command->add_flag("--ascii", o->ascii, "STL as text, one solid a patch");
    command->add_option("--panels", o->input.panels, "panels of the added mass; 0: leave it out")
        ->capture_default_str();
    command->add_option("--picture", o->picture, "PNG of the body from below");
    command->add_option("--section", o->section, "PNG or PDF of the section with dimensions");
    command->add_option("--underbody", o->underside, "PNG or PDF of the under side with dimensions");
    command->add_option("--gap-picture", o->gap_picture, "PNG or PDF of the gap under the base (with --gap)");
    command->add_option("--ballast", o->ballast, "name of the point mass to be placed for the wanted trim");
    command->add_option("--trim-pitch", o->trim_pitch, "wanted pitch at rest")->capture_default_str();
    command->add_option("--trim-roll", o->trim_roll, "wanted roll at rest")->capture_default_str();
    shell.on(command, [o, actions, command, &shell] {
        const auto chosen = command->get_subcommands();
        return chosen.empty() ? make_body(*o, shell) : actions->at(chosen.front())();
    });
}

// ---- body compare A B ----

int compare_bodies(const std::string& a, const std::string& b, std::size_t triangles, Shell& shell) {
    const geometry::BodyShape first = geometry::read_shape(a), second = geometry::read_shape(b);
    const geometry::Comparison c = geometry::compare(first, second, triangles, shell.progress());
    shell.progress().report(1, "done");
    if (shell.json) {
        shell.print_json(c);
        return done;
    }
    if (c.equal) {
        shell.print(first.name + " and " + second.name + " are equal");
        return done;
    }
    for (const auto& d : c.differences) {
        shell.print(d.name + (d.unit.empty() || d.unit == "1" ? "" : " [" + d.unit + "]") + ": " + d.a + " -> " + d.b);
    }
    const auto change = [&](const char* name, double x, double y, double scale, const char* unit) {
        shell.print(std::string(name) + ": " + number(scale * x) + " -> " + number(scale * y) + " " + unit + " (" +
                    number(100 * (y / x - 1), 3) + " %)");
    };
    change("volume", c.volume_a, c.volume_b, 1e6, "cm^3");
    change("area", c.mass_a.area, c.mass_b.area, 1e4, "cm^2");
    change("base area", c.base_area_a, c.base_area_b, 1e4, "cm^2");
    shell.print("surfaces differ by at most " + number(1e3 * c.largest_distance, 4) + " mm, at (" +
                number(1e3 * c.where.x, 4) + ", " + number(1e3 * c.where.y, 4) + ", " + number(1e3 * c.where.z, 4) +
                ") mm");
    return done;
}

void add_compare(CLI::App* body, Shell& shell, Actions& actions) {
    CLI::App* command = body->add_subcommand("compare", "what differs between two shapes, and what that does");
    struct Options {
        std::string a, b;
        std::size_t triangles = 6000;
    };
    auto o = std::make_shared<Options>();
    command->add_option("a", o->a, "SHAPE.toml")->required();
    command->add_option("b", o->b, "SHAPE.toml")->required();
    command->add_option("--triangles", o->triangles, "about how many triangles")->capture_default_str();
    command->footer(
        "Example:\n  underbody body compare cases/evie/shapes/rectangle.toml cases/evie/shapes/rectangle_bump2.toml");
    on(shell, actions, command, [o, &shell] { return compare_bodies(o->a, o->b, o->triangles, shell); });
}

// ---- body added-mass ----

struct AddedMassCommand {
    std::string shape, gap = "1mm:100mm", pitch = "0 deg", density = "1000 kg/m^3", out, picture;
    std::size_t panels = 2000, count = 9;
};

// "1mm:100mm" as `count` gaps in equal ratios, or a list "1mm,2mm".
std::vector<double> gaps_of(const AddedMassCommand& o) {
    std::vector<double> gaps;
    const auto colon = o.gap.find(':');
    if (colon == std::string::npos) {
        for (const std::string_view part : core::split(o.gap, ',')) {
            gaps.push_back(core::parse_in(part, "m"));
        }
    } else {
        const double low = core::parse_in(o.gap.substr(0, colon), "m"),
                     high = core::parse_in(o.gap.substr(colon + 1), "m");
        if (!(low > 0 && high > low) || o.count < 2) {
            throw core::UsageError("range", "--gap " + o.gap + " is no range of gaps", {},
                                   "for example 1mm:100mm, with --count 2 or more");
        }
        for (std::size_t i = 0; i < o.count; ++i) {
            gaps.push_back(low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(o.count - 1)));
        }
    }
    for (const double gap : gaps) {
        if (!(gap > 0)) {
            throw core::UsageError("range", "a gap of " + number(gap) + " m", {}, "gaps are positive");
        }
    }
    return gaps;
}

int added_mass_table(const AddedMassCommand& o, Shell& shell) {
    const geometry::BodyShape shape = geometry::read_shape(o.shape);
    geometry::AddedMassOptions options;
    options.density = core::parse_in(o.density, "kg/m^3");
    options.placement = geometry::Placement{0, core::parse_in(o.pitch, "rad"), 0};
    const geometry::AddedMassSweep sweep =
        geometry::added_mass_against_gap(shape, gaps_of(o), o.panels, options, shell.progress());
    shell.progress().report(1, "done");
    const core::Table table = geometry::table(sweep);
    if (!o.out.empty()) {
        core::write_csv(o.out, table);
    }
    if (!o.picture.empty()) {
        write_picture(geometry::figure(sweep, shape.name), o.picture);
    }
    if (shell.json) {
        nlohmann::json document{{"name", shape.name}, {"free_water", sweep.free_water}, {"gaps", sweep.at_gap}};
        shell.print_json(document);
    } else if (o.out.empty()) {
        shell.print(core::write_csv(table));
    } else {
        shell.print(o.out + ": " + std::to_string(table.rows()) + " gaps");
    }
    return done;
}

void add_added_mass(CLI::App* body, Shell& shell, Actions& actions) {
    CLI::App* command = body->add_subcommand("added-mass", "table of the added mass against the gap, for model.toml");
    auto o = std::make_shared<AddedMassCommand>();
    command->add_option("shape", o->shape, "SHAPE.toml")->required();
    command->add_option("--gap", o->gap, "range 1mm:100mm (equal ratios) or list 1mm,2mm,5mm")->capture_default_str();
    command->add_option("--count", o->count, "gaps in the range")->capture_default_str();
    command->add_option("--pitch", o->pitch, "nose up positive")->capture_default_str();
    command->add_option("--panels", o->panels, "panels of the body")->capture_default_str();
    command->add_option("--density", o->density, "of the water")->capture_default_str();
    command->add_option("--out", o->out, "CSV to write; else it is printed");
    command->add_option("--picture", o->picture, "PNG or PDF of the curves");
    command->footer(
        "Example:\n  underbody body added-mass cases/evie/shapes/ellipse.toml --gap 1mm:100mm --out added-mass.csv "
        "--picture added-mass.png");
    on(shell, actions, command, [o, &shell] { return added_mass_table(*o, shell); });
}

// ---- body sweep ----

int sweep_shapes(const std::string& file, const std::string& out, std::size_t triangles, Shell& shell) {
    geometry::VariantSet set = geometry::read_variants(file);
    const std::vector<geometry::MadeVariant> made = geometry::make_variants(set, triangles, shell.progress());
    shell.progress().report(1, "done");
    const core::Table table = geometry::table(set, made);
    std::vector<geometry::NamedBody> bodies;
    std::size_t refused = 0, equal = 0;
    for (const geometry::MadeVariant& m : made) {
        refused += m.variant->refused.empty() ? 0 : 1;
        equal += m.variant->same_as.empty() ? 0 : 1;
        if (m.mesh.triangles.empty()) {
            continue;
        }
        bodies.push_back({m.variant->name, &m.mesh});
        if (!out.empty()) {
            core::write_file(std::filesystem::path(out) / (m.variant->name + ".toml"),
                             geometry::write_shape(m.variant->shape));
            geometry::write_mesh(m.mesh, std::filesystem::path(out) / (m.variant->name + ".stl"));
        }
    }
    if (!out.empty()) {
        core::write_csv(std::filesystem::path(out) / "shapes.csv", table);
        if (!bodies.empty()) {
            bodies.resize(std::min<std::size_t>(bodies.size(), 60));  // more than a sheet can show
            write_picture(geometry::sheet_figure(bodies, set.name), std::filesystem::path(out) / "sheet.png",
                          {1400, 1000, 1.5});
        }
    }
    if (shell.json) {
        nlohmann::json document{{"name", set.name}, {"keys", set.keys}, {"variants", nlohmann::json::array()}};
        for (const geometry::MadeVariant& m : made) {
            nlohmann::json entry{{"name", m.variant->name},
                                 {"values", m.variant->values},
                                 {"same_as", m.variant->same_as},
                                 {"refused", m.variant->refused}};
            if (!m.mesh.triangles.empty()) {
                entry["volume"] = m.mass.volume;
                entry["area"] = m.mass.area;
                entry["quality"] = m.certificate;
            }
            document["variants"].push_back(entry);
        }
        shell.print_json(document);
    } else if (out.empty()) {
        shell.print(core::write_csv(table));
    } else {
        shell.print(std::to_string(made.size()) + " shapes: " + std::to_string(made.size() - refused - equal) +
                    " made, " + std::to_string(equal) + " equal to an earlier one, " + std::to_string(refused) +
                    " refused; " + out + "/shapes.csv, sheet.png");
    }
    return refused == made.size() ? check_failed : done;
}

void add_sweep(CLI::App* body, Shell& shell, Actions& actions) {
    CLI::App* command =
        body->add_subcommand("sweep", "all shapes of a file with [[vary]] lists or ranges and [[tie]]s");
    struct Options {
        std::string file, out;
        std::size_t triangles = 20000;
    };
    auto o = std::make_shared<Options>();
    command->add_option("file", o->file, "a SHAPE.toml with [[vary]]")->required();
    command->add_option("--out", o->out, "folder for the shapes, their surfaces, shapes.csv and sheet.png");
    command->add_option("--triangles", o->triangles, "about how many triangles each")->capture_default_str();
    command->footer(
        "Example of a file: a shape, and below it\n"
        "  [[vary]]\n  key = \"protrusion.height\"\n  values = [\"1 mm\", \"2 mm\", \"3 mm\"]\n"
        "  [[vary]]\n  key = \"body.base_cut\"\n  from = 0.6\n  to = 0.8\n  count = 5\n"
        "  [[tie]]\n  key = \"protrusion.length\"\n  of = \"protrusion.height\"\n  factor = 5\n"
        "Then:\n  underbody body sweep bumps.toml --out bumps");
    on(shell, actions, command, [o, &shell] { return sweep_shapes(o->file, o->out, o->triangles, shell); });
}

// ---- body domain ----

struct DomainCommand {
    Input input;
    std::string solver = "openfoam", out, speed = "0.5 m/s", viscosity = "1e-6 m^2/s";
    geometry::FlowOptions flow;
    bool whole = false;
};

int write_domain(DomainCommand& o, Shell& shell) {
    const auto placement = o.input.placement();
    if (!placement) {
        throw core::UsageError("missing", "a flow domain needs --gap", {}, "add --gap 5mm");
    }
    geometry::BodyOptions options = o.input.options();
    options.panels = 0;
    const geometry::Body body = geometry::read_body(o.input.shape, options, shell.progress());
    o.flow.placement = *placement;
    o.flow.speed = core::parse_in(o.speed, "m/s");
    o.flow.kinematic_viscosity = core::parse_in(o.viscosity, "m^2/s");
    o.flow.density = options.density;
    o.flow.half = !o.whole;
    const geometry::FlowDomain domain = geometry::flow_domain(body.mesh, o.flow);
    const auto files = o.solver == "openfoam" ? geometry::write_openfoam_case(body.mesh, o.flow, o.out)
                                              : geometry::write_ansys_case(body.mesh, o.flow, o.out);
    if (domain.cells_in_gap < 3 && o.solver == "openfoam") {
        shell.warn("only " + number(domain.cells_in_gap, 2) +
                   " cells across the smallest clearance: choose a smaller --cell");
    }
    nlohmann::json document{{"solver", o.solver},
                            {"folder", o.out},
                            {"boundaries", domain.boundaries},
                            {"walls", domain.walls},
                            {"cells_in_gap", domain.cells_in_gap},
                            {"clearance", domain.clearance},
                            {"files", nlohmann::json::array()}};
    for (const auto& file : files) {
        document["files"].push_back(file.string());
    }
    if (shell.json) {
        shell.print_json(document);
    } else {
        shell.print(
            o.out + ": " + std::to_string(files.size()) + " files; " +
            (o.solver == "openfoam" ? "run " + o.out + "/Allrun" : "mesh surfaces/, then fluent.jou or cfx.ccl"));
    }
    return done;
}

void add_domain(CLI::App* body, Shell& shell, Actions& actions) {
    CLI::App* command =
        body->add_subcommand("domain", "the flow past the body over a moving ground, as a case for a solver");
    auto o = std::make_shared<DomainCommand>();
    o->input.add_to(command, true);
    command->add_option("--solver", o->solver, "openfoam or ansys")
        ->check(CLI::IsMember({"openfoam", "ansys"}))
        ->capture_default_str();
    command->add_option("--out", o->out, "new folder")->required();
    command->add_option("--speed", o->speed, "of the stream and the ground")->capture_default_str();
    command->add_option("--viscosity", o->viscosity, "kinematic")->capture_default_str();
    command->add_flag("--whole", o->whole, "both halves (default: the port half with a plane of symmetry)");
    command->add_option("--cell", o->flow.cell, "background cell, in body lengths")->capture_default_str();
    command->add_option("--surface-level", o->flow.surface_level, "halvings of the cell at the body")
        ->capture_default_str();
    command->add_option("--layers", o->flow.layers, "prism layers")->capture_default_str();
    command->add_option("--iterations", o->flow.iterations, "of the solver")->capture_default_str();
    command->footer(
        "Examples:\n"
        "  underbody body domain shape.toml --gap 10mm --out case && case/Allrun\n"
        "  underbody body domain shape.toml --gap 5mm --pitch 2deg --solver ansys --out for-fluent");
    on(shell, actions, command, [o, &shell] { return write_domain(*o, shell); });
}

}  // namespace

void add_body_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand(
        "body", "make the body that a SHAPE.toml describes: surface, mass, added mass, pictures, solver cases");
    command->footer(
        "Examples:\n"
        "  underbody body cases/evie/shapes/ellipse.toml --out evie.stl\n"
        "  underbody body shape.toml --out placed.vtp --gap 5mm --pitch 2deg --json\n"
        "  underbody body hull.stl --unit mm --section hull.png\n"
        "  underbody body compare a.toml b.toml\n"
        "  underbody body added-mass shape.toml --gap 1mm:100mm --out added-mass.csv\n"
        "  underbody body sweep bumps.toml --out bumps\n"
        "  underbody body domain shape.toml --gap 10mm --out case");
    const auto actions = std::make_shared<Actions>();
    add_compare(command, shell, *actions);
    add_added_mass(command, shell, *actions);
    add_sweep(command, shell, *actions);
    add_domain(command, shell, *actions);
    add_make(command, shell, actions);
}

}  // namespace underbody::studio
