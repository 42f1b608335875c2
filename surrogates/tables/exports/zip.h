// A minimal zip writer: stored entries, fixed dates, so that the same content gives the same bytes.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace underbody::tables {

/// (name, content) in the order given; names with forward slashes. APPNOTE 6.3.3, version 2.0, method 0, dates
/// 1980-01-01.
std::string zip_archive(const std::vector<std::pair<std::string, std::string>>& entries, const std::string& comment);

}  // namespace underbody::tables
