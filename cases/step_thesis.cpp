// Chapters 7 and 8 of the thesis: its figures from our own runs, its statements beside what we compute.
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "surrogates/estimator/thesis.h"

namespace underbody::cases {

void run_thesis(Engine& engine) {
    if (!engine.study.thesis) {
        return;
    }
    const Key key("thesis", {"surrogates/tables", "surrogates/dynamics", "surrogates/estimator"});
    std::optional<estimator::ThesisStudy> thesis;
    const auto compute = [&]() -> const estimator::ThesisStudy& {
        if (!thesis) {
            thesis = estimator::thesis_study(engine.progress);
        }
        return *thesis;
    };
    const auto made = engine.make("thesis", "thesis", key, [&] {
        nlohmann::json document;
        estimator::to_json(document, compute());
        document["figure_names"] = nlohmann::json::array();
        for (const auto& [name, figure] : compute().figures) {
            document["figure_names"].push_back(name);
        }
        return document.dump();
    });
    if (!made) {
        return;
    }
    engine.add_document("thesis/thesis", *made);
    const auto document = nlohmann::json::parse(*made);
    for (const auto& name : document.at("figure_names")) {
        engine.figure("thesis/" + name.get<std::string>(), key, [&] {
            const core::Figure* figure = compute().figure(name.get<std::string>());
            if (figure == nullptr) {
                throw core::InputError("missing", "the thesis study lost its figure " + name.get<std::string>());
            }
            return *figure;
        });
    }
}

}  // namespace underbody::cases
