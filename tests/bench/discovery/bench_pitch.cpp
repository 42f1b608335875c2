// The bench of heave with pitch.
#include <array>
#include <cmath>

#include "bench_motion.h"
#include "tests/surrogates/discovery/pitch_rig.h"
#include "tests/surrogates/discovery/write_runs.h"

using namespace underbody;

namespace {

using discovery::Discovery;

bool moved(const Discovery& found, double seconds) {
    const dynamics::RecordReading& records = found.model.records;
    return std::abs(records.input_advance - seconds) < 0.02 && std::abs(records.others_advance - seconds) < 0.02 &&
           records.input_factor == 1 && records.factors.empty();
}

/// Of these inputs alone.
bool turned(const Discovery& found, double force, double moment) {
    const dynamics::RecordReading& records = found.model.records;
    return found.verdict == "none" && records.input_advance == 0 && records.others_advance == 0 &&
           records.factor_of("input_force") == force && records.factor_of("input_moment") == moment;
}

const std::vector<bench::Kind<test::PitchRig>> kinds{
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
    {"late input", 0.9, [](test::PitchRig& rig) { rig.late = 5; },
     [](const Discovery& found) { return found.verdict == "none" && moved(found, 0.2); }},
    {"input late by a row", 0.9, [](test::PitchRig& rig) { rig.late = 1; },
     [](const Discovery& found) { return found.verdict == "none" && moved(found, 0.04); }},
    {"late input and linear_damping", 0,
     [](test::PitchRig& rig) {
         rig.late = 5;
         rig.force = [](const test::PitchMoment& now) { return -0.3 * now.rise; };
     },
     [](const Discovery& found) {
         return found.verdict == "effect" && found.effects.size() == 1 &&
                found.effects.front().name == "linear_damping" && moved(found, 0.2);
     }},
    {"turned force", 0, [](test::PitchRig& rig) { rig.logged_force = -1; },
     [](const Discovery& found) { return turned(found, -1, 1); }},
    {"turned moment", 0, [](test::PitchRig& rig) { rig.logged_moment = -1; },
     [](const Discovery& found) { return turned(found, 1, -1); }},
    {"zero by run", 0.9,
     [](test::PitchRig& rig) {
         rig.zero = [](std::size_t run) { return std::array{4e-3, -4e-3, 3e-3, -3e-3, 5e-3, -5e-3}[run % 6]; };
     },
     [](const Discovery& found) { return found.verdict == "unknown" && found.by_run.has_value(); }},
    {"periodic_disturbance", 0.9,
     [](test::PitchRig& rig) {
         rig.force = [](const test::PitchMoment& now) { return 4e-3 * std::sin(6.283185 * 0.37 * now.t + 1); };
     }},
};

/// Weak effects, whose name or presence a few short runs leave open.
struct Weak {
    const char* name;
    void (*change)(test::PitchRig& rig, double strength);
};
const std::vector<Weak> weak{
    {"pitch_stiffness",
     [](test::PitchRig& rig, double s) {
         rig.moment = [s](const test::PitchMoment& now) { return -7e-4 * s * std::sin(now.pitch); };
     }},
    {"linear_damping",
     [](test::PitchRig& rig, double s) {
         rig.force = [s](const test::PitchMoment& now) { return -0.08 * s * now.rise; };
     }},
    {"pitch_damping",
     [](test::PitchRig& rig, double s) {
         rig.moment = [s](const test::PitchMoment& now) { return -4e-4 * s * now.rate; };
     }},
    {"added_pitch_inertia", [](test::PitchRig& rig, double s) { rig.added_inertia = 3e-4 * s; }},
    {"input_arm",
     [](test::PitchRig& rig, double s) {
         rig.moment = [s](const test::PitchMoment& now) { return 1e-3 * s * std::cos(now.pitch) * now.input; };
     }},
};

double odds(double one, double other) { return one / std::max(other, 1e-12); }

double probability_of(const Discovery& found, const std::string& name) {
    for (const auto* list : {&found.effects, &found.alternatives}) {
        for (const discovery::FoundEffect& effect : *list) {
            if (effect.name == name) {
                return effect.probability;
            }
        }
    }
    return 0;
}

/// The two explanations that the next experiment is to tell apart; the second may be "none".
std::array<std::string, 2> asked_apart(const Discovery& found) {
    const std::string& text = found.next_experiment;
    const auto between = [&](const std::string& from, const std::string& to) {
        const std::size_t begin = text.find(from), end = text.find(to, begin);
        return begin == std::string::npos || end == std::string::npos
                   ? std::string()
                   : text.substr(begin + from.size(), end - begin - from.size());
    };
    if (text.rfind("to tell ", 0) == 0) {
        return {between("to tell ", " from "), between(" from ", ": ")};
    }
    return {text.rfind("to see the law", 0) == 0 ? ""
            : text.rfind("to confirm ", 0) == 0  ? between("to confirm ", ": ")
                                                 : between("to see ", " below"),
            "none"};
}

/// Carries out what each verdict on a weak effect promises: the run that it says, four times, with the same controller
/// and set points, the wave added and fresh noise.
int carry_out(const dynamics::Model& model, const bench::MotionOptions& asked) {
    discovery::DiscoverOptions options;
    options.consequence = options.figures = false;
    double promised = 0, promised_spread = 0;
    std::size_t done = 0, settled = 0, wrong = 0;
    for (std::uint64_t seed = asked.first; seed < asked.first + asked.seeds; ++seed) {
        const Weak& kind = weak[seed % weak.size()];
        test::PitchRig rig;
        rig.seconds = asked.seconds;
        rig.colour = asked.colour >= 0 ? asked.colour : seed / weak.size() % 2 == 0 ? 0 : 0.9;
        kind.change(rig, 0.4 + 0.3 * static_cast<double>(seed / weak.size() % 5));
        dynamics::Measurements data = test::pitch_rig_runs(rig, 5, seed);
        const std::clock_t begin = std::clock();
        const Discovery before = discovery::discover(model, data, options);
        const double spent = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        const std::array<std::string, 2> pair = asked_apart(before);
        const bool among = pair[0] == kind.name || pair[1] == kind.name;
        std::printf("  %s, seed %llu: %s %.2f, asked %s from %s, promised %.3f (%.1f s)%s\n", kind.name,
                    static_cast<unsigned long long>(seed), before.verdict.c_str(),
                    before.effects.empty() ? 0 : before.effects.front().probability, pair[0].c_str(), pair[1].c_str(),
                    before.next_power, spent, among ? "" : ": not what is there");
        std::fflush(stdout);
        if (!among || before.next_set_points.columns().size() < 2) {
            continue;
        }
        const core::Column& added = before.next_set_points.columns().back();
        const auto wave = [&](double t) {
            const auto row = static_cast<std::size_t>(std::lround(t * rig.frequency));
            return added.numbers[std::min(row, added.numbers.size() - 1)];
        };
        (added.name == "input_force" ? rig.added_force : rig.added_moment) = wave;
        core::Random order(seed);
        const std::size_t place = before.next_experiment.find("run-");
        const std::size_t run = std::stoul(before.next_experiment.substr(place + 4)) - 1;
        for (std::uint64_t repeat = 0; repeat < 4; ++repeat) {
            rig.again = 10 * seed + repeat;
            dynamics::MeasuredRun once = test::pitch_rig_runs(rig, static_cast<int>(run) + 1, seed).runs.back();
            once.name = "again-" + std::to_string(repeat + 1);
            once.table.source = once.name + ".csv";
            // which runs are held out goes by their order, which is anybody's
            data.runs.insert(data.runs.begin() + static_cast<std::ptrdiff_t>(order.below(data.runs.size() + 1)),
                             std::move(once));
        }
        const Discovery after = discovery::discover(model, data, options);
        const std::string other = pair[pair[0] == kind.name ? 1 : 0];
        const auto chance = [&](const std::string& name) {
            return name == "none" ? after.none_probability : probability_of(after, name);
        };
        const bool own = after.verdict == "effect" && odds(chance(kind.name), chance(other)) >= 20;
        const bool for_other = odds(chance(other), chance(kind.name)) >= 20;
        ++done;
        settled += own ? 1 : 0;
        wrong += for_other ? 1 : 0;
        promised += before.next_power;
        promised_spread += before.next_power * (1 - before.next_power);
        std::printf("    %s%s: %s %.3g to %.3g; %s\n", own ? "settled" : "open", for_other ? ", FOR THE OTHER" : "",
                    after.verdict.c_str(), chance(kind.name), chance(other), after.sentence.c_str());
        std::printf("    %s\n", before.next_experiment.c_str());
        std::fflush(stdout);
    }
    const core::Interval interval =
        core::wilson_interval(static_cast<double>(settled), static_cast<double>(std::max<std::size_t>(done, 1)));
    std::printf("%zu experiments: promised %.1f +- %.1f, settled %zu (%.2f to %.2f of all), for the other %zu\n", done,
                promised, std::sqrt(promised_spread), settled, interval.low, interval.high, wrong);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const bench::MotionOptions asked = bench::motion_options(argc, argv);
    if (!asked.understood) {
        return 2;
    }
    const core::TemporaryFolder folder("bench-pitch");
    if (asked.experiments) {
        return carry_out(test::pitch_rig_model(folder.path()), asked);
    }
    return bench::judge(
        kinds, test::pitch_rig_model(folder.path()), asked,
        [](const test::PitchRig& rig, std::uint64_t seed) { return test::pitch_rig_runs(rig, 6, seed); },
        [](const dynamics::Measurements& data, const std::filesystem::path& where, const char* kind) {
            test::write_runs(data, where / "runs", "heave_pitch", kind);
            test::pitch_rig_model(where);
        });
}
