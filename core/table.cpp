#include "core/table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/file.h"
#include "core/heading.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::core {

const Column* Table::find(std::string_view name) const {
    for (const auto& column : columns_) {
        if (column.name == name) {
            return &column;
        }
    }
    return nullptr;
}

namespace {
std::vector<std::string> names_of(const std::vector<Column>& columns) {
    std::vector<std::string> names;
    for (const auto& column : columns) {
        names.push_back(column.name);
    }
    return names;
}
}  // namespace

const std::vector<double>& Table::numbers(std::string_view name) const {
    const Column* column = find(name);
    if (column == nullptr) {
        throw InputError("missing", "there is no column '" + std::string(name) + "'", {source, {}, {}, {}},
                         did_you_mean(std::string(name), names_of(columns_)));
    }
    if (column->is_text()) {
        throw InputError("unit", "column '" + std::string(name) + "' has no unit, so it holds text",
                         {source, {}, {}, {}},
                         "write its unit in the header: '" + std::string(name) + " [unit]', [1] for a pure number");
    }
    return column->numbers;
}

const std::vector<std::string>& Table::text(std::string_view name) const {
    const Column* column = find(name);
    if (column == nullptr || !column->is_text()) {
        std::vector<std::string> texts;
        for (const auto& other : columns_) {
            if (other.is_text()) {
                texts.push_back(other.name);
            }
        }
        throw InputError("missing", "there is no text column '" + std::string(name) + "'", {source, {}, {}, {}},
                         texts.empty() ? "no column holds text: its header has no unit in brackets"
                                       : did_you_mean(std::string(name), texts));
    }
    return column->text;
}

void Table::check_new(const std::string& name, std::size_t size) {
    if (find(name) != nullptr) {
        throw InputError("duplicate", "column '" + name + "' occurs twice", {source, {}, {}, {}});
    }
    if (!columns_.empty() && size != rows_) {
        throw std::logic_error("Table: column '" + name + "' has " + std::to_string(size) + " rows, the table " +
                               std::to_string(rows_));
    }
    rows_ = size;
}

void Table::add_numbers(std::string name, std::string si_unit, std::vector<double> values, std::string written_unit) {
    check_new(name, values.size());
    Column column;
    column.name = std::move(name);
    column.unit = std::move(si_unit);
    column.written_unit = written_unit.empty() ? column.unit : std::move(written_unit);
    column.numbers = std::move(values);
    columns_.push_back(std::move(column));
}

void Table::add_text(std::string name, std::vector<std::string> values) {
    check_new(name, values.size());
    Column column;
    column.name = std::move(name);
    column.text = std::move(values);
    columns_.push_back(std::move(column));
}

Place Table::place(std::size_t row, std::string_view name) const {
    Place place;
    place.file = source;
    if (const std::int64_t line = line_of_row(row); line > 0) {
        place.line = line;
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            if (columns_[i].name == name) {
                place.column = static_cast<std::int64_t>(i) + 1;
            }
        }
    }
    return place;
}

Table Table::selected(const std::vector<std::size_t>& rows) const {
    Table result;
    result.source = source;
    result.comments = comments;
    result.rows_ = rows.size();
    for (const auto& column : columns_) {
        Column part{column.name, column.unit, column.written_unit, {}, {}};
        for (const std::size_t row : rows) {
            if (column.is_text()) {
                part.text.push_back(column.text.at(row));
            } else {
                part.numbers.push_back(column.numbers.at(row));
            }
        }
        result.columns_.push_back(std::move(part));
    }
    for (const std::size_t row : rows) {
        result.lines_.push_back(line_of_row(row));
    }
    return result;
}

