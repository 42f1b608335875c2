#include "surrogates/estimator/observe/estimate.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/normal.h"
#include "core/quantile.h"
#include "core/text.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/estimator/observe/prepared_runs.h"

namespace underbody::estimator {

using internal::noise_for;
using internal::note;
using internal::prepare;
using internal::Prepared;

namespace {

// Columns of the result, grown sample by sample.
struct Columns {
    std::vector<std::string> run, note;
    std::vector<double> time, gap, velocity, ground, drag, total;
    std::vector<double> gap_sigma, velocity_sigma, ground_sigma, drag_sigma, total_sigma, innovation;

    [[nodiscard]] core::Table table() const {
        core::Table t;
        t.add_text("run", run);
        t.add_numbers("time", "s", time);
        const auto pair = [&](const char* name, const char* unit, const std::vector<double>& value,
                              const std::vector<double>& sigma) {
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
    c.note.emplace_back(e.outlier                  ? "outlier"
                        : e.outside                ? "outside the table"
                        : std::isnan(e.innovation) ? "not measured"
                                                   : "");
}

core::Figure forces_figure(const Columns& c, const std::string& run) {
    core::Figure f;
    f.title = "Estimated forces, run " + run;
    f.caption = "Bands: 95 %. total_force is observed; ground_force and drag_force rest on the declared drag law.";
    f.x = {"time", "s", 0, 0, false};
    f.y = {"force", "mN", 0, 0, false};
    const auto series = [&](const char* name, const std::vector<double>& value, const std::vector<double>& sigma,
                            std::size_t colour) {
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
            band.lower.push_back(1e3 * (value[i] - core::sigmas_of_95 * sigma[i]));
            band.upper.push_back(1e3 * (value[i] + core::sigmas_of_95 * sigma[i]));
        }
        f.bands.push_back(band);
        f.curves.push_back(curve);
    };
    series("total_force (observed)", c.total, c.total_sigma, 0);
    series("ground_force (model-dependent)", c.ground, c.ground_sigma, 1);
    series("drag_force (model-dependent)", c.drag, c.drag_sigma, 2);
    return f;
}

void estimate_extended(const std::vector<Prepared>& runs, const EstimateOptions& o, Estimation& out, Columns& columns,
                       core::Progress& progress) {
    double squares = 0, count = 0;
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
            add(columns, summary.name, runs[i].signals.time[k] + runs[i].run->clock_offset, r.estimates[k]);
            summary.outside += r.estimates[k].outside ? 1.0 / static_cast<double>(r.estimates.size()) : 0;
            squares += r.estimates[k].departure * r.estimates[k].departure;
            count += 1;
        }
        if (r.mean_squared_innovation > 2 || r.mean_squared_innovation < 0.5) {
            note(out.remarks, "run '" + summary.name + "': the innovations are " +
                                  core::format_number(std::sqrt(r.mean_squared_innovation), 3) +
                                  " times what the filter states; noise or model are not what was declared");
        }
        out.runs.push_back(summary);
    }
    out.departure_rms = count > 0 ? std::sqrt(squares / count) : 0;
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
    const double middle = 0.5 * (t.gap_lower + t.gap_upper);
    AugmentedModel model =
        corrected(learn(m, set.layout, l), Correction::p2, heave_rows(set.layout, plant.mass_at(middle), plant.bias));
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
                             const FilterNoise& noise, double step, double density) {
    const bool velocity = noise.velocity > 0;
    if ((o.observer == "reduced" || o.observer == "disturbance") && !velocity) {
        throw core::InputError("missing",
                               "the " + o.observer + " observer needs measured heave_velocity, and the data have none",
                               {}, "take extended, kalman or full (option 'observer'): they need the gap alone");
    }
    const std::vector<std::string> sensors =
        velocity ? std::vector<std::string>{"heave_velocity", "gap"} : std::vector<std::string>{"gap"};
    const Vector sigma = velocity ? Vector{noise.velocity, noise.gap} : Vector{noise.gap};
    if (o.observer == "reduced") {
        return reduced_observer(model, reduced_gain(model, o.poles), step);
    }
    if (o.observer == "disturbance") {
        const SeparatedPlant& plant = runs.front().plant;
        const double middle = model.mean[2];  // gap of the region that the model was learned in
        return disturbance_observer(plant.mass_at(middle), plant.bias, -o.poles.front().real(), step);
    }
    if (o.observer == "full") {
        return full_observer(model, sensors, full_gain(model, sensors, stretched(o.poles, 4)), step);
    }
    if (o.observer == "latent") {
        const Matrix gain = full_gain(model, sensors, stretched(o.poles, 4));
        const Vector scale(model.sigma.begin() + 1, model.sigma.begin() + 5),
            centre(model.mean.begin() + 1, model.mean.begin() + 5);
        return latent_observer(model, usual_rotation(), scale, centre, sensors, gain, step);
    }
    return kalman_observer(model, sensors, {0, 0, density, density}, sigma, step);
}

int find(const std::vector<std::string>& names, const char* name) {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? -1 : static_cast<int>(at - names.begin());
}

// Runs the filter over a run; `each` receives sample, its measurements and the estimates.
template <typename Each>
void follow(const LinearFilter& f, const UniformRun& run, Each&& each) {
    FilterRunner runner(f);
    double e[FilterRunner::most_states] = {}, y[FilterRunner::most_signals] = {};
    for (std::size_t k = 0; k < run.time.size(); ++k) {
        for (std::size_t i = 0; i < f.measured.size(); ++i) {
            y[i] = f.measured[i] == "gap" ? run.gap[k] : run.velocity[k];
        }
        if (run.restart[k]) {
            runner.start(y, e);
        } else {
            const double input = run.input.empty() ? 0 : run.input[k - 1];
            runner.step(y, &input, e);
        }
        each(k, y, e);
    }
}

struct Innovations {
    double log_likelihood = 0, squares = 0, count = 0;
    [[nodiscard]] double mean_square() const { return count > 0 ? squares / count : NAN; }
};

// Innovations of a steady-state Kalman filter out of what is left after the measurement: r = (I - C K) nu, and (I - C
// K) S = R.
Innovations innovations_of(const ObserverDesign& design, const UniformRun& run, const Vector& sigma) {
    const LinearFilter& f = design.filter;
    const std::size_t p = f.measured.size();
    std::vector<std::size_t> place;
    for (const auto& name : f.measured) {
        place.push_back(static_cast<std::size_t>(find(f.estimates, name.c_str())));
    }
    Matrix left = Matrix::identity(p), r(p, p);
    for (std::size_t i = 0; i < p; ++i) {
        for (std::size_t j = 0; j < p; ++j) {
            left(i, j) -= design.gain(place[i], j);
        }
        r(i, i) = sigma[i] * sigma[i];
    }
    const Matrix back = inverse(left), spread = back * r, weight = inverse(spread);
    const double size = p == 2 ? spread(0, 0) * spread(1, 1) - spread(0, 1) * spread(1, 0) : spread(0, 0);
    Innovations sum;
    std::size_t since = 0;
    follow(f, run, [&](std::size_t k, const double* y, const double* e) {
        since = run.restart[k] ? 0 : since + 1;
        if (since < 50) {  // the start values came from the same data
            return;
        }
        Vector residual(p);
        for (std::size_t i = 0; i < p; ++i) {
            residual[i] = y[i] - e[place[i]];
        }
        const Vector nu = back * residual, weighted = weight * nu;
        double square = 0;
        for (std::size_t i = 0; i < p; ++i) {
            square += nu[i] * weighted[i];
        }
        sum.log_likelihood -= 0.5 * (square + std::log(std::max(size, 1e-300)));
        sum.squares += square;
        sum.count += static_cast<double>(p);
    });
    return sum;
}

// The force density at which the linear law's own filter is likeliest: what the law misses is noise to it.
double likely_linear_density(const AugmentedModel& model, const std::vector<Prepared>& runs,
                             const std::vector<UniformRun>& signals, EstimateOptions o, const FilterNoise& noise,
                             double step) {
    o.observer = "kalman";
    const Vector sigma = noise.velocity > 0 ? Vector{noise.velocity, noise.gap} : Vector{noise.gap};
    double best = 1e-6, highest = -INFINITY;
    for (double exponent = -11; exponent <= 0; exponent += 0.5) {
        const double density = std::pow(10.0, exponent);
        double sum = 0;
        try {
            const ObserverDesign design = design_linear(model, runs, o, noise, step, density);
            for (const auto& run : signals) {
                sum += innovations_of(design, run, sigma).log_likelihood;
            }
        } catch (const core::InputError&) {
            continue;  // no steady state at so little noise
        }
        if (sum > highest) {
            highest = sum;
            best = density;
        }
    }
    return best;
}

RunEstimate summary_of(const std::string& name, const UniformRun& u) {
    RunEstimate summary;
    summary.name = name;
    summary.samples = u.time.size();
    summary.used = u.time.size();
    summary.outliers = u.outliers;
    summary.missing = u.missing;
    summary.gaps_in_time = u.gaps;
    summary.mean_squared_innovation = NAN;
    return summary;
}

/// The usual step of most runs.
double common_step(const std::vector<Prepared>& runs) {
    std::vector<double> steps;
    for (const auto& r : runs) {
        steps.push_back(usual_step(r.signals));
    }
    return core::median(std::move(steps));
}

bool differs(const SeparatedPlant& a, const SeparatedPlant& b) {
    double unused = 0;
    const double h = 0.5 * (std::max(a.lower, a.contact_gap) + a.upper), force = a.ground_force(h, unused);
    return std::abs(b.ground_force(h, unused) - force) > 0.01 * std::abs(force) || std::abs(b.bias - a.bias) > 1e-6;
}

/// Of each estimate of a linear observer.
Vector sigmas_of(const ObserverDesign& design, const FilterNoise& sensors, core::Problems& remarks) {
    const LinearFilter& f = design.filter;
    Vector sigma;
    if (!design.covariance.empty()) {
        for (std::size_t i = 0; i < f.estimates.size(); ++i) {
            sigma.push_back(std::sqrt(std::max(design.covariance(i, i), 0.0)));
        }
        return sigma;
    }
    Vector noise;
    for (const auto& s : f.measured) {
        noise.push_back(s == "gap" ? sensors.gap : sensors.velocity);
    }
    note(remarks, "sigmas of this observer count the sensors' noise alone, not what its model misses");
    return noise_gain(f, noise);
}

/// What a linear observer says at sample k of a run; what it does not estimate is taken from the sensors.
FilterEstimate row_of(const LinearFilter& f, const Vector& sigma, const FilterNoise& noise, const SeparatedPlant& plant,
                      const UniformRun& u, std::size_t k, const double* e) {
    FilterEstimate row;
    const auto pick = [&](const char* name, double& value, double& its_sigma, double other, double other_sigma) {
        const int i = find(f.estimates, name);
        value = i >= 0 ? e[i] : other;
        its_sigma = i >= 0 ? sigma[static_cast<std::size_t>(i)] : other_sigma;
    };
    pick("gap", row.gap, row.gap_sigma, u.gap[k], noise.gap);
    pick("heave_velocity", row.velocity, row.velocity_sigma, u.velocity.empty() ? NAN : u.velocity[k],
         noise.velocity > 0 ? noise.velocity : NAN);
    pick("ground_force", row.ground_force, row.ground_sigma, NAN, NAN);
    pick("drag_force", row.drag_force, row.drag_sigma, NAN, NAN);
    pick("total_force", row.total_force, row.total_sigma, NAN, NAN);
    row.innovation = NAN;
    if (std::isfinite(row.ground_force) && std::isfinite(row.drag_force)) {
        // What departs from the declared laws may be the ground's or the drag's, whatever a linear law made of it.
        FilterEstimate declared;
        double slope = 0;
        declared.drag_force = plant.drag(row.gap, row.velocity);
        declared.departure = row.total_force - (plant.ground_force(row.gap, slope) - declared.drag_force);
        declared.departure_sigma = row.total_sigma;
        const double split = split_sigma(noise, declared);
        row.ground_sigma = std::hypot(row.ground_sigma, split);
        row.drag_sigma = std::hypot(row.drag_sigma, split);
    }
    row.outside = row.gap < plant.lower || row.gap > plant.upper;
    return row;
}

void estimate_linear(const std::vector<Prepared>& runs, const EstimateOptions& o, Estimation& out, Columns& columns,
                     core::Progress& progress) {
    const double step = common_step(runs);
    if (std::any_of(runs.begin(), runs.end(),
                    [&](const Prepared& r) { return differs(runs.front().plant, r.plant); })) {
        note(out.remarks, "the runs have different conditions; a linear observer has one model, that of run '" +
                              runs.front().run->name + "': take the extended filter, or the runs apart");
    }
    const AugmentedModel model = linear_model(runs, o);
    std::vector<UniformRun> signals;
    std::size_t bridged = 0;
    for (const auto& r : runs) {
        signals.push_back(uniform(r.signals, step));
        bridged += signals.back().bridged;
    }
    if (bridged > 0 && o.observer != "extended") {
        note(out.remarks, core::counted(bridged, "missing heave velocity was", "missing heave velocities were") +
                              " bridged by the slope of the gap over 0.5 s");
    }
    double density = out.noise.force_density;
    if (o.observer == "kalman" && out.density_chosen) {
        density = out.noise.force_density = likely_linear_density(model, runs, signals, o, out.noise, step);
    }
    out.design.push_back(design_linear(model, runs, o, out.noise, step, density));
    const ObserverDesign& design = out.design.front();
    out.separability = design.separability;
    const LinearFilter& f = design.filter;
    const Vector sigma = sigmas_of(design, out.noise, out.remarks);
    for (std::size_t run = 0; run < runs.size(); ++run) {
        progress.check();
        const Prepared& r = runs[run];
        const UniformRun& u = signals[run];
        RunEstimate summary = summary_of(r.run->name, u);
        if (o.observer == "kalman") {
            const Vector own =
                out.noise.velocity > 0 ? Vector{out.noise.velocity, out.noise.gap} : Vector{out.noise.gap};
            summary.mean_squared_innovation = innovations_of(design, u, own).mean_square();
        }
        follow(f, u, [&](std::size_t k, const double*, const double* e) {
            const FilterEstimate row = row_of(f, sigma, out.noise, r.plant, u, k, e);
            add(columns, summary.name, u.time[k] + r.run->clock_offset, row);
            columns.note.back() = u.restart[k] && k > 0 ? "started anew" : row.outside ? "outside the table" : "";
        });
        out.runs.push_back(summary);
    }
}

void add_remarks(Estimation& out) {
    for (const auto& r : out.runs) {
        if (r.outliers > 0) {
            note(out.remarks, "run '" + r.name + "': " +
                                  core::counted(r.outliers, "outlier of the gap was", "outliers of the gap were") +
                                  " left out");
        }
        if (r.outside > 0) {
            note(out.remarks,
                 "run '" + r.name + "': " + core::format_number(100 * r.outside, 3) + " % lies beyond the force table");
        }
    }
}

}  // namespace

