// What of a comparison with the solver's own loads is off by more than its tolerance and passes all the same.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace underbody::cases {

/// "; 4 more off by up to 3.41 % of the force's size, excused by what their own run swings by ..." of the document of a
/// verification; empty where there is none.
std::string excused(const nlohmann::json& verification);

}  // namespace underbody::cases
