#include "cases/study_text.h"

#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "core/toml.h"

namespace underbody::cases {

namespace {

/// True of ["3 mm", "5 mm"] and { gap = "3 mm" }.
bool is_list_or_table(const std::string& text) {
    if (!text.starts_with('[') && !text.starts_with('{')) {
        return false;
    }
    try {
        return core::read_toml_text("value = " + text, "").has("value");
    } catch (const core::Error&) {
        return false;  // a text like "[draft] of a study"
    }
}

/// A number, a list and an inline table stay what they are; all else becomes a string ("0.28 N").
std::string toml_value(const std::string& text) {
    const bool word = text == "true" || text == "false";
    return word || core::parse_number(text) || is_list_or_table(text) ? text : core::toml_string(text);
}

std::string key_of_line(std::string_view line) {
    const auto equal = line.find('=');
    return equal == std::string_view::npos ? std::string() : std::string(core::trimmed(line.substr(0, equal)));
}

/// What a line holds outside quotes.
struct Outside {
    std::string comment;  ///< behind the value, with the space before it; "" when there is none
    int opened = 0;       ///< brackets that it opens and does not close
};

Outside outside_quotes(std::string_view line) {
    Outside out;
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (quote != 0) {
            quote = c == quote ? char(0) : quote;
        } else if (c == '"' || c == '\'') {
            quote = c;
        } else if (c == '#') {
            const auto end = line.find_last_not_of(" \t", i - 1);
            out.comment = line.substr(end + 1);
            break;
        }
        out.opened += quote != 0 ? 0 : c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
    }
    return out;
}

/// The last line of a value that begins in line `first`: a list may go over several.
std::size_t last_line_of_value(const std::vector<std::string>& lines, std::size_t first) {
    int open = outside_quotes(lines[first]).opened;
    std::size_t last = first;
    while (open > 0 && last + 1 < lines.size()) {
        open += outside_quotes(lines[++last]).opened;
    }
    return last;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    for (const auto line : core::split(text, '\n')) {
        lines.emplace_back(line);
    }
    return lines;
}

std::string joined(const std::vector<std::string>& lines) {
    std::string result;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        result += (i > 0 ? "\n" : "") + lines[i];
    }
    return result;
}

/// Lines of one table: those behind its head, up to the next.
struct Block {
    std::size_t begin = 0, end = 0;
};

Block block_at(const std::vector<std::string>& lines, std::size_t begin) {
    std::size_t end = begin;
    while (end < lines.size() && !core::trimmed(lines[end]).starts_with("[")) {
        end = last_line_of_value(lines, end) + 1;
    }
    return {begin, end};
}

/// `key = value` at the place where the key stands, else behind the last key of the block.
void set_in(std::vector<std::string>& lines, const Block& block, const std::string& key, const std::string& value) {
    const std::string line = key + " = " + toml_value(value);
    std::size_t behind = block.begin;
    for (std::size_t i = block.begin; i < block.end; ++i) {
        const std::size_t last = last_line_of_value(lines, i);
        if (key_of_line(lines[i]) == key) {
            lines[i] = line + outside_quotes(lines[last]).comment;
            const auto place = lines.begin() + static_cast<std::ptrdiff_t>(i) + 1;
            lines.erase(place, place + static_cast<std::ptrdiff_t>(last - i));
            return;
        }
        const auto text = core::trimmed(lines[i]);
        behind = text.empty() || text.starts_with("#") ? behind : last + 1;
        i = last;
    }
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(behind), line);
}

std::string name_in(const std::vector<std::string>& lines, const Block& block) {
    for (std::size_t i = block.begin; i < block.end; ++i) {
        if (key_of_line(lines[i]) == "name") {
            const auto quoted = core::split(lines[i], lines[i].find('"') != std::string::npos ? '"' : '\'');
            return quoted.size() > 1 ? std::string(quoted[1]) : std::string();
        }
    }
    return {};
}

}  // namespace

std::string with_value(const std::string& text, const std::string& kind, const std::string& name,
                       const std::string& key, const std::string& value) {
    auto lines = lines_of(text);
    std::vector<std::string> names;
    const std::string head = "[[" + kind + "]]";
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!core::trimmed(lines[i]).starts_with(head)) {
            continue;
        }
        const Block block = block_at(lines, i + 1);
        names.push_back(name_in(lines, block));
        if (names.back() == name) {
            set_in(lines, block, key, value);
            return joined(lines);
        }
    }
    throw core::UsageError("missing", "the study has no [[" + kind + "]] '" + name + "'", {},
                           core::did_you_mean(name, names));
}

std::string with_value_of_table(const std::string& text, const std::string& table, const std::string& key,
                                const std::string& value) {
    auto lines = lines_of(text);
    const std::string head = "[" + table + "]";
    std::size_t begin = 0;
    while (!table.empty() && begin < lines.size() && !core::trimmed(lines[begin]).starts_with(head)) {
        ++begin;
    }
    if (begin == lines.size()) {
        return text + (text.empty() || text.ends_with('\n') ? "" : "\n") + "\n" + head + "\n" + key + " = " +
               toml_value(value) + "\n";
    }
    set_in(lines, block_at(lines, begin + (table.empty() ? 0 : 1)), key, value);
    return joined(lines);
}

}  // namespace underbody::cases
