// Over which conditions a search of shapes computes loads, and what a table of one shape may be asked of: known without
// a run.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cases/conditions.h"
#include "cases/design_spec.h"
#include "surrogates/tables/search/surrogate.h"

namespace underbody::cases {

/// Conditions that take several values, in the order of the surrogates' variables.
std::vector<tables::SearchVariable> conditions_of(const DesignSpec& spec);

/// What was computed at one value alone, SI.
std::vector<std::pair<std::string, double>> only_values(const DesignSpec& spec);

/// What a table of a shape is asked of.
struct AskedPoints {
    std::vector<std::string> quantities;  ///< empty: all
    std::vector<std::string> axes;        ///< empty: all conditions that vary
    Conditions held;                      ///< SI
};
/// Without a run: that axes and held values are conditions of [design]. Throws core::InputError: a condition
/// that is not known (with the nearest), has no value or one beyond the range that is computed.
void check_asked(const DesignSpec& spec, const AskedPoints& asked);

}  // namespace underbody::cases
