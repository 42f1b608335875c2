// Integrals of pressure and traction over the faces of one surface.
#pragma once

#include <array>
#include <span>

#include "core/progress.h"
#include "postproc/field/surface_arrays.h"

namespace underbody::postproc {

/// Values to integrate: one per node or one per face; shear has three components and may be empty. Without a pressure
/// only the shape is summed: area, area vector, flux of place.
struct FaceValues {
    std::span<const double> pressure;
    bool pressure_on_nodes = true;
    std::span<const double> shear;
    bool shear_on_nodes = true;
    double reference_pressure = 0;
};

/// Sums over all faces, with the normals as they lie in the arrays; positions relative to `origin`.
struct FaceSums {
    double area = 0;
    std::array<double, 3> area_vector{};
    std::array<double, 3> pressure_force{};   ///< - integral of p n
    std::array<double, 3> pressure_moment{};  ///< - integral of x cross p n
    std::array<double, 3> shear_force{};      ///< integral of tau
    std::array<double, 3> shear_moment{};
    std::array<double, 3> flux_of_place{};  ///< integral of x_i n_i: each is the volume of a closed surface

    FaceSums& operator+=(const FaceSums& other);
};

/// Triangles with linear values and quads with bilinear values and place are integrated exactly, larger polygons as
/// fans around their centre. (The area of a warped quad, which weighs the shear, to second order of its warp.)
FaceSums integrate_faces(const SurfaceArrays& surface, const FaceValues& values, const std::array<double, 3>& origin,
                         core::Progress& progress = core::Progress::none());

/// The same for one face; for running integrals.
FaceSums integrate_face(const SurfaceArrays& surface, const FaceValues& values, const std::array<double, 3>& origin,
                        std::size_t face);

}  // namespace underbody::postproc
