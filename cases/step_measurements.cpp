// Measured runs against the declared model: the residual, and what the model lacks.
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "core/file.h"
#include "surrogates/discovery/discovery.h"
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
            if (spec.discover) {
                run_discovery(engine, spec, key);
            }
        } catch (const core::InputError& error) {
            engine.fail("measurement", spec.name, error.what());
        }
    }
}

}  // namespace underbody::cases
