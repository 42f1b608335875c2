// Surfaces, Fluent journal, CFX CCL and CFD-Post session of a flow domain.
#include <algorithm>
#include <cmath>
#include <map>

#include "core/file.h"
#include "geometry/body/patch_mesher.h"
#include "geometry/cases/case_files.h"
#include "geometry/cases/flow_domain.h"
#include "geometry/mesh/mesh_file.h"

namespace underbody::geometry {

namespace {

namespace fs = std::filesystem;

// A side of the box as two triangles whose normals point out of the water.
SurfaceMesh side(const std::string& name, const std::array<Vec3, 4>& corners) {
    SurfaceMesh mesh;
    mesh.points.assign(corners.begin(), corners.end());
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.patch = {0, 0};
    mesh.patch_names = {name};
    return mesh;
}

std::vector<SurfaceMesh> sides(const FlowDomain& domain) {
    const Vec3 &a = domain.box.lower, &b = domain.box.upper;
    return {side("inlet", {{{b.x, a.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {b.x, a.y, b.z}}}),
            side("outlet", {{{a.x, a.y, a.z}, {a.x, a.y, b.z}, {a.x, b.y, b.z}, {a.x, b.y, a.z}}}),
            side("ground", {{{a.x, a.y, a.z}, {a.x, b.y, a.z}, {b.x, b.y, a.z}, {b.x, a.y, a.z}}}),
            side("top", {{{a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z}}}),
            side("side", {{{a.x, b.y, a.z}, {a.x, b.y, b.z}, {b.x, b.y, b.z}, {b.x, b.y, a.z}}}),
            side(domain.boundaries.back(), {{{a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, a.y, b.z}, {a.x, a.y, b.z}}})};
}

/// The plane without the section of the body, which is bounded by the edges of one triangle only.
PatchProblem plane_around(const FlowDomain& domain, const SurfaceMesh& half) {
    std::map<std::pair<std::int32_t, std::int32_t>, int> seen;
    for (const Triangle& t : half.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            ++seen[std::minmax(t[k], t[(k + 1) % 3])];
        }
    }
    PatchProblem problem;
    const Vec3 &a = domain.box.lower, &b = domain.box.upper;
    problem.points = {{a.x, a.z}, {b.x, a.z}, {b.x, b.z}, {a.x, b.z}};
    problem.segments = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
    std::map<std::int32_t, std::int32_t> number;
    Vec3 middle;
    const auto local = [&](std::int32_t p) {
        const auto [found, fresh] = number.emplace(p, static_cast<std::int32_t>(problem.points.size()));
        if (fresh) {
            const Vec3& at = half.points[static_cast<std::size_t>(p)];
            problem.points.push_back({at.x, at.z});
            middle += at;
        }
        return found->second;
    };
    for (const auto& [edge, count] : seen) {
        if (count == 1) {
            const std::int32_t from = local(edge.first), to = local(edge.second);
            problem.segments.push_back({from, to});
        }
    }
    middle = middle / static_cast<double>(number.size());
    problem.seeds = {{{middle.x, middle.z}, 1}};  // inside the body: left out
    const double edge = 0.1 * (b.x - a.x);
    problem.edge = [edge](const PlanePoint&) { return edge; };
    problem.surface = [](const PlanePoint& p) { return Vec3{p.u, 0, p.v}; };
    return problem;
}

// The plane y = 0 of a half model, around the section of the body, with the body's own points on it.
SurfaceMesh symmetry_plane(const FlowDomain& domain, const SurfaceMesh& half) {
    const PatchTriangles filled = fill_patch(plane_around(domain, half));
    SurfaceMesh mesh;
    mesh.patch_names = {"symmetry"};
    for (const PlanePoint& p : filled.points) {
        mesh.points.push_back({p.u, 0, p.v});
    }
    for (std::size_t i = 0; i < filled.triangles.size(); ++i) {
        if (filled.label[i] == 0) {  // counter-clockwise in (x, z) looks toward -y: out of the water
            mesh.triangles.push_back(filled.triangles[i]);
            mesh.patch.push_back(0);
        }
    }
    return mesh;
}

std::string joined(const std::vector<std::string>& names, const std::string& between) {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : between) + name;
    }
    return text;
}

/// Lift, drag and pitch moment of the walls.
std::string journal_reports(const FlowDomain& d, double gap) {
    std::string text;
    const std::string walls = joined(d.walls, " ");
    const auto report = [&](const std::string& name, const std::string& kind, const std::string& vector) {
        text += "/solve/report-definitions/add " + name + " " + kind + " thread-names " + walls + " () " + vector +
                " quit\n";
    };
    report("lift", "force", "force-vector 0 0 1");
    report("drag", "force", "force-vector -1 0 0");
    // Nose up is a turn of x toward z: about -y.
    report("pitch-moment", "moment", "mom-center 0 0 " + digits(gap) + " mom-axis 0 -1 0");
    return text;
}

