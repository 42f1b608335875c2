#include "surrogates/dynamics/simulate/doubtful_clock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "core/text.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/read_records.h"

namespace underbody::dynamics {

namespace {

/// The readings of a run that has its own plant.
struct ClockRun {
    HeavePlant plant;
    std::vector<double> time, gap, input;
};

ClockRun clock_run(const Model& model, const MeasuredRun& run) {
    constexpr std::size_t most = 2000;  // readings
    InputSignals signals = signals_of(run);
    for (const InputSignals::Signal& one : signals.signals) {
        if (one.channel != Channel::input_force) {  // what varies is held at its mean
            signals.held[one.channel] =
                std::accumulate(one.values.begin(), one.values.end(), 0.0) / static_cast<double>(one.values.size());
        }
    }
    ClockRun all{HeavePlant(model, signals.held), {}, {}, {}};
    const std::vector<double> gap = run.values("gap"), pushed = run.values("input_force");
    const std::vector<double>& time = run.table.numbers("time");
    double input = all.plant.held_input();
    for (std::size_t i = 0; i < time.size() && all.time.size() < most; ++i) {
        if (!pushed.empty() && std::isfinite(pushed[i])) {
            input = all.plant.terms.actuator.felt(pushed[i]);
        }
        if (std::isfinite(gap[i])) {
            all.time.push_back(time[i]);
            all.gap.push_back(gap[i]);
            all.input.push_back(input);
        }
    }
    return all;
}

/// Sums of squares over windows: of the recorded accelerations, the model's, and their difference.
struct Misfit {
    double recorded = 0, of_model = 0, apart = 0;
    /// 0: they agree; 1: one of them is nothing beside the other.
    [[nodiscard]] double share() const { return recorded + of_model > 0 ? apart / (recorded + of_model) : 1; }
};

/// Adds the windows of `count` readings of a run whose times are `factor` times the recorded ones.
void add_windows(const ClockRun& run, std::size_t count, double factor, Misfit& sum) {
    using std::numbers::pi;
    HeaveMoment moment = run.plant.held_moment();
    const std::size_t arm = std::max<std::size_t>(1, count / 20);
    for (std::size_t first = 0; first + count <= run.time.size(); first += count / 2) {
        const std::size_t last = first + count - 1;
        const double lasted = run.time[last] - run.time[first];
        double recorded = 0, of_model = 0;
        for (std::size_t i = first; i <= last; ++i) {
            const double s = (run.time[i] - run.time[first]) / lasted, sine = std::sin(pi * s);
            const std::size_t before = std::max(first, i - std::min(i, arm)), after = std::min(last, i + arm);
            const double share =
                0.5 * (run.time[std::min(last, i + 1)] - run.time[std::max(first + 1, i) - 1]) / lasted;
            const double rate = (run.gap[after] - run.gap[before]) / (run.time[after] - run.time[before]);
            // the weight sin^4 and its second derivative
            const double weight = std::pow(sine, 4), bent = 4 * pi * pi * (3 * sine * sine - 4 * std::pow(sine, 4));
            moment.t = run.time[i] * factor;
            moment.input = run.input[i];
            recorded += share * bent * (run.gap[i] - run.gap[first]) / (lasted * lasted * factor * factor);
            of_model += share * weight * run.plant.acceleration(run.gap[i], rate / factor, moment);
        }
        if (std::isfinite(recorded) && std::isfinite(of_model)) {
            sum.recorded += recorded * recorded;
            sum.of_model += of_model * of_model;
            sum.apart += (recorded - of_model) * (recorded - of_model);
        }
    }
}

/// The least share over windows of several lengths: short ones see fast motion, long ones through noise.
double misfit(const std::vector<ClockRun>& runs, double factor) {
    double least = 1;
    for (const std::size_t count : {20U, 60U, 200U}) {
        Misfit sum;
        for (const ClockRun& run : runs) {
            add_windows(run, count, factor, sum);
        }
        least = std::min(least, sum.share());
    }
    return least;
}

}  // namespace

std::optional<core::Problem> doubtful_clock(const Model& model, const Measurements& data) {
    struct Mistake {
        double factor;  ///< of the recorded times
        const char *meant, *headed;
    };
    constexpr std::array mistakes = {
        Mistake{1.0 / 60, "s", "min"}, Mistake{1.0 / 3600, "s", "h"}, Mistake{1e3, "s", "ms"}, Mistake{1e6, "s", "us"},
        Mistake{1e-3, "ms", "s"},      Mistake{1e-6, "us", "s"},      Mistake{60, "min", "s"}};
    constexpr double foreign = 0.8, fits = 0.35;
    constexpr std::size_t most_runs = 10;
    std::vector<ClockRun> runs;
    for (const MeasuredRun& run : data.runs) {
        const bool heaves = run.has("gap") && empty_text(run, "gap").empty();  // one on the ground has no gap
        if (runs.size() < most_runs && run.table.rows() > 0 && heaves) {
            runs.push_back(clock_run(model, run));
        }
    }
    if (!(misfit(runs, 1) > foreign)) {
        return {};
    }
    for (const Mistake& one : mistakes) {
        if (misfit(runs, one.factor) < fits) {
            const double times = std::max(one.factor, 1 / one.factor);
            return core::Problem{core::Problem::Severity::warning,
                                 "the model's forces move a body as recorded only if the times are " +
                                     core::format_number(times, 4) + " times " +
                                     (one.factor < 1 ? "shorter" : "longer") + ": is time in " + one.meant +
                                     ", and headed [" + one.headed + "]?",
                                 {data.runs.front().table.source, {}, {}, {}}};
        }
    }
    return {};
}

}  // namespace underbody::dynamics
