// The bench of heave with pitch: simulated rigs with a controller fed the noisy reading, and what discover() says.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>

#include "core/file.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/statistics.h"
#include "tests/surrogates/discovery/pitch_rig.h"

using namespace underbody;

namespace {

struct Kind {
    const char* name;  ///< what a verdict should say; "none": nothing
    double colour;     ///< of the noise
    void (*change)(test::PitchRig& rig);
};

const Kind kinds[] = {
    {"none", 0, [](test::PitchRig&) {}},
    {"none", 0.9, [](test::PitchRig&) {}},
    {"input_arm", 0,
     [](test::PitchRig& rig) {
         rig.moment = [](const test::PitchMoment& now) { return 0.008 * std::cos(now.pitch) * now.input; };
     }},
    {"moment_offset", 0, [](test::PitchRig& rig) { rig.moment = [](const test::PitchMoment&) { return 3e-4; }; }},
    {"pitch_damping", 0,
     [](test::PitchRig& rig) { rig.moment = [](const test::PitchMoment& now) { return -0.003 * now.rate; }; }},
    {"pitch_stiffness", 0,
     [](test::PitchRig& rig) {
         rig.moment = [](const test::PitchMoment& now) { return -0.006 * std::sin(now.pitch); };
     }},
    {"added_pitch_inertia", 0, [](test::PitchRig& rig) { rig.added_inertia = 0.002; }},
    {"linear_damping", 0,
     [](test::PitchRig& rig) { rig.force = [](const test::PitchMoment& now) { return -0.3 * now.rise; }; }},
    {"constant_force", 0, [](test::PitchRig& rig) { rig.force = [](const test::PitchMoment&) { return 0.01; }; }},
};

}  // namespace

int main(int argc, char** argv) {
    std::size_t seeds = 1;
    std::uint64_t first = 30000;
    std::string only;
    double colour = -1, seconds = 20;
    std::string write;
    for (int i = 1; i + 1 < argc; i += 2) {
        if (std::strcmp(argv[i], "--seeds") == 0) {
            seeds = std::stoul(argv[i + 1]);
        } else if (std::strcmp(argv[i], "--first-seed") == 0) {
            first = std::stoull(argv[i + 1]);
        } else if (std::strcmp(argv[i], "--kind") == 0) {
            only = argv[i + 1];
        } else if (std::strcmp(argv[i], "--colour") == 0) {
            colour = std::stod(argv[i + 1]);
        } else if (std::strcmp(argv[i], "--seconds") == 0) {
            seconds = std::stod(argv[i + 1]);
        } else if (std::strcmp(argv[i], "--write") == 0) {
            write = argv[i + 1];
        } else {
            std::fprintf(stderr,
                         "bench_pitch [--kind NAME] [--colour C] [--first-seed N] [--seeds N] [--seconds S] "
                         "[--write FOLDER]\n");
            return 2;
        }
    }
    const core::TemporaryFolder folder("bench-pitch");
    const dynamics::Model model = test::pitch_rig_model(folder.path());
    for (const Kind& kind : kinds) {
        if ((!only.empty() && only != kind.name) || (colour >= 0 && kind.colour != colour)) {
            continue;
        }
        std::size_t right = 0, silent = 0, unknown = 0;
        for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
            test::PitchRig rig;
            rig.seconds = seconds;
            rig.colour = kind.colour;
            kind.change(rig);
            const dynamics::Measurements data = test::pitch_rig_runs(rig, 6, seed);
            if (!write.empty()) {
                const std::filesystem::path where =
                    std::filesystem::path(write) / (std::string(kind.name) + "-" + std::to_string(seed));
                test::write_pitch_runs(data, where / "runs", kind.name);
                test::pitch_rig_model(where);
                continue;
            }
            discovery::DiscoverOptions options;
            options.consequence = options.figures = false;
            const std::clock_t begin = std::clock();
            const discovery::Discovery found = discovery::discover(model, data, options);
            const double spent = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
            const bool named =
                found.verdict == "effect" && found.effects.size() == 1 && found.effects.front().name == kind.name;
            bool tied = false;
            for (const discovery::FoundEffect& rival : found.alternatives) {
                tied = tied || (found.verdict == "effect" && rival.name == kind.name && rival.probability > 0.2);
            }
            const bool none = found.verdict == "none";
            right += named || tied || (none && std::strcmp(kind.name, "none") == 0) ? 1 : 0;
            silent += none ? 1 : 0;
            unknown += found.verdict == "unknown" ? 1 : 0;
            std::printf("  %s, colour %g, seed %llu: %s (%.1f s)\n", kind.name, kind.colour,
                        static_cast<unsigned long long>(seed), found.sentence.c_str(), spent);
            std::fflush(stdout);
        }
        if (!write.empty()) {
            continue;
        }
        const discovery::Interval interval = discovery::wilson_interval(right, seeds);
        std::printf("%s, colour %g: %zu of %zu right or tied (%.2f to %.2f), %zu silent, %zu unknown\n", kind.name,
                    kind.colour, right, seeds, interval.low, interval.high, silent, unknown);
        std::fflush(stdout);
    }
    return 0;
}