/// The stream at the inlet, the outlet and the sliding ground.
std::string journal_stream(const FlowOptions& o) {
    const std::string v = digits(o.speed);
    return "; turbulence of the stream: the third choice of ke-spec, intensity in per cent and viscosity ratio\n"
           "/define/boundary-conditions/set/velocity-inlet inlet () vmag no " +
           v + " ke-spec no no yes turb-intensity " + digits(100 * o.turbulence_intensity) + " turb-viscosity-ratio " +
           digits(o.viscosity_ratio) + " quit\n" +
           "/define/boundary-conditions/set/pressure-outlet outlet () gauge-pressure no 0 quit\n"
           "; the ground slides with the stream, " +
           v +
           " m/s toward -x: a negative speed along +x, the direction a wall has unless told otherwise\n"
           "/define/boundary-conditions/set/wall ground () motion-bc yes motion-bc-moving relative? no vmag no -" +
           v +
           " quit\n"
           "/solve/set/p-v-coupling 24\n/solve/set/discretization-scheme/mom 1\n/solve/set/discretization-scheme/k "
           "1\n/solve/set/discretization-scheme/omega 1\n";
}

std::string journal(const FlowDomain& d, const FlowOptions& o) {
    const double mu = o.density * o.kinematic_viscosity, k = 1.5 * std::pow(o.turbulence_intensity * o.speed, 2);
    const double omega = k / (o.viscosity_ratio * o.kinematic_viscosity);
    const std::string v = digits(o.speed);
    std::string text =
        "; Fluent journal: steady flow past the body, k-omega SST, ground moving with the stream.\n"
        "; Mesh the surfaces of surfaces/ with these zone names and save it as mesh.msh.h5 beside this file; then\n"
        ";   fluent 3ddp -g -i fluent.jou\n"
        "; Axes: x forward, y to port, z up; the stream runs toward -x. Lengths in m.\n"
        "; The prompts are those of Fluent 2022 R2; later releases keep to them by the next line.\n"
        "/file/set-tui-version \"22.2\"\n"
        "/file/set-batch-options no yes yes no\n"
        "/file/read-case \"mesh.msh.h5\"\n/mesh/check\n"
        "/define/models/steady? yes\n/define/models/viscous/kw-sst? yes\n"
        "/define/materials/change-create air water yes constant " +
        digits(o.density) + " no no yes constant " + digits(mu) +
        " no no no yes\n"
        "/define/boundary-conditions/zone-type inlet velocity-inlet\n"
        "/define/boundary-conditions/zone-type outlet pressure-outlet\n"
        "/define/boundary-conditions/zone-type ground wall\n"
        "/define/boundary-conditions/zone-type top symmetry\n/define/boundary-conditions/zone-type side symmetry\n"
        "/define/boundary-conditions/zone-type " +
        d.boundaries.back() + " symmetry\n";
    for (const std::string& wall : d.walls) {
        text += "/define/boundary-conditions/zone-type " + wall + " wall\n";
    }
    text += journal_stream(o);
    text += journal_reports(d, o.placement.gap);
    text +=
        "/solve/report-files/add forces report-defs lift drag pitch-moment () file-name \"forces.out\" quit\n"
        "; k " +
        digits(k) + " m^2/s^2, omega " + digits(omega) +
        " 1/s in the stream\n"
        "/solve/initialize/compute-defaults/velocity-inlet inlet\n/solve/initialize/initialize-flow\n"
        "/solve/iterate " +
        std::to_string(o.iterations > 0 ? o.iterations : 400) +
        "\n"
        "/file/write-case-data \"result.cas.h5\"\n"
        "; read back with: underbody loads result.cas.h5\n"
        "/file/export/ensight-gold \"result\" pressure wall-shear x-wall-shear y-wall-shear z-wall-shear () no * () () "
        "no\n"
        "/exit yes\n";
    return text;
}

std::string ccl_boundary(const std::string& name, const std::string& type, const std::string& body) {
    return "    BOUNDARY: " + name + "\n      Boundary Type = " + type + "\n      Location = " + name + "\n" + body +
           "    END\n";
}

