// What a CFD file holds, in one form: zones with VTK data in SI under canonical names.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/progress.h"

namespace underbody::postproc {

/// Where the values of an array live.
enum class Location { nodes, faces, cells };

enum class ZoneKind {
    wall,
    inlet,
    outlet,
    symmetry,
    periodic,
    interface,
    interior,
    farfield,
    fluid,
    solid,
    line,
    points,
    other,
    unknown
};

/// "wall", "inlet", ...
std::string to_string(ZoneKind kind);
std::string to_string(Location location);

/// One array of a zone. The VTK array carries the canonical name; its values are SI.
struct ArrayInfo {
    std::string name;           ///< canonical: pressure, wall_shear, velocity, y_plus, ... or the file's own name
    std::string unit;           ///< SI unit; empty when the file does not say
    std::string original_name;  ///< as in the file
    std::string original_unit;  ///< as in the file, may be empty
    Location on = Location::nodes;
    int components = 1;  ///< six: a symmetric tensor as xx yy zz xy yz xz; nine: xx xy xz yx ... zz
};

/// A surface, a volume, a line or a set of points, with its own name.
///
/// Surfaces are `vtkPolyData` whose cells are the faces; values on faces are cell data, values on nodes point data.
/// The right-hand normal of a face points OUT of the body, that is into the fluid, for walls; importers turn
/// faces where their format says otherwise (`normals_into_fluid` false: orientation unknown, loads will settle it).
struct Zone {
    std::string name;
    int id = 0;
    ZoneKind kind = ZoneKind::unknown;
    std::string original_kind;             ///< the file's own word
    vtkSmartPointer<vtkPolyData> surface;  ///< surfaces, lines, points
    vtkSmartPointer<vtkUnstructuredGrid> volume;
    std::vector<ArrayInfo> arrays;
    bool normals_into_fluid = true;

    [[nodiscard]] const ArrayInfo* find(const std::string& name) const;
};

/// Whether pressures are relative to something, and to what.
struct PressureReference {
    enum class Kind { gauge, absolute, unknown } kind = Kind::unknown;
    double operating_pressure = 0;  ///< Pa, added to gauge values gives absolute ones; 0 when unknown
};

struct Field {
    std::vector<std::string> files;  ///< what it was read from
    std::string format;              ///< "CFD-Post CSV", "Fluent legacy", "Fluent HDF5", "EnSight Gold", ...
    std::string writer;              ///< product and version when the file says so
    int dimension = 3;
    std::vector<Zone> zones;
    PressureReference pressure;
    std::optional<double> density;  ///< kg/m^3, constant, when the file says so
    std::vector<std::pair<std::string, std::string>> metadata;
    core::Problems problems;

    [[nodiscard]] const Zone* find(const std::string& name) const;
};

class AskedUnits;

/// What the caller knows that a file may not say.
struct ReadOptions {
    std::string length_unit;          ///< for formats without one; empty: refuse where it matters, else SI
    std::vector<std::string> arrays;  ///< canonical or original names; empty: all
    std::vector<std::string> zones;   ///< patterns (* ?); empty: all
    bool surfaces_only = false;       ///< leave volumes out, for loads
    std::optional<double>
        time;          ///< s, of files with several times; nothing: the last one. A warning of files that state none
    std::string base;  ///< of a CGNS file with several: its name, or its number from 1; empty: the last
    std::filesystem::path companion;  ///< the mesh of a results file, when it cannot be found by name
    /// Units that the file does not say: original column or variable name -> unit ("Pressure" -> "Pa").
    std::vector<std::pair<std::string, std::string>> units;
    /// The variables that importers found, kept by `read_field` itself: whoever states a unit for another made a slip.
    std::shared_ptr<AskedUnits> asked_units;
};

/// Reads any known file, found by its content. Throws core::InputError (file, line or byte) when it is damaged or
/// unknown, and where the format has no use for an option that is given (a time, a companion, a unit of a variable that
/// is not there).
Field read_field(const std::filesystem::path& path, const ReadOptions& options = {},
                 core::Progress& progress = core::Progress::none());

/// Canonical name of a known field variable ("Pressure", "SV_P", "p-rgh", ...), or the name itself.
/// The unit is the SI unit that the canonical quantity has, "" when the name is not known.
struct CanonicalName {
    std::string name;
    std::string unit;
};
CanonicalName canonical_name(const std::string& original);

/// "velocity_y" -> {"velocity", 1} for canonical vectors; nothing for anything else. Importers of formats that
/// store components apart join them to one array of three components.
struct VectorComponent {
    std::string vector;
    int index = 0;
};
std::optional<VectorComponent> vector_component(const std::string& canonical);

/// Does `name` fit a pattern with * and ? (without case)?
bool matches(const std::string& pattern, const std::string& name);
/// Does it fit any of them? No patterns: everything fits.
bool matches_any(const std::vector<std::string>& patterns, const std::string& name);

}  // namespace underbody::postproc
