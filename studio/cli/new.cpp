// underbody new FORMAT [FILE]: a commented file to begin with.
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cases/file_templates.h"
#include "core/file_format.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

void add_new_command(CLI::App& app, Shell& shell) {
    auto* command = app.add_subcommand("new", "writes a commented template of a shape, study, model or data set");
    struct Options {
        std::string format, file;
    };
    auto options = std::make_shared<Options>();
    std::string names;
    for (const core::FileFormat* format : cases::file_formats()) {
        names += (names.empty() ? "" : ", ") + format->name;
    }
    command->add_option("format", options->format, "what to write: " + names)->required();
    command->add_option("file", options->file, "file or folder; default: the usual name in this folder; -: to stdout");
    command->footer(
        "The template is accepted as it stands; what begins with # may be added. A file that is there is not "
        "replaced.\n"
        "Examples:\n"
        "  underbody new shape body.toml\n"
        "  underbody new study .\n"
        "  underbody new model model.toml\n"
        "  underbody new dataset runs/\n"
        "  underbody new model -\n"
        "Every key with its unit and default: underbody list keys model");
    shell.on(command, [&shell, options] {
        if (options->file == "-") {
            const std::string text = core::template_text(cases::file_format(options->format));
            shell.json ? shell.print_json({{"text", text}}) : shell.print(text);
            return static_cast<int>(done);
        }
        nlohmann::json files = nlohmann::json::array();
        for (const auto& file : cases::write_template(options->format, options->file)) {
            files.push_back(file.string());
            shell.print("wrote " + file.string());
        }
        if (shell.json) {
            shell.print_json({{"files", files}});
        }
        return static_cast<int>(done);
    });
}

}  // namespace underbody::studio
