#include "cases/design_table.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/own_files.h"

namespace underbody::cases {

namespace fs = std::filesystem;

std::vector<std::string> names_of(const core::Table& table) {
    std::vector<std::string> names;
    for (const core::Column& column : table.columns()) {
        names.push_back(column.name);
    }
    return names;
}

std::vector<std::string> text_or(const core::Table& table, const std::string& name, const std::string& fallback) {
    return table.find(name) != nullptr ? table.text(name) : std::vector<std::string>(table.rows(), fallback);
}

const std::vector<double>& numbers_of(const core::Table& table, const tables::SearchVariable& v) {
    const core::Column* column = table.find(v.name);
    if (column == nullptr) {
        throw core::InputError("column", table.source + " has no column '" + v.name + "', which [design] varies", {},
                               "set the file aside, or vary what it holds");
    }
    return table.numbers(v.name);
}

DesignTable::Stamp DesignTable::stamp_of(const fs::path& file) {
    std::error_code none;
    Stamp stamp;
    stamp.there = fs::exists(file, none);
    if (stamp.there) {
        stamp.size = fs::file_size(file, none);
        stamp.time = fs::last_write_time(file, none);
    }
    return stamp;
}

core::Table DesignTable::read(const fs::path& file, const std::vector<std::string>& own) {
    seen_ = stamp_of(file);
    core::Table table = core::read_csv(file);
    comments_ = table.comments;
    others_.clear();
    for (const core::Column& column : table.columns()) {
        if (std::find(own.begin(), own.end(), column.name) == own.end()) {
            others_.push_back(column);
        }
    }
    return table;
}

void DesignTable::check_unchanged(const fs::path& file) const {
    if (!(stamp_of(file) == seen_)) {
        throw core::InputError("changed", "the file was changed while this was under way, and is left as it is",
                               {file.string(), {}, {}, {}},
                               "start again: cases that were computed are not computed again");
    }
}

void DesignTable::add_others(core::Table& table, std::size_t first) const {
    for (const core::Column& column : others_) {
        if (column.is_text()) {
            std::vector<std::string> cells(table.rows());
            for (std::size_t i = 0; i < cells.size() && first + i < column.text.size(); ++i) {
                cells[i] = column.text[first + i];
            }
            table.add_text(column.name, std::move(cells));
        } else {
            std::vector<double> cells(table.rows(), std::nan(""));
            for (std::size_t i = 0; i < cells.size() && first + i < column.numbers.size(); ++i) {
                cells[i] = column.numbers[first + i];
            }
            table.add_numbers(column.name, column.unit, std::move(cells), column.written_unit);
        }
    }
}

void DesignTable::write(const fs::path& file, core::Table table) {
    check_unchanged(file);
    add_others(table, 0);
    table.comments = comments_;
    const core::ReplacingAllowed as_it_was_read;
    core::write_csv(file, table);
    file_ = file;
    seen_ = stamp_of(file);
    ours_ = true;
}

void DesignTable::append(const core::Table& rows) {
    check_unchanged(file_);
    core::Table whole = rows;
    add_others(whole, static_cast<std::size_t>(-1) / 2);  // beyond every row of the user's
    std::string text = core::write_csv(whole);
    text.erase(0, text.find('\n') + 1);
    const int file = ::open(file_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    const bool written = file >= 0 && ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    const int error = errno;
    if (written) {
        core::mark_as_own(file);
    } else if (file >= 0) {
        (void)!::ftruncate(file, static_cast<off_t>(seen_.size));  // no half row stays
    }
    if (file >= 0) {
        ::close(file);
    }
    if (!written) {
        throw core::SystemError("write", file_.string() + ": " + std::strerror(error));
    }
    seen_ = stamp_of(file_);
}

}  // namespace underbody::cases
