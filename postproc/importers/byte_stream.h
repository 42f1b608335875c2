// The bytes of a file, plain or gzipped, through a window that moves forward: a file of any size needs 4 MiB.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "core/error.h"

namespace underbody::postproc {

/// Reads forward. The window [here(), end()) is contiguous; `ensure` makes it longer.
/// A gzipped file is inflated on a second thread; its checksum is checked when the end is reached.
class ByteStream {
public:
    /// Throws InputError when the file cannot be opened.
    explicit ByteStream(const std::filesystem::path& path);
    /// Bytes in memory; they must outlive the stream.
    ByteStream(std::string_view bytes, std::string name);
    ~ByteStream();
    ByteStream(const ByteStream&) = delete;
    ByteStream& operator=(const ByteStream&) = delete;

    /// Makes at least `count` bytes (at most `largest_window`) available, or all that are left.
    /// True if there are `count`.
    bool ensure(std::size_t count) { return static_cast<std::size_t>(end_ - here_) >= count || refill(count); }
    static constexpr std::size_t largest_window = std::size_t{1} << 20;

    [[nodiscard]] const char* here() const { return here_; }
    [[nodiscard]] const char* end() const { return end_; }
    /// After reading from the window: the new place, within [here(), end()].
    void move_to(const char* place) { here_ = place; }
    [[nodiscard]] bool at_end() { return !ensure(1); }

    /// The next byte, or -1 at the end of the file.
    int peek() { return ensure(1) ? static_cast<unsigned char>(*here_) : -1; }
    int get() { return ensure(1) ? static_cast<unsigned char>(*here_++) : -1; }

    /// Copies `count` bytes; throws InputError when fewer are left.
    void read(void* target, std::size_t count);
    void skip(std::uint64_t count);

    /// Offset of here() from the beginning (of the inflated bytes, if gzipped).
    [[nodiscard]] std::uint64_t position() const { return window_start_ + static_cast<std::uint64_t>(here_ - base_); }
    /// No more bytes than this can follow: exact for a plain file, 1032 times the compressed bytes for a gzipped one.
    [[nodiscard]] std::uint64_t most_left() const;
    [[nodiscard]] bool compressed() const;
    [[nodiscard]] const std::string& name() const { return name_; }
    /// The file and the byte where the stream is.
    [[nodiscard]] core::Place place() const;

private:
    bool refill(std::size_t count);

    struct Source;
    std::string name_;
    std::unique_ptr<Source> source_;
    std::unique_ptr<char[]> window_;
    std::size_t window_size_ = std::size_t{4} << 20;
    const char* base_ = nullptr;  ///< first byte of the window
    const char* here_ = nullptr;
    const char* end_ = nullptr;
    std::uint64_t window_start_ = 0;  ///< offset of base_ in the file
};

/// The first bytes of a file for recognising it: inflated when they are gzip.
std::string inflated_head(std::string_view head);

}  // namespace underbody::postproc
