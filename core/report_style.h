// The look of every report.
#pragma once

#include <string_view>

namespace underbody::core {

inline constexpr std::string_view report_style = "body { font-family: sans-serif; }\n";

}  // namespace underbody::core
