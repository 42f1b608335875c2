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

/// A table of the study, for exports that say what they are of and commands that do the same.
struct TableOfStudy {
    std::string name;
    std::string file;    ///< of its points, beside the report
    std::string first;   ///< the command that writes that file; empty: it is there, and of the table as it is now
    std::string before;  ///< what must be changed before `first` writes it; empty: nothing
    std::string origin;  ///< line of the head by which `study why` knows the file; empty: the store has no such table
    /// The words as a command line, behind what must be done before.
    [[nodiscard]] std::string line(const Words& words) const;
};
/// Empty where no study is open or it has no such table.
TableOfStudy table_of_study(const Session& session, const std::string& table);

/// Fits the table as the study says now and writes the file with the options of the record. Throws core::Error: no such
/// table, no loads, as tables::export_table.
void export_again(const Session& session, const std::string& file, const ExportRecord& record,
                  core::Progress& progress);

/// `exported FILE TABLE KEY=VALUE ...`, as the action takes it.
Words words_of_export(const std::string& file, const ExportRecord& record);

}  // namespace underbody::studio
