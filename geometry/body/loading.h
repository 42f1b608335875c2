// What is in the body: its own mass and point masses, as [mass] of a SHAPE.toml says.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/toml.h"
#include "geometry/mesh/vec3.h"

namespace underbody::geometry {

struct PointMass {
    std::string name;
    double mass = 0;  ///< kg
    Vec3 position;    ///< m, axes of the mesh: x forward, y to port, z up, from the centre of the base
};

/// [mass] of a SHAPE.toml, all optional:
///
///     [mass]
///     hull = "1.4 kg"            # spread evenly over the volume; or density = "620 kg/m^3"
///     [[mass.point]]
///     name = "battery"
///     mass = "0.5 kg"
///     position = ["20 mm", "0 mm", "15 mm"]   # x forward, y to port, z up, from the centre of the base
struct Loading {
    double uniform_density = 0;  ///< kg/m^3, of the hull over the whole volume
    double hull_mass = 0;        ///< kg, as an alternative to the density
    std::vector<PointMass> points;
};

/// Nothing when the file has no [mass]. Throws core::InputError: negative masses, both hull and density.
std::optional<Loading> loading_from(const core::TomlTable& root);

/// The [mass] of a SHAPE.toml, read together with the shape.
std::optional<Loading> read_loading(const std::filesystem::path& path);

}  // namespace underbody::geometry
