#include "postproc/importers/hdf5/hdf5_chunks.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <new>

#include "postproc/importers/hdf5/hdf5_handle.h"
#include "postproc/importers/mesh/buffer.h"

namespace underbody::postproc {

namespace {

/// The values of a chunk, handed out in order.
class ChunkValues {
public:
    ChunkValues(const Hdf5ChunkLayout& layout, const Hdf5Chunk& chunk)
        : chunk_(chunk), size_(layout.chunk_bytes()), used_(layout.used_bytes(chunk.row)) {
        if (chunk.deflated && ::inflateInit(&zip_) != Z_OK) {
            throw std::bad_alloc();
        }
        initialised_ = chunk.deflated;
        zip_.next_in = const_cast<unsigned char*>(chunk.bytes.data());
        zip_.avail_in = static_cast<unsigned>(chunk.bytes.size());
        // What is shuffled has the first bytes of all values first: it is inflated as a whole.
        constexpr std::size_t most_inflated = 1032;
        const bool as_whole =
            chunk.deflated ? size_ / most_inflated <= chunk.bytes.size() : size_ == chunk.bytes.size();
        size_ = as_whole ? size_ : used_;
        sound_ = chunk.deflated ? size_ / most_inflated <= chunk.bytes.size() : size_ == chunk.bytes.size();
        if (sound_ && chunk.shuffled) {
            unshuffle(layout.width);
        }
    }
    ~ChunkValues() {
        if (initialised_) {
            ::inflateEnd(&zip_);
        }
    }
    ChunkValues(const ChunkValues&) = delete;
    ChunkValues& operator=(const ChunkValues&) = delete;

    /// How many bytes there are, as far as is known: a chunk that is inflated may turn out to have its used rows only.
    [[nodiscard]] std::size_t size() const { return size_; }
    /// The next `bytes` bytes, there until the next call (behind `size` nothing of use); null: the chunk is damaged.
    const unsigned char* next(std::size_t bytes) {
        if (!sound_) {
            return nullptr;
        }
        const std::size_t from = at_;
        at_ += bytes;
        if (chunk_.shuffled) {
            return values_.data() + from;
        }
        return stored(bytes);
    }
    /// Did all that was handed out pass the check sum at the end?
    bool whole() {
        return sound_ && (!chunk_.deflated || at_ < size_ || ended_ || ::inflate(&zip_, Z_FINISH) == Z_STREAM_END);
    }

private:
    const unsigned char* stored(std::size_t bytes) {
        if (!chunk_.deflated) {
            const unsigned char* from = chunk_.bytes.data() + taken_;
            taken_ += bytes;
            return from;
        }
        window_.resize(bytes);
        zip_.next_out = window_.data();
        zip_.avail_out = static_cast<unsigned>(bytes);
        const int result = ::inflate(&zip_, Z_SYNC_FLUSH);
        ended_ = result == Z_STREAM_END;
        if (ended_ && zip_.total_out == used_) {
            size_ = used_;
            return window_.data();
        }
        sound_ = zip_.avail_out == 0 && (result == Z_OK || ended_);
        return sound_ ? window_.data() : nullptr;
    }
    void unshuffle(std::size_t width) {
        const unsigned char* planes = stored(size_);
        if (planes == nullptr) {
            return;
        }
        const std::size_t count = size_ / width;
        values_.resize(count * width);
        for (std::size_t byte = 0; byte < width; ++byte) {
            for (std::size_t i = 0; i < count; ++i) {
                values_[i * width + byte] = planes[byte * count + i];
            }
        }
        window_ = {};
    }

    const Hdf5Chunk& chunk_;
    std::size_t size_;
    std::size_t used_;  ///< of the rows that the data set has
    std::size_t at_ = 0;
    std::size_t taken_ = 0;
    z_stream zip_{};
    bool initialised_ = false;
    bool sound_ = true;
    bool ended_ = false;
    std::vector<unsigned char> window_;
    std::vector<unsigned char> values_;
};

}  // namespace

namespace {

/// Fills in the filters; false if others were used, or these in another order.
bool take_filters(hid_t properties, Hdf5ChunkLayout& layout) {
    const int filters = H5Pget_nfilters(properties);
    constexpr H5Z_filter_t order[] = {H5Z_FILTER_SHUFFLE, H5Z_FILTER_DEFLATE, H5Z_FILTER_FLETCHER32};
    const H5Z_filter_t* next = order;
    for (int i = 0; i < filters; ++i) {
        unsigned flags = 0;
        unsigned parameters[8] = {};
        std::size_t count = 8;
        const H5Z_filter_t filter =
            H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &count, parameters, 0, nullptr, nullptr);
        next = std::find(next, std::end(order), filter);
        if (next == std::end(order) ||
            (filter == H5Z_FILTER_SHUFFLE && (count != 1 || parameters[0] != layout.width))) {
            return false;
        }
        ++next;
        layout.filters.push_back(filter);
    }
    return filters >= 0;
}

}  // namespace

