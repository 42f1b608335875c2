#include "surrogates/dynamics/logs/ros_message.h"

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/text.h"
#include "surrogates/dynamics/logs/log_bytes.h"

namespace underbody::dynamics {

namespace {

using eprosima::fastcdr::Cdr;

constexpr std::size_t longest_sequence = 64;  ///< numbers of one that become fields
constexpr std::size_t most_fields = 4096;
constexpr int deepest = 16;

bool is_primitive(const std::string& type) {
    static const std::set<std::string, std::less<>> all = {"bool",   "byte",  "char",   "float32", "float64",
                                                           "int8",   "uint8", "int16",  "uint16",  "int32",
                                                           "uint32", "int64", "uint64", "string"};
    return all.count(type) > 0;
}

template <typename Number>
double next(Cdr& cdr) {
    Number value{};
    cdr.deserialize(value);
    return static_cast<double>(value);
}

/// A number; text is passed over and gives NaN.
double next_number(Cdr& cdr, const std::string& type) {
    if (type == "float64") {
        return next<double>(cdr);
    }
    if (type == "float32") {
        return next<float>(cdr);
    }
    if (type == "int32") {
        return next<std::int32_t>(cdr);
    }
    if (type == "uint32") {
        return next<std::uint32_t>(cdr);
    }
    if (type == "int64") {
        return next<std::int64_t>(cdr);
    }
    if (type == "uint64") {
        return next<std::uint64_t>(cdr);
    }
    if (type == "int16") {
        return next<std::int16_t>(cdr);
    }
    if (type == "uint16") {
        return next<std::uint16_t>(cdr);
    }
    if (type == "int8") {
        return next<std::int8_t>(cdr);
    }
    if (type == "string") {
        std::string text;
        cdr.deserialize(text);
        return std::nan("");
    }
    return next<std::uint8_t>(cdr);  // bool, byte, char, uint8
}

bool is_stamp(const std::string& type) { return type == "builtin_interfaces/Time"; }

}  // namespace

std::string ros_type_name(std::string_view name) {
    const auto parts = core::split(name, '/');
    return parts.size() == 3 ? std::string(parts[0]) + "/" + std::string(parts[2]) : std::string(name);
}

namespace {

/// One line of a definition: false when it is none.
bool read_field(std::string_view line, const std::string& package, RosField& field) {
    const std::size_t space = line.find_first_of(" \t");
    if (space == std::string_view::npos) {
        return false;
    }
    std::string type(line.substr(0, space));
    std::string_view rest = core::trimmed(line.substr(space));
    field.name = rest.substr(0, rest.find_first_of(" \t="));  // a default value may follow
    const std::size_t bracket = type.find('[');
    if (bracket != std::string::npos) {
        const std::string inside = type.substr(bracket + 1, type.find(']') - bracket - 1);
        const auto count = core::parse_integer(inside);
        field.array = count ? RosField::Array::fixed : RosField::Array::sequence;  // "", "<=8"
        field.count = count && *count > 0 ? static_cast<std::size_t>(*count) : 0;
        if (count && (*count < 1 || *count > 1000000)) {
            return false;
        }
        type.resize(bracket);
    }
    type = type.substr(0, type.find("<="));  // string<=20
    if (!is_primitive(type) && type != "wstring" && type.find('/') == std::string::npos) {
        type = type == "Header" ? "std_msgs/Header" : package + "/" + type;
    }
    field.type = ros_type_name(type);
    return !field.name.empty() && !field.type.empty();
}

}  // namespace

std::string add_ros_definition(RosTypes& types, const std::string& type, std::string_view text) {
    std::string name = ros_type_name(type);
    std::vector<RosField> fields;
    const auto keep = [&] { types.emplace(name, std::move(fields)); };
    for (std::string_view line : core::split(text, '\n')) {
        line = core::trimmed(line.substr(0, line.find('#')));
        if (line.empty()) {
            continue;
        }
        if (line.starts_with("====")) {
            keep();
            fields.clear();
            name.clear();
            continue;
        }
        if (line.starts_with("MSG:")) {
            name = ros_type_name(core::trimmed(line.substr(4)));
            continue;
        }
        if (line.starts_with("IDL:")) {
            return "a definition as IDL is not read";
        }
        // constants: type NAME=value; text after a default may hold '=' too
        const std::size_t space = line.find_first_of(" \t");
        const std::string_view rest =
            space == std::string_view::npos ? std::string_view() : core::trimmed(line.substr(space));
        const std::size_t end = rest.find_first_of(" \t=");
        if (end != std::string_view::npos && core::trimmed(rest.substr(end)).starts_with("=")) {
            continue;
        }
        RosField field;
        if (name.empty() || !read_field(line, name.substr(0, name.find('/')), field)) {
            return "'" + std::string(line.substr(0, 60)) + "' is no field of a message";
        }
        fields.push_back(std::move(field));
    }
    if (!name.empty()) {
        keep();
    }
    return {};
}

RosDecoder::RosDecoder(const RosTypes& types, std::string type) : types_(types), type_(ros_type_name(type)) {
    check(type_, 0);
}

void RosDecoder::check(const std::string& type, int depth) {
    if (is_primitive(type) || !reason_.empty()) {
        return;
    }
    const auto found = types_.find(type);
    if (found == types_.end()) {
        reason_ = type == "wstring"
                      ? "text of wide characters is not read"
                      : "the definition of " + type + " is not known" + (type == type_ ? "" : ", which is part of it");
    } else if (depth > deepest) {
        reason_ = "its definition holds itself, or is nested too deeply";
    } else {
        for (const RosField& one : found->second) {
            check(one.type, depth + 1);
        }
    }
}

/// One message on its way through the definition.
struct RosDecoder::Walk {
    Cdr& cdr;
    std::int64_t start;
    std::vector<double>& values;
    std::size_t sequence = 0;
    bool silent = false;  ///< within a sequence of messages, whose numbers are passed over
};

void RosDecoder::message(Walk& walk, const std::string& type, const std::string& prefix) {
    const std::vector<RosField>& all = types_.at(type);
    if (all.empty()) {
        (void)next<std::uint8_t>(walk.cdr);  // a message without fields has one byte
    }
    const std::size_t begin = walk.values.size();
    for (const RosField& one : all) {
        field(walk, one, prefix);
    }
    // The angles of a quaternion, about x, y, z of its own frame, as REP 103 turns them (z, then y, then x).
    if (type == "geometry_msgs/Quaternion" && !walk.silent && walk.values.size() == begin + 4) {
        const double x = walk.values[begin], y = walk.values[begin + 1], z = walk.values[begin + 2],
                     w = walk.values[begin + 3], square = x * x + y * y + z * z + w * w;
        const double sine = square > 0 ? std::clamp(2 * (w * y - z * x) / square, -1.0, 1.0) : std::nan("");
        walk.values.push_back(std::atan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z));
        walk.values.push_back(std::asin(sine));
        walk.values.push_back(std::atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z));
        if (!described_) {
            for (const char* angle : {"roll", "pitch", "yaw"}) {
                fields_.push_back({prefix + angle, "rad"});
            }
        }
    }
}

