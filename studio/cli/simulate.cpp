// underbody simulate: the motion from a start, in heave, heave and pitch, on the ground, or all eleven states.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>

#include "core/angle.h"
#include "core/table.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/feedback_options.h"
#include "studio/cli/force_notes.h"
#include "studio/cli/model_options.h"
#include "studio/cli/motion_start.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/hold_with_jets.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/dynamics/simulate/surface_motion.h"

namespace underbody::studio {

namespace {

using dynamics::Channel;

struct SimulateArguments {
    std::vector<std::string> set;
    std::string model;
    std::string from;
    std::string duration = "60 s";
    std::string step;
    std::string conditions;
    std::string inputs;
    std::string out;
    std::string plot;
    std::string motion = "auto";
    std::string escape;
    std::string feedback;
    std::string lqr;
    std::string hold;
    std::string thrust;
    double tolerance = 1e-9;
    bool until_settled = false;
    bool until_contact = false;
};

/// Recorded inputs from a table: time, any channels, and thrusts by the names of the jets.
struct Inputs {
    dynamics::InputSignals signals;
    std::vector<double> jet_time;
    std::vector<std::vector<double>> thrust;  ///< one per jet of the model; empty where the table has none

    [[nodiscard]] bool drives_jets() const {
        return std::any_of(thrust.begin(), thrust.end(), [](const auto& one) { return !one.empty(); });
    }
    [[nodiscard]] dynamics::JetCommand command(std::vector<double> steady) const {
        return [time = jet_time, thrust = thrust, steady = std::move(steady)](double t, const dynamics::BodyState&) {
            std::vector<double> now = steady;
            const auto above = std::upper_bound(time.begin(), time.end(), t);
            const std::size_t i = above == time.begin() ? 0 : static_cast<std::size_t>(above - time.begin()) - 1;
            const std::size_t j = std::min(i + 1, time.empty() ? 0 : time.size() - 1);
            for (std::size_t k = 0; k < thrust.size(); ++k) {
                if (!thrust[k].empty()) {
                    const double part = j > i ? std::clamp((t - time[i]) / (time[j] - time[i]), 0.0, 1.0) : 0.0;
                    now[k] = thrust[k][i] + part * (thrust[k][j] - thrust[k][i]);
                }
            }
            return now;
        };
    }
};

void read_inputs(const std::string& path, const std::vector<dynamics::Jet>& jets, Inputs& inputs, Shell& shell) {
    const core::Table table = core::read_csv(path);
    const std::vector<double>& time = table.numbers("time");
    for (std::size_t i = 1; i < time.size(); ++i) {
        if (!(time[i] > time[i - 1])) {
            throw core::InputError("range", "time does not grow", table.place(i, "time"));
        }
    }
    inputs.signals.time = inputs.jet_time = time;
    inputs.thrust.resize(jets.size());
    std::string passed_over;
    for (const core::Column& column : table.columns()) {
        Channel channel{};
        if (column.is_text() || column.name == "time") {
            continue;
        }
        if (dynamics::find_channel(column.name, channel)) {
            if (channel != Channel::gap && channel != Channel::heave_velocity) {
                inputs.signals.signals.push_back({channel, column.numbers});
            }
            continue;
        }
        const bool of_a_jet =
            std::any_of(jets.begin(), jets.end(), [&](const auto& jet) { return jet.name == column.name; });
        if (!of_a_jet) {
            passed_over += (passed_over.empty() ? "'" : ", '") + column.name + "'";
        }
        for (std::size_t k = 0; k < jets.size(); ++k) {
            if (jets[k].name == column.name) {
                for (std::size_t i = 0; i < time.size(); ++i) {
                    if (!std::isfinite(column.numbers[i])) {
                        throw core::InputError("missing", "a thrust is missing", table.place(i, column.name));
                    }
                }
                inputs.thrust[k] = column.numbers;
            }
        }
    }
    if (!passed_over.empty()) {
        shell.show({{core::Problem::Severity::warning,
                     "columns that are no input of the model were passed over: " + passed_over,
                     {path, {}, {}, {}}}});
    }
    if (inputs.signals.signals.empty() && !inputs.drives_jets()) {
        throw core::InputError("missing", "there is no input in the table", {path, {}, {}, {}},
                               "columns such as input_force [N], jet_voltage [V], speed [m/s], or a jet's name [N]");
    }
}

std::vector<double> steady_thrusts(const std::string& text, const std::vector<dynamics::Jet>& jets) {
    std::vector<double> thrust(jets.size(), 0.0);
    if (text.empty()) {
        return thrust;
    }
    std::vector<core::QuantityName> names;
    for (const dynamics::Jet& jet : jets) {
        names.push_back({jet.name, "N", "", ""});
    }
    for (const core::NamedValue& value : core::parse_assignments(text, names)) {
        for (std::size_t k = 0; k < jets.size(); ++k) {
            if (jets[k].name == value.name) {
                if (value.value < jets[k].minimum || value.value > jets[k].maximum) {
                    throw core::UsageError("range", "--thrust: " + value.name + " gives " +
                                                        core::format_number(jets[k].minimum, 4) + " to " +
                                                        core::format_number(jets[k].maximum, 4) + " N");
                }
                thrust[k] = value.value;
            }
        }
    }
    return thrust;
}

/// Everything a motion needs, read and checked before anything runs.
struct Job {
    dynamics::Model model;
    MotionStart start;
    Inputs inputs;
    std::vector<double> thrust;
    std::optional<dynamics::VehicleHold> hold;
    dynamics::TrajectoryOptions options;
    core::Problems remarks;  ///< of the inputs, said already