namespace {

/// The first row of the last chunks.
hsize_t last_chunk_row(const Hdf5ChunkLayout& layout) {
    return layout.lengths[0] == 0 ? 0 : (layout.lengths[0] - 1) / layout.chunk[0] * layout.chunk[0];
}

/// Do the bytes of plain chunks add up where the last ones have no more rows than the data set?
bool ends_cut(const Hdf5ChunkLayout& layout, hsize_t chunks) {
    const hsize_t last_chunks = (layout.lengths[1] + layout.chunk[1] - 1) / layout.chunk[1];
    const std::uint64_t spare = (layout.chunk_bytes() - layout.used_bytes(last_chunk_row(layout))) * last_chunks;
    return layout.stored_bytes + spare == chunks * layout.chunk_bytes();
}

}  // namespace

std::optional<Hdf5ChunkLayout> layout_of_chunks(hid_t set, hid_t type, hid_t space, std::string& refusal) {
    const Hdf5Handle properties(H5Dget_create_plist(set), H5Pclose);
    Hdf5ChunkLayout layout;
    const int rank = H5Sget_simple_extent_ndims(space);
    unsigned options = 0;
    if (!properties.good() || rank < 1 || rank > 2 || H5Pget_chunk(properties.get(), rank, layout.chunk) != rank ||
        H5Sget_simple_extent_dims(space, layout.lengths, nullptr) < 0 ||
        H5Pget_chunk_opts(properties.get(), &options) < 0 ||
        (options & ~static_cast<unsigned>(H5D_CHUNK_DONT_FILTER_PARTIAL_CHUNKS)) != 0) {
        refusal = "how its chunks lie in the file is not understood";
        return {};
    }
    layout.edges_plain = options != 0;
    layout.width = H5Tget_size(type);
    constexpr hsize_t widest = 65536;
    constexpr hsize_t largest = (hsize_t{1} << 32) - 1;
    if (layout.width == 0 || layout.width > widest || layout.chunk[0] == 0 || layout.chunk[1] == 0 ||
        layout.chunk[1] > widest || layout.chunk[0] > largest / layout.row_bytes()) {
        refusal = "its chunks of " + std::to_string(layout.chunk[0]) + " x " + std::to_string(layout.chunk[1]) +
                  " values of " + std::to_string(layout.width) + " bytes are too large";
        return {};
    }
    if (!take_filters(properties.get(), layout)) {
        refusal = "its chunks are packed in another way than deflated (write the file anew: h5repack -f GZIP=1)";
        return {};
    }
    hsize_t chunks = 0;
    layout.stored_bytes = H5Dget_storage_size(set);
    // Of what is not packed the library says the size that a chunk should have, and reads as much as the file has.
    const bool counted = layout.filters.empty() && H5Dget_num_chunks(set, space, &chunks) >= 0;
    layout.last_cut = counted && layout.stored_bytes != chunks * layout.chunk_bytes() && ends_cut(layout, chunks);
    if (layout.filters.empty() &&
        (!counted || (layout.stored_bytes != chunks * layout.chunk_bytes() && !layout.last_cut))) {
        refusal = "its " + std::to_string(chunks) + " chunks have " + std::to_string(layout.stored_bytes) +
                  " bytes, which are not " + std::to_string(layout.chunk[0] * layout.chunk[1]) + " values each";
        return {};
    }
    return layout;
}

