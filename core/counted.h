// "1 case", "2 cases": a count with its noun.
#pragma once

#include <string>

namespace underbody::core {

/// `count` and `noun`, in the plural but for one: `plural`, or the noun with an s.
template <typename Count>
std::string counted(Count count, const std::string& noun, const std::string& plural = {}) {
    return std::to_string(count) + " " + (count == 1 ? noun : plural.empty() ? noun + "s" : plural);
}

/// "1 of 9 points lies", "2 of 9 points lie": a share with its verb.
template <typename Count, typename All>
std::string counted_of(Count count, All all, const std::string& noun, const std::string& one,
                       const std::string& several) {
    return std::to_string(count) + " of " + counted(all, noun) + " " + (count == 1 ? one : several);
}

/// "1 standard deviation", "1.5 standard deviations": a number that is written already, with its noun.
inline std::string counted_text(const std::string& number, const std::string& noun) {
    return number + " " + noun + (number == "1" ? "" : "s");
}

}  // namespace underbody::core
