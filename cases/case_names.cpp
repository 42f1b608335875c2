#include "cases/case_names.h"

#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

// Of paths as text: ten thousand cases are named in a list, and a path of the library is taken apart for each.

std::string_view last_part(std::string_view path) { return path.substr(path.rfind('/') + 1); }

/// Empty when there is one part, or the root.
std::string_view parent_of(std::string_view path) {
    const std::size_t slash = path.rfind('/');
    return slash == std::string_view::npos ? std::string_view() : path.substr(0, slash);
}

std::string_view stem_of(std::string_view name) {
    for (const std::string_view ending : {".gz", ".h5"}) {
        if (name.ends_with(ending)) {
            name.remove_suffix(ending.size());
        }
    }
    const std::size_t dot = name.rfind('.');
    return dot == std::string_view::npos || dot == 0 ? name : name.substr(0, dot);
}

/// The path below the study's folder, wherever that lies; else the whole path.
std::string below(const fs::path& file, const fs::path& folder) {
    const std::string& whole = file.native();
    const std::string& start = folder.native();
    if (whole.size() > start.size() + 1 && whole.starts_with(start) && whole[start.size()] == '/' &&
        start.find("..") == std::string::npos) {
        return whole.substr(start.size() + 1);
    }
    const fs::path rest = file.lexically_relative(folder);
    return (rest.empty() || *rest.begin() == ".." ? file : rest).string();
}

}  // namespace

std::string short_name(const fs::path& path, const fs::path& study, bool folder) {
    const std::string file = below(path, study);
    const std::string_view own = last_part(file);
    const std::string_view parent = own == "controlDict" ? parent_of(parent_of(file)) : parent_of(file);
    const std::string_view stem = folder ? own : stem_of(own);
    const bool named_alike = !folder && (stem == "case" || own == "controlDict");
    return std::string(named_alike && !last_part(parent).empty() ? last_part(parent) : stem);
}

void tell_names_apart(std::vector<Case>& cases, const fs::path& folder) {
    std::unordered_map<std::string, std::vector<Case*>> by_name;
    for (auto& entry : cases) {
        by_name[entry.name].push_back(&entry);
    }
    for (auto& [name, alike] : by_name) {
        if (alike.size() == 1) {
            continue;
        }
        for (Case* entry : alike) {
            const std::string path = below(entry->file, folder);
            std::string_view before = parent_of(path);
            before = last_part(before) == name ? parent_of(before) : before;
            if (!last_part(before).empty()) {
                entry->name = std::string(last_part(before)) + "/" + name;
            }
        }
    }
    std::unordered_set<std::string> taken;
    for (auto& entry : cases) {
        if (!taken.insert(entry.name).second) {
            entry.name = below(entry.file, folder);  // no two have that
            taken.insert(entry.name);
        }
    }
}

}  // namespace underbody::cases
