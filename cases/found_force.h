// The force of a [[table]] as a measurement of the study was found to change it: what a controller is to be given once
// the effect is accepted.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "cases/study.h"
#include "core/progress.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/points/range_policy.h"

namespace underbody::cases {

struct FoundForce {
    std::string measurement;      ///< whose model it is
    std::filesystem::path model;  ///< its file
    std::string effects;          ///< that change the force: "surface_roughness"
    std::string digest;           ///< equal for equal models, wherever they lie
};

/// What was found and taken as the study's own changes the force of the table: a measurement among `accepted` (whose
/// spec in `study` names the found model, see with_accepted), or one whose found model was written into the study
/// (write_accepted), has one force source of the table's quantity, with the very points of the table, and an effect of
/// the vehicle that acts on it at rest. The first one; nothing where there is none, the table has no points or the
/// model cannot be read.
std::optional<FoundForce> found_force(const Study& study, const StudyResults& results, const TableSpec& spec,
                                      const std::set<std::string>& accepted);

/// The force of that model over the axes of the table, as it simulates it: N or N m, axes SI. Throws as
/// dynamics::force_tables.
tables::ForceTable table_of_found(const FoundForce& found, const TableSpec& spec,
                                  const tables::RangePolicies& range = {},
                                  core::Progress& progress = core::Progress::none());

}  // namespace underbody::cases
