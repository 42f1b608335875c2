#include "cases/study_text.h"

#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "core/toml.h"

namespace underbody::cases {

namespace {

/// A number stays one; all else becomes a string ("0.28 N").
std::string toml_value(const std::string& text) {
    const bool word = text == "true" || text == "false";
    return word || core::parse_number(text) ? text : core::toml_string(text);
}

std::string key_of_line(std::string_view line) {
    const auto equal = line.find('=');
    return equal == std::string_view::npos ? std::string() : std::string(core::trimmed(line.substr(0, equal)));
}

/// The comment behind a value, with the space before it; "" when there is none.
std::string comment_of(std::string_view line) {
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (quote != 0) {
            quote = line[i] == quote ? char(0) : quote;
        } else if (line[i] == '"' || line[i] == '\'') {
            quote = line[i];
        } else if (line[i] == '#') {
            const auto end = line.find_last_not_of(" \t", i - 1);
            return std::string(line.substr(end + 1));
        }
    }
    return {};
}

}  // namespace

std::string with_value(const std::string& text, const std::string& kind, const std::string& name,
                       const std::string& key, const std::string& value) {
    std::vector<std::string> lines;
    for (const auto line : core::split(text, '\n')) {
        lines.emplace_back(line);
    }
    std::vector<std::string> names;
    const std::string head = "[[" + kind + "]]";
    for (std::size_t begin = 0; begin < lines.size(); ++begin) {
        if (!core::trimmed(lines[begin]).starts_with(head)) {
            continue;
        }
        std::size_t end = begin + 1, at = 0, last = begin;
        std::string found;
        for (; end < lines.size() && !core::trimmed(lines[end]).starts_with("["); ++end) {
            const std::string here = key_of_line(lines[end]);
            last = core::trimmed(lines[end]).empty() || core::trimmed(lines[end]).starts_with("#") ? last : end;
            at = here == key ? end : at;
            if (here == "name") {
                const auto quoted = core::split(lines[end], lines[end].find('"') != std::string::npos ? '"' : '\'');
                found = quoted.size() > 1 ? std::string(quoted[1]) : std::string();
            }
        }
        names.push_back(found);
        if (found != name) {
            continue;
        }
        if (at > 0) {
            lines[at] = key + " = " + toml_value(value) + comment_of(lines[at]);
        } else {
            lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(last) + 1, key + " = " + toml_value(value));
        }
        std::string result;
        for (std::size_t i = 0; i < lines.size(); ++i) {
            result += (i > 0 ? "\n" : "") + lines[i];
        }
        return result;
    }
    throw core::UsageError("missing", "the study has no [[" + kind + "]] '" + name + "'", {},
                           core::did_you_mean(name, names));
}

}  // namespace underbody::cases
