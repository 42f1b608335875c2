// Designs that a search chose: what the surrogates said of them before they were computed, beside what the solver says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/design.h"
#include "core/figure.h"

namespace underbody::cases {

/// An objective or a limit of one design.
struct ProofOfResponse {
    std::string name;
    std::string unit;  ///< SI
    tables::ResponseValue predicted;
    /// Of this design's own runs alone, linear between them where they stand about the response's conditions; sigma is
    /// that of the runs. Nothing where they do not reach, or are not all there.
    std::optional<tables::ResponseValue> computed;
    bool of_curves = false;  ///< of three gaps or pitches at least; below zero: there is none
    /// Their difference over the joint sigma; NaN where nothing is computed, no error is known, or one of both says of
    /// a number of curves that there is none.
    [[nodiscard]] double difference_in_sigmas() const;
};

struct ProofOfDesign {
    std::string design;
    std::string fidelity;
    std::string why;   ///< as in plan.csv
    std::string note;  ///< why nothing is compared: "not computed yet", what failed, a prediction of something else
    std::vector<ProofOfResponse> responses;  ///< empty where nothing is compared
};

/// In the order of the plan, those that were chosen with a prediction. Only runs of the fidelity that was planned
/// count: the prediction is of the finest that the surrogates had learned from, so that the difference holds the error
/// of the mesh as well where that was a coarser one.
std::vector<ProofOfDesign> proofs(const Design& design);

/// Of the runs of one design on one fidelity, as ProofOfResponse::computed.
std::optional<tables::ResponseValue> computed_response(const Design& design, const std::string& name,
                                                       const std::string& fidelity, const tables::Response& response);

/// One picture a unit: predicted against computed, with the errors of both.
std::vector<core::Figure> proof_figures(const std::vector<ProofOfDesign>& all);

/// "design-031 (fine): slope_5mm predicted -0.02 +- 0.01 N m/rad, computed -0.018 +- 0.002 N m/rad (0.2 sigma)", a line
/// a response.
std::string proof_text(const ProofOfDesign& proof);
void to_json(nlohmann::json& json, const ProofOfDesign& proof);

}  // namespace underbody::cases
