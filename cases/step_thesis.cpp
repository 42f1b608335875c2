// The thesis's figures from our own runs, and its statements beside what we compute: chapters 7 and 8, and dynamics.
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "cases/thesis/claims.h"

namespace underbody::cases {

namespace {

/// One part of the thesis: a document of claims and its figures. `make` makes a study with `figures`, at most once.
void run_part(Engine& engine, const std::string& name, const Key& key, const std::function<thesis::Study()>& make) {
    Shared<thesis::Study> study(engine.states(), make);
    const auto made = engine.make("thesis", name, key, [&] {
        nlohmann::json claims;
        to_json(claims, study.get());
        claims["figure_names"] = nlohmann::json::array();
        for (const auto& [figure, drawn] : study.get().figures) {
            claims["figure_names"].push_back(figure);
        }
        return claims.dump();
    });
    if (!made) {
        return;
    }
    const std::string text = engine.value(*made);
    engine.add_document("thesis/" + name, text);
    const auto document = nlohmann::json::parse(text);
    for (const nlohmann::json& figure : document.at("figure_names")) {
        Key of_figure = key;
        of_figure.from(*made);
        engine.figure("thesis/" + figure.get<std::string>(), of_figure, [&] {
            const core::Figure* found = study.get().figure(figure.get<std::string>());
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
        run_part(engine, "thesis", Key("thesis", {"surrogates/tables", "surrogates/dynamics", "surrogates/estimator"}),
                 [&] { return thesis::separation(engine.progress); });
    }
    if (engine.study.thesis_dynamics) {
        run_part(engine, "dynamics", Key("thesis dynamics", {"surrogates/tables", "surrogates/dynamics"}),
                 [&] { return thesis::dynamics_of_the_body(engine.progress); });
    }
}

}  // namespace underbody::cases
