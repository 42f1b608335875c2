// The model behind a stability map of a study: the declared one with the study's force tables.
#pragma once

#include <filesystem>

#include "cases/study.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::cases {

/// Reads the model of the [[region]] and adds its tables as force sources. `tables` is the folder where the tables are
/// written and stay, so that dynamics::write_model can copy them; empty: they are in the model only.
/// Throws core::InputError when loads are missing or the model is wrong.
dynamics::Model region_model(const Study& study, const RegionSpec& spec, const StudyResults& results,
                             const std::filesystem::path& tables = {});

dynamics::RegionOptions region_options(const RegionSpec& spec);

}  // namespace underbody::cases
