// underbody learn: the data-driven augmented linear model.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/force_notes.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/dynamics/simulate/read_records.h"
#include "surrogates/estimator/control/bounds.h"
#include "surrogates/estimator/model/run_data.h"
#include "surrogates/estimator/model/training.h"
#include "surrogates/estimator/observe/observer.h"

namespace underbody::studio {

namespace {

using namespace estimator;

struct LearnArguments {
    std::string model, method = "grid", fit, offset = "mean", correction = "p1", excitation = "pink", region, mesh,
                       input_sigma, duration, interval, auxiliaries, conditions, data, moments_of, samples_out, out,
                       focus, step = "0.1 s", horizon = "10 s", plot;
    std::size_t order = 0, samples = 50000;
    std::uint64_t seed = 1;
    bool scan = false, at_rest = false, compare = false;
};

std::vector<std::string> split(const std::string& text, char mark) {
    std::vector<std::string> parts;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(mark, at), text.size());
        std::string part = text.substr(at, end - at);
        part.erase(0, part.find_first_not_of(' '));
        part.erase(part.find_last_not_of(' ') + 1);
        parts.push_back(part);
        at = end + 1;
    }
    return parts;
}

std::size_t count_of(const std::string& text) {
    std::size_t value = 0;
    const auto r = std::from_chars(text.data(), text.data() + text.size(), value);
    if (r.ec != std::errc() || r.ptr != text.data() + text.size() || value == 0) {
        throw core::UsageError("parse", "'" + text + "' is no count", {},
                               "for instance --mesh 5x41x61: inputs, velocities, gaps");
    }
    return value;
}

template <typename Value>
Value choose(const std::string& text, const std::vector<std::pair<std::string, Value>>& choices, const char* option) {
    std::vector<std::string> names;
    for (const auto& [name, value] : choices) {
        if (name == text) {
            return value;
        }
        names.push_back(name);
    }
    throw core::UsageError("name", std::string(option) + " does not know '" + text + "'", {},
                           core::did_you_mean(text, names));
}

/// Gaps and velocities to sample: those of the force table, unless stated.
void take_region(TrainingOptions& o, const LearnArguments& a, const SeparatedPlant& plant) {
    o.gap_lower = std::max(plant.lower, plant.contact_gap);
    o.gap_upper = plant.upper;
    for (const core::NamedRange& r :
         a.region.empty() ? std::vector<core::NamedRange>{} : core::parse_ranges(a.region)) {
        if (r.name == "gap") {
            o.gap_lower = r.lower;
            o.gap_upper = r.upper;
        } else if (r.name == "heave_velocity") {
            o.velocity_lower = r.lower;
            o.velocity_upper = r.upper;
        } else {
            throw core::UsageError("name", "--region knows gap and heave_velocity, not '" + r.name + "'");
        }
    }
    constexpr double no_end = 1e6;  // m: no table bounds the gaps
    if (a.data.empty() && a.moments_of.empty() && !(o.gap_upper - o.gap_lower < no_end)) {
        throw core::UsageError("range", "the model has no force table whose gaps could be sampled", {},
                               "say them: --region gap=0:0.1");
    }
}

void take_auxiliaries(TrainingOptions& o, const LearnArguments& a) {
    if (!a.auxiliaries.empty()) {
        if (a.method == "dmdc") {
            throw core::UsageError("range", "--method dmdc has no auxiliary variables", {},
                                   "take --method edmd for a dictionary");
        }
        o.auxiliaries = split(a.auxiliaries, ',');
    } else if (a.method == "dmdc") {
        o.auxiliaries = {};
    } else if (a.method == "edmd") {
        o.auxiliaries = usual_dictionary();
    }
}

void take_mesh(TrainingOptions& o, const LearnArguments& a) {
    if (!a.mesh.empty()) {
        const auto parts = split(a.mesh, 'x');
        if (parts.size() != 3) {
            throw core::UsageError("parse", "--mesh wants three counts", {},
                                   "for instance --mesh 5x41x61: inputs, velocities, gaps");
        }
        o.mesh_inputs = count_of(parts[0]);
        o.mesh_velocities = count_of(parts[1]);
        o.mesh_gaps = count_of(parts[2]);
    }
    if (!a.focus.empty()) {
        const auto parts = split(a.focus, ':');
        if (parts.size() != 3) {
            throw core::UsageError("parse", "--focus wants lower:upper:share", {}, "for instance --focus 0:0.15:0.5");
        }
        o.focus_lower = option_value("--focus", std::string(parts[0]), "m");
        o.focus_upper = option_value("--focus", std::string(parts[1]), "m");
        o.focus_share = option_value("--focus", std::string(parts[2]), "1");
    }
}

