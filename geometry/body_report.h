// A body read from a shape or a surface file, with what the program says of it: both fronts show this.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "core/progress.h"
#include "geometry/added_mass.h"
#include "geometry/body_shape.h"
#include "geometry/certificate.h"
#include "geometry/loading.h"
#include "geometry/mass_properties.h"
#include "geometry/placement.h"
#include "geometry/surface_mesh.h"

namespace underbody::geometry {

struct BodyOptions {
    std::size_t triangles = 20000;
    std::optional<std::string> unit;  ///< of a surface file
    double feature_angle = 20;        ///< degrees, of a surface file
    double density = default_water_density;
    std::optional<Placement> placement;
    std::size_t panels = 1200;              ///< of the added mass; 0: none
    std::optional<double> underside_up_to;  ///< m above the ground; default: the gap and a quarter of the body's height
};

struct Body {
    std::string name;
    std::optional<BodyShape> shape;  ///< empty for a surface file
    /// m, how far the origin (the centre of the flat base) lies forward of the ellipsoid's axis; 0 for a surface file.
    double origin_from_axis = 0;
    SurfaceMesh mesh;  ///< certified; origin at the centre of the base
    MassProperties mass;
    Certificate certificate;
    double density = default_water_density;
    std::optional<Loading> loading;
    std::optional<Trim> trim;
    std::optional<AddedMass> added_mass;
    std::optional<Placement> placement;
    std::optional<Clearance> clearance;
    std::optional<ContactAngles> contact;
    std::optional<AreaBelow> underside;
    std::string remark;  ///< what the reader should know; may be empty
};

/// SHAPE.toml, or a surface by its ending (whose origin is moved to the middle of its base when it has one).
/// Throws core::InputError: as the readers do; a surface that does not pass its certificate (with the place); a
/// placement that puts a point of the body below the ground (with the nearest gap and pitch).
Body read_body(const std::filesystem::path& path, const BodyOptions& options = {},
               core::Progress& progress = core::Progress::none());

/// Throws core::InputError (kind "contact") when the lowest point is not above the ground.
void require_clearance(const SurfaceMesh& body, const Placement& placement);

/// docs/conventions.md section 7, command `body`.
void to_json(nlohmann::json& json, const Body& body);

}  // namespace underbody::geometry
