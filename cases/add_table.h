// A table of forces for a study: a [[table]] more in study.toml, checked before anything is written.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cases/study.h"

namespace underbody::cases {

/// What a new [[table]] says.
struct NewTable {
    std::string quantity = "lift_force";
    std::string name;               ///< empty: the quantity in words ("lift")
    std::vector<std::string> axes;  ///< empty: the conditions that vary among its cases
    std::string where;              ///< as on the command line: "variant=ellipse,pitch=0deg"
    std::string net_weight;         ///< with its unit; empty: none
    std::string virtual_mass;       ///< likewise
    std::vector<std::string> exports;
};

struct AddedTable {
    std::filesystem::path file;  ///< study.toml
    std::string text;            ///< of it, with the new lines
    Study study;                 ///< that it is; the new table is the last of `tables`
    std::size_t cases = 0;       ///< that it is made of
};

/// The study with the table; nothing is written. Throws core::UsageError and core::InputError: no case for it, cases
/// that differ in what is neither an axis nor held, an axis that does not vary, a name that is taken, what is wrong
/// with the new lines.
AddedTable with_new_table(const std::filesystem::path& folder, const NewTable& table);

/// Writes study.toml.
void write_added(const AddedTable& added);

/// What to hold so that the cases of the study make one table: of each word (variant, mesh) the value that most cases
/// have, as `NewTable::where`.
std::string guessed_where(const Study& study);

}  // namespace underbody::cases
