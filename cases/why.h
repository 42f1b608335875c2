// Where a number comes from: from a result back to the files, options and code that made it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cases/store.h"
#include "cases/study.h"

namespace underbody::cases {

/// One result with all that it rests on.
struct Origin {
    std::string kind;  ///< "loads", "table", "region", "export", ...
    std::string name;
    StepState state = StepState::unchanged;
    std::string made;  ///< UTC
    std::vector<std::pair<std::string, std::string>>
        facts;  ///< what it says of itself: "lift_force" -> "0.5 N", "faces" -> "6"
    std::vector<std::pair<std::string, std::string>> options;
    std::vector<std::pair<std::string, std::string>> code;  ///< room -> version of its sources
    std::vector<StoredInput> files;                         ///< read, looked for, listed
    std::vector<std::pair<std::string, std::string>> from;  ///< kind and name of the results that it was made of
};

/// The result first, then those that it rests on, each once, nearest first. `what`: "table/lift", "lift" where only one
/// result is called so, "lift_force of cube-h2", or a file beside the report ("exports/lift.h"). Throws
/// core::InputError: no such result (with the nearest name), several, or none that is still true.
std::vector<Origin> origins(const Study& study, const RunOptions& options, const std::string& what);

void to_json(nlohmann::json& json, const Origin& origin);

}  // namespace underbody::cases