/// Lift, drag and pitch moment of the walls, as expressions.
std::string ccl_forces(const FlowDomain& d, double gap) {
    std::string lift, drag, moment;
    for (const std::string& wall : d.walls) {
        const std::string plus = lift.empty() ? "" : " + ";
        lift += plus + "force_z()@" + wall;
        drag += (drag.empty() ? "-force_x()@" : " - force_x()@") + wall;
        // about the centre of the base: torque at the origin less gap times force_x, nose up = -y
        moment += (moment.empty() ? "-torque_y()@" : " - torque_y()@") + wall;
    }
    return "      LiftForce = " + lift + "\n      DragForce = " + drag + "\n      PitchMoment = " + moment + " - " +
           digits(gap) + " [m] * DragForce\n    END\n  END\nEND\n";
}

std::string ccl_boundaries(const FlowDomain& d, const FlowOptions& o) {
    const std::string v = digits(o.speed) + " [m s^-1]";
    const std::string no_slip =
        "      BOUNDARY CONDITIONS:\n        MASS AND MOMENTUM:\n          Option = No Slip Wall\n        END\n      "
        "END\n";
    std::string text =
        ccl_boundary("inlet", "INLET",
                     "      BOUNDARY CONDITIONS:\n        FLOW REGIME:\n          Option = Subsonic\n        END\n     "
                     "   MASS AND MOMENTUM:\n          Option = Cartesian Velocity Components\n          U = -" +
                         v +
                         "\n          V = 0 [m s^-1]\n          W = 0 [m s^-1]\n        END\n        TURBULENCE:\n     "
                         "     Eddy Viscosity Ratio = " +
                         digits(o.viscosity_ratio) +
                         "\n          Fractional Intensity = " + digits(o.turbulence_intensity) +
                         "\n          Option = Intensity and Eddy Viscosity Ratio\n        END\n      END\n") +
        ccl_boundary("outlet", "OPENING",
                     "      BOUNDARY CONDITIONS:\n        FLOW REGIME:\n          Option = Subsonic\n        END\n     "
                     "   MASS AND MOMENTUM:\n          Option = Entrainment\n          Relative Pressure = 0 [Pa]\n    "
                     "    END\n        TURBULENCE:\n          Option = Zero Gradient\n        END\n      END\n") +
        ccl_boundary("ground", "WALL",
                     "      BOUNDARY CONDITIONS:\n        MASS AND MOMENTUM:\n          Option = No Slip Wall\n        "
                     "  WALL VELOCITY:\n            Option = Cartesian Components\n            Wall U = -" +
                         v +
                         "\n            Wall V = 0 [m s^-1]\n            Wall W = 0 [m s^-1]\n          END\n        "
                         "END\n      END\n") +
        ccl_boundary("top", "WALL",
                     "      BOUNDARY CONDITIONS:\n        MASS AND MOMENTUM:\n          Option = Free Slip Wall\n      "
                     "  END\n      END\n") +
        ccl_boundary("side", "WALL",
                     "      BOUNDARY CONDITIONS:\n        MASS AND MOMENTUM:\n          Option = Free Slip Wall\n      "
                     "  END\n      END\n");
    if (o.half) {
        text += ccl_boundary("symmetry", "SYMMETRY", "");
    } else {
        text +=
            ccl_boundary("side_starboard", "WALL",
                         "      BOUNDARY CONDITIONS:\n        MASS AND MOMENTUM:\n          Option = Free Slip Wall\n  "
                         "      END\n      END\n");
    }
    for (const std::string& wall : d.walls) {
        text += ccl_boundary(wall, "WALL", no_slip);
    }
    return text;
}

