#include "surrogates/discovery/discovery.h"

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"
#include "surrogates/discovery/residual.h"
#include "surrogates/discovery/static/load_cell.h"
#include "surrogates/discovery/wording.h"
#include "surrogates/dynamics/model/force_error.h"
#include "surrogates/dynamics/model/lineage.h"
#include "surrogates/dynamics/simulate/measured_motion.h"

namespace underbody::discovery {

namespace {

/// Raw logs of a load cell among the runs of a static set become forces at set points.
dynamics::Measurements reduced(const dynamics::Measurements& raw) {
    dynamics::Measurements data = raw;
    for (dynamics::MeasuredRun& run : data.runs) {
        if (data.kind == dynamics::MeasurementKind::steady && is_load_cell_log(run.table)) {
            LoadCellReduction reduction = reduce_load_cell(run.table);
            data.problems.push_back({core::Problem::Severity::note,
                                     run.name + " is the log of a load cell: " + reduction_text(reduction),
                                     core::Place{run.file.string(), {}, {}, {}}});
            data.problems.insert(data.problems.end(), reduction.problems.begin(), reduction.problems.end());
            run.table = std::move(reduction.table);
        }
    }
    return data;
}

}  // namespace

namespace {

/// A law without a name that is as large as what the declared tables say of their own error may be that error: said
/// beside the verdict. Empty otherwise, and where the tables state none.
std::string as_large_as_the_tables_error(const dynamics::Model& model, const Discovery& found) {
    constexpr double as_large = 2;  // standard deviations
    if (found.verdict != "unknown" || found.effects.empty() || found.effects.front().uses.size() != 1 ||
        !found.effects.front().uses.front().table) {
        return {};
    }
    const dynamics::EffectUse& use = found.effects.front().uses.front();
    const std::string quantity = use.quantity.empty() ? use.table->quantity() : use.quantity;
    const core::Table& points = use.table->points();
    double corrected = 0, error = 0;
    try {
        const dynamics::ForceError sigma(model, quantity);
        for (std::size_t row = 0; row < points.rows(); ++row) {
            const double value = points.numbers(quantity)[row];
            dynamics::Conditions at = model.conditions;
            for (const tables::TableAxis& axis : use.table->axes()) {
                dynamics::Channel channel{};
                if (!dynamics::find_channel(axis.name, channel)) {
                    return {};
                }
                at[channel] = points.numbers(axis.name)[row];
            }
            if (value != 0) {  // else it has faded
                corrected += value * value;
                error += std::pow(sigma(at), 2);
            }
        }
    } catch (const core::Error&) {
        return {};  // the error hangs on a condition that nobody said
    }
    if (!(corrected > 0) || !(corrected <= as_large * as_large * error)) {
        return {};
    }
    const double ratio = std::sqrt(corrected / error);
    return " It is no larger than what the declared tables say of their own error there (" +
           core::format_number(ratio, 2) + " of it): it may be that error and no effect; more points of the table " +
           "would tell.";
}

/// The model says of what was found what the data could not well tell it from.
void say_ties(Discovery& result) {
    std::vector<std::string> found;
    for (const FoundEffect& effect : result.effects) {
        found.push_back(effect.name);
    }
    const std::string names = verdict_names(result);
    if (result.verdict == "effect" && names != list_of(found)) {
        result.model.lineage.made_from.push_back(std::string(dynamics::tied_line) + names);
    }
}

}  // namespace

Discovery discover(const dynamics::Model& model, const dynamics::Measurements& measured, const DiscoverOptions& options,
                   core::Progress& progress) {
    const auto begin = std::chrono::steady_clock::now();
    const dynamics::Measurements data = reduced(measured);
    const dynamics::Motion* const motion = dynamics::motion_of(model, data);
    Discovery result = data.kind == dynamics::MeasurementKind::steady ? discover_static(model, data, options, progress)
                       : motion != nullptr ? discover_motion(*motion, model, data, options, progress)
                                           : discover_heave(model, data, options, progress);
    if (result.verdict == "none") {
        result.depends_on.clear();  // noise depends on nothing
    }
    result.sentence += as_large_as_the_tables_error(model, result);
    result.model.lineage.made_from.push_back(
        "made by underbody discover from " + model.name + " and the measurements '" +
        (data.title.empty() ? std::filesystem::weakly_canonical(data.folder).filename().string() : data.title) + "'");
    if (!model.file.empty() && std::filesystem::exists(model.file)) {
        result.model.lineage.made_from.push_back("declared model: " + model.file.filename().string() + ", content " +
                                                 core::content_hash_of_file(model.file));
    }
    std::set<std::filesystem::path> hashed;  // runs may be pieces of one file
    for (const dynamics::MeasuredRun& run : data.runs) {
        if (!std::filesystem::exists(run.file) || !hashed.insert(run.file).second) {
            continue;  // made in memory, or told already
        }
        result.model.lineage.made_from.push_back("run " + run.file.filename().string() + ", content " +
                                                 core::content_hash_of_file(run.file));
    }
    result.model.lineage.made_from.push_back("verdict: " + result.sentence);
    say_ties(result);
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return result;
}

namespace {

nlohmann::json number(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr); }

nlohmann::json to_json(const ErrorEstimate& estimate) {
    return {{"rmse", estimate.rmse}, {"low", estimate.low}, {"high", estimate.high}, {"count", estimate.count}};
}

nlohmann::json to_json(const FoundEffect& effect) {
    nlohmann::json json{{"name", effect.name},
                        {"depends_on", effect.depends_on},
                        {"probability", effect.probability},
                        {"evidence", effect.evidence}};
    nlohmann::json& parameters = json["parameters"] = nlohmann::json::object();
    for (const FoundParameter& parameter : effect.parameters) {
        parameters[parameter.name] = {
            {"value", number(parameter.value)}, {"sigma", number(parameter.sigma)}, {"unit", parameter.unit}};
    }
    if (!effect.told_apart_by.empty()) {
        json["told_apart_by"] = effect.told_apart_by;
    }
    for (const dynamics::EffectUse& use : effect.uses) {
        if (!use.parameter.empty()) {
            json["parameter"] = use.parameter;
        }
        if (!use.quantity.empty() && effect.uses.size() == 1) {
            json["quantity"] = use.quantity;
        }
    }
    return json;
}

nlohmann::json to_json(const ErrorChange& change) {
    const double noise = change.noise > 0 ? change.noise : 1;
    nlohmann::json json{{"channel", change.channel},
                        {"unit", change.unit},
                        {"before", to_json(change.before)},
                        {"after", to_json(change.after)},
                        {"in_noise", {{"before", change.before.rmse / noise}, {"after", change.after.rmse / noise}}}};
    if (std::isinf(change.horizon)) {
        json["free_run"] = true;
    } else if (change.horizon > 0) {
        json["horizon_s"] = change.horizon;
    }
    return json;
}

nlohmann::json to_json(const Consequence& consequence) {
    nlohmann::json equilibria = nlohmann::json::array();
    for (const EquilibriumPair& pair : consequence.equilibria) {
        equilibria.push_back({{"name", pair.name},
                              {"stable", pair.stable},
                              {"gap_before", number(pair.gap_before)},
                              {"gap_after", number(pair.gap_after)}});
    }
    nlohmann::json json{{"equilibria", equilibria},
                        {"region_before", consequence.region_before},
                        {"region_after", consequence.region_after},
                        {"estimator", nullptr},
                        {"text", consequence.text}};
    if (consequence.estimator_before > 0) {
        json["estimator"] = {{"quantity", "heave_velocity"},
                             {"unit", "m/s"},
                             {"rmse_before", consequence.estimator_before},
                             {"rmse_after", consequence.estimator_after}};
    }
    return json;
}

nlohmann::json to_json(const DetectionLimit& limit) {
    return {{"name", limit.name}, {"parameter", limit.parameter}, {"value", number(limit.value)}, {"unit", limit.unit}};
}

template <typename T>
nlohmann::json list_of(const std::vector<T>& all) {
    nlohmann::json list = nlohmann::json::array();
    for (const T& one : all) {
        list.push_back(to_json(one));
    }
    return list;
}

/// "error", "errors" and "rest": what the model misses, before and after.
void add_errors(const Discovery& d, nlohmann::json& json) {
    if (d.error.empty()) {
        return;
    }
    json["error"] = to_json(d.error.front());
    json["error"]["held_out"] = d.held_out;
    json["errors"] = list_of(d.error);
    if (d.rest.twins > 0) {
        const double unit = d.error.front().noise > 0 ? d.error.front().noise : 1;
        json["rest"] = {{"is_noise", d.rest.is_noise},
                        {"unexplained_in_noise", d.rest.is_noise ? 0.0 : d.rest.unexplained / unit},
                        {"twins_in_noise", d.rest.twins / unit},
                        {"depends_on", d.rest.depends_on}};
        if (d.rest.or_noise_figure) {
            json["rest"]["or_noise_figure"] = true;
        }
    }
}

/// What only some data sets have.
void add_particulars(const Discovery& d, nlohmann::json& json) {
    if (d.motion != "heave") {
        json["motion"] = d.motion;
    }
    for (const AxisResidual& axis : d.axes) {
        json["axes"].push_back({{"quantity", axis.quantity},
                                {"unit", axis.unit},
                                {"before", {{"mean", axis.mean_before}, {"rms", axis.rms_before}}},
                                {"after", {{"mean", axis.mean_after}, {"rms", axis.rms_after}}},
                                {"sigma", axis.sigma}});
    }
    if (!d.mended.empty()) {
        json["records_mended"] = d.mended;
    }
    if (d.by_run) {
        json["differs_by_run"] = {{"name", d.by_run->name},  {"parameter", d.by_run->parameter},
                                  {"unit", d.by_run->unit},  {"chance", d.by_run->chance},
                                  {"runs", d.by_run->runs},  {"value", d.by_run->value},
                                  {"sigma", d.by_run->sigma}};
    }
    if (d.placebo.twins > 0) {
        json["placebo"] = {{"twins", d.placebo.twins},
                           {"false_alarms", d.placebo.alarms},
                           {"error_after_over_before", d.placebo.error_ratio}};
    }
}

}  // namespace

