#include "core/table_rows.h"

#include <cmath>

#include "core/text.h"

namespace underbody::core {

namespace {

std::vector<QuantityName> columns_of_numbers(const Table& table) {
    std::vector<QuantityName> names;
    for (const auto& column : table.columns()) {
        if (!column.is_text()) {
            names.push_back({column.name, column.unit, {}, {}});
        }
    }
    return names;
}

const Column& column_named(const Table& table, const std::string& name) {
    const Column* column = table.find(name);
    if (column == nullptr || column->is_text()) {
        std::vector<std::string> known;
        for (const auto& one : columns_of_numbers(table)) {
            known.push_back(one.name);
        }
        throw UsageError("unknown", "there is no column of numbers '" + name + "'", {}, did_you_mean(name, known));
    }
    return *column;
}

}  // namespace

std::vector<NamedRange> ranges_of_columns(const std::string& text, const Table& table) {
    for (const auto& part : split(text, ',')) {  // names first: those of other tables mean nothing here
        if (const auto equal = part.find('='); equal != std::string::npos) {
            static_cast<void>(column_named(table, std::string(trimmed(part.substr(0, equal)))));
        }
    }
    return parse_ranges(text, columns_of_numbers(table));
}

std::vector<std::size_t> rows_within(const Table& table, const std::vector<NamedRange>& ranges) {
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < table.rows(); ++row) {
        rows.push_back(row);
    }
    for (const auto& range : ranges) {
        const Column& column = column_named(table, range.name);
        std::erase_if(rows, [&](std::size_t row) {
            const double value = column.numbers[row];
            // A value that was converted from another unit may differ in its last digit.
            return !(value >= range.lower - 1e-12 * std::abs(range.lower) &&
                     value <= range.upper + 1e-12 * std::abs(range.upper));
        });
    }
    return rows;
}

}  // namespace underbody::core
