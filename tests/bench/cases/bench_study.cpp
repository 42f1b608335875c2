// `underbody study run cases/evie` when nothing changed, as a whole process. Goal: under 0.3 s.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace {

void unchanged_study(benchmark::State& state) {
    const std::filesystem::path scratch = std::filesystem::temp_directory_path() / "underbody-bench-study";
    const std::string command = std::string(UNDERBODY_PROGRAM_FOLDER) + "/underbody study run " +
                                UNDERBODY_SOURCE_FOLDER + "/cases/evie --quiet --store " +
                                (scratch / "s.sqlite").string() + " --report " +
                                (scratch / "r" / "index.html").string() + " >/dev/null 2>&1";
    if (std::system(command.c_str()) != 0) {
        state.SkipWithError("the study does not run");
        return;
    }
    for (auto _ : state) {
        benchmark::DoNotOptimize(std::system(command.c_str()));
    }
}
BENCHMARK(unchanged_study)->Unit(benchmark::kMillisecond)->UseRealTime()->Repetitions(5)->Iterations(1);

}  // namespace