namespace {

/// Does the check sum (Fletcher's of 32 bits, in the last four bytes) agree with the others? Takes it away.
bool take_check_sum(std::vector<unsigned char>& bytes) {
    constexpr std::size_t width = 4;
    constexpr std::uint64_t modulus = 65535;
    if (bytes.size() < width) {
        return false;
    }
    const unsigned char* sum = bytes.data() + bytes.size() - width;
    const std::uint64_t stated[2] = {sum[0] + 256U * sum[1], sum[2] + 256U * sum[3]};
    const std::size_t size = bytes.size() - width;
    // The sum of all words of two bytes, and the sum of these sums (RFC 1146); 0 and 65535 are the same there.
    std::uint64_t plain = 0;
    std::uint64_t summed = 0;
    for (std::size_t i = 0; i < size; i += 2) {
        plain = (plain + 256U * bytes[i] + (i + 1 < size ? bytes[i + 1] : 0U)) % modulus;
        summed = (summed + plain) % modulus;
    }
    bytes.resize(size);
    return stated[0] % modulus == plain && stated[1] % modulus == summed;
}

}  // namespace

hsize_t stored_size(hid_t set, const Hdf5Chunk& chunk) {
    const hsize_t offset[2] = {chunk.row, chunk.column};
    hsize_t size = 0;
    return H5Dget_chunk_storage_size(set, offset, &size) < 0 ? 0 : size;
}

std::string load_chunk(hid_t set, const Hdf5ChunkLayout& layout, std::uint64_t file_bytes, Hdf5Chunk& chunk) {
    const hsize_t size = stored_size(set, chunk);
    const hsize_t offset[2] = {chunk.row, chunk.column};
    std::uint32_t skipped = 0;
    const bool plain = layout.filters.empty();
    if (size == 0 || size > file_bytes ||
        (plain && (size != layout.chunk_bytes() || layout.stored_bytes > file_bytes))) {
        return "its values cannot be read";
    }
    // A plain chunk may have other bytes in the file than it should, but no more than all have together. Of one that is
    // cut the library states the full size all the same.
    Buffer<unsigned char> room(plain ? std::max<std::uint64_t>(size, layout.stored_bytes) : 0);
    std::fill_n(room.data(), plain ? size : 0, static_cast<unsigned char>(0));
    chunk.bytes.resize(plain ? 0 : size);
    if (H5Dread_chunk(set, H5P_DEFAULT, offset, &skipped, plain ? room.data() : chunk.bytes.data()) < 0) {
        return "its values cannot be read";
    }
    if (plain) {
        const bool cut = layout.last_cut && chunk.row == last_chunk_row(layout);
        chunk.bytes.assign(room.data(), room.data() + (cut ? layout.used_bytes(chunk.row) : size));
    }
    if (layout.edges_plain &&
        (chunk.row + layout.chunk[0] > layout.lengths[0] || chunk.column + layout.chunk[1] > layout.lengths[1])) {
        chunk.deflated = chunk.shuffled = false;
        return {};
    }
    const auto used = [&](H5Z_filter_t filter) {
        const auto found = std::find(layout.filters.begin(), layout.filters.end(), filter);
        return found != layout.filters.end() && (skipped >> (found - layout.filters.begin()) & 1U) == 0;
    };
    chunk.deflated = used(H5Z_FILTER_DEFLATE);
    chunk.shuffled = used(H5Z_FILTER_SHUFFLE);
    if (used(H5Z_FILTER_FLETCHER32) && !take_check_sum(chunk.bytes)) {
        return "the check sum of row " + std::to_string(chunk.row) + " and those behind it is wrong";
    }
    return {};
}

bool unpack(const Hdf5ChunkLayout& layout, const Hdf5Chunk& chunk, hsize_t end, core::Progress& progress,
            const std::function<bool(hsize_t row, hsize_t rows, const unsigned char* stored)>& take) {
    constexpr std::size_t window = std::size_t{1} << 18;  // stays near the processor
    const hsize_t at_once = std::max<hsize_t>(1, window / layout.row_bytes());
    ChunkValues values(layout, chunk);
    const hsize_t last = end == layout.lengths[0] ? values.size() / layout.row_bytes() : end - chunk.row;
    for (hsize_t row = 0; row < last && row * layout.row_bytes() < values.size(); row += at_once) {
        progress.check();
        const hsize_t some = std::min(at_once, last - row);
        const unsigned char* stored = values.next(some * layout.row_bytes());
        if (stored == nullptr) {
            return false;
        }
        if (chunk.row + row < end && !take(chunk.row + row, std::min(some, end - chunk.row - row), stored)) {
            return true;
        }
    }
    return values.whole();
}

}  // namespace underbody::postproc
