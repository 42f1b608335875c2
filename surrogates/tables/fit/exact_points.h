// Points whose errors nobody stated.
#pragma once

#include <string>

#include "surrogates/tables/fit/force_table.h"

namespace underbody::tables {

/// What the error of a table through points that state none rests on: "the points of lift_force state no errors and are
/// taken as exact ...", or that what they scatter by about the fit is taken as their error. Empty for any other, and
/// where a warning of the table says it. It belongs wherever the table's error is read.
std::string unstated_errors(const ForceTable& table);

/// Of such a sentence: are the points taken as exact?
bool says_exact(const std::string& sentence);

}  // namespace underbody::tables
