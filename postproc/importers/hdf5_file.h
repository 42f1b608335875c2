// HDF5 behind a door: no header of it in ours, numbers come out as Buffers, sizes are checked before memory is taken.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "postproc/importers/buffer.h"

namespace underbody::postproc {

/// A file opened for reading. Every failure is an InputError with the file and the path within it.
class Hdf5File {
public:
    explicit Hdf5File(const std::filesystem::path& path);
    ~Hdf5File();
    Hdf5File(const Hdf5File&) = delete;
    Hdf5File& operator=(const Hdf5File&) = delete;

    [[nodiscard]] const std::string& name() const { return name_; }
    /// A group or a dataset.
    [[nodiscard]] bool has(const std::string& path) const;
    /// Names of the children of a group, numbers in their order ("2" before "10"); empty if there is no such group.
    [[nodiscard]] std::vector<std::string> children(const std::string& path) const;
    /// An attribute with one whole number.
    [[nodiscard]] std::optional<std::int64_t> attribute(const std::string& path, const std::string& name) const;
    [[nodiscard]] std::optional<std::string> text_attribute(const std::string& path, const std::string& name) const;
    /// Lengths along the dimensions of a dataset (at most 2); empty if it is not one.
    [[nodiscard]] std::vector<std::uint64_t> shape(const std::string& path) const;

    [[nodiscard]] Buffer<double> reals(const std::string& path) const;
    [[nodiscard]] Buffer<std::uint32_t> numbers(const std::string& path) const;
    /// `rows` rows from `first` on (from 0), without reading the others. `out` has room for the rows' numbers.
    void reals(const std::string& path, std::uint64_t first, std::uint64_t rows, double* out) const;
    void numbers(const std::string& path, std::uint64_t first, std::uint64_t rows, std::uint32_t* out) const;
    /// All strings of a dataset joined; "" if it is not there.
    [[nodiscard]] std::string text(const std::string& path) const;

private:
    [[noreturn]] void fail(const std::string& path, const std::string& what) const;
    void read_rows(const std::string& path, std::uint64_t first, std::uint64_t rows, bool whole, void* out) const;
    std::uint64_t checked_size(std::int64_t dataset, const std::string& path, std::size_t bytes_each) const;

    std::string name_;
    std::int64_t file_ = -1;
    std::uint64_t bytes_ = 0;
};

}  // namespace underbody::postproc
