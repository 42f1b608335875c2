#include "core/name_pattern.h"

#include <dirent.h>

#include <algorithm>
#include <compare>
#include <memory>
#include <set>
#include <unordered_set>

#include "core/inputs.h"
#include "core/mistyped.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::core {

namespace fs = std::filesystem;

namespace {

using Part = NamePattern::Part;

Part braced(const std::string& inside, const std::string& pattern) {
    const std::size_t colon = inside.find(':');
    Part part;
    part.value = std::string(trimmed(inside.substr(0, colon)));
    part.kind = colon == std::string::npos ? Part::Kind::text : Part::Kind::number;
    if (part.value.empty()) {
        throw UsageError("parse", "a brace without a name in the pattern '" + pattern + "'");
    }
    if (part.kind == Part::Kind::text) {
        if (const QuantityName* quantity = find_quantity(part.value); quantity != nullptr) {
            throw UsageError("unit", "{" + part.value + "} in the pattern has no unit", {},
                             "write {" + part.value + ":" + quantity->unit + "} or the unit that the names use");
        }
        return part;
    }
    part.unit = std::string(trimmed(inside.substr(colon + 1)));
    if (const std::string meant = mistyped_quantity(part.value); !meant.empty()) {
        throw UsageError("name", "{" + inside + "} in the pattern: " + no_quantity(part.value), {},
                         "did you mean '" + meant + "'?");
    }
    try {
        const QuantityName* quantity = find_quantity(part.value);
        conversion(part.unit, quantity != nullptr ? quantity->unit : si_unit(part.unit));
    } catch (const InputError& error) {
        throw UsageError(error.kind(), "{" + inside + "}: " + error.message(), {}, error.hint());
    }
    return part;
}

std::vector<Part> parts_of(const std::string& pattern) {
    std::vector<Part> parts;
    const auto literal = [&parts](char c) {
        if (parts.empty() || parts.back().kind != Part::Kind::literal) {
            parts.push_back({Part::Kind::literal, {}, {}});
        }
        parts.back().value += c;
    };
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        if (pattern[i] == '{') {
            const std::size_t close = pattern.find('}', i);
            if (close == std::string::npos) {
                throw UsageError("parse", "a brace is not closed in the pattern '" + pattern + "'");
            }
            parts.push_back(braced(pattern.substr(i + 1, close - i - 1), pattern));
            i = close;
        } else if (pattern[i] == '*') {
            parts.push_back({Part::Kind::any, {}, {}});
        } else if (pattern[i] == '?') {
            parts.push_back({Part::Kind::one, {}, {}});
        } else {
            literal(pattern[i]);
        }
    }
    return parts;
}

bool match_from(const std::vector<Part>& parts, std::size_t index, std::string_view rest, NamePattern::Match& found) {
    if (index == parts.size()) {
        return rest.empty();
    }
    const Part& part = parts[index];
    if (part.kind == Part::Kind::literal) {
        return rest.starts_with(part.value) && match_from(parts, index + 1, rest.substr(part.value.size()), found);
    }
    if (part.kind == Part::Kind::one) {
        return !rest.empty() && rest.front() != '/' && match_from(parts, index + 1, rest.substr(1), found);
    }
    // Text is as short as the rest allows; a number as long: "h10.5-coarse" is 10.5 for "h{gap:mm}*", not 1.
    const std::size_t shortest = part.kind == Part::Kind::any ? 0 : 1;
    const std::size_t longest = std::min(rest.find('/'), rest.size());
    for (std::size_t tried = shortest; tried <= longest; ++tried) {
        const std::size_t length = part.kind == Part::Kind::number ? longest - tried + 1 : tried;
        const std::string_view piece = rest.substr(0, length);
        std::optional<double> number;
        if (part.kind == Part::Kind::number) {
            number = parse_number(piece);
            if (!number || piece.find_first_not_of("0123456789.+-eE") != std::string_view::npos) {
                continue;
            }
        }
        if (!match_from(parts, index + 1, rest.substr(length), found)) {
            continue;
        }
        if (part.kind == Part::Kind::number) {
            const QuantityName* quantity = find_quantity(part.value);
            found.numbers.emplace_back(
                part.value, convert(*number, part.unit, quantity != nullptr ? quantity->unit : si_unit(part.unit)));
        } else if (part.kind == Part::Kind::text) {
            found.texts.emplace_back(part.value, std::string(piece));
        }
        return true;
    }
    return false;
}

}  // namespace

NamePattern::NamePattern(std::string pattern) : pattern_(std::move(pattern)), parts_(parts_of(pattern_)) {
    std::set<std::string> names;
    for (const auto& part : parts_) {
        if ((part.kind == Part::Kind::text || part.kind == Part::Kind::number) && !names.insert(part.value).second) {
            throw UsageError("duplicate", "{" + part.value + "} occurs twice in the pattern '" + pattern_ + "'");
        }
    }
}

bool NamePattern::is_pattern(const std::string& text) { return text.find_first_of("{*?") != std::string::npos; }

