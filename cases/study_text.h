// Changes in the text of study.toml that leave comments and order as they are.
#pragma once

#include <string>

namespace underbody::cases {

/// The text with `key = value` in the [[kind]] of that name, at the place where the key stands, else behind its last.
/// A number, true and false, a list and an inline table stay what they are, all else becomes a string; a value of
/// several lines is replaced as a whole. Throws core::UsageError: there is no such
/// [[kind]] (with the nearest name).
std::string with_value(const std::string& text, const std::string& kind, const std::string& name,
                       const std::string& key, const std::string& value);

/// The same in a table that a study has once, such as "reference" or "sweep.slurm" ("": what stands before the first
/// table); where it is not there, it is put at the end.
std::string with_value_of_table(const std::string& text, const std::string& table, const std::string& key,
                                const std::string& value);

}  // namespace underbody::cases
