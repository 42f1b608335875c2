// Which rows and which quantities of a table to use.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/table.h"

namespace underbody::tables {

/// The points of a CSV file; or of a JSON that `export --format json` wrote, as the table that its CSV would be. Throws
/// core::InputError with file and place.
core::Table read_points(const std::filesystem::path& path);

/// Rows where every condition holds: "variant=ellipse, mesh=medium, pitch=0deg". Text columns compare as written,
/// numbers within 1e-9; a bare number is SI. "NAME=a|b" takes either. The way a study writes it is read too: {variant =
/// "ellipse", pitch = "0 deg"}. Empty: all rows. Throws core::UsageError for an unknown column or a selection that
/// leaves nothing (naming the values there are).
core::Table selected_rows(const core::Table& table, const std::string& conditions);

/// Known forces and moments that the table has, in its order; other numeric columns when it has none of these.
std::vector<std::string> force_columns(const core::Table& table);

}  // namespace underbody::tables
