// Findings of importers and checks as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/error.h"

namespace underbody::postproc {

/// [{severity, message, file, line, column, byte}]; what is not known is left out.
nlohmann::json json_of(const core::Problems& problems);

}  // namespace underbody::postproc
