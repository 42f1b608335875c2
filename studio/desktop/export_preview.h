// What an export would write, before it is written.
#pragma once

#include <QString>
#include <map>
#include <string>

#include "core/figure.h"
#include "core/progress.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::studio {

/// What would be written, and how far it is from the table.
struct ExportPreview {
    QString facts, text;
    core::Figure error;  ///< without curves where the file equals the table
};
/// Throws as tables::export_table.
ExportPreview preview_of(const tables::ForceTable& table, const std::string& kind, const tables::ExportOptions& wanted,
                         core::Progress& progress);

/// Fitted again to its points, as it was, with these policies beyond the ends of its axes; none: as it is.
tables::ForceTable refitted(const tables::ForceTable& known, const std::map<std::string, std::string>& range);

}  // namespace underbody::studio
