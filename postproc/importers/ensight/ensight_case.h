// The text file that tells which files an EnSight Gold case consists of.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace underbody::postproc {

/// A file, and which of its steps; -1: it has one only.
struct EnsightFile {
    std::filesystem::path path;
    int step = -1;
};

struct EnsightVariable {
    std::string name;
    EnsightFile file;
    bool on_nodes = true;
    int components = 1;
};

struct EnsightCase {
    EnsightFile geometry;
    /// Where the elements are, when the geometry's steps hold coordinates only ("change_coords_only").
    std::optional<EnsightFile> connectivity;
    std::vector<EnsightVariable> variables;
    std::vector<std::pair<std::string, std::string>> constants;
    int steps = 1;               ///< how many steps there are in time
    std::vector<double> times;   ///< of these steps, s; empty when steady
    std::optional<double> time;  ///< of the step that the files belong to
    core::Problems problems;
};

/// Does the text look like an EnSight case?
bool is_ensight_case(std::string_view head);

/// Reads it; file names are made complete (quotes, wildcards) for the step at `time`, or the last one.
/// Throws InputError with the line.
EnsightCase read_ensight_case(const std::filesystem::path& path, std::optional<double> time = {});

}  // namespace underbody::postproc
