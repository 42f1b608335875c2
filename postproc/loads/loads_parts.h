// The zones whose faces are summed to loads, with their values: which ones, from where, in SI.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <memory>
#include <string>
#include <vector>

#include "postproc/field/field.h"
#include "postproc/field/surface_arrays.h"
#include "postproc/loads/face_integral.h"
#include "postproc/loads/loads_result.h"

namespace underbody::postproc {

/// One zone, or one of several closed shells of it, ready to be summed.
struct SummedZone {
    const Zone* zone = nullptr;
    std::string name;                       ///< of the zone, with the number of the shell
    vtkSmartPointer<vtkPolyData> polygons;  ///< of the zone; a plane case's lines as a strip, see `zones_to_sum`
    std::unique_ptr<SurfaceArrays> surface;
    FaceValues values;
    std::vector<double> own_pressure;  ///< what `values` look into, unless that is VTK's
    std::vector<double> own_shear;
    bool absolute = false;  ///< its pressure is not relative to anything
    FaceSums sums;
    double sign = 1;
};

/// Is the plane case half the section of a body of revolution about the x axis?
bool is_body_of_revolution(const Field& field, const LoadsOptions& options);

/// The zones asked for, or those of the body; sets `values_from` and `left_out` of the result and adds to its problems.
/// The lines of a plane case become strips across the plane: of one metre, or, of a body of revolution, as wide as
/// the circle that each place runs through (flat and still of the right area and slope, so that along the axis, and for
/// the moment about it, the sums are those of the whole body).
/// Throws InputError: no zone fits, a zone without faces or without pressure, a density that is missing, gauge and
/// absolute pressures without a known difference, a body of revolution on both sides of its axis.
std::vector<SummedZone> zones_to_sum(const Field& field, const LoadsOptions& options, LoadsResult& result);

/// Throws InputError that names the first value that is missing, if the zone's sums are not finite.
void refuse_missing_values(const SummedZone& part, const Field& field, const std::string& file);

/// Throws InputError when the fields are those of no solution: the initial ones of an OpenFOAM case whose last time is
/// 0 (one pressure everywhere), values beyond anything physical, as a diverged run writes. With `accept` a warning.
void refuse_no_solution(const std::vector<SummedZone>& parts, const Field& field, LoadsResult& result, bool accept);

/// "'base', 'hull'"
std::string quoted(const std::vector<std::string>& names);

}  // namespace underbody::postproc
