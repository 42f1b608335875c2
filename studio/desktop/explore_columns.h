// The columns that Explore shows, and their units there.
#pragma once

#include <QString>
#include <string>
#include <vector>

#include "core/table.h"

namespace underbody::studio {

/// Columns of numbers that are looked at: conditions and the main loads, what was varied; not their errors.
std::vector<const core::Column*> columns_of(const core::Table& table);

/// What a column's numbers are shown in.
std::string unit_of(const core::Column& column);

/// A column's name as a title has it.
QString axis_words(const std::string& name);

}  // namespace underbody::studio
