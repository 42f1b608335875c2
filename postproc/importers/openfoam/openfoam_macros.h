// What "$name" stands for in an OpenFOAM dictionary, and which files "#include" may bring in.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace underbody::postproc {

/// The entries read so far of one dictionary, by their scoped names ("boundaryField.inlet.value").
class FoamEntries {
public:
    void enter(const std::string& dictionary);
    void leave();
    /// An entry of the current dictionary, its text without the closing ';' or the braces. Beyond 1 MB in all, entries
    /// are not kept.
    void define(const std::string& key, std::string text);
    /// The text that `$name` stands for: "name" here or in an enclosing dictionary, ".name" here, "..name" one further
    /// out, ":a.b" (or "/a/b", "!a/b") from the top. Nothing: not defined.
    [[nodiscard]] std::optional<std::string> find(std::string name) const;

private:
    std::vector<std::string> scope_;
    std::map<std::string, std::string> texts_;
    std::size_t bytes_ = 0;
};

/// Letters of a macro's name; "{" and "}" may stand round it.
bool is_macro_letter(char c);

/// The file that `#include "name"` in a file of `folder` means, where it is a file of the case of at most 1 MB: a case
/// brings in nothing from elsewhere on the machine. "$FOAM_CASE", "${FOAM_CASE}" and "<case>", "<system>", "<constant>"
/// are known.
std::optional<std::filesystem::path> included_file(std::string name, const std::filesystem::path& folder,
                                                   const std::filesystem::path& case_folder);

}  // namespace underbody::postproc
