// Values of options with units: a mistake in them is a mistake of the command line (exit code 2), and names the option.
#pragma once

#include <string>
#include <utility>

namespace underbody::studio {

/// The value in `unit` (SI) of an option's text; a bare number is SI. Throws core::UsageError that names the option
/// when it does not parse, is not finite or has another dimension.
double option_value(const std::string& option, const std::string& text, const std::string& unit);

/// "NAME=VALUE" in two. Throws core::UsageError that names the option.
std::pair<std::string, std::string> name_and_value(const std::string& option, const std::string& text);

}  // namespace underbody::studio
