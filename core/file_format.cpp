#include "core/file_format.h"

#include <algorithm>
#include <cctype>

#include "core/text.h"

namespace underbody::core {

namespace {

/// "force[2].scale.speed" -> "force[].scale.speed".
std::string without_numbers(std::string_view place) {
    std::string result;
    bool inside = false;
    for (const char c : place) {
        if (c == ']') {
            inside = false;
        }
        if (!inside) {
            result += c;
        }
        if (c == '[') {
            inside = true;
        }
    }
    return result;
}

/// How many parts of the described path are "*" when the place fits it; -1 when it does not fit.
int fit_of_place(std::string_view described, std::string_view place) {
    const auto wanted = split(described, '.'), found = split(place, '.');
    if (wanted.size() != found.size()) {
        return -1;
    }
    int any = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (wanted[i] == "*") {
            ++any;
        } else if (wanted[i] != found[i]) {
            return -1;
        }
    }
    return any;
}

/// The name of the table just below `place` on the way to `path`; empty when the path does not lead through it.
std::string next_name(std::string_view place, std::string_view path) {
    const auto there = split(place, '.'), parts = split(path, '.');
    const std::size_t depth = place.empty() ? 0 : there.size();
    if (path.empty() || parts.size() <= depth) {
        return {};
    }
    for (std::size_t i = 0; i < depth; ++i) {
        if (parts[i] != "*" && parts[i] != there[i]) {
            return {};
        }
    }
    std::string name(parts[depth]);
    return name.ends_with("[]") ? name.substr(0, name.size() - 2) : name;
}

}  // namespace

const FileTable* FileFormat::table(std::string_view place) const {
    const std::string plain = without_numbers(place);
    const FileTable* best = nullptr;
    int fewest = 0;
    for (const FileTable& candidate : tables) {
        const int any = fit_of_place(candidate.path, plain);
        if (any >= 0 && (best == nullptr || any < fewest)) {
            best = &candidate;
            fewest = any;
        }
    }
    return best;
}

const FileKey* FileFormat::key(std::string_view place, std::string_view of_name) const {
    const FileTable* found = table(place);
    const FileKey* any = nullptr;
    if (found != nullptr) {
        for (const FileKey& entry : found->keys) {
            if (entry.name == of_name) {
                return &entry;
            }
            if (entry.name == "*") {
                any = &entry;
            }
        }
    }
    return any;
}

bool FileFormat::takes_any_name(std::string_view place) const {
    if (key(place, "*") != nullptr) {
        return true;
    }
    const std::string plain = without_numbers(place);
    return std::any_of(tables.begin(), tables.end(),
                       [&](const FileTable& entry) { return next_name(plain, entry.path) == "*"; });
}

std::string FileFormat::how_to_add_table(std::string_view parent, std::string_view place) const {
    const FileTable* described = table(place);
    if (described == nullptr) {
        return {};
    }
    if (!described->one_line.empty()) {
        return "add " + described->one_line + (parent.empty() ? "" : " under " + heading_of(parent));
    }
    std::string lines;
    for (const FileKey& entry : described->keys) {
        if (entry.required()) {
            lines += (lines.empty() ? ": " : ", ") + entry.name + " = " + entry.example;
        }
    }
    return "add " + heading_of(place) + (lines.empty() ? "" : " and its keys") + lines;
}

std::vector<std::string> FileFormat::names(std::string_view place) const {
    std::vector<std::string> result;
    const auto add = [&result](const std::string& found) {
        if (!found.empty() && found != "*" && std::find(result.begin(), result.end(), found) == result.end()) {
            result.push_back(found);
        }
    };
    if (const FileTable* here = table(place)) {
        for (const FileKey& entry : here->keys) {
            add(entry.name);
        }
    }
    const std::string plain = without_numbers(place);
    for (const FileTable& entry : tables) {
        add(next_name(plain, entry.path));
    }
    return result;
}

bool FileFormat::knows(std::string_view place, std::string_view of_name) const {
    const auto all = names(place);
    return takes_any_name(place) || std::find(all.begin(), all.end(), of_name) != all.end();
}

