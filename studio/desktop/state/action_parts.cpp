#include "studio/desktop/state/action_parts.h"

#include "core/text.h"
#include "core/units.h"

namespace underbody::studio::action {

using core::UsageError;

void need(const Words& arguments, std::size_t least, std::size_t most, const char* form) {
    if (arguments.size() < least || arguments.size() > most) {
        throw UsageError("words", "this action takes other words", {}, std::string("write it as: ") + form);
    }
}

/// "KEY=VALUE" in two; the value may hold '='.
std::pair<std::string, std::string> assignment(const std::string& word) {
    const auto at = word.find('=');
    if (at == std::string::npos || at == 0) {
        throw UsageError("words", "'" + word + "' is not KEY=VALUE");
    }
    return {word.substr(0, at), word.substr(at + 1)};
}

[[noreturn]] void unknown_key(const std::string& key, const std::vector<std::string>& known) {
    throw UsageError("unknown", "there is no key '" + key + "' here", {}, core::did_you_mean(key, known));
}

bool yes_or_no(const std::string& text) {
    if (text != "on" && text != "off") {
        throw UsageError("range", "'" + text + "' is neither on nor off");
    }
    return text == "on";
}

/// Empty: none.
std::optional<double> number_or_none(const std::string& text, const char* unit) {
    return text.empty() ? std::optional<double>() : core::parse_in(text, unit);
}

double within(double value, double lower, double upper, const std::string& what) {
    if (!(value >= lower && value <= upper)) {
        throw UsageError("range", what + " " + core::format_number(value, 6) + " is out of range", {},
                         "between " + core::format_number(lower) + " and " + core::format_number(upper));
    }
    return value;
}

std::array<double, 2> range_of(const std::string& text, const char* unit) {
    const auto at = text.find(':', 1);
    if (at == std::string::npos) {
        throw UsageError("parse", "'" + text + "' is not LOW:HIGH");
    }
    const std::array<double, 2> range = {core::parse_in(text.substr(0, at), unit),
                                         core::parse_in(text.substr(at + 1), unit)};
    if (!(range[0] < range[1])) {
        throw UsageError("range", "the range " + text + " is empty", {}, "the first number is the smaller one");
    }
    return range;
}

std::string need_shape(const State& state, const Session& session) {
    const std::string name = shown_shape(state, session);
    if (name.empty()) {
        throw UsageError("missing", "there is no shape to change", {}, "open a study with a [[body]], or a SHAPE.toml");
    }
    return name;
}

}  // namespace underbody::studio::action
