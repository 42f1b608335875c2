// What was declared of a case, held against what its file shows: the gap, the lengths of the body, its conditions.
#pragma once

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

/// Of cases, what tells them apart and what came out.
struct ConditionedLoads {
    std::string name;
    std::vector<std::pair<std::string, std::string>> conditions;  ///< name and value, as shown
    std::vector<double> loads;                                    ///< lift, drag and side force first
};
/// A warning for each group of cases whose loads are the same to the last digit although their conditions, other than
/// the time, differ: copies of one file. Beside it the last of the group, by its place in `cases`. Of a group the first
/// names, of very many groups the first and how many more there are.
std::vector<std::pair<core::Problem, std::size_t>> same_loads(const std::vector<ConditionedLoads>& cases);

/// A warning for each of a few cases (a third at most, of four and more) whose forces, over the square of the speed
/// where all state one, are more than 300 times those of all others, or about a thousandth: one file of a batch has its
/// pressure in another unit, or over density.
std::vector<std::pair<core::Problem, std::size_t>> other_sizes(const std::vector<ConditionedLoads>& cases);

/// Both.
std::vector<std::pair<core::Problem, std::size_t>> odd_loads(const std::vector<ConditionedLoads>& cases);

}  // namespace underbody::postproc