std::string heading_of(std::string_view place) {
    if (place.empty()) {
        return {};
    }
    const bool list = place.ends_with("]");
    std::string plain = without_numbers(place);
    for (std::size_t at = plain.find("[]"); at != std::string::npos; at = plain.find("[]")) {
        plain.erase(at, 2);
    }
    return list ? "[[" + plain + "]]" : "[" + plain + "]";
}

namespace {

std::string with_comment(std::string line, const std::string& comment) {
    constexpr std::size_t column = 36;
    line.append(line.size() < column ? column - line.size() : 2, ' ');
    return line + "# " + comment;
}

std::string comment_of(const FileKey& key) {
    std::string comment = key.meaning;
    if (key.name != "*" && !key.kind.empty() && key.kind != "text" && key.kind != "file") {
        comment += key.kind.find('|') != std::string::npos ? ": " + key.kind : " [" + key.kind + "]";
    }
    if (!key.fallback.empty()) {
        comment += "; default: " + key.fallback;
    }
    return key.instead_of.empty() ? comment : comment + "; in place of " + key.instead_of;
}

void write_table(std::string& out, const FileFormat& format, const FileTable& table) {
    // A table that the file must hold stands as it is; so do its required keys.
    const std::string off = table.required ? "" : "# ";
    if (!table.path.empty()) {
        out += "\n" + with_comment(off + heading_of(table.path), table.meaning) + "\n";
    }
    for (const FileKey& key : table.keys) {
        const std::string line = key.name == "*" ? key.example : key.name + " = " + key.example;
        out += with_comment((table.required && key.required() ? "" : "# ") + line, comment_of(key)) + "\n";
    }
    for (const FileTable& inner : format.tables) {
        const bool shown = std::any_of(table.keys.begin(), table.keys.end(),
                                       [&](const FileKey& key) { return key.example == inner.one_line; });
        if (!inner.one_line.empty() && inner.path.starts_with(table.path + ".") && !shown) {
            out += with_comment((inner.required && table.required ? "" : "# ") + inner.one_line, inner.meaning) + "\n";
        }
    }
}

std::string sentence(std::string text) {
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
    return text;
}

std::string markdown_cell(std::string text) {
    for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) {
        text.insert(at, "\\");
    }
    return text;
}

}  // namespace

std::string template_text(const FileFormat& format) {
    std::string out =
        "# " + format.file + ": " + format.title + "\n" +
        "# Lengths, speeds and the like are text with a unit (\"5 mm\", \"0.5 m/s\"); a bare number is SI.\n"
        "# What begins with '#' may be left out: take the '#' away to use it. Numbers are examples.\n";
    for (const FileTable& table : format.tables) {
        if (table.one_line.empty()) {
            write_table(out, format, table);
        }
    }
    return out;
}

std::string markdown_keys(const FileFormat& format) {
    std::string out;
    for (const FileTable& table : format.tables) {
        out += (out.empty() ? "" : "\n");
        const std::string heading = table.path.empty() ? "Top of the file" : "`" + heading_of(table.path) + "`";
        out += "### " + heading + "\n\n" + sentence(table.meaning) +
               (table.required && !table.path.empty() ? " (required)." : ".") +
               (table.one_line.empty() ? "" : " On one line: `" + table.one_line + "`.") +
               "\n\n| key | unit or kind | default | meaning | example |\n|---|---|---|---|---|\n";
        for (const FileKey& key : table.keys) {
            std::string standing = key.required() ? "required" : key.fallback;
            if (!key.instead_of.empty()) {
                standing += (standing.empty() ? "in place of `" : "; in place of `") + key.instead_of + "`";
            }
            out += "| " + (key.name == "*" ? std::string("any") : "`" + key.name + "`") + " | " +
                   markdown_cell(key.kind) + " | " + markdown_cell(standing) + " | " + markdown_cell(key.meaning) +
                   " | `" + markdown_cell(key.example) + "` |\n";
        }
    }
    return out;
}

}  // namespace underbody::core
