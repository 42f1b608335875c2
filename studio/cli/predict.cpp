// underbody predict: the model against measured runs.
#include "surrogates/dynamics/simulate/predict.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/force_notes.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

struct PredictArguments {
    std::string model;
    std::string data;
    std::string horizon = "2 s";
    std::string out;
    std::string plot;
};

int run_predict(const PredictArguments& a, Shell& shell) {
    for (const std::string& file : {a.out, a.plot}) {
        Shell::will_write(file);
    }
    const dynamics::Model model = dynamics::read_model(a.model);
    const dynamics::Measurements data = dynamics::read_measurements(a.data);
    std::vector<std::string> warnings = show_table_warnings(shell, model, data);
    dynamics::PredictOptions options;
    options.horizon = option_value("--horizon", a.horizon, "s");
    const dynamics::Prediction prediction = dynamics::predict(model, data, options, shell.progress());
    shell.show(prediction.remarks);
    for (const core::Problem& remark : prediction.remarks) {
        if (remark.severity != core::Problem::Severity::note &&
            std::find(warnings.begin(), warnings.end(), remark.message) == warnings.end()) {
            warnings.push_back(remark.message);
        }
    }
    shell.hand_over("prediction", [&] { return commented(shell, prediction.table); });
    if (!a.out.empty()) {
        core::write_csv(std::filesystem::path(a.out), commented(shell, prediction.table));
    }
    if (!a.plot.empty()) {
        write_picture(dynamics::prediction_figure(prediction), a.plot);
    }
    if (shell.json) {
        nlohmann::json json;
        dynamics::to_json(json, prediction);
        json["warnings"] = warnings;
        shell.print_json(json);
    }
    std::string text;
    for (const dynamics::ChannelError& channel : prediction.channels) {
        text += channel.name + ": RMSE " + core::format_number(channel.rmse, 4) + " " + channel.unit + " over " +
                core::counted(channel.count, "value");
        if (channel.in_noise > 0) {
            text += ", " + core::format_number(channel.in_noise, 3) + " times the " +
                    (channel.noise_declared ? "declared" : "estimated") + " noise of " +
                    core::format_number(channel.noise, 3) + " " + channel.unit;
        }
        if (prediction.diverged > 0) {
            text += "; " + core::counted_of(prediction.diverged, prediction.windows, "window", "runs", "run") +
                    " away: the model is wrong there, the figure does not say by how much";
        }
        text += "\n";
    }
    if (const std::string read = dynamics::reading_text(prediction.records); !read.empty()) {
        text += "logs read as " + read + " (" +
                (prediction.input_between == "linear" && prediction.input_between_from == "data"
                     ? "the measured motion fits that better"
                     : "the model's [records]") +
                ")\n";
    }
    shell.print(text);
    return ExitCode::done;
}

}  // namespace

void add_predict_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("predict", "the model against measured runs");
    auto a = std::make_shared<PredictArguments>();
    command->add_option("model", a->model, "the model (model.toml)")->required();
    command->add_option("--data", a->data, "folder of measurements (with dataset.toml)")->required();
    command->add_option("--horizon", a->horizon, "length of a prediction of a time series (default 2 s)");
    command->add_option("--out", a->out, "measured and predicted values as a table (CSV)");
    command->add_option("--plot", a->plot, "a picture (.png, .pdf)");
    command->footer(
        "Examples:\n"
        "  underbody predict model.toml --data runs --out pred.csv --json\n"
        "  underbody predict found/model.toml --data held-out --horizon 5s --plot pred.png\n"
        "A static set gives one row a set point. A time series is cut into windows of the horizon; each starts from "
        "the state that fits\n"
        "the measurements before it best, and nothing measured later is used.");
    shell.on(command, [a, &shell] { return run_predict(*a, shell); });
}

}  // namespace underbody::studio
