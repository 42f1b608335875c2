// Options that every command shares that reads CFD files.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "postproc/field/field.h"

namespace CLI {
class App;
}

namespace underbody::studio {

/// For options with several names, parted by commas: blanks around each are not of the name.
std::string trimmed_name(const std::string& name);

/// --zones, --length-unit, --unit, --mesh, --time, --cgns-base.
struct FieldOptions {
    std::vector<std::string> zones;
    std::string length_unit;
    std::vector<std::string> units;
    std::string mesh;
    std::string time;
    std::string base;

    void add_to(CLI::App& command, bool with_zones = true);
    /// Throws core::UsageError for a --unit without '='.
    [[nodiscard]] postproc::ReadOptions read_options() const;
};

/// A file of a batch with the conditions that its name or the manifest gives.
struct ConditionedFile {
    std::string path;
    std::vector<std::pair<std::string, double>> numbers;  ///< SI
    std::vector<std::pair<std::string, std::string>> texts;
    core::Place row{};  ///< its row of the manifest; without a file when it is in none
};
struct Batch {
    std::vector<ConditionedFile> files;
    std::vector<std::pair<std::string, std::string>> number_units;  ///< condition -> unit it was written in
    core::Problems problems;                                        ///< files that a pattern only just passes over
};

/// Files, shell patterns and name patterns ('{variant}-h{gap:mm}.csv'); `manifest` is a table with a column `file`
/// whose other columns are conditions (rows are added to the files named, paths are relative to the manifest).
/// `zones`: those that --zones named, for the hint when one of several stands among the files.
Batch find_files(const std::vector<std::string>& arguments, const std::string& manifest,
                 const std::vector<std::string>& zones);

}  // namespace underbody::studio
