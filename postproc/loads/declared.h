// What was declared of a case, held against what its file shows: gap, pitch, speed, the point of the moments, the
// lengths of the body, its conditions.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "postproc/field/vector_math.h"
#include "postproc/loads/loads_result.h"

namespace underbody::postproc {

struct Field;

/// A warning where the gap (m) declared for a file differs from the height of the moment's reference point, the middle
/// of the base, over the ground: the highest flat wall under it that is not the body's, else the plane 0 of the file.
/// It may differ by 5 %, by the rounding of its last digit, and by a tenth of the length along a body pitched (rad)
/// about some other point. Nothing where the file does not tell: a reference that was given, one below that plane, a
/// plane case.
std::optional<core::Problem> gap_fault(const Field& field, const LoadsResult& loads, double gap, double pitch);

/// Warnings for lengths of reference that are more than `limit` times off those of the body (length, width and height;
/// 0: not known).
core::Problems size_faults(const LoadsReferences& given, const Vector& body, double limit, const core::Place& place);

/// A warning where the zones of the base (`base`: their pattern) do not face down in a whole body: its up is another
/// direction of the file, or two columns of coordinates have changed places. Nothing for a plane case, and none for a
/// base that faces up on an open surface, whose outside nothing tells.
std::optional<core::Problem> base_fault(const LoadsResult& loads, const std::string& base);

/// rad, nose up: how far the flat base of a body is pitched against the axes of its file, from the summed area of its
/// zones (`base`: their pattern), which only their rim decides. NaN where no such zone is flat, and in a plane case.
double base_tilt(const LoadsResult& loads, const std::string& base);

/// A warning where the pitch (rad) declared for a file cannot be the body's whatever tilt its base has of its own (15
/// deg at most): degrees read as radians, or the other way round, or one beyond 90 deg.
std::optional<core::Problem> pitch_fault(const LoadsResult& loads, const std::string& base, double pitch);

/// A warning for a point of the moments that was given and lies more than `limit` times the size of the body away from
/// it: one in mm that was read in m.
std::optional<core::Problem> reference_fault(const Field& field, const LoadsResult& loads, double limit);

/// A warning where the highest pressure on a closed body, counted from the middle one, is not that of a flow of its
/// speed and density, which comes to rest at 1/2 rho U^2: below a fifth, above six times (on zones that fit `base`,
/// where there are no others, thirty times: a film over the ground). Whatever the pressure is relative to, with or
/// without the weight of the water. Speed and density are those of its coefficients; where it has none, `speed` (m/s;
/// NaN: not said, and there is no warning) in the field's density, or fresh water's where nobody states one.
std::optional<core::Problem> flow_fault(const Field& field, const LoadsResult& loads, const std::string& base,
                                        double speed = NAN);

/// What was said of a case that its file is to bear out.
struct Declared {
    double gap = NAN, pitch = NAN;  ///< m, rad; NaN: not said
    std::string base = "*base*";    ///< pattern of the zones of the flat base
    bool zones_named = false;       ///< the zones may be a part of the body
    bool driven = false;            ///< by jets: pressures do not follow from the speed
    double speed = NAN;             ///< m/s; NaN: not said
};
/// All of the above of one case.
core::Problems declared_faults(const Field& field, const LoadsResult& loads, const Declared& said);

/// Of cases, what tells them apart and what came out.
struct ConditionedLoads {
    std::string name;
    std::vector<std::pair<std::string, std::string>> conditions;  ///< name and value, as shown
    std::vector<double> loads;                                    ///< lift, drag and side force first
    double base_pitch = NAN;                                      ///< rad, in the file: base_tilt
};
/// A warning for each group of cases whose loads are the same to the last digit although their conditions, other than
/// the time, differ: copies of one file. Beside it the last of the group, by its place in `cases`. Of a group the first
/// names, of very many groups the first and how many more there are.
std::vector<std::pair<core::Problem, std::size_t>> same_loads(const std::vector<ConditionedLoads>& cases);

/// A warning for each of a few cases (a third at most, of four and more) whose forces, over the square of the speed
/// where all state one, are more than 300 times those of all others, or about a thousandth: one file of a batch has its
/// pressure in another unit, or over density.
std::vector<std::pair<core::Problem, std::size_t>> other_sizes(const std::vector<ConditionedLoads>& cases);

/// A warning for each case whose pitch and whose base in the file do not differ as they do in most cases of the same
/// body (words and numbers that are no quantities tell bodies apart): files that were exchanged, a sign that was
/// turned. One for all where the base lies alike in every file whatever pitch was declared.
std::vector<std::pair<core::Problem, std::size_t>> other_pitches(const std::vector<ConditionedLoads>& cases);

/// All of these.
std::vector<std::pair<core::Problem, std::size_t>> odd_loads(const std::vector<ConditionedLoads>& cases);

}  // namespace underbody::postproc
