// Added mass of shapes and of surfaces, and its table against the gap.
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/mass_properties.h"
#include "geometry/water/added_mass.h"
#include "geometry/water/panel_mesh.h"

namespace underbody::geometry {

namespace {

// The panels, and a third of them to extrapolate with (none: no extrapolation).
struct Levels {
    SurfaceMesh fine, coarse;
    std::optional<AddedMass::PanelFit> fit;
};

constexpr std::size_t fewest_to_extrapolate = 600;

Levels levels_of(const BodyShape& shape, std::size_t panels, bool over_ground, bool extrapolate,
                 core::Progress& progress) {
    SurfaceOptions options;
    options.edge_refinement = over_ground ? 0.4 : 0.8;
    options.triangles = panels;
    Levels levels{make_surface(shape, options, progress), {}, {}};
    if (extrapolate && panels >= fewest_to_extrapolate) {
        options.triangles = panels / 3;
        levels.coarse = make_surface(shape, options, progress);
    }
    return levels;
}

Levels levels_of(const SurfaceMesh& surface, std::size_t panels, bool over_ground, bool extrapolate,
                 core::Progress& progress) {
    PanelOptions options;
    options.refinement = over_ground ? 0.4 : 0.8;
    options.panels = panels;
    PanelMesh fine = panel_mesh(surface, options, progress);
    Levels levels{std::move(fine.mesh), {}, {}};
    levels.fit = {fine.triangles, fine.distance_rms, fine.distance_largest, fine.volume_error};
    if (extrapolate && panels >= fewest_to_extrapolate) {
        options.panels = panels / 3;
        levels.coarse = panel_mesh(surface, options, progress).mesh;
    }
    return levels;
}

AddedMass solved(const Levels& levels, AddedMassOptions options, core::Progress& progress) {
    if (!options.reference) {
        options.reference = mass_properties(levels.fine).centroid;
    }
    AddedMass fine = added_mass(levels.fine, options, progress);
    fine.fit = levels.fit;
    if (levels.coarse.triangles.empty()) {
        return fine;
    }
    const AddedMass coarse = added_mass(levels.coarse, options, progress);
    // Error like 1/panels: second order in the edge length.
    const double ratio = static_cast<double>(fine.panels) / static_cast<double>(coarse.panels);
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 6; ++j) {
            const double change = (fine.matrix[i][j] - coarse.matrix[i][j]) / (ratio - 1);
            fine.matrix[i][j] += change;
            if (i == j && i < 3) {
                fine.extrapolation = std::max(fine.extrapolation, std::abs(change / fine.matrix[i][i]));
            }
        }
    }
    return fine;
}

template <class Body>
AddedMassSweep against_gap(const Body& body, const std::vector<double>& gaps, std::size_t panels,
                           const AddedMassOptions& options, core::Progress& progress) {
    AddedMassSweep sweep;
    AddedMassOptions each = options;
    each.placement.reset();
    sweep.free_water = solved(levels_of(body, panels, false, true, progress), each, progress);
    each.reference = sweep.free_water.reference;
    const Levels levels = levels_of(body, panels, true, true, progress);
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        each.placement = options.placement.value_or(Placement{});
        each.placement->gap = gaps[i];
        progress.report(static_cast<double>(i) / static_cast<double>(gaps.size()),
                        "added mass at " + core::format_number(1000 * gaps[i], 4) + " mm");
        sweep.at_gap.push_back(solved(levels, each, progress));
    }
    return sweep;
}

}  // namespace

AddedMass added_mass(const BodyShape& shape, std::size_t panels, const AddedMassOptions& options, bool extrapolate,
                     core::Progress& progress) {
    return solved(levels_of(shape, panels, options.placement.has_value(), extrapolate, progress), options, progress);
}

AddedMass added_mass(const SurfaceMesh& surface, std::size_t panels, const AddedMassOptions& options, bool extrapolate,
                     core::Progress& progress) {
    return solved(levels_of(surface, panels, options.placement.has_value(), extrapolate, progress), options, progress);
}

AddedMassSweep added_mass_against_gap(const BodyShape& shape, const std::vector<double>& gaps, std::size_t panels,
                                      const AddedMassOptions& options, core::Progress& progress) {
    return against_gap(shape, gaps, panels, options, progress);
}

