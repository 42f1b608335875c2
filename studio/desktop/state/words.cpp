#include "studio/desktop/state/words.h"

#include "core/error.h"

namespace underbody::studio {

namespace {

std::string quoted(const std::string& word) {
    constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,%@";
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) {
        return word;
    }
    std::string text = "'";
    for (const char c : word) {
        text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    return text + "'";
}

}  // namespace

std::string line_of(const Words& words) {
    std::string line;
    for (const auto& word : words) {
        line += (line.empty() ? "" : " ") + quoted(word);
    }
    return line;
}

Words words_of(std::string_view line) {
    Words words;
    std::string word;
    bool within = false;
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (quote != 0) {
            if (c == quote) {
                quote = 0;
            } else if (c == '\\' && quote == '"' && i + 1 < line.size()) {
                word += line[++i];
            } else {
                word += c;
            }
        } else if (c == '\'' || c == '"') {
            quote = c;
            within = true;
        } else if (c == '\\' && i + 1 < line.size()) {
            word += line[++i];
            within = true;
        } else if (c == ' ' || c == '\t' || c == '\r') {
            if (within) {
                words.push_back(word);
            }
            word.clear();
            within = false;
        } else if (c == '#' && !within) {
            return words;
        } else {
            word += c;
            within = true;
        }
    }
    if (quote != 0) {
        throw core::InputError("parse", "a quote is never closed", {}, "close it before the end of the line");
    }
    if (within) {
        words.push_back(word);
    }
    return words;
}

}  // namespace underbody::studio
