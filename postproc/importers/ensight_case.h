// The text file that tells which files an EnSight Gold case consists of.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace underbody::postproc {

struct EnsightVariable {
    std::string name;
    std::filesystem::path file;
    bool on_nodes = true;
    int components = 1;
};

struct EnsightCase {
    std::filesystem::path geometry;
    std::vector<EnsightVariable> variables;
    std::vector<std::pair<std::string, std::string>> constants;
    int steps = 1;     ///< how many steps there are in time; the last is taken
    std::string time;  ///< of that step, as written; "" when steady
    core::Problems problems;
};

/// Does the text look like an EnSight case?
bool is_ensight_case(std::string_view head);

/// Reads it; file names are made complete (quotes, wildcards of the last step). Throws InputError with the line.
EnsightCase read_ensight_case(const std::filesystem::path& path);

}  // namespace underbody::postproc
