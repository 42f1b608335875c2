// Added mass of shapes and its table against the gap.
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/text.h"
#include "geometry/added_mass.h"
#include "geometry/body_surface.h"
#include "geometry/mass_properties.h"

namespace underbody::geometry {

namespace {

SurfaceOptions panel_options(std::size_t panels, bool over_ground) {
    SurfaceOptions options;
    options.triangles = panels;
    options.edge_refinement = over_ground ? 0.4 : 0.8;
    return options;
}

}  // namespace

AddedMass added_mass(const BodyShape& shape, std::size_t panels, const AddedMassOptions& options, bool extrapolate,
                     core::Progress& progress) {
    const bool over_ground = options.placement.has_value();
    const SurfaceMesh fine_mesh = make_surface(shape, panel_options(panels, over_ground), progress);
    AddedMassOptions at_point = options;
    if (!at_point.reference) {
        at_point.reference = mass_properties(fine_mesh).centroid;
    }
    AddedMass fine = added_mass(fine_mesh, at_point, progress);
    if (!extrapolate || panels < 600) {
        return fine;
    }
    const SurfaceMesh coarse_mesh = make_surface(shape, panel_options(panels / 3, over_ground), progress);
    const AddedMass coarse = added_mass(coarse_mesh, at_point, progress);
    // Error like 1/panels: second order in the edge length.
    const double ratio = static_cast<double>(fine.panels) / static_cast<double>(coarse.panels);
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 6; ++j) {
            fine.matrix[i][j] += (fine.matrix[i][j] - coarse.matrix[i][j]) / (ratio - 1);
        }
    }
    return fine;
}

AddedMassSweep added_mass_against_gap(const BodyShape& shape, const std::vector<double>& gaps, std::size_t panels,
                                      const AddedMassOptions& options, core::Progress& progress) {
    AddedMassSweep sweep;
    AddedMassOptions each = options;
    each.placement.reset();
    sweep.free_water = added_mass(shape, panels, each, true, progress);
    each.reference = sweep.free_water.reference;
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        each.placement = options.placement.value_or(Placement{});
        each.placement->gap = gaps[i];
        progress.report(static_cast<double>(i) / static_cast<double>(gaps.size()),
                        "added mass at " + core::format_number(1000 * gaps[i], 4) + " mm");
        sweep.at_gap.push_back(added_mass(shape, panels, each, true, progress));
    }
    return sweep;
}

core::Table table(const AddedMassSweep& sweep) {
    core::Table result;
    result.comments = {
        " added mass over flat ground, source panels with image; body axes x forward, y starboard, z down",
        " moments about (" + core::format_number(sweep.free_water.reference.x, 6) + ", " +
            core::format_number(sweep.free_water.reference.y, 6) + ", " +
            core::format_number(sweep.free_water.reference.z, 6) +
            ") m from the centre of the base (x forward, y port, z up); " + std::to_string(sweep.free_water.panels) +
            " panels, " + core::format_number(sweep.free_water.density, 6) + " kg/m^3"};
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
