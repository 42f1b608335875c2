// Speed of learning and estimating. Goals: covariance and model of 9 x 4,000,000 samples in 0.2 s on two cores, no
// slower than NumPy's covariance and ten times scikit-learn's PCA; a truncation scan in 10 ms; 50,000 time-evolved
// columns in 1 s; an observer step in 200 ns without allocation.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>
#include <string>
#include <vector>

#include "cases/thesis/published.h"
#include "core/random.h"
#include "surrogates/estimator/model/augmented_model.h"
#include "surrogates/estimator/model/training.h"
#include "surrogates/estimator/observe/extended_filter.h"
#include "surrogates/estimator/observe/observer.h"

namespace {
std::size_t allocations = 0;
}

// Counts what the program asks of the heap.
void* operator new(std::size_t size) {
    ++allocations;
    if (void* p = std::malloc(size)) {
        return p;
    }
    throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace {

using namespace underbody::estimator;
using namespace underbody::thesis;

constexpr std::size_t columns = 4000000;

const TrainingSet& samples() {
    static const TrainingSet set = [] {
        TrainingOptions o;
        o.samples = columns;
        return training_set(reference_plant(), o);
    }();
    return set;
}

const std::filesystem::path& file() {
    static const std::filesystem::path path = [] {
        auto p = std::filesystem::temp_directory_path() / "underbody-bench-samples.npy";
        write_npy(p, samples().values.data(), samples().count, 9);
        std::atexit(
            [] { std::filesystem::remove(std::filesystem::temp_directory_path() / "underbody-bench-samples.npy"); });
        return p;
    }();
    return path;
}

double peak_memory_mb() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.rfind("VmHWM:", 0) == 0) {
            return std::atof(line.c_str() + 6) / 1024;
        }
    }
    return 0;
}

void covariance_and_model_samples_in_rows(benchmark::State& state) {
    const TrainingSet& set = samples();
    for (auto _ : state) {
        benchmark::DoNotOptimize(learn(moments(set.view()), set.layout));
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * columns * 72));
}
BENCHMARK(covariance_and_model_samples_in_rows)->Unit(benchmark::kMillisecond)->UseRealTime();

void covariance_and_model_channels_in_rows(benchmark::State& state) {
    const TrainingSet& set = samples();
    std::vector<double> turned(set.values.size());
    for (std::size_t i = 0; i < columns; ++i) {
        for (std::size_t c = 0; c < 9; ++c) {
            turned[c * columns + i] = set.values[i * 9 + c];
        }
    }
    for (auto _ : state) {
        benchmark::DoNotOptimize(learn(moments(SampleView::channels_in_rows(turned.data(), 9, columns)), set.layout));
    }
}
BENCHMARK(covariance_and_model_channels_in_rows)->Unit(benchmark::kMillisecond)->UseRealTime();

void covariance_streamed_from_a_file(benchmark::State& state) {
    const auto& path = file();
    const double before = peak_memory_mb();
    for (auto _ : state) {
        benchmark::DoNotOptimize(moments_of_file(path));
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * columns * 72));
    state.counters["peak_memory_growth_MB"] = peak_memory_mb() - before;
}
BENCHMARK(covariance_streamed_from_a_file)->Unit(benchmark::kMillisecond)->UseRealTime();

void truncation_scan_of_all_orders(benchmark::State& state) {
    TrainingOptions o;
    const TrainingSet set = training_set(reference_plant(), o);
    const Moments m = moments(set.view());
    for (auto _ : state) {
        benchmark::DoNotOptimize(scan_orders(m, set.layout));
    }
}
BENCHMARK(truncation_scan_of_all_orders)->Unit(benchmark::kMillisecond);

void time_evolved_set_of_50000(benchmark::State& state) {
    TrainingOptions o;
    o.method = TrainingOptions::Method::time;
    const SeparatedPlant plant = reference_plant();
    for (auto _ : state) {
        benchmark::DoNotOptimize(training_set(plant, o));
    }
}
BENCHMARK(time_evolved_set_of_50000)->Unit(benchmark::kMillisecond)->UseRealTime();

void observer_step(benchmark::State& state) {
    const AugmentedModel m =
        corrected(published_8_47(), Correction::p3, heave_rows(Layout::heave(), thesis_virtual_mass(), 0));
    const std::vector<std::string> sensors{"heave_velocity", "gap"};
    const bool full = state.range(0) != 0;
    FilterRunner run(full ? kalman_observer(m, sensors, {0, 0, 1e-6, 1e-6}, {1e-4, 1e-3}, 0.02).filter
                          : reduced_observer(m, reduced_gain(m, {{-3, 0}, {-4, 0}}), 0.02).filter);
    double x[2] = {0.01, 0.3}, u = 0.002, e[FilterRunner::most_states];
    run.start(x, e);
    const std::size_t before = allocations;
    for (auto _ : state) {
        x[0] = -x[0];
        run.step(x, &u, e);
        benchmark::DoNotOptimize(e[0]);
    }
    state.counters["allocations"] = static_cast<double>(allocations - before);
    state.SetLabel(full ? "steady-state Kalman, 4 states" : "reduced order, 2 states");
}
BENCHMARK(observer_step)->Arg(0)->Arg(1);

void extended_filter_2000_samples(benchmark::State& state) {
    const SeparatedPlant plant = reference_plant();
    underbody::core::Random random(1);
    RunSignals run;
    double h = .2, w = 0;
    for (int k = 0; k < 2000; ++k) {
        run.time.push_back(.02 * k);
        run.gap.push_back(h + 2e-4 * random.normal());
        plant.advance(h, w, 0, .02);
    }
    for (auto _ : state) {
        benchmark::DoNotOptimize(extended_filter(plant, run, {}));
    }
    state.SetItemsProcessed(state.iterations() * 2000);
}
BENCHMARK(extended_filter_2000_samples)->Unit(benchmark::kMillisecond);

// The peers, in the same run, by Debian's own Python; skipped aloud where a package is missing.
void peer(benchmark::State& state, const char* name, const char* imports, const char* work) {
    const auto script = std::filesystem::temp_directory_path() / "underbody-bench-peer.py";
    std::ofstream(script)
        << "import time\nimport numpy as np\n"
        << imports << "\nx = np.ascontiguousarray(np.load('" << file().string()
        << "').T)\ny = np.ascontiguousarray(x.T)\nbest = 1e9\nfor i in range(3):\n    t = time.perf_counter()\n    "
        << work << "\n    best = min(best, time.perf_counter() - t)\nprint(best)\n";
    const std::string command = "/usr/bin/python3 " + script.string() + " 2>/dev/null";
    for (auto _ : state) {
        double seconds = 0;
        FILE* pipe = popen(command.c_str(), "r");
        if (pipe == nullptr || std::fscanf(pipe, "%lf", &seconds) != 1) {
            state.SkipWithError((std::string(name) + " is not here").c_str());
        }
        if (pipe != nullptr) {
            pclose(pipe);
        }
        state.SetIterationTime(seconds > 0 ? seconds : 1e-9);
    }
    std::filesystem::remove(script);
}

void numpy_covariance(benchmark::State& state) { peer(state, "NumPy", "", "np.cov(x, bias=True)"); }
BENCHMARK(numpy_covariance)->UseManualTime()->Iterations(1)->Unit(benchmark::kMillisecond);

void scikit_learn_pca(benchmark::State& state) {
    peer(state, "scikit-learn", "from sklearn.decomposition import PCA", "PCA(n_components=7).fit(y)");
}
BENCHMARK(scikit_learn_pca)->UseManualTime()->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
