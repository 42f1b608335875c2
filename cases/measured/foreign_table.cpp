#include "cases/measured/foreign_table.h"

#include <algorithm>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"

namespace underbody::cases {

std::size_t ForeignTable::column(const std::string& name) const {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) {
        throw core::InputError("name", "no column '" + name + "'", core::Place{source, 1, {}, {}},
                               core::did_you_mean(name, header));
    }
    return static_cast<std::size_t>(found - header.begin());
}

double ForeignTable::number(std::size_t row, std::size_t column_index) const {
    const auto value = core::parse_number(rows[row][column_index]);
    if (!value) {
        throw core::InputError(
            "parse", "'" + rows[row][column_index] + "' is not a number",
            core::Place{source, static_cast<std::int64_t>(row) + 2, static_cast<std::int64_t>(column_index) + 1, {}});
    }
    return *value;
}

std::vector<double> ForeignTable::numbers(const std::string& name) const {
    const std::size_t index = column(name);
    std::vector<double> values;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        values.push_back(number(row, index));
    }
    return values;
}

ForeignTable read_foreign(const std::filesystem::path& file) {
    ForeignTable table;
    table.source = file.string();
    const std::string text = core::read_file(file);
    for (const std::string_view line : core::split(text, '\n')) {
        if (core::trimmed(line).empty()) {
            continue;
        }
        std::vector<std::string> cells;
        for (const std::string_view cell : core::split(line, ',')) {
            cells.emplace_back(core::trimmed(cell));
        }
        if (table.header.empty()) {
            table.header = std::move(cells);
        } else if (cells.size() == table.header.size()) {
            table.rows.push_back(std::move(cells));
        } else {
            throw core::InputError("parse", "a line with another number of columns than the header",
                                   core::Place{table.source, static_cast<std::int64_t>(table.rows.size()) + 2, {}, {}});
        }
    }
    return table;
}

}  // namespace underbody::cases
