// Values of options with units: a mistake in them is a mistake of the command line (exit code 2), and names the option.
#pragma once

#include <string>

namespace underbody::studio {

/// The value in `unit` (SI) of an option's text; a bare number is SI. Throws core::UsageError that names the option
/// when it does not parse, is not finite or has another dimension.
double option_value(const std::string& option, const std::string& text, const std::string& unit);

}  // namespace underbody::studio
