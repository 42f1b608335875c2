#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <utility>

#include "cases/thesis/claims.h"
#include "core/text.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/feedback.h"
#include "surrogates/dynamics/simulate/hold_with_jets.h"
#include "surrogates/dynamics/simulate/surface_motion.h"
#include "surrogates/dynamics/theory/release.h"
#include "surrogates/dynamics/theory/scaling.h"

namespace underbody::thesis {

using namespace dynamics;

namespace {

constexpr double chord = 0.2032, virtual_mass = 1 / 0.2529;
using std::numbers::pi;

std::string n(double value, int digits = 4) { return core::format_number(value, digits); }

/// Natural frequency of the free motion, from its turning points after a small push.
double swing_frequency(const Model& model, double gap, double push) {
    TrajectoryOptions options;
    options.duration = 120;
    options.tolerance = 1e-10;
    options.output_step = 0.01;
    const Trajectory motion = simulate(model, gap + push, 0, {}, options);
    double first = 0, last = 0;
    int crossings = 0;
    for (std::size_t i = 1; i < motion.gap.size(); ++i) {
        const double a = motion.gap[i - 1] - gap, b = motion.gap[i] - gap;
        if (a > 0 && b <= 0) {
            last = motion.time[i - 1] + (motion.time[i] - motion.time[i - 1]) * a / (a - b);
            first = crossings == 0 ? last : first;
            ++crossings;
        }
    }
    return crossings > 1 ? 2 * pi * (crossings - 1) / (last - first) : 0;
}

Model bare(double mass, double linear_drag, double quadratic_drag) {
    return read_model_text("[vehicle]\nmass = 2.2\n[drag.heave]\nlinear = " + core::format_number(linear_drag) +
                               "\nquadratic = " + core::format_number(quadratic_drag) + "\n",
                           "thesis", ".")
        .with_parameter("vehicle.added_mass_heave", mass - 2.2);
}

/// Lift over gap in chords at fixed speed, as a table for a body `size` times as large: the regimes of section 4.4
/// (lift below 1 % of the chord, suction to 25 %, weak lift above).
tables::ForceTable thesis_lift(double size, double speed) {
    // C_L over gap in chords: 0.214 at 1 mm falls through zero at 2 mm, suction to 50 mm, weak lift beyond.
    const double points[][2] = {{0, 0.9},       {0.0025, 0.45}, {0.00492, 0.2144}, {0.00984, 0},   {0.015, -0.09},
                                {0.025, -0.15}, {0.05, -0.16},  {0.1, -0.10},      {0.15, -0.055}, {0.2, -0.02},
                                {0.246, 0},     {0.3, 0.012},   {0.4, 0.02},       {0.6, 0.012},   {1, 0.003}};
    std::vector<double> gap, lift;
    const double area = plan_area(chord * size, 0.152 * size);
    for (const auto& [epsilon, coefficient] : points) {
        gap.push_back(epsilon * chord * size);
        lift.push_back(0.5 * 1000 * speed * speed * area * coefficient);
    }
    core::Table table;
    table.source = "thesis-lift.csv";
    table.add_numbers("gap", "m", gap);
    table.add_numbers("lift_force", "N", lift);
    tables::FitOptions options;
    options.kind = tables::FitOptions::Kind::interpolation;
    return tables::ForceTable::fit(table, "lift_force", options);
}

/// The reference vehicle `size` times as large over that lift, no drag unless given.
Model thesis_vehicle(double size, double speed, double quadratic_drag = 0) {
    Model model = bare(virtual_mass, 0, quadratic_drag * size * size);
    model.vehicle.mass = 2.2 * size * size * size;
    model.vehicle.added_mass_heave = (virtual_mass - 2.2) * size * size * size;
    model.forces.push_back(
        {"lift_force", "thesis-lift.csv", "thesis-lift.csv", thesis_lift(size, speed), {Channel::gap}, {}, 1.0});
    return model;
}

/// Smallest downward kick at the stable gap nearest the ground with which the body touches, m/s, by bisection on
/// trajectories.
double kick_that_touches(const Model& model, double gap, double upper) {
    TrajectoryOptions options;
    options.duration = 20;
    options.stop_at_contact = true;
    options.tolerance = 1e-10;
    double lo = 0, hi = upper;
    for (int i = 0; i < 26; ++i) {
        const double kick = (lo + hi) / 2;
        (simulate(model, gap, -kick, {}, options).end == "contact" ? hi : lo) = kick;
    }
    return (lo + hi) / 2;
}

/// Share of its kinetic energy that the body gains in 10 s without forces, in the plane and in ideal fluid, by a step
/// of 1 ms: of the equations as printed, whose cross terms have the mass in place of the virtual masses, or corrected.
double energy_gained(bool as_printed) {
    const double mass = 2.2, surge = mass + 0.79865194, sway = mass + 1.335082, yaw = 0.00708337 + 0.00037700395;
    using State = std::array<double, 3>;  // u, v, r
    const auto rate = [&](const State& s) {
        const double of_sway = as_printed ? mass : sway, of_surge = as_printed ? mass : surge;
        return State{of_sway * s[2] * s[1] / surge, -of_surge * s[2] * s[0] / sway, (surge - sway) * s[0] * s[1] / yaw};
    };
    const auto moved = [](const State& s, double step, const State& k) {
        return State{s[0] + step * k[0], s[1] + step * k[1], s[2] + step * k[2]};
    };
    const auto energy = [&](const State& s) { return surge * s[0] * s[0] + sway * s[1] * s[1] + yaw * s[2] * s[2]; };
    const State start{0.35, 0.02, 0.1};
    State s = start;
    constexpr double step = 1e-3;
    for (int i = 0; i < 10000; ++i) {
        const State a = rate(s), b = rate(moved(s, step / 2, a)), c = rate(moved(s, step / 2, b)),
                    d = rate(moved(s, step, c));
        for (std::size_t k = 0; k < s.size(); ++k) {
            s[k] += step / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
        }
    }
    return energy(s) / energy(start) - 1;
}

void equations_of_motion(Study& study) {
    study.claims.push_back({"3.6", "equation 3.6", "the equations of motion of the body",
                            "unforced in ideal fluid its kinetic energy grows by " + n(energy_gained(true)) +
                                " of itself in 10 s from 0.35 m/s, 0.02 m/s and 0.1 rad/s; with the virtual masses in "
                                "the cross terms it changes by " +
                                n(energy_gained(false), 2),
                            "does not reproduce"});
}

void springs(Study& study) {
    const auto swings = [](double stiffness, double mass) {
        const Model model =
            bare(mass, 0, 0).with_effect(make_use("tether_stiffness", {{"stiffness", stiffness}, {"gap", 0.1}}));
        return swing_frequency(model, 0.1, 1e-3);
    };
    const double full = swings(220, 2.2), virtual_full = swings(220, virtual_mass), slow = swings(55, 2.2),
                 virtual_slow = swings(55, virtual_mass);
    study.claims.push_back(
        {"4-frequency", "equations 4.7, 4.8", "a stiffness of 220 N/m gives 8.8 rad/s (1.4 Hz) at 0.5 m/s",
         "motion simulated: " + n(full) + " rad/s with the mass alone, " + n(virtual_full) +
             " with the virtual mass; 220 N/m is quoted at 1 m/s, at 0.5 m/s it is 55 N/m: " + n(slow) + " and " +
             n(virtual_slow) + " rad/s; 8.8 rad/s would need " + n(220 / (8.8 * 8.8)) + " kg",
         "does not reproduce"});
    // A spring about 2 mm over the ground: touches just above omega h.
    const double k = 55, h = 0.002;
    const Model model =
        bare(virtual_mass, 0, 0).with_effect(make_use("tether_stiffness", {{"stiffness", k}, {"gap", h}}));
    const double kick = kick_that_touches(model, h, 0.05);
    study.claims.push_back(
        {"4-kick", "equation 4.9", "the body touches when kicked down faster than omega h = 0.018 m/s at 2 mm",
         "linear spring of 55 N/m (0.5 m/s) and the virtual mass: trajectories touch from " + n(1e3 * kick) +
             " mm/s, omega h = " + n(1e3 * survivable_kick(spring_frequency(k, virtual_mass), h)) +
             " mm/s; with 8.8 rad/s it would be 17.6",
         "in part"});
    // The lift over the gap is stiffer toward the ground: the estimate is on the safe side.
    const Model real = thesis_vehicle(1, 0.5);
    const HeavePlant plant(real);
    const HeaveEquilibrium a = heave_equilibria(plant).front();
    const double real_kick = kick_that_touches(real, a.gap, 0.2);
    study.claims.push_back({"4-kick-nonlinear", "section 4.5",
                            "lift rises near the wall, so the linear estimate is conservative",
                            "stable gap " + n(1e3 * a.gap) + " mm, dF/dh = " + n(-a.stiffness) +
                                " N/m: linear estimate " + n(1e3 * survivable_kick(a.frequency, a.gap)) +
                                " mm/s, trajectories touch from " + n(1e3 * real_kick) + " mm/s",
                            real_kick > survivable_kick(a.frequency, a.gap) ? "reproduces" : "does not reproduce"});
}

void sizes(Study& study) {
    struct Row {
        double force, mass, stiffness, frequency, gap, kick;
    };
    const auto row = [](double size) {
        const Model model = thesis_vehicle(size, 0.5);
        const HeavePlant plant(model);
        const HeaveEquilibrium a = heave_equilibria(plant).front();
        const double at = 0.03 * chord * size;
        return Row{plant.lift(at), model.heave_mass(),
                   a.stiffness,    swing_frequency(model, a.gap, 1e-3 * a.gap),
                   a.gap,          kick_that_touches(model, a.gap, 0.5)};
    };
    const Row one = row(1);
    core::Figure figure;
    figure.title = "A vehicle twice, three and four times as large";
    figure.x = {"size", "", 1, 4};
    figure.y = {"factor", "", 0.1, 100, true};
    core::FigureCurve curves[6] = {
        {"force s^2", {}, {}, core::palette(0)},      {"mass s^3", {}, {}, core::palette(1)},
        {"stiffness s", {}, {}, core::palette(2)},    {"frequency 1/s", {}, {}, core::palette(3)},
        {"gap s", {}, {}, core::palette(4), 2, true}, {"kick 1", {}, {}, core::palette(5)}};
    Row two{};
    for (const double size : {1.0, 1.5, 2.0, 3.0, 4.0}) {
        const Row r = row(size);
        two = size == 2 ? r : two;
        const double values[6] = {r.force / one.force,         r.mass / one.mass, r.stiffness / one.stiffness,
                                  r.frequency / one.frequency, r.gap / one.gap,   r.kick / one.kick};
        for (std::size_t k = 0; k < 6; ++k) {
            curves[k].x.push_back(size);
            curves[k].y.push_back(values[k]);
        }
    }
    for (core::FigureCurve& curve : curves) {
        figure.curves.push_back(std::move(curve));
    }
    figure.caption =
        "Bodies of one shape at one speed and one gap in chords, each simulated: swings for the frequency, "
        "kicks bisected until the body touches.";
    study.figures.emplace_back("4-scaling", std::move(figure));
    study.claims.push_back(
        {"4-scaling", "equations 4.10 to 4.15",
         "twice the size: force 4, mass 8, force per mass 1/2, stiffness 2, frequency 1/2, survivable kick 1",
         "simulated: force " + n(two.force / one.force) + ", mass " + n(two.mass / one.mass) + ", force per mass " +
             n(two.force / one.force / (two.mass / one.mass)) + ", stiffness " + n(two.stiffness / one.stiffness) +
             ", frequency " + n(two.frequency / one.frequency) + ", kick " + n(two.kick / one.kick),
         std::abs(two.kick / one.kick - 1) < 0.01 && std::abs(two.frequency / one.frequency - 0.5) < 0.005
             ? "reproduces"
             : "does not reproduce"});
}

/// Weight at each voltage whose equilibria are those reported; REF-A-like upwash is asked for what it would have to be.
void voltages(Study& study) {
    const double reported[][2] = {{10, 1.2}, {8, 1.0}, {4, 0.6}};
    std::string upwash;
    for (const auto& [volts, gap] : reported) {
        upwash += (upwash.empty() ? "" : ", ") + n(upwash_at_equilibrium(10, volts)) + " at " + n(gap) + " m";
    }
    // A slack tether of lambda N/m net wet weight hangs the body: thrust k V^2 balances W0 + lambda h.
    const double thrust = 0.0300, w1 = thrust * 1.0, w2 = thrust * 0.64, w3 = thrust * 0.16;
    const double low = (w2 - w3) / 0.4, high = (w1 - w3) / 0.6;
    const Model model = bare(virtual_mass, 0.05, 15)
                            .with_effect(make_use("tether_stiffness", {{"stiffness", (low + high) / 2}, {"gap", 0.6}}))
                            .with_parameter("vehicle.net_weight", w3);
    core::Figure figure;
    figure.title = "Equilibrium against voltage";
    figure.x = {"jet voltage", "V", 3, 11};
    figure.y = {"gap", "m", 0, 1.6};
    core::FigureCurve hung{"thrust V^2 and a slack tether", {}, {}, core::palette(0)};
    double worst = 0;
    for (double volts = 3; volts <= 11; volts += 0.25) {
        Conditions held;
        held[Channel::input_force] = thrust * volts * volts / 100;
        const auto found = heave_equilibria(HeavePlant(model, held));
        if (!found.empty()) {
            hung.x.push_back(volts);
            hung.y.push_back(found.front().gap);
        }
    }
    core::FigurePoints points{"reported", {}, {}, {}, core::palette(1)};
    for (const auto& [volts, gap] : reported) {
        points.x.push_back(volts);
        points.y.push_back(gap);
        for (std::size_t i = 0; i < hung.x.size(); ++i) {
            worst = hung.x[i] == volts ? std::max(worst, std::abs(hung.y[i] - gap)) : worst;
        }
    }
    figure.curves.push_back(std::move(hung));
    figure.points.push_back(std::move(points));
    figure.caption = "Gaps reported for 4, 8 and 10 V, and the equilibria of a body whose slack tether weighs " +
                     n((low + high) / 2, 3) + " N/m.";
    study.figures.emplace_back("5-voltage", std::move(figure));
    study.claims.push_back(
        {"5-voltage", "sections 5.4 and 5.7", "10, 8 and 4 V hold the body at 1.2, 1.0 and 0.6 m by upwash",
         "upwash over thrust would have to be " + upwash + ": five times the thrust from one jet; a slack tether of " +
             n(low, 3) + " to " + n(high, 3) + " N/m gives the same gaps within " + n(worst, 2) + " m",
         "in part"});
}

void releases(Study& study) {
    ReleaseSetup setup;
    setup.film = jet_film(0.0717, 0.0536, 0.0025, jet_flow(0.036, 0.005, 1000, 1e-6).flow, 1e-3, 1000);
    setup.mass = 0.6;
    setup.quadratic_drag = 15;
    setup.density = 1000;
    const double threshold = -setup.film.lowest();
    const double with = escape_threshold(setup, 0.1);
    ReleaseSetup dry = setup;
    dry.squeeze = false;
    dry.extra_force = 0;
    const bool unaided = release(dry).outcome == ReleaseOutcome::escapes;
    study.claims.push_back({"5-22-threshold", "figure 5-22, docs/physics.md section 5.3",
                            "a released body escapes once it is light enough",
                            "static threshold " + n(1e3 * threshold) + " mN; with the squeeze film it escapes from " +
                                n(1e3 * with) + " mN, without " +
                                (unaided ? "it escapes with no lightening at all"
                                         : "from " + n(1e3 * escape_threshold(dry, 0.1, 1e-7), 2) + " mN"),
                            std::abs(with - threshold) < 0.02 * threshold ? "reproduces" : "does not reproduce"});
    std::vector<Release> runs;
    std::vector<std::string> names;
    std::string seen;
    std::set<ReleaseOutcome> outcomes;
    const auto add = [&](ReleaseSetup one, const std::string& how) {
        runs.push_back(release(one));
        names.push_back(how);
        seen += (seen.empty() ? "" : "; ") + std::string(release_outcome_name(runs.back().outcome)) + ": " + how;
        outcomes.insert(runs.back().outcome);
    };
    setup.duration = dry.duration = 20;
    dry.gap_mass = false;
    add(setup, "film and its mass");
    ReleaseSetup light = setup;
    light.extra_force = 0.018;
    light.gap_mass = false;
    add(light, "18 mN lighter, without the film's mass");
    ReleaseSetup heavy = dry;
    heavy.quadratic_drag = 60;
    heavy.start = 1.1e-3;
    add(heavy, "no squeeze film, let go at 1.1 mm");
    light = setup;
    light.extra_force = 1.05 * threshold;
    add(light, "5 % lighter than the film can hold");
    study.figures.emplace_back("5-22", release_figure(runs, names));
    study.claims.push_back({"5-22-outcomes", "figure 5-22",
                            "four outcomes: settles, overshoots, oscillates and decays, escapes", seen,
                            outcomes.size() == 4 ? "reproduces" : "in part"});
}

Model sled() {
    Model model = read_model_text(
        "[vehicle]\nmass = 2.2\nadded_mass_surge = 0.79865194\nadded_mass_sway = 1.335082\nyaw_inertia = "
        "0.00708337\nadded_inertia_yaw = 0.00037700395\nnet_weight = 0.1\n[contact]\nfriction = 0\n",
        "thesis", ".");
    EvieJets layout;
    layout.alpha = 20 * pi / 180;
    layout.gamma = 35 * pi / 180;
    layout.turn_x = 0.08;
    layout.turn_y = 0.05;
    layout.turn_z = 0.03;
    layout.beta = pitch_free_elevation(layout.turn_x, layout.turn_z, layout.gamma);
    layout.pitch_x = 0.06;
    layout.pitch_upper = 0.05;
    layout.pitch_lower = 0.04;
    layout.bottom = 0.05;
    layout.maximum = 0.1;
    model.jets = evie_jets(layout);
    return model;
}

void headings(Study& study) {
    const Model model = sled();
    const SurfaceMotion motion(model);
    const HeadingBounds bounds = heading_bounds(surface_coefficients(model), 0.35, 0);
    core::Figure figure;
    figure.title = "A turn of 10 degrees by PD";
    figure.x = {"time", "s"};
    figure.y = {"heading", "deg"};
    std::string text;
    for (const double part : {0.8, 1.5, 4.0}) {
        VehicleHold hold;
        hold.heading = 10 * pi / 180;
        hold.heading_gain = part * bounds.least_k2_without_friction;
        hold.yaw_rate_gain = 0.03;
        BodyOptions options;
        options.duration = 20;
        options.output_step = 0.05;
        options.command_step = 0.02;
        const SurfaceTrajectory run =
            simulate_surface(motion, {0.35, 0, 0, 0, 0, 0}, JetHold(model, hold).command(), options);
        core::FigureCurve curve{
            "K2 = " + n(part, 2) + " times its bound", run.time, {}, core::palette(figure.curves.size())};
        for (const SurfaceState& y : run.state) {
            curve.y.push_back(y[3] * 180 / pi);
        }
        text += (text.empty() ? "" : ", ") + n(part, 2) + " times: " + n(curve.y.back(), 3) + " deg after 20 s" +
                (part > 1 ? " (linear: " + n(10 * part / (part - 1), 3) + ")" : "");
        figure.curves.push_back(std::move(curve));
    }
    figure.caption =
        "Nonlinear motion on the ground without friction at 0.35 m/s; the jets give at most 0.1 N each. "
        "Below the bound Munk's moment wins.";
    study.figures.emplace_back("3-7", std::move(figure));
    study.claims.push_back({"3-7", "figures 3-7 to 3-9, equation 3.9",
                            "PD on the heading turns the vehicle when its gains are high enough",
                            "bound K2 > S_r Om^2 = " + n(bounds.least_k2_without_friction) +
                                " N m/rad; without friction a sideslip stays and the heading "
                                "settles at K2/(K2 - bound) times the wanted 10 deg. Nonlinear model at " +
                                text,
                            "reproduces"});
}

void regulator(Study& study) {
    // Heave held at 20 mm by LQR over the thesis-like lift, from two kicks.
    const Model model = thesis_vehicle(1, 0.5, 15);
    const HeavePlant plant(model);
    HeaveFeedback gains = heave_lqr(plant, 0.02, 1, 100, 1);
    core::Figure figure;
    figure.title = "Heave held at 20 mm by LQR";
    figure.x = {"time", "s"};
    figure.y = {"gap", "mm", 0, 60};
    TrajectoryOptions options;
    options.duration = 20;
    options.output_step = 0.05;
    double last = 0;
    for (const double start : {0.015, 0.03, 0.05}) {
        for (const HeaveFeedback* feedback : {static_cast<const HeaveFeedback*>(nullptr), &std::as_const(gains)}) {
            const Trajectory run = simulate(model, start, 0, {}, options, core::Progress::none(), feedback);
            core::FigureCurve curve{feedback ? "LQR from " + n(1e3 * start, 2) + " mm" : "free",
                                    run.time,
                                    {},
                                    core::palette(figure.curves.size() / 2),
                                    2,
                                    feedback == nullptr};
            if (!feedback && start != 0.015) {
                curve.name.clear();
            }
            for (const double h : run.gap) {
                curve.y.push_back(1e3 * h);
            }
            last = feedback ? run.gap.back() : last;
            figure.curves.push_back(std::move(curve));
        }
    }
    const double parked = held_gap([&](double h) { return plant.static_force(h); }, gains.gap_gain, 0.02);
    figure.caption =
        "Nonlinear motion; dashed without control. The regulator parks where its spring and the ground "
        "effect balance, " +
        n(1e3 * parked) + " mm.";
    study.figures.emplace_back("3-13", std::move(figure));
    study.claims.push_back({"3-13", "figures 3-13 and 3-14", "LQR holds the vehicle against the ground effect",
                            "gains k_h = " + n(gains.gap_gain) + " N/m, k_w = " + n(gains.velocity_gain) +
                                " N s/m; the nonlinear model ends at " + n(1e3 * last) +
                                " mm, where spring and ground effect balance (" + n(1e3 * parked) + " mm)",
                            std::abs(last - parked) < 1e-5 ? "reproduces" : "does not reproduce"});
}

}  // namespace

Study dynamics_of_the_body(core::Progress& progress) {
    Study study;
    void (*const parts[])(Study&) = {equations_of_motion, springs, sizes, voltages, releases, headings, regulator};
    double done = 0;
    for (const auto part : parts) {
        progress.check();
        progress.report(done / 7, "equations of motion, springs, sizes, voltages, releases, headings");
        part(study);
        done += 1;
    }
    return study;
}

}  // namespace underbody::thesis
