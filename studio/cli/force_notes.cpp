#include "studio/cli/force_notes.h"

#include <nlohmann/json.hpp>

#include "studio/cli/shell.h"
#include "surrogates/dynamics/model/table_notes.h"
#include "surrogates/dynamics/plant/environment.h"

namespace underbody::studio {

void show_forces(Shell& shell, const dynamics::Model& model, const dynamics::Conditions& held, nlohmann::json& json) {
    json["forces"] = dynamics::fits_json(model);
    json["warnings"] = nlohmann::json::array();
    for (const std::string& line : dynamics::fit_lines(model)) {
        shell.print(line + "\n");
    }
    const auto say = [&](const core::Problem& problem) {
        if (problem.severity != core::Problem::Severity::note) {
            if (!shell.json) {  // there they stand in the document
                shell.remark({problem});
            }
            json["warnings"].push_back(problem.message);
        }
    };
    for (const core::Problem& problem : dynamics::held_outside(model, held.over(model.conditions))) {
        say(problem);
    }
    for (const core::Problem& problem : dynamics::effects_without_motion(model)) {
        say(problem);
    }
    for (const dynamics::ForceSource& source : model.forces) {
        for (const core::Problem& problem : source.table.remarks()) {
            say(problem);
        }
    }
}

}  // namespace underbody::studio
