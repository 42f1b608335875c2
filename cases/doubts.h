// What a result does not know of itself: doubts that other results of the same study cast on it.
#pragma once

#include <string>
#include <vector>

#include "cases/study.h"

namespace underbody::cases {

/// Sentences for a map of a model that a [[measurement]] of the study finds incomplete.
std::vector<std::string> doubts_of_model(const Study& study, const StudyResults& results, const RegionSpec& region);

/// What the steps of a [[measurement]] warn of (noise, runs outside a table, ...), each once; those of earlier versions
/// hold none.
std::vector<std::string> warnings_of(const MeasurementSpec& measurement, const StudyResults& results);

/// What a map takes otherwise than the study's tables: another speed, weight or water, or a speed that nobody states.
std::vector<std::string> warnings_of(const RegionSpec& region, const StudyResults& results);

/// Sentences for a table whose error is of a mesh study that does not converge.
std::vector<std::string> doubts_of_mesh(const TableSpec& table, const StudyResults& results);

}  // namespace underbody::cases
