// The data-driven model beside the models it replaces and the peers of today.
#include "surrogates/estimator/model/peers.h"

#include "cases/thesis/parts.h"

namespace underbody::thesis {

namespace {

const PredictionError& named(const std::vector<PredictionError>& errors, const std::string& name) {
    for (const PredictionError& e : errors) {
        if (e.model == name) {
            return e;
        }
    }
    throw core::InputError("name", "no model '" + name + "' was compared");
}

std::string list(const std::vector<PredictionError>& errors) {
    std::string text;
    for (const PredictionError& e : errors) {
        text += (text.empty() ? "" : "; ") + e.model + " " + number(1e3 * e.acceleration, 3) + " mm/s^2, " +
                number(1e3 * e.gap, 3) + " mm" + (e.diverged ? " (leaves the range)" : "");
    }
    return text;
}

}  // namespace

void add_peers(Study& study, core::Progress& progress) {
    const SeparatedPlant plant = reference_plant();
    for (const double reach : {0.3, 1.2}) {
        TrainingOptions training;
        training.samples = 20000;
        training.gap_upper = reach;
        PredictionTest test;
        test.gap_upper = reach;
        const auto errors = compare_predictions(plant, usual_peers(plant, training, 0.1, progress),
                                                test_motions(plant, test), progress);
        const bool near = reach < 1;
        const std::string where = near ? "0 to 0.3 m" : "0 to 1.2 m";
        study.figures.emplace_back(
            near ? "7-peers-a" : "7-peers-b",
            prediction_figure(errors,
                              "40 test motions of 10 s from starts over " + where +
                                  " and +-30 mm/s; REF-A, drag 50.2 w|w|; training: 20,000 samples of the grid."));
        study.figures.back().second.title = "Models beside each other, gaps of " + where;
        const double learned = named(errors, "least squares, p2").gap,
                     tangent = named(errors, "tangent at mid-range").gap,
                     equivalent = named(errors, "equivalent linear").gap, dictionary = named(errors, "edmd").gap;
        study.claims.push_back({near ? "7-peers-near" : "7-peers-far", "sections 7.2 and 7.5, gaps of " + where,
                                "The data-driven model predicts where the tangent and the modified linear model fail",
                                "rms errors of dw/dt and of the gap over 10 s: " + list(errors) +
                                    "; the dictionary of extended DMD " +
                                    (dictionary < learned ? "does better than" : "does not better") +
                                    " the two forces, and none replaces the curve itself",
                                learned < 0.8 * std::min(tangent, equivalent) ? "reproduces" : "in part"});
    }
}

}  // namespace underbody::thesis