AddedMassSweep added_mass_against_gap(const SurfaceMesh& surface, const std::vector<double>& gaps, std::size_t panels,
                                      const AddedMassOptions& options, core::Progress& progress) {
    return against_gap(surface, gaps, panels, options, progress);
}

core::Table table(const AddedMassSweep& sweep) {
    core::Table result;
    const auto metres = [](double v) { return core::format_number(std::abs(v) < 1e-12 ? 0.0 : v, 6); };
    const Vec3& about = sweep.free_water.reference;
    result.comments = {
        " added mass over flat ground, source panels with image; body axes x forward, y starboard, z down",
        " moments about (" + metres(about.x) + ", " + metres(about.y) + ", " + metres(about.z) +
            ") m from the centre of the base (x forward, y port, z up); " + std::to_string(sweep.free_water.panels) +
            " panels, " + core::format_number(sweep.free_water.density, 6) + " kg/m^3"};
    if (sweep.free_water.fit) {
        const AddedMass::PanelFit& fit = *sweep.free_water.fit;
        result.comments.push_back(" panels made from " + std::to_string(fit.triangles) +
                                  " triangles, off their surface by " + core::format_number(1e3 * fit.distance_rms, 3) +
                                  " mm (RMS), " + core::format_number(1e3 * fit.distance_largest, 3) + " mm at most");
    }
    std::vector<double> gap, pitch;
    for (const AddedMass& m : sweep.at_gap) {
        gap.push_back(m.placement->gap);
        pitch.push_back(m.placement->pitch);
    }
    result.add_numbers("gap", "m", gap, "mm");
    result.add_numbers("pitch", "rad", pitch, "deg");
    struct Entry {
        const char* name;
        std::size_t row, column;
        const char* unit;
    };
    for (const Entry& entry :
         {Entry{"added_mass_surge", 0, 0, "kg"}, Entry{"added_mass_sway", 1, 1, "kg"},
          Entry{"added_mass_heave", 2, 2, "kg"}, Entry{"added_inertia_roll", 3, 3, "kg m^2"},
          Entry{"added_inertia_pitch", 4, 4, "kg m^2"}, Entry{"added_inertia_yaw", 5, 5, "kg m^2"},
          Entry{"added_mass_surge_heave", 0, 2, "kg"}, Entry{"added_mass_surge_pitch", 0, 4, "kg m"},
          Entry{"added_mass_heave_pitch", 2, 4, "kg m"}, Entry{"added_mass_sway_roll", 1, 3, "kg m"},
          Entry{"added_mass_sway_yaw", 1, 5, "kg m"}}) {
        std::vector<double> values;
        for (const AddedMass& m : sweep.at_gap) {
            values.push_back(m.matrix[entry.row][entry.column]);
        }
        result.add_numbers(entry.name, entry.unit, values);
    }
    return result;
}

core::Figure figure(const AddedMassSweep& sweep, const std::string& name) {
    core::Figure figure;
    figure.title = "Added mass of " + name + " over flat ground";
    figure.caption = "Source panels with the ground's image, " + std::to_string(sweep.free_water.panels) +
                     " panels; dashed: free water. Ideal fluid: no film damping, no separation.";
    figure.x = {"gap", "mm", 0, 0, true};
    figure.y = {"added mass", "kg", 0, 0, false};
    constexpr std::array<const char*, 3> names{"surge", "sway", "heave"};
    for (std::size_t k = 0; k < 3; ++k) {
        core::FigureCurve curve;
        curve.name = names[k];
        curve.colour = core::palette(k);
        for (const AddedMass& m : sweep.at_gap) {
            curve.x.push_back(1000 * m.placement->gap);
            curve.y.push_back(m.matrix[k][k]);
        }
        core::FigureCurve free = curve;
        free.name.clear();
        free.dashed = true;
        free.width = 1;
        std::fill(free.y.begin(), free.y.end(), sweep.free_water.matrix[k][k]);
        figure.curves.push_back(curve);
        figure.curves.push_back(free);
    }
    return figure;
}

}  // namespace underbody::geometry
