// What a Fluent case says besides its mesh: writer, operating pressure, density, axisymmetry, units.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/importers/mesh/face_mesh.h"

namespace underbody::postproc {

struct FluentSettings {
    std::string writer;
    std::string variables;             ///< the Lisp text of section 37 ("Rampant Variables" in HDF5)
    std::vector<std::string> skipped;  ///< sections that were not understood: "3067 (4 times)"
    std::vector<std::string> notes;    ///< for the user
};

/// The value of `(name value)` or `(name . value)` in Lisp text: "101325", "\"si\"", "#f"; nothing if it is not there.
std::optional<std::string> lisp_value(std::string_view text, std::string_view name);

/// Writer, operating pressure, reference values, axisymmetry and the density of a constant-density fluid into the
/// field.
void apply_settings(const FluentSettings& settings, bool with_values, Field& field);

/// A case is in metres; a mesh says nothing, or its unit: scales by `options.length_unit` or the file's unit, and says
/// so.
void scale_lengths(FaceMesh& mesh, const ReadOptions& options, Field& field);

}  // namespace underbody::postproc
