#include "studio/cli/force_notes.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "studio/cli/shell.h"
#include "surrogates/dynamics/model/table_notes.h"
#include "surrogates/dynamics/plant/environment.h"

namespace underbody::studio {

namespace {

/// The messages of those that are no notes, which are said.
std::vector<std::string> said(Shell& shell, const core::Problems& problems) {
    std::vector<std::string> messages;
    for (const core::Problem& problem : problems) {
        if (problem.severity != core::Problem::Severity::note) {
            messages.push_back(problem.message);
            shell.show({problem});
        }
    }
    return messages;
}

/// Of the model and of its force tables, each once.
core::Problems table_remarks(const dynamics::Model& model) {
    core::Problems all = model.remarks;
    for (const dynamics::ForceSource& source : model.forces) {
        for (const core::Problem& own : source.table.remarks()) {
            if (std::none_of(all.begin(), all.end(),
                             [&](const core::Problem& known) { return known.message == own.message; })) {
                all.push_back(own);
            }
        }
    }
    return all;
}

core::Problems together(core::Problems first, const core::Problems& more) {
    first.insert(first.end(), more.begin(), more.end());
    return first;
}

core::Problems outside_or_in_vain(const dynamics::Model& model, const dynamics::Conditions& held) {
    return together(dynamics::held_outside(model, held.over(model.conditions)),
                    together(dynamics::held_in_vain(model, held), dynamics::gaps_of_another_size(model)));
}

}  // namespace

core::Table commented(Shell& shell, core::Table table) {
    shell.comment_warnings(table);
    return table;
}

std::vector<std::string> show_held_at_reference(Shell& shell, const dynamics::Model& model,
                                                const dynamics::Conditions& held,
                                                const std::vector<dynamics::Channel>& moving) {
    std::vector<std::string> notes;
    for (const core::Problem& note : dynamics::held_at_reference(model, held, moving)) {
        shell.print(note.message + "\n");
        notes.push_back(note.message);
    }
    return notes;
}

void show_forces(Shell& shell, const dynamics::Model& model, const dynamics::Conditions& held, nlohmann::json& json,
                 const std::vector<dynamics::Channel>& moving) {
    json["forces"] = dynamics::fits_json(model);
    for (const std::string& line : dynamics::fit_lines(model)) {
        shell.print(line + "\n");
    }
    json["held_at_reference"] = show_held_at_reference(shell, model, held, moving);
    json["warnings"] = said(shell, together(outside_or_in_vain(model, held),
                                            together(dynamics::effects_without_motion(model), table_remarks(model))));
}

std::vector<std::string> show_table_warnings(Shell& shell, const dynamics::Model& model,
                                             const dynamics::Conditions& held) {
    return said(shell, together(outside_or_in_vain(model, held), table_remarks(model)));
}

std::vector<std::string> show_table_warnings(Shell& shell, const dynamics::Model& model,
                                             const dynamics::Measurements& data) {
    return said(shell, together(dynamics::runs_outside(model, data), table_remarks(model)));
}

}  // namespace underbody::studio
