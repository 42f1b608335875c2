// The bench of a coupled motion: simulated rigs with a controller fed the noisy reading, and what discover() says.
#pragma once

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/normal.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/simulate/predict.h"

namespace underbody::bench {

template <typename Rig>
struct Kind {
    const char* name;  ///< what a verdict should say; "none": nothing
    double colour;     ///< of the noise
    void (*change)(Rig& rig);
    /// Of what is no effect with the kind's name.
    bool (*right)(const discovery::Discovery& found) = nullptr;
};

/// Largest error of a channel over 2 s, in its noise.
inline double worst_in_noise(const dynamics::Model& model, const dynamics::Measurements& data) {
    double worst = 0;
    for (const dynamics::ChannelError& channel : dynamics::predict(model, data).channels) {
        worst = std::max(worst, channel.in_noise);
    }
    return worst;
}

/// The model as written and read again.
inline dynamics::Model written(const dynamics::Model& model) {
    const core::TemporaryFolder folder("bench-motion");
    dynamics::write_model(model, folder.path() / "model.toml");
    return dynamics::read_model(folder.path() / "model.toml");
}

struct MotionOptions {
    std::size_t seeds = 1;
    std::uint64_t first = 30000;
    std::string only, write, verdicts;
    double colour = -1, seconds = 20;
    bool experiments = false;  ///< what is promised of the next experiment is carried out
    bool understood = true;
};

inline MotionOptions motion_options(int argc, char** argv) {
    MotionOptions options;
    for (int i = 1; i + 1 < argc; i += 2) {
        const std::string name = argv[i], value = argv[i + 1];
        if (name == "--seeds") {
            options.seeds = std::stoul(value);
        } else if (name == "--first-seed") {
            options.first = std::stoull(value);
        } else if (name == "--kind") {
            options.only = value;
        } else if (name == "--colour") {
            options.colour = std::stod(value);
        } else if (name == "--seconds") {
            options.seconds = std::stod(value);
        } else if (name == "--experiments") {
            options.experiments = value == "yes";
        } else if (name == "--write") {
            options.write = value;
        } else {
            std::fprintf(stderr,
                         "%s [--kind NAME] [--colour C] [--first-seed N] [--seeds N] [--seconds S] [--write FOLDER] "
                         "[--experiments yes]\n",
                         argv[0]);
            options.understood = false;
        }
    }
    return options;
}

/// `runs(rig, seed)` makes a data set, `write(data, folder, kind)` puts it into files.
template <typename Rig, typename Runs, typename Write>
int judge(const std::vector<Kind<Rig>>& kinds, const dynamics::Model& model, const MotionOptions& asked,
          const Runs& runs, const Write& write) {
    for (const Kind<Rig>& kind : kinds) {
        if ((!asked.only.empty() && asked.only != kind.name) || (asked.colour >= 0 && kind.colour != asked.colour)) {
            continue;
        }
        std::size_t right = 0, tied = 0, silent = 0, unknown = 0, worse = 0;
        for (std::uint64_t seed = asked.first; seed < asked.first + asked.seeds; ++seed) {
            Rig rig;
            rig.seconds = asked.seconds;
            rig.colour = kind.colour;
            kind.change(rig);
            const dynamics::Measurements data = runs(rig, seed);
            if (!asked.write.empty()) {
                write(data, std::filesystem::path(asked.write) / (std::string(kind.name) + "-" + std::to_string(seed)),
                      kind.name);
                continue;
            }
            discovery::DiscoverOptions options;
            options.consequence = options.figures = false;
            const std::clock_t begin = std::clock();
            const discovery::Discovery found = discovery::discover(model, data, options);
            const double spent = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
            const bool named =
                found.verdict == "effect" && found.effects.size() == 1 && found.effects.front().name == kind.name;
            bool beside = false;
            for (const discovery::FoundEffect& rival : found.alternatives) {
                beside = beside || (found.verdict == "effect" && rival.name == kind.name && rival.probability > 0.2);
            }
            const bool none = found.verdict == "none";
            const bool own = kind.right != nullptr ? kind.right(found)
                                                   : named || beside || (none && std::strcmp(kind.name, "none") == 0);
            right += own ? 1 : 0;
            tied += beside ? 1 : 0;
            silent += none ? 1 : 0;
            unknown += found.verdict == "unknown" ? 1 : 0;
            if constexpr (requires { rig.gain; }) {
                rig.gain = 1.3;  // fresh runs have another controller and other starts
            }
            const dynamics::Measurements fresh = runs(rig, seed + 1000000);
            const double before = worst_in_noise(model, fresh), after = worst_in_noise(written(found.model), fresh);
            worse += after > 1.05 * before ? 1 : 0;
            std::printf("  %s, colour %g, seed %llu: %s%s (%.1f s; fresh runs %.3g to %.3g noises)\n", kind.name,
                        kind.colour, static_cast<unsigned long long>(seed),
                        own ? "" : "NOT RIGHT: ", found.sentence.c_str(), spent, before, after);
            std::fflush(stdout);
        }
        if (!asked.write.empty()) {
            continue;
        }
        const core::Interval interval =
            core::wilson_interval(static_cast<double>(right), static_cast<double>(asked.seeds));
        std::printf(
            "%s, colour %g: %zu of %zu right or tied (%.2f to %.2f), %zu tied, %zu silent, %zu unknown, fresh runs "
            "worse "
            "in %zu\n",
            kind.name, kind.colour, right, asked.seeds, interval.low, interval.high, tied, silent, unknown, worse);
        std::fflush(stdout);
    }
    return 0;
}

}  // namespace underbody::bench
