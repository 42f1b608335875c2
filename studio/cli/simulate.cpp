// underbody simulate: the motion from a start.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/dynamics/heave.h"

namespace underbody::studio {

namespace {

struct Arguments {
    std::string model;
    std::string from;
    std::string duration = "60 s";
    std::string step;
    std::string conditions;
    std::string inputs;
    std::string out;
    std::string plot;
    double tolerance = 1e-9;
    bool until_settled = false;
    bool until_contact = false;
};

/// Inputs from a table: time and any channels.
dynamics::InputSignals read_inputs(const std::string& path) {
    const core::Table table = core::read_csv(path);
    dynamics::InputSignals signals;
    signals.time = table.numbers("time");
    for (std::size_t i = 1; i < signals.time.size(); ++i) {
        if (!(signals.time[i] > signals.time[i - 1])) {
            throw core::InputError("range", "time does not grow", table.place(i, "time"));
        }
    }
    for (const core::Column& column : table.columns()) {
        dynamics::Channel channel{};
        if (!column.is_text() && column.name != "time" && dynamics::find_channel(column.name, channel)) {
            if (channel != dynamics::Channel::gap && channel != dynamics::Channel::heave_velocity) {
                signals.signals.push_back({channel, column.numbers});
            }
        }
    }
    if (signals.signals.empty()) {
        throw core::InputError("missing", "there is no input in the table", {path, {}, {}, {}},
                               "columns such as input_force [N], jet_voltage [V], speed [m/s]");
    }
    return signals;
}

int run(const Arguments& a, Shell& shell) {
    const dynamics::Model model = dynamics::read_model(a.model);
    double gap = std::nan(""), velocity = 0;
    dynamics::InputSignals inputs;
    if (!a.inputs.empty()) {
        inputs = read_inputs(a.inputs);
    }
    for (const core::NamedValue& value : core::parse_assignments(a.from)) {
        if (value.name == "gap") {
            gap = value.value;
        } else if (value.name == "heave_velocity") {
            velocity = value.value;
        } else {
            inputs.held.set(value.name, value.value);
        }
    }
    for (const core::NamedValue& value :
         a.conditions.empty() ? std::vector<core::NamedValue>{} : core::parse_assignments(a.conditions)) {
        inputs.held.set(value.name, value.value);
    }
    if (std::isnan(gap)) {
        throw core::UsageError("missing", "--from needs the gap to start at", {},
                               "for instance --from gap=20mm,heave_velocity=0");
    }
    dynamics::TrajectoryOptions options;
    options.duration = core::parse_in(a.duration, "s");
    options.output_step = a.step.empty() ? 0.0 : core::parse_in(a.step, "s");
    options.tolerance = a.tolerance;
    options.stop_at_contact = a.until_contact;
    options.stop_at_equilibrium = a.until_settled;
    if (!(options.duration > 0) || options.output_step < 0 || !(a.tolerance > 0) || a.tolerance > 0.1) {
        throw core::UsageError("range", "--for must be positive, --step not negative, --tolerance between 0 and 0.1");
    }
    const dynamics::Trajectory motion = dynamics::simulate(model, gap, velocity, inputs, options, shell.progress());
    shell.show(motion.remarks);
    if (!a.out.empty()) {
        core::write_csv(std::filesystem::path(a.out), motion.table());
    }
    if (!a.plot.empty()) {
        const dynamics::HeavePlant plant = dynamics::plant_for(model, inputs);
        write_picture(dynamics::trajectory_figure(motion, dynamics::heave_equilibria(plant)), a.plot);
    }
    if (shell.json) {
        nlohmann::json json;
        dynamics::to_json(json, motion);
        shell.print_json(json);
    }
    std::string text = "ends by " + motion.end + " at t = " + core::format_number(motion.time.back(), 6) + " s, gap " +
                       core::format_number(1e3 * motion.gap.back(), 6) + " mm, heave velocity " +
                       core::format_number(1e3 * motion.heave_velocity.back(), 4) + " mm/s\n";
    for (const dynamics::TrajectoryEvent& event : motion.events) {
        text += "  " + event.kind + " at " + core::format_number(event.time, 6) + " s, gap " +
                core::format_number(1e3 * event.gap, 5) + " mm, " + core::format_number(1e3 * event.velocity, 4) +
                " mm/s\n";
    }
    shell.print(text);
    return ExitCode::done;
}

}  // namespace

void add_simulate_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("simulate", "the motion of a model from a start");
    auto a = std::make_shared<Arguments>();
    command->add_option("model", a->model, "the model (model.toml)")->required();
    command->add_option("--from", a->from, "where it starts: gap=..., heave_velocity=... (default 0)")->required();
    command->add_option("--for", a->duration, "how long (default 60 s)");
    command->add_option("--step", a->step, "time between outputs (default: the integrator's own steps)");
    command->add_option("--conditions", a->conditions, "what is held: speed=0.5m/s,jet_voltage=8V, input_force=...");
    command->add_option("--inputs", a->inputs,
                        "a table with time and inputs (input_force, jet_voltage, ...), linear between its rows");
    command->add_option("--out", a->out, "the motion as a table (CSV)");
    command->add_option("--plot", a->plot, "a picture of it (.png, .pdf)");
    command->add_option("--tolerance", a->tolerance, "relative error of a step (default 1e-9)");
    command->add_flag("--until-settled", a->until_settled, "stop where the body has come to rest");
    command->add_flag("--until-contact", a->until_contact, "stop where the body touches the ground");
    command->footer(
        "Examples:\n"
        "  underbody simulate model.toml --from gap=0.1 --for 60 --out run.csv\n"
        "  underbody simulate model.toml --from \"gap=20 mm,heave_velocity=-5 mm/s\" --conditions jet_voltage=8V "
        "--plot run.png\n"
        "  underbody simulate model.toml --from gap=0.1 --inputs run-01.csv --step 0.02 --out again.csv\n"
        "The gap is the height of the base over the ground; heave velocity is positive up. CVODE integrates and stops "
        "exactly at contact, lift-off and escape.");
    shell.on(command, [a, &shell] { return run(*a, shell); });
}

}  // namespace underbody::studio
