#include "surrogates/discovery/discovery.h"

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/hash.h"
#include "core/html.h"
#include "core/text.h"
#include "surrogates/discovery/wording.h"

namespace underbody::discovery {

Discovery discover(const dynamics::Model& model, const dynamics::Measurements& data, const DiscoverOptions& options,
                   core::Progress& progress) {
    const auto begin = std::chrono::steady_clock::now();
    Discovery result = data.kind == dynamics::MeasurementKind::steady ? discover_static(model, data, options, progress)
                                                                      : discover_time_series(model, data, options, progress);
    result.model.lineage.made_from.push_back("made by underbody discover from " + model.name + " and the measurements '" + data.title +
                                             "'");
    if (!model.file.empty() && std::filesystem::exists(model.file)) {
        result.model.lineage.made_from.push_back("declared model: " + model.file.filename().string() + ", content " +
                                                 core::content_hash_of_file(model.file));
    }
    for (const dynamics::MeasuredRun& run : data.runs) {
        if (!std::filesystem::exists(run.file)) {
            continue;  // made in memory
        }
        result.model.lineage.made_from.push_back("run " + run.file.filename().string() + ", content " +
                                                 core::content_hash_of_file(run.file));
    }
    result.model.lineage.made_from.push_back("verdict: " + result.sentence);
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
        parameters[parameter.name] = {{"value", number(parameter.value)}, {"sigma", number(parameter.sigma)}, {"unit", parameter.unit}};
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
    if (change.horizon > 0) {
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
    return {{"equilibria", equilibria},
            {"region_before", consequence.region_before},
            {"region_after", consequence.region_after},
            {"text", consequence.text}};
}

}  // namespace

nlohmann::json to_json(const Discovery& d) {
    nlohmann::json json;
    json["verdict"] = d.verdict;
    json["sentence"] = d.sentence;
    json["effects"] = nlohmann::json::array();
    for (const FoundEffect& effect : d.effects) {
        json["effects"].push_back(to_json(effect));
    }
    json["alternatives"] = nlohmann::json::array();
    for (const FoundEffect& effect : d.alternatives) {
        json["alternatives"].push_back(to_json(effect));
    }
    json["none_probability"] = d.none_probability;
    json["depends_on"] = d.depends_on;
    json["gate"] = {{"p", d.gate}};
    json["stability"] = d.stability;
    nlohmann::json& noise = json["noise"] = nlohmann::json::object();
    for (const auto& [channel, used] : d.noise) {
        noise[channel] = {{"value", used.value}, {"unit", used.unit}, {"from", used.from}, {"estimated", number(used.estimated)}};
    }
    if (!d.error.empty()) {
        json["error"] = to_json(d.error.front());
        json["error"]["held_out"] = d.held_out;
        json["errors"] = nlohmann::json::array();
        for (const ErrorChange& change : d.error) {
            json["errors"].push_back(to_json(change));
        }
    }
    json["detection_limits"] = nlohmann::json::array();
    for (const DetectionLimit& limit : d.limits) {
        json["detection_limits"].push_back(
            {{"name", limit.name}, {"parameter", limit.parameter}, {"value", number(limit.value)}, {"unit", limit.unit}});
    }
    json["consequence"] = to_json(d.consequence);
    json["next_experiment"] = d.next_experiment;
    json["next_experiment_power"] = d.next_power;
    json["problems"] = nlohmann::json::array();
    for (const core::Problem& problem : d.problems) {
        json["problems"].push_back({{"message", problem.message}, {"place", problem.place.text()}});
    }
    return json;
}

namespace {

std::vector<std::string> effect_row(const FoundEffect& effect) {
    std::string numbers;
    for (const FoundParameter& parameter : effect.parameters) {
        numbers += (numbers.empty() ? "" : "; ") + parameter.name + " " + value_text(parameter);
    }
    return {effect.name, core::format_number(effect.probability, 3), numbers, list_of(effect.depends_on),
            effect.told_apart_by.empty() ? effect.evidence : effect.told_apart_by};
}

void add_error(core::HtmlPage& page, const Discovery& d) {
    page.section("Error before and after");
    page.paragraph("Measured on " + d.held_out + ".");
    std::vector<std::vector<std::string>> rows;
    for (const ErrorChange& change : d.error) {
        const auto text = [&](const ErrorEstimate& e) {
            return core::format_number(e.rmse, 3) + " (" + core::format_number(e.low, 3) + " to " + core::format_number(e.high, 3) + ")";
        };
        rows.push_back({change.channel + " [" + change.unit + "]",
                        change.horizon > 0 ? (std::isinf(change.horizon) ? "free run" : core::format_number(change.horizon, 3) + " s") : "set points",
                        text(change.before), text(change.after), core::format_number(change.before.rmse / std::max(change.noise, 1e-300), 3),
                        core::format_number(change.after.rmse / std::max(change.noise, 1e-300), 3)});
    }
    page.table({"channel", "horizon", "before (95 %)", "after (95 %)", "before, in noise", "after, in noise"}, rows,
               "Root mean square of measured less predicted; intervals from resampling whole runs or set points.");
}

}  // namespace

std::string report_html(const Discovery& d, const dynamics::Model& before, const dynamics::Measurements& data,
                        const FigureRenderer& renderer) {
    core::HtmlPage page("What the model lacks: " + d.verdict,
                        before.name + " against " + (data.title.empty() ? data.folder.string() : data.title));
    page.section("Verdict");
    page.paragraph(d.sentence);
    for (const core::Problem& problem : d.problems) {
        page.warning(problem.message);
    }
    std::vector<core::HtmlPage::Fact> facts;
    if (!d.effects.empty()) {
        facts.push_back({core::format_number(100 * d.effects.front().probability, 3) + " %", "probability of the verdict"});
    } else {
        facts.push_back({core::format_number(100 * d.none_probability, 3) + " %", "probability that nothing is missing"});
    }
    facts.push_back({core::format_number(100 * d.stability, 3) + " %", "of resampled data give the same verdict"});
    if (!d.error.empty()) {
        const ErrorChange& chief = d.error.front();
        facts.push_back({core::format_number(chief.before.rmse / std::max(chief.noise, 1e-300), 3) + " -> " +
                             core::format_number(chief.after.rmse / std::max(chief.noise, 1e-300), 3),
                         "error of " + chief.channel + " in noise, before -> after"});
    }
    page.facts(facts);
    std::vector<core::HtmlPage::Picture> pictures;
    for (const core::Figure& figure : d.figures) {
        if (renderer) {
            pictures.push_back({renderer(figure), figure.caption, figure.title});
        }
    }
    page.pictures(pictures);
    page.section("How sure, and what else it could be");
    std::vector<std::vector<std::string>> rows;
    for (const FoundEffect& effect : d.effects) {
        rows.push_back(effect_row(effect));
    }
    for (const FoundEffect& effect : d.alternatives) {
        rows.push_back(effect_row(effect));
    }
    rows.push_back({"none", core::format_number(d.none_probability, 3), "", "",
                    "chance of as much structure in noise alone: " + core::format_number(d.gate, 2)});
    page.table({"effect", "probability", "numbers", "depends on", "evidence, or what would tell it apart"}, rows);
    page.paragraph("The residual depends on " + list_of(d.depends_on) + " (found without any named effect).");
    add_error(page, d);
    page.section("What it changes");
    page.paragraph(d.consequence.text);
    if (!d.consequence.equilibria.empty()) {
        std::vector<std::vector<std::string>> equilibria;
        for (const EquilibriumPair& pair : d.consequence.equilibria) {
            const auto text = [](double gap) { return std::isfinite(gap) ? core::format_number(1000 * gap, 4) : std::string("gone"); };
            equilibria.push_back({pair.name, pair.stable ? "stable" : "unstable", text(pair.gap_before), text(pair.gap_after)});
        }
        page.table({"equilibrium", "kind", "gap before [mm]", "gap after [mm]"}, equilibria);
    }
    if (!d.consequence.region_before.empty()) {
        std::vector<std::vector<std::string>> regions;
        std::map<std::string, std::pair<double, double>> both;
        for (const auto& [name, share] : d.consequence.region_before) {
            both[name].first = share;
        }
        for (const auto& [name, share] : d.consequence.region_after) {
            both[name].second = share;
        }
        for (const auto& [name, shares] : both) {
            regions.push_back({name, core::format_number(100 * shares.first, 3), core::format_number(100 * shares.second, 3)});
        }
        page.table({"where a start ends", "share before [%]", "share after [%]"}, regions);
    }
    page.section("The next experiment");
    page.paragraph(d.next_experiment);
    page.section("Noise and limits");
    std::vector<std::vector<std::string>> noise;
    for (const auto& [channel, used] : d.noise) {
        noise.push_back({channel + " [" + used.unit + "]", core::format_number(used.value, 3), core::format_number(used.estimated, 3), used.from});
    }
    page.table({"channel", "used", "estimated", "from"}, noise);
    std::vector<std::vector<std::string>> limits;
    for (const DetectionLimit& limit : d.limits) {
        limits.push_back({limit.name, limit.parameter, core::format_number(limit.value, 3) + " " + limit.unit});
    }
    page.folded_table("Smallest effects that these data would have shown", {"effect", "parameter", "limit"}, limits);
    page.section("From what it was made");
    page.list(d.model.lineage.made_from);
    return page.text();
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
