// underbody body added-mass, underbody body domain: the water around a body.
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/table.h"
#include "core/told.h"
#include "core/units.h"
#include "geometry/cases/flow_domain.h"
#include "geometry/water/added_mass.h"
#include "studio/cli/body_parts.h"
#include "studio/cli/option_value.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

using core::format_number;

// ---- body added-mass ----

struct AddedMassCommand {
    std::string shape, unit, gap = "1mm:100mm", pitch = "0 deg", density = default_density(), out, picture;
    std::size_t panels = 2000, count = 9;
};

// "1mm:100mm" as `count` gaps in equal ratios, or a list "1mm,2mm".
std::vector<double> gaps_of(const AddedMassCommand& o) {
    std::vector<double> gaps;
    const auto colon = o.gap.find(':');
    if (colon == std::string::npos) {
        for (const std::string_view part : core::split(o.gap, ',')) {
            gaps.push_back(option_value("--gap", std::string(part), "m"));
        }
    } else {
        const double low = option_value("--gap", o.gap.substr(0, colon), "m"),
                     high = option_value("--gap", o.gap.substr(colon + 1), "m");
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
            throw core::UsageError("range", "a gap of " + core::told(gap, "m"), {}, "gaps are positive");
        }
    }
    return gaps;
}

int added_mass_table(const AddedMassCommand& o, Shell& shell) {
    BodyInput input;
    input.shape = o.shape;
    input.unit = o.unit;
    input.density = o.density;
    input.panels = o.panels;
    geometry::BodyOptions reading = input.options();
    reading.panels = 0;
    const std::vector<double> gaps = gaps_of(o);
    const geometry::Body body = geometry::read_body(o.shape, reading, shell.progress());
    geometry::AddedMassOptions options;
    options.density = reading.density;
    options.placement = geometry::Placement{0, option_value("--pitch", o.pitch, "rad"), 0};
    options.reference = body.trim ? body.trim->centre_of_gravity : body.mass.centroid;
    const geometry::AddedMassSweep sweep =
        body.shape ? geometry::added_mass_against_gap(*body.shape, gaps, o.panels, options, shell.progress())
                   : geometry::added_mass_against_gap(body.mesh, gaps, o.panels, options, shell.progress());
    shell.progress().report(1, "done");
    const core::Table table = geometry::table(sweep);
    if (!o.out.empty()) {
        core::write_csv(o.out, table);
    }
    if (!o.picture.empty()) {
        write_picture(geometry::figure(sweep, body.name), o.picture);
    }
    if (shell.json) {
        nlohmann::json document{{"name", body.name},
                                {"free_water", sweep.free_water},
                                {"gaps", sweep.at_gap},
                                {"moments_about", body.trim ? "centre of gravity" : "centroid of the volume"}};
        shell.print_json(document);
    } else if (o.out.empty()) {
        shell.print(core::write_csv(table));
    } else {
        shell.print(o.out + ": " + core::counted(table.rows(), "gap"));
    }
    return done;
}

// ---- body domain ----

struct DomainCommand {
    BodyInput input;
    std::string solver = "openfoam", out, speed = "0.5 m/s", viscosity = "1e-6 m^2/s";
    std::string mesher, density = "medium", jet = "0 m^3/s";
    geometry::FlowOptions flow;
    bool whole = false;
};

/// Index of a name in a list of names that was checked.
template <class Enum>
Enum named(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<Enum>(std::find(names.begin(), names.end(), name) - names.begin());
}

std::vector<std::string> boundaries_of(const geometry::BlockCase& made) {
    std::vector<std::string> names;
    for (const auto& patch : made.mesh.mesh.patches) {
        if (std::find(made.mesh.walls.begin(), made.mesh.walls.end(), patch.name) == made.mesh.walls.end()) {
            names.push_back(patch.name);
        }
    }
    return names;
}

