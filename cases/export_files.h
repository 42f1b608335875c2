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

/// "lift.h": the file of an export of a [[table]]; "lift_simulink.mat" where another format ends alike. Throws
/// core::InputError for an unknown format.
inline std::string export_file(const std::string& table, const std::string& format) {
    std::vector<std::string> known;
    const auto& formats = tables::export_formats();
    for (const auto& candidate : formats) {
        if (candidate.name == format) {
            const auto first = std::find_if(formats.begin(), formats.end(),
                                            [&](const auto& other) { return other.ending == candidate.ending; });
            return export_name(table) + (first->name == format ? "" : "_" + format) + candidate.ending;
        }
        known.push_back(candidate.name);
    }
    throw core::InputError("name", "unknown export format '" + format + "'", {}, core::did_you_mean(format, known));
}

}  // namespace underbody::cases
