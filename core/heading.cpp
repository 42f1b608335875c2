#include "core/heading.h"

#include "core/text.h"
#include "core/units.h"

namespace underbody::core {

namespace {

/// "gap (mm)", as others write it: of a known quantity and a unit; what else stands in parentheses belongs to the name.
std::optional<HeadingText> in_parentheses(std::string_view text) {
    const std::size_t open = text.rfind('(');
    if (open == std::string_view::npos || text.back() != ')') {
        return {};
    }
    HeadingText heading{std::string(trimmed(text.substr(0, open))),
                        std::string(trimmed(text.substr(open + 1, text.size() - open - 2)))};
    constexpr std::string_view deviation = "_sigma";
    const std::string_view name = heading.name;
    const auto quantity = name.ends_with(deviation) ? name.substr(0, name.size() - deviation.size()) : name;
    const bool meant = find_quantity(quantity) != nullptr && is_unit(*heading.unit);
    return meant ? std::optional(heading) : std::nullopt;
}

}  // namespace

std::optional<HeadingText> heading_text(std::string_view cell) {
    const std::string_view text = trimmed(cell);
    const std::size_t open = text.find('[');
    if (open == std::string_view::npos) {
        return in_parentheses(text).value_or(HeadingText{std::string(text), {}});
    }
    if (text.back() != ']') {
        return {};
    }
    return HeadingText{std::string(trimmed(text.substr(0, open))),
                       std::string(trimmed(text.substr(open + 1, text.size() - open - 2)))};
}

}  // namespace underbody::core
