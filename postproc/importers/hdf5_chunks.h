// Deflated chunks of HDF5 data sets: how they lie in the file, and their values. Only for .cpp files: it brings the
// library's headers. The library itself inflates one after the other, and keeps a whole one in memory.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "core/progress.h"

namespace underbody::postproc {

/// How the values of a data set are cut into chunks that can be unpacked here. With one dimension there is one column.
struct Hdf5ChunkLayout {
    hsize_t lengths[2] = {1, 1};
    hsize_t chunk[2] = {1, 1};
    int rank = 1;
    std::size_t width = 1;  ///< bytes of a value
    std::size_t wanted_width = 1;
    /// Numbers as the file has them into numbers as they are wanted.
    void (*convert)(const unsigned char* stored, std::size_t count, void* out) = nullptr;
    std::vector<H5Z_filter_t> filters;  ///< in the order of writing

    [[nodiscard]] std::size_t row_bytes() const { return chunk[1] * width; }
    [[nodiscard]] std::size_t chunk_bytes() const { return chunk[0] * row_bytes(); }
};

/// Of a data set that is deflated, shuffled before or not, for its values as whole numbers of 32 bits (`whole`) or as
/// reals; nothing for all others: they are the library's.
std::optional<Hdf5ChunkLayout> layout_of_chunks(hid_t set, hid_t type, hid_t space, bool whole);

/// A chunk as it lies in the file.
struct Hdf5Chunk {
    hsize_t row = 0, column = 0;  ///< of its first value
    bool deflated = true, shuffled = false;
    std::vector<unsigned char> bytes;
};

/// Calls `take(first row, rows, values)` for the rows of a chunk up to `end` (of the data set), some at a time, as long as
/// it says true. At the end of the data set the chunk is unpacked to its own end, where its check sum is. False: damaged.
bool unpack(const Hdf5ChunkLayout& layout, const Hdf5Chunk& chunk, hsize_t end, core::Progress& progress,
            const std::function<bool(hsize_t row, hsize_t rows, const unsigned char* stored)>& take);

}  // namespace underbody::postproc
