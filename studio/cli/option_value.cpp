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

}  // namespace underbody::studio
