// The same readings written as each kind of log that a vehicle writes; small writers for tests, after the formats' own
// documents, not after the readers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace underbody::test {

/// One sensor: readings of one kind at their own times.
struct LoggedSensor {
    std::string message;       ///< PX4: topic; DataFlash: at most four letters; ROS: topic
    std::string type;          ///< ROS: "sensor_msgs/msg/Range", "nav_msgs/msg/Odometry", ...; others: not used
    std::string field;         ///< PX4, DataFlash: its one number beside the time
    std::vector<double> time;  ///< s
    std::vector<double> value;
};

/// Start of all these logs on their own clock, microseconds (ROS: since 1970, after 1.7e9 s).
inline constexpr std::uint64_t log_start_us = 5000000;

std::string ulog_bytes(const std::vector<LoggedSensor>& sensors);
std::string dataflash_bytes(const std::vector<LoggedSensor>& sensors);
std::string dataflash_text(const std::vector<LoggedSensor>& sensors);
/// `compression`: "", "lz4", "zstd"; `definitions`: the bag holds the messages' definitions.
std::string mcap_bytes(const std::vector<LoggedSensor>& sensors, const std::string& compression,
                       bool definitions = true);
void write_sqlite_bag(const std::filesystem::path& file, const std::vector<LoggedSensor>& sensors);

/// A message in CDR, stamped `time_ns` where the type has a header, its chief number `value`: range of a Range, z of
/// the position of an Odometry or PoseStamped, z of the linear acceleration of an Imu, data of a Float64.
std::string cdr_message(const std::string& type, std::int64_t time_ns, double value);

}  // namespace underbody::test