TrainingOptions training_options(const LearnArguments& a, const SeparatedPlant& plant) {
    TrainingOptions o;
    o.method = choose<TrainingOptions::Method>(a.method,
                                               {{"grid", TrainingOptions::Method::grid},
                                                {"time", TrainingOptions::Method::time},
                                                {"dmdc", TrainingOptions::Method::grid},
                                                {"edmd", TrainingOptions::Method::grid}},
                                               "--method");
    o.samples = a.samples;
    o.seed = a.seed;
    o.start_at_rest = a.at_rest;
    o.excitation = choose<Excitation>(a.excitation,
                                      {{"none", Excitation::none},
                                       {"white", Excitation::white},
                                       {"pink", Excitation::pink},
                                       {"pulses", Excitation::pulses}},
                                      "--excitation");
    take_region(o, a, plant);
    double largest = 0, slope = 0;
    for (int i = 0; i <= 400; ++i) {
        largest =
            std::max(largest, std::abs(plant.ground_force(o.gap_lower + (o.gap_upper - o.gap_lower) * i / 400, slope)));
    }
    o.input_sigma =
        a.input_sigma.empty() ? std::max(0.5 * largest, 1e-4) : option_value("--input-sigma", a.input_sigma, "N");
    o.duration = a.duration.empty() ? o.duration : option_value("--for", a.duration, "s");
    o.interval = a.interval.empty() ? o.interval : option_value("--every", a.interval, "s");
    take_auxiliaries(o, a);
    take_mesh(o, a);
    return o;
}

nlohmann::json bounds_json(const Matrix& m) {
    const RobustnessBounds b = robustness_bounds(m);
    return {{"hurwitz", b.hurwitz},
            {"stability_degree", b.stability_degree},
            {"patel_toda", b.patel_toda},
            {"patel_toda_element", b.patel_toda_element},
            {"yedavalli", b.yedavalli}};
}

nlohmann::json scan_json(const Moments& moments, const Layout& layout, const LearnOptions& options) {
    nlohmann::json list = nlohmann::json::array();
    LearnOptions latent = options;
    if (latent.fit == Fit::least_squares) {
        latent.fit = Fit::method2;
    }
    for (const AugmentedModel& m : scan_orders(moments, layout, latent)) {
        const DerivativeError e = derivative_error(m, moments);
        nlohmann::json poles = nlohmann::json::array();
        for (const auto& p : estimator::eigenvalues(m.A)) {
            poles.push_back({{"real", p.real()}, {"imaginary", p.imag()}});
        }
        list.push_back({{"order", m.order},
                        {"above_rank", m.order > m.rank},
                        {"rms", e.rms},
                        {"relative", e.relative},
                        {"poles", poles}});
    }
    return list;
}

struct Learned {
    AugmentedModel model;
    Moments moments;
    core::Problems remarks;
    std::vector<std::string> warnings;           ///< of the force tables, said already
    std::vector<std::string> held_at_reference;  ///< likewise
    std::vector<KnownRow> rows;
    std::vector<PredictionError> predictions;
    std::string tested_on;
};

bool by_snapshots(const LearnArguments& a) { return a.method == "dmdc" || a.method == "edmd"; }

bool has_forces(const Layout& layout) {
    const auto count = [&](const char* name) { return std::count(layout.states.begin(), layout.states.end(), name); };
    return count("ground_force") + count("drag_force") == 2 || count("total_force") == 1;
}

