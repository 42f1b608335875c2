#include "postproc/importers/csv/csv_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>

#include "core/parallel.h"
#include "postproc/importers/solver_number.h"

namespace underbody::postproc {

namespace {

// Small enough that two cores share evenly, large enough that the loop is all that counts.
constexpr std::size_t chunk_size = std::size_t{2} << 20;

// Of the number of a node: more would not fit into an Index.
constexpr std::ptrdiff_t most_digits = 15;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// A tab between columns is no blank.
const char* skip_blanks(const char* p, const char* end, char separator) {
    while (p < end && is_blank(*p) && *p != separator) {
        ++p;
    }
    return p;
}

const char* line_end(const char* p, const char* end) {
    const void* found = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
    return found == nullptr ? end : static_cast<const char*>(found);
}

std::size_t count_of(std::string_view text, char wanted) {
    // Bytes first, widened every 255 rounds: the compiler makes vector code of this.
    std::size_t total = 0;
    const char* p = text.data();
    std::size_t left = text.size();
    constexpr std::size_t lanes = 32;
    while (left >= lanes) {
        std::array<std::uint8_t, lanes> sums{};
        const std::size_t rounds = std::min<std::size_t>(255, left / lanes);
        for (std::size_t r = 0; r < rounds; ++r) {
            for (std::size_t i = 0; i < lanes; ++i) {
                sums[i] = static_cast<std::uint8_t>(sums[i] + (p[i] == wanted ? 1 : 0));
            }
            p += lanes;
        }
        left -= rounds * lanes;
        for (const auto s : sums) {
            total += s;
        }
    }
    return total + static_cast<std::size_t>(std::count(p, p + left, wanted));
}

/// The failure that stands first in the file wins, so that the message does not depend on the threads.
class FirstError {
public:
    void keep(const RowError& error) {
        const std::lock_guard lock(mutex_);
        if (found_.at == nullptr || error.at < found_.at) {
            found_ = error;
        }
    }
    void throw_if_any() const {
        if (found_.at != nullptr) {
            throw found_;  // NOLINT: a value, turned into an InputError by the caller
        }
    }

private:
    std::mutex mutex_;
    RowError found_;
};

std::string_view token_at(const char* p, const char* end, char separator) {
    const char* q = p;
    while (q < end && *q != separator && *q != '\n' && *q != '\r') {
        ++q;
    }
    while (q > p && is_blank(q[-1])) {
        --q;
    }
    return {p, static_cast<std::size_t>(q - p)};
}

bool same_word(std::string_view a, std::string_view b) {
    return a.size() == b.size() &&
           std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) { return (x | 0x20) == y; });
}

/// One chunk of rows of numbers.
class NumberChunk {
public:
    NumberChunk(std::string_view text, char separator, const std::vector<ColumnTarget>& targets, std::size_t first,
                std::size_t room)
        : p_(text.data()),
          end_(p_ + text.size()),
          separator_(separator),
          targets_(targets),
          row_(first),
          last_(first + room),
          first_(first) {
        result_.missing.assign(targets.size(), 0);
        result_.first_missing.assign(targets.size(), nullptr);
    }

    NumberRows run() {
        while (p_ < end_) {
            p_ = skip_blanks(p_, end_, separator_);
            if (p_ < end_ && *p_ != '\n') {
                if (*p_ == '#' || (*p_ == separator_ && only_separators())) {
                    p_ = line_end(p_, end_);
                } else {
                    read_row();
                }
            }
            ++p_;
        }
        result_.rows = row_ - first_;
        return result_;
    }

private:
    bool only_separators() const {
        const char* q = p_;
        while (q < end_ && (*q == separator_ || is_blank(*q))) {
            ++q;
        }
        // With one column a lone separator is no row either; otherwise it takes more than separators to be one.
        return q == end_ || *q == '\n';
    }

    void read_row() {
        if (row_ == last_) {
            throw RowError{p_, "more rows than lines", ""};  // cannot happen: every row ends with its line
        }
        const std::size_t columns = targets_.size();
        for (std::size_t c = 0; c < columns; ++c) {
            const ColumnTarget& target = targets_[c];
            p_ = skip_blanks(p_, end_, separator_);
            double value = 0;
            const char* next = p_ < end_ ? parse_number(p_, end_, value) : nullptr;
            if (next == nullptr || !(std::abs(value) <= std::numeric_limits<double>::max())) {
                next = odd_token(c, value);
            }
            p_ = skip_blanks(next, end_, separator_);
            if (target.base != nullptr) {
                target.base[row_ * target.stride] = value * target.scale + target.offset;
            }
            if (c + 1 < columns) {
                if (p_ == end_ || *p_ != separator_) {
                    too_short(c + 1);
                }
                ++p_;
            }
        }
        while (p_ < end_ && (*p_ == separator_ || is_blank(*p_))) {
            ++p_;
        }
        if (p_ < end_ && *p_ != '\n') {
            const bool glued = p_[-1] != separator_ && !is_blank(p_[-1]);
            throw RowError{p_,
                           glued ? "'" + std::string(token_at(p_, end_, separator_)) + "' behind a number"
                                 : "the row has more values than the header names (" + std::to_string(columns) + ")",
                           ""};
        }
        ++row_;
    }

