#include "postproc/importers/hdf5/hdf5_rows.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/parallel.h"
#include "postproc/importers/hdf5/hdf5_chunks.h"
#include "postproc/importers/hdf5/hdf5_handle.h"
#include "postproc/importers/hdf5/hdf5_numbers.h"

namespace underbody::postproc {

namespace {

/// What becomes of the numbers of a file.
struct Wanted {
    Hdf5Convert convert = nullptr;
    std::size_t width = 1;  ///< bytes
};

/// Gives the rows that begin at `row` to whom they belong.
void distribute(const Hdf5ChunkLayout& layout, const Wanted& wanted, const Hdf5Chunk& chunk,
                const std::vector<Hdf5Rows::Share>& shares, hsize_t row, hsize_t rows, const unsigned char* stored) {
    const hsize_t columns = std::min(layout.chunk[1], layout.lengths[1] - chunk.column);
    for (const auto& share : shares) {
        const hsize_t from = std::max<hsize_t>(row, share.first);
        const hsize_t to = std::min<hsize_t>(row + rows, share.first + share.rows);
        if (from >= to) {
            continue;
        }
        auto* out = static_cast<unsigned char*>(share.out) +
                    ((from - share.first) * layout.lengths[1] + chunk.column) * wanted.width;
        const unsigned char* in = stored + (from - row) * layout.row_bytes();
        if (layout.chunk[1] == layout.lengths[1]) {
            wanted.convert(in, (to - from) * columns, out);
            continue;
        }
        for (hsize_t i = from; i < to; ++i) {
            wanted.convert(in, columns, out);
            in += layout.row_bytes();
            out += layout.lengths[1] * wanted.width;
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

    [[nodiscard]] const std::optional<Hdf5ChunkLayout>& layout() const { return layout_; }
    [[nodiscard]] const Wanted& wanted() const { return wanted_; }
    [[nodiscard]] hsize_t rows() const { return lengths_[0]; }
    [[nodiscard]] hsize_t columns() const { return lengths_[1]; }
    void check_rows(std::uint64_t first, std::uint64_t rows) const;
    /// By the library: what lies in one piece.
    void read(const Hdf5Rows::Share& share) const;
    /// The chunks of which `shares` want something.
    [[nodiscard]] std::vector<Hdf5Chunk> chunks(const std::vector<Hdf5Rows::Share>& shares) const;
    void load(Hdf5Chunk& chunk) const;
    [[noreturn]] void damaged() const { file_.fail(path_, "its values cannot be read"); }

private:
    const Hdf5File& file_;
    std::string path_;
    bool whole_;
    Hdf5Handle set_;
    Hdf5Handle type_;
    Hdf5Handle space_;
    int rank_ = 0;
    hsize_t lengths_[2] = {1, 1};
    Wanted wanted_;
    std::optional<Hdf5ChunkLayout> layout_;
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
    wanted_ = {conversion_from(type_.get(), whole_), whole_ ? sizeof(std::uint32_t) : sizeof(double)};
    if (wanted_.convert == nullptr) {
        file_.fail(path_,
                   "its numbers of " + std::to_string(H5Tget_size(type_.get())) + " bytes are of no kind that is read");
    }
    (void)file_.backed_size(set_.get(), path_);
    rank_ = H5Sget_simple_extent_ndims(space_.get());
    if (rank_ < 1 || rank_ > 2 || H5Sget_simple_extent_dims(space_.get(), lengths_, nullptr) < 0) {
        rank_ = 0;
        return;
    }
    const Hdf5Handle plan(H5Dget_create_plist(set_.get()), H5Pclose);
    if (plan.good() && H5Pget_layout(plan.get()) == H5D_CHUNKED) {
        std::string refusal;
        layout_ = layout_of_chunks(set_.get(), type_.get(), space_.get(), refusal);
        if (!layout_) {
            file_.fail(path_, refusal);
        }
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

std::vector<Hdf5Chunk> DataSet::chunks(const std::vector<Hdf5Rows::Share>& shares) const {
    std::vector<Hdf5Chunk> result;
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
            Hdf5Chunk chunk;
            chunk.row = row;
            chunk.column = column;
            if (stored_size(set_.get(), chunk) == 0) {
                file_.fail(path_, "rows " + std::to_string(row) + " to " +
                                      std::to_string(std::min(row + layout_->chunk[0], lengths_[0])) +
                                      " were never written");
            }
            result.push_back(std::move(chunk));
        }
    }
    return result;
}

void DataSet::load(Hdf5Chunk& chunk) const {
    if (const std::string refusal = load_chunk(set_.get(), *layout_, file_.bytes(), chunk); !refusal.empty()) {
        file_.fail(path_, refusal);
    }
}

/// Chunks that wait to be unpacked.
class Unpacking {
public:
    explicit Unpacking(core::Progress& progress) : progress_(progress) {}
    void add(const DataSet& set, const std::vector<Hdf5Rows::Share>& shares, Hdf5Chunk&& chunk) {
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
                const Hdf5ChunkLayout& layout = *task.set->layout();
                const hsize_t end = end_of_wanted(*task.shares, task.chunk.row,
                                                  std::min(task.chunk.row + layout.chunk[0], layout.lengths[0]));
                const bool good = unpack(
                    layout, task.chunk, end, progress_, [&](hsize_t row, hsize_t rows, const unsigned char* stored) {
                        distribute(layout, task.set->wanted(), task.chunk, *task.shares, row, rows, stored);
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
        Hdf5Chunk chunk;
    };
    core::Progress& progress_;
    std::vector<Task> waiting_;
    std::size_t bytes_ = 0;
};

template <typename Number>
void each_row_of(const Hdf5File& file, const std::string& path, core::Progress& progress,
                 const std::function<bool(const Number*, std::size_t)>& take) {
    const DataSet set(file, path, std::is_integral_v<Number>);
    set.check_rows(0, set.rows());
    const std::size_t columns = set.columns();
    constexpr std::size_t window = std::size_t{1} << 18;
    const hsize_t at_once = std::max<hsize_t>(1, window / std::max<std::size_t>(1, columns));
    std::vector<Number> numbers;
    bool more = true;
    // Chunks that are as wide as the data set can be looked at while they are inflated.
    const bool whole_rows = set.layout() && set.layout()->chunk[1] == columns;
    if (whole_rows) {
        auto chunks = set.chunks({{0, set.rows(), nullptr}});
        for (std::size_t i = 0; i < chunks.size() && more; ++i) {
            Hdf5Chunk chunk = std::move(chunks[i]);
            set.load(chunk);
            const hsize_t end = std::min(chunk.row + set.layout()->chunk[0], set.rows());
            const bool good = unpack(*set.layout(), chunk, end, progress,
                                     [&](hsize_t /*row*/, hsize_t rows, const unsigned char* stored) {
                                         numbers.resize(rows * columns);
                                         set.wanted().convert(stored, rows * columns, numbers.data());
                                         return more = take(numbers.data(), rows);
                                     });
            if (!good) {
                set.damaged();
            }
        }
        return;
    }
    Hdf5Rows part(file);
    for (hsize_t row = 0; row < set.rows() && more; row += at_once) {
        progress.check();
        const hsize_t some = std::min(at_once, set.rows() - row);
        numbers.resize(some * columns);
        part.add(path, row, some, numbers.data());
        part.read(progress);
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
        if (!set.layout()) {
            std::for_each(request.shares.begin(), request.shares.end(), [&](const Share& share) { set.read(share); });
            continue;
        }
        for (auto& chunk : set.chunks(request.shares)) {
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
