// Where a number comes from: from a result back to the files, options and code that made it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cases/store.h"
#include "cases/study.h"

namespace underbody::cases {

/// What a result says of itself.
struct Fact {
    std::string name;   ///< "lift_force", "stable gap", "zone 'hull'"
    std::string value;  ///< "0.5 N", "6 faces, 0.06 m^2"
    std::optional<double> number;
    std::string unit;  ///< of `number`, SI
};

/// One result with all that it rests on.
struct Origin {
    std::string kind;  ///< "loads", "table", "region", "export", ...
    std::string name;
    std::string id;  ///< 16 hexadecimal digits; exported files say it in their head ("Result: table/lift ID")
    StepState state = StepState::unchanged;
    std::string made;  ///< UTC
    std::vector<Fact> facts;
    std::vector<std::pair<std::string, std::string>> options;
    std::vector<std::pair<std::string, std::string>> code;  ///< room -> version of its sources
    std::vector<StoredInput> files;                         ///< read, looked for, listed
    std::vector<std::pair<std::string, std::string>> from;  ///< kind and name of the results that it was made of

    [[nodiscard]] const Fact* fact(const std::string& fact_name) const;
};

/// The way back from a number.
struct Way {
    std::optional<Fact> asked;       ///< the number asked for; nothing when a whole result was
    std::vector<std::string> notes;  ///< what changed since a file was exported, ...
    /// The result first, then those that it rests on, each once, nearest first.
    std::vector<Origin> origins;
};

/// `what`: "table/lift"; "lift" where only one result is called so; "lift_force of cube-h2"; a number as a report
/// prints it ("3.5 mm", "12.3 %"); a file beside the report ("exports/lift.h"), or a copy of one elsewhere, which its
/// head tells: also of a result that has been made anew since. Throws core::InputError: no such result or number (with
/// the nearest name), several (named), none that is still true.
Way way_back(const Study& study, const RunOptions& options, const std::string& what);

void to_json(nlohmann::json& json, const Fact& fact);
void to_json(nlohmann::json& json, const Origin& origin);

/// What the value of a result says (why_facts.cpp). `folder`: of the study.
std::vector<Fact> facts_of(const std::string& kind, const std::string& value, const std::filesystem::path& folder);

}  // namespace underbody::cases
