// A body read from a shape or a surface file, with what the program says of it: both fronts show this.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "geometry/body/body_shape.h"
#include "geometry/body/certificate.h"
#include "geometry/body/mass_properties.h"
#include "geometry/mesh/surface_mesh.h"
#include "geometry/water/added_mass.h"
#include "geometry/water/placement.h"
#include "geometry/water/trim.h"

namespace underbody::geometry {

/// A point mass of [mass] that is moved, at its own height, until the body rests at an attitude.
struct BallastWish {
    std::string name;
    double pitch = 0, roll = 0;  ///< rad, nose up, starboard down
};

struct BodyOptions {
    /// Parameters of a SHAPE.toml that are other than in the file: name, value as written (`set_parameter`).
    std::vector<std::pair<std::string, std::string>> set;
    std::size_t triangles = 20000;
    std::optional<std::string> unit;  ///< of a surface file
    double feature_angle = 20;        ///< degrees, of a surface file
    double density = default_water_density;
    std::optional<Placement> placement;
    std::optional<BallastWish> ballast;
    std::size_t panels = 1200;              ///< of the added mass; 0: none
    std::optional<double> underside_up_to;  ///< m above the ground; default: the gap and a quarter of the body's height
};

struct Body {
    std::string name;
    std::optional<BodyShape> shape;  ///< empty for a surface file
    /// m, how far the origin (the centre of the flat base) lies forward of the ellipsoid's axis; 0 for a surface file.
    double origin_from_axis = 0;
    SurfaceMesh mesh;     ///< certified; origin at the centre of the base
    MassProperties mass;  ///< of the exact shape where there is one, else of the facets of the surface file
    /// m^3, of a surface file: what the smooth surface behind its facets holds more than they (see `volume_left_out`).
    double volume_left_out = 0;
    Certificate certificate;
    double density = default_water_density;
    std::optional<Loading> loading;  ///< with the ballast where it was moved to
    std::optional<Vec3> ballast;     ///< m, where that is
    std::optional<Trim> trim;        ///< of that loading
    std::optional<AddedMass> added_mass;
    std::optional<Placement> placement;
    std::optional<Clearance> clearance;
    std::optional<ContactAngles> contact;
    std::optional<AreaBelow> underside;
    std::vector<std::string> remarks;  ///< what the reader of the numbers should know

    /// m, of the body as it is (cut, with what stands below its base): along x, y and z.
    [[nodiscard]] Vec3 outer_size() const { return mass.bounding_box.upper - mass.bounding_box.lower; }
};

/// SHAPE.toml, or a surface by its ending (whose origin is moved to the middle of its base when it has one).
/// Throws core::InputError: as the readers and `check` do; parameters for a surface file, which has none; a surface
/// that does not pass its certificate (with the place); a placement that puts a point of the body below the ground
/// (with the nearest gap and pitch).
Body read_body(const std::filesystem::path& path, const BodyOptions& options = {},
               core::Progress& progress = core::Progress::none());

/// Throws core::InputError (kind "contact") when the lowest point is not above the ground.
void require_clearance(const SurfaceMesh& body, const Placement& placement);

/// docs/conventions.md section 7, command `body`.
void to_json(nlohmann::json& json, const Body& body);

}  // namespace underbody::geometry
