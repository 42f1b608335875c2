#include "surrogates/estimator/estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "surrogates/dynamics/measurements.h"
#include "surrogates/dynamics/predict.h"

namespace underbody::estimator {

namespace {

void note(core::Problems& problems, const std::string& text) {
    problems.push_back({core::Problem::Severity::warning, text, {}});
}

// Plant at a run's conditions; channels that vary within the run are held at their mean.
SeparatedPlant plant_of(const dynamics::Model& model, const dynamics::MeasuredRun& run, core::Problems& remarks) {
    const dynamics::InputSignals signals = dynamics::signals_of(run);
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
    if (held.has(dynamics::Channel::input_force) && !run.table.find("input_force")) {
        plant.bias += held[dynamics::Channel::input_force];
    }
    return plant;
}

double noise_or_estimate(const dynamics::Measurements& data, const std::string& channel, double given, bool& declared) {
    declared = true;
    if (given > 0) {
        return given;
    }
    if (const auto noise = data.declared_noise(channel)) {
        return *noise;
    }
    declared = false;
    std::vector<double> each;
    for (const auto& run : data.runs) {
        if (run.has(channel)) {
            const double sigma = dynamics::noise_of(run.table.numbers("time"), run.values(channel));
            if (sigma > 0) {
                each.push_back(sigma);
            }
        }
    }
    if (each.empty()) {
        return 0;
    }
    std::nth_element(each.begin(), each.begin() + static_cast<std::ptrdiff_t>(each.size() / 2), each.end());
    return each[each.size() / 2];
}

// Columns of the result, grown sample by sample.
struct Columns {
    std::vector<std::string> run, note;
    std::vector<double> time, gap, velocity, ground, drag, total;
    std::vector<double> gap_sigma, velocity_sigma, ground_sigma, drag_sigma, total_sigma, innovation;

