#include "postproc/importers/hdf5_chunks.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <type_traits>
#include <utility>

#include "postproc/importers/hdf5_handle.h"

namespace underbody::postproc {

namespace {

using Convert = decltype(Hdf5ChunkLayout::convert);

template <typename Stored, typename Wanted>
Wanted as(Stored value) {
    if constexpr (std::is_same_v<Wanted, std::uint32_t> && sizeof(Stored) > sizeof(Wanted)) {
        constexpr Stored most = std::numeric_limits<Wanted>::max();
        return static_cast<Wanted>(std::clamp<Stored>(value, 0, most));
    } else {
        return static_cast<Wanted>(value);
    }
}

template <typename Stored, typename Wanted>
void convert(const unsigned char* stored, std::size_t count, void* out) {
    auto* wanted = static_cast<Wanted*>(out);
    for (std::size_t i = 0; i < count; ++i) {
        Stored value;
        std::memcpy(&value, stored + i * sizeof(Stored), sizeof(Stored));
        wanted[i] = as<Stored, Wanted>(value);
    }
}

template <typename Wanted>
Convert convert_to(hid_t type) {
    const std::pair<hid_t, Convert> known[] = {
        {H5T_IEEE_F64LE, convert<double, Wanted>},      {H5T_STD_U32LE, convert<std::uint32_t, Wanted>}, {H5T_STD_I32LE, convert<std::int32_t, Wanted>},
        {H5T_IEEE_F32LE, convert<float, Wanted>},       {H5T_STD_I16LE, convert<std::int16_t, Wanted>},  {H5T_STD_U16LE, convert<std::uint16_t, Wanted>},
        {H5T_STD_I64LE, convert<std::int64_t, Wanted>}, {H5T_STD_U64LE, convert<std::uint64_t, Wanted>}, {H5T_STD_I8LE, convert<std::int8_t, Wanted>},
        {H5T_STD_U8LE, convert<std::uint8_t, Wanted>}};
    for (const auto& [stored, conversion] : known) {
        if (H5Tequal(stored, type) > 0) {
            return conversion;
        }
    }
    return nullptr;
}

/// The values of a chunk, handed out in order.
class ChunkValues {
public:
    ChunkValues(const Hdf5ChunkLayout& layout, const Hdf5Chunk& chunk) : chunk_(chunk), size_(layout.chunk_bytes()) {
        if (chunk.deflated && ::inflateInit(&zip_) != Z_OK) {
            throw std::bad_alloc();
        }
        initialised_ = chunk.deflated;
        zip_.next_in = const_cast<unsigned char*>(chunk.bytes.data());
        zip_.avail_in = static_cast<unsigned>(chunk.bytes.size());
        // What is shuffled has the first bytes of all values first: it is inflated as a whole.
        constexpr std::size_t most_inflated = 1032;
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

    /// The next `bytes` bytes, there until the next call; null: the chunk is damaged.
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
    bool whole() { return sound_ && (!chunk_.deflated || at_ < size_ || ended_ || ::inflate(&zip_, Z_FINISH) == Z_STREAM_END); }

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
        sound_ = zip_.avail_out == 0 && (result == Z_OK || ended_);
        return sound_ ? window_.data() : nullptr;
    }
    void unshuffle(std::size_t width) {
        const unsigned char* planes = stored(size_);
        if (planes == nullptr) {
            return;
        }
        const std::size_t count = size_ / width;
        values_.resize(size_);
        for (std::size_t byte = 0; byte < width; ++byte) {
            for (std::size_t i = 0; i < count; ++i) {
                values_[i * width + byte] = planes[byte * count + i];
            }
        }
        window_ = {};
    }

    const Hdf5Chunk& chunk_;
    std::size_t size_;
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

std::optional<Hdf5ChunkLayout> layout_of_chunks(hid_t set, hid_t type, hid_t space, bool whole) {
    const Hdf5Handle properties(H5Dget_create_plist(set), H5Pclose);
    Hdf5ChunkLayout layout;
    layout.rank = H5Sget_simple_extent_ndims(space);
    unsigned options = 0;
    if (std::endian::native != std::endian::little || !properties.good() || H5Pget_layout(properties.get()) != H5D_CHUNKED || layout.rank < 1 ||
        layout.rank > 2 || H5Pget_chunk(properties.get(), layout.rank, layout.chunk) != layout.rank ||
        H5Sget_simple_extent_dims(space, layout.lengths, nullptr) < 0 || H5Pget_chunk_opts(properties.get(), &options) < 0 || options != 0) {
        return {};
    }
    layout.width = H5Tget_size(type);
    layout.wanted_width = whole ? sizeof(std::uint32_t) : sizeof(double);
    layout.convert = whole ? convert_to<std::uint32_t>(type) : convert_to<double>(type);
    constexpr hsize_t widest = 65536;
    constexpr hsize_t largest = hsize_t{1} << 32;
    if (layout.convert == nullptr || layout.chunk[0] == 0 || layout.chunk[1] == 0 || layout.chunk[1] > widest ||
        layout.chunk[0] > largest / layout.row_bytes()) {
        return {};
    }
    const int filters = H5Pget_nfilters(properties.get());
    for (int i = 0; i < filters; ++i) {
        unsigned flags = 0;
        unsigned parameters[8] = {};
        std::size_t count = 8;
        const H5Z_filter_t filter = H5Pget_filter2(properties.get(), static_cast<unsigned>(i), &flags, &count, parameters, 0, nullptr, nullptr);
        const bool deflate = filter == H5Z_FILTER_DEFLATE && i + 1 == filters;
        const bool shuffle = filter == H5Z_FILTER_SHUFFLE && i == 0 && count == 1 && parameters[0] == layout.width;
        if (!deflate && !shuffle) {
            return {};
        }
        layout.filters.push_back(filter);
    }
    if (layout.filters.empty() || layout.filters.back() != H5Z_FILTER_DEFLATE) {
        return {};
    }
    return layout;
}

bool unpack(const Hdf5ChunkLayout& layout, const Hdf5Chunk& chunk, hsize_t end, core::Progress& progress,
            const std::function<bool(hsize_t row, hsize_t rows, const unsigned char* stored)>& take) {
    constexpr std::size_t window = std::size_t{1} << 18;  // stays near the processor
    const hsize_t at_once = std::max<hsize_t>(1, window / layout.row_bytes());
    const hsize_t last = end == layout.lengths[0] ? layout.chunk[0] : end - chunk.row;
    ChunkValues values(layout, chunk);
    for (hsize_t row = 0; row < last; row += at_once) {
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
