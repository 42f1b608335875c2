// Files of results beside the report.
#pragma once

#include <algorithm>
#include <string>

#include "core/error.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::cases {

/// The name of a table as identifier and file.
inline std::string export_name(std::string table) {
    std::replace_if(
        table.begin(), table.end(), [](char c) { return c == ' ' || c == ',' || c == '/'; }, '_');
    return table;
}

/// "lift.h": the file of an export of a [[table]]. Throws core::InputError for an unknown format.
inline std::string export_file(const std::string& table, const std::string& format) {
    std::vector<std::string> known;
    for (const auto& candidate : tables::export_formats()) {
        if (candidate.name == format) {
            return export_name(table) + candidate.ending;
        }
        known.push_back(candidate.name);
    }
    throw core::InputError("name", "unknown export format '" + format + "'", {}, core::did_you_mean(format, known));
}

}  // namespace underbody::cases
