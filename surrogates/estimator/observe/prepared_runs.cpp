#include "surrogates/estimator/observe/prepared_runs.h"

#include <algorithm>
#include <cmath>

#include "core/counted.h"
#include "core/quantile.h"
#include "core/text.h"
#include "surrogates/dynamics/model/taken_as_zero.h"
#include "surrogates/dynamics/simulate/clean_readings.h"
#include "surrogates/dynamics/simulate/declared_noise.h"
#include "surrogates/dynamics/simulate/doubtful_clock.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/dynamics/simulate/read_records.h"

namespace underbody::estimator {

namespace internal {

void note(core::Problems& problems, const std::string& text) {
    problems.push_back({core::Problem::Severity::warning, text, {}});
}

namespace {

// Plant at a run's conditions; channels that vary within the run are held at their mean.
SeparatedPlant plant_of(const dynamics::Model& model, const dynamics::RecordReading& records,
                        const dynamics::MeasuredRun& run, core::Problems& remarks) {
    const dynamics::InputSignals signals = dynamics::signals_of(run, records);
    dynamics::Conditions held = signals.held;
    for (const auto& signal : signals.signals) {
        if (signal.channel == dynamics::Channel::input_force) {
            continue;
        }
        double sum = 0, n = 0;
        for (const double v : signal.values) {
            sum += std::isfinite(v) ? v : 0;
            n += std::isfinite(v) ? 1 : 0;
        }
        held[signal.channel] = sum / n;
        note(remarks, "run '" + run.name + "': " + dynamics::channel_name(signal.channel) +
                          " varies; the force table is taken at its mean and the departure carries the rest");
    }
    SeparatedPlant plant = separate(model, held);
    plant.actuator.delay -= records.input_advance;
    if (held.has(dynamics::Channel::input_force) && !run.table.find("input_force")) {
        plant.bias += plant.actuator.felt(held[dynamics::Channel::input_force]);
    }
    return plant;
}

/// Given, declared, or what the readings scatter by where nothing is declared or they contradict it, as in predictions
/// and discovery; 0 where nothing says it.
double noise_of_channel(const dynamics::Model& model, const dynamics::Measurements& data, const std::string& channel,
                        double given, bool& declared, core::Problems& remarks) {
    declared = true;
    if (given > 0) {
        return given;
    }
    const std::optional<double> stated = data.declared_noise(channel);
    const double scatter = dynamics::scatter_of(model, data, channel);
    if (!stated && !(scatter > 0)) {
        declared = false;
        return 0;
    }
    const dynamics::JudgedNoise judged = dynamics::judged_noise(channel, stated, scatter);
    declared = stated && judged.value == *stated;
    if (!judged.doubt.empty()) {
        note(remarks, judged.doubt);
    }
    return judged.value;
}

}  // namespace

std::vector<Prepared> prepare(const dynamics::Model& model, const dynamics::Measurements& data,
                              core::Problems& remarks) {
    if (data.kind != dynamics::MeasurementKind::time_series) {
        throw core::InputError("kind", "the estimator needs time series; this data set is static",
                               {data.folder.string(), {}, {}, {}}, "static forces are compared by 'underbody predict'");
    }
    if (data.motion == "body") {
        throw core::InputError("motion", "estimates are of heave: these runs are of the whole body, driven by its jets",
                               {data.folder.string(), {}, {}, {}}, "predict and discover follow them");
    }
    const dynamics::InputReading reading = dynamics::input_reading(model, data);
    if (const std::string read = dynamics::reading_text(reading.records); !read.empty()) {
        note(remarks, "logs read as " + read + " (" +
                          (reading.from == "data" ? "the measured motion fits that better" : "the model's [records]") +
                          ")");
    }
    const core::Problems unsaid = dynamics::input_taken_as_zero(model, data);
    remarks.insert(remarks.end(), unsaid.begin(), unsaid.end());
    if (const auto doubt = dynamics::doubtful_clock(model, data)) {
        remarks.push_back(*doubt);
    }
    std::vector<Prepared> all;
    for (const auto& run : data.runs) {
        all.push_back(
            {&run, plant_of(model, reading.records, run, remarks), signals_of_run(run, remarks, reading.records)});
        all.back().signals = through_actuator(all.back().plant, std::move(all.back().signals));
        if (!(range_of(all.back().signals.gap) > 0)) {
            note(remarks, "run '" + run.name + "': the gap does not vary; a dead sensor looks like that");
        }
    }
    if (all.empty()) {
        throw core::InputError("empty", "the data set has no runs", {data.folder.string(), {}, {}, {}});
    }
    for (const auto& r : all.front().plant.remarks) {
        remarks.push_back(r);
    }
    return all;
}

NoiseChoice noise_for(const dynamics::Model& model, const dynamics::Measurements& data, const EstimateOptions& o,
                      const std::vector<Prepared>& runs, core::Problems& remarks) {
    NoiseChoice choice;
    FilterNoise& noise = choice.noise;
    bool declared = false;
    noise.gap = noise_of_channel(model, data, "gap", o.gap_sigma, choice.gap_declared, remarks);
    if (data.all_have("heave_velocity")) {
        noise.velocity = noise_of_channel(model, data, "heave_velocity", o.velocity_sigma, declared, remarks);
    }
    if (!(noise.gap > 0)) {
        double size = 0;
        for (const auto& r : runs) {
            for (const double h : r.signals.gap) {
                size = std::isfinite(h) ? std::max(size, std::abs(h)) : size;
            }
        }
        noise.gap = std::max(1e-6 * size, 1e-9);
        note(remarks,
             "the gap shows no noise; " + core::format_number(noise.gap, 2) + " m is taken for its resolution");
    }
    if (data.all_have("heave_velocity") && !(noise.velocity > 0)) {
        noise.velocity = 1e-6;
        note(remarks, "the heave velocity shows no noise; 1e-6 m/s is taken for its resolution");
    }
    noise.drag_relative = o.drag_relative;
    noise.split_departure = true;
    noise.gate = o.gate;
    noise.force_density = o.force_density;
    if (!(noise.force_density > 0)) {
        std::vector<PlantRun> each;
        for (const auto& r : runs) {
            each.push_back({&r.plant, &r.signals});
        }
        noise.force_density = likely_force_density(each, noise);
        choice.density_chosen = true;
    }
    return choice;
}

}  // namespace internal

using internal::note;

double internal::range_of(const std::vector<double>& values) {
    double lowest = INFINITY, highest = -INFINITY;
    for (const double v : values) {
        lowest = std::isfinite(v) ? std::min(lowest, v) : lowest;
        highest = std::isfinite(v) ? std::max(highest, v) : highest;
    }
    return highest - lowest;
}

RunSignals signals_of_run(const dynamics::MeasuredRun& run, core::Problems& remarks,
                          const dynamics::RecordReading& records) {
    RunSignals s;
    if (!run.has("gap")) {
        throw core::InputError("missing", "run '" + run.name + "' has no gap: estimates are of heave",
                               {run.table.source, {}, {}, {}}, "runs on the ground are for predict and discover");
    }
    s.time = run.table.numbers("time");
    s.gap = run.values("gap");
    s.velocity = dynamics::as_read(run, "heave_velocity", records);
    if (run.table.find("input_force") == nullptr) {
        return s;
    }
    s.input = dynamics::as_read(run, "input_force", records);
    s.held = records.input_between !=
             dynamics::RecordReading::Between::linear;  // as dynamics::predict takes recorded inputs
    if (!std::any_of(s.input.begin(), s.input.end(), [](double u) { return std::isfinite(u); })) {
        throw core::InputError("missing", "every value of input_force is missing", {run.file.string(), {}, {}, {}});
    }
    const std::vector<double> written = run.values("input_force");
    const auto missing = std::count_if(written.begin(), written.end(), [](double u) { return !std::isfinite(u); });
    if (missing > 0) {
        note(remarks,
             "run '" + run.name + "': " +
                 core::counted(missing, "missing value of input_force was ", "missing values of input_force were ") +
                 (s.held ? "held from the one before" : "interpolated"));
    }
    return s;
}

double usual_step(const RunSignals& run) {
    if (run.time.size() < 2) {
        throw core::InputError("few", "a run needs at least two samples");
    }
    return core::usual_step(run.time);
}

namespace {

// Measured values less outliers, by the rule of predictions and discovery.
std::vector<std::size_t> good_samples(const std::vector<double>& time, std::vector<double> values, UniformRun& out) {
    out.missing += static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [](double value) { return !std::isfinite(value); }));
    if (const double noise = dynamics::sensor_noise(time, values); noise > 0) {
        out.outliers += dynamics::drop_outliers(values, noise);
    }
    std::vector<std::size_t> good;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i])) {
            good.push_back(i);
        }
    }
    return good;
}

