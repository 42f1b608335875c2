// Statements of the thesis beside what is computed here, and its figures drawn from our own runs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"

namespace underbody::thesis {

struct Claim {
    std::string id;         ///< "7-rank"
    std::string where;      ///< figure, table or equation of the thesis
    std::string statement;  ///< what the thesis says
    std::string computed;   ///< what comes out here, with its numbers
    std::string verdict;    ///< "reproduces", "in part", "does not reproduce", "cannot be checked"
};

struct Study {
    std::vector<std::pair<std::string, core::Figure>> figures;  ///< by the thesis's number, panels by letter: "7-7a"
    std::vector<Claim> claims;
    /// nullptr when there is none of that name.
    [[nodiscard]] const core::Figure* figure(const std::string& number) const;
};

/// Chapters 7 and 8: about five seconds. Plant: REF-A, quadratic drag 50.2 N s^2/m^2, S of the thesis; seeds stated in
/// the captions.
Study separation(core::Progress& progress = core::Progress::none());
/// Springs, sizes, voltages, releases and heading: a few seconds. Nothing is random.
Study dynamics_of_the_body(core::Progress& progress = core::Progress::none());

void to_json(nlohmann::json& json, const Study& study);

}  // namespace underbody::thesis