    [[nodiscard]] core::Table table() const {
        core::Table t;
        t.add_text("run", run);
        t.add_numbers("time", "s", time);
        const auto pair = [&](const char* name, const char* unit, const std::vector<double>& value, const std::vector<double>& sigma) {
            t.add_numbers(name, unit, value);
            t.add_numbers(std::string(name) + "_sigma", unit, sigma);
        };
        pair("gap", "m", gap, gap_sigma);
        pair("heave_velocity", "m/s", velocity, velocity_sigma);
        pair("ground_force", "N", ground, ground_sigma);
        pair("drag_force", "N", drag, drag_sigma);
        pair("total_force", "N", total, total_sigma);
        t.add_numbers("innovation", "m", innovation);
        t.add_text("remark", note);
        return t;
    }
};

void add(Columns& c, const std::string& run, double time, const FilterEstimate& e) {
    c.run.push_back(run);
    c.time.push_back(time);
    c.gap.push_back(e.gap);
    c.velocity.push_back(e.velocity);
    c.ground.push_back(e.ground_force);
    c.drag.push_back(e.drag_force);
    c.total.push_back(e.total_force);
    c.gap_sigma.push_back(e.gap_sigma);
    c.velocity_sigma.push_back(e.velocity_sigma);
    c.ground_sigma.push_back(e.ground_sigma);
    c.drag_sigma.push_back(e.drag_sigma);
    c.total_sigma.push_back(e.total_sigma);
    c.innovation.push_back(e.innovation);
    c.note.emplace_back(e.outlier ? "outlier" : e.outside ? "outside the table" : std::isnan(e.innovation) ? "not measured" : "");
}

core::Figure forces_figure(const Columns& c, const std::string& run) {
    core::Figure f;
    f.title = "Estimated forces, run " + run;
    f.caption = "Bands: 95 %. total_force is observed; ground_force and drag_force rest on the declared drag law.";
    f.x = {"time", "s", 0, 0, false};
    f.y = {"force", "mN", 0, 0, false};
    const auto series = [&](const char* name, const std::vector<double>& value, const std::vector<double>& sigma, std::size_t colour) {
        core::FigureCurve curve;
        core::FigureBand band;
        curve.name = name;
        curve.colour = core::palette(colour);
        band.colour = curve.colour;
        band.colour.alpha = 45;
        for (std::size_t i = 0; i < c.time.size() && c.run[i] == run; ++i) {
            curve.x.push_back(c.time[i]);
            curve.y.push_back(1e3 * value[i]);
            band.x.push_back(c.time[i]);
            band.lower.push_back(1e3 * (value[i] - 1.96 * sigma[i]));
            band.upper.push_back(1e3 * (value[i] + 1.96 * sigma[i]));
        }
        f.bands.push_back(band);
        f.curves.push_back(curve);
    };
    series("total_force (observed)", c.total, c.total_sigma, 0);
    series("ground_force (model-dependent)", c.ground, c.ground_sigma, 1);
    series("drag_force (model-dependent)", c.drag, c.drag_sigma, 2);
    return f;
}

struct Prepared {
    const dynamics::MeasuredRun* run;
    SeparatedPlant plant;
    RunSignals signals;
};

std::vector<Prepared> prepare(const dynamics::Model& model, const dynamics::Measurements& data, core::Problems& remarks) {
    if (data.kind != dynamics::MeasurementKind::time_series) {
        throw core::InputError("kind", "the estimator needs time series; this data set is static", {data.folder.string(), {}, {}, {}},
                               "static forces are compared by 'underbody predict'");
    }
    std::vector<Prepared> all;
    for (const auto& run : data.runs) {
        all.push_back({&run, plant_of(model, run, remarks), signals_of_run(run, remarks)});
    }
    for (const auto& r : all.front().plant.remarks) {
        remarks.push_back(r);
    }
    return all;
}

FilterNoise noise_for(const dynamics::Measurements& data, const EstimateOptions& o, std::vector<Prepared>& runs, Estimation& out) {
    FilterNoise noise;
    bool declared = false;
    noise.gap = noise_or_estimate(data, "gap", o.gap_sigma, out.gap_noise_declared);
    noise.velocity = data.all_have("heave_velocity") ? noise_or_estimate(data, "heave_velocity", o.velocity_sigma, declared) : 0;
    if (!(noise.gap > 0)) {
        double size = 0;
        for (const auto& r : runs) {
            for (const double h : r.signals.gap) {
                size = std::isfinite(h) ? std::max(size, std::abs(h)) : size;
            }
        }
        noise.gap = std::max(1e-6 * size, 1e-9);
        note(out.remarks, "the gap shows no noise; " + core::format_number(noise.gap, 2) + " m is taken for its resolution");
    }
    if (data.all_have("heave_velocity") && !(noise.velocity > 0)) {
        noise.velocity = 1e-6;
        note(out.remarks, "the heave velocity shows no noise; 1e-6 m/s is taken for its resolution");
    }
    noise.drag_relative = o.drag_relative;
    noise.gate = o.gate;
    noise.force_density = o.force_density;
    if (!(noise.force_density > 0)) {
        std::vector<RunSignals> signals;
        for (const auto& r : runs) {
            signals.push_back(r.signals);
        }
        noise.force_density = likely_force_density(runs.front().plant, signals, noise);
        out.density_chosen = true;
    }
    return noise;
}

void estimate_extended(const std::vector<Prepared>& runs, const EstimateOptions& o, Estimation& out, Columns& columns,
                       core::Progress& progress) {
    for (std::size_t i = 0; i < runs.size(); ++i) {
        progress.check();
        progress.report(static_cast<double>(i) / static_cast<double>(runs.size()), "estimating " + runs[i].run->name);
        const FilterResult r = extended_filter(runs[i].plant, runs[i].signals, out.noise, o.smooth);
        RunEstimate summary;
        summary.name = runs[i].run->name;
        summary.samples = r.estimates.size();
        summary.used = r.used;
        summary.outliers = r.outliers;
        summary.missing = r.missing;
        summary.gaps_in_time = uniform(runs[i].signals, usual_step(runs[i].signals)).gaps;
        summary.mean_squared_innovation = r.mean_squared_innovation;
        summary.innovation_correlation = r.innovation_correlation;
        for (std::size_t k = 0; k < r.estimates.size(); ++k) {
            add(columns, summary.name, runs[i].signals.time[k], r.estimates[k]);
            summary.outside += r.estimates[k].outside ? 1.0 / static_cast<double>(r.estimates.size()) : 0;
        }
        if (r.mean_squared_innovation > 2 || r.mean_squared_innovation < 0.5) {
            note(out.remarks, "run '" + summary.name + "': the innovations are " +
                                  core::format_number(std::sqrt(r.mean_squared_innovation), 3) +
                                  " times what the filter states; noise or model are not what was declared");
        }
        out.runs.push_back(summary);
    }
}

// The linear model that the linear observers run on: learned from the declared plant over the region of the data.
AugmentedModel linear_model(const std::vector<Prepared>& runs, const EstimateOptions& o) {
    TrainingOptions t;
    t.gap_lower = INFINITY;
    t.gap_upper = -INFINITY;
    double speed = 0, force = 0;
    for (const auto& r : runs) {
        for (std::size_t k = 0; k < r.signals.time.size(); ++k) {
            if (std::isfinite(r.signals.gap[k])) {
                t.gap_lower = std::min(t.gap_lower, r.signals.gap[k]);
                t.gap_upper = std::max(t.gap_upper, r.signals.gap[k]);
            }
            if (k >= 25 && std::isfinite(r.signals.gap[k]) && std::isfinite(r.signals.gap[k - 25])) {
                speed = std::max(speed, std::abs(r.signals.gap[k] - r.signals.gap[k - 25]) /
                                            (r.signals.time[k] - r.signals.time[k - 25]));
            }
            force = r.signals.input.empty() ? force : std::max(force, std::abs(r.signals.input[k]));
        }
    }
    t.gap_lower = std::max(t.gap_lower, runs.front().plant.contact_gap);
    t.gap_upper = std::max(t.gap_upper, t.gap_lower + 1e-3);
    t.velocity_upper = std::clamp(speed, 1e-3, 1.0);
    t.velocity_lower = -t.velocity_upper;
    t.input_sigma = std::max(force / 2, 1e-4);
    t.samples = 20000;
    const SeparatedPlant& plant = runs.front().plant;
    const TrainingSet set = training_set(plant, t);
    LearnOptions l;
    l.order = o.order;
    l.fit = o.order > 0 ? Fit::method2 : Fit::least_squares;
    const Moments m = moments(set.view());
    AugmentedModel model = corrected(learn(m, set.layout, l), Correction::p2, heave_rows(set.layout, plant.virtual_mass, plant.bias));
    return model;
}

Vector stretched(const Poles& poles, std::size_t count) {
    Vector all;
    for (const auto& p : poles) {
        if (p.imag() != 0) {
            throw core::InputError("poles", "full order and latent observers take real poles");
        }
        all.push_back(p.real());
    }
    while (all.size() < count) {
        all.push_back(all.back() * 1.2 - 0.1);
    }
    return all;
}

ObserverDesign design_linear(const AugmentedModel& model, const std::vector<Prepared>& runs, const EstimateOptions& o,
                             const FilterNoise& noise, double step) {
    const bool velocity = noise.velocity > 0;
    if ((o.observer == "reduced" || o.observer == "disturbance") && !velocity) {
        throw core::InputError("missing", "the " + o.observer + " observer needs measured heave_velocity, and the data have none", {},
                               "take --observer extended, kalman or full: they need the gap alone");
    }
    const std::vector<std::string> sensors =
        velocity ? std::vector<std::string>{"heave_velocity", "gap"} : std::vector<std::string>{"gap"};
    const Vector sigma = velocity ? Vector{noise.velocity, noise.gap} : Vector{noise.gap};
    if (o.observer == "reduced") {
        return reduced_observer(model, reduced_gain(model, o.poles), step);
    }
    if (o.observer == "disturbance") {
        return disturbance_observer(runs.front().plant.virtual_mass, runs.front().plant.bias, -o.poles.front().real(), step);
    }
    if (o.observer == "full") {
        return full_observer(model, sensors, full_gain(model, sensors, stretched(o.poles, 4)), step);
    }
    if (o.observer == "latent") {
        const Matrix gain = full_gain(model, sensors, stretched(o.poles, 4));
        // Rotation: the eigenvectors of the state part of the covariance are as good as any orthonormal square T.
        const double c = std::sqrt(.5);
        const Matrix rotation{{c, 0, c, 0}, {0, c, 0, c}, {-c, 0, c, 0}, {0, -c, 0, c}};
        const Vector scale(model.sigma.begin() + 1, model.sigma.begin() + 5), centre(model.mean.begin() + 1, model.mean.begin() + 5);
        return latent_observer(model, rotation, scale, centre, sensors, gain, step);
    }
    // What the linear law misses of the rates acts as noise of about a second's memory.
    Vector process(4, 0.0);
    for (std::size_t i = 2; i < 4; ++i) {
        const double rate = model.sigma[5 + i];
        process[i] = std::max(rate * rate, noise.force_density);
    }
    return kalman_observer(model, sensors, process, sigma, step);
}

int find(const std::vector<std::string>& names, const char* name) {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? -1 : static_cast<int>(at - names.begin());
}

void estimate_linear(const std::vector<Prepared>& runs, const EstimateOptions& o, Estimation& out, Columns& columns,
                     core::Progress& progress) {
    std::vector<double> steps;
    for (const auto& r : runs) {
        steps.push_back(usual_step(r.signals));
    }
    std::sort(steps.begin(), steps.end());
    const double step = steps[steps.size() / 2];
    const AugmentedModel model = linear_model(runs, o);
    out.design.push_back(design_linear(model, runs, o, out.noise, step));
    const ObserverDesign& design = out.design.front();
    out.separability = design.separability;
    const LinearFilter& f = design.filter;
    Vector sigma;
    if (!design.covariance.empty()) {
        for (std::size_t i = 0; i < f.estimates.size(); ++i) {
            sigma.push_back(std::sqrt(std::max(design.covariance(i, i), 0.0)));
        }
    } else {
        Vector noise;
        for (const auto& s : f.measured) {
            noise.push_back(s == "gap" ? out.noise.gap : out.noise.velocity);
        }
        sigma = noise_gain(f, noise);
        note(out.remarks, "sigmas of this observer count the sensors' noise alone, not what its model misses");
    }
    const int at[] = {find(f.estimates, "gap"), find(f.estimates, "heave_velocity"), find(f.estimates, "ground_force"),
                      find(f.estimates, "drag_force"), find(f.estimates, "total_force")};
    for (const auto& r : runs) {
        progress.check();
        const UniformRun u = uniform(r.signals, step);
        FilterRunner runner(f);
        double e[FilterRunner::most_states] = {}, y[FilterRunner::most_signals] = {};
        RunEstimate summary;
        summary.name = r.run->name;
        summary.samples = u.time.size();
        summary.used = u.time.size();
        summary.outliers = u.outliers;
        summary.missing = u.missing;
        summary.gaps_in_time = u.gaps;
        summary.mean_squared_innovation = NAN;
        for (std::size_t k = 0; k < u.time.size(); ++k) {
            for (std::size_t i = 0; i < f.measured.size(); ++i) {
                y[i] = f.measured[i] == "gap" ? u.gap[k] : u.velocity[k];
            }
            if (u.restart[k]) {
                runner.start(y, e);
            } else {
                const double input = u.input.empty() ? 0 : u.input[k - 1];
                runner.step(y, &input, e);
            }
            FilterEstimate row;
            const auto pick = [&](int i, double other) { return i >= 0 ? e[i] : other; };
            const auto pick_sigma = [&](int i, double other) { return i >= 0 ? sigma[static_cast<std::size_t>(i)] : other; };
            row.gap = pick(at[0], u.gap[k]);
            row.velocity = pick(at[1], u.velocity.empty() ? NAN : u.velocity[k]);
            row.ground_force = pick(at[2], NAN);
            row.drag_force = pick(at[3], NAN);
            row.total_force = pick(at[4], NAN);
            row.gap_sigma = pick_sigma(at[0], out.noise.gap);
            row.velocity_sigma = pick_sigma(at[1], out.noise.velocity > 0 ? out.noise.velocity : NAN);
            row.ground_sigma = pick_sigma(at[2], NAN);
            row.drag_sigma = pick_sigma(at[3], NAN);
            row.total_sigma = pick_sigma(at[4], NAN);
            row.innovation = NAN;
            row.outside = row.gap < r.plant.lower || row.gap > r.plant.upper;
            add(columns, summary.name, u.time[k], row);
            columns.note.back() = u.restart[k] && k > 0 ? "started anew" : row.outside ? "outside the table" : "";
        }
        out.runs.push_back(summary);
    }
}

}  // namespace

RunSignals signals_of_run(const dynamics::MeasuredRun& run, core::Problems& remarks) {
    RunSignals s;
    s.time = run.table.numbers("time");
    s.gap = run.values("gap");
    s.velocity = run.has("heave_velocity") ? run.values("heave_velocity") : std::vector<double>{};
    if (run.table.find("input_force") == nullptr) {
        return s;
    }
    s.input = run.values("input_force");
    s.held = true;  // as dynamics::predict takes recorded inputs
    std::size_t bridged = 0, last = s.input.size();
    for (std::size_t i = 0; i < s.input.size(); ++i) {
        if (!std::isfinite(s.input[i])) {
            ++bridged;
            continue;
        }
        for (std::size_t k = last == s.input.size() ? 0 : last + 1; k < i; ++k) {
            s.input[k] = last == s.input.size() ? s.input[i]
                                                : s.input[last] + (s.input[i] - s.input[last]) * (s.time[k] - s.time[last]) /
                                                                      (s.time[i] - s.time[last]);
        }
        last = i;
    }
    if (last == s.input.size()) {
        throw core::InputError("missing", "every value of input_force is missing", {run.file.string(), {}, {}, {}});
    }
    for (std::size_t k = last + 1; k < s.input.size(); ++k) {
        s.input[k] = s.input[last];
    }
    if (bridged > 0) {
        note(remarks, "run '" + run.name + "': " + std::to_string(bridged) + " missing values of input_force were interpolated");
    }
    return s;
}

double usual_step(const RunSignals& run) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < run.time.size(); ++i) {
        steps.push_back(run.time[i] - run.time[i - 1]);
    }
    if (steps.empty()) {
        throw core::InputError("few", "a run needs at least two samples");
    }
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
    return steps[steps.size() / 2];
}

