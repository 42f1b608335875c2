// Files that were exported for controllers: what they were made of, whether that has changed since, and making them
// again.
#pragma once

#include <string>

#include "core/progress.h"
#include "studio/desktop/state/state.h"
#include "studio/desktop/state/words.h"

namespace underbody::studio {

/// Equal for equal points and an equal way of fitting; empty where the study has no such table or no loads for it.
std::string table_digest(const Session& session, const std::string& table);

enum class ExportState { as_now, stale, missing };
/// Whether the file is there, and made of what the table is now.
ExportState state_of(const Session& session, const std::string& file, const ExportRecord& record);

/// Paths of those that are stale or missing.
std::vector<std::string> stale_exports(const State& state, const Session& session);

/// Fits the table as the study says now and writes the file with the options of the record. Throws core::Error: no such
/// table, no loads, as tables::export_table.
void export_again(const Session& session, const std::string& file, const ExportRecord& record,
                  core::Progress& progress);

/// The points of a table of the study as `study run` writes them; empty without a study.
std::string table_file(const State& state, const std::string& table);

/// `exported FILE TABLE KEY=VALUE ...`, as the action takes it.
Words words_of_export(const std::string& file, const ExportRecord& record);

}  // namespace underbody::studio
