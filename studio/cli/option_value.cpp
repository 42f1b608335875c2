#include "studio/cli/option_value.h"

#include "core/error.h"
#include "core/units.h"

namespace underbody::studio {

double option_value(const std::string& option, const std::string& text, const std::string& unit) {
    try {
        return core::parse_in(text, unit);
    } catch (const core::InputError& error) {
        throw core::UsageError(error.kind(), option + ": " + error.message(), {}, error.hint());
    }
}

std::pair<std::string, std::string> name_and_value(const std::string& option, const std::string& text) {
    const std::size_t equal = text.find('=');
    if (equal == std::string::npos || equal == 0 || equal + 1 == text.size()) {
        throw core::UsageError("parse", option + ": '" + text + "' is not NAME=VALUE");
    }
    return {text.substr(0, equal), text.substr(equal + 1)};
}

}  // namespace underbody::studio
