// The thesis's figures from our own runs, and its statements beside what we compute: chapters 7 and 8, and dynamics.
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "surrogates/dynamics/thesis.h"
#include "surrogates/estimator/thesis.h"

namespace underbody::cases {

namespace {

/// One part of the thesis: a document of claims and its figures. `compute` makes a study with `figures`, at most once.
template <class Study, class Compute>
void run_part(Engine& engine, const std::string& name, const Key& key, const Compute& make) {
    std::optional<Study> study;
    const auto compute = [&]() -> const Study& {
        if (!study) {
            study = make();
        }
        return *study;
    };
    const std::optional<std::string> made = engine.make("thesis", name, key, [&] {
        nlohmann::json document;
        to_json(document, compute());
        document["figure_names"] = nlohmann::json::array();
        for (const auto& [figure, drawn] : compute().figures) {
            document["figure_names"].push_back(figure);
        }
        return document.dump();
    });
    if (!made) {
        return;
    }
    engine.add_document("thesis/" + name, *made);
    const nlohmann::json document = nlohmann::json::parse(*made);
    for (const nlohmann::json& figure : document.at("figure_names")) {
        engine.figure("thesis/" + figure.get<std::string>(), key, [&] {
            const core::Figure* found = compute().figure(figure.get<std::string>());
            if (found == nullptr) {
                throw core::InputError("missing", "the thesis study lost its figure " + figure.get<std::string>());
            }
            return *found;
        });
    }
}

}  // namespace

void run_thesis(Engine& engine) {
    if (engine.study.thesis) {
        run_part<estimator::ThesisStudy>(
            engine, "thesis", Key("thesis", {"surrogates/tables", "surrogates/dynamics", "surrogates/estimator"}),
            [&] { return estimator::thesis_study(engine.progress); });
    }
    if (engine.study.thesis_dynamics) {
        run_part<dynamics::ThesisDynamics>(engine, "dynamics",
                                           Key("thesis dynamics", {"surrogates/tables", "surrogates/dynamics"}),
                                           [&] { return dynamics::thesis_dynamics(engine.progress); });
    }
}

}  // namespace underbody::cases
