// ROS 2 messages: their definitions (.msg texts) and their numbers out of CDR. Only the readers of bags include this.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "surrogates/dynamics/logs/log.h"

namespace underbody::dynamics {

/// A field of a definition.
struct RosField {
    enum class Array { none, fixed, sequence };
    std::string name;
    std::string type;  ///< "float64", "string", "geometry_msgs/Point"
    Array array = Array::none;
    std::size_t count = 0;  ///< of a fixed array
};

/// Definitions by "package/Type"; "msg/" within a name is left out.
using RosTypes = std::map<std::string, std::vector<RosField>>;

/// "sensor_msgs/msg/Range" -> "sensor_msgs/Range".
std::string ros_type_name(std::string_view name);

/// Adds a type from its definition and those it brings along ("===" lines, "MSG: package/Type"). Types that are there
/// stay. Returns what is wrong with the text, or nothing.
std::string add_ros_definition(RosTypes& types, const std::string& type, std::string_view text);

/// std_msgs, builtin_interfaces, geometry_msgs, nav_msgs/Odometry and the sensors of sensor_msgs (ROS 2 Humble to
/// Jazzy: they are the same).
const RosTypes& common_ros_types();

/// Decodes the messages of one topic.
class RosDecoder {
public:
    RosDecoder(const RosTypes& types, std::string type);
    /// Why messages of the type cannot be read; empty where they can.
    [[nodiscard]] const std::string& reason() const { return reason_; }
    /// Decodes one message with its encapsulation header: one number a field, fields as description() has them after
    /// the first. Stamps are s since `start` (ns). Sequences give as many numbers as the first message had (at most
    /// 64), NaN where a later one is shorter. False: the bytes do not fit the definition.
    bool decode(std::string_view cdr, std::int64_t start, std::vector<double>& values);
    [[nodiscard]] const std::vector<LogField>& fields() const { return fields_; }

private:
    struct Walk;
    void check(const std::string& type, int depth);
    void field(Walk& walk, const RosField& field, const std::string& prefix);
    void message(Walk& walk, const std::string& type, const std::string& prefix);
    const RosTypes& types_;
    std::string type_, reason_;
    std::vector<LogField> fields_;
    std::vector<std::size_t> lengths_;  ///< of the sequences, in order, in the first message
    bool described_ = false;
};

/// The topics of one bag, whatever it is kept in.
class RosTopics {
public:
    RosTopics(std::string file, LogSink& sink) : file_(std::move(file)), sink_(sink) {}
    /// A definition that the bag holds. `encoding`: "ros2msg"; others are passed over.
    void add_definition(const std::string& type, const std::string& encoding, std::string_view text);
    void add_topic(std::size_t id, const std::string& name, const std::string& type, const std::string& encoding);
    /// `time`: ns since 1970.
    void message(std::size_t id, std::int64_t time, std::string_view cdr);
    void finish(LogEnd& end) const;
    [[nodiscard]] double last() const { return last_; }
    [[nodiscard]] std::size_t messages() const { return messages_; }

private:
    struct Topic {
        std::string name, type, reason;
        std::unique_ptr<RosDecoder> decoder;
        bool begun = false, wanted = false;
    };
    std::string file_;
    LogSink& sink_;
    RosTypes types_ = common_ros_types();
    std::map<std::string, std::string> bad_definitions_;
    std::map<std::size_t, Topic> topics_;
    std::vector<UnreadMessages> unread_;
    std::vector<double> values_;
    std::int64_t start_ = 0;
    double last_ = 0;
    std::size_t messages_ = 0;
};

}  // namespace underbody::dynamics