namespace {

/// One header cell, `name [unit]` or `name`.
struct Heading {
    std::string name;
    std::string unit;
    Conversion to_si;
    std::string si;
};

Heading read_heading(std::string_view cell, const Place& place) {
    const auto text = heading_text(cell);
    if (!text) {
        throw InputError("parse", "'" + std::string(trimmed(cell)) + "' is not of the form 'name [unit]'", place);
    }
    Heading heading;
    heading.name = text->name;
    heading.unit = text->unit.value_or("");
    if (!text->unit) {
        if (find_quantity(heading.name) != nullptr) {
            throw InputError("unit", "column '" + heading.name + "' has no unit", place,
                             "write '" + heading.name + " [" + find_quantity(heading.name)->unit + "]'");
        }
    } else if (heading.unit.empty()) {
        throw InputError("unit", "column '" + heading.name + "' has an empty unit", place,
                         "a pure number has [1]; a column of text has no brackets");
    }
    if (heading.name.empty()) {
        throw InputError("parse", "a column has no name", place);
    }
    if (heading.unit.empty()) {
        return heading;
    }
    constexpr std::string_view sigma_ending = "_sigma";
    std::string base = heading.name;
    const bool is_sigma = base.size() > sigma_ending.size() && base.ends_with(sigma_ending);
    if (is_sigma) {
        base.resize(base.size() - sigma_ending.size());
    }
    const QuantityName* quantity = find_quantity(base);
    heading.si = quantity != nullptr ? quantity->unit : si_unit(heading.unit, place);
    heading.to_si = conversion(heading.unit, heading.si, place);
    if (is_sigma) {
        heading.to_si.offset = 0;  // a difference of temperatures has no zero point
    }
    return heading;
}

}  // namespace

namespace {

/// The first field such as "0,25", with its quotes; empty when the line has none.
std::string quoted_decimal_comma(std::string_view line) {
    for (std::size_t open = line.find('"'); open != std::string_view::npos;) {
        const std::size_t close = line.find('"', open + 1);
        if (close == std::string_view::npos) {
            break;
        }
        std::string number(line.substr(open + 1, close - open - 1));
        const std::size_t comma = number.find(',');
        if (comma != std::string::npos && parse_number(number.replace(comma, 1, "."))) {
            return std::string(line.substr(open, close - open + 1));
        }
        open = line.find('"', close + 1);
    }
    return {};
}

}  // namespace

Table read_csv(const std::filesystem::path& path) {
    const MappedFile file(path);
    return read_csv(file.bytes(), path.string());
}

namespace {

/// Of a header line in one piece.
void check_separator(std::string_view line, std::size_t cells, const Place& place) {
    if (cells == 1 && line.find_first_of(";\t") != std::string_view::npos) {
        throw InputError("parse",
                         std::string("the columns are separated by ") +
                             (line.find(';') != std::string_view::npos ? "';'" : "tabulators") + ", not by commas",
                         place, "separate them by commas, and write numbers with '.' as decimal point");
    }
}

[[noreturn]] void refuse_ragged(std::string_view line, std::size_t cells, std::size_t headings, const Place& place) {
    if (const std::string quoted = quoted_decimal_comma(line); !quoted.empty()) {
        throw InputError("parse", quoted + " is a number with a decimal comma", place,
                         "write it with '.' as decimal point, without quotes");
    }
    throw InputError("ragged",
                     "this line has " + std::to_string(cells) + " fields, the header " + std::to_string(headings),
                     {place.file, place.line, static_cast<std::int64_t>(std::min(cells, headings)) + 1, {}},
                     "numbers use '.' as decimal point; a missing value is an empty field");
}

void add_cell(Column& column, const Heading& heading, std::string_view cell, const Place& place) {
    if (column.is_text()) {
        column.text.emplace_back(cell);
        return;
    }
    if (cell.empty()) {
        column.numbers.push_back(std::numeric_limits<double>::quiet_NaN());
        return;
    }
    const auto value = parse_number(cell);
    if (!value) {
        throw InputError("parse", "column '" + column.name + "': '" + std::string(cell) + "' is not a number", place);
    }
    if (!std::isfinite(*value)) {
        throw InputError("range", "column '" + column.name + "': '" + std::string(cell) + "' is not finite", place,
                         "leave the field empty for a missing value");
    }
    column.numbers.push_back(heading.to_si(*value));
}

}  // namespace