namespace {

// Measured values less outliers: a value far from the middle of its neighbours (Hampel's identifier).
std::vector<std::size_t> good_samples(const std::vector<double>& time, const std::vector<double>& values, UniformRun& out) {
    std::vector<std::size_t> finite, good;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i])) {
            finite.push_back(i);
        } else {
            ++out.missing;
        }
    }
    const double noise = dynamics::noise_of(time, values);
    for (std::size_t k = 0; k < finite.size(); ++k) {
        if (k >= 2 && k + 2 < finite.size()) {
            std::array<double, 5> near{};
            for (std::size_t j = 0; j < 5; ++j) {
                near[j] = values[finite[k + j - 2]];
            }
            const double spread = std::max(std::abs(near[0] - near[4]), 8 * noise);
            std::nth_element(near.begin(), near.begin() + 2, near.end());
            if (noise > 0 && std::abs(values[finite[k]] - near[2]) > spread) {
                ++out.outliers;
                continue;
            }
        }
        good.push_back(finite[k]);
    }
    return good;
}

double between(const std::vector<double>& time, const std::vector<double>& values, std::size_t a, std::size_t b, double t) {
    return a == b ? values[a] : values[a] + (values[b] - values[a]) * (t - time[a]) / (time[b] - time[a]);
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
                const double slope = (run.gap[j] - run.gap[i]) / std::max(run.time[j] - run.time[i], 1e-12);
                out.velocity.push_back(both ? between(run.time, run.velocity, i, j, t) : slope);
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

Estimation estimate(const dynamics::Model& model, const dynamics::Measurements& data, const EstimateOptions& asked,
                    core::Progress& progress) {
    EstimateOptions options = asked;
    if (options.poles.empty()) {
        options.poles.assign({std::complex<double>(-3), std::complex<double>(-4)});
    }
    static const std::vector<std::string> known{"extended", "kalman", "reduced", "full", "latent", "disturbance"};
    if (std::find(known.begin(), known.end(), options.observer) == known.end()) {
        throw core::InputError("name", "there is no observer '" + options.observer + "'", {}, core::did_you_mean(options.observer, known));
    }
    Estimation out;
    out.observer = options.observer;
    std::vector<Prepared> runs = prepare(model, data, out.remarks);
    out.noise = noise_for(data, options, runs, out);
    Columns columns;
    if (options.observer == "extended") {
        const SeparatedPlant& p = runs.front().plant;
        out.separability = separability(frozen_model(p, 0.5 * (std::max(p.lower, p.contact_gap) + p.upper), 0.01));
        estimate_extended(runs, options, out, columns, progress);
        out.explanation = "total_force is seen through the motion; ground_force adds the declared drag law to it, and drag_force is that "
                          "law: their split is as good as the law";
    } else {
        estimate_linear(runs, options, out, columns, progress);
        out.explanation = out.separability.explanation;
    }
    out.labels = {{"gap", "observed"}, {"heave_velocity", "observed"}, {"total_force", "observed"}};
    if (options.observer != "disturbance") {
        out.labels.emplace_back("ground_force", "model-dependent");
        out.labels.emplace_back("drag_force", "model-dependent");
    }
    for (const auto& r : out.runs) {
        if (r.outliers > 0) {
            note(out.remarks, "run '" + r.name + "': " + std::to_string(r.outliers) + " outliers of the gap were left out");
        }
        if (r.outside > 0) {
            note(out.remarks, "run '" + r.name + "': " + core::format_number(100 * r.outside, 3) + " % lies beyond the force table");
        }
    }
    out.figure = forces_figure(columns, out.runs.front().name);
    out.table = columns.table();
    return out;
}

TrainingSet training_from_runs(const dynamics::Model& model, const dynamics::Measurements& data, const EstimateOptions& options,
                               core::Progress& progress) {
    TrainingSet set;
    set.layout = Layout::heave();
    Estimation scratch;
    std::vector<Prepared> runs = prepare(model, data, set.remarks);
    const FilterNoise noise = noise_for(data, options, runs, scratch);
    for (const auto& r : runs) {
        progress.check();
        const FilterResult f = extended_filter(r.plant, r.signals, noise, true);
        for (std::size_t k = 1; k + 1 < f.estimates.size(); ++k) {
            const FilterEstimate& e = f.estimates[k];
            const double span = r.signals.time[k + 1] - r.signals.time[k - 1];
            const double u = r.signals.input.empty() ? 0 : r.signals.input[k];
            double ground_slope = 0, drag_slope = 0;
            r.plant.ground_force(e.gap, ground_slope);
            r.plant.drag_force(e.velocity, drag_slope);
            const double dw = (e.total_force + u + r.plant.bias) / r.plant.virtual_mass;
            const double departure = (f.estimates[k + 1].departure - f.estimates[k - 1].departure) / span;
            const double row[] = {u,  e.velocity, e.gap,     e.ground_force,
                                  e.drag_force, dw, e.velocity, ground_slope * e.velocity + departure, drag_slope * dw};
            set.values.insert(set.values.end(), row, row + 9);
            ++set.count;
        }
    }
    for (auto& p : scratch.remarks) {
        set.remarks.push_back(std::move(p));
    }
    return set;
}

void to_json(nlohmann::json& j, const Estimation& e) {
    nlohmann::json labels = nlohmann::json::object(), runs = nlohmann::json::array(), remarks = nlohmann::json::array();
    for (const auto& [name, label] : e.labels) {
        labels[name] = label;
    }
    const auto number = [](double v) { return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(); };
    for (const auto& r : e.runs) {
        runs.push_back({{"name", r.name},
                        {"samples", r.samples},
                        {"outliers", r.outliers},
                        {"missing", r.missing},
                        {"gaps_in_time", r.gaps_in_time},
                        {"mean_squared_innovation", number(r.mean_squared_innovation)},
                        {"innovation_correlation", number(r.innovation_correlation)},
                        {"outside", r.outside}});
    }
    for (const auto& r : e.remarks) {
        remarks.push_back(r.message);
    }
    j = {{"observer", e.observer},
         {"labels", labels},
         {"explanation", e.explanation},
         {"separability", e.separability},
         {"noise",
          {{"gap", {{"value", e.noise.gap}, {"unit", "m"}, {"from", e.gap_noise_declared ? "declared" : "data"}}},
           {"force_density", {{"value", e.noise.force_density}, {"unit", "N^2/s"}, {"from", e.density_chosen ? "likelihood" : "given"}}},
           {"drag_relative", e.noise.drag_relative}}},
         {"runs", runs},
         {"remarks", remarks}};
    if (!e.design.empty()) {
        j["design"] = e.design.front();
    }
}

}  // namespace underbody::estimator