void RosDecoder::field(Walk& walk, const RosField& one, const std::string& prefix) {
    const auto give = [&](const std::string& name, double value, const std::string& unit = {}) {
        if (walk.silent || walk.values.size() >= most_fields) {
            return;
        }
        walk.values.push_back(value);
        if (!described_) {
            fields_.push_back({name, unit});
        }
    };
    const auto each = [&](const std::string& name) {
        if (is_stamp(one.type)) {
            const auto seconds = static_cast<std::int64_t>(next<std::int32_t>(walk.cdr));
            const auto rest = static_cast<std::int64_t>(next<std::uint32_t>(walk.cdr));
            give(name, seconds_between(walk.start, seconds * 1000000000 + rest), "s");
        } else if (!is_primitive(one.type)) {
            message(walk, one.type, name + ".");
        } else if (one.type == "string") {
            (void)next_number(walk.cdr, one.type);
        } else {
            give(name, next_number(walk.cdr, one.type));
        }
    };
    const std::string name = prefix + one.name;
    if (one.array == RosField::Array::none) {
        each(name);
        return;
    }
    const bool counted = one.array == RosField::Array::sequence;
    const std::size_t count = counted ? static_cast<std::size_t>(next<std::uint32_t>(walk.cdr)) : one.count;
    if (!counted) {
        for (std::size_t i = 0; i < count; ++i) {
            each(name + "[" + std::to_string(i) + "]");
        }
        return;
    }
    const bool numbers = is_primitive(one.type) && one.type != "string" && !walk.silent;
    std::size_t shown = 0;
    if (numbers) {
        if (!described_) {
            lengths_.push_back(std::min(count, longest_sequence));
        }
        shown = walk.sequence < lengths_.size() ? lengths_[walk.sequence] : 0;
        ++walk.sequence;
    }
    const bool before = walk.silent;
    for (std::size_t i = 0; i < count; ++i) {
        walk.silent = before || i >= shown;
        each(walk.silent ? name : name + "[" + std::to_string(i) + "]");
    }
    walk.silent = before;
    for (std::size_t i = count; i < shown; ++i) {
        give(name, std::nan(""));
    }
}

