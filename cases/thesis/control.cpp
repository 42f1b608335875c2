// Section 8.9 and figure 8-14: the loop closed with estimated forces.
#include <cmath>

#include "cases/thesis/parts.h"
#include "surrogates/estimator/control/loop_region.h"

namespace underbody::thesis {

namespace {

LinearFilter observer_at(double dt) {
    const AugmentedModel model = p3_of_8_47();
    return reduced_observer(model, reduced_gain(model, {{-3, 0}, {-4, 0}}), dt).filter;
}

ControlLaw weak_law() {
    ControlLaw weak;
    weak.velocity_gain = .9;
    weak.gap_gain = .05;
    weak.reference_gap = .02;
    return weak;
}

// 8-14 (a) to (e)
void holding(Study& study) {
    const SeparatedPlant plant = reference_plant();
    const double s = plant.virtual_mass;
    LoopOptions o;
    o.disturbance = [](double t) { return t > 25 && t < 30 ? 0.01 : 0.002 * std::sin(2 * t); };
    const ControlLaw law = hold_at(0.02, s, -1, -1);
    const LinearFilter filter = observer_at(o.step);
    const LoopRun run = close_loop(plant, law, LoopEstimator::with(filter), o),
                  open = close_loop(plant, law, LoopEstimator::nothing(), o);
    const char* words =
        "8.47 with P3, poles -3 and -4; k_w = 2 S, k_h = S, start at rest at 0.25 m; a pulse of 10 mN from 25 to 30 s "
        "and 2 mN at 2 rad/s.";
    const auto figure = [&](const char* name, const char* title, const char* y, const char* unit) {
        study.figures.emplace_back(name, plot(title, words, "time", "s", y, unit));
        return &study.figures.back().second;
    };
    core::Figure* f = figure("8-14a", "8-14: control force and disturbance", "force", "mN");
    curve(*f, "control", run.time, run.command, 1, false, 1e3);
    curve(*f, "disturbance", run.time, run.disturbance, 0, false, 1e3);
    f = figure("8-14b", "8-14: gap", "gap", "mm");
    curve(*f, "with cancellation", run.time, run.gap, 0, false, 1e3);
    curve(*f, "without", open.time, open.gap, 1, true, 1e3);
    f = figure("8-14c", "8-14: heave velocity", "heave velocity", "mm/s");
    curve(*f, "with cancellation", run.time, run.velocity, 0, false, 1e3);
    curve(*f, "without", open.time, open.velocity, 1, true, 1e3);
    f = figure("8-14d", "8-14: ground force", "force", "mN");
    curve(*f, "F_g", run.time, run.ground_force, 7, false, 1e3);
    curve(*f, "estimated (takes up the disturbance)", run.time, run.ground_estimate, 2, true, 1e3);
    f = figure("8-14e", "8-14: drag", "force", "mN");
    curve(*f, "F_d", run.time, run.drag_force, 7, false, 1e3);
    curve(*f, "estimated", run.time, run.drag_estimate, 2, true, 1e3);
    LoopOptions calm;
    const LoopRun with = close_loop(plant, law, LoopEstimator::with(filter), calm),
                  without = close_loop(plant, law, LoopEstimator::nothing(), calm);
    study.claims.push_back({"8-14-hold", "8.4, Figure 8-14", "Cancelling the estimated forces holds the gap",
                            "20 mm asked: " + number(1e3 * with.gap.back(), 5) + " mm with, " +
                                number(1e3 * without.gap.back(), 5) + " mm without cancellation",
                            "reproduces"});
}

// Each estimator in the same loop, over its own learned model, from 250 mm to 20 mm; then with what a real loop has.
void every_estimator(Study& study) {
    const SeparatedPlant plant = reference_plant();
    const ControlLaw law = hold_at(0.02, plant.virtual_mass, -1, -1);
    LoopOptions calm, rough;
    rough.actuator_lag = 0.1;
    rough.gap_noise = 2e-4;
    rough.velocity_noise = 2e-4;
    ControlLaw limited = law;
    limited.limit = 0.1;
    std::string words;
    double worst = 0;
    for (const std::string& name : loop_estimators()) {
        if (name == "truth" || name == "none") {
            continue;
        }
        const LoopEstimator e = design_loop_estimator(name, plant, {});
        const LoopRun quiet = close_loop(plant, law, e, calm), real = close_loop(plant, limited, e, rough);
        worst = std::max(worst, std::abs(quiet.hold_error));
        words += (words.empty() ? "" : "; ") + name + " " + number(1e3 * (law.reference_gap + quiet.hold_error), 5) +
                 " mm, error of F_T " + number(1e3 * real.total_force_error.value(), 2) + " mN and spread " +
                 number(1e3 * real.hold_sigma, 2) + " mm in the rough loop";
    }
    study.claims.push_back({"8-each", "section 8.9", "The estimator of separate forces is what the loop needs",
                            "20 mm asked, gap held: " + words +
                                " (limit 100 mN, lag 0.1 s, sensor noise 0.2 mm and 0.2 mm/s). Every estimate of the "
                                "total force holds the gap; the split into two forces is not used by the law",
                            worst < 2e-4 ? "in part" : "does not reproduce"});
}

// The law as figure 8-4 prints it, and weak gains.
void printed_law(Study& study) {
    const SeparatedPlant plant = reference_plant();
    // The law as figure 8-4 prints it, with the drag as a resistance: the drag is doubled instead of removed.
    const ControlLaw weak = weak_law();
    LoopOptions slow;
    slow.duration = 600;
    slow.step = 0.05;
    const LinearFilter good = observer_at(slow.step);
    LinearFilter printed = good;
    const std::size_t total = 2;
    for (std::size_t j = 0; j < printed.output.columns(); ++j) {
        printed.output(total, j) = printed.output(0, j) + printed.output(1, j);
    }
    for (std::size_t j = 0; j < printed.feed.columns(); ++j) {
        printed.feed(total, j) = printed.feed(0, j) + printed.feed(1, j);
    }
    const LoopRun right = close_loop(plant, weak, LoopEstimator::with(good), slow),
                  wrong = close_loop(plant, weak, LoopEstimator::with(printed), slow);
    const auto settle = [](const LoopRun& r) {
        double t = 0;
        for (std::size_t k = 0; k < r.time.size(); ++k) {
            t = std::abs(r.gap[k] - .02) > .002 ? r.time[k] : t;
        }
        return t;
    };
    study.claims.push_back({"8-4", "Figure 8-4", "u = -Kx - F_d_hat - F_g_hat",
                            "with F_d a resistance that law doubles the drag: within 2 mm of 20 mm after " +
                                number(settle(wrong), 3) + " s against " + number(settle(right), 3) +
                                " s with -(F_g_hat - F_d_hat)",
                            "does not reproduce"});
    const LoopRun parked = close_loop(plant, weak, LoopEstimator::nothing(), slow);
    study.claims.push_back({"8-weak", "8.4", "Feedback needs the estimate of the forces",
                            "weak gains (0.9, 0.05) from 0.25 m end at " + number(1e3 * parked.gap.back(), 4) +
                                " mm without cancellation, " + number(1e3 * right.gap.back(), 4) + " mm with",
                            "reproduces"});
}

// 8-14 (f)
void region(Study& study, core::Progress& progress) {
    const SeparatedPlant plant = reference_plant();
    LoopOptions map;
    map.step = 0.1;
    map.duration = 400;
    LoopRegionOptions grid;
    grid.axes = {{"gap", 0, 1.2}, {"heave_velocity", -.03, .03}};
    grid.columns = 40;
    grid.rows = 24;
    grid.refine = false;
    const auto with = loop_region(plant, weak_law(), LoopEstimator::with(observer_at(map.step)), map, grid, progress);
    const auto without = loop_region(plant, weak_law(), LoopEstimator::nothing(), map, grid, progress);
    // Stronger gains with what a real loop has: the saturation decides how far the region reaches.
    LoopOptions real = map;
    real.duration = 240;
    real.actuator_lag = 0.2;
    real.gap_noise = 2e-4;
    real.velocity_noise = 2e-4;
    ControlLaw limited = hold_at(0.02, plant.virtual_mass, -.5, -.5);
    limited.limit = 0.015;
    LoopDesign design;
    design.step = real.step;
    grid.columns = 24;
    grid.rows = 12;
    const auto rough =
        loop_region(plant, limited, design_loop_estimator("extended", plant, design), real, grid, progress);
    const auto add = [&](const char* name, const char* title, const dynamics::StabilityRegion& r) {
        core::Figure f = dynamics::region_figure(r);
        f.title = title;
        study.figures.emplace_back(name, f);
    };
    add("8-14f", "8-14: where starts end, forces cancelled", with);
    add("8-14g", "8-14: the same without cancellation", without);
    add("8-14h", "8-14: extended filter, limit 15 mN, lag, sensor noise", rough);
    study.claims.push_back(
        {"8-14-region", "Figure 8-14(f)", "The region of attraction is robust",
         "share of starts (0..1.2 m, +-30 mm/s) that end at 20 mm with weak gains: " +
             number(100 * with.fraction("held"), 3) + " % with, " + number(100 * without.fraction("held"), 3) +
             " % without cancellation; with the extended filter under a limit of 15 mN, a lag of 0.2 s and sensor "
             "noise " +
             number(100 * rough.fraction("held"), 3) + " %: the limit lies below the largest ground force, 20 mN",
         with.fraction("held") > without.fraction("held") ? "reproduces" : "does not reproduce"});
}

}  // namespace

void add_control(Study& study, core::Progress& progress) {
    holding(study);
    every_estimator(study);
    progress.check();
    printed_law(study);
    region(study, progress);
}

}  // namespace underbody::thesis
