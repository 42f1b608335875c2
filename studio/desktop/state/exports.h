// Files that were exported for controllers: what they were made of, whether that has changed since, and making them
// again.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "studio/desktop/state/state.h"
#include "studio/desktop/state/words.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::studio {

/// Equal for equal points, an equal way of fitting and an equal model that changes the force (cases::found_force);
/// empty where the study has no such table or no loads for it.
std::string table_digest(const Session& session, const std::string& table);

enum class ExportState { as_now, stale, missing };
/// Whether the file is there, and made of what the table is now.
ExportState state_of(const Session& session, const std::string& file, const ExportRecord& record);

/// Paths of those that are stale or missing.
std::vector<std::string> stale_exports(const State& state, const Session& session);

/// Tables that are marked: selected, or with a star; in the order of the study.
std::vector<std::string> marked_tables(const State& state, const Session& session);

/// Of these, those that are there and are not what the window wrote: another program did, or somebody changed them
/// since.
std::vector<std::string> foreign_files(const State& state, const std::vector<std::string>& files);

/// A table of the study, for exports that say what they are of and commands that do the same.
struct TableOfStudy {
    std::string name;
    std::string file;    ///< of its points, beside the report; of the model that was found to change its force
    std::string first;   ///< the command that writes that file; empty: it is there, and of the table as it is now
    std::string before;  ///< what must be changed before `first` writes it; empty: nothing
    std::string origin;  ///< line of the head by which `study why` knows the file; empty: the store has no such table
    std::string axes;    ///< to be named in the command; empty: they follow from the file
    std::string found;  ///< what the force holds beside the table: "surface_roughness, found of 'tank'"; empty: nothing
    /// Of the head of the file, where something was found.
    [[nodiscard]] std::string found_line() const;
    /// The words as a command line, behind what must be done before.
    [[nodiscard]] std::string line(const Words& words) const;
    /// The command that writes an export of it.
    [[nodiscard]] Words command(const std::string& quantity, const std::string& file_to_write,
                                const ExportRecord& record) const;
};
/// Empty where no study is open or it has no such table.
TableOfStudy table_of_study(const Session& session, const std::string& table);

/// What is exported of a table: fitted as the study says now, or the force of the model that was found to change it;
/// beyond its ends the policies of `range` (axis -> policy). Throws core::Error: no such table, no loads.
tables::ForceTable exported_table(const Session& session, const std::string& table,
                                  const std::map<std::string, std::string>& range, core::Progress& progress);

/// Writes the file with the options of the record; replaces what is there. Returns the record with what it was made of
/// and what was written. Throws as exported_table and tables::export_table.
ExportRecord export_again(const Session& session, const std::string& file, ExportRecord record,
                          core::Progress& progress);

/// How a record asks for a file: name, frame, numbers, error.
tables::ExportOptions options_of(const ExportRecord& record);

using ExportedFiles = std::vector<std::pair<std::string, ExportRecord>>;  ///< by path
/// `exported FILE TABLE KEY=VALUE ... [and FILE TABLE KEY=VALUE ...]`, as the action takes it.
Words words_of_exports(const ExportedFiles& files);
/// The words of each file: FILE TABLE KEY=VALUE ...
std::vector<Words> split_exports(const Words& words);

}  // namespace underbody::studio
