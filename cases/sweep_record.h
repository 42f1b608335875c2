// What a case of a sweep is made of, kept in its folder, so that a case of other inputs is known as such.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/body/body_shape.h"
#include "geometry/cases/flow_domain.h"

namespace underbody::cases {

/// Everything that the solution of a case depends on.
struct CaseRecord {
    /// "body.length" -> "0.2032 m", "gap" -> "5 mm", "iterations" -> "400", ...: shape, placement, flow, mesh.
    std::vector<std::pair<std::string, std::string>> made_of;
    std::string shape;                         ///< geometry::shape_hash
    std::string code;                          ///< version of the code that writes the case
    std::map<std::string, std::string> files;  ///< the case's own files -> hash of what is solved by them
    std::vector<std::string> walls;            ///< patches of the body
};

/// Without `files` and `walls`.
CaseRecord record_of(const geometry::BodyShape& shape, const geometry::FlowOptions& flow);

/// Hashes of the files of a written case: system, constant without the mesh, time 0. How often it is written
/// (writeInterval, purgeWrite, startFrom) is no part of what is solved.
std::map<std::string, std::string> case_files(const std::filesystem::path& folder);

/// "iterations: 40 there, 60 now"; empty when both are made of the same. Code and files are not looked at.
std::vector<std::string> differences(const CaseRecord& there, const CaseRecord& now);
/// The files of both that differ, by name.
std::vector<std::string> different_files(const CaseRecord& there, const CaseRecord& now);

nlohmann::json to_json(const CaseRecord& record);
/// Nothing when it is no whole record.
std::optional<CaseRecord> record_from(const nlohmann::json& json);

}  // namespace underbody::cases
