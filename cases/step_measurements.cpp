// Measured runs against the declared model: the residual, and what the model lacks.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "core/file.h"
#include "core/text.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/residual.h"
#include "surrogates/dynamics/measurements.h"
#include "surrogates/dynamics/model.h"

namespace underbody::cases {

namespace {

namespace fs = std::filesystem;

const std::vector<std::string> rooms = {"surrogates/tables", "surrogates/dynamics", "surrogates/estimator", "surrogates/discovery"};

/// The files of a discovery folder (all text), its first figures as PNG in base64: one value for the store.
std::string compute_discovery(Engine& engine, const MeasurementSpec& spec) {
    const auto model = dynamics::read_model(spec.model);
    const auto data = dynamics::read_measurements(spec.data);
    const auto found = discovery::discover(model, data, {}, engine.progress);
    const auto renderer = [&](const core::Figure& figure) {
        return engine.options.renderer ? engine.options.renderer(figure) : std::string();
    };
    const core::TemporaryFolder scratch;
    discovery::write_discovery(found, model, data, scratch.path(), renderer);
    nlohmann::json packed = {{"files", nlohmann::json::object()}};
    for (const auto& entry : fs::directory_iterator(scratch.path())) {
        if (entry.is_regular_file()) {
            packed["files"][entry.path().filename().string()] = core::read_file(entry.path());
        }
    }
    return packed.dump();
}

/// Residual force of the declared model: numbers, sentences and figures.
void run_residual(Engine& engine, const MeasurementSpec& spec, const Key& data_key) {
    Key key("residual", rooms);
    key.add(data_key.digest());
    std::vector<discovery::Residual> residuals;
    const auto compute = [&] {
        if (residuals.empty()) {
            residuals = discovery::measured_residual(dynamics::read_model(spec.model), dynamics::read_measurements(spec.data), engine.progress);
        }
    };
    std::size_t figures = 0;
    const auto made = engine.make("residual", spec.name, key, [&] {
        compute();
        nlohmann::json document = {{"residuals", nlohmann::json::array()}, {"sentences", nlohmann::json::array()}, {"figures", 0}};
        std::size_t count = 0;
        for (const auto& residual : residuals) {
            document["residuals"].push_back(discovery::to_json(residual));
            count += residual.figures.size();
            document["sentences"].push_back(
                "Beyond the declared model, the data ask for a " + residual.quantity + " of " + core::format_number(1e3 * residual.mean, 2) +
                " mN on average and " + core::format_number(1e3 * residual.root_mean_square, 2) +
                " mN root mean square; measuring noise alone would leave about " + core::format_number(1e3 * residual.sigma, 2) + " mN.");
        }
        document["figures"] = count;
        return document.dump();
    });
    if (!made) {
        return;
    }
    engine.add_document("residual/" + spec.name, *made);
    figures = nlohmann::json::parse(*made).at("figures").get<std::size_t>();
    for (std::size_t i = 0; i < std::min<std::size_t>(figures, 8); ++i) {
        engine.figure("residual/" + spec.name + "/" + std::to_string(i), key, [&] {
            compute();
            std::size_t index = i;
            for (const auto& residual : residuals) {
                if (index < residual.figures.size()) {
                    return residual.figures[index];
                }
                index -= residual.figures.size();
            }
            throw core::InputError("missing", "the residual has fewer figures than it had");
        });
    }
}

void run_discovery(Engine& engine, const MeasurementSpec& spec, const Key& data_key) {
    Key key("discovery", rooms);
    key.add(data_key.digest()).add(engine.options.renderer ? "drawn" : "bare");
    const auto made = engine.make("discovery", spec.name, key, [&] { return compute_discovery(engine, spec); });
    if (!made) {
        return;
    }
    const auto packed = nlohmann::json::parse(*made);
    for (const auto& [file, text] : packed.at("files").items()) {
        if (engine.options.write_report) {
            Engine::write_if_changed(engine.report_folder() / "discovery" / spec.name / file, text.get<std::string>());
        }
        if (file == "discovery.json") {
            engine.add_document("discovery/" + spec.name, text.get<std::string>());
        }
    }
}

}  // namespace

void run_measurements(Engine& engine) {
    for (const auto& spec : engine.study.measurements) {
        try {
            Key key("measurement", rooms);
            key.add(engine.hash_of(spec.model)).add(engine.hash_of_folder(spec.data));
            for (const auto& force : dynamics::read_model(spec.model).forces) {
                key.add(engine.hash_of(force.table_path));
            }
            run_residual(engine, spec, key);
            if (spec.discover) {
                run_discovery(engine, spec, key);
            }
        } catch (const core::InputError& error) {
            engine.fail("measurement", spec.name, error.what());
        }
    }
}

}  // namespace underbody::cases
