// underbody doctor: what is here of the programs that some commands call.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cases/surroundings.h"
#include "core/counted.h"
#include "core/text.h"
#include "studio/cli/commands.h"
#include "studio/cli/field_options.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

std::string gigabytes(const nlohmann::json& bytes) { return core::format_number(bytes.get<double>() / 1e9, 3) + " GB"; }

std::string line_of(const cases::Surrounding& one) {
    const std::string head =
        (one.found ? "yes  " : "no   ") + one.name + std::string(10 - std::min<std::size_t>(9, one.name.size()), ' ');
    std::string text = head + one.purpose;
    const std::string below = "\n" + std::string(15, ' ');
    if (one.found) {
        text += below + (one.version.empty() ? "" : one.version + ", ") + one.path;
    }
    text += one.note.empty() ? "" : below + one.note;
    return text + (one.found ? "" : below + "to get it: " + one.get);
}

int run_doctor(Shell& shell, const std::vector<std::string>& needed) {
    const auto all = cases::surroundings(shell.progress());
    std::vector<std::string> names;
    for (const auto& one : all) {
        names.push_back(one.name);
    }
    std::string missing;
    for (const auto& name : needed) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) {
            throw core::UsageError("name", "doctor does not look for '" + name + "'", {},
                                   core::did_you_mean(name, names));
        }
        if (!all[static_cast<std::size_t>(found - names.begin())].found) {
            missing += (missing.empty() ? "" : ", ") + name;
        }
    }
    const nlohmann::json machine = cases::machine_json();
    if (shell.json) {
        shell.print_json({{"version", version()}, {"machine", machine}, {"parts", all}});
    }
    shell.print("underbody " + version() + " on " + core::counted(machine["cores"].get<int>(), "core") + ", " +
                gigabytes(machine["memory"]) + " of memory, " + gigabytes(machine["free_disk"]) + " free here");
    for (const auto& one : all) {
        shell.print(line_of(one));
    }
    if (!missing.empty()) {
        shell.warn("not here: " + missing);
        return check_failed;
    }
    return done;
}

}  // namespace

void add_doctor_command(CLI::App& app, Shell& shell) {
    CLI::App* command =
        app.add_subcommand("doctor", "what is here of the programs that some commands call, and how to get the rest");
    auto needed = std::make_shared<std::vector<std::string>>();
    command->add_option("--need", *needed, "exit code 4 when one of these is not here: openfoam,slurm")
        ->delimiter(',')
        ->transform(trimmed_name);
    command->footer(
        "Nothing is installed or changed, and everything named here is optional: without it the commands that it is "
        "for "
        "say so.\n"
        "Examples:\n"
        "  underbody doctor\n"
        "  underbody doctor --need openfoam,xvfb      for scripts: is this machine good for a sweep with pictures?\n"
        "  underbody doctor --json");
    shell.on(command, [needed, &shell] { return run_doctor(shell, *needed); });
}

}  // namespace underbody::studio