/// The model and its peers on motions that none of them has seen.
void compare(const LearnArguments& a, const dynamics::Model& declared, const SeparatedPlant& plant,
             const TrainingOptions& training, const RunSplit& split, Learned& out, Shell& shell) {
    const double step = option_value("--step", a.step, "s"), horizon = option_value("--horizon", a.horizon, "s");
    NamedModels models;
    std::vector<TestMotion> motions;
    if (a.data.empty()) {
        models = usual_peers(plant, training, step, shell.progress());
        PredictionTest test;
        test.horizon = horizon;
        test.gap_lower = training.gap_lower;
        test.gap_upper = training.gap_upper;
        test.velocity_lower = training.velocity_lower;
        test.velocity_upper = training.velocity_upper;
        test.input_sigma = training.input_sigma;
        test.seed = a.seed + 98;
        motions = test_motions(plant, test);
        out.tested_on = std::to_string(test.runs) + " simulated motions of " + core::format_number(horizon, 4) +
                        " s, none in the training set";
    } else {
        const std::vector<std::string> forces{"ground_force", "drag_force"};
        const auto train = motions_from_runs(declared, split.train, horizon, {}, shell.progress());
        models = usual_peers(plant, training_from_runs(declared, split.train, forces, {}, shell.progress()),
                             snapshot_pairs(train, {}, step), snapshot_pairs(train, usual_dictionary(), step));
        motions = motions_from_runs(declared, split.test, horizon, {}, shell.progress());
        out.tested_on = std::to_string(motions.size()) + " windows of measured runs; " + split.how;
    }
    models.emplace_back("this model", out.model);
    out.predictions = compare_predictions(plant, models, motions, shell.progress());
    if (!a.plot.empty()) {
        write_picture(prediction_figure(out.predictions, out.tested_on), a.plot);
    }
}

/// kg, in the middle of the gaps: a linear law has one mass.
double mass_within(const SeparatedPlant& plant, const TrainingOptions& training) {
    return plant.mass_at(0.5 * (training.gap_lower + training.gap_upper));
}

TrainingSet samples_for(const LearnArguments& a, const dynamics::Model& declared, const SeparatedPlant& plant,
                        const TrainingOptions& training, const RunSplit& split, Shell& shell) {
    return a.data.empty() ? training_set(plant, training, shell.progress())
                          : training_from_runs(declared, split.train, training.auxiliaries, {}, shell.progress());
}

void learn_from_samples(const LearnArguments& a, const SeparatedPlant& plant, const TrainingOptions& training,
                        const Layout& layout, LearnOptions options, Learned& out) {
    options.virtual_mass = mass_within(plant, training);
    if (options.offset == OffsetMode::equilibrium) {
        options.point = equilibrium_point(plant, layout, training.gap_lower, training.gap_upper);
    }
    out.model = learn(out.moments, layout, options);
    const auto correction = choose<Correction>(
        a.correction, {{"p1", Correction::p1}, {"p2", Correction::p2}, {"p3", Correction::p3}, {"p4", Correction::p4}},
        "--correction");
    if (correction != Correction::p1) {
        if (out.rows.empty()) {
            throw core::UsageError(
                "missing", "corrections need ground_force and drag_force, or total_force, among the auxiliaries");
        }
        out.model = corrected(out.model, correction, out.rows);
    }
}

Learned learn_model(const LearnArguments& a, const dynamics::Model& declared, const LearnOptions& options,
                    Shell& shell) {
    dynamics::Conditions held;
    for (const core::NamedValue& v :
         a.conditions.empty() ? std::vector<core::NamedValue>{} : core::parse_assignments(a.conditions)) {
        held.set(v.name, v.value);
    }
    RunSplit split;
    if (!a.data.empty()) {
        split = split_runs(dynamics::read_measurements(a.data), a.compare);
        shell.show(split.train.problems);
        if (a.conditions.empty()) {
            held = dynamics::signals_of(split.train.runs.front()).held;
        }
    }
    const SeparatedPlant plant = separate(declared, held);
    const TrainingOptions training = training_options(a, plant);
    Layout layout{{"input_force"}, {"heave_velocity", "gap"}, 2};
    layout.states.insert(layout.states.end(), training.auxiliaries.begin(), training.auxiliaries.end());
    Learned out;
    out.warnings =
        a.data.empty() ? show_table_warnings(shell, declared, held) : show_table_warnings(shell, declared, split.train);
    out.held_at_reference = show_held_at_reference(shell, declared, held);
    if (has_forces(layout)) {
        out.rows = heave_rows(layout, mass_within(plant, training), plant.bias);
    }
    if (!a.moments_of.empty()) {
        if (by_snapshots(a) || !a.data.empty()) {
            throw core::UsageError("range",
                                   "--moments-of is a training set of its own: no --data, and --method grid or time");
        }
        out.moments = moments_of_file(a.moments_of, layout.names(), shell.progress());
    } else {
        const TrainingSet set = samples_for(a, declared, plant, training, split, shell);
        out.remarks = set.remarks;
        if (!a.samples_out.empty()) {
            write_npy(a.samples_out, set.values.data(), set.count, layout.channels());
        }
        out.moments = moments(set.view(), layout.names(), shell.progress());
    }
    if (by_snapshots(a)) {
        const double step = option_value("--step", a.step, "s");
        out.model = learn_dmd(
            a.data.empty()
                ? snapshot_pairs(plant, training, step, shell.progress())
                : snapshot_pairs(motions_from_runs(declared, split.train, option_value("--horizon", a.horizon, "s"), {},
                                                   shell.progress()),
                                 training.auxiliaries, step),
            a.order);
    } else {
        learn_from_samples(a, plant, training, layout, options, out);
    }
    if (a.compare) {
        compare(a, declared, plant, training, split, out, shell);
    }
    return out;
}

