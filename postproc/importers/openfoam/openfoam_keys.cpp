#include "postproc/importers/openfoam/openfoam_keys.h"

#include <algorithm>
#include <regex>

#include "core/error.h"

namespace underbody::postproc {

namespace {

// The compiler of expressions goes one call deeper for every bracket.
constexpr std::size_t longest_pattern = 1000;
constexpr std::size_t longest_name = 1000;

}  // namespace

struct FoamKey::Pattern {
    std::regex expression;
};

FoamKey::FoamKey(std::string word, bool quoted) : word_(std::move(word)) {
    if (!quoted) {
        return;
    }
    if (word_.size() > longest_pattern) {
        throw core::InputError("format", "a pattern of " + std::to_string(word_.size()) + " characters for names: '" +
                                             word_.substr(0, 40) + " ...'");
    }
    try {
        // In time that grows with the name's length only, whatever the expression.
        pattern_ = std::make_shared<Pattern>(
            Pattern{std::regex(word_, std::regex::extended | std::regex_constants::__polynomial)});
    } catch (const std::regex_error& error) {
        throw core::InputError("format",
                               "'" + word_ + "' is in quotation marks, but no regular expression: " + error.what());
    }
}

bool FoamKey::fits(const std::string& name) const {
    return pattern_ == nullptr ? word_ == name
                               : name.size() <= longest_name && std::regex_match(name, pattern_->expression);
}

int key_for_patch(const std::vector<FoamKey>& keys, const std::string& patch, const std::vector<std::string>& groups) {
    const auto last = [&](auto&& is_it) {
        const auto found = std::find_if(keys.rbegin(), keys.rend(), is_it);
        return static_cast<int>(keys.rend() - found) - 1;
    };
    if (const int own = last([&](const FoamKey& key) { return !key.is_pattern() && key.word() == patch; }); own >= 0) {
        return own;
    }
    if (const int group = last([&](const FoamKey& key) {
            return !key.is_pattern() && std::find(groups.begin(), groups.end(), key.word()) != groups.end();
        });
        group >= 0) {
        return group;
    }
    return last([&](const FoamKey& key) { return key.is_pattern() && key.fits(patch); });
}

}  // namespace underbody::postproc