double between(const std::vector<double>& time, const std::vector<double>& values, std::size_t a, std::size_t b,
               double t) {
    return a == b ? values[a] : values[a] + (values[b] - values[a]) * (t - time[a]) / (time[b] - time[a]);
}

}  // namespace

namespace {

// Slope of the least-squares line through the good gaps within 0.25 s of sample `at`, five at least, of the stretch
// [first, last].
double slope_about(const RunSignals& run, const std::vector<std::size_t>& good, std::size_t at, std::size_t first,
                   std::size_t last) {
    std::size_t low = at, high = at;
    const auto near = [&](std::size_t k) { return std::abs(run.time[good[k]] - run.time[good[at]]) <= 0.25; };
    while (low > first && (near(low - 1) || at - low < 2)) {
        --low;
    }
    while (high < last && (near(high + 1) || high - at < 2)) {
        ++high;
    }
    double n = 0, st = 0, sh = 0, stt = 0, sth = 0;
    for (std::size_t k = low; k <= high; ++k) {
        const double t = run.time[good[k]] - run.time[good[at]], h = run.gap[good[k]];
        n += 1;
        st += t;
        sh += h;
        stt += t * t;
        sth += t * h;
    }
    const double determinant = n * stt - st * st;
    return determinant > 0 ? (n * sth - st * sh) / determinant : 0;
}

}  // namespace

