#include "postproc/importers/hdf5_rows.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>

#include "core/parallel.h"
#include "postproc/importers/hdf5_handle.h"

namespace underbody::postproc {

namespace {

/// Numbers as the file has them into numbers as they are wanted.
using Convert = void (*)(const unsigned char* stored, std::size_t count, void* out);

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

/// How the values of a data set are cut into chunks that can be unpacked here. With one dimension there is one column.
struct ChunkLayout {
    hsize_t lengths[2] = {1, 1};
    hsize_t chunk[2] = {1, 1};
    int rank = 1;
    std::size_t width = 1;  ///< bytes of a value
    std::size_t wanted_width = 1;
    Convert convert = nullptr;
    std::vector<H5Z_filter_t> filters;  ///< in the order of writing

    [[nodiscard]] std::size_t row_bytes() const { return chunk[1] * width; }
    [[nodiscard]] std::size_t chunk_bytes() const { return chunk[0] * row_bytes(); }
};

/// Of a data set that is deflated, shuffled before or not; nothing for all others: they are the library's.
std::optional<ChunkLayout> layout_of(hid_t set, hid_t type, hid_t space, bool whole) {
    const Hdf5Handle properties(H5Dget_create_plist(set), H5Pclose);
    ChunkLayout layout;
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

/// A chunk as it lies in the file.
struct Chunk {
    hsize_t row = 0, column = 0;  ///< of its first value
    bool deflated = true, shuffled = false;
    std::vector<unsigned char> bytes;
};

/// The values of a chunk, handed out in order.
class ChunkValues {
public:
    ChunkValues(const ChunkLayout& layout, const Chunk& chunk) : chunk_(chunk), size_(layout.chunk_bytes()) {
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

    const Chunk& chunk_;
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

/// Calls `take(first row, rows, values)` for the rows of a chunk up to `end` (of the data set), some at a time, as
/// long as it says true. At the end of the data set the chunk is unpacked to its own end, where its
/// check sum is. False: damaged.
template <typename Take>
bool unpack(const ChunkLayout& layout, const Chunk& chunk, hsize_t end, core::Progress& progress, Take&& take) {
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

/// Gives the rows that begin at `row` to whom they belong.
void distribute(const ChunkLayout& layout, const Chunk& chunk, const std::vector<Hdf5Rows::Share>& shares, hsize_t row, hsize_t rows,
                const unsigned char* stored) {
    const hsize_t columns = std::min(layout.chunk[1], layout.lengths[1] - chunk.column);
    for (const auto& share : shares) {
        const hsize_t from = std::max<hsize_t>(row, share.first);
        const hsize_t to = std::min<hsize_t>(row + rows, share.first + share.rows);
        if (from >= to) {
            continue;
        }
        auto* out = static_cast<unsigned char*>(share.out) + ((from - share.first) * layout.lengths[1] + chunk.column) * layout.wanted_width;
        const unsigned char* in = stored + (from - row) * layout.row_bytes();
        if (layout.chunk[1] == layout.lengths[1]) {
            layout.convert(in, (to - from) * columns, out);
            continue;
        }
        for (hsize_t i = from; i < to; ++i) {
            layout.convert(in, columns, out);
            in += layout.row_bytes();
            out += layout.lengths[1] * layout.wanted_width;
        }
    }
}

/// Behind the last row that somebody wants of those from `begin` to `end`; `begin`: nobody wants any.
hsize_t end_of_wanted(const std::vector<Hdf5Rows::Share>& shares, hsize_t begin, hsize_t end) {
    hsize_t last = begin;
    for (const auto& share : shares) {
        if (share.first < end && share.first + share.rows > begin) {
            last = std::max(last, std::min<hsize_t>(end, share.first + share.rows));
        }
    }
    return last;
}

/// A data set of numbers, opened.
class DataSet {
public:
    DataSet(const Hdf5File& file, const std::string& path, bool whole);

    [[nodiscard]] const std::optional<ChunkLayout>& layout() const { return layout_; }
    [[nodiscard]] hsize_t rows() const { return lengths_[0]; }
    [[nodiscard]] hsize_t columns() const { return lengths_[1]; }
    void check_rows(std::uint64_t first, std::uint64_t rows) const;
    /// By the library.
    void read(const Hdf5Rows::Share& share) const;
    /// The chunks of which `shares` want something; nothing if not all of them are in the file.
    [[nodiscard]] std::optional<std::vector<Chunk>> chunks(const std::vector<Hdf5Rows::Share>& shares) const;
    void load(Chunk& chunk) const;
    [[noreturn]] void damaged() const { file_.fail(path_, "its values cannot be read"); }

private:
    [[nodiscard]] hsize_t size_of(const Chunk& chunk) const;

    const Hdf5File& file_;
    std::string path_;
    bool whole_;
    Hdf5Handle set_;
    Hdf5Handle type_;
    Hdf5Handle space_;
    int rank_ = 0;
    hsize_t lengths_[2] = {1, 1};
    std::optional<ChunkLayout> layout_;
};

DataSet::DataSet(const Hdf5File& file, const std::string& path, bool whole)
    : file_(file),
      path_(path),
      whole_(whole),
      set_(file.has(path) ? H5Dopen2(file.id(), path.c_str(), H5P_DEFAULT) : -1, H5Dclose),
      type_(set_.good() ? H5Dget_type(set_.get()) : -1, H5Tclose),
      space_(set_.good() ? H5Dget_space(set_.get()) : -1, H5Sclose) {
    if (!set_.good()) {
        file_.fail(path_, "there is no such data set");
    }
    const H5T_class_t kind = H5Tget_class(type_.get());
    if (kind != H5T_INTEGER && (whole_ || kind != H5T_FLOAT)) {
        file_.fail(path_, whole_ ? "its values are not whole numbers" : "its values are not numbers");
    }
    (void)file_.backed_size(set_.get(), path_);
    rank_ = H5Sget_simple_extent_ndims(space_.get());
    if (rank_ >= 1 && rank_ <= 2 && H5Sget_simple_extent_dims(space_.get(), lengths_, nullptr) >= 0) {
        layout_ = layout_of(set_.get(), type_.get(), space_.get(), whole_);
    } else {
        rank_ = 0;
    }
}

void DataSet::check_rows(std::uint64_t first, std::uint64_t rows) const {
    if (rank_ == 0 || first > lengths_[0] || rows > lengths_[0] - first) {
        file_.fail(path_, "it has no rows " + std::to_string(first) + " to " + std::to_string(first + rows));
    }
}

void DataSet::read(const Hdf5Rows::Share& share) const {
    if (share.rows == 0 || lengths_[1] == 0) {
        return;
    }
    const hsize_t from[2] = {share.first, 0};
    const hsize_t count[2] = {share.rows, lengths_[1]};
    const Hdf5Handle target(H5Screate_simple(rank_, count, nullptr), H5Sclose);
    // Negative numbers of up to 4 bytes stay what they are, bit by bit; wider ones are cut by the library.
    const bool narrow_and_signed = H5Tget_sign(type_.get()) == H5T_SGN_2 && H5Tget_size(type_.get()) <= 4;
    const hid_t wanted = !whole_ ? H5T_NATIVE_DOUBLE : narrow_and_signed ? H5T_NATIVE_INT32 : H5T_NATIVE_UINT32;
    if (H5Sselect_hyperslab(space_.get(), H5S_SELECT_SET, from, nullptr, count, nullptr) < 0 ||
        H5Dread(set_.get(), wanted, target.get(), space_.get(), H5P_DEFAULT, share.out) < 0) {
        damaged();
    }
}

hsize_t DataSet::size_of(const Chunk& chunk) const {
    const hsize_t offset[2] = {chunk.row, chunk.column};
    hsize_t size = 0;
    return H5Dget_chunk_storage_size(set_.get(), offset, &size) < 0 ? 0 : size;
}

std::optional<std::vector<Chunk>> DataSet::chunks(const std::vector<Hdf5Rows::Share>& shares) const {
    std::vector<Chunk> result;
    if (lengths_[1] == 0) {
        return result;
    }
    hsize_t begin = lengths_[0];
    for (const auto& share : shares) {
        begin = share.rows > 0 ? std::min<hsize_t>(begin, share.first) : begin;
    }
    const hsize_t end = end_of_wanted(shares, begin, lengths_[0]);
    for (hsize_t row = begin / layout_->chunk[0] * layout_->chunk[0]; row < end; row += layout_->chunk[0]) {
        if (end_of_wanted(shares, row, row + layout_->chunk[0]) == row) {
            continue;
        }
        for (hsize_t column = 0; column < lengths_[1]; column += layout_->chunk[1]) {
            Chunk chunk;
            chunk.row = row;
            chunk.column = column;
            if (size_of(chunk) == 0) {
                return {};
            }
            result.push_back(std::move(chunk));
        }
    }
    return result;
}

void DataSet::load(Chunk& chunk) const {
    const hsize_t size = size_of(chunk);
    if (size == 0 || size > file_.bytes()) {
        damaged();
    }
    chunk.bytes.resize(size);
    const hsize_t offset[2] = {chunk.row, chunk.column};
    std::uint32_t skipped = 0;
    if (H5Dread_chunk(set_.get(), H5P_DEFAULT, offset, &skipped, chunk.bytes.data()) < 0) {
        damaged();
    }
    const auto used = [&](H5Z_filter_t filter) {
        const auto found = std::find(layout_->filters.begin(), layout_->filters.end(), filter);
        return found != layout_->filters.end() && (skipped >> (found - layout_->filters.begin()) & 1U) == 0;
    };
    chunk.deflated = used(H5Z_FILTER_DEFLATE);
    chunk.shuffled = used(H5Z_FILTER_SHUFFLE);
}

/// Chunks that wait to be unpacked.
class Unpacking {
public:
    explicit Unpacking(core::Progress& progress) : progress_(progress) {}
    void add(const DataSet& set, const std::vector<Hdf5Rows::Share>& shares, Chunk&& chunk) {
        constexpr std::size_t most = std::size_t{8} << 20;
        bytes_ += chunk.bytes.size();
        waiting_.push_back({&set, &shares, std::move(chunk)});
        if (bytes_ >= most) {
            run();
        }
    }
    void run() {
        core::parallel_for(
            waiting_.size(),
            [&](std::size_t i) {
                const Task& task = waiting_[i];
                const ChunkLayout& layout = *task.set->layout();
                const hsize_t end = end_of_wanted(*task.shares, task.chunk.row, std::min(task.chunk.row + layout.chunk[0], layout.lengths[0]));
                const bool good = unpack(layout, task.chunk, end, progress_, [&](hsize_t row, hsize_t rows, const unsigned char* stored) {
                    distribute(layout, task.chunk, *task.shares, row, rows, stored);
                    return true;
                });
                if (!good) {
                    task.set->damaged();
                }
            },
            progress_);
        waiting_.clear();
        bytes_ = 0;
    }

private:
    struct Task {
        const DataSet* set;
        const std::vector<Hdf5Rows::Share>* shares;
        Chunk chunk;
    };
    core::Progress& progress_;
    std::vector<Task> waiting_;
    std::size_t bytes_ = 0;
};

template <typename Number>
void each_row_of(const Hdf5File& file, const std::string& path, core::Progress& progress, const std::function<bool(const Number*, std::size_t)>& take) {
    const DataSet set(file, path, std::is_integral_v<Number>);
    set.check_rows(0, set.rows());
    const std::size_t columns = set.columns();
    constexpr std::size_t window = std::size_t{1} << 18;
    const hsize_t at_once = std::max<hsize_t>(1, window / std::max<std::size_t>(1, columns));
    std::vector<Number> numbers;
    bool more = true;
    // Chunks that are as wide as the data set can be looked at while they are inflated.
    const bool whole_rows = set.layout() && set.layout()->chunk[1] == columns;
    auto chunks = whole_rows ? set.chunks({{0, set.rows(), nullptr}}) : std::nullopt;
    if (chunks) {
        for (std::size_t i = 0; i < chunks->size() && more; ++i) {
            Chunk chunk = std::move((*chunks)[i]);
            set.load(chunk);
            const hsize_t end = std::min(chunk.row + set.layout()->chunk[0], set.rows());
            const bool good = unpack(*set.layout(), chunk, end, progress, [&](hsize_t /*row*/, hsize_t rows, const unsigned char* stored) {
                numbers.resize(rows * columns);
                set.layout()->convert(stored, rows * columns, numbers.data());
                return more = take(numbers.data(), rows);
            });
            if (!good) {
                set.damaged();
            }
        }
        return;
    }
    for (hsize_t row = 0; row < set.rows() && more; row += at_once) {
        progress.check();
        const hsize_t some = std::min(at_once, set.rows() - row);
        numbers.resize(some * columns);
        set.read({row, some, numbers.data()});
        more = take(numbers.data(), some);
    }
}

}  // namespace

void Hdf5Rows::note(const std::string& path, bool whole, const Share& share) {
    if (requests_.empty() || requests_.back().path != path || requests_.back().whole != whole) {
        requests_.push_back({path, whole, {}});
    }
    requests_.back().shares.push_back(share);
}

void Hdf5Rows::read(core::Progress& progress) {
    const std::vector<Request> requests = std::exchange(requests_, {});
    std::deque<DataSet> sets;  // open until the last of their chunks is unpacked
    Unpacking unpacking(progress);
    for (const auto& request : requests) {
        progress.check();
        const DataSet& set = sets.emplace_back(file_, request.path, request.whole);
        for (const auto& share : request.shares) {
            set.check_rows(share.first, share.rows);
        }
        auto chunks = set.layout() ? set.chunks(request.shares) : std::nullopt;
        if (!chunks) {
            std::for_each(request.shares.begin(), request.shares.end(), [&](const Share& share) { set.read(share); });
            continue;
        }
        for (auto& chunk : *chunks) {
            set.load(chunk);
            unpacking.add(set, request.shares, std::move(chunk));
        }
    }
    unpacking.run();
}

void each_row(const Hdf5File& file, const std::string& path, core::Progress& progress,
              const std::function<bool(const double* numbers, std::size_t rows)>& take) {
    each_row_of(file, path, progress, take);
}

void each_row(const Hdf5File& file, const std::string& path, core::Progress& progress,
              const std::function<bool(const std::uint32_t* numbers, std::size_t rows)>& take) {
    each_row_of(file, path, progress, take);
}

}  // namespace underbody::postproc
