// Keywords of OpenFOAM dictionaries that stand for several things: quoted ones are regular expressions.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace underbody::postproc {

/// A keyword as it stands before an entry.
class FoamKey {
public:
    /// `quoted`: between quotation marks, and so a POSIX extended regular expression for a whole name. Throws
    /// core::InputError without a place when it is none.
    FoamKey(std::string word, bool quoted);

    [[nodiscard]] bool is_pattern() const { return pattern_ != nullptr; }
    [[nodiscard]] const std::string& word() const { return word_; }
    /// Is it this name, or a pattern that it fits?
    [[nodiscard]] bool fits(const std::string& name) const;

private:
    struct Pattern;
    std::string word_;
    std::shared_ptr<const Pattern> pattern_;
};

/// Which of the keys of a boundary field is for the patch, as OpenFOAM looks it up: its plain name, else the last of
/// the groups that it is in, else the last pattern that its name fits; -1: none.
int key_for_patch(const std::vector<FoamKey>& keys, const std::string& patch, const std::vector<std::string>& groups);

}  // namespace underbody::postproc
