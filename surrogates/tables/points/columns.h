// Columns of a table that nothing uses. For the files of this room only.
#pragma once

#include <string>

#include "core/error.h"
#include "core/table.h"

namespace underbody::tables {

/// Columns that are no known quantity: those that look like a misnamed axis, force or standard deviation (which the
/// table lacks) as warnings with the heading they should have, other numbers as notes. Columns of words are labels and
/// not told.
core::Problems unused_columns(const core::Table& table, const std::string& quantity);

/// The warnings in one line for the hint of an error: "the column 'Gap (mm)' is not understood: write 'gap [mm]'";
/// empty without any.
std::string misnamed_columns(const core::Table& table, const std::string& quantity);

}  // namespace underbody::tables
