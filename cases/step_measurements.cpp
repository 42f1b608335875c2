// Measured runs against the declared model: the residual, and what the model lacks.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "cases/names_in_study.h"
#include "core/file.h"
#include "core/text.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/made_again.h"
#include "surrogates/discovery/residual.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::cases {

namespace {

namespace fs = std::filesystem;

const std::vector<std::string> rooms = {"surrogates/tables", "surrogates/dynamics", "surrogates/estimator",
                                        "surrogates/discovery"};

/// The files of a discovery folder (all text), its first figures as PNG in base64: one value for the store.
std::string compute_discovery(Engine& engine, const MeasurementSpec& spec) {
    const auto model = named_in_study(engine, dynamics::read_model(spec.model), spec.model);
    const auto data = named_in_study(engine, dynamics::read_measurements(spec.data));
    discovery::DiscoverOptions options;
    options.placebo_twins = discovery::usual_placebo_twins;
    auto found = discovery::discover(model, data, options, engine.progress);
    (void)discovery::make_again(found, model, data, engine.progress);
    const auto renderer = [&](const core::Figure& figure) {
        return engine.options.renderer ? engine.options.renderer(figure) : std::string();
    };
    const Scratch scratch;
    discovery::write_discovery(found, model, data, scratch.path(), renderer);
    nlohmann::json packed = {{"files", nlohmann::json::object()}};
    for (const auto& entry : fs::directory_iterator(scratch.path())) {
        if (entry.is_regular_file()) {
            packed["files"][entry.path().filename().string()] = core::read_file(entry.path());
        }
    }
    return packed.dump();
}

std::string residual_document(const std::vector<discovery::Residual>& residuals) {
    nlohmann::json document = {
        {"residuals", nlohmann::json::array()}, {"sentences", nlohmann::json::array()}, {"figures", 0}};
    std::size_t count = 0;
    for (const auto& residual : residuals) {
        document["residuals"].push_back(discovery::to_json(residual));
        count += residual.figures.size();
        document["sentences"].push_back("Beyond the declared model, the data ask for a " + residual.quantity + " of " +
                                        core::format_number(1e3 * residual.mean, 2) + " mN on average and " +
                                        core::format_number(1e3 * residual.root_mean_square, 2) +
                                        " mN root mean square; measuring noise alone would leave about " +
                                        core::format_number(1e3 * residual.sigma, 2) + " mN.");
    }
    document["figures"] = count;
    return document.dump();
}

core::Figure figure_of(const std::vector<discovery::Residual>& residuals, std::size_t index) {
    for (const auto& residual : residuals) {
        if (index < residual.figures.size()) {
            return residual.figures[index];
        }
        index -= residual.figures.size();
    }
    throw core::InputError("missing", "the residual has fewer figures than it had");
}

Key measurement_key(const std::string& kind, const Engine& engine, const MeasurementSpec& spec) {
    Key key(kind, rooms);
    key.add("model", engine.path_in_study(spec.model)).add("data", engine.path_in_study(spec.data));
    return key;
}

/// Residual force of the declared model: numbers, sentences and figures.
void run_residual(Engine& engine, const MeasurementSpec& spec) {
    const Key key = measurement_key("residual", engine, spec);
    Shared<std::vector<discovery::Residual>> residuals(engine.states(), [&] {
        return discovery::measured_residual(named_in_study(engine, dynamics::read_model(spec.model), spec.model),
                                            named_in_study(engine, dynamics::read_measurements(spec.data)),
                                            engine.progress);
    });
    const auto made = engine.make("residual", spec.name, key, [&] { return residual_document(residuals.get()); });
    if (!made) {
        return;
    }
    const std::string text = engine.value(*made);
    engine.add_document("residual/" + spec.name, text);
    const auto figures = nlohmann::json::parse(text).at("figures").get<std::size_t>();
    for (std::size_t i = 0; i < std::min<std::size_t>(figures, 8); ++i) {
        Key of_figure = key;
        of_figure.from(*made);
        engine.figure("residual/" + spec.name + "/" + std::to_string(i), of_figure,
                      [&] { return figure_of(residuals.get(), i); });
    }
}

void run_discovery(Engine& engine, const MeasurementSpec& spec) {
    Key key = measurement_key("discovery", engine, spec);
    const bool drawn = engine.options.renderer || engine.mode == Engine::Mode::look;
    key.add("figures", drawn ? "drawn" : "none");
    const auto made = engine.make("discovery", spec.name, key, [&] { return compute_discovery(engine, spec); });
    if (!made) {
        return;
    }
    const auto packed = nlohmann::json::parse(engine.value(*made));
    auto model = nlohmann::json::object();  // what accepting it takes, wherever the report lies
    for (const auto& [file, text] : packed.at("files").items()) {
        if (file == "model.toml" || (fs::path(file).extension() == ".csv" && file != "next-experiment.csv")) {
            model[file] = text;
        }
        if (engine.options.write_report && engine.mode == Engine::Mode::compute) {
            Engine::write_if_changed(engine.report_folder() / "discovery" / spec.name / file, text.get<std::string>());
        }
        if (file == "discovery.json") {
            engine.add_document("discovery/" + spec.name, text.get<std::string>());
        }
    }
    engine.add_document("found-model/" + spec.name, model.dump());
}

}  // namespace

void run_measurements(Engine& engine) {
    for (const auto& spec : engine.study.measurements) {
        run_residual(engine, spec);
        if (spec.discover) {
            run_discovery(engine, spec);
        }
    }
}

}  // namespace underbody::cases
