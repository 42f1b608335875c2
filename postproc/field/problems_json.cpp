#include "postproc/field/problems_json.h"

#include <nlohmann/json.hpp>

namespace underbody::postproc {

nlohmann::json json_of(const core::Problems& problems) {
    nlohmann::json list = nlohmann::json::array();
    for (const auto& problem : problems) {
        const char* word = problem.severity == core::Problem::Severity::note      ? "note"
                           : problem.severity == core::Problem::Severity::warning ? "warning"
                                                                                  : "error";
        nlohmann::json entry = {{"severity", word}, {"message", problem.message}};
        if (!problem.place.file.empty()) {
            entry["file"] = problem.place.file;
        }
        if (problem.place.line) {
            entry["line"] = *problem.place.line;
        }
        if (problem.place.column) {
            entry["column"] = *problem.place.column;
        }
        if (problem.place.byte) {
            entry["byte"] = *problem.place.byte;
        }
        list.push_back(std::move(entry));
    }
    return list;
}

}  // namespace underbody::postproc