bool RosDecoder::decode(std::string_view bytes, std::int64_t start, std::vector<double>& values) {
    values.clear();
    // The first bytes say how the rest is laid out: CDR, big (0) or little endian (1).
    if (!reason_.empty() || bytes.size() < 4 || bytes[0] != 0 || (bytes[1] != 0 && bytes[1] != 1)) {
        return false;
    }
    try {
        // The library reads only, though it asks for bytes that may be written.
        eprosima::fastcdr::FastBuffer buffer(const_cast<char*>(bytes.data()), bytes.size());
        Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
        cdr.read_encapsulation();
        Walk walk{cdr, start, values};
        message(walk, type_, "");
    } catch (const eprosima::fastcdr::exception::Exception&) {
        if (!described_) {
            fields_.clear();
            lengths_.clear();
        }
        return false;
    }
    if (!described_) {
        described_ = true;
    }
    return values.size() == fields_.size();
}

void RosTopics::add_definition(const std::string& type, const std::string& encoding, std::string_view text) {
    const std::string name = ros_type_name(type);
    if (types_.count(name) > 0 || core::trimmed(text).empty()) {
        return;
    }
    if (encoding != "ros2msg" && encoding != "ros1msg") {
        bad_definitions_[name] = "its definition is in '" + encoding + "', which is not read";
        return;
    }
    RosTypes more = types_;
    const std::string wrong = add_ros_definition(more, name, text);
    if (wrong.empty()) {
        types_ = std::move(more);
    } else {
        bad_definitions_[name] = "its definition cannot be read: " + wrong;
    }
}

void RosTopics::add_topic(std::size_t id, const std::string& name, const std::string& type,
                          const std::string& encoding) {
    Topic& topic = topics_[id];
    topic = {};
    topic.name = name;
    topic.type = type;
    if (encoding != "cdr") {
        topic.reason = "its messages are in '" + encoding + "', not CDR";
        return;
    }
    topic.decoder = std::make_unique<RosDecoder>(types_, type);
    topic.reason = topic.decoder->reason();
    const auto bad = bad_definitions_.find(ros_type_name(type));
    if (!topic.reason.empty() && bad != bad_definitions_.end()) {
        topic.reason = bad->second;
    }
}

void RosTopics::message(std::size_t id, std::int64_t time, std::string_view cdr) {
    start_ = messages_ == 0 ? time : start_;
    ++messages_;
    const double seconds = seconds_between(start_, time);
    last_ = std::max(last_, seconds);
    const auto found = topics_.find(id);
    if (found == topics_.end()) {
        count_unread(unread_, "topic " + std::to_string(id), "", "the bag does not describe it");
        return;
    }
    Topic& topic = found->second;
    if (!topic.reason.empty()) {
        count_unread(unread_, topic.name, topic.type, topic.reason);
        return;
    }
    if (topic.begun && !topic.wanted) {
        return;
    }
    if (!topic.decoder->decode(cdr, start_, values_)) {
        count_unread(unread_, topic.name, topic.type, "the message is damaged, or is not what its definition says");
        return;
    }
    if (!topic.begun) {
        topic.begun = true;
        topic.wanted = sink_.begin(id, {topic.name, topic.type, topic.decoder->fields()});
        if (!topic.wanted) {
            return;
        }
    }
    sink_.row(id, seconds, values_);
}

void RosTopics::finish(LogEnd& end) const {
    end.clock = "when the bag received a message; `header.stamp` is when its sender stamped it";
    end.start = start_;
    end.unread.insert(end.unread.end(), unread_.begin(), unread_.end());
}

}  // namespace underbody::dynamics
