// underbody discover: what does the model lack?
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/wording.h"

namespace underbody::studio {

namespace {

struct Arguments {
    std::string model;
    std::string data;
    std::string out;
    std::string horizon = "2 s";
    std::uint64_t seed = 1;
};

void print(Shell& shell, const discovery::Discovery& found, const std::filesystem::path& folder) {
    std::string text = found.sentence + "\n";
    for (const discovery::FoundEffect& effect : found.effects) {
        text += "\n" + effect.name + ", probability " + core::format_number(effect.probability, 3) + "\n";
        for (const discovery::FoundParameter& parameter : effect.parameters) {
            text += "  " + parameter.name + " = " + discovery::value_text(parameter) + "\n";
        }
    }
    if (!found.alternatives.empty()) {
        text += "\nWhat else it could be:\n";
        for (const discovery::FoundEffect& rival : found.alternatives) {
            text += "  " + rival.name + ", probability " + core::format_number(rival.probability, 3) +
                    (rival.told_apart_by.empty() ? "" : ": " + rival.told_apart_by) + "\n";
        }
    }
    for (const discovery::ErrorChange& change : found.error) {
        text += "\nError of " + change.channel + " on held-out data: " + core::format_number(change.before.rmse, 3) + " -> " +
                core::format_number(change.after.rmse, 3) + " " + change.unit + " (noise " + core::format_number(change.noise, 3) + ")";
    }
    text += "\n\nNext experiment: " + found.next_experiment + "\nReport: " + (folder / "report.html").string() + "\n";
    shell.print(text);
}

}  // namespace

void add_discover_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("discover", "find what the model lacks: from measured data to the effect, and the error before and after");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("model", arguments->model, "the declared model (model.toml)")->required();
    command->add_option("--data", arguments->data, "folder of measurements (with dataset.toml)")->required();
    command->add_option("--out", arguments->out, "folder for model.toml, report.html and discovery.json")->required();
    command->add_option("--horizon", arguments->horizon, "length of the prediction windows of a time series");
    command->add_option("--seed", arguments->seed, "seed of all random draws");
    command->footer(
        "Examples:\n"
        "  underbody discover model.toml --data runs --out found        report, new model and discovery.json in found/\n"
        "  underbody discover model.toml --data runs --out found --json the same, discovery.json on stdout as well\n"
        "  underbody predict found/model.toml --data other-runs         the new model on data it has not seen\n"
        "The verdict is 'none', 'effect' (named, with its numbers) or 'unknown' (a smooth correction takes its place).");
    shell.on(command, [arguments, &shell] {
        const dynamics::Model model = dynamics::read_model(arguments->model);
        const dynamics::Measurements data = dynamics::read_measurements(arguments->data);
        discovery::DiscoverOptions options;
        options.horizon = core::parse_in(arguments->horizon, "s");
        options.seed = arguments->seed;
        const discovery::Discovery found = discovery::discover(model, data, options, shell.progress());
        shell.show(found.problems);
        discovery::write_discovery(found, model, data, arguments->out, [](const core::Figure& figure) { return render_png(figure); });
        if (shell.json) {
            shell.print_json(discovery::to_json(found));
        }
        print(shell, found, arguments->out);
        return static_cast<int>(ExitCode::done);
    });
}

}  // namespace underbody::studio
