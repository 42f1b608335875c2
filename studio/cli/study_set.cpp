#include "studio/cli/study_set.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "cases/accept.h"
#include "cases/study.h"
#include "cases/study_format.h"
#include "cases/study_text.h"
#include "core/file.h"
#include "core/own_files.h"
#include "core/text.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

/// Tables that a study has once: reference, sweep.slurm ...; "" for what stands before the first.
std::vector<std::string> single_tables() {
    std::vector<std::string> paths;
    for (const auto& table : cases::study_format().tables) {
        if (table.path.find("[]") == std::string::npos) {
            paths.push_back(table.path);
        }
    }
    return paths;
}

/// TABLE.KEY=VALUE, KEY=VALUE of what stands before the first table, or KIND.NAME.KEY=VALUE; a name may hold dots.
std::string with_assignment(const std::string& text, const std::string& assignment) {
    const auto [path, value] = name_and_value("study set", assignment);
    const auto first = path.find('.');
    const auto last = path.rfind('.');
    const std::string table = last == std::string::npos ? "" : path.substr(0, last);
    const auto single = single_tables();
    if (std::find(single.begin(), single.end(), table) != single.end()) {
        return cases::with_value_of_table(text, table, path.substr(last + 1), value);  // npos + 1 is 0: all of it
    }
    if (first == last) {
        std::string hint = core::did_you_mean(table, single);
        hint += hint.empty() ? "" : "; ";
        throw core::UsageError("parse", "'" + path + "' is neither TABLE.KEY nor KIND.NAME.KEY of a study", {},
                               hint + "such as reference.density=\"998 kg/m^3\" or table.lift.net_weight=0.28N");
    }
    return cases::with_value(text, path.substr(0, first), path.substr(first + 1, last - first - 1),
                             path.substr(last + 1), value);
}

int set_values(Shell& shell, const std::string& folder, const std::vector<std::string>& assignments) {
    const std::filesystem::path file = std::filesystem::path(folder) / "study.toml";
    std::string text = core::read_file(file);
    for (const auto& assignment : assignments) {
        text = with_assignment(text, assignment);
    }
    const auto after = cases::Study::from_text(text, file);  // what is wrong with it is said before it is written
    const core::ReplacingAllowed of_the_user;                // who asked for it
    core::write_file(file, text);
    shell.print(file.string() + ": " + std::to_string(assignments.size()) +
                (assignments.size() == 1 ? " value set" : " values set"));
    if (shell.json) {
        shell.print_json({{"study", file.string()}, {"set", assignments}});
    }
    return done;
}

int accept_model(Shell& shell, const std::string& folder, const std::string& measurement) {
    const auto study = cases::Study::open(folder);
    const auto accepted = cases::accept_model(study, cases::stored_results(study, {}), measurement);
    cases::write_accepted(study, accepted);
    std::string users;
    for (const auto& user : accepted.users) {
        users += (users.empty() ? "" : ", ") + user;
    }
    shell.print(accepted.sentence + "\n" + (study.folder() / accepted.model).string() + " is now the model of " +
                users + "; underbody study run " + folder + " makes what rests on it");
    if (shell.json) {
        shell.print_json({{"measurement", measurement},
                          {"model", (study.folder() / accepted.model).string()},
                          {"users", accepted.users},
                          {"sentence", accepted.sentence}});
    }
    return done;
}

}  // namespace

void add_study_accept(CLI::App& study, Shell& shell) {
    auto* command = study.add_subcommand(
        "accept", "takes the model that `discover` found for a measurement as the study's own; the old one stays");
    auto folder = std::make_shared<std::string>();
    auto measurement = std::make_shared<std::string>();
    command->add_option("study", *folder, "folder of the study")->required();
    command->add_option("measurement", *measurement, "name of the [[measurement]]")->required();
    command->footer("Example:\n  underbody study accept cases/evie 'heave test'");
    shell.on(command, [folder, measurement, &shell] { return accept_model(shell, *folder, *measurement); });
}

void add_study_set(CLI::App& study, Shell& shell) {
    auto* command = study.add_subcommand("set", "change values in study.toml; comments and order stay");
    auto folder = std::make_shared<std::string>();
    auto assignments = std::make_shared<std::vector<std::string>>();
    command->add_option("study", *folder, "folder of the study")->required();
    command->add_option("values", *assignments, "TABLE.KEY=VALUE or KIND.NAME.KEY=VALUE ...")->required();
    command->footer(
        "Examples:\n  underbody study set cases/evie table.lift.net_weight=0.28N\n"
        "  underbody study set cases/evie \"reference.density=1025 kg/m^3\"");
    shell.on(command, [folder, assignments, &shell] { return set_values(shell, *folder, *assignments); });
}

}  // namespace underbody::studio
