// Names by which results are asked for: their own, those of their files, and what the head of an exported file says.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace underbody::cases {

using Name = std::pair<std::string, std::string>;  ///< kind and name, as a person knows them

inline std::string shown(const Name& name) { return name.first + "/" + name.second; }

/// The file beside the report that holds a result; empty: none does.
std::string file_of(const Name& name);
/// "'cube-h2'", "report/exports/lift.h" without what says nothing of the result.
std::string bare(std::string what);
bool is_called(const Name& name, const std::string& what);

/// What the head of an exported file says of its making.
struct Head {
    Name result;
    std::string id;       ///< of the result
    bool again = false;   ///< of the result that the file which this one was exported from held
    std::string content;  ///< hash of the file that it was made from
};
Head head_of(const std::filesystem::path& file);

}  // namespace underbody::cases