Table read_csv(std::string_view bytes, const std::string& source) {
    Table table;
    table.source = source;
    if (bytes.starts_with("\xEF\xBB\xBF")) {
        bytes.remove_prefix(3);
    }
    std::vector<Heading> headings;
    std::int64_t line_number = 0;
    std::size_t begin = 0;
    while (begin < bytes.size()) {
        const std::size_t end = std::min(bytes.find('\n', begin), bytes.size());
        const std::string_view line = trimmed(bytes.substr(begin, end - begin));
        begin = end + 1;
        ++line_number;
        if (line.empty()) {
            continue;
        }
        if (line.front() == '#') {
            table.comments.emplace_back(trimmed(line.substr(1)));
            continue;
        }
        const auto cells = split(line, ',');
        if (headings.empty()) {
            check_separator(line, cells.size(), {source, line_number, {}, {}});
            for (std::size_t i = 0; i < cells.size(); ++i) {
                const Place place{source, line_number, static_cast<std::int64_t>(i) + 1, {}};
                headings.push_back(read_heading(cells[i], place));
                Column column{headings.back().name, headings.back().si, headings.back().unit, {}, {}};
                if (table.find(column.name) != nullptr) {
                    throw InputError("duplicate", "column '" + column.name + "' occurs twice", place);
                }
                table.columns_.push_back(std::move(column));
            }
            continue;
        }
        if (cells.size() != headings.size()) {
            refuse_ragged(line, cells.size(), headings.size(), {source, line_number, {}, {}});
        }
        for (std::size_t i = 0; i < cells.size(); ++i) {
            Column& column = table.columns_[i];
            add_cell(column, headings[i], trimmed(cells[i]),
                     {source, line_number, static_cast<std::int64_t>(i) + 1, {}});
        }
        table.lines_.push_back(line_number);
        ++table.rows_;
    }
    if (headings.empty()) {
        throw InputError("empty", "the table is empty: there is no header line", {source, {}, {}, {}},
                         "the first line names the columns: 'gap [mm], lift_force [N]'");
    }
    if (table.rows_ == 0) {
        throw InputError("empty", "the table has a header but no rows", {source, {}, {}, {}});
    }
    return table;
}

namespace {

/// The shortest digits in the written unit that read back to the same SI number: 3 degrees are 3, though 3 degrees in
/// radians are 3.0000000000000004 degrees by a multiplication.
std::string converted_text(double si, const Conversion& conversion, const Conversion& back) {
    const double value = conversion(si);
    if (!conversion.is_identity() && std::isfinite(value)) {
        for (const int digits : {14, 15, 16}) {
            const std::string text = format_number(value, digits);
            if (const auto read = parse_number(text); read && back(*read) == si) {
                return format_number(*read);
            }
        }
    }
    return format_number(value);
}

}  // namespace

std::string write_csv(const Table& table) {
    std::string text;
    for (const auto& comment : table.comments) {
        text += "# " + comment + "\n";
    }
    std::vector<Conversion> conversions, back;
    bool first = true;
    for (const auto& column : table.columns()) {
        text += (first ? "" : ", ") + column.name;
        first = false;
        conversions.emplace_back();
        back.emplace_back();
        if (!column.is_text()) {
            text += " [" + column.written_unit + "]";
            conversions.back() = conversion(column.unit, column.written_unit);
            back.back() = conversion(column.written_unit, column.unit);
            if (column.name.ends_with("_sigma")) {
                conversions.back().offset = back.back().offset = 0;
            }
        }
    }
    text += "\n";
    for (std::size_t row = 0; row < table.rows(); ++row) {
        for (std::size_t i = 0; i < table.columns().size(); ++i) {
            const Column& column = table.columns()[i];
            text += i == 0 ? "" : ", ";
            if (column.is_text()) {
                text += column.text[row];
            } else if (std::isfinite(column.numbers[row])) {
                text += converted_text(column.numbers[row], conversions[i], back[i]);
            }
        }
        text += "\n";
    }
    return text;
}

void write_csv(const std::filesystem::path& path, const Table& table) { write_file(path, write_csv(table)); }

}  // namespace underbody::core
