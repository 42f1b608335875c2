// Look-ups, fits and exports of force tables; OpenTURNS and SciPy as peers in the same run.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/random.h"
#include "surrogates/tables/exports/export.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/table_batch.h"

#ifdef UNDERBODY_HAS_OPENTURNS
#include <openturns/OT.hxx>
#endif

namespace {

using namespace underbody;

tables::ForceTable grid_table(int n) {
    std::vector<double> g, p, f;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            g.push_back(0.001 + 0.099 * i / (n - 1));
            p.push_back(-0.1 + 0.2 * j / (n - 1));
            f.push_back(1 / (1 + 100 * g.back()) + 3 * p.back() + std::sin(40 * g.back()));
        }
    }
    core::Table table;
    table.source = "bench";
    table.add_numbers("gap", "m", g);
    table.add_numbers("pitch", "rad", p);
    table.add_numbers("lift_force", "N", f);
    return tables::ForceTable::fit(table, "lift_force");
}

std::vector<double> random_points() {
    core::Random random(1);
    std::vector<double> points;
    for (int i = 0; i < 1 << 16; ++i) {
        points.push_back(random.uniform(0.001, 0.1));
        points.push_back(random.uniform(-0.1, 0.1));
    }
    return points;
}

void look_up_value_and_both_slopes(benchmark::State& state) {
    const auto table = grid_table(static_cast<int>(state.range(0)));
    const auto points = random_points();
    double sum = 0;
    for (auto _ : state) {
        for (std::size_t i = 0; i < points.size(); i += 2) {
            double slope[2];
            sum += table.value(&points[i], slope) + slope[0] + slope[1];
        }
        benchmark::DoNotOptimize(sum);
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size() / 2));
}
BENCHMARK(look_up_value_and_both_slopes)->Arg(20)->Arg(100);

/// Many points in one call, as the peer below takes them.
void look_up_many_at_once(benchmark::State& state) {
    const auto table = grid_table(static_cast<int>(state.range(0)));
    const auto points = random_points();
    std::vector<double> value(points.size() / 2), slope(points.size());
    for (auto _ : state) {
        tables::values(table, points.data(), value.size(), value.data(), slope.data());
        benchmark::DoNotOptimize(value.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(value.size()));
}
BENCHMARK(look_up_many_at_once)->Arg(20)->Arg(100);

/// The peer: linear values only, by Debian's own Python; median of seven, in
/// processor time, because a shared machine has little other. After it as many by the library, value and both slopes,
/// likewise.
void scipy_regular_grid_interpolator(benchmark::State& state) {
    const char* script =
        "/usr/bin/python3 -c \"import numpy as np,time\n"
        "from scipy.interpolate import RegularGridInterpolator as R\n"
        "g=np.linspace(.001,.1,100);p=np.linspace(-.1,.1,100)\n"
        "f=R((g,p),np.sin(40*g)[:,None]+3*p[None,:]);r=np.random.default_rng(1)\n"
        "x=np.c_[r.uniform(.001,.1,1000000),r.uniform(-.1,.1,1000000)];f(x[:1000]);m=[]\n"
        "for _ in range(7):\n t=time.process_time();f(x);m.append(time.process_time()-t)\n"
        "print(1e6/sorted(m)[3])\" 2>/dev/null";
    for (auto _ : state) {
        FILE* pipe = ::popen(script, "r");
        double rate = 0;
        if (pipe == nullptr || std::fscanf(pipe, "%lf", &rate) != 1) {
            state.SkipWithError("skipped: SciPy is not installed");
        }
        if (pipe != nullptr) {
            ::pclose(pipe);
        }
        state.counters["values_per_second"] = rate;
        const auto table = grid_table(100);
        const auto points = random_points();
        std::vector<double> value(points.size() / 2), slope(points.size()), seconds, one_by_one;
        for (int i = 0; i < 7; ++i) {
            const std::clock_t start = std::clock();
            for (int pass = 0; pass < 30; ++pass) {
                for (std::size_t k = 0; k < value.size(); ++k) {
                    value[k] = table.value(&points[2 * k], &slope[2 * k]);
                }
            }
            one_by_one.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / 30);
            const std::clock_t begin = std::clock();
            for (int pass = 0; pass < 30; ++pass) {
                tables::values(table, points.data(), value.size(), value.data(), slope.data());
            }
            seconds.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / 30);
        }
        std::sort(seconds.begin(), seconds.end());
        std::sort(one_by_one.begin(), one_by_one.end());
        state.counters["ours_one_by_one_per_second"] = static_cast<double>(value.size()) / one_by_one[3];
        state.counters["ours_one_by_one_over_theirs"] = static_cast<double>(value.size()) / one_by_one[3] / rate;
        state.counters["ours_per_second"] = static_cast<double>(value.size()) / seconds[3];
        state.counters["ours_over_theirs"] = static_cast<double>(value.size()) / seconds[3] / rate;
    }
}
BENCHMARK(scipy_regular_grid_interpolator)->Iterations(1)->Unit(benchmark::kMillisecond);

