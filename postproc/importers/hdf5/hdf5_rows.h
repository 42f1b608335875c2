// Numbers of HDF5 data sets, read together: the library does one after another, what is deflated is inflated by all
// cores.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "postproc/importers/hdf5/hdf5_file.h"

namespace underbody::postproc {

/// Rows of data sets, noted one by one and then read. Rows of the same data set are best noted one after another: what
/// they share is inflated once, and what lies behind the last of them not at all.
class Hdf5Rows {
public:
    /// The file must outlive this.
    explicit Hdf5Rows(const Hdf5File& file) : file_(file) {}

    /// `rows` rows from `first` on (from 0) of a data set of numbers with one or two dimensions. `out` has room for
    /// them and stays where it is until `read`.
    void add(const std::string& path, std::uint64_t first, std::uint64_t rows, double* out) {
        note(path, false, {first, rows, out});
    }
    /// Whole numbers. Negative ones of up to 4 bytes become larger than any id; wider ones are cut to the smallest and
    /// the largest.
    void add(const std::string& path, std::uint64_t first, std::uint64_t rows, std::uint32_t* out) {
        note(path, true, {first, rows, out});
    }

    /// Reads what was noted and forgets it. Throws InputError with file and path.
    void read(core::Progress& progress);

    /// Some of the rows of a data set and where they go.
    struct Share {
        std::uint64_t first = 0;
        std::uint64_t rows = 0;
        void* out = nullptr;
    };

private:
    struct Request {
        std::string path;
        bool whole = false;
        std::vector<Share> shares;
    };
    void note(const std::string& path, bool whole, const Share& share);

    const Hdf5File& file_;
    std::vector<Request> requests_;
};

/// All rows of a data set in order, some at a time, without memory for all of them. `take` gets their numbers and how
/// many rows it are, and says whether it wants more. Throws as `Hdf5Rows::read` does.
void each_row(const Hdf5File& file, const std::string& path, core::Progress& progress,
              const std::function<bool(const double* numbers, std::size_t rows)>& take);
void each_row(const Hdf5File& file, const std::string& path, core::Progress& progress,
              const std::function<bool(const std::uint32_t* numbers, std::size_t rows)>& take);

}  // namespace underbody::postproc