std::string mesh_text(const geometry::BlockMesh& mesh) {
    const auto& q = mesh.quality;
    return core::counted(q.cells, "cell") + ", " + std::to_string(mesh.cells_in_gap) +
           " across the gap, non-orthogonality at most " +
           rounded(core::convert(q.largest_non_orthogonality, "rad", "deg"), 3) + " deg, skewness at most " +
           rounded(q.largest_skewness, 3) + ", y+ about " + rounded(mesh.wall_units_mean, 2);
}

/// Of blocks or cut out of a background (snappy); blocks need a shape of the family.
bool by_blocks(const DomainCommand& o, const geometry::Body& body) {
    const bool blocks = o.solver == "openfoam" && (o.mesher.empty() ? body.shape.has_value() : o.mesher == "blocks");
    if (o.flow.jet_flow != 0 && !blocks) {
        throw core::UsageError("choice", "a jet needs a mesh of blocks for OpenFOAM", {}, "--mesher blocks");
    }
    if (blocks && !body.shape) {
        throw core::UsageError("choice", "blocks are for bodies of the family, which a SHAPE.toml describes", {},
                               "--mesher snappy takes any surface");
    }
    if (body.shape && geometry::tail_plate(*body.shape) != nullptr && !blocks) {
        throw core::UsageError("mesh",
                               "the body '" + body.shape->name + "' has a tail plate, which blocks alone can mesh", {},
                               "--solver openfoam --mesher blocks, or a shape without [tail_plate]");
    }
    return blocks;
}

nlohmann::json json_of(const DomainCommand& o, const geometry::FlowDomain& domain,
                       const std::optional<geometry::BlockCase>& made,
                       const std::vector<std::filesystem::path>& files) {
    const bool blocks = made.has_value();
    nlohmann::json document{{"solver", o.solver},
                            {"folder", o.out},
                            {"boundaries", blocks ? boundaries_of(*made) : domain.boundaries},
                            {"walls", domain.walls},
                            {"cells_in_gap", blocks ? made->mesh.cells_in_gap : domain.cells_in_gap},
                            {"clearance", domain.clearance},
                            {"files", nlohmann::json::array()}};
    for (const auto& file : files) {
        document["files"].push_back(file.string());
    }
    if (o.solver == "openfoam") {
        document["mesher"] = blocks ? "blocks" : "snappy";
        document["mesh"] = blocks ? nlohmann::json(made->mesh) : nlohmann::json(nullptr);
    }
    return document;
}

void show_doubts(Shell& shell, const DomainCommand& o, const geometry::Body& body, const geometry::FlowDomain& domain,
                 bool blocks) {
    if (const std::string doubt = o.input.doubt(body.mesh); !doubt.empty()) {
        shell.show_warning(doubt);
    }
    if (const std::string doubt = geometry::doubt_of_gap(o.flow.placement.gap); !doubt.empty()) {
        shell.show_warning(doubt);
    }
    if (domain.cells_in_gap < 3 && o.solver == "openfoam" && !blocks) {
        shell.show_warning("only " + rounded(domain.cells_in_gap, 2) +
                           " cells across the smallest clearance: choose a smaller --cell");
    }
}

int write_domain(DomainCommand& o, Shell& shell) {
    const auto placement = o.input.placement();
    if (!placement) {
        throw core::UsageError("missing", "a flow domain needs --gap", {}, "add --gap 5mm");
    }
    geometry::BodyOptions options = o.input.options();
    options.panels = 0;
    const geometry::Body body = geometry::read_body(o.input.shape, options, shell.progress());
    o.flow.placement = *placement;
    o.flow.speed = option_value("--speed", o.speed, "m/s");
    o.flow.kinematic_viscosity = option_value("--viscosity", o.viscosity, "m^2/s");
    o.flow.density = options.density;
    o.flow.half = !o.whole;
    o.flow.jet_flow = option_value("--jet-flow", o.jet, "m^3/s");
    const geometry::FlowDomain domain = geometry::flow_domain(body.mesh, o.flow);
    const bool blocks = by_blocks(o, body);
    o.flow.mesher = blocks ? geometry::CaseMesher::blocks : geometry::CaseMesher::snappy;
    o.flow.mesh_density = named<geometry::MeshDensity>(geometry::density_names(), o.density);
    std::optional<geometry::BlockCase> made;
    std::vector<std::filesystem::path> files;
    if (blocks) {
        made = geometry::write_block_case(*body.shape, o.flow, o.out, shell.progress());
        files = made->files;
    } else {
        files = o.solver == "openfoam" ? geometry::write_openfoam_case(body.mesh, o.flow, o.out)
                                       : geometry::write_ansys_case(body.mesh, o.flow, o.out);
    }
    show_doubts(shell, o, body, domain, blocks);
    const nlohmann::json document = json_of(o, domain, made, files);
    if (shell.json) {
        shell.print_json(document);
    } else {
        shell.print(
            o.out + ": " + core::counted(files.size(), "file") + "; " + (blocks ? mesh_text(made->mesh) + "; " : "") +
            (o.solver == "openfoam" ? "run " + o.out + "/Allrun" : "mesh surfaces/, then fluent.jou or cfx.ccl"));
    }
    return done;
}

}  // namespace

