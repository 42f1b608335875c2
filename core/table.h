// Tables with units: columns of SI numbers or of text, read from and written to CSV (name [unit], ...).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace underbody::core {

/// One column. Numbers are SI whatever unit the file had; a missing value is NaN; text columns have `text` only.
struct Column {
    std::string name;
    std::string unit;          ///< SI unit of `numbers` ("" for text, "1" for pure numbers)
    std::string written_unit;  ///< the unit of the file it came from, or the one to write in
    std::vector<double> numbers;
    std::vector<std::string> text;

    [[nodiscard]] bool is_text() const { return unit.empty(); }
};

class Table {
public:
    /// Name of the file it was read from, for messages; may be empty.
    std::string source;
    /// Comment lines (without '#'), kept in order; written back at the top.
    std::vector<std::string> comments;

    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }

    /// nullptr when there is none.
    [[nodiscard]] const Column* find(std::string_view name) const;
    /// Throws InputError with the nearest name when there is none, or when it is text.
    [[nodiscard]] const std::vector<double>& numbers(std::string_view name) const;
    [[nodiscard]] const std::vector<std::string>& text(std::string_view name) const;

    /// `values` in SI. `written_unit` (default: the SI unit) is used by the writer. Sizes must agree with the rows
    /// there are.
    void add_numbers(std::string name, std::string si_unit, std::vector<double> values, std::string written_unit = {});
    void add_text(std::string name, std::vector<std::string> values);

    /// Line of the file that row `row` came from (1-based), 0 when not from a file.
    [[nodiscard]] std::int64_t line_of_row(std::size_t row) const { return row < lines_.size() ? lines_[row] : 0; }
    [[nodiscard]] Place place(std::size_t row, std::string_view column) const;

    /// A table of the given rows, in that order.
    [[nodiscard]] Table selected(const std::vector<std::size_t>& rows) const;

    friend Table read_csv(std::string_view bytes, const std::string& source);

private:
    void check_new(const std::string& name, std::size_t size);
    std::vector<Column> columns_;
    std::vector<std::int64_t> lines_;
    std::size_t rows_ = 0;
};

/// Reads docs/conventions.md section 2: UTF-8, BOM skipped, header `name [unit]`, '#' comments, empty field = missing.
/// A column without a unit holds text. Columns whose name is a known quantity, or `NAME_sigma` of one, must have
/// its dimension. Throws InputError naming file, line and column: no header, duplicate name, missing or unknown
/// unit, wrong dimension, ragged line, a number that does not parse, a non-finite value. A table without rows is an
/// error.
Table read_csv(const std::filesystem::path& path);
Table read_csv(std::string_view bytes, const std::string& source);

/// The table in its written units, shortest digits that read back to the same doubles.
std::string write_csv(const Table& table);
void write_csv(const std::filesystem::path& path, const Table& table);

}  // namespace underbody::core
