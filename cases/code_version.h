// Which code made a result.
#pragma once

#include <map>
#include <string>

namespace underbody::cases {

/// Room ("postproc", "surrogates/tables", ...) -> hash over its sources at build time.
const std::map<std::string, std::string>& code_versions();

}  // namespace underbody::cases
