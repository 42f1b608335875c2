#include "tests/support/log_writers.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>

namespace underbody::test {

namespace {

template <typename Number>
void put(std::string& to, Number value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    to.append(bytes, sizeof value);
}

std::string padded(std::string text, std::size_t size) {
    text.resize(size, '\0');
    return text;
}

struct Event {
    double time;
    std::size_t sensor, index;
    double order;  ///< s: time, by a clock that is never set back
};

/// All readings of all sensors as they came.
std::vector<Event> in_order(const std::vector<LoggedSensor>& sensors) {
    std::vector<Event> all;
    for (std::size_t s = 0; s < sensors.size(); ++s) {
        const std::vector<double>& time = sensors[s].time;
        double order = time.empty() ? 0 : time.front();
        for (std::size_t i = 0; i < time.size(); ++i) {
            order += i > 0 ? std::max(time[i] - time[i - 1], 0.0) : 0;
            all.push_back({time[i], s, i, order});
        }
    }
    std::stable_sort(all.begin(), all.end(), [](const Event& a, const Event& b) { return a.order < b.order; });
    return all;
}

std::uint64_t microseconds(double time) { return log_start_us + static_cast<std::uint64_t>(std::llround(time * 1e6)); }
std::int64_t nanoseconds(double time) { return 1700000000000000000 + std::llround(time * 1e9); }

/// CDR, little endian: every number at a multiple of its size, counted behind the four bytes of the header.
class CdrWriter {
public:
    CdrWriter() : bytes_("\x00\x01\x00\x00", 4) {}
    template <typename Number>
    CdrWriter& add(Number value) {
        while ((bytes_.size() - 4) % sizeof value != 0) {
            bytes_ += '\0';
        }
        put(bytes_, value);
        return *this;
    }
    CdrWriter& text(const std::string& value) {
        add(static_cast<std::uint32_t>(value.size() + 1));
        bytes_ += value;
        bytes_ += '\0';
        return *this;
    }
    CdrWriter& numbers(std::size_t count, double value = 0) {
        for (std::size_t i = 0; i < count; ++i) {
            add(value);
        }
        return *this;
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
};

std::string definition(const std::string& type) {
    const std::string line = std::string(80, '=') + "\n";
    const std::string header = line + "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + line +
                               "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
    if (type == "sensor_msgs/msg/Range") {
        return "# a comment\nstd_msgs/Header header\nuint8 ULTRASOUND=0\nuint8 radiation_type\nfloat32 field_of_view\n"
               "float32 min_range\nfloat32 max_range\nfloat32 range  # metres\nfloat32 variance\n" +
               header;
    }
    return type == "std_msgs/msg/Float64" ? "float64 data\n" : "";
}

void put_record(std::string& to, char operation, const std::string& content) {
    to += operation;
    put(to, static_cast<std::uint64_t>(content.size()));
    to += content;
}

void put_text(std::string& to, const std::string& text) {
    put(to, static_cast<std::uint32_t>(text.size()));
    to += text;
}

std::string compressed(const std::string& plain, const std::string& by) {
    if (by == "zstd") {
        std::string out(ZSTD_compressBound(plain.size()), '\0');
        out.resize(ZSTD_compress(out.data(), out.size(), plain.data(), plain.size(), 1));
        return out;
    }
    if (by == "lz4") {
        std::string out(LZ4F_compressFrameBound(plain.size(), nullptr), '\0');
        out.resize(LZ4F_compressFrame(out.data(), out.size(), plain.data(), plain.size(), nullptr));
        return out;
    }
    return plain;
}

}  // namespace

std::string cdr_message(const std::string& type, std::int64_t time_ns, double value) {
    CdrWriter cdr;
    static const std::set<std::string> stamped = {"sensor_msgs/msg/Range", "sensor_msgs/msg/Imu",
                                                  "nav_msgs/msg/Odometry", "geometry_msgs/msg/PoseStamped"};
    if (stamped.count(type) == 0) {
        return cdr.add(value).bytes();  // Float64, and types of the tests' own
    }
    cdr.add(static_cast<std::int32_t>(time_ns / 1000000000)).add(static_cast<std::uint32_t>(time_ns % 1000000000));
    cdr.text("base_link");
    if (type == "sensor_msgs/msg/Range") {
        cdr.add(std::uint8_t{0}).add(0.1f).add(0.0f).add(10.0f).add(static_cast<float>(value)).add(0.0f);
    } else if (type == "sensor_msgs/msg/Imu") {
        cdr.numbers(3).add(1.0).numbers(9).numbers(3, 0.25).numbers(9).numbers(2).add(value).numbers(9);
    } else if (type == "nav_msgs/msg/Odometry") {
        cdr.text("body").numbers(2).add(value).numbers(3).add(1.0).numbers(36).numbers(6).numbers(36);
    } else {
        cdr.numbers(2).add(value).numbers(3).add(1.0);
    }
    return cdr.bytes();
}

std::string ulog_bytes(const std::vector<LoggedSensor>& sensors) {
    std::string out("ULog\x01\x12\x35\x01", 8);
    put(out, log_start_us);
    const auto message = [&](char type, const std::string& content) {
        put(out, static_cast<std::uint16_t>(content.size()));
        out += type;
        out += content;
    };
    message('B', std::string(40, '\0'));
    message('I', std::string("\x10") + "char[3] sys_name" + "PX4");
    for (const LoggedSensor& sensor : sensors) {
        message('F', sensor.message + ":uint64_t timestamp;uint64_t timestamp_sample;double " + sensor.field +
                         ";float[3] spare;vec other;uint8_t flag;uint8_t[7] _padding0;");
    }
    message('F', "vec:float x;char[4] name;");
    for (std::size_t s = 0; s < sensors.size(); ++s) {
        std::string content(1, '\0');
        put(content, static_cast<std::uint16_t>(s));
        message('A', content + sensors[s].message);
    }
    for (const Event& event : in_order(sensors)) {
        std::string content;
        put(content, static_cast<std::uint16_t>(event.sensor));
        put(content, microseconds(event.time));
        put(content, microseconds(event.time) - 1000);
        put(content, sensors[event.sensor].value[event.index]);
        for (int i = 0; i < 4; ++i) {
            put(content, static_cast<float>(i));
        }
        content += "name";
        content += '\1';
        message('D', content);
    }
    return out;
}

namespace {

struct DataflashType {
    unsigned char type;
    std::string name, letters, labels;
    std::size_t length;
};

std::vector<DataflashType> dataflash_types(const std::vector<LoggedSensor>& sensors) {
    std::vector<DataflashType> all = {{128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns", 89},
                                      {178, "UNIT", "QbZ", "TimeUS,Id,Label", 3 + 8 + 1 + 64},
                                      {179, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", 3 + 8 + 1 + 32},
                                      {180, "MULT", "Qbd", "TimeUS,Id,Mult", 3 + 8 + 1 + 8}};
    for (std::size_t s = 0; s < sensors.size(); ++s) {
        all.push_back({static_cast<unsigned char>(10 + s), sensors[s].message, "QBdc",
                       "TimeUS,I," + sensors[s].field + ",Temp", 3 + 8 + 1 + 8 + 2});
    }
    return all;
}

}  // namespace

std::string dataflash_bytes(const std::vector<LoggedSensor>& sensors) {
    std::string out;
    const auto begin = [&](unsigned char type) {
        out += "\xa3\x95";
        out += static_cast<char>(type);
    };
    const std::vector<DataflashType> types = dataflash_types(sensors);
    for (const DataflashType& one : types) {
        begin(128);
        out += static_cast<char>(one.type);
        out += static_cast<char>(one.length);
        out += padded(one.name, 4) + padded(one.letters, 16) + padded(one.labels, 64);
    }
    for (const auto& [id, label] :
         {std::pair('s', "s"), std::pair('m', "m"), std::pair('O', "degC"), std::pair('#', "instance")}) {
        begin(178);
        put(out, log_start_us);
        out += id;
        out += padded(label, 64);
    }
    for (const auto& [id, factor] : {std::pair('F', 1e-6), std::pair('B', 1e-2), std::pair('-', 0.0)}) {
        begin(180);
        put(out, log_start_us);
        out += id;
        put(out, factor);
    }
    for (std::size_t s = 0; s < sensors.size(); ++s) {
        begin(179);
        put(out, log_start_us);
        out += static_cast<char>(10 + s);
        out += padded(sensors[s].field == "Dist" ? "s#mO" : "s#-O", 16) + padded("F--B", 16);
    }
    for (const Event& event : in_order(sensors)) {
        begin(static_cast<unsigned char>(10 + event.sensor));
        put(out, microseconds(event.time));
        out += '\0';
        put(out, sensors[event.sensor].value[event.index]);
        put(out, static_cast<std::int16_t>(1850));
    }
    return out;
}

std::string dataflash_text(const std::vector<LoggedSensor>& sensors) {
    std::string out;
    for (const DataflashType& one : dataflash_types(sensors)) {
        out += "FMT, " + std::to_string(one.type) + ", " + std::to_string(one.length) + ", " + one.name + ", " +
               one.letters + ", " + one.labels + "\n";
    }
    char line[160];
    for (const Event& event : in_order(sensors)) {
        std::snprintf(line, sizeof line, "%s, %llu, 0, %.17g, 18.50\n", sensors[event.sensor].message.c_str(),
                      static_cast<unsigned long long>(microseconds(event.time)),
                      sensors[event.sensor].value[event.index]);
        out += line;
    }
    return out;
}

std::string mcap_bytes(const std::vector<LoggedSensor>& sensors, const std::string& compression, bool definitions) {
    const std::string magic("\x89MCAP0\r\n", 8);
    std::string out = magic, head;
    put_text(head, "ros2");
    put_text(head, "tests");
    put_record(out, 1, head);
    std::string described;
    for (std::size_t s = 0; s < sensors.size(); ++s) {
        std::string schema, channel;
        put(schema, static_cast<std::uint16_t>(s + 1));
        put_text(schema, sensors[s].type);
        put_text(schema, "ros2msg");
        put_text(schema, definitions ? definition(sensors[s].type) : "");
        put_record(described, 3, schema);
        put(channel, static_cast<std::uint16_t>(s));
        put(channel, static_cast<std::uint16_t>(s + 1));
        put_text(channel, sensors[s].message);
        put_text(channel, "cdr");
        put(channel, std::uint32_t{0});
        put_record(described, 4, channel);
    }
    std::string records = described;
    const std::vector<Event> events = in_order(sensors);
    for (std::size_t i = 0; i < events.size(); ++i) {
        const Event& event = events[i];
        std::string message;
        put(message, static_cast<std::uint16_t>(event.sensor));
        put(message, static_cast<std::uint32_t>(i));
        put(message, static_cast<std::uint64_t>(nanoseconds(event.time)));
        put(message, static_cast<std::uint64_t>(nanoseconds(event.time)));
        message += cdr_message(sensors[event.sensor].type, nanoseconds(event.time) - 2000000,
                               sensors[event.sensor].value[event.index]);
        put_record(records, 5, message);
        if (records.size() > 8000 || i + 1 == events.size()) {
            const std::string packed = compressed(records, compression);
            std::string chunk;
            put(chunk, std::uint64_t{0});
            put(chunk, std::uint64_t{0});
            put(chunk, static_cast<std::uint64_t>(records.size()));
            put(chunk, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(records.data()),
                                                        static_cast<uInt>(records.size()))));
            put_text(chunk, compression);
            put(chunk, static_cast<std::uint64_t>(packed.size()));
            put_record(out, 6, chunk + packed);
            records.clear();
        }
    }
    put_record(out, 15, std::string(4, '\0'));
    put_record(out, 2, std::string(20, '\0'));
    return out + magic;
}

void write_sqlite_bag(const std::filesystem::path& file, const std::vector<LoggedSensor>& sensors) {
    SQLite::Database base(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    base.exec(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
        "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)");
    base.exec(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
        "data BLOB NOT NULL)");
    SQLite::Transaction all(base);
    for (std::size_t s = 0; s < sensors.size(); ++s) {
        SQLite::Statement topic(base, "INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')");
        topic.bind(1, static_cast<std::int64_t>(s + 1));
        topic.bind(2, sensors[s].message);
        topic.bind(3, sensors[s].type);
        topic.exec();
    }
    SQLite::Statement row(base, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)");
    for (const Event& event : in_order(sensors)) {
        const std::string data = cdr_message(sensors[event.sensor].type, nanoseconds(event.time) - 2000000,
                                             sensors[event.sensor].value[event.index]);
        row.bind(1, static_cast<std::int64_t>(event.sensor + 1));
        row.bind(2, static_cast<std::int64_t>(nanoseconds(event.time)));
        row.bind(3, data.data(), static_cast<int>(data.size()));
        row.exec();
        row.reset();
    }
    all.commit();
}

}  // namespace underbody::test
