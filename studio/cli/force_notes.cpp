#include "studio/cli/force_notes.h"

#include <nlohmann/json.hpp>

#include "studio/cli/shell.h"
#include "surrogates/dynamics/model/table_notes.h"
#include "surrogates/dynamics/plant/environment.h"

namespace underbody::studio {

namespace {

/// The message of a warning, which the text has said; nothing for a note.
std::vector<std::string> said(Shell& shell, const core::Problem& problem) {
    if (problem.severity == core::Problem::Severity::note) {
        return {};
    }
    if (!shell.json) {  // there they stand in the document
        shell.remark({problem});
    }
    return {problem.message};
}

}  // namespace

void show_forces(Shell& shell, const dynamics::Model& model, const dynamics::Conditions& held, nlohmann::json& json) {
    json["forces"] = dynamics::fits_json(model);
    json["warnings"] = nlohmann::json::array();
    for (const std::string& line : dynamics::fit_lines(model)) {
        shell.print(line + "\n");
    }
    const auto say = [&](const core::Problem& problem) {
        for (const std::string& warning : said(shell, problem)) {
            json["warnings"].push_back(warning);
        }
    };
    for (const core::Problem& problem : dynamics::held_outside(model, held.over(model.conditions))) {
        say(problem);
    }
    for (const core::Problem& problem : dynamics::effects_without_motion(model)) {
        say(problem);
    }
    for (const std::string& warning : show_table_warnings(shell, model)) {
        json["warnings"].push_back(warning);
    }
}

std::vector<std::string> show_table_warnings(Shell& shell, const dynamics::Model& model) {
    std::vector<std::string> warnings;
    for (const dynamics::ForceSource& source : model.forces) {
        for (const core::Problem& problem : source.table.remarks()) {
            const auto one = said(shell, problem);
            warnings.insert(warnings.end(), one.begin(), one.end());
        }
    }
    return warnings;
}

}  // namespace underbody::studio
