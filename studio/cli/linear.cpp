// underbody linear: the small motion about an equilibrium, its modes and its control.
#include "surrogates/dynamics/linear/linear.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "core/angle.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/force_notes.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/dynamics/linear/trim_error.h"
#include "surrogates/dynamics/model/table_notes.h"
#include "surrogates/dynamics/model/taken_as_zero.h"
#include "surrogates/dynamics/simulate/feedback.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/surface_motion.h"
#include "surrogates/tables/analysis/equilibria.h"

namespace underbody::studio {

namespace {

struct LinearArguments {
    std::string model;
    std::string conditions;
    std::string sweep;
    std::string weights = "1,100,1";
    std::string out;
    std::string at;
    std::string gamma_chart;
    std::string sideslip = "6 deg";
    std::string friction_offset;
};

nlohmann::json matrix_json(const dynamics::Matrix& m) {
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

/// "29.7 +- 1.1"; no error where none is stated.
std::string with_error(double value, double sigma, int digits) {
    return core::format_number(value, digits) + (sigma > 0 ? " +- " + core::format_number(sigma, 2) : "");
}

nlohmann::json number_or_null(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); }

/// One standard deviation of the trim itself.
void add_error(nlohmann::json& json, const dynamics::TrimError& error) {
    json["errors_stated"] = error.stated;
    json["sigma"] = error.gap;
    json["force_sigma"] = error.force;
    json["stiffness_sigma"] = error.stiffness;
    if (error.stated) {
        json["stable_share"] = number_or_null(error.stable);
    }
}

nlohmann::json system_json(const dynamics::LinearSystem& system, const std::vector<dynamics::Mode>& modes,
                           const dynamics::TrimError& error = {}) {
    const dynamics::Controllability control = dynamics::controllability(system);
    nlohmann::json json = {{"states", system.states},
                           {"inputs", system.inputs},
                           {"A", matrix_json(system.a)},
                           {"B", matrix_json(system.b)}};
    json["controllability"] = {{"rank", control.rank}, {"of", system.a.rows()}, {"weakness", control.weakness}};
    json["modes"] = nlohmann::json::array();
    for (std::size_t i = 0; i < modes.size(); ++i) {
        const dynamics::Mode& mode = modes[i];
        json["modes"].push_back({{"name", mode.name},
                                 {"real", mode.value.real()},
                                 {"imaginary", mode.value.imag()},
                                 {"frequency", mode.frequency},
                                 {"frequency_unit", "rad/s"},
                                 {"frequency_in_hertz", mode.frequency / (2 * std::numbers::pi)},
                                 {"damping_ratio", mode.damping_ratio},
                                 {"stable", mode.stable},
                                 {"neutral", mode.neutral}});
        if (i < error.modes.size()) {
            const dynamics::ModeError& own = error.modes[i];
            json["modes"].back().update({{"real_sigma", number_or_null(own.real)},
                                         {"imaginary_sigma", number_or_null(own.imaginary)},
                                         {"frequency_sigma", number_or_null(own.frequency)},
                                         {"damping_ratio_sigma", number_or_null(own.damping_ratio)}});
        }
    }
    return json;
}

std::string mode_text(const dynamics::Mode& mode, const dynamics::ModeError& error = {}) {
    constexpr double two_pi = 2 * std::numbers::pi;
    std::string text = "  " + mode.name + ": ";
    if (mode.value.imag() != 0) {
        text += core::format_number(mode.neutral ? 0 : mode.value.real(), 5) + " +- " +
                core::format_number(mode.value.imag(), 5) + " i 1/s, " +
                with_error(mode.frequency / two_pi, error.frequency / two_pi, 4) + " Hz, damping ratio " +
                with_error(mode.damping_ratio, error.damping_ratio, 3);
    } else {
        text += with_error(mode.value.real(), error.real, 5) + " 1/s";
    }
    text += std::isnan(error.real) ? " (its kind changes within the errors of the forces)" : "";
    return text + (mode.neutral ? "  neutral" : mode.stable ? "" : "  unstable") + "\n";
}

std::string modes_text(const std::vector<dynamics::Mode>& modes, const dynamics::TrimError& error) {
    std::string text;
    for (std::size_t i = 0; i < modes.size(); ++i) {
        text += mode_text(modes[i], i < error.modes.size() ? error.modes[i] : dynamics::ModeError{});
    }
    if (error.stated && error.stable > 1 - tables::sure_enough && error.stable < tables::sure_enough) {
        text +=
            "  stable in " + core::format_number(100 * error.stable, 3) + " % of the draws from the stated errors\n";
    }
    return text;
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

nlohmann::json complex_json(const std::complex<double>& value) { return {value.real(), value.imag()}; }

std::string rank_text(const dynamics::LinearSystem& system, const std::string& by) {
    const dynamics::Controllability control = dynamics::controllability(system);
    return "  controllable by " + by + ": rank " + std::to_string(control.rank) + " of " +
           std::to_string(system.a.rows()) + ", weakness " + core::format_number(control.weakness, 3) + "\n";
}

/// Equilibria, or the one trim that was asked for.
std::vector<dynamics::HeaveEquilibrium> trims(std::vector<dynamics::HeaveEquilibrium> equilibria,
                                              const std::optional<dynamics::HeaveEquilibrium>& at) {
    return at ? std::vector<dynamics::HeaveEquilibrium>{*at} : std::move(equilibria);
}

bool pitches(const dynamics::Model& model) {
    const std::vector<std::string> quantities = model.quantities();
    const dynamics::Vehicle& v = model.vehicle;
    return std::find(quantities.begin(), quantities.end(), "pitch_moment") != quantities.end() &&
           !std::isnan(v.pitch_inertia) && !std::isnan(v.base_depth) && !std::isnan(v.base_half_length);
}

/// What the balances in heave alone are worth once nothing holds the pitch; empty for a model without pitch.
std::string free_in_pitch(const dynamics::Model& model, const dynamics::Conditions& held, nlohmann::json& json) {
    if (!pitches(model)) {
        return {};
    }
    std::string stable, unstable;
    for (const dynamics::HeaveEquilibrium& e : dynamics::HeavePitch(model, held).equilibria()) {
        const std::string where = e.name + " at " + core::format_number(1e3 * e.gap, 5) + " mm, " +
                                  core::format_number(e.pitch / core::degree, 4) + " deg nose up";
        if (e.stable) {
            stable += (stable.empty() ? "" : "; ") + where;
        } else {
            unstable +=
                (unstable.empty() ? "" : "; ") + where + ", growing with " + core::format_number(e.growth, 4) + " 1/s";
        }
    }
    json["stable_in_heave_and_pitch"] = !stable.empty();
    return !stable.empty() ? "these hold the pitch at 0; free to pitch, the body balances stably: " + stable + "\n"
           : !unstable.empty()
               ? "these hold the pitch at 0; free to pitch, no balance is stable: " + unstable + "\n"
               : "these hold the pitch at 0; free to pitch, the body balances nowhere within the tables\n";
}

/// What is said of a trim that the force tables do not cover; nothing of one within them.
core::Problems trim_outside(const dynamics::Model& model, dynamics::Conditions held,
                            const std::optional<dynamics::HeaveEquilibrium>& at) {
    if (!at) {
        return {};
    }
    held[dynamics::Channel::gap] = at->gap;
    held[dynamics::Channel::pitch] = at->pitch;
    return dynamics::held_outside(model, held);
}

void heave(const dynamics::Model& model, const dynamics::Conditions& held, const std::vector<double>& q,
           const std::optional<dynamics::HeaveEquilibrium>& at, nlohmann::json& json, std::string& text, Shell& shell) {
    const char* pitch_held = pitches(model) ? ", pitch held at 0" : "";
    const dynamics::HeavePlant plant(model, held);
    const bool outside = !trim_outside(model, held, at).empty();
    json["heave"] = nlohmann::json::array();
    for (const dynamics::HeaveEquilibrium& e : trims(dynamics::heave_equilibria(plant), at)) {
        double slope = 0, stiffness = 0;
        const double mass = plant.inertia(e.gap, slope);
        const dynamics::LinearSystem system = dynamics::heave_system(plant, e.gap, &stiffness);
        stiffness += 0.0;  // no negative zero
        const double damping = -system.a(0, 0) * mass;
        const dynamics::TrimError error = dynamics::heave_trim_error(model, held, e.gap, !at);
        const std::vector<dynamics::Mode> modes = dynamics::modes(system, {"heave", "heave"});
        const dynamics::HeaveFeedback gains = dynamics::heave_lqr(plant, e.gap, q[0], q[1], q[2]);
        shell.show(dynamics::loop_remarks(plant, gains, true));
        nlohmann::json one = system_json(system, modes, error);
        const double trim_force = plant.static_force(e.gap);
        one["name"] = e.name;
        one["gap"] = e.gap;
        one["stable"] = stiffness > 0;
        one["pitch_held"] = pitches(model);
        one["stiffness"] = stiffness;
        one["outside"] = outside;
        one["damping"] = damping;
        one["virtual_mass"] = mass;
        one["force_at_rest"] = trim_force;
        add_error(one, error);
        one["lqr"] = {{"velocity_gain", gains.velocity_gain}, {"gap_gain", gains.gap_gain}};
        json["heave"].push_back(one);
        text += e.name + (stiffness > 0 ? " (stable" : " (unstable") + pitch_held + ") at " +
                with_error(1e3 * e.gap, 1e3 * error.gap, 6) + " mm: stiffness " +
                with_error(stiffness, error.stiffness, 4) + " N/m" +
                (outside ? " (outside the tables: that of the ends they hold, its error is not known)" : "");
        text += at ? ", held by " + with_error(-trim_force, error.force, 4) + " N up\n" : "\n";
        text += modes_text(modes, error);
        text += "  LQR: u = -" + core::format_number(gains.velocity_gain, 5) + " N s/m w - " +
                core::format_number(gains.gap_gain, 5) + " N/m (gap - " + core::format_number(e.gap, 5) + " m)\n";
    }
}

void heave_pitch(const dynamics::Model& model, const dynamics::Conditions& held,
                 const std::optional<dynamics::HeaveEquilibrium>& at, nlohmann::json& json, std::string& text,
                 Shell& shell) {
    const dynamics::HeavePitch plant(model, held);
    json["heave_pitch"] = nlohmann::json::array();
    for (const dynamics::HeaveEquilibrium& e : trims(plant.equilibria(), at)) {
        const dynamics::LinearSystem system = plant.linearised(e.gap, e.pitch);
        const std::vector<dynamics::Mode> modes = dynamics::modes(system, {"heave", "heave", "pitch", "pitch"});
        const dynamics::PitchFeedback gains = dynamics::pitch_lqr(plant, e.gap, e.pitch, {});
        if (shell.json) {  // the text has no gains of it
            shell.show(dynamics::loop_remarks(plant, gains, true));
        }
        const dynamics::TrimError error = dynamics::pitch_trim_error(model, held, e.gap, e.pitch, !at);
        nlohmann::json one = system_json(system, modes, error);
        add_error(one, error);
        one["pitch_sigma"] = error.pitch;
        one["name"] = e.name;
        one["gap"] = e.gap;
        one["pitch"] = e.pitch;
        one["stable"] =
            std::all_of(modes.begin(), modes.end(), [](const dynamics::Mode& m) { return m.value.real() < 1e-6; });
        one["lqr"] = {{"force_gain", gains.force_gain}, {"moment_gain", gains.moment_gain}};
        for (const std::complex<double>& pole : dynamics::closed_poles(plant, gains)) {
            one["lqr"]["poles"].push_back(complex_json(pole));
        }
        json["heave_pitch"].push_back(one);
        text += "heave and pitch, " + e.name + " at " + with_error(1e3 * e.gap, 1e3 * error.gap, 6) + " mm, " +
                with_error(e.pitch / core::degree, error.pitch / core::degree, 4) + " deg nose up\n";
        text += modes_text(modes, error);
        text += rank_text(system, "force and moment");
    }
}

/// Yaw rate against the difference of the two aft jets, and what their angles do.
void turning_jets(const dynamics::Model& model, const dynamics::SurfaceCoefficients& c, double speed, double friction,
                  const LinearArguments& a, nlohmann::json& json, std::string& text) {
    const std::optional<dynamics::EvieJets> layout = dynamics::turning_layout(model.jets);
    if (!layout) {
        if (!a.gamma_chart.empty()) {
            throw core::InputError("missing", "the model has no jets that turn it", {a.model, {}, {}, {}},
                                   "a pair aft, off the middle plane, that pushes forward and to the side");
        }
        return;
    }
    const double beta = dynamics::pitch_free_elevation(layout->turn_x, layout->turn_z, layout->gamma);
    const dynamics::YawTransfer transfer = dynamics::yaw_transfer(c, speed, friction, *layout);
    nlohmann::json poles = nlohmann::json::array();
    std::string pole_text;
    for (const std::complex<double>& pole : transfer.poles) {
        poles.push_back(complex_json(pole));
        pole_text +=
            (pole_text.empty() ? "" : ", ") + core::format_number(pole.real(), 5) +
            (pole.imag() != 0 ? (pole.imag() > 0 ? " + " : " - ") + core::format_number(std::abs(pole.imag()), 5) + " i"
                              : "");
    }
    double offset = a.friction_offset.empty() ? model.vehicle.base_half_width
                                              : option_value("--friction-offset", a.friction_offset, "m");
    offset = std::isnan(offset) ? 0 : offset;
    const dynamics::GammaChart chart =
        dynamics::gamma_chart(c, *layout, speed, option_value("--sideslip", a.sideslip, "rad"), friction, offset);
    if (!a.gamma_chart.empty()) {
        write_picture(dynamics::gamma_figure(chart), a.gamma_chart);
    }
    json["turning_jets"] = {
        {"gamma", layout->gamma},          {"beta", layout->beta},
        {"beta_without_pitch", beta},      {"yaw_per_difference", {{"poles", poles}, {"zero", transfer.zero}}},
        {"needed_torque", chart.needed},   {"best_gamma", chart.best_gamma},
        {"least_gamma", chart.least_gamma}};
    text += "  turning jets: gamma " + core::format_number(layout->gamma / core::degree, 4) + " deg, beta " +
            core::format_number(layout->beta / core::degree, 4) +
            " deg (thrust without pitch moment: " + core::format_number(beta / core::degree, 5) +
            " deg)\n  yaw rate per thrust difference: poles " + pole_text + " 1/s, zero " +
            core::format_number(transfer.zero, 5) + " 1/s" + (transfer.zero > 0 ? " (non-minimum phase)" : "") +
            "\n  yaw torque needed " + core::format_number(chart.needed, 4) + " N m" +
            (std::isnan(chart.least_gamma)
                 ? ": more than a pair gives at any angle\n"
                 : ": gamma at least " + core::format_number(chart.least_gamma / core::degree, 4) +
                       " deg, most torque at " + core::format_number(chart.best_gamma / core::degree, 4) + " deg\n");
}

/// Thrusts of the jets that hold a straight run, or none; how that is said.
struct RunThrust {
    std::vector<double> thrust;
    std::string said;
};

RunThrust run_thrust(const dynamics::Model& model, const dynamics::SurfaceMotion& motion, double speed) {
    RunThrust run{std::vector<double>(model.jets.size(), 0.0), "no jets"};
    if (!model.jets.empty()) {
        try {
            run.thrust = dynamics::surface_trim_thrusts(motion, speed);
            run.said = "jets in trim";
        } catch (const core::InputError& error) {
            run.said = std::string("jets off: ") + error.what();
        }
    }
    return run;
}

void surface(const dynamics::Model& model, const dynamics::Conditions& held, const LinearArguments& a,
             nlohmann::json& json, std::string& text) {
    const double speed = held.get(dynamics::Channel::speed, 0.35);
    if (!(speed > 0)) {
        return;
    }
    const dynamics::SurfaceMotion motion(model, held);
    const auto [thrust, trim] = run_thrust(model, motion, speed);
    const dynamics::SurfaceState run{speed, 0, 0, 0, 0, 0};
    const double normal = motion.contact(run, thrust).normal;
    if (normal < 0) {
        text +=
            "on the ground at " + core::format_number(speed, 4) + " m/s: the body leaves it, no run on the ground\n";
        nlohmann::json lifted = {{"speed", speed}, {"normal_force", normal}};
        turning_jets(model, dynamics::surface_coefficients(model), speed, 0, a, lifted, text);
        json["surface"] = lifted;
        return;
    }
    const double friction = model.contact.friction * normal;
    const dynamics::LinearSystem system = motion.linearised(run, thrust, false);
    const std::vector<dynamics::Mode> modes = dynamics::modes(system, {"surge", "sway", "yaw", "heading"});
    const dynamics::SurfaceCoefficients c = dynamics::surface_coefficients(model);
    const dynamics::HeadingBounds bounds = dynamics::heading_bounds(c, speed, friction);
    nlohmann::json one = system_json(system, modes);
    one["speed"] = speed;
    one["normal_force"] = normal;
    one["friction_force"] = friction;
    one["heading_gain_bound"] = bounds.least_k2_without_friction;
    one["trim_thrust"] = nlohmann::json::object();
    for (std::size_t k = 0; k < thrust.size(); ++k) {
        one["trim_thrust"][model.jets[k].name] = thrust[k];
    }
    text += "on the ground at " + core::format_number(speed, 4) + " m/s" +
            (held.has(dynamics::Channel::speed) ? "" : " (no speed is given: this one is taken)") + ", normal force " +
            core::format_number(normal, 3) + " N, friction " + core::format_number(friction, 3) + " N (" + trim + ")\n";
    for (const dynamics::Mode& mode : modes) {
        text += mode_text(mode);
    }
    text += rank_text(system, "surge force, side force and yaw moment");
    if (!model.jets.empty()) {
        const dynamics::LinearSystem by_jet = motion.linearised(run, thrust, true);
        const dynamics::Controllability control = dynamics::controllability(by_jet);
        one["controllability_by_jets"] = {{"rank", control.rank}, {"of", 4}, {"weakness", control.weakness}};
        text += rank_text(by_jet, "the jets");
    }
    text += "  heading feedback N = K2 (psi_d - psi) - K1 r needs K2 above " +
            core::format_number(bounds.least_k2_without_friction, 4) +
            " N m/rad and K1 above 0 without friction; (a + k1)(a k1 + k2 - Om^2) > a k2 with it, a = " +
            core::format_number(bounds.a, 4) + " 1/s, Om^2 = " + core::format_number(bounds.omega_squared, 4) +
            " 1/s^2, k = K/" + core::format_number(c.inertia_r, 4) + " kg m^2\n";
    turning_jets(model, c, speed, friction, a, one, text);
    json["surface"] = one;
}

/// All ten states in free water about a gap, a pitch and a speed.
void body(const dynamics::Model& model, const dynamics::Conditions& held, const dynamics::HeaveEquilibrium& at,
          nlohmann::json& json, std::string& text) {
    const dynamics::RigidBody plant(model, held);
    dynamics::BodyState trim{};
    const double speed = held.get(dynamics::Channel::speed, 0);
    trim[dynamics::state_u] = speed * std::cos(at.pitch);
    trim[dynamics::state_w] = speed * std::sin(at.pitch);
    trim[dynamics::state_theta] = at.pitch;
    trim[dynamics::state_z] = plant.height_for_gap(at.gap, at.pitch);
    const dynamics::LinearSystem system =
        dynamics::linearise_body(plant, trim, std::vector<double>(model.jets.size(), 0.0));
    const std::vector<dynamics::Mode> modes = dynamics::modes(
        system, {"surge", "sway", "heave", "pitch", "yaw", "pitch", "heading", "north", "east", "heave"});
    json["body"] = system_json(system, modes);
    text += "the whole body at " + core::format_number(1e3 * at.gap, 6) + " mm, " +
            core::format_number(at.pitch / core::degree, 4) + " deg nose up, " + core::format_number(speed, 4) +
            " m/s\n";
    for (const dynamics::Mode& mode : modes) {
        text += mode_text(mode);
    }
    if (!model.jets.empty()) {
        text += rank_text(system, "the jets");
    }
}

bool whole_body(const dynamics::Model& model) {
    const dynamics::Vehicle& v = model.vehicle;
    return !std::isnan(v.roll_inertia) && !std::isnan(v.pitch_inertia) && !std::isnan(v.yaw_inertia) &&
           !std::isnan(v.base_depth) && !std::isnan(v.base_half_length);
}

void sweep(const dynamics::Model& model, const dynamics::Conditions& held, const LinearArguments& a,
           nlohmann::json& json) {
    const std::vector<core::NamedRange> ranges = core::parse_ranges(a.sweep);
    dynamics::Channel channel{};
    if (!dynamics::find_channel(ranges.at(0).name, channel)) {
        throw core::UsageError("name", "--sweep: '" + ranges[0].name + "' is not a condition", {},
                               core::did_you_mean(ranges[0].name, dynamics::channel_names()));
    }
    const dynamics::EquilibriumSweep found =
        dynamics::equilibrium_sweep(model, held, channel, ranges[0].lower, ranges[0].upper, 101);
    if (!a.out.empty()) {
        write_picture(dynamics::equilibrium_figure(found), a.out);
    }
    json["sweep"] = nlohmann::json::array();
    for (std::size_t i = 0; i < found.value.size(); ++i) {
        for (const dynamics::HeaveEquilibrium& e : found.equilibria[i]) {
            json["sweep"].push_back({{ranges[0].name, found.value[i]}, {"gap", e.gap}, {"stable", e.stable}});
        }
    }
}

/// The trim that is asked for, if one is; its speed goes to the conditions.
std::optional<dynamics::HeaveEquilibrium> trim_of(const LinearArguments& a, dynamics::Conditions& given) {
    std::optional<dynamics::HeaveEquilibrium> at;
    if (!a.at.empty()) {
        at.emplace();
        at->name = "trim";
        at->gap = std::nan("");
        for (const core::NamedValue& value : core::parse_assignments(a.at)) {
            (value.name == "gap"     ? at->gap
             : value.name == "pitch" ? at->pitch
                                     : given[dynamics::Channel::speed]) = value.value;
            if (value.name != "gap" && value.name != "pitch" && value.name != "speed") {
                throw core::UsageError("name", "--at takes gap, pitch and speed, not '" + value.name + "'");
            }
        }
        if (std::isnan(at->gap)) {
            throw core::UsageError("missing", "--at needs a gap", {}, "for instance --at gap=5mm,pitch=1deg");
        }
    }
    return at;
}

void add_sweep(const LinearArguments& a, const dynamics::Model& model, const dynamics::Conditions& held,
               nlohmann::json& json) {
    if (!a.sweep.empty()) {
        sweep(model, held, a, json);
    } else if (!a.out.empty()) {
        throw core::UsageError("missing", "--out draws a sweep: name its range", {},
                               "for instance --sweep jet_voltage=3V:12V");
    }
}

int run_linear(const LinearArguments& a, Shell& shell) {
    const dynamics::Model model = dynamics::read_model(a.model);
    dynamics::Conditions given;
    for (const core::NamedValue& value :
         a.conditions.empty() ? std::vector<core::NamedValue>{} : core::parse_assignments(a.conditions)) {
        given.set(value.name, value.value);
    }
    const std::optional<dynamics::HeaveEquilibrium> at = trim_of(a, given);
    const dynamics::Conditions held = given.over(model.conditions);
    if (const double ground = at ? dynamics::HeavePlant(model, held).terms.contact_gap : 0; at && at->gap < ground) {
        throw core::InputError("range",
                               "--at lies in the ground: gap " + core::told(at->gap, "m") +
                                   " is below the contact gap " + core::told(ground, "m"),
                               {a.model, {}, {}, {}}, "a trim above it, or set [contact] gap in the model");
    }
    if (at && at->pitch != 0 && !pitches(model)) {
        shell.show_warning("the model has no motion in pitch: pitch " + core::told(at->pitch, "rad") +
                           " of --at is not used");
    }
    const std::vector<double> weights = weights_of(a.weights);
    shell.show(model.remarks);
    shell.show(dynamics::HeavePlant(model, held).left_out_of_small_motions());
    shell.show(trim_outside(model, held, at));
    nlohmann::json json;
    std::string text;
    add_sweep(a, model, held, json);
    heave(model, held, weights, at, json, text, shell);
    text += text.empty() ? "" : free_in_pitch(model, held, json);
    const dynamics::Vehicle& v = model.vehicle;
    if (pitches(model)) {
        heave_pitch(model, held, at, json, text, shell);
    }
    if (!std::isnan(v.yaw_inertia)) {
        surface(model, held, a, json, text);
        if (json.contains("surface")) {
            shell.show(dynamics::taken_as_zero_on_ground(model));
        }
    } else if (!a.gamma_chart.empty()) {
        throw core::InputError("missing", "the chart of jet angles needs vehicle.yaw_inertia", {a.model, {}, {}, {}});
    }
    if (at && whole_body(model)) {
        body(model, held, *at, json, text);
    }
    show_forces(shell, model, held, json);
    if (shell.json) {
        shell.print_json(json);
    }
    shell.print(text.empty() ? "no equilibrium: the vertical forces balance nowhere within the tables\n" : text);
    return ExitCode::done;
}

}  // namespace

void add_linear_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand(
        "linear", "small motion about each equilibrium: matrices, named modes, controllability, LQR gains, jet angles");
    auto a = std::make_shared<LinearArguments>();
    command->add_option("model", a->model, "the model (model.toml)")->required();
    command->add_option("--conditions", a->conditions, "what is held: speed=0.5m/s,jet_voltage=8V, ...");
    command->add_option("--at", a->at,
                        "about this trim instead of the equilibria: gap=5mm,pitch=1deg,speed=0.35m/s (then also all "
                        "states of the body)");
    command->add_option("--weights", a->weights,
                        "LQR weights q_w,q_h,r of heave velocity, gap and force (default 1,100,1)");
    command->add_option("--sweep", a->sweep, "equilibria against one condition, such as jet_voltage=3V:12V");
    command->add_option("--out", a->out, "picture of the sweep (.png, .pdf)");
    command->add_option("--gamma-chart", a->gamma_chart,
                        "picture of yaw torque and surge thrust against the angle of the turning jets (.png, .pdf)");
    command->add_option("--sideslip", a->sideslip, "sideslip that the yaw torque must master (default 6 deg)");
    command->add_option("--friction-offset", a->friction_offset,
                        "arm of one-sided friction (default: half width of the base)");
    command->footer(
        "Examples:\n"
        "  underbody linear model.toml --conditions speed=0.5m/s\n"
        "  underbody linear model.toml --at gap=5mm,pitch=1deg,speed=0.35m/s\n"
        "  underbody linear model.toml --sweep jet_voltage=3V:12V --out voltage.png\n"
        "  underbody linear model.toml --gamma-chart gamma.png --sideslip 6deg\n"
        "Heave always; heave and pitch where the model has a pitch_moment table; surge, sway, yaw on the ground where "
        "it has a yaw inertia, with the poles and the zero of yaw rate per thrust difference where it has jets.");
    shell.on(command, [a, &shell] { return run_linear(*a, shell); });
}

}  // namespace underbody::studio
