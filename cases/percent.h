// Shares as people read them.
#pragma once

#include <cmath>
#include <string>

#include "core/text.h"

namespace underbody::cases {

/// A share so small that sums of doubles leave it behind where nothing is.
inline bool is_rounding(double share) { return share != 0 && std::abs(share) < 1e-10; }

/// "12.3 %", "0 %"; "below rounding" instead of "8.3e-14 %".
inline std::string percent(double share, int digits = 3) {
    return is_rounding(share) ? "below rounding" : core::format_number(100 * share, digits) + " %";
}

/// "12.3 % of the force's size", "less than rounding".
inline std::string percent_of(double share, const std::string& whole, int digits = 3) {
    return is_rounding(share) ? "less than rounding" : percent(share, digits) + " of " + whole;
}

/// A warning where a share was given as a bare number so large that per cent were meant; empty where not. `what`: "the
/// option or key and its number"; `largest`: what a share may be without a question.
inline std::string percent_sign_missing(const std::string& what, double share, double largest,
                                        const std::string& whole) {
    return share > largest ? what + " is " + percent(share) + " of " + whole + ": \"" + core::format_number(share) +
                                 " %\" is with the sign"
                           : std::string();
}

}  // namespace underbody::cases
