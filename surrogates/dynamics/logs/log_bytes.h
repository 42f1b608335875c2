// Bytes of a log with a look ahead, and little-endian numbers out of them. Only the readers of logs include this.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "core/progress.h"
#include "surrogates/dynamics/logs/log.h"

namespace underbody::dynamics {

/// A little-endian number at a byte of `bytes`; the caller has checked that it is there.
template <typename Number>
Number number_at(std::string_view bytes, std::size_t at) {
    Number value{};
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

/// The whole part of a number that may be anything in a damaged log; 0 for what no 64-bit integer holds.
inline std::int64_t whole_part(double value) {
    constexpr double most = 9.2e18;
    return std::abs(value) < most ? static_cast<std::int64_t>(value) : 0;
}

/// Seconds from `start` to `time` (ns), exact to a nanosecond where 64 bits hold the difference; two times of a damaged
/// log may lie further apart.
inline double seconds_between(std::int64_t start, std::int64_t time) {
    std::int64_t difference = 0;
    return __builtin_sub_overflow(time, start, &difference)
               ? (static_cast<double>(time) - static_cast<double>(start)) / 1e9
               : static_cast<double>(difference) / 1e9;
}

/// A stream with a window ahead.
class LogBytes {
public:
    LogBytes(ByteStream& stream, core::Progress& progress) : stream_(stream), progress_(progress) {}

    /// The next `count` bytes, or fewer when the stream ends before; valid until the next call.
    std::string_view peek(std::size_t count);
    /// Goes on by `count` bytes, which may lie beyond what was peeked.
    void skip(std::size_t count);
    /// Place of the next byte.
    [[nodiscard]] std::int64_t offset() const { return offset_; }

private:
    ByteStream& stream_;
    core::Progress& progress_;
    std::vector<char> buffer_;
    std::size_t begin_ = 0, end_ = 0;
    std::int64_t offset_ = 0;
    bool ended_ = false;
};

/// Bytes in memory as a stream.
class MemoryStream : public ByteStream {
public:
    explicit MemoryStream(std::string_view bytes) : bytes_(bytes) {}
    std::size_t read(char* into, std::size_t most) override {
        const std::size_t count = std::min(most, bytes_.size());
        std::memcpy(into, bytes_.data(), count);
        bytes_.remove_prefix(count);
        return count;
    }

private:
    std::string_view bytes_;
};

/// Gathers damage of one log: several damaged places become one sentence.
class DamageReport {
public:
    void skipped(std::int64_t at, std::int64_t bytes) {
        first_ = places_ == 0 ? at : first_;
        ++places_;
        bytes_ += bytes;
    }
    /// `left`: the bytes at the end that are no whole one of `what`.
    void cut(std::int64_t at, std::size_t left, std::string what) {
        cut_at_ = at;
        cut_left_ = left;
        cut_what_ = std::move(what);
    }
    /// `last`: s, time of the last row that was read.
    void tell(const std::string& file, double last, core::Problems& problems) const;

private:
    std::int64_t first_ = 0, bytes_ = 0, cut_at_ = -1;
    std::size_t places_ = 0, cut_left_ = 0;
    std::string cut_what_;
};

/// Unread messages counted by name.
void count_unread(std::vector<UnreadMessages>& all, const std::string& name, const std::string& type,
                  const std::string& reason);

/// "as the log states" -> a unit that core::is_unit knows, or empty.
std::string known_unit(std::string_view stated);

// One reader a format. `name` is for messages.
LogEnd read_ulog(LogBytes& bytes, const std::string& name, LogSink& sink);
LogEnd read_dataflash(LogBytes& bytes, const std::string& name, LogSink& sink);
LogEnd read_dataflash_text(LogBytes& bytes, const std::string& name, LogSink& sink);
LogEnd read_mcap(LogBytes& bytes, const std::string& name, LogSink& sink);
LogEnd read_sqlite_bag(const std::filesystem::path& path, LogSink& sink, core::Progress& progress);

}  // namespace underbody::dynamics
