// HDF5 behind a door: no header of it in ours, numbers come out as Buffers, sizes are checked before memory is taken.
// Rows of many data sets at once: hdf5_rows.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "postproc/importers/mesh/buffer.h"

namespace underbody::postproc {

/// A file opened for reading. Every failure is an InputError with the file and the path within it.
class Hdf5File {
public:
    explicit Hdf5File(const std::filesystem::path& path);
    ~Hdf5File();
    Hdf5File(const Hdf5File&) = delete;
    Hdf5File& operator=(const Hdf5File&) = delete;

    [[nodiscard]] const std::string& name() const { return name_; }
    /// A group or a dataset that could be opened when the file was looked through.
    [[nodiscard]] bool has(const std::string& path) const;
    /// Names of the children of a group, numbers in their order ("2" before "10"); empty if there is no such group.
    [[nodiscard]] std::vector<std::string> children(const std::string& path) const;
    /// An attribute with one whole number.
    [[nodiscard]] std::optional<std::int64_t> attribute(const std::string& path, const std::string& name) const;
    /// An attribute with one string, of fixed or variable length.
    [[nodiscard]] std::optional<std::string> text_attribute(const std::string& path, const std::string& name) const;
    /// Lengths along the dimensions of a dataset (at most 2); empty if it is not one.
    [[nodiscard]] std::vector<std::uint64_t> shape(const std::string& path) const;

    /// The same, once it is sure that the file has bytes for so many numbers: memory may be taken for them.
    [[nodiscard]] std::vector<std::uint64_t> backed_shape(const std::string& path) const;

    /// A list of whole numbers, as `Hdf5Rows` gives them.
    [[nodiscard]] Buffer<std::uint32_t> numbers(const std::string& path) const;
    /// The strings of a dataset, of fixed or variable length; none if it is not there or holds something else.
    [[nodiscard]] std::vector<std::string> texts(const std::string& path) const;
    /// All of them joined.
    [[nodiscard]] std::string text(const std::string& path) const;

    // For what reads values of this file.
    [[nodiscard]] std::int64_t id() const { return file_; }
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
    [[noreturn]] void fail(const std::string& path, const std::string& what) const;
    /// How many numbers a dataset holds, if the bytes that it has in the file can hold them.
    [[nodiscard]] std::uint64_t backed_size(std::int64_t dataset, const std::string& path) const;

private:
    std::string name_;
    /// Paths of all objects that a process of its own opened and looked at: what it did not come to is not touched,
    /// however a damaged file may lead there.
    std::shared_ptr<const std::set<std::string>> looked_at_;
    std::int64_t file_ = -1;
    std::uint64_t bytes_ = 0;
};

}  // namespace underbody::postproc
