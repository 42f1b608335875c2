// bench_watch false-alarms HOURS [PER_DAY [KIND [SEED]]]: alarms of the watch over simulated hours in which the rig is
// its model, with the interval of their rate, for each kind of noise. Days run side by side, each with its own seed
// (day 1 of the first kind: 1000; SEED is added to all). bench_watch delays [SEEDS]: how long changes that make the
// model's 2 s prediction wrong by 1, 2 and 5 noises take to be seen. bench_watch found [RIGS [SEED]]: alarms in the
// hour after a constant force was found to its error, of a body on its spring and of a free one. bench_watch begin
// [RIGS [SEED]]: how often a fault from the first reading is told in an hour, where there is one and where not.
// bench_watch speed: readings a second at 1 kHz, and memory.
#include <sys/resource.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <numeric>
#include <vector>

#include "tests/support/watched_rig.h"

namespace {

namespace dynamics = underbody::dynamics;
using underbody::discovery::Watch;
using underbody::test::WatchedRig;

struct Kind {
    const char* name;
    std::function<void(WatchedRig&)> set;
};

const std::vector<Kind>& kinds() {
    static const std::vector<Kind> all{{"white noise", [](WatchedRig&) {}},
                                       {"coloured noise (AR 0.9)", [](WatchedRig& rig) { rig.colour = 0.9; }},
                                       {"white, 1 % wild, 5 % lost",
                                        [](WatchedRig& rig) {
                                            rig.wild = 0.01;
                                            rig.lost = 0.05;
                                        }},
                                       {"AR 0.9, 1 % wild, 5 % lost",
                                        [](WatchedRig& rig) {
                                            rig.colour = 0.9;
                                            rig.wild = 0.01;
                                            rig.lost = 0.05;
                                        }},
                                       {"AR 0.7 and gusts",
                                        [](WatchedRig& rig) {
                                            rig.colour = 0.7;
                                            rig.disturbance = 0.002;
                                        }},
                                       {"AR 0.9, 2 % of the rows lost",
                                        [](WatchedRig& rig) {
                                            rig.colour = 0.9;
                                            rig.lost_rows = 0.02;
                                        }},
                                       {"white, 1 % wild, 0.5 % of the fields text",
                                        [](WatchedRig& rig) {
                                            rig.wild = 0.01;
                                            rig.text = 0.005;
                                        }},
                                       {"AR 0.9, 1 % wild, 0.5 % of the fields text", [](WatchedRig& rig) {
                                            rig.colour = 0.9;
                                            rig.wild = 0.01;
                                            rig.text = 0.005;
                                        }}};
    return all;
}

void count_false_alarms(double hours, double per_day, int only, std::size_t seed) {
    const auto days = static_cast<std::size_t>(std::max(1.0, hours / 24));
    const double each = hours / static_cast<double>(days), in_days = hours / 24;
    for (std::size_t k = 0; k < kinds().size(); ++k) {
        if (only > 0 && k + 1 != static_cast<std::size_t>(only)) {
            continue;
        }
        std::vector<int> alarms(days, 0);
        tbb::parallel_for(std::size_t{0}, days, [&](std::size_t day) {
            WatchedRig rig(seed + 1000 * (k + 1) + day);
            kinds()[k].set(rig);
            alarms[day] = underbody::test::false_alarms(rig, each, per_day);
        });
        int all = 0;
        for (const int one : alarms) {
            all += one;
        }
        // 95 % interval of a Poisson count (Garwood 1936)
        const auto quantile = [](double degrees, double p) {
            return degrees > 0 ? 0.5 * boost::math::quantile(boost::math::chi_squared(degrees), p) : 0.0;
        };
        std::printf(
            "%-28s %g h at 20 Hz: %d false alarms, %.3g a day (95 %%: %.3g to %.3g), stated %g; on %zu days of %zu\n",
            kinds()[k].name, hours, all, all / in_days, quantile(2.0 * all, 0.025) / in_days,
            quantile(2.0 * all + 2, 0.975) / in_days, per_day,
            static_cast<std::size_t>(std::count_if(alarms.begin(), alarms.end(), [](int n) { return n > 0; })), days);
        std::fflush(stdout);
    }
}

using Change = std::function<void(WatchedRig&, double)>;

/// Root mean square over windows of 2 s of what a change of this size does to the gap under the same inputs.
double apart(const Change& change, double size) {
    WatchedRig rig(77);
    rig.noise = 1e-9;
    double sum = 0;
    int count = 0;
    for (int window = 0; window < 300; ++window) {
        WatchedRig other = rig;
        change(other, size);
        for (int i = 0; i < 40; ++i) {
            rig.advance();
            other.advance();
            other.input = rig.input;
            sum += (rig.reading - other.reading) * (rig.reading - other.reading);
            ++count;
        }
    }
    return std::sqrt(sum / count);
}

double size_of(const Change& change, double wanted) {
    double size = 1e-3;
    for (int i = 0; i < 6; ++i) {
        size *= wanted / apart(change, size);
    }
    return size;
}

void measure_delays(std::uint64_t seeds) {
    const std::vector<std::pair<const char*, Change>> changes{
        {"constant force", [](WatchedRig& rig, double size) { rig.force = size; }},
        {"friction", [](WatchedRig& rig, double size) { rig.friction = size; }},
        {"input gain", [](WatchedRig& rig, double size) { rig.gain = 1 - size; }},
        {"damping", [](WatchedRig& rig, double size) { rig.more_damping = size; }}};
    for (const auto& [name, change] : changes) {
        for (const double colour : {0.0, 0.9}) {
            for (const double noises : {1.0, 2.0, 5.0}) {
                const double size = size_of(change, noises * 2e-4);
                std::vector<double> found(seeds, 0);
                tbb::parallel_for(std::size_t{0}, found.size(), [&, &effect = change](std::size_t i) {
                    WatchedRig rig(i + 1);
                    rig.colour = colour;
                    Watch watch(WatchedRig::model(), {});
                    const double begin = 300;
                    bool seen = false;
                    while (!seen && rig.time < begin + 1800) {
                        if (rig.time >= begin) {
                            effect(rig, size);
                        }
                        seen = rig.show(watch).has_value();
                    }
                    found[i] = seen ? rig.time - begin : 1e9;
                });
                const auto before = std::count_if(found.begin(), found.end(), [](double t) { return t < 0; });
                const auto never = std::count_if(found.begin(), found.end(), [](double t) { return t > 1e8; });
                std::sort(found.begin(), found.end());
                std::printf(
                    "%-15s noise AR %.1f, %g noises (%.3g): median %.0f s, slowest %.0f s; before %td, not "
                    "within half an hour %td of %zu\n",
                    name, colour, noises, size, found[found.size() / 2], found.back() > 1e8 ? NAN : found.back(),
                    before, never, found.size());
                std::fflush(stdout);
            }
        }
    }
}

/// Alarms in an hour with a number that is off by its error, which the model states or not.
int alarms_after_found(WatchedRig rig, double off, bool stated) {
    constexpr double change = 300, force = 1e-3, sigma = 6e-5;  // s, N
    const dynamics::Model declared =
        rig.spring > 0
            ? WatchedRig::model()
            : dynamics::read_model_text(
                  "[vehicle]\nmass = 4\nnet_weight = 0\n[drag.heave]\nlinear = 0.5\nquadratic = 0\n", "free.toml", ".");
    Watch watch(declared, {});
    int alarms = 0;
    bool found = false;
    while (rig.time < change + 60 + 3600) {
        rig.force = rig.time > change ? force : 0;
        const bool alarm = rig.show(watch).has_value();
        if (!found && rig.time > change + 60) {
            found = true;
            dynamics::EffectUse use = dynamics::make_use("constant_force", {{"force", force + off * sigma}});
            use.sigmas = {stated ? sigma : 0};
            watch.go_on_with(declared.with_effect(use), 60);
        } else if (found && alarm) {
            ++alarms;
            watch.reset();
        }
    }
    return alarms;
}

void count_after_found(std::size_t rigs, std::size_t seed) {
    for (const double spring : {WatchedRig::stiffness, 0.0}) {
        for (const double colour : {0.0, 0.9}) {
            for (const bool stated : {false, true}) {
                std::vector<int> alarms(rigs, 0);
                tbb::parallel_for(std::size_t{0}, rigs, [&](std::size_t i) {
                    underbody::core::Random random(seed + i);
                    WatchedRig rig(seed + i);
                    rig.spring = spring;
                    rig.colour = colour;
                    alarms[i] = alarms_after_found(rig, random.normal(), stated);
                });
                std::printf("%s, noise AR %.1f, error of the number %s: %d alarms in %zu h, on %td rigs of %zu\n",
                            spring > 0 ? "spring" : "free body", colour, stated ? "stated" : "unsaid",
                            std::accumulate(alarms.begin(), alarms.end(), 0), rigs,
                            std::count_if(alarms.begin(), alarms.end(), [](int n) { return n > 0; }), rigs);
                std::fflush(stdout);
            }
        }
    }
}

/// What is said of rigs that are wrong, or not, from the first reading.
void count_from_the_begin(std::size_t rigs, std::size_t seed) {
    for (const auto& [name, force] : std::vector<std::pair<const char*, double>>{
             {"nothing is missing", 0}, {"20 to 50 mN from the first reading", 0.02}}) {
        for (const double colour : {0.0, 0.9}) {
            for (const bool declared : {true, false}) {
                std::vector<int> told(rigs, 0), as_force(rigs, 0), alarms(rigs, 0);
                tbb::parallel_for(std::size_t{0}, rigs, [&, missing = force](std::size_t i) {
                    WatchedRig rig(seed + i);
                    rig.colour = colour;
                    rig.force =
                        missing *
                        (1 + 1.5 * static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(rigs - 1, 1))) *
                        (i % 2 == 0 ? 1 : -1);
                    underbody::discovery::WatchOptions options;
                    if (declared) {
                        options.noise["gap"] = rig.noise;
                    }
                    Watch watch(WatchedRig::model(), options);
                    while (rig.time < 3600 && !watch.fault()) {
                        if (rig.show(watch)) {
                            ++alarms[i];
                            watch.reset();
                        }
                    }
                    if (const auto& fault = watch.fault()) {
                        told[i] = rig.time < 300 ? 1 : 2;
                        as_force[i] = fault->shows.rfind("a constant force", 0) == 0 && fault->force * rig.force > 0;
                    }
                });
                const auto count = [](const std::vector<int>& of, int least) {
                    return std::count_if(of.begin(), of.end(), [&](int n) { return n >= least; });
                };
                std::printf(
                    "%s, noise AR %.1f, %s: told in %td of %zu (%td after 5 min), %td as a constant force; "
                    "alarms on %td\n",
                    name, colour, declared ? "declared" : "no figure", count(told, 1), rigs, count(told, 2),
                    count(as_force, 1), count(alarms, 1));
                std::fflush(stdout);
            }
        }
    }
}

