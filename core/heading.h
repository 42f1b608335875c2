// The heading of a table's column: "gap [mm]".
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace underbody::core {

struct HeadingText {
    std::string name;
    std::optional<std::string> unit;  ///< what stands in the brackets, may be empty; nothing without brackets
};

/// Name and unit as they are written, of a known quantity also as "gap (mm)"; nothing when a bracket opens and does not
/// close at the end.
std::optional<HeadingText> heading_text(std::string_view cell);

}  // namespace underbody::core