nlohmann::json describe(const Learned& l, const LearnOptions& options, bool scan, bool snapshots) {
    nlohmann::json json = l.model;
    if (l.model.layout.states.size() > l.model.layout.measured) {
        json["separability"] = separability(l.model);
        json["robustness"] = {{"j_zeta", bounds_json(l.model.j_zeta())},
                              {"symmetric_part", symmetric_part_abscissa(l.model.j_zeta())},
                              {"performance_ratio",
                               l.model.j_x().largest() > 0 ? performance_ratio(l.model.j_zeta(), l.model.j_x()) : 0}};
    }
    const DerivativeError e = derivative_error(l.model, l.moments);
    json["derivative_error"] = {{"rms", e.rms}, {"relative", e.relative}};
    if (!l.predictions.empty()) {
        json["predictions"] = {{"on", l.tested_on}, {"models", l.predictions}};
    }
    if (snapshots) {
        return json;
    }
    LearnOptions best = options;
    best.fit = Fit::least_squares;
    best.order = 0;
    best.offset = OffsetMode::mean;
    AugmentedModel recommended = learn(l.moments, l.model.layout, best);
    if (!l.rows.empty()) {
        fix_rows(recommended, l.rows);
    }
    json["recommended"] = {{"fit", "least_squares with known rows"},
                           {"A", matrix_json(recommended.A)},
                           {"B", matrix_json(recommended.B)},
                           {"offset", recommended.offset}};
    if (scan) {
        json["scan"] = scan_json(l.moments, l.model.layout, options);
    }
    return json;
}

std::string text_of(const Learned& l) {
    const AugmentedModel& m = l.model;
    std::string text = "order " + std::to_string(m.order) + " of rank " + std::to_string(m.rank) + " from " +
                       core::counted(m.samples, "sample") + ", " + m.method + "\n";
    for (std::size_t i = 0; i < m.layout.states.size(); ++i) {
        text += "  d " + m.layout.states[i] + " =";
        for (std::size_t j = 0; j < m.layout.states.size(); ++j) {
            text += " " + core::format_number(m.A(i, j), 5);
        }
        text += " |";
        for (std::size_t j = 0; j < m.layout.inputs.size(); ++j) {
            text += " " + core::format_number(m.B(i, j), 5);
        }
        text += " | " + core::format_number(m.offset[i], 4) + "\n";
    }
    if (m.layout.states.size() > m.layout.measured) {
        text += separability(m).explanation + "\n";
    }
    if (!l.predictions.empty()) {
        text += "\nrms errors on " + l.tested_on + "\n" + prediction_text(l.predictions);
    }
    return text;
}

int run_learn(const LearnArguments& a, Shell& shell) {
    for (const std::string& file : {a.out, a.plot, a.samples_out}) {
        Shell::will_write(file);
    }
    const dynamics::Model declared = dynamics::read_model(a.model);
    LearnOptions options;
    options.order = a.order;
    // An order asks for the thesis's truncated model; without one, for the best linear law.
    const std::string fit = !a.fit.empty() ? a.fit : a.order > 0 ? "method2" : "least_squares";
    options.fit = choose<Fit>(fit,
                              {{"least_squares", Fit::least_squares},
                               {"weighted_latent", Fit::weighted_latent},
                               {"method1", Fit::method1},
                               {"method2", Fit::method2}},
                              "--fit");
    options.offset = choose<OffsetMode>(
        a.offset, {{"mean", OffsetMode::mean}, {"none", OffsetMode::none}, {"equilibrium", OffsetMode::equilibrium}},
        "--offset");
    const Learned learned = learn_model(a, declared, options, shell);
    shell.show(learned.remarks);
    shell.show(learned.model.remarks);
    nlohmann::json json = describe(learned, options, a.scan, by_snapshots(a));
    json["warnings"] = learned.warnings;
    json["held_at_reference"] = learned.held_at_reference;
    if (!a.out.empty()) {
        core::write_file(a.out, json.dump(2) + "\n");
    }
    if (shell.json) {
        shell.print_json(json);
    }
    shell.print(text_of(learned));
    return ExitCode::done;
}

}  // namespace