UniformRun uniform(const RunSignals& run, double step) {
    UniformRun out;
    const std::vector<std::size_t> good = good_samples(run.time, run.gap, out);
    if (good.size() < 2) {
        throw core::InputError("few", "a run needs at least two measured gaps");
    }
    for (std::size_t g = 0; g + 1 < good.size();) {
        // A stretch without gaps in time.
        std::size_t end = g;
        while (end + 1 < good.size() && run.time[good[end + 1]] - run.time[good[end]] < 5.5 * step) {
            ++end;
        }
        const double t0 = run.time[good[g]];
        const auto count = static_cast<std::size_t>(std::floor((run.time[good[end]] - t0) / step + 1e-6));
        std::size_t a = g;
        for (std::size_t k = 0; end > g && k <= count; ++k) {
            const double t = t0 + step * static_cast<double>(k);
            while (a + 1 < end && run.time[good[a + 1]] <= t + 1e-9) {
                ++a;
            }
            const std::size_t i = good[a], j = good[std::min(a + 1, end)];
            out.time.push_back(t);
            out.gap.push_back(between(run.time, run.gap, i, j, t));
            if (!run.velocity.empty()) {
                const bool both = std::isfinite(run.velocity[i]) && std::isfinite(run.velocity[j]);
                out.bridged += both ? 0U : 1U;
                out.velocity.push_back(both ? between(run.time, run.velocity, i, j, t)
                                            : slope_about(run, good, std::min(a, end), g, end));
            }
            if (!run.input.empty()) {
                out.input.push_back(between(run.time, run.input, i, j, t));
            }
            out.restart.push_back(k == 0);
        }
        out.gaps += end + 1 < good.size() ? 1U : 0U;
        g = end + 1;
    }
    return out;
}

}  // namespace underbody::estimator