    /// What is no plain number: nothing, "null", or an error.
    const char* odd_token(std::size_t column, double& value) {
        const std::string_view token = token_at(p_, end_, separator_);
        if (token.empty() && (p_ == end_ || *p_ != separator_) && column > 0 && column + 1 < targets_.size()) {
            too_short(column);
        }
        if (token.empty() || same_word(token, "null")) {
            value = std::numeric_limits<double>::quiet_NaN();
            if (result_.missing[column]++ == 0) {
                result_.first_missing[column] = p_;
            }
            return p_ + token.size();
        }
        if (same_word(token, "nan") || same_word(token, "inf") || same_word(token, "-inf") ||
            same_word(token, "+inf") || same_word(token, "-nan") || same_word(token, "infinity") ||
            same_word(token, "-infinity")) {
            throw RowError{p_, "'" + std::string(token) + "' is not a finite number",
                           "the solution has diverged there, or the variable is not defined on this surface"};
        }
        throw RowError{p_, "'" + std::string(token.substr(0, 40)) + "' is not a number", ""};
    }

    [[noreturn]] void too_short(std::size_t values) const {
        const bool at_end = p_ >= end_;
        if (!at_end && *p_ != '\n') {
            throw RowError{p_, "'" + std::string(token_at(p_, end_, separator_).substr(0, 40)) + "' behind a number",
                           ""};
        }
        throw RowError{p_,
                       "the row has " + std::to_string(values) + " values, the header names " +
                           std::to_string(targets_.size()) + (at_end ? ": the file ends in the middle of a row" : ""),
                       at_end ? "the file is cut short: export it again" : ""};
    }

    const char* p_;
    const char* end_;
    char separator_;
    const std::vector<ColumnTarget>& targets_;
    std::size_t row_;
    std::size_t last_;
    std::size_t first_;
    NumberRows result_;
};

/// Node numbers of one row from `p` on, behind which it then stands; how many there are.
std::size_t index_row(const char*& p, const char* end, char separator, IndexRows& result, Index* connectivity) {
    std::size_t count = 0;
    while (true) {
        Index value = 0;
        const char* start = p;
        while (p < end && p - start <= most_digits && static_cast<unsigned char>(*p - '0') < 10) {
            value = value * 10 + (*p++ - '0');
        }
        if (p == start || p - start > most_digits) {
            throw RowError{start,
                           "'" + std::string(token_at(start, end, separator).substr(0, 40)) + "' is not a node number",
                           "faces name their nodes by whole numbers from 0"};
        }
        connectivity[result.entries++] = value;
        ++count;
        result.smallest = std::min(result.smallest, value);
        if (value > result.largest) {
            result.largest = value;
            result.largest_at = start;
        }
        const char* after = p;
        p = skip_blanks(p, end, separator);
        // Spreadsheets fill short rows with separators.
        bool separated = false;
        while (p < end && *p == separator) {
            separated = true;
            p = skip_blanks(p + 1, end, separator);
        }
        if (p == end || *p == '\n') {
            break;
        }
        if (!separated) {
            throw RowError{after,
                           "'" + std::string(token_at(p, end, separator).substr(0, 40)) + "' behind a node number", ""};
        }
    }
    return count;
}

/// One chunk of rows of indices.
IndexRows index_chunk(std::string_view text, char separator, std::size_t least, Index* lengths, Index* connectivity,
                      std::size_t room) {
    IndexRows result;
    result.smallest = std::numeric_limits<Index>::max();
    const char* p = text.data();
    const char* end = p + text.size();
    while (p < end) {
        p = skip_blanks(p, end, separator);
        if (p == end || *p == '\n') {
            ++p;
            continue;
        }
        const char* behind = p;  // a row of nothing but separators is a blank line of a spreadsheet
        while (behind < end && (*behind == separator || is_blank(*behind))) {
            ++behind;
        }
        if (*p == '#' || behind == end || *behind == '\n') {
            p = line_end(behind, end) + 1;
            continue;
        }
        const char* row_start = p;
        const std::size_t count = index_row(p, end, separator, result, connectivity);
        if (count < least) {
            throw RowError{row_start,
                           "a row of " + std::to_string(count) + " node numbers where at least " +
                               std::to_string(least) + " are needed",
                           ""};
        }
        if (result.rows == room) {
            throw RowError{row_start, "more rows than lines", ""};
        }
        lengths[result.rows++] = static_cast<Index>(count);
        ++p;
    }
    return result;
}

}  // namespace

