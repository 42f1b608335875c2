// What the parts of a design search share.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace underbody::cases {

/// One field of a CSV line.
inline std::string one_field(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == ',' || c == '\n' || c == '"'; }, ';');
    return text;
}

inline bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

inline constexpr const char* not_settled_state = "not settled";
/// The pitch moment about the body's own centre of buoyancy.
inline constexpr const char* moment_at_buoyancy = "pitch_moment_at_buoyancy";

}  // namespace underbody::cases
