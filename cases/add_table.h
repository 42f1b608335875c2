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
    Conditions where;               ///< what its cases have
    std::string net_weight;         ///< with its unit; empty: none
    std::string virtual_mass;       ///< likewise
    std::vector<std::string> exports;
};

/// What becomes of it in a study.
struct PlannedTable {
    std::string name;
    std::vector<std::string> axes;
    std::size_t cases = 0;  ///< that it is made of
};

/// Throws core::UsageError and core::InputError: no case for it, cases that differ in what is neither an axis nor held,
/// an axis that does not vary, a name that is taken, a weight or mass that is none, an unknown export. Reads no file.
PlannedTable plan_table(const Study& study, const NewTable& table);

/// Its [[table]], as study.toml has it.
std::string lines_of(const NewTable& table, const PlannedTable& planned);

/// The table over the gap of the fullest curve among the cases, as gap_groups tells them apart.
NewTable proposed_table(const Study& study);

struct AddedTable {
    std::filesystem::path file;  ///< study.toml
    std::string text;            ///< of it, with the new lines
    Study study;                 ///< that it is; the new table is the last of `tables`
    PlannedTable planned;
};

/// The study with the table; nothing is written. Throws as plan_table, and what is wrong with study.toml or the new
/// lines.
AddedTable with_new_table(const std::filesystem::path& folder, const NewTable& table);

/// Writes study.toml.
void write_added(const AddedTable& added);

}  // namespace underbody::cases
