// Chunks of HDF5 data sets: how they lie in the file, and their values. Only for .cpp files: it brings the library's
// headers. The library itself unpacks one after the other, keeps a whole one in memory, and takes values out of it
// without a look at its end.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"

namespace underbody::postproc {

/// How the values of a data set are cut into chunks that can be unpacked here. With one dimension there is one column.
struct Hdf5ChunkLayout {
    hsize_t lengths[2] = {1, 1};
    hsize_t chunk[2] = {1, 1};
    std::size_t width = 1;  ///< bytes of a value
    std::vector<H5Z_filter_t>
        filters;  ///< in the order of writing: shuffled, deflated, with a check sum; none of them twice
    std::uint64_t stored_bytes = 0;  ///< of all chunks in the file
    bool edges_plain = false;        ///< chunks that reach beyond the data set are stored without filters
    bool last_cut = false;           ///< plain chunks, of which the last have no more rows than the data set

    [[nodiscard]] std::size_t row_bytes() const { return chunk[1] * width; }
    [[nodiscard]] std::size_t chunk_bytes() const { return chunk[0] * row_bytes(); }
    /// The bytes of those rows of the chunk at `row` that the data set has: some writers (Fluent Meshing) store no
    /// others.
    [[nodiscard]] std::size_t used_bytes(hsize_t row) const {
        return (row + chunk[0] > lengths[0] ? lengths[0] - row : chunk[0]) * row_bytes();
    }
};

/// Of a data set with one or two dimensions whose values lie in chunks; `refusal` says why they cannot be unpacked here
/// where the result is nothing.
std::optional<Hdf5ChunkLayout> layout_of_chunks(hid_t set, hid_t type, hid_t space, std::string& refusal);

/// A chunk as it lies in the file.
struct Hdf5Chunk {
    hsize_t row = 0, column = 0;  ///< of its first value
    bool deflated = true, shuffled = false;
    std::vector<unsigned char> bytes;
};

/// The bytes that a chunk has in the file; 0: it was never written.
hsize_t stored_size(hid_t set, const Hdf5Chunk& chunk);

/// Reads the bytes of the chunk at `row` and `column` of a file of so many bytes and takes away their check sum. Says
/// what is wrong with them; nothing: they are good.
std::string load_chunk(hid_t set, const Hdf5ChunkLayout& layout, std::uint64_t file_bytes, Hdf5Chunk& chunk);

/// Calls `take(first row, rows, values)` for the rows of a chunk up to `end` (of the data set), some at a time, as long
/// as it says true. At the end of the data set the chunk is unpacked to its own end, where its check sum is; it may end
/// with the last row of the data set. False: damaged.
bool unpack(const Hdf5ChunkLayout& layout, const Hdf5Chunk& chunk, hsize_t end, core::Progress& progress,
            const std::function<bool(hsize_t row, hsize_t rows, const unsigned char* stored)>& take);

}  // namespace underbody::postproc
