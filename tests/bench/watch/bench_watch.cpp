// bench_watch HOURS [PER_DAY [COLOUR [DISTURBANCE [RATE]]]]: false alarms of the watch over simulated hours in which
// the rig is its model, with the interval of their rate; then how long changes take to be seen. Days of 24 hours run
// side by side, each with its own seed (day 1 -> seed 1000).
#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "surrogates/discovery/watch/watch.h"
#include "tests/support/watched_rig.h"

namespace {

using underbody::discovery::Watch;
using underbody::discovery::WatchOptions;
using underbody::test::WatchedRig;

int alarms_in(WatchedRig rig, double hours, double per_day) {
    WatchOptions options;
    options.false_alarms_per_day = per_day;
    Watch watch(WatchedRig::model(), options);
    int alarms = 0;
    while (rig.time < 3600 * hours) {
        rig.advance();
        if (watch.gap(rig.time, rig.reading)) {
            ++alarms;
            watch.reset();
        }
        watch.input(rig.time, rig.input);
    }
    return alarms;
}

template <typename Change>
void delays(const char* name, double step, Change&& change) {
    std::vector<double> found;
    int before = 0, never = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        WatchedRig rig(seed);
        rig.step = step;
        Watch watch(WatchedRig::model(), {});
        bool seen = false;
        while (!seen && rig.time < 4200) {
            if (rig.time >= 600) {
                change(rig);
            }
            rig.advance();
            seen = watch.gap(rig.time, rig.reading).has_value();
            watch.input(rig.time, rig.input);
        }
        if (!seen) {
            ++never;
        } else if (rig.time < 600) {
            ++before;
        } else {
            found.push_back(rig.time - 600);
        }
    }
    std::sort(found.begin(), found.end());
    std::printf("%-34s median %7.1f s, slowest %7.1f s, not within an hour %d, before the change %d (of 20)\n", name,
                found.empty() ? 0.0 : found[found.size() / 2], found.empty() ? 0.0 : found.back(), never, before);
}

}  // namespace

int main(int argc, char** argv) {
    const auto given = [&](int i, double otherwise) { return argc > i ? std::atof(argv[i]) : otherwise; };
    const double hours = given(1, 24), per_day = given(2, 1), rate = given(5, 20);
    const auto days = static_cast<std::size_t>(std::max(1.0, hours / 24));
    const double each = hours / static_cast<double>(days);
    std::vector<int> alarms(days, 0);
    const auto begun = std::chrono::steady_clock::now();
    tbb::parallel_for(std::size_t{0}, days, [&](std::size_t day) {
        WatchedRig rig(1000 + day);
        rig.step = 1 / rate;
        rig.colour = given(3, 0);
        rig.disturbance = given(4, 0);
        alarms[day] = alarms_in(rig, each, per_day);
    });
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    int all = 0;
    for (const int one : alarms) {
        all += one;
    }
    // 95 % interval of a Poisson count (Garwood 1936)
    const auto quantile = [](double degrees, double p) {
        return degrees > 0 ? 0.5 * boost::math::quantile(boost::math::chi_squared(degrees), p) : 0.0;
    };
    const double in_days = hours / 24;
    std::printf(
        "%g hours at %g Hz, colour %g, disturbance %g: %d false alarms, %.3g a day (95 %%: %.3g to %.3g); stated "
        "at most %g; %.3g million readings a second\n",
        hours, rate, given(3, 0), given(4, 0), all, all / in_days, quantile(2.0 * all, 0.025) / in_days,
        quantile(2.0 * all + 2, 0.975) / in_days, per_day, hours * 3600 * rate / took / 1e6);
    delays("constant force of 4 mN", 1 / rate, [](WatchedRig& rig) { rig.force = 0.004; });
    delays("friction of 4 mN", 1 / rate, [](WatchedRig& rig) { rig.friction = 0.004; });
    delays("input gain 0.9", 1 / rate, [](WatchedRig& rig) { rig.gain = 0.9; });
    delays("damping more by 0.2 N s/m", 1 / rate, [](WatchedRig& rig) { rig.more_damping = 0.2; });
    delays("noise half as large again", 1 / rate, [](WatchedRig& rig) { rig.noise = 3e-4; });
    return 0;
}
