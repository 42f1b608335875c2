// Forces and moments that a field exerts on a body, in one pass over its faces.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "postproc/field/field.h"
#include "postproc/field/vector_math.h"
#include "postproc/loads/loads_result.h"

namespace underbody::postproc {

/// How the axes of a file lie to the vehicle: unit vectors of the file's frame.
/// "+x", "-z", "x": an axis of the file. Throws core::UsageError for anything else.
Vector axis_from(const std::string& text);

/// Integrates pressure and wall shear. Node values are taken bilinear over quads and linear over triangles and the
/// fans of larger polygons, and integrated exactly (force and moment); face values are constant over their face.
/// A plane case gives forces per metre depth, an axisymmetric one those on the whole body of revolution.
/// Deterministic whatever the number of threads. Where no zones are named and some wall cannot be part of a body with
/// the others (a ground), it is left out if the others close without it; if they do not, nobody can tell what the body
/// is, and that is an error. A zone all of whose faces stand in others too (a group beside its members) is left out;
/// named, it counts twice with a warning. Throws core::InputError: zones that share some of their faces only, no zone
/// fits, a zone without faces or pressure, a value that is missing, an importer's error (unless accepted), a half model
/// on both sides of its plane, gauge and absolute pressures side by side.
LoadsResult loads(const Field& field, const LoadsOptions& options = {},
                  core::Progress& progress = core::Progress::none());

/// Keys of docs/conventions.md section 7.
void to_json(nlohmann::json& json, const LoadsResult& result);

/// Every quantity of a result that goes into a table, with its SI unit: lift_force, drag_force, ..., closure.
struct LoadsColumn {
    std::string name;
    std::string unit;
    double value = 0;
};
std::vector<LoadsColumn> table_row(const LoadsResult& result);
/// These, the coefficients where there are any, the reference point and length: what a row of every table of loads
/// holds.
std::vector<LoadsColumn> table_columns(const LoadsResult& result);

}  // namespace underbody::postproc
