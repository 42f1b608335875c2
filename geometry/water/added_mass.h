// The inertia of the water around a body: the full 6 x 6 matrix, in free water or over flat ground.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "core/table.h"
#include "core/water.h"
#include "geometry/body/body_shape.h"
#include "geometry/mesh/surface_mesh.h"
#include "geometry/water/placement.h"

namespace underbody::geometry {

using Matrix6 = std::array<std::array<double, 6>, 6>;

/// SI, in the body axes of the models: x forward, y starboard, z down, fixed in the body, moments about `reference`;
/// rows and columns surge, sway, heave, roll, pitch, yaw: kg, kg m and kg m^2. Positive on the diagonal (A = -X_udot
/// and so on).
struct AddedMass {
    /// How panels made anew for a surface of (many) triangles lie on it.
    struct PanelFit {
        std::size_t triangles = 0;    ///< of the surface
        double distance_rms = 0;      ///< m, of the panels from the surface
        double distance_largest = 0;  ///< m
        double volume_error = 0;      ///< (volume of the panels - that of the surface) over it
    };
    Matrix6 matrix{};
    Vec3 reference;  ///< m, in the axes of the mesh (x forward, y to port, z up, from the centre of the base)
    std::optional<Placement> placement;  ///< over the ground; free water when empty
    double density = 0;                  ///< kg/m^3
    std::size_t panels = 0;
    double asymmetry =
        0;  ///< largest |A - A'| over the largest diagonal of its kind: 0 when exact, a measure of the error
    double edge_over_gap = 0;  ///< longest panel edge in the lowest part over the smallest clearance; 0 in free water
    /// Largest change of a diagonal entry by the extrapolation, over the entry: a cautious bound of the error left.
    double extrapolation = 0;
    std::optional<PanelFit> fit;
};

struct AddedMassOptions {
    double density = core::default_water_density;  ///< kg/m^3
    std::optional<Placement> placement;
    /// Point of the moments; the centroid of the volume when empty.
    std::optional<Vec3> reference;
};

/// Constant sources on the mesh's triangles, normal velocity met at their centroids, integrals exact near by, ground by
/// image; LU in float64. A body that is symmetric in y (as `make_surface` makes them) and does not roll is solved as
/// two systems of half the size. Memory: the matrix of each system, one after the other. Throws core::InputError:
/// surface not closed, body touches the ground, more than 20000 unknowns in one system.
AddedMass added_mass(const SurfaceMesh& mesh, const AddedMassOptions& options = {},
                     core::Progress& progress = core::Progress::none());

/// The same for a shape: meshes it with about `panels` triangles (finer on the base over the ground), and takes out
/// most of the error of flat panels by a second, coarser mesh (Richardson, order 2) unless `extrapolate` is false.
AddedMass added_mass(const BodyShape& shape, std::size_t panels, const AddedMassOptions& options = {},
                     bool extrapolate = true, core::Progress& progress = core::Progress::none());

/// The same for a surface of any number of triangles (closed, as `certify` finds it): panels are made anew on it
/// (`panel_mesh.h`), and `fit` says how near they lie.
AddedMass added_mass(const SurfaceMesh& surface, std::size_t panels, const AddedMassOptions& options = {},
                     bool extrapolate = true, core::Progress& progress = core::Progress::none());

/// For `model.toml`: columns gap [mm], pitch [deg] and the entries `added_mass_surge`, `_sway`, `_heave` [kg],
/// `added_inertia_roll`,
/// `_pitch`, `_yaw` [kg m^2] and the couplings `added_mass_surge_pitch`, `added_mass_heave_pitch`, ... [kg m].
struct AddedMassSweep {
    std::vector<AddedMass> at_gap;
    AddedMass free_water;
};
AddedMassSweep added_mass_against_gap(const BodyShape& shape, const std::vector<double>& gaps, std::size_t panels,
                                      const AddedMassOptions& options = {},
                                      core::Progress& progress = core::Progress::none());
AddedMassSweep added_mass_against_gap(const SurfaceMesh& surface, const std::vector<double>& gaps, std::size_t panels,
                                      const AddedMassOptions& options = {},
                                      core::Progress& progress = core::Progress::none());
core::Table table(const AddedMassSweep& sweep);
/// Heave, surge, sway over their free-water values, and the thin-film limit of the heave.
core::Figure figure(const AddedMassSweep& sweep, const std::string& name);

/// The matrix for another reference point (same axes).
AddedMass moved(const AddedMass& mass, const Vec3& reference);

void to_json(nlohmann::json& json, const AddedMass& mass);

}  // namespace underbody::geometry