void add_body_added_mass(CLI::App* body, Shell& shell, BodyActions& actions) {
    CLI::App* command = body->add_subcommand("added-mass", "table of the added mass against the gap, for model.toml");
    auto o = std::make_shared<AddedMassCommand>();
    command->add_option("shape", o->shape, "SHAPE.toml, or a surface: .stl, .obj, .ply, .vtp")->required();
    command->add_option("--unit", o->unit, "unit of length of a surface file: mm, m, in");
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

void add_body_domain(CLI::App* body, Shell& shell, BodyActions& actions) {
    CLI::App* command =
        body->add_subcommand("domain", "the flow past the body over a moving ground, as a case for a solver");
    auto o = std::make_shared<DomainCommand>();
    o->input.add_to(command, true);
    o->input.add_placement(command);
    command->add_option("--solver", o->solver, "openfoam or ansys")
        ->check(CLI::IsMember({"openfoam", "ansys"}))
        ->capture_default_str();
    command->add_option("--out", o->out, "new folder")->required();
    command->add_option("--speed", o->speed, "of the stream and the ground")->capture_default_str();
    command->add_option("--viscosity", o->viscosity, "kinematic")->capture_default_str();
    command->add_flag("--whole", o->whole, "both halves (default: the port half with a plane of symmetry)");
    command
        ->add_option("--mesher", o->mesher,
                     "of OpenFOAM: blocks (hexahedra, many cells in any gap; default for a SHAPE.toml) or snappy "
                     "(snappyHexMesh; default for a surface, or with --cell, --surface-level, --layers)")
        ->check(CLI::IsMember(geometry::mesher_names()));
    command->add_option("--mesh-density", o->density, "blocks: draft, coarse, medium or fine")
        ->check(CLI::IsMember(geometry::density_names()))
        ->capture_default_str();
    command->add_option("--jet-flow", o->jet, "blocks: through the nozzle of the whole body, 50mL/s")
        ->capture_default_str();
    auto* cell =
        command->add_option("--cell", o->flow.cell, "snappy: background cell, in body lengths")->capture_default_str();
    auto* level =
        command->add_option("--surface-level", o->flow.surface_level, "snappy: halvings of the cell at the body")
            ->capture_default_str();
    auto* layers = command->add_option("--layers", o->flow.layers, "snappy: prism layers")->capture_default_str();
    command->add_option("--iterations", o->flow.iterations,
                        "of the solver at most (default: blocks 800, snappy and ansys 400); a run of blocks ends when "
                        "its loads have settled");
    command->footer(
        "Examples:\n"
        "  underbody body domain shape.toml --gap 10mm --out case && case/Allrun\n"
        "  underbody body domain shape.toml --gap 5mm --pitch 2deg --solver ansys --out for-fluent");
    on(shell, actions, command, [o, cell, level, layers, &shell] {
        if (o->mesher.empty() && cell->count() + level->count() + layers->count() > 0) {
            o->mesher = "snappy";
        }
        return write_domain(*o, shell);
    });
}

}  // namespace underbody::studio
