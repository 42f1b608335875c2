#include "studio/cli/program.h"

#include <CLI/CLI.hpp>

#include "studio/cli/commands.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

/// What every command takes is said by every command's help.
void mention_common_options(CLI::App& app) {
    for (auto* command : app.get_subcommands([](CLI::App*) { return true; })) {
        const std::string footer = command->get_footer();
        command->footer(footer + (footer.empty() ? "" : "\n") +
                        "With every command: --json, --quiet, --verbose, --threads N, --force (underbody --help)");
        mention_common_options(*command);
    }
}

/// An option that may be given several times takes one word each time: else it would take the words behind it too, a
/// file among them (--zones hull body.csv). The word says something: an empty one would count as not given. A count
/// below zero would be read as one of 2^64 less so many.
void one_word_an_option(CLI::App& app) {
    const CLI::Validator something(
        [](const std::string& word) { return word.empty() ? "it is empty: leave it out, or say what" : std::string(); },
        "", "");
    const CLI::Validator no_sign(
        [](const std::string& word) {
            return word.starts_with('-') ? "'" + word + "' is below 0: it counts" : std::string();
        },
        "", "");
    for (auto* option : app.get_options()) {
        if (option->get_positional() || option->get_items_expected_max() == 0) {
            continue;
        }
        if (option->get_items_expected_max() > 1) {
            option->allow_extra_args(false);
        }
        option->check(something);
        if (option->get_type_name().starts_with("UINT")) {
            option->check(no_sign);
        }
    }
    for (auto* command : app.get_subcommands([](CLI::App*) { return true; })) {
        one_word_an_option(*command);
    }
}

}  // namespace

std::string version() { return UNDERBODY_VERSION; }

void add_commands(CLI::App& app, Shell& shell, const std::string& only) {
    app.name("underbody");
    app.description("Underbody: CFD post-processing and ground-effect design studio");
    app.set_version_flag("--version", version());
    app.require_subcommand(1);
    app.fallthrough();  // --json and the like may stand before or after the command
    app.footer(
        "Examples:\n"
        "  underbody loads body.csv                       forces and moments of a CFD-Post export\n"
        "  underbody table equilibria lift.csv --weight 0.3\n"
        "  underbody study run cases/evie                 the shipped study, to a report\n"
        "Each command has examples of its own: underbody COMMAND --help\n"
        "Exit codes: 0 done, 1 defect of the program, 2 wrong use, 3 wrong input, 4 a check failed, 130 cancelled.");
    app.add_flag("--json", shell.json, "results as one JSON document on stdout");
    app.add_flag("--quiet", shell.quiet, "no progress and no remarks");
    app.add_flag("--verbose", shell.verbose, "say more of what is done");
    app.add_flag("--force", shell.force, "replace files that underbody did not write, or that were changed since");
    app.add_option("--threads", shell.threads, "threads to use (default: all cores)")->check(CLI::NonNegativeNumber);
#define UNDERBODY_ADD(name)               \
    if (only.empty() || only == #name) {  \
        add_##name##_command(app, shell); \
    }
    UNDERBODY_COMMANDS(UNDERBODY_ADD)
#undef UNDERBODY_ADD
    mention_common_options(app);
    one_word_an_option(app);
}

}  // namespace underbody::studio
