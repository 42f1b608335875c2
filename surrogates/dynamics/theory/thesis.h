// The thesis's statements on springs, sizes, voltages, releases and heading, beside what the models here compute.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

struct ThesisCheck {
    std::string id;         ///< "4-frequency"
    std::string where;      ///< section, equation or figure of the thesis
    std::string statement;  ///< what it says
    std::string computed;   ///< what comes out here, with its numbers
    std::string verdict;    ///< "reproduces", "in part", "does not reproduce"
};

struct ThesisDynamics {
    std::vector<std::pair<std::string, core::Figure>> figures;  ///< by the thesis's number: "5-22"
    std::vector<ThesisCheck> checks;
    /// nullptr when there is none of that name.
    [[nodiscard]] const core::Figure* figure(const std::string& name) const;
};

/// All checks; a few seconds. Nothing is random.
ThesisDynamics thesis_dynamics(core::Progress& progress = core::Progress::none());
void to_json(nlohmann::json& json, const ThesisDynamics& study);

/// Lift over gap in chords at fixed speed, as a table for a body `size` times as large: the regimes of section 4.4
/// (lift below 1 % of the chord, suction to 25 %, weak lift above).
tables::ForceTable thesis_lift(double size, double speed);
/// The reference vehicle `size` times as large over that lift, no drag unless given.
Model thesis_vehicle(double size, double speed, double quadratic_drag = 0);
/// Smallest downward kick at the stable gap nearest the ground with which the body touches, m/s, by bisection on
/// trajectories.
double kick_that_touches(const Model& model, double gap, double upper);

}  // namespace underbody::dynamics