std::string ccl(const FlowDomain& d, const FlowOptions& o) {
    std::string text =
        "# CFX CCL: steady flow past the body, SST, ground moving with the stream. Import into CFX-Pre over a mesh "
        "whose 2D regions\n"
        "# carry these names. Axes: x forward, y to port, z up; the stream runs toward -x.\n"
        "LIBRARY:\n  MATERIAL: Water here\n    Material Group = User\n    Option = Pure Substance\n    Thermodynamic "
        "State = Liquid\n    PROPERTIES:\n"
        "      Option = General Material\n      EQUATION OF STATE:\n        Density = " +
        digits(o.density) +
        " [kg m^-3]\n        Molar Mass = 18.02 [kg kmol^-1]\n        Option = Value\n      END\n"
        "      DYNAMIC VISCOSITY:\n        Dynamic Viscosity = " +
        digits(o.density * o.kinematic_viscosity) +
        " [Pa s]\n        Option = Value\n      END\n    END\n  END\n  CEL:\n    EXPRESSIONS:\n";
    text += ccl_forces(d, o.placement.gap) +
            "FLOW: Flow Analysis 1\n  ANALYSIS TYPE:\n    Option = Steady State\n  END\n  DOMAIN: Water\n    Coord "
            "Frame = Coord 0\n    Domain Type = Fluid\n    Location = Assembly\n" +
            ccl_boundaries(d, o);
    text +=
        "    DOMAIN MODELS:\n      BUOYANCY MODEL:\n        Option = Non Buoyant\n      END\n      DOMAIN MOTION:\n    "
        "    Option = Stationary\n      END\n      REFERENCE PRESSURE:\n        Reference Pressure = 1 [atm]\n      "
        "END\n    END\n"
        "    FLUID DEFINITION: Fluid 1\n      Material = Water here\n      Option = Material Library\n      "
        "MORPHOLOGY:\n        Option = Continuous Fluid\n      END\n    END\n"
        "    FLUID MODELS:\n      HEAT TRANSFER MODEL:\n        Option = None\n      END\n      TURBULENCE MODEL:\n    "
        "    Option = SST\n      END\n      TURBULENT WALL FUNCTIONS:\n        Option = Automatic\n      END\n    "
        "END\n  END\n"
        "  OUTPUT CONTROL:\n    MONITOR OBJECTS:\n";
    for (const char* name : {"LiftForce", "DragForce", "PitchMoment"}) {
        text += std::string("      MONITOR POINT: ") + name + "\n        Expression Value = " + name +
                "\n        Option = Expression\n      END\n";
    }
    text +=
        "    END\n    RESULTS:\n      File Compression Level = Default\n      Option = Standard\n    END\n  END\n  "
        "SOLVER CONTROL:\n    ADVECTION SCHEME:\n      Option = High Resolution\n    END\n"
        "    CONVERGENCE CONTROL:\n      Maximum Number of Iterations = " +
        std::to_string(o.iterations > 0 ? o.iterations : 400) +
        "\n      Timescale Control = Auto Timescale\n    END\n    CONVERGENCE CRITERIA:\n      Residual Target = "
        "1e-5\n      Residual Type = RMS\n    END\n  END\nEND\n";
    return text;
}

std::string session(const FlowDomain& d) {
    return "# CFD-Post session: writes the walls of the body as CSV with faces. Load the result first, then: cfdpost "
           "-batch export.cse\n"
           "COMMAND FILE:\n  CFX Post Version = 19.0\nEND\nEXPORT:\n  ANSYS Export Data = Element Heat Flux\n  Case "
           "Name = Case result\n  Export Connectivity = On\n  Export Coord Frame = Global\n"
           "  Export File = body.csv\n  Export Geometry = On\n  Export Node Numbers = Off\n  Export Null Data = On\n  "
           "Export Type = Generic\n  Export Units System = Current\n  Export Variable Type = Current\n  Include File "
           "Information = Off\n  Include Header = On\n  Location List = " +
           [&] {
               std::string list;
               for (const std::string& wall : d.walls) {
                   list += (list.empty() ? "/BOUNDARY:" : ",/BOUNDARY:") + wall;
               }
               return list;
           }() +
           "\n  Null Token = null\n  Overwrite = On\n  Precision = 8\n  Separator = \", \"\n  Spatial Variables = "
           "X,Y,Z\n  Variable List = Pressure, Wall Shear X, Wall Shear Y, Wall Shear Z, Yplus\n"
           "  Vector Brackets = ()\n  Vector Display = Scalar\nEND\n>export\n";
}

}  // namespace

std::vector<std::filesystem::path> write_ansys_case(const SurfaceMesh& body, const FlowOptions& options,
                                                    const std::filesystem::path& folder) {
    const FlowDomain domain = flow_domain(body, options);
    require_empty_folder(folder);
    std::vector<fs::path> files;
    const auto put = [&](const fs::path& name, const std::string& text) {
        core::write_file(folder / name, text);
        files.push_back(folder / name);
    };
    SurfaceMesh at = placed(options.half ? port_half(body) : body, options.placement);
    std::vector<SurfaceMesh> parts = sides(domain);
    if (options.half) {
        parts.back() = symmetry_plane(domain, at);
    }
    for (const std::string& wall : domain.walls) {
        parts.push_back(patch_of(at, wall));
    }
    for (const SurfaceMesh& part : parts) {
        put(fs::path("surfaces") / (part.patch_names.front() + ".stl"), mesh_bytes(part, MeshFormat::stl_ascii));
        put(fs::path("surfaces") / (part.patch_names.front() + ".obj"), mesh_bytes(part, MeshFormat::obj));
    }
    put("fluent.jou", journal(domain, options));
    put("cfx.ccl", ccl(domain, options));
    put("export.cse", session(domain));
    return files;
}

}  // namespace underbody::geometry