RowPlan plan_rows(std::string_view block, char separator, std::size_t columns, bool count_entries,
                  core::Progress& progress) {
    RowPlan plan;
    std::size_t begin = 0;
    while (begin < block.size()) {
        std::size_t end = std::min(block.size(), begin + chunk_size);
        if (end < block.size()) {
            end = static_cast<std::size_t>(line_end(block.data() + end, block.data() + block.size()) - block.data());
            end = std::min(block.size(), end + 1);
        }
        plan.chunks.push_back(block.substr(begin, end - begin));
        begin = end;
    }
    std::vector<std::size_t> rows(plan.chunks.size());
    std::vector<std::size_t> entries(plan.chunks.size());
    core::parallel_for(
        plan.chunks.size(),
        [&](std::size_t i) {
            const std::string_view chunk = plan.chunks[i];
            // Blank lines are no reason to ask for memory: a row takes at least a byte a column.
            rows[i] = std::min(count_of(chunk, '\n') + 1, chunk.size() / std::max<std::size_t>(1, columns) + 1);
            entries[i] = count_entries ? rows[i] + count_of(chunk, separator) : 0;
        },
        progress);
    plan.first = {0};
    plan.first_entry = {0};
    for (std::size_t i = 0; i < plan.chunks.size(); ++i) {
        plan.first.push_back(plan.first.back() + rows[i]);
        plan.first_entry.push_back(plan.first_entry.back() + entries[i]);
    }
    return plan;
}

NumberRows parse_numbers(const RowPlan& plan, char separator, const std::vector<ColumnTarget>& targets,
                         core::Progress& progress) {
    std::vector<NumberRows> parts(plan.chunks.size());
    FirstError error;
    core::parallel_for(
        plan.chunks.size(),
        [&](std::size_t i) {
            try {
                parts[i] =
                    NumberChunk(plan.chunks[i], separator, targets, plan.first[i], plan.first[i + 1] - plan.first[i])
                        .run();
            } catch (const RowError& found) {
                error.keep(found);
            }
        },
        progress);
    error.throw_if_any();
    NumberRows all;
    all.missing.assign(targets.size(), 0);
    all.first_missing.assign(targets.size(), nullptr);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (all.rows != plan.first[i]) {  // close the gaps that blank lines left
            for (const auto& target : targets) {
                for (std::size_t r = 0; target.base != nullptr && r < parts[i].rows; ++r) {
                    target.base[(all.rows + r) * target.stride] = target.base[(plan.first[i] + r) * target.stride];
                }
            }
        }
        all.rows += parts[i].rows;
        for (std::size_t c = 0; c < targets.size(); ++c) {
            if (all.missing[c] == 0) {
                all.first_missing[c] = parts[i].first_missing[c];
            }
            all.missing[c] += parts[i].missing[c];
        }
    }
    return all;
}

IndexRows parse_indices(const RowPlan& plan, char separator, std::size_t least, Index* offsets, Index* connectivity,
                        core::Progress& progress) {
    std::vector<IndexRows> parts(plan.chunks.size());
    FirstError error;
    core::parallel_for(
        plan.chunks.size(),
        [&](std::size_t i) {
            try {
                parts[i] = index_chunk(plan.chunks[i], separator, least, offsets + 1 + plan.first[i],
                                       connectivity + plan.first_entry[i], plan.first[i + 1] - plan.first[i]);
            } catch (const RowError& found) {
                error.keep(found);
            }
        },
        progress);
    error.throw_if_any();
    IndexRows all;
    all.smallest = std::numeric_limits<Index>::max();
    offsets[0] = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        std::memmove(connectivity + all.entries, connectivity + plan.first_entry[i], parts[i].entries * sizeof(Index));
        for (std::size_t r = 0; r < parts[i].rows; ++r) {  // lengths become offsets
            offsets[all.rows + r + 1] = offsets[all.rows + r] + offsets[1 + plan.first[i] + r];
        }
        all.rows += parts[i].rows;
        all.entries += parts[i].entries;
        all.smallest = std::min(all.smallest, parts[i].smallest);
        if (parts[i].largest > all.largest) {
            all.largest = parts[i].largest;
            all.largest_at = parts[i].largest_at;
        }
    }
    return all;
}

}  // namespace underbody::postproc