namespace {

/// Calls `visit` with each path below `start` ("" or ending in '/'), relative to it, and whether it is a folder. Goes
/// `depth` folders down, through no links, and past folders that may not be read. By hand: a path of the library is
/// taken apart for every file.
template <class Visit>
void walk(const std::string& start, std::ptrdiff_t depth, const Visit& visit) {
    std::vector<std::pair<std::string, std::ptrdiff_t>> folders = {{"", 0}};
    while (!folders.empty()) {
        const auto [folder, level] = std::move(folders.back());
        folders.pop_back();
        const std::unique_ptr<DIR, int (*)(DIR*)> open(::opendir((start + folder).c_str()), ::closedir);
        while (const dirent* entry = open != nullptr ? ::readdir(open.get()) : nullptr) {
            const std::string_view name = entry->d_name;
            if (name == "." || name == "..") {
                continue;
            }
            std::string below = folder;
            below += name;
            bool link = entry->d_type == DT_LNK;
            bool is_folder = entry->d_type == DT_DIR;
            if (link || entry->d_type == DT_UNKNOWN) {
                std::error_code error;
                link = link || fs::is_symlink(start + below, error);
                is_folder = stamp_of((start + below).c_str()).kind == FileStamp::Kind::folder;
            }
            visit(below, is_folder);
            if (is_folder && !link && level < depth) {
                folders.emplace_back(std::move(below += '/'), level + 1);
            }
        }
    }
}

std::optional<NamePattern::Match> match_all(const std::vector<Part>& parts, std::string_view text) {
    NamePattern::Match found;
    if (!match_from(parts, 0, text, found)) {
        return std::nullopt;
    }
    // The recursion collects from the back.
    std::reverse(found.numbers.begin(), found.numbers.end());
    std::reverse(found.texts.begin(), found.texts.end());
    return found;
}

}  // namespace

std::optional<NamePattern::Match> NamePattern::match(const std::string& text) const { return match_all(parts_, text); }

std::vector<NamePattern::Found> NamePattern::files(const fs::path& root) const { return files_of(parts_, root); }

std::vector<NamePattern::Found> NamePattern::files_and_folders(const fs::path& root) const {
    return files_of(parts_, root, true);
}

std::vector<fs::path> NamePattern::near_misses(const fs::path& root, bool folders) const {
    std::vector<Part> loose = parts_;
    for (auto& part : loose) {
        part.kind = part.kind == Part::Kind::number ? Part::Kind::text : part.kind;
    }
    std::unordered_set<std::string> taken;
    for (const auto& found : files_of(parts_, root, folders)) {
        taken.insert(found.path.string());
    }
    std::vector<fs::path> missed;
    for (const auto& found : files_of(loose, root, folders)) {
        if (!taken.contains(found.path.string())) {
            missed.push_back(found.path);
        }
    }
    std::sort(missed.begin(), missed.end());
    return missed;
}

std::string NamePattern::why_not(const fs::path& path, const fs::path& root) const {
    std::vector<Part> loose = parts_;
    for (auto& part : loose) {
        part.kind = part.kind == Part::Kind::number ? Part::Kind::text : part.kind;
    }
    const bool absolute = !pattern_.empty() && pattern_.front() == '/';
    const auto found =
        match_all(loose, (absolute ? path : path.lexically_relative(root.lexically_normal())).generic_string());
    std::size_t text = 0;
    for (std::size_t i = 0; found && i < parts_.size(); ++i) {
        if (parts_[i].kind != Part::Kind::number && parts_[i].kind != Part::Kind::text) {
            continue;
        }
        const std::string word = found->texts[text++].second;
        if (parts_[i].kind == Part::Kind::text || parse_number(word)) {
            continue;
        }
        const std::string brace = "{" + parts_[i].value + ":" + parts_[i].unit + "}";
        if (i + 1 < parts_.size() && parts_[i + 1].kind == Part::Kind::text &&
            parse_number(word + found->texts[text].second)) {
            return "nothing is left for {" + parts_[i + 1].value + "} behind the number " + word +
                   found->texts[text].second;
        }
        if (word.ends_with(parts_[i].unit) && parse_number(word.substr(0, word.size() - parts_[i].unit.size()))) {
            return "'" + word + "' carries its unit: write " + brace + parts_[i].unit;
        }
        return "'" + word + "' is no number for " + brace;
    }
    return "it does not fit";
}

std::vector<NamePattern::Found> NamePattern::files_of(const std::vector<Part>& parts, const fs::path& root,
                                                      bool folders) const {
    // Walk from the last folder that stands before the first brace or star.
    const std::size_t first = pattern_.find_first_of("{*?");
    const std::size_t slash = first == std::string::npos ? pattern_.rfind('/') : pattern_.rfind('/', first);
    const bool absolute = !pattern_.empty() && pattern_.front() == '/';
    const std::string fixed = slash == std::string::npos ? std::string() : pattern_.substr(0, slash);
    fs::path start = absolute ? fs::path(fixed.empty() ? "/" : fixed) : root / fixed;
    std::error_code error;
    if (!absolute && !fs::exists(root, error)) {
        start = start.lexically_normal();  // "new/../fields" is there before "new" is
    }
    const std::string before =
        start.native().ends_with('/') ? start.native() : start.native() + "/";  // of what the walk gives
    std::string normal = (start / "x").lexically_normal().native();
    normal.pop_back();
    const auto depth =
        std::count(pattern_.begin() + static_cast<std::ptrdiff_t>(slash == std::string::npos ? 0 : slash + 1),
                   pattern_.end(), '/');
    std::vector<Found> found;
    std::string name = fixed.empty() && !absolute ? fixed : fixed + "/";
    const std::size_t ahead = name.size();
    const auto take = [&](const std::string& below, bool folder) {
        if (folder && !folders) {
            return;
        }
        name.resize(ahead);
        name += below;
        if (auto match_found = match_all(parts, name)) {
            found.push_back({normal + below, std::move(*match_found), folder});
        }
    };
    if (!start.empty()) {
        walk(before, depth, take);
    }
    std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
        if (const auto order = a.match.texts <=> b.match.texts; order != 0) {
            return order < 0;
        }
        if (const auto order = a.match.numbers <=> b.match.numbers; order != 0) {
            return order < 0;
        }
        return a.path < b.path;
    });
    return found;
}

}  // namespace underbody::core
