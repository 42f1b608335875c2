// plan.csv and results.csv of a search: files that the program and people write.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/table.h"
#include "surrogates/tables/search/surrogate.h"

namespace underbody::cases {

/// The names of its columns.
std::vector<std::string> names_of(const core::Table& table);
/// A column of text; `fallback` in every row where the table has none of that name.
std::vector<std::string> text_or(const core::Table& table, const std::string& name, const std::string& fallback);
/// The column of a variable. Throws core::InputError where the table has none.
const std::vector<double>& numbers_of(const core::Table& table, const tables::SearchVariable& variable);

/// One file. Columns and comments that the program does not know stay as they are; a file that somebody changed after
/// it was read is not written over.
class DesignTable {
public:
    /// Reads the file, whose columns of these names are the program's. Throws as core::read_csv.
    core::Table read(const std::filesystem::path& file, const std::vector<std::string>& own);
    /// Writes it whole: at least as many rows as were read, in the same order. Throws core::InputError (kind "changed")
    /// when the file was changed since it was read or written here; core::SystemError.
    void write(const std::filesystem::path& file, core::Table table);
    /// Adds rows to what is there, in one piece. A file that was not written here yet has columns of its own: it must
    /// be written whole first. Throws as write.
    void append(const core::Table& rows);
    /// Written here: rows can be added.
    [[nodiscard]] bool ours() const { return ours_; }

private:
    struct Stamp {
        bool there = false;
        std::uintmax_t size = 0;
        std::filesystem::file_time_type time;
        friend bool operator==(const Stamp&, const Stamp&) = default;
    };
    static Stamp stamp_of(const std::filesystem::path& file);
    void check_unchanged(const std::filesystem::path& file) const;
    void add_others(core::Table& table, std::size_t first) const;

    std::filesystem::path file_;
    Stamp seen_;
    std::vector<core::Column> others_;  ///< of the user's
    std::vector<std::string> comments_;
    bool ours_ = false;
};

}  // namespace underbody::cases
