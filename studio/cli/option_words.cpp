#include "studio/cli/option_words.h"

#include <algorithm>
#include <cctype>

namespace underbody::studio {

namespace {

/// For a shell.
std::string quoted(const std::string& value) {
    if (value.find_first_of(" *?[]^()<>&;$\"") == std::string::npos) {
        return value;
    }
    return value.find_first_of("*\"") == std::string::npos ? '"' + value + '"' : '\'' + value + '\'';
}

bool is_flag(const std::string& name) {
    return !name.empty() &&
           std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::islower(c) != 0 || c == '-'; });
}

}  // namespace

std::string with_flags(const std::string& text) {
    constexpr std::string_view begin = "option '";
    std::string result;
    std::size_t done = 0;
    for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at + 1)) {
        const std::size_t first = at + begin.size();
        const std::size_t last = text.find('\'', first);
        if (last == std::string::npos) {
            break;
        }
        const std::string words = text.substr(first, last - first);
        const std::size_t blank = std::min(words.find(' '), words.size());
        if (is_flag(words.substr(0, blank))) {
            result += text.substr(done, at - done) + "--" + words.substr(0, blank);
            result += blank < words.size() ? " " + quoted(words.substr(blank + 1)) : "";
            done = last + 1;
        }
    }
    return result + text.substr(done);
}

}  // namespace underbody::studio