void measure_speed() {
    WatchedRig rig(5);
    rig.step = 1e-3;
    std::vector<std::array<double, 3>> rows;
    for (int i = 0; i < 1800000; ++i) {
        rig.advance();
        rows.push_back({rig.time, rig.reading, rig.input});
    }
    rusage before{}, after{};
    getrusage(RUSAGE_SELF, &before);
    Watch watch(WatchedRig::model(), {});
    const auto begun = std::chrono::steady_clock::now();
    double slowest = 0;
    for (const auto& [time, gap, input] : rows) {
        const auto at = std::chrono::steady_clock::now();
        watch.gap(time, gap);
        watch.input(time, input);
        slowest = std::max(slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - at).count());
    }
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    getrusage(RUSAGE_SELF, &after);
    std::printf(
        "half an hour at 1 kHz: %.3g million readings a second on one core, longest pause %.2f s, %ld MB more\n",
        1e-6 * static_cast<double>(rows.size()) / took, slowest, (after.ru_maxrss - before.ru_maxrss) / 1024);
}

}  // namespace

int main(int argc, char** argv) {
    const auto given = [&](int i, double otherwise) { return argc > i ? std::atof(argv[i]) : otherwise; };
    if (argc > 1 && std::strcmp(argv[1], "delays") == 0) {
        measure_delays(static_cast<std::uint64_t>(given(2, 10)));
    } else if (argc > 1 && std::strcmp(argv[1], "found") == 0) {
        count_after_found(static_cast<std::size_t>(given(2, 20)), static_cast<std::size_t>(given(3, 1)));
    } else if (argc > 1 && std::strcmp(argv[1], "begin") == 0) {
        count_from_the_begin(static_cast<std::size_t>(given(2, 20)), static_cast<std::size_t>(given(3, 1)));
    } else if (argc > 1 && std::strcmp(argv[1], "speed") == 0) {
        measure_speed();
    } else if (argc > 1 && std::strcmp(argv[1], "false-alarms") == 0) {
        count_false_alarms(given(2, 24), given(3, 1), static_cast<int>(given(4, 0)),
                           static_cast<std::size_t>(given(5, 0)));
    } else {
        std::fprintf(stderr,
                     "bench_watch false-alarms HOURS [PER_DAY [KIND [SEED]]] | delays [SEEDS] | found [RIGS [SEED]] | "
                     "begin [RIGS [SEED]] | speed\n");
        return 2;
    }
    return 0;
}
