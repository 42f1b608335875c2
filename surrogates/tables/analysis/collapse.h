// How well forces at several speeds, sizes, jet voltages or jet flows fall on one curve: C_L(h/c) and q^2 f(h).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/figure.h"
#include "core/table.h"
#include "core/water.h"

namespace underbody::tables {

struct CollapseOptions {
    /// What differs: "speed" or "length" (force as C = 2 F/(rho U^2 S) over gap/length: docs/physics.md section 4.4),
    /// "jet_voltage" (F/V^2 over gap) or "jet_flow" (F/q^2 over gap: docs/physics.md section 5.1). Empty: the first of
    /// these that varies.
    std::string by;
    double density = core::default_water_density;  ///< kg/m^3
    double length = 0;                             ///< m, where there is no column `length`; 0: the gap is not divided
    double width =
        0;  ///< m, where there is no column `width`; S = pi/4 length width, or length^2 when no width is known, or 1
    double tolerance = 0.02;  ///< points without stated errors are judged by this share of the largest coefficient
};

/// The points of one speed, size, voltage or flow against the reference curve.
struct CollapseGroup {
    double level = 0;        ///< the speed, size, voltage or flow
    std::size_t points = 0;  ///< that lie within the gaps of the reference curve
    double mean_ratio = 1;   ///< of coefficients to the reference curve
    double exponent = 2;     ///< of the level with which the force would fall on the curve
    double rms = 0;          ///< of the deviations, in joint errors: about 1 when they collapse
    double worst = 0;        ///< largest deviation, in its joint error
    double worst_gap = 0;    ///< where: gap (m), or gap over length
    std::vector<std::pair<double, double>>
        beyond;  ///< ranges of the gap (over length) whose points all lie beyond twice their joint error
};

struct Collapse {
    std::string quantity, by, by_unit;
    std::string abscissa;     ///< "gap" (m) or "gap_over_length"
    std::string coefficient;  ///< "C_L", "force_over_speed_squared" ... and its unit
    std::string coefficient_unit;
    double reference = 0;               ///< level of the group with most points: the curve
    std::vector<CollapseGroup> groups;  ///< the others
    bool holds = false;                 ///< at most one point in twenty beyond twice its joint error, none beyond four
    double exponent = 2;                ///< over all groups
    std::string verdict;                ///< a sentence
    core::Table points;  ///< abscissa, coefficient, level, deviation in joint errors (NaN beyond the gaps of the curve)
    std::vector<double> curve_x, curve_y, curve_sigma;  ///< the reference curve
};

/// Throws core::InputError when only one level is there, a level is not positive, nothing overlaps; core::UsageError
/// for an unknown `by`, a density, length or width that is negative.
Collapse collapse(const core::Table& table, const std::string& quantity, const CollapseOptions& options = {});
core::Figure collapse_figure(const Collapse& collapse);
void to_json(nlohmann::json& json, const Collapse& collapse);

}  // namespace underbody::tables
