// Logs that vehicles write: PX4 ULog, ArduPilot DataFlash, ROS 2 bags (SQLite and MCAP). Messages go row by row to a
// sink, so that a log of any size is read in bounded memory and one that still grows is read as it grows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/progress.h"

namespace underbody::dynamics {

/// One number of a message.
struct LogField {
    std::string name;  ///< as the log names it; nested ones with dots, of arrays with [i]: "pose.position.z", "q[2]"
    std::string unit;  ///< as the log states it and UDUNITS-2 reads it; empty: the log does not say
};

/// All messages of one name: a topic, or one instance of a sensor.
struct LogSeries {
    std::string name;  ///< "/range", "RFND", and "RFND[1]" for the second of several alike
    std::string type;  ///< "sensor_msgs/msg/Range"; empty where the name says it
    std::vector<LogField> fields;
};

/// Takes what a log holds. Rows of one series come in the order of the file.
class LogSink {
public:
    virtual ~LogSink() = default;
    /// Called once before a series' first row. False: its rows are not wanted.
    virtual bool begin(std::size_t series, const LogSeries& description) = 0;
    /// `time`: s since the log's start, by the log's own clock. One value a field; NaN: none in this message. Values
    /// that are stamps (fields of unit "s" whose name says stamp or time) are on the same clock.
    virtual void row(std::size_t series, double time, std::span<const double> values) = 0;
};

/// Messages that were left unread, and why.
struct UnreadMessages {
    std::string name;
    std::string type;
    std::string reason;
    std::size_t count = 0;
};

/// What is known once a log was read to its end.
struct LogEnd {
    std::string format;  ///< "PX4 ULog"
    std::string clock;   ///< what the log's times are: "microseconds since the autopilot started"
    /// Start of the log on its own clock, ns: since the autopilot started, or since 1970 (ROS).
    std::int64_t start = 0;
    std::vector<UnreadMessages> unread;
    core::Problems problems;  ///< damage, truncation: what was read and up to where
};

/// Bytes that come one after the other: a file, one that still grows, a pipe.
class ByteStream {
public:
    virtual ~ByteStream() = default;
    /// At most `most` bytes; 0: the end.
    virtual std::size_t read(char* into, std::size_t most) = 0;
};

/// "ulog", "dataflash", "dataflash text", "sqlite bag", "mcap", or empty: by the first bytes (128 tell). A bag is also
/// a folder with .db3 or .mcap files in it.
std::string log_format(std::string_view first_bytes);
/// The same of a file or folder; empty when it cannot be read or is no log.
std::string log_format(const std::filesystem::path& path);

/// Reads a whole log. Damage is skipped and a cut end is accepted, each with a problem that says what was read and up
/// to where. Throws core::InputError: not such a log (with what can be read), a version or a needed feature that is not
/// known, a compressed bag, nothing that can be read at all.
LogEnd read_log(const std::filesystem::path& path, LogSink& sink, core::Progress& progress = core::Progress::none());

/// The formats that can be read while they grow: ULog, DataFlash, MCAP. `name` is for messages.
/// Throws core::InputError as read_log, and for a SQLite bag, which cannot be read from a stream.
LogEnd read_log(ByteStream& stream, const std::string& name, LogSink& sink,
                core::Progress& progress = core::Progress::none());

}  // namespace underbody::dynamics
