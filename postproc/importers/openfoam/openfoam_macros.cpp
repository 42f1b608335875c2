#include "postproc/importers/openfoam/openfoam_macros.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "core/inputs.h"

namespace underbody::postproc {

namespace fs = std::filesystem;

namespace {

/// The full name of an entry in the first `depth` of these dictionaries.
std::string scoped(const std::vector<std::string>& scope, std::size_t depth, const std::string& key) {
    std::string name;
    for (std::size_t i = 0; i < depth; ++i) {
        name += scope[i] + ".";
    }
    return name + key;
}

}  // namespace

void FoamEntries::enter(const std::string& dictionary) { scope_.push_back(dictionary); }

void FoamEntries::leave() { scope_.pop_back(); }

void FoamEntries::define(const std::string& key, std::string text) {
    constexpr std::size_t most = std::size_t{1} << 20;
    const std::string name = scoped(scope_, scope_.size(), key);
    const auto before = texts_.find(name);
    bytes_ -= before == texts_.end() ? 0 : before->second.size();
    if (text.size() > most - std::min(most, bytes_)) {
        texts_.erase(name);
        return;
    }
    bytes_ += text.size();
    texts_[name] = std::move(text);
}

std::optional<std::string> FoamEntries::find(std::string name) const {
    const auto exact = [&](const std::string& full) {
        const auto found = texts_.find(full);
        return found == texts_.end() ? std::nullopt : std::optional(found->second);
    };
    if (name.empty()) {
        return {};
    }
    std::replace(name.begin() + 1, name.end(), '/', '.');
    if (name.front() == ':' || name.front() == '/' || name.front() == '!') {
        return exact(name.substr(1));
    }
    if (name.front() == '.') {
        const std::size_t dots = std::min(name.find_first_not_of('.'), name.size());
        return exact(scoped(scope_, scope_.size() - std::min(scope_.size(), dots - 1), name.substr(dots)));
    }
    for (std::size_t depth = scope_.size() + 1; depth-- > 0;) {
        if (auto found = exact(scoped(scope_, depth, name))) {
            return found;
        }
    }
    return {};
}

bool is_macro_letter(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_.:/!").find(c) != std::string_view::npos;
}

std::optional<fs::path> included_file(std::string name, const fs::path& folder, const fs::path& case_folder) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 5> known = {
        {{"${FOAM_CASE}", ""}, {"$FOAM_CASE", ""}, {"<case>", ""}, {"<system>", "system"}, {"<constant>", "constant"}}};
    for (const auto& [word, place] : known) {
        if (name.starts_with(word)) {
            name = (case_folder / place).string() + name.substr(word.size());
            break;
        }
    }
    std::error_code error;
    const fs::path whole = fs::weakly_canonical(folder / name, error);  // an absolute name stays what it is
    const fs::path top = fs::weakly_canonical(case_folder, error);
    core::note_presence(whole);
    const auto inside = std::mismatch(top.begin(), top.end(), whole.begin(), whole.end()).first == top.end();
    constexpr std::uintmax_t most = 1 << 20;
    if (name.empty() || error || !inside || !fs::is_regular_file(whole, error) || fs::file_size(whole, error) > most) {
        return {};
    }
    return whole;
}

}  // namespace underbody::postproc
