// Units and labels as people write them.
#include <array>

#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

/// Superscript of a digit or a minus sign, "" for anything else.
std::string superscript(char letter) {
    static const std::array<const char*, 10> digits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    if (letter == '-') {
        return "⁻";
    }
    return letter >= '0' && letter <= '9' ? digits[static_cast<std::size_t>(letter - '0')] : "";
}

std::string pretty_word(const std::string& word) {
    if (word == "degC") {
        return "°C";
    }
    if (word == "deg") {
        return "°";
    }
    if (word == "ohm") {
        return "Ω";
    }
    if (word == "um") {
        return "µm";
    }
    return word;
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

}  // namespace

std::string pretty_unit(const std::string& unit) {
    if (unit == "1") {
        return "";
    }
    std::string result;
    std::size_t i = 0;
    while (i < unit.size()) {
        if (is_letter(unit[i])) {
            std::size_t end = i;
            while (end < unit.size() && is_letter(unit[end])) {
                ++end;
            }
            result += pretty_word(unit.substr(i, end - i));
            i = end;
        } else if (unit[i] == '^' && i + 1 < unit.size() && !superscript(unit[i + 1]).empty()) {
            ++i;
            do {
                result += superscript(unit[i++]);
            } while (i < unit.size() && unit[i] >= '0' && unit[i] <= '9');
        } else {
            result += unit[i++];
        }
    }
    return result;
}

std::string axis_title(const std::string& label, const std::string& unit) {
    const std::string pretty = pretty_unit(unit);
    if (pretty.empty()) {
        return label;
    }
    return label.empty() ? pretty : label + " (" + pretty + ")";
}

}  // namespace underbody::studio