Estimation estimate(const dynamics::Model& model, const dynamics::Measurements& data, const EstimateOptions& asked,
                    core::Progress& progress) {
    EstimateOptions options = asked;
    if (options.poles.empty()) {
        options.poles.assign({std::complex<double>(-3), std::complex<double>(-4)});
    }
    static const std::vector<std::string> known{"extended", "kalman", "reduced", "full", "latent", "disturbance"};
    if (std::find(known.begin(), known.end(), options.observer) == known.end()) {
        throw core::InputError("name", "there is no observer '" + options.observer + "'", {},
                               core::did_you_mean(options.observer, known));
    }
    Estimation out;
    out.observer = options.observer;
    std::vector<Prepared> runs = prepare(model, data, out.remarks);
    const internal::NoiseChoice choice = noise_for(model, data, options, runs, out.remarks);
    out.noise = choice.noise;
    out.gap_noise_declared = choice.gap_declared;
    out.density_chosen = choice.density_chosen;
    Columns columns;
    if (options.observer == "extended") {
        const SeparatedPlant& p = runs.front().plant;
        out.separability = separability(frozen_model(p, 0.5 * (std::max(p.lower, p.contact_gap) + p.upper), 0.01));
        estimate_extended(runs, options, out, columns, progress);
        out.explanation =
            "total_force is seen through the motion; ground_force adds the declared drag law to it, and drag_force is "
            "that law: their split is as good as the law. Their bands count how far the data depart from the declared "
            "laws, whichever of the two departs: on simulated runs, with the drag law right or wrong by a factor of "
            "two, "
            "in still and in moving water, the two-sigma bands hold the truth in at least 98 % of the samples";
    } else {
        estimate_linear(runs, options, out, columns, progress);
        out.explanation = out.separability.explanation;
    }
    out.labels = {{"gap", "observed"}, {"heave_velocity", "observed"}, {"total_force", "observed"}};
    if (options.observer != "disturbance") {
        out.labels.emplace_back("ground_force", "model-dependent");
        out.labels.emplace_back("drag_force", "model-dependent");
    }
    add_remarks(out);
    out.figure = forces_figure(columns, out.runs.front().name);
    out.table = columns.table();
    return out;
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
           {"force_density",
            {{"value", e.noise.force_density}, {"unit", "N^2/s"}, {"from", e.density_chosen ? "likelihood" : "given"}}},
           {"drag_relative", e.noise.drag_relative}}},
         {"departure_rms", e.departure_rms},
         {"runs", runs},
         {"remarks", remarks}};
    if (!e.design.empty()) {
        j["design"] = e.design.front();
    }
}

}  // namespace underbody::estimator
