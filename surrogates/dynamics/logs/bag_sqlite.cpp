// ROS 2 bags in SQLite: tables `topics`, `messages` and, since Iron, `message_definitions` (rosbag2_storage_sqlite3).
#include <SQLiteCpp/SQLiteCpp.h>

#include "core/text.h"
#include "surrogates/dynamics/logs/log_bytes.h"
#include "surrogates/dynamics/logs/ros_message.h"

namespace underbody::dynamics {

namespace {

/// The name of a file as SQLite's URI has it: read as it stands, with no lock and no journal beside it.
std::string as_uri(const std::filesystem::path& path) {
    std::string uri = "file:";
    for (const char c : std::filesystem::absolute(path).string()) {
        if (c == '%' || c == '?' || c == '#') {
            constexpr char digits[] = "0123456789ABCDEF";
            uri += {'%', digits[static_cast<unsigned char>(c) >> 4], digits[c & 15]};
        } else {
            uri += c;
        }
    }
    return uri + "?immutable=1";
}

void read_topics(SQLite::Database& base, RosTopics& topics) {
    if (base.tableExists("message_definitions")) {
        SQLite::Statement rows(base,
                               "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
        while (rows.executeStep()) {
            topics.add_definition(rows.getColumn(0).getString(), rows.getColumn(1).getString(),
                                  rows.getColumn(2).getString());
        }
    }
    SQLite::Statement rows(base, "SELECT id, name, type, serialization_format FROM topics");
    while (rows.executeStep()) {
        topics.add_topic(static_cast<std::size_t>(rows.getColumn(0).getInt64()), rows.getColumn(1).getString(),
                         rows.getColumn(2).getString(), rows.getColumn(3).getString());
    }
}

}  // namespace

LogEnd read_sqlite_bag(const std::filesystem::path& path, LogSink& sink, core::Progress& progress) {
    LogEnd end;
    end.format = "ROS 2 bag, SQLite";
    const std::string name = path.string();
    RosTopics topics(name, sink);
    try {
        SQLite::Database base(as_uri(path), SQLite::OPEN_READONLY | SQLite::OPEN_URI);
        if (!base.tableExists("topics") || !base.tableExists("messages")) {
            throw core::InputError("format", "this SQLite file is no ROS 2 bag: it has no topics and messages",
                                   {name, {}, {}, {}}, "name the .db3 file of a bag");
        }
        read_topics(base, topics);
        SQLite::Statement rows(base, "SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp, id");
        for (std::size_t count = 0; rows.executeStep(); ++count) {
            if (count % 256 == 0) {
                progress.check();
            }
            const SQLite::Column data = rows.getColumn(2);
            topics.message(static_cast<std::size_t>(rows.getColumn(0).getInt64()), rows.getColumn(1).getInt64(),
                           {static_cast<const char*>(data.getBlob()), static_cast<std::size_t>(data.getBytes())});
        }
    } catch (const SQLite::Exception& error) {
        if (topics.messages() == 0) {
            throw core::InputError("damaged", std::string("this bag cannot be read: ") + error.what(),
                                   {name, {}, {}, {}},
                                   "copy it from the vehicle anew; sqlite3 FILE .recover rescues what is left");
        }
        end.problems.push_back({core::Problem::Severity::warning,
                                "the bag is damaged (" + std::string(error.what()) +
                                    "): " + std::to_string(topics.messages()) + " messages were read, up to " +
                                    core::format_number(topics.last(), 6) + " s of the log",
                                core::Place{name, {}, {}, {}}});
    }
    // A recorder that was killed leaves its last messages in a file beside the bag, which is not touched here.
    const std::string beside = name + "-wal";
    std::error_code none;
    if (const auto size = std::filesystem::file_size(beside, none); !none && size > 0) {
        end.problems.push_back(
            {core::Problem::Severity::warning,
             "the messages that the recorder left in " + beside + " (" + std::to_string(size) + " bytes) were not read",
             core::Place{name, {}, {}, {}}});
    }
    topics.finish(end);
    return end;
}

}  // namespace underbody::dynamics
