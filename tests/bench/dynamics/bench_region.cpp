// Stability regions against the clock, and a trajectory against SciPy, CVODE and Boost.odeint in the same run.
#include <benchmark/benchmark.h>

#include <array>
#include <boost/numeric/odeint.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/file.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/ode.h"
#include "tests/surrogates/dynamics/models.h"

namespace {

using namespace underbody;
using namespace underbody::dynamics;

constexpr int peers = 100;  // starts that every peer integrates

Model vehicle() { return dynamics::test::ref_a_model(0.3, 15, 0.002); }

RegionOptions map(std::size_t cells) {
    RegionOptions options;
    options.axes = {{"gap", -0.04, 1.0}, {"heave_velocity", -0.1, 0.1}};
    options.columns = options.rows = cells;
    options.refine = false;
    return options;
}

std::vector<std::array<double, 2>> starts() {
    core::Random random(3);
    std::vector<std::array<double, 2>> all;
    for (int i = 0; i < peers; ++i) {
        all.push_back({random.uniform(-0.04, 1.0), random.uniform(-0.1, 0.1)});
    }
    return all;
}

void HeaveRegion400(benchmark::State& state) {
    core::set_threads(static_cast<int>(state.range(0)));
    const Model model = vehicle();
    for (auto _ : state) {
        const StabilityRegion region = stability_region(model, map(400));
        benchmark::DoNotOptimize(region.index.data());
    }
    state.counters["us_per_start"] = benchmark::Counter(
        160000.0 * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    core::set_threads(0);
}
BENCHMARK(HeaveRegion400)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void HeaveRegion400OfAnInterpolatedTable(benchmark::State& state) {
    Model model = vehicle();
    model.forces[0].table =
        tables::ForceTable::fit(dynamics::test::ref_a_table(), "lift_force",
                                {{tables::RangePolicy::clamp, {}}, tables::FitOptions::Kind::interpolation});
    for (auto _ : state) {
        benchmark::DoNotOptimize(stability_region(model, map(400)).index.data());
    }
}
BENCHMARK(HeaveRegion400OfAnInterpolatedTable)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Every trajectory followed to the end of its 60 s, contact or escape: nothing is decided by energy.
void HeaveFollowedToTheEnd(benchmark::State& state) {
    const Model waved =
        vehicle().with_effect(make_use("periodic_disturbance", {{"amplitude", 1e-12}, {"frequency", 0.1}}));
    const HeavePlant plant(waved);
    const HeaveEnds ends(plant, -0.05, 1.8, 60, 1e-6, 1.04, 0.2);
    const auto all = starts();
    for (auto _ : state) {
        for (const auto& s : all) {
            benchmark::DoNotOptimize(ends.of(s[0], s[1]).index);
        }
    }
    state.counters["us_per_start"] =
        benchmark::Counter(peers * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(HeaveFollowedToTheEnd)->Unit(benchmark::kMillisecond);

void PeerCvode(benchmark::State& state) {
    const Model model = vehicle();
    TrajectoryOptions options;
    options.tolerance = 1e-6;
    options.stop_at_contact = true;
    options.escape_gap = 1.8;
    const auto all = starts();
    for (auto _ : state) {
        for (const auto& s : all) {
            benchmark::DoNotOptimize(simulate(model, s[0], s[1], {}, options).end.data());
        }
    }
    state.counters["us_per_start"] =
        benchmark::Counter(peers * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(PeerCvode)->Unit(benchmark::kMillisecond);

void PeerOdeint(benchmark::State& state) {
    namespace odeint = boost::numeric::odeint;
    using Pair = std::array<double, 2>;
    const HeavePlant plant(vehicle());
    const auto rate = [&](const Pair& y, Pair& d, double t) {
        HeaveMoment moment;
        moment.t = t;
        d = {y[1], plant.acceleration(y[0], y[1], moment)};
    };
    const auto all = starts();
    for (auto _ : state) {
        for (const auto& s : all) {
            auto stepper = odeint::make_controlled(1e-9, 1e-6, odeint::runge_kutta_dopri5<Pair>());
            Pair y = s;
            double t = 0, step = 0.02;
            while (t < 60 && y[0] > -0.05 && y[0] < 1.8) {
                step = std::min(step, 60 - t);
                stepper.try_step(rate, y, t, step);
            }
            benchmark::DoNotOptimize(y[0]);
        }
    }
    state.counters["us_per_start"] =
        benchmark::Counter(peers * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(PeerOdeint)->Unit(benchmark::kMillisecond);

/// SciPy's solve_ivp over the same starts, at 1e-6, by Debian's own Python.
void PeerScipy(benchmark::State& state) {
    std::string script =
        "import sys\ntry:\n    import numpy as np\n    from scipy.integrate import solve_ivp\n    from "
        "scipy.interpolate import CubicSpline\nexcept Exception:\n"
        "    print('missing'); sys.exit(0)\nimport time\nh=[];f=[]\n";
    const core::Table table = dynamics::test::ref_a_table();
    for (std::size_t i = 0; i < table.rows(); ++i) {
        script += "h.append(" + core::format_number(table.numbers("gap")[i]) + ");f.append(" +
                  core::format_number(table.numbers("lift_force")[i]) + ")\n";
    }
    script +=
        "s=CubicSpline(h,f)\nlo,hi=h[0],h[-1]\ndef rate(t,y):\n    x=min(max(y[0],lo),hi); w=y[1]\n"
        "    return [w,(float(s(x))-0.002-0.3*w-15*w*abs(w))*0.2529]\n"
        "def touch(t,y): return y[0]+0.05\ntouch.terminal=True\ndef leave(t,y): return 1.8-y[0]\nleave.terminal=True\n"
        "starts=[";
    for (const auto& s : starts()) {
        script += "(" + core::format_number(s[0]) + "," + core::format_number(s[1]) + "),";
    }
    script +=
        "]\nsolve_ivp(rate,(0,1),starts[0])\nb=time.perf_counter()\nfor s0 in starts:\n    "
        "solve_ivp(rate,(0,60),s0,rtol=1e-6,atol=1e-9,events=[touch,leave])\n"
        "print((time.perf_counter()-b)/len(starts)*1e6)\n";
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "peer.py", script);
    double microseconds = 0;
    for (auto _ : state) {
        const auto begin = std::chrono::steady_clock::now();
        FILE* pipe = popen(("/usr/bin/python3 " + (folder.path() / "peer.py").string()).c_str(), "r");
        char line[64] = {};
        if (!pipe || !std::fgets(line, sizeof line, pipe) || std::string(line).starts_with("missing")) {
            state.SkipWithError("skipped: SciPy is not here (python3-scipy)");
        } else {
            microseconds = std::stod(line);
        }
        if (pipe) {
            pclose(pipe);
        }
        state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    state.counters["us_per_start"] = microseconds;
}
BENCHMARK(PeerScipy)->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Lift and moment over gap and pitch of a plate near the ground.
Model plate() {
    std::vector<double> gap, pitch, lift, moment;
    for (int i = 0; i <= 40; ++i) {
        for (int j = 0; j <= 16; ++j) {
            const double h = 5e-4 + 1.2e-3 * i + 1e-5 * i * i, p = -0.08 + 0.01 * j;
            gap.push_back(h);
            pitch.push_back(p);
            lift.push_back(2.2e-10 / std::pow(h, 3) * (1 + 8 * p) - 1.8e-7 / (h * h) + 0.03);
            moment.push_back(-0.02 * p + 1e-5 * p / (h + 0.002));
        }
    }
    core::Table table;
    table.source = "plate.csv";
    table.add_numbers("gap", "m", gap);
    table.add_numbers("pitch", "rad", pitch);
    table.add_numbers("lift_force", "N", lift);
    table.add_numbers("pitch_moment", "N m", moment);
    Model model = read_model_text(
        "[vehicle]\nmass = 2.2\nadded_mass_heave = 1.754\npitch_inertia = 0.00685\nadded_inertia_pitch = "
        "0.0005\nbase_depth = 0.0514\n"
        "base_half_length = 0.0717\nnet_weight = 0.02\nbuoyancy_height = 0.002\n[drag.heave]\nlinear = 0.3\nquadratic "
        "= 15\n[drag.pitch]\nlinear = 0.0005\nquadratic = 0.01\n",
        "plate.toml", ".");
    for (const char* quantity : {"lift_force", "pitch_moment"}) {
        model.forces.push_back(
            {quantity,
             "plate.csv",
             "plate.csv",
             tables::ForceTable::fit(table, quantity,
                                     {{tables::RangePolicy::clamp, {}}, tables::FitOptions::Kind::interpolation}),
             {Channel::gap, Channel::pitch},
             {},
             1.0});
    }
    return model;
}

void HeavePitchRegion100(benchmark::State& state) {
    const Model model = plate();
    RegionOptions options;
    options.axes = {{"gap", 0.0, 0.06}, {"pitch", -0.08, 0.08}};
    options.columns = options.rows = 100;
    options.through_contact = true;
    options.refine = false;
    options.tolerance = 1e-7;
    for (auto _ : state) {
        const StabilityRegion region = stability_region(model, options);
        benchmark::DoNotOptimize(region.index.data());
        for (const EndClass& end : region.classes) {
            state.counters[end.name] = end.fraction;
        }
    }
}
BENCHMARK(HeavePitchRegion100)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);

void ProbabilityOf100Draws200(benchmark::State& state) {
    core::Table table = dynamics::test::ref_a_table();
    table.add_numbers("lift_force_sigma", "N", std::vector<double>(table.rows(), 5e-4));
    Model model = vehicle();
    model.forces[0].table = tables::ForceTable::fit(
        table, "lift_force", {{tables::RangePolicy::clamp, {}}, tables::FitOptions::Kind::interpolation});
    for (auto _ : state) {
        const ProbabilityMap chances = probability_map(model, map(200), 100, 1);
        state.counters["safe"] = chances.area_mean;
        state.counters["sigma"] = chances.area_sigma;
    }
}
BENCHMARK(ProbabilityOf100Draws200)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);

}  // namespace
