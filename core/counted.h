// "1 case", "2 cases": a count with its noun.
#pragma once

#include <string>

namespace underbody::core {

/// `count` and `noun`, in the plural but for one: `plural`, or the noun with an s.
template <typename Count>
std::string counted(Count count, const std::string& noun, const std::string& plural = {}) {
    return std::to_string(count) + " " + (count == 1 ? noun : plural.empty() ? noun + "s" : plural);
}

}  // namespace underbody::core
