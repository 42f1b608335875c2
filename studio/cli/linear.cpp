// underbody linear: the small motion about an equilibrium, its modes and its control.
#include "surrogates/dynamics/linear.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/dynamics/feedback.h"
#include "surrogates/dynamics/heave_pitch.h"

namespace underbody::studio {

namespace {

struct Arguments {
    std::string model;
    std::string conditions;
    std::string sweep;
    std::string weights = "1,100,1";
    std::string out;
};

nlohmann::json matrix_json(const dynamics::Dense& m) {
    nlohmann::json rows = nlohmann::json::array();
    for (std::size_t i = 0; i < m.rows(); ++i) {
        nlohmann::json row = nlohmann::json::array();
        for (std::size_t j = 0; j < m.columns(); ++j) {
            row.push_back(m(i, j));
        }
        rows.push_back(row);
    }
    return rows;
}

nlohmann::json system_json(const dynamics::LinearSystem& system, const std::vector<dynamics::Mode>& modes) {
    const dynamics::Controllability control = dynamics::controllability(system);
    nlohmann::json json = {{"states", system.states},
                           {"inputs", system.inputs},
                           {"A", matrix_json(system.a)},
                           {"B", matrix_json(system.b)}};
    json["controllability"] = {{"rank", control.rank}, {"of", system.a.rows()}, {"weakness", control.weakness}};
    json["modes"] = nlohmann::json::array();
    for (const dynamics::Mode& mode : modes) {
        json["modes"].push_back({{"name", mode.name},
                                 {"real", mode.value.real()},
                                 {"imaginary", mode.value.imag()},
                                 {"frequency", mode.frequency},
                                 {"damping_ratio", mode.damping_ratio},
                                 {"stable", mode.stable}});
    }
    return json;
}

std::string mode_text(const dynamics::Mode& mode) {
    std::string text = "  " + mode.name + ": " + core::format_number(mode.value.real(), 5);
    if (mode.value.imag() != 0) {
        text += " +- " + core::format_number(mode.value.imag(), 5) + " i 1/s, " +
                core::format_number(mode.frequency / 6.283185307179586, 4) + " Hz, damping ratio " +
                core::format_number(mode.damping_ratio, 3);
    } else {
        text += " 1/s";
    }
    return text + (mode.stable ? "" : "  unstable") + "\n";
}

std::vector<double> weights_of(const std::string& text) {
    std::vector<double> weights;
    for (const std::string_view part : core::split(text, ',')) {
        const auto value = core::parse_number(part);
        if (!value || !(*value > 0)) {
            throw core::UsageError("range", "--weights '" + text + "' are not three positive numbers", {},
                                   "q_w,q_h,r, for instance 1,100,1");
        }
        weights.push_back(*value);
    }
    if (weights.size() != 3) {
        throw core::UsageError("range", "--weights needs three numbers: q_w,q_h,r");
    }
    return weights;
}

void heave(const dynamics::Model& model, const dynamics::Conditions& held, const std::vector<double>& q,
           nlohmann::json& json, std::string& text) {
    const dynamics::HeavePlant plant(model, held);
    json["heave"] = nlohmann::json::array();
    for (const dynamics::HeaveEquilibrium& e : dynamics::heave_equilibria(plant)) {
        double slope = 0;
        const double mass = plant.inertia(e.gap, slope), speed = 1e-7;
        const double damping = (plant.resistance(e.gap, speed) - plant.resistance(e.gap, -speed)) / (2 * speed);
        dynamics::LinearSystem system;
        system.a = dynamics::Dense{{-damping / mass, -e.stiffness / mass}, {1, 0}};
        system.b = dynamics::Dense{{1 / mass}, {0}};
        system.states = {"heave_velocity", "gap"};
        system.inputs = {"input_force"};
        const std::vector<dynamics::Mode> modes = dynamics::modes(system, {"heave", "heave"});
        const dynamics::HeaveFeedback gains = dynamics::heave_lqr(plant, e.gap, q[0], q[1], q[2]);
        nlohmann::json one = system_json(system, modes);
        one["name"] = e.name;
        one["gap"] = e.gap;
        one["stable"] = e.stable;
        one["stiffness"] = e.stiffness;
        one["damping"] = damping;
        one["virtual_mass"] = mass;
        one["lqr"] = {{"velocity_gain", gains.velocity_gain}, {"gap_gain", gains.gap_gain}};
        json["heave"].push_back(one);
        text += e.name + (e.stable ? " (stable)" : " (unstable)") + " at " + core::format_number(1e3 * e.gap, 6) +
                " mm: stiffness " + core::format_number(e.stiffness, 4) + " N/m\n";
        for (const dynamics::Mode& mode : modes) {
            text += mode_text(mode);
        }
        text += "  LQR: u = -" + core::format_number(gains.velocity_gain, 5) + " N s/m w - " +
                core::format_number(gains.gap_gain, 5) + " N/m (gap - " + core::format_number(e.gap, 5) + " m)\n";
    }
}

void heave_pitch(const dynamics::Model& model, const dynamics::Conditions& held, nlohmann::json& json,
                 std::string& text) {
    const dynamics::HeavePitch plant(model, held);
    json["heave_pitch"] = nlohmann::json::array();
    for (const dynamics::HeaveEquilibrium& e : plant.equilibria()) {
        const dynamics::LinearSystem system = plant.linearised(e.gap, e.pitch);
        const std::vector<dynamics::Mode> modes = dynamics::modes(system, {"heave", "heave", "pitch", "pitch"});
        nlohmann::json one = system_json(system, modes);
        one["name"] = e.name;
        one["gap"] = e.gap;
        one["pitch"] = e.pitch;
        one["stable"] = e.stable;
        json["heave_pitch"].push_back(one);
        text += "heave and pitch, " + e.name + " at " + core::format_number(1e3 * e.gap, 6) + " mm, " +
                core::format_number(57.29577951308232 * e.pitch, 4) + " deg nose up\n";
        for (const dynamics::Mode& mode : modes) {
            text += mode_text(mode);
        }
    }
}

void surface(const dynamics::Model& model, const dynamics::Conditions& held, nlohmann::json& json, std::string& text) {
    const double speed = held.get(dynamics::Channel::speed, 0.35);
    if (!(speed > 0)) {
        return;
    }
    const dynamics::SurfaceCoefficients c = dynamics::surface_coefficients(model);
    const double friction = model.contact.friction * std::max(0.0, model.vehicle.net_weight);
    const dynamics::LinearSystem system = dynamics::surface_system(c, speed, friction);
    const std::vector<dynamics::Mode> modes = dynamics::modes(system, {"surge", "sway", "yaw", "heading"});
    const dynamics::HeadingBounds bounds = dynamics::heading_bounds(c, speed, friction);
    nlohmann::json one = system_json(system, modes);
    one["speed"] = speed;
    one["friction_force"] = friction;
    one["heading_gain_bound"] = bounds.least_k2_without_friction;
    json["surface"] = one;
    text += "on the ground at " + core::format_number(speed, 4) + " m/s, friction " + core::format_number(friction, 3) +
            " N\n";
    for (const dynamics::Mode& mode : modes) {
        text += mode_text(mode);
    }
    text += "  heading feedback needs more than " + core::format_number(bounds.least_k2_without_friction, 4) +
            " N m/rad without friction\n";
}

int run(const Arguments& a, Shell& shell) {
    const dynamics::Model model = dynamics::read_model(a.model);
    dynamics::Conditions given;
    for (const core::NamedValue& value :
         a.conditions.empty() ? std::vector<core::NamedValue>{} : core::parse_assignments(a.conditions)) {
        given.set(value.name, value.value);
    }
    const dynamics::Conditions held = given.over(model.conditions);
    const std::vector<double> weights = weights_of(a.weights);
    shell.show(model.remarks);
    nlohmann::json json;
    std::string text;
    if (!a.sweep.empty()) {
        const std::vector<core::NamedRange> ranges = core::parse_ranges(a.sweep);
        dynamics::Channel channel{};
        dynamics::find_channel(ranges.at(0).name, channel);
        const dynamics::EquilibriumSweep sweep =
            dynamics::equilibrium_sweep(model, held, channel, ranges[0].lower, ranges[0].upper, 101);
        if (!a.out.empty()) {
            write_picture(dynamics::equilibrium_figure(sweep), a.out);
        }
        json["sweep"] = nlohmann::json::array();
        for (std::size_t i = 0; i < sweep.value.size(); ++i) {
            for (const dynamics::HeaveEquilibrium& e : sweep.equilibria[i]) {
                json["sweep"].push_back({{ranges[0].name, sweep.value[i]}, {"gap", e.gap}, {"stable", e.stable}});
            }
        }
    } else if (!a.out.empty()) {
        throw core::UsageError("missing", "--out draws a sweep: name its range", {},
                               "for instance --sweep jet_voltage=3V:12V");
    }
    heave(model, held, weights, json, text);
    const std::vector<std::string> quantities = model.quantities();
    if (std::find(quantities.begin(), quantities.end(), "pitch_moment") != quantities.end() &&
        !std::isnan(model.vehicle.pitch_inertia)) {
        heave_pitch(model, held, json, text);
    }
    if (!std::isnan(model.vehicle.yaw_inertia)) {
        surface(model, held, json, text);
    }
    if (shell.json) {
        shell.print_json(json);
    }
    shell.print(text.empty() ? "no equilibrium: the vertical forces balance nowhere within the tables\n" : text);
    return ExitCode::done;
}

}  // namespace

void add_linear_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand(
        "linear", "small motion about each equilibrium: matrices, named modes, controllability, LQR gains");
    auto a = std::make_shared<Arguments>();
    command->add_option("model", a->model, "the model (model.toml)")->required();
    command->add_option("--conditions", a->conditions, "what is held: speed=0.5m/s,jet_voltage=8V, ...");
    command->add_option("--weights", a->weights,
                        "LQR weights q_w,q_h,r of heave velocity, gap and force (default 1,100,1)");
    command->add_option("--sweep", a->sweep, "equilibria against one condition, such as jet_voltage=3V:12V");
    command->add_option("--out", a->out, "picture of the sweep (.png, .pdf)");
    command->footer(
        "Examples:\n"
        "  underbody linear model.toml --conditions speed=0.5m/s\n"
        "  underbody linear model.toml --sweep jet_voltage=3V:12V --out voltage.png\n"
        "Heave always; heave and pitch where the model has a pitch_moment table; surge, sway, yaw on the ground where "
        "it has a yaw inertia.");
    shell.on(command, [a, &shell] { return run(*a, shell); });
}

}  // namespace underbody::studio
