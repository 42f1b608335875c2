// A plain CSV of somebody else: no units in its header, text stays text.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace underbody::cases {

struct ForeignTable {
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;
    std::string source;

    /// Throws core::InputError with the nearest name.
    [[nodiscard]] std::size_t column(const std::string& name) const;
    /// Throws core::InputError with line and column where the cell is no number.
    [[nodiscard]] double number(std::size_t row, std::size_t column_index) const;
    [[nodiscard]] std::vector<double> numbers(const std::string& name) const;
};

/// Throws core::InputError: no file, a line with another number of columns than the header.
ForeignTable read_foreign(const std::filesystem::path& file);

}  // namespace underbody::cases