void add_learn_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("learn", "the data-driven linear model of velocity, gap and forces");
    auto a = std::make_shared<LearnArguments>();
    command->add_option("model", a->model, "the model (model.toml)")->required();
    command->add_option("--method", a->method,
                        "grid: samples of the region (default); time: along trajectories; dmdc, edmd: dynamic mode "
                        "decomposition with control from snapshots, plain or over the auxiliaries as a dictionary");
    command->add_option("--order", a->order, "latent variables kept (default: the rank, by least squares)");
    command->add_option("--fit", a->fit, "least_squares, weighted_latent, method1, method2 (default with --order)");
    command->add_option("--offset", a->offset, "mean (default), none, equilibrium");
    command->add_option("--correction", a->correction,
                        "p1 as fitted (default), p2 known rows, p3 no gap column, p4 every structural zero");
    command->add_option("--region", a->region,
                        "gap=0:1.2,heave_velocity=-0.03:0.03 (default: the force table, 30 mm/s)");
    command->add_option("--samples", a->samples, "how many (default 50000, at most 4000000)");
    command->add_option("--mesh", a->mesh, "a deterministic grid instead: inputs x velocities x gaps, 5x41x61");
    command->add_option("--focus", a->focus, "lower:upper:share: this share of samples from a band of gaps");
    command->add_option("--excitation", a->excitation, "pink (default), white, pulses, none");
    command->add_option("--input-sigma", a->input_sigma,
                        "deviation of the input (default: half the largest ground force)");
    command->add_option("--for", a->duration, "time: length of each trajectory (default 10 s)");
    command->add_option("--every", a->interval, "time: interval of samples (default 0.1 s)");
    command->add_flag("--at-rest", a->at_rest, "time: start each trajectory at rest");
    command->add_option("--auxiliaries", a->auxiliaries,
                        "ground_force,drag_force (default), total_force, ground_slope, drag_slope, gap_squared, "
                        "gap_cubed, velocity_squared");
    command->add_option("--conditions", a->conditions, "what is held: speed=0.5m/s,jet_voltage=8V");
    command->add_option("--data", a->data, "train on measured runs (folder with dataset.toml), smoothed by the model");
    command->add_option("--moments-of", a->moments_of,
                        "train on samples of a NumPy file, streamed (input, states, derivatives)");
    command->add_option("--samples-out", a->samples_out, "write the training samples as a NumPy file");
    command->add_option("--step", a->step, "between the snapshots of dmdc and edmd (default 0.1 s)");
    command->add_flag("--compare", a->compare,
                      "errors of derivatives and of long predictions on test motions (or test runs of --data), "
                      "beside tangent, equivalent-linear, dmdc, edmd and nonlinear models");
    command->add_option("--horizon", a->horizon, "of the predictions (default 10 s)");
    command->add_option("--plot", a->plot, "--compare: errors of the predicted gap (.png, .pdf)");
    command->add_option("--seed", a->seed, "seed of the samples (default 1)");
    command->add_flag("--scan", a->scan, "errors and poles at every order, in the JSON");
    command->add_option("--out", a->out, "the model as JSON");
    command->footer(
        "Examples:\n"
        "  underbody learn model.toml --method grid --json\n"
        "  underbody learn model.toml --method grid --order 6 --scan --out learned.json\n"
        "  underbody learn model.toml --method time --region gap=0:0.3,heave_velocity=-0.03:0.03 --correction p3\n"
        "  underbody learn model.toml --auxiliaries total_force --data runs\n"
        "  underbody learn model.toml --method edmd --auxiliaries ground_force,gap_squared --compare --plot peers.png\n"
        "  underbody learn model.toml --data runs --compare --horizon 5s\n"
        "States are heave_velocity, gap and the auxiliaries; the input is input_force; dx = A x + B u + offset.");
    shell.on(command, [a, &shell] { return run_learn(*a, shell); });
}

}  // namespace underbody::studio
