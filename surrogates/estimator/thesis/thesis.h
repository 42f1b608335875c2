// The figures of chapters 7 and 8 of the thesis drawn from our own runs, and its statements beside what we compute.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"

namespace underbody::estimator {

struct Claim {
    std::string id;         ///< "7-rank"
    std::string where;      ///< figure, table or equation of the thesis
    std::string statement;  ///< what the thesis says
    std::string computed;   ///< what comes out here, with its numbers
    std::string verdict;    ///< "reproduces", "in part", "does not reproduce", "cannot be checked"
};

struct ThesisStudy {
    std::vector<std::pair<std::string, core::Figure>> figures;  ///< by the thesis's number, panels by letter: "7-7a"
    std::vector<Claim> claims;
    [[nodiscard]] const core::Figure* figure(const std::string& number) const;
};

/// Everything: about five seconds. Plant: REF-A, quadratic drag 50.2 N s^2/m^2, S of the thesis; seeds stated in the
/// captions.
ThesisStudy thesis_study(core::Progress& progress = core::Progress::none());

void add_chapter_7(ThesisStudy& study, core::Progress& progress);
void add_peers(ThesisStudy& study,
               core::Progress& progress);  ///< tangent, equivalent-linear, learned, dmdc, edmd, nonlinear
void add_chapter_8(ThesisStudy& study, core::Progress& progress);
void add_control(ThesisStudy& study, core::Progress& progress);  ///< the end of chapter 8

void to_json(nlohmann::json& json, const ThesisStudy& study);

}  // namespace underbody::estimator
