#include "geometry/cases/flow_domain.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "geometry/cases/case_files.h"
#include "geometry/water/above_ground.h"

namespace underbody::geometry {

namespace {

void positive(const char* name, double value) {
    if (!(value > 0) || !std::isfinite(value)) {
        throw core::InputError("range",
                               std::string(name) + " is " + core::format_number(value, 6) + ": it must be positive", {},
                               "the nearest allowed value: above 0");
    }
}

}  // namespace

const std::vector<std::string>& mesher_names() {
    static const std::vector<std::string> names = {"blocks", "snappy"};
    return names;
}

int iterations_of(const FlowOptions& options) {
    return options.iterations > 0 ? options.iterations : options.mesher == CaseMesher::blocks ? 800 : 400;
}

namespace {

void check(const SurfaceMesh& body, const FlowOptions& o) {
    for (const auto& [name, value] : {std::pair{"speed", o.speed},
                                      {"density", o.density},
                                      {"kinematic_viscosity", o.kinematic_viscosity},
                                      {"turbulence_intensity", o.turbulence_intensity},
                                      {"viscosity_ratio", o.viscosity_ratio},
                                      {"upstream", o.upstream},
                                      {"downstream", o.downstream},
                                      {"side", o.side},
                                      {"above", o.above},
                                      {"cell", o.cell}}) {
        positive(name, value);
    }
    if (o.cell > 0.5) {
        throw core::InputError(
            "range", "a background cell of " + core::format_number(o.cell, 4) + " body lengths cannot find the body",
            {}, "the nearest allowed value: 0.5");
    }
    if (o.half) {
        if (o.placement.roll != 0) {
            throw core::InputError("symmetry", "a rolled body has no plane of symmetry", {},
                                   "make a whole model, or take roll = 0");
        }
        port_half(body);  // throws when triangles cross the plane
    }
}

}  // namespace

FlowDomain flow_domain(const SurfaceMesh& body, const FlowOptions& o) {
    check(body, o);
    FlowDomain domain;
    domain.clearance = clearance(body, o.placement);
    require_above_ground(domain.clearance, o.placement);
    const Box at = bounding_box(placed(body, o.placement));
    const Box made = bounding_box(body);
    const double length = made.upper.x - made.lower.x, cell = o.cell * length;
    const auto cells = [cell](double distance) { return cell * std::ceil(distance / cell); };
    domain.box.lower = {-cells(o.downstream * length - at.lower.x), o.half ? 0.0 : -cells(o.side * length - at.lower.y),
                        0};
    domain.box.upper = {cells(o.upstream * length + at.upper.x), cells(o.side * length + at.upper.y),
                        cells(o.above * length + at.upper.z)};
    domain.boundaries = {"inlet", "outlet", "ground", "top", "side", o.half ? "symmetry" : "side_starboard"};
    for (const PatchSummary& patch : patches(body)) {
        domain.walls.push_back(patch.name);
    }
    domain.gap_level =
        std::clamp(static_cast<int>(std::ceil(std::log2(4 * cell / domain.clearance.smallest))), o.surface_level, 6);
    domain.cells_in_gap = domain.clearance.smallest / (cell / std::pow(2, domain.gap_level));
    return domain;
}

void require_empty_folder(const std::filesystem::path& folder) {
    if (std::filesystem::exists(folder) &&
        (!std::filesystem::is_directory(folder) || !std::filesystem::is_empty(folder))) {
        throw core::InputError("exists", "'" + folder.string() + "' is not an empty folder",
                               {folder.string(), {}, {}, {}},
                               "name a new folder: a case is never written over another");
    }
}

std::string foam_header(const std::string& kind, const std::string& object) {
    return "FoamFile\n{\n    version 2.0;\n    format ascii;\n    class " + kind + ";\n    object " + object +
           ";\n}\n\n";
}

std::string foam_transport(double kinematic_viscosity) {
    return foam_header("dictionary", "transportProperties") + "transportModel Newtonian;\nnu " +
           digits(kinematic_viscosity) + ";\n";
}

std::string foam_turbulence() {
    return foam_header("dictionary", "turbulenceProperties") +
           "simulationType RAS;\nRAS\n{\n    RASModel kOmegaSST;\n    turbulence on;\n    printCoeffs on;\n}\n";
}

void make_executable(const std::filesystem::path& file) {
    using std::filesystem::perms;
    std::filesystem::permissions(file, perms::owner_exec | perms::group_exec | perms::others_exec,
                                 std::filesystem::perm_options::add);
}

/// Iterations between two writes, so that a solve that was cut can go on: about an eighth of them. OpenFOAM writes its
/// last iteration only where the interval divides it; a number without a divisor in between gets no checkpoints.
int checkpoint_interval(int iterations) {
    int best = iterations;
    for (int interval = std::max(1, iterations / 40); interval <= iterations / 3; ++interval) {
        const bool closer =
            std::abs(std::log(8.0 * interval / iterations)) < std::abs(std::log(8.0 * best / iterations));
        best = iterations % interval == 0 && closer ? interval : best;
    }
    return best;
}

std::string digits(double value) { return core::format_number(value, 12); }

std::string doubt_of_gap(double gap) {
    if (gap >= smallest_tried_gap) {
        return {};
    }
    return "the gap of " + core::format_number(1e3 * gap, 3) +
           " mm is thinner than any that such a case was checked at (1 mm): walls of real bodies are rougher than "
           "that, and the flow in it is laminar where the turbulence model is not";
}

}  // namespace underbody::geometry
