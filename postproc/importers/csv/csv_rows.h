// The bulk of a CSV file: rows of numbers and rows of indices, parsed once, straight to where they belong.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/progress.h"

namespace underbody::postproc {

using Index = long long;  ///< VTK's 64-bit integer, so that its arrays can be filled in place

/// Where the values of one column go: value * scale + offset is written to base[row * stride].
struct ColumnTarget {
    double* base = nullptr;  ///< nullptr: the column is skipped
    std::size_t stride = 1;
    double scale = 1;
    double offset = 0;
};

/// A row that cannot be read: where in the text, and why. The caller turns it into an error with line and column.
struct RowError {
    const char* at = nullptr;
    std::string message;
    std::string hint;
};

/// Upper bound for the number of rows in a block, from its line ends; chunk by chunk, so that threads know their place.
struct RowPlan {
    std::vector<std::string_view> chunks;  ///< cut at line ends
    std::vector<std::size_t> first;        ///< first row (upper bound) of each chunk, and the total at the end
    std::vector<std::size_t> first_entry;  ///< the same for separated entries (used for faces)
    [[nodiscard]] std::size_t capacity() const { return first.back(); }
    [[nodiscard]] std::size_t entries() const { return first_entry.back(); }
};
RowPlan plan_rows(std::string_view block, char separator, std::size_t columns, bool count_entries,
                  core::Progress& progress);

struct NumberRows {
    std::size_t rows = 0;
    std::vector<std::size_t> missing;        ///< per column: empty or "null" fields, stored as NaN
    std::vector<const char*> first_missing;  ///< where the first one stands
};

/// Reads all rows of a block into `targets` (room for plan.capacity() rows each); blank and '#' lines are skipped.
/// Deterministic whatever the number of threads. Throws RowError.
NumberRows parse_numbers(const RowPlan& plan, char separator, const std::vector<ColumnTarget>& targets,
                         core::Progress& progress);

struct IndexRows {
    std::size_t rows = 0;
    std::size_t entries = 0;
    Index smallest = 0;
    Index largest = -1;
    const char* largest_at = nullptr;
};

/// Reads rows of `least` or more whole numbers. `offsets` has room for capacity() + 1, `connectivity` for entries().
/// Throws RowError.
IndexRows parse_indices(const RowPlan& plan, char separator, std::size_t least, Index* offsets, Index* connectivity,
                        core::Progress& progress);

}  // namespace underbody::postproc