/// The exported header, compiled by the system compiler; reports nanoseconds a look-up of value and slopes.
void c_header(benchmark::State& state) {
    core::TemporaryFolder folder;
    tables::export_table(grid_table(100), "c", folder.path() / "table.h");
    core::write_file(
        folder.path() / "main.c",
        "#define _POSIX_C_SOURCE 199309L\n#include <stdio.h>\n#include <time.h>\n#include \"table.h\"\nstatic double "
        "p[131072];\nint main(void){unsigned s=1;int i,k;double sum=0;struct timespec a,b;"
        "for(i=0;i<65536;++i){s=s*1664525u+1013904223u;p[2*i]=.001+.099*(s/"
        "4294967296.0);s=s*1664525u+1013904223u;p[2*i+1]=-.1+.2*(s/4294967296.0);}"
        "clock_gettime(CLOCK_PROCESS_CPUTIME_ID,&a);for(k=0;k<50;++k)for(i=0;i<65536;++i){table_result "
        "r;table_at(p+2*i,&r);sum+=r.value+r.slope[0]+r.slope[1];}"
        "clock_gettime(CLOCK_PROCESS_CPUTIME_ID,&b);printf(\"%g "
        "%g\\n\",((b.tv_sec-a.tv_sec)*1e9+(b.tv_nsec-a.tv_nsec))/(50*65536.0),sum);return 0;}\n");
    const std::string at = "cd '" + folder.path().string() + "' && cc -std=c99 -O2 main.c -o main && ./main";
    for (auto _ : state) {
        FILE* pipe = ::popen(at.c_str(), "r");
        double nanoseconds = 0;
        if (pipe == nullptr || std::fscanf(pipe, "%lf", &nanoseconds) != 1) {
            state.SkipWithError("skipped: no C compiler");
        }
        if (pipe != nullptr) {
            ::pclose(pipe);
        }
        state.counters["ns_per_look_up"] = nanoseconds;
    }
}
BENCHMARK(c_header)->Iterations(1)->Unit(benchmark::kMillisecond);

core::Table scattered(int count) {
    core::Random random(3);
    std::vector<double> g, p, u, f, s;
    for (int i = 0; i < count; ++i) {
        g.push_back(0.001 * std::pow(100.0, random.uniform()));
        p.push_back(random.uniform(-0.07, 0.07));
        u.push_back(random.uniform(0.3, 1));
        f.push_back(u.back() * u.back() * (1 + 5e-4 / g.back() + 8 * p.back() / (1 + 30 * g.back())) +
                    random.normal(0, 0.01));
        s.push_back(0.01);
    }
    core::Table table;
    table.source = "bench";
    table.add_numbers("gap", "m", g);
    table.add_numbers("pitch", "rad", p);
    table.add_numbers("speed", "m/s", u);
    table.add_numbers("lift_force", "N", f);
    table.add_numbers("lift_force_sigma", "N", s);
    return table;
}

void gaussian_process_of_500_points_in_three_axes(benchmark::State& state) {
    const auto table = scattered(500);
    for (auto _ : state) {
        benchmark::DoNotOptimize(tables::ForceTable::fit(table, "lift_force"));
    }
}
BENCHMARK(gaussian_process_of_500_points_in_three_axes)->Unit(benchmark::kSecond)->Iterations(1);

void means_and_variances_after_tabulation(benchmark::State& state) {
    const auto table = tables::ForceTable::fit(scattered(200), "lift_force");
    core::Random random(5);
    std::vector<double> points;
    for (int i = 0; i < 4096; ++i) {
        points.insert(points.end(),
                      {random.uniform(0.002, 0.09), random.uniform(-0.06, 0.06), random.uniform(0.35, 0.95)});
    }
    double sum = 0;
    for (auto _ : state) {
        for (std::size_t i = 0; i < points.size(); i += 3) {
            sum += table.value(&points[i]) + table.sigma(&points[i]);
        }
        benchmark::DoNotOptimize(sum);
    }
    state.SetItemsProcessed(state.iterations() * 4096);
}
BENCHMARK(means_and_variances_after_tabulation);

#ifdef UNDERBODY_HAS_OPENTURNS
void openturns_kriging_of_500_points_in_three_axes(benchmark::State& state) {
    const auto table = scattered(500);
    OT::Sample x(500, 3), y(500, 1);
    for (unsigned i = 0; i < 500; ++i) {
        x(i, 0) = std::log(table.numbers("gap")[i]);
        x(i, 1) = table.numbers("pitch")[i];
        x(i, 2) = table.numbers("speed")[i];
        y(i, 0) = table.numbers("lift_force")[i];
    }
    for (auto _ : state) {
        OT::KrigingAlgorithm kriging(x, y, OT::MaternModel(OT::Point(3, 1.0), 2.5),
                                     OT::ConstantBasisFactory(3).build());
        kriging.setNoise(OT::Point(500, 1e-4));
        kriging.run();
        benchmark::DoNotOptimize(kriging.getResult());
    }
}
BENCHMARK(openturns_kriging_of_500_points_in_three_axes)->Unit(benchmark::kSecond)->Iterations(1);
#endif

void export_of_100_by_100(benchmark::State& state, const char* format) {
    core::TemporaryFolder folder;
    const auto table = grid_table(100);
    for (auto _ : state) {
        tables::export_table(table, format, folder.path() / "table.out");
    }
}
BENCHMARK_CAPTURE(export_of_100_by_100, c, "c")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(export_of_100_by_100, csv, "csv")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(export_of_100_by_100, json, "json")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(export_of_100_by_100, mat, "mat")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(export_of_100_by_100, jsbsim, "jsbsim")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(export_of_100_by_100, fmu, "fmu")->Unit(benchmark::kMillisecond);

}  // namespace