    [[nodiscard]] dynamics::JetCommand command() const {
        if (hold) {
            return dynamics::JetHold(model, *hold, inputs.signals.held).command();
        }
        return model.jets.empty() ? dynamics::JetCommand() : inputs.command(thrust);
    }
    [[nodiscard]] dynamics::BodyOptions body_options() const {
        dynamics::BodyOptions body;
        body.duration = options.duration;
        body.output_step = options.output_step;
        body.command_step = hold ? 0.02 : 0;
        body.escape_gap = options.escape_gap;
        body.tolerance = options.tolerance;
        body.stop_at_contact = options.stop_at_contact;
        body.stop_at_equilibrium = options.stop_at_equilibrium;
        return body;
    }
};

/// Inputs are what acts; where logs of this vehicle say something else, a log among them would be read wrongly: says
/// so.
core::Problems taken_at_its_word(const std::string& file, dynamics::RecordReading records) {
    records.input_between = dynamics::RecordReading::Between::unsaid;
    const std::string other = dynamics::reading_text(records);
    return other.empty()
               ? core::Problems()
               : core::Problems{{core::Problem::Severity::warning,
                                 "taken at its word, as the inputs that act; [records] of the model reads logs "
                                 "with " +
                                     other + ": a log is not what acted ('predict' reads it so)",
                                 {file, {}, {}, {}}}};
}

Job job_of(const SimulateArguments& a, Shell& shell) {
    Job job{model_with(a.model, a.set), {}, {}, {}, {}, {}, {}};
    job.inputs.thrust.resize(job.model.jets.size());
    if (!a.inputs.empty()) {
        read_inputs(a.inputs, job.model.jets, job.inputs, shell);
        job.remarks = taken_at_its_word(a.inputs, job.model.records);
        shell.show(job.remarks);
    }
    job.start = motion_start(a.from, job.inputs.signals.held);
    for (const core::NamedValue& value :
         a.conditions.empty() ? std::vector<core::NamedValue>{} : core::parse_assignments(a.conditions)) {
        job.inputs.signals.held.set(value.name, value.value);
    }
    job.thrust = steady_thrusts(a.thrust, job.model.jets);
    if (!a.hold.empty()) {
        job.hold = hold_of(a.hold);
    }
    job.options.duration = option_value("--for", a.duration, "s");
    job.options.output_step = a.step.empty() ? 0.0 : option_value("--step", a.step, "s");
    job.options.tolerance = a.tolerance;
    job.options.stop_at_contact = a.until_contact;
    job.options.stop_at_equilibrium = a.until_settled;
    job.options.escape_gap = a.escape.empty() ? 0.0 : option_value("--escape", a.escape, "m");
    if (!(job.options.duration > 0) || job.options.output_step < 0 || !(a.tolerance > 0) || a.tolerance > 0.1) {
        throw core::UsageError("range", "--for must be positive, --step not negative, --tolerance between 0 and 0.1");
    }
    if (job.options.escape_gap > 0 && job.start.gap.value_or(0) >= job.options.escape_gap) {
        throw core::UsageError("range",
                               "the start at gap " + core::told(*job.start.gap, "m") + " lies beyond --escape " +
                                   core::told(job.options.escape_gap, "m"),
                               {}, "a larger --escape, or none");
    }
    return job;
}

template <class Motion>
void write_motion(const Motion& motion, const core::Figure& figure, const SimulateArguments& a, const Job& job,
                  Shell& shell) {
    nlohmann::json json;
    auto moving = dynamics::varying_channels(job.inputs.signals);
    if constexpr (std::is_same_v<Motion, dynamics::SurfaceTrajectory> ||
                  std::is_same_v<Motion, dynamics::BodyTrajectory>) {
        moving.push_back(Channel::speed);
    }
    show_forces(shell, job.model, job.inputs.signals.held, json, moving);
    if (!a.out.empty()) {
        core::write_csv(std::filesystem::path(a.out), commented(shell, motion.table()));
    }
    if (!a.plot.empty()) {
        write_picture(figure, a.plot);
    }
    shell.hand_over("motion", [&] { return commented(shell, motion.table()); });
    for (const core::Problem& remark : job.remarks) {
        json["warnings"].push_back(remark.message);
    }
    if (shell.json) {
        nlohmann::json document;
        dynamics::to_json(document, motion);
        document.update(json);
        shell.print_json(document);
    }
}

std::string millimetres(double metres, int digits = 6) { return core::format_number(1e3 * metres, digits) + " mm"; }
std::string angle_in_degrees(double radians) { return core::format_number(radians / core::degree, 5) + " deg"; }

std::string event_text(const std::vector<dynamics::TrajectoryEvent>& events) {
    std::string text;
    for (const dynamics::TrajectoryEvent& event : events) {
        text += "  " + event.kind + " at " + core::format_number(event.time, 6) + " s, gap " +
                millimetres(event.gap, 5) + ", " + core::format_number(1e3 * event.velocity, 4) + " mm/s\n";
    }
    return text;
}

/// Gains out of small motions.
void show_what_gains_leave_out(const SimulateArguments& a, const Job& job, Shell& shell) {
    if (!a.lqr.empty()) {
        shell.show(dynamics::HeavePlant(job.model, job.inputs.signals.held).left_out_of_small_motions());
    }
}

void run_heave(const SimulateArguments& a, Job& job, Shell& shell) {
    show_what_gains_leave_out(a, job, shell);
    const dynamics::Trajectory motion = dynamics::simulate(
        job.model, job.start.needed_gap(), job.start.heave_velocity.value_or(0), job.inputs.signals, job.options,
        shell.progress(), heave_feedback_of(shell, a.feedback, a.lqr, job.model, job.inputs.signals.held).get());
    shell.show(motion.remarks);
    const dynamics::HeavePlant plant = dynamics::plant_for(job.model, job.inputs.signals);
    write_motion(motion, dynamics::trajectory_figure(motion, dynamics::heave_equilibria(plant)), a, job, shell);
    shell.print("ends by " + motion.end + " at t = " + core::format_number(motion.time.back(), 6) + " s, gap " +
                millimetres(motion.gap.back()) + ", heave velocity " +
                core::format_number(1e3 * motion.heave_velocity.back(), 4) + " mm/s\n" + event_text(motion.events));
}

void run_heave_pitch(const SimulateArguments& a, Job& job, Shell& shell) {
    show_what_gains_leave_out(a, job, shell);
    dynamics::HeavePitch plant(job.model, job.inputs.signals.held, dynamics::varying_channels(job.inputs.signals));
    if (const auto feedback = pitch_feedback_of(shell, a.feedback, a.lqr, plant)) {
        plant.close_loop(*feedback);
    }
    const dynamics::PitchState start = job.start.of_pitch();
    dynamics::PitchTrajectory motion =
        dynamics::simulate(plant, start, job.options, shell.progress(), job.inputs.signals);
    add_remarks(motion.remarks, job.model);
    shell.show(motion.remarks);
    write_motion(motion, dynamics::trajectory_figure(motion), a, job, shell);
    const dynamics::PitchState& last = motion.state.back();
    shell.print("ends by " + motion.end + " at t = " + core::format_number(motion.time.back(), 6) + " s, gap " +
                millimetres(last[0]) + ", pitch " + angle_in_degrees(last[2]) + " nose up, contact " +
                dynamics::contact_state_name(motion.contact.back()) + "\n" + event_text(motion.events));
}

void run_surface(const SimulateArguments& a, Job& job, Shell& shell) {
    const dynamics::SurfaceMotion body(job.model, job.inputs.signals.held,
                                       dynamics::varying_channels(job.inputs.signals));
    const double speed =
        job.start.speed.value_or(job.inputs.signals.held.over(job.model.conditions).get(Channel::speed, 0));
    const dynamics::SurfaceState start{speed,
                                       job.start.sway_velocity.value_or(0),
                                       job.start.yaw_rate.value_or(0),
                                       job.start.heading.value_or(0),
                                       job.start.north.value_or(0),
                                       job.start.east.value_or(0)};
    dynamics::SurfaceTrajectory motion = dynamics::simulate_surface(body, start, job.command(), job.body_options(),
                                                                    shell.progress(), job.inputs.signals);
    add_remarks(motion.remarks, job.model);
    shell.show(motion.remarks);
    write_motion(motion, dynamics::trajectory_figure(motion), a, job, shell);
    const dynamics::SurfaceState& last = motion.state.back();
    shell.print("ends by " + motion.end + " at t = " + core::format_number(motion.time.back(), 6) + " s, speed " +
                core::format_number(last[0], 5) + " m/s, heading " + angle_in_degrees(last[3]) + ", normal force " +
                core::format_number(motion.contact.back().normal, 4) + " N\n");
}

void run_body(const SimulateArguments& a, Job& job, Shell& shell) {
    const dynamics::RigidBody body(job.model, job.inputs.signals.held, dynamics::varying_channels(job.inputs.signals));
    const dynamics::BodyState start = job.start.of_body(body, job.inputs.signals.held.over(job.model.conditions));
    dynamics::BodyTrajectory motion =
        dynamics::simulate_body(body, start, job.command(), job.body_options(), shell.progress(), job.inputs.signals);
    add_remarks(motion.remarks, job.model);
    shell.show(motion.remarks);
    write_motion(motion, dynamics::trajectory_figure(motion), a, job, shell);
    const dynamics::BodyState& last = motion.state.back();
    std::string text = "ends by " + motion.end + " at t = " + core::format_number(motion.time.back(), 6) + " s, gap " +
                       millimetres(motion.gap.back()) + ", pitch " + angle_in_degrees(last[dynamics::state_theta]) +
                       " nose up, heading " + angle_in_degrees(last[dynamics::state_psi]) + ", speed " +
                       core::format_number(last[dynamics::state_u], 5) + " m/s, contact " +
                       dynamics::contact_state_name(motion.contact.back()) + "\n";
    for (const dynamics::TrajectoryEvent& event : motion.events) {
        text += "  " + event.kind + " at " + core::format_number(event.time, 6) + " s\n";
    }
    shell.print(text);
}

/// The least motion that has the states of the start.
std::string motion_of(const SimulateArguments& a, const Job& job) {
    if (a.motion != "auto") {
        return a.motion;
    }
    if (job.hold || !a.thrust.empty() || job.inputs.drives_jets() || job.start.travels()) {
        return job.start.gap || job.start.turns() ? "body" : "surface";
    }
    return job.start.turns() ? "heave-pitch" : "heave";
}

int run_simulate(const SimulateArguments& a, Shell& shell) {
    for (const std::string& file : {a.out, a.plot}) {
        Shell::will_write(file);
    }
    Job job = job_of(a, shell);
    const std::string motion = motion_of(a, job);
    const bool in_heave = motion == "heave" || motion == "heave-pitch";
    if (in_heave && (job.hold || !a.thrust.empty() || job.inputs.drives_jets())) {
        throw core::UsageError("range", "jets move the body or the body on the ground, not " + motion, {},
                               "--motion body or --motion surface");
    }
    if (!in_heave && (!a.feedback.empty() || !a.lqr.empty())) {
        throw core::UsageError("range", "--feedback and --lqr close the loop in heave and in heave and pitch", {},
                               "for jets: --hold heading=20deg,speed=0.35m/s");
    }
    shell.show(job.start.not_used_in(motion));
    if (motion == "heave") {
        const std::vector<std::string> quantities = job.model.quantities();
        if (std::find(quantities.begin(), quantities.end(), "pitch_moment") != quantities.end() && a.motion == "auto") {
            shell.info("heave alone, at zero pitch: the model also has pitch moments, --motion heave-pitch uses them");
        }
        run_heave(a, job, shell);
    } else if (motion == "heave-pitch") {
        run_heave_pitch(a, job, shell);
    } else if (motion == "surface") {
        run_surface(a, job, shell);
    } else {
        run_body(a, job, shell);
    }
    return ExitCode::done;
}

}  // namespace

void add_simulate_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("simulate", "the motion of a model from a start");
    auto a = std::make_shared<SimulateArguments>();
    command->add_option("model", a->model, "the model (model.toml)")->required();
    command
        ->add_option(
            "--from", a->from,
            "where it starts: gap, heave_velocity, pitch, pitch_rate, speed, sway_velocity, yaw_rate, heading, "
            "north, east (default 0)")
        ->required();
    command->add_option("--set", a->set, set_help());
    command->add_option("--for", a->duration, "how long (default 60 s)");
    command
        ->add_option("--motion", a->motion,
                     "heave; heave-pitch; surface (u, v, r, psi flat on the ground); body (all eleven states); auto: "
                     "the least that has the states of --from")
        ->check(CLI::IsMember({"auto", "heave", "heave-pitch", "surface", "body"}));
    command->add_option("--step", a->step, "time between outputs (default: the integrator's own steps)");
    command->add_option("--conditions", a->conditions, "what is held: speed=0.5m/s,jet_voltage=8V, input_force=...");
    command->add_option("--inputs", a->inputs,
                        "a table with time and inputs (input_force, jet_voltage, ..., or thrusts by the jets' names), "
                        "linear between its rows");
    command->add_option("--thrust", a->thrust, "steady thrusts of jets: J1=0.05N,J2=0.05N (surface and body)");
    command->add_option(
        "--hold", a->hold,
        "hold with the jets: heading=20deg,speed=0.35m/s,gap=20mm,pitch=0; gains heading_gain, "
        "yaw_rate_gain, speed_gain, gap_gain, heave_gain, pitch_gain, pitch_rate_gain (SI); sampled every 20 ms");
    command->add_option("--feedback", a->feedback, feedback_help());
    command->add_option("--lqr", a->lqr, lqr_help());
    command->add_option("--escape", a->escape, "stop above this gap");
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
        "  underbody simulate model.toml --from gap=8mm,pitch=1deg --plot both.png        heave and pitch\n"
        "  underbody simulate model.toml --motion surface --from speed=0.35m/s --hold heading=20deg,speed=0.35m/s\n"
        "  underbody simulate model.toml --motion body --from gap=20mm,speed=0.35m/s --thrust J1=0.1N,J2=0.1N\n"
        "The gap is the height of the base over the ground; heave velocity is positive up, pitch nose up, yaw and "
        "heading to starboard. CVODE integrates and stops exactly at contact, lift-off and escape.");
    shell.on(command, [a, &shell] { return run_simulate(*a, shell); });
}

}  // namespace underbody::studio
