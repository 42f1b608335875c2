// Logs that still grow: bytes of a file or a pipe as they come, and CSV out of them row by row.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "surrogates/dynamics/logs/log.h"
#include "surrogates/dynamics/logs/log_channels.h"

namespace underbody::dynamics {

/// A file or a pipe. With `follow` a file has no end: what is added to it is waited for, until somebody cancels.
/// Throws core::InputError: cannot be opened; with `follow` also when the file becomes shorter or is replaced.
class GrowingStream : public ByteStream {
public:
    /// "-" is the standard input.
    GrowingStream(const std::string& path, bool follow, core::Progress& progress);
    ~GrowingStream() override;
    GrowingStream(const GrowingStream&) = delete;
    GrowingStream& operator=(const GrowingStream&) = delete;

    /// Waits for what is not there yet. Throws core::Cancelled.
    std::size_t read(char* into, std::size_t most) override;
    /// At least so many of the first bytes, which are read again afterwards; fewer where there are no more.
    std::string first(std::size_t least);
    /// False: its writer is not kept waiting and nothing is lost while nobody reads (a file that is complete).
    [[nodiscard]] bool live() const { return live_; }

private:
    void check_same_file() const;
    std::string path_;
    int descriptor_;
    bool follow_, live_ = false;
    core::Progress& progress_;
    std::string first_;
};

/// A CSV file's rows to a sink as they come; a last line that is not complete is waited for. `sink_of` is called once,
/// with the first rows, for the sink that the channels go to. Memory does not grow with the file.
/// Throws core::InputError with the line in the file: as core::read_csv within the first 20 rows, or where more than
/// 100 lines in a row cannot be read; no rows at all. After 20 good rows a line that cannot be read is passed over with
/// a problem (the first three each, and how many there were). A number that is not finite is no reading, with a
/// problem. A last line that was cut by the end of the file is left out with a problem.
void read_csv_stream(ByteStream& stream, const std::string& name,
                     const std::function<std::unique_ptr<ChannelSink>(const core::Table& first_rows)>& sink_of,
                     core::Problems& problems);

}  // namespace underbody::dynamics
