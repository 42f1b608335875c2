// A sweep of shapes in one file: lists, ranges and ties between parameters; a table of what each one is; comparison of
// two.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/table.h"
#include "geometry/body/body_shape.h"
#include "geometry/body/certificate.h"
#include "geometry/body/mass_properties.h"
#include "geometry/mesh/surface_mesh.h"

namespace underbody::core {
class TomlTable;
}

namespace underbody::geometry {

/// Sets one parameter by its name in the file ("body.base_cut", "protrusion.height"; text with a unit, or a word).
/// A parameter of [protrusion], [nozzle] or [tail_plate] brings that part into being. Does not check the shape.
/// Throws core::InputError: unknown name (with the nearest), a value that does not parse or has another dimension.
void set_parameter(BodyShape& shape, const std::string& name, const std::string& text);
/// A number in SI; throws for words and unknown names.
void set_parameter(BodyShape& shape, const std::string& name, double value);
/// SI value of a number parameter; throws for words.
double parameter(const BodyShape& shape, const std::string& name);
/// False for a parameter of a part that the shape has not ("protrusion.height" of a body without one).
bool has_part_of(const BodyShape& shape, const std::string& name);
/// Names of all parameters, with their SI units ("" for words).
struct ParameterName {
    std::string name;
    std::string unit;
};
const std::vector<ParameterName>& parameter_names();
/// SI unit of a parameter, "" for words. Throws core::InputError for an unknown name (with the nearest).
std::string parameter_unit(const std::string& key, const core::Place& place);

/// The unit in which designers read values of an SI unit: mm for m, deg for rad, others as they are.
std::string shown_unit(const std::string& unit);
/// "1.5 mm": an SI value in that unit.
std::string shown_value(double value, const std::string& unit, int digits);

/// [[tie]]: a number of the shape that follows another one, key = factor * of + offset (SI).
struct Tie {
    std::string key, of;
    double factor = 1, offset = 0;
};
/// Throws core::InputError: unknown names, numbers of different kinds.
Tie tie_from(const core::TomlTable& table);
void apply(const Tie& tie, BodyShape& shape);

/// [[vary]]: a parameter and the values that it takes, as written.
struct Vary {
    std::string key;
    std::vector<std::string> values;
    bool operator==(const Vary&) const = default;
};
/// "protrusion.height=1mm:3mm:5" (five values from 1 to 3 mm) or "body.base=ellipse,rectangle" (a list; numbers may
/// carry units). Throws core::UsageError: no '=', fewer than two values in a range; core::InputError as set_parameter.
Vary vary_from(const std::string& text);

struct Variant {
    std::string name;  ///< of the file, and a number: "evie-007"
    BodyShape shape;
    std::vector<std::string> values;  ///< what was varied, as written
    std::string refused;              ///< why it cannot be made; empty when it can
    std::string same_as;              ///< name of an earlier variant that is equal in everything
};

/// A file like SHAPE.toml (the values that stay) with
///
///     [[vary]]
///     key = "protrusion.height"
///     values = ["1 mm", "2 mm"]            # or from = "1 mm", to = "3 mm", count = 5
///     [[tie]]
///     key = "protrusion.length"            # = factor * of + offset, after each variation
///     of = "protrusion.height"
///     factor = 5
///     offset = "0 mm"
///
/// All combinations, the last [[vary]] fastest. Throws core::InputError for the file's own faults and beyond 100000
/// variants.
struct VariantSet {
    std::string name;
    std::vector<std::string> keys;
    std::vector<Variant> variants;
};
VariantSet read_variants(const std::filesystem::path& path);
/// The same of a shape and what varies; names are those of `name` with a number. Throws core::InputError: beyond 100000
/// variants.
VariantSet variants_of(const BodyShape& shape, const std::string& name, const std::vector<Vary>& varies,
                       const std::vector<Tie>& ties = {});

struct MadeVariant {
    const Variant* variant = nullptr;
    SurfaceMesh mesh;  ///< empty when refused or same_as
    MassProperties mass;
    Certificate certificate;
};
/// In parallel; every surface certified, a failing one is recorded as refused with its place.
std::vector<MadeVariant> make_variants(VariantSet& set, std::size_t triangles,
                                       core::Progress& progress = core::Progress::none());

/// What `table` says of each variant besides what was varied, with SI unit and the one that people read.
struct VariantColumn {
    std::string name, unit, shown;
};
const std::vector<VariantColumn>& variant_columns();

/// One row a variant: name, the varied parameters (mm, degrees, or words), volume, area, buoyancy, centroid, base area,
/// smallest angle, largest distance to the exact shape, volume error, `same_as`, `refused`.
core::Table table(const VariantSet& set, const std::vector<MadeVariant>& made);

/// What differs between two shapes, and what that does.
struct Comparison {
    bool equal = false;  ///< in everything but the name
    struct Difference {
        std::string name, unit;
        std::string a, b;  ///< as numbers in SI or words; "-" where the part is missing
    };
    std::vector<Difference> differences;
    MassProperties mass_a, mass_b;
    double volume_a = 0, volume_b = 0;  ///< m^3, of the exact shapes, as in mass_a, mass_b
    double base_area_a = 0, base_area_b = 0;
    /// m, of the points of each mesh from the other's exact surface, to first order, the ellipsoids laid on each other.
    double largest_distance = 0;
    Vec3 where;  ///< in the axes of `a` (from the centre of its base)
};
Comparison compare(const BodyShape& a, const BodyShape& b, std::size_t triangles = 6000,
                   core::Progress& progress = core::Progress::none());
void to_json(nlohmann::json& json, const Comparison& comparison);

}  // namespace underbody::geometry