nlohmann::json to_json(const Discovery& d) {
    nlohmann::json json;
    json["verdict"] = d.verdict;
    json["headline"] = headline(d);
    json["sentence"] = d.sentence;
    json["effects"] = list_of(d.effects);
    json["alternatives"] = list_of(d.alternatives);
    for (std::size_t i = 0; i < d.alternatives.size(); ++i) {
        json["alternatives"][i]["told_apart_by"] = d.alternatives[i].told_apart_by;
    }
    json["none_probability"] = d.none_probability;
    json["depends_on"] = d.depends_on;
    json["gate"] = {{"p", d.gate}, {"open", d.structure}};
    json["stability"] = d.stability;
    nlohmann::json& noise = json["noise"] = nlohmann::json::object();
    for (const auto& [channel, used] : d.noise) {
        noise[channel] = {
            {"value", used.value}, {"unit", used.unit}, {"from", used.from}, {"estimated", number(used.estimated)}};
    }
    add_errors(d, json);
    add_particulars(d, json);
    json["detection_limits"] = list_of(d.limits);
    json["consequence"] = to_json(d.consequence);
    if (d.made_again) {
        json["consequence"].update(*d.made_again);
    }
    json["next_experiment"] = d.next_experiment;
    json["next_experiment_power"] = d.next_power;
    json["problems"] = json_of(d.problems);
    return json;
}

void write_discovery(const Discovery& discovery, const dynamics::Model& before, const dynamics::Measurements& data,
                     const std::filesystem::path& folder, const FigureRenderer& renderer) {
    std::filesystem::create_directories(folder);
    if (discovery.next_set_points.rows() > 0) {
        core::write_csv(folder / "next-experiment.csv", discovery.next_set_points);
    }
    dynamics::write_model(discovery.model, folder / "model.toml");
    core::write_file(folder / "report.html", report_html(discovery, before, data, renderer));
    core::write_file(folder / "discovery.json", to_json(discovery).dump(2) + "\n");
}

}  // namespace underbody::discovery
