#include "core/heading.h"

#include "core/text.h"

namespace underbody::core {

std::optional<HeadingText> heading_text(std::string_view cell) {
    const std::string_view text = trimmed(cell);
    const std::size_t open = text.find('[');
    if (open == std::string_view::npos) {
        return HeadingText{std::string(text), {}};
    }
    if (text.back() != ']') {
        return {};
    }
    return HeadingText{std::string(trimmed(text.substr(0, open))),
                       std::string(trimmed(text.substr(open + 1, text.size() - open - 2)))};
}

}  // namespace underbody::core
