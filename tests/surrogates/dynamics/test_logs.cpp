// Vehicles' logs: each kind is written by the tests' own writers and read back; damage and cuts anywhere; the samples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>

#include "core/file.h"
#include "core/random.h"
#include "surrogates/dynamics/logs/log.h"
#include "surrogates/dynamics/logs/log_bytes.h"
#include "surrogates/dynamics/logs/log_summary.h"
#include "surrogates/dynamics/logs/ros_message.h"
#include "tests/support/log_writers.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

using dynamics::LogEnd;
using dynamics::LogSeries;
using ::testing::HasSubstr;

struct Kept : dynamics::LogSink {
    struct Series {
        LogSeries description;
        std::vector<double> time;
        std::vector<std::vector<double>> rows;
        [[nodiscard]] std::vector<double> column(const std::string& name) const {
            std::vector<double> values;
            for (std::size_t i = 0; i < description.fields.size(); ++i) {
                for (const auto& row : rows) {
                    if (description.fields[i].name == name) {
                        values.push_back(row[i]);
                    }
                }
            }
            return values;
        }
    };
    std::map<std::size_t, Series> all;
    bool begin(std::size_t series, const LogSeries& description) override {
        EXPECT_EQ(all.count(series), 0u);
        all[series].description = description;
        return true;
    }
    void row(std::size_t series, double time, std::span<const double> values) override {
        ASSERT_EQ(values.size(), all.at(series).description.fields.size());
        all[series].time.push_back(time);
        all[series].rows.emplace_back(values.begin(), values.end());
    }
    [[nodiscard]] std::size_t rows() const {
        std::size_t sum = 0;
        for (const auto& [id, series] : all) {
            sum += series.rows.size();
        }
        return sum;
    }
    [[nodiscard]] const Series& named(const std::string& name) const {
        for (const auto& [id, series] : all) {
            if (series.description.name == name) {
                return series;
            }
        }
        throw std::runtime_error("no series " + name);
    }
};

LogEnd read_bytes(const std::string& bytes, dynamics::LogSink& sink) {
    dynamics::MemoryStream stream(bytes);
    return dynamics::read_log(stream, "memory", sink);
}

/// Two sensors at different rates, the second one uneven.
std::vector<test::LoggedSensor> two_sensors(bool ros) {
    test::LoggedSensor gap{ros ? "/range" : "RFND", "sensor_msgs/msg/Range", "Dist", {}, {}};
    test::LoggedSensor push{ros ? "/push" : "PUSH", "std_msgs/msg/Float64", "Force", {}, {}};
    for (int i = 0; i < 300; ++i) {
        gap.time.push_back(0.05 * i);
        gap.value.push_back(static_cast<double>(static_cast<float>(0.1 + 0.01 * std::sin(0.3 * i))));
        if (i % 3 == 0) {
            push.time.push_back(0.05 * i + 0.001 * (i % 7));
            push.value.push_back(0.25 * i);
        }
    }
    return {gap, push};
}

void expect_two_sensors(const Kept& kept, bool ros, const std::string& gap_field, const std::string& push_field) {
    const auto sensors = two_sensors(ros);
    const auto& gap = kept.named(sensors[0].message);
    const auto& push = kept.named(sensors[1].message);
    ASSERT_EQ(gap.time.size(), sensors[0].time.size());
    ASSERT_EQ(push.time.size(), sensors[1].time.size());
    EXPECT_EQ(gap.column(gap_field), sensors[0].value);
    EXPECT_EQ(push.column(push_field), sensors[1].value);
    for (std::size_t i = 0; i < push.time.size(); ++i) {
        EXPECT_NEAR(push.time[i], sensors[1].time[i], 1e-9);
    }
}

TEST(Logs, UlogComesBackAsItWasWritten) {
    Kept kept;
    const LogEnd end = read_bytes(test::ulog_bytes(two_sensors(false)), kept);
    EXPECT_TRUE(end.problems.empty());
    expect_two_sensors(kept, false, "Dist", "Force");
    const auto& gap = kept.named("RFND");
    EXPECT_EQ(gap.column("spare[2]").front(), 2);
    EXPECT_EQ(gap.column("other.x").front(), 3);
    EXPECT_EQ(gap.column("flag").front(), 1);
    EXPECT_NEAR(gap.column("timestamp_sample")[1], 0.049, 1e-12);
    EXPECT_TRUE(gap.column("other.name[0]").empty()) << "text is no number";
}

TEST(Logs, DataflashComesBackAsItWasWrittenWithUnits) {
    for (const bool text : {false, true}) {
        Kept kept;
        const auto sensors = two_sensors(false);
        const LogEnd end = read_bytes(text ? test::dataflash_text(sensors) : test::dataflash_bytes(sensors), kept);
        EXPECT_TRUE(end.problems.empty());
        expect_two_sensors(kept, false, "Dist", "Force");
        EXPECT_NEAR(kept.named("RFND").column("Temp").front(), 18.5, 1e-12) << "hundredths in the binary form";
        if (!text) {
            EXPECT_EQ(kept.named("RFND").description.fields[2].unit, "m");
            EXPECT_EQ(kept.named("PUSH").description.fields[2].unit, "");
        }
    }
}

TEST(Logs, BagsComeBackAsTheyWereWritten) {
    for (const char* compression : {"", "lz4", "zstd"}) {
        for (const bool definitions : {true, false}) {
            Kept kept;
            const LogEnd end = read_bytes(test::mcap_bytes(two_sensors(true), compression, definitions), kept);
            EXPECT_TRUE(end.problems.empty() && end.unread.empty()) << compression;
            expect_two_sensors(kept, true, "range", "data");
            EXPECT_NEAR(kept.named("/range").column("header.stamp")[1], 0.048, 1e-9);
        }
    }
    const core::TemporaryFolder folder;
    test::write_sqlite_bag(folder.path() / "b_0.db3", two_sensors(true));
    for (const auto& path : {folder.path() / "b_0.db3", folder.path()}) {
        Kept kept;
        EXPECT_TRUE(dynamics::read_log(path, kept).problems.empty());
        expect_two_sensors(kept, true, "range", "data");
    }
}

TEST(Logs, EveryRosTypeThatVehiclesLogGivesItsNumber) {
    const std::pair<const char*, const char*> types[] = {{"sensor_msgs/msg/Range", "range"},
                                                         {"sensor_msgs/msg/Imu", "linear_acceleration.z"},
                                                         {"nav_msgs/msg/Odometry", "pose.pose.position.z"},
                                                         {"geometry_msgs/msg/PoseStamped", "pose.position.z"},
                                                         {"std_msgs/msg/Float64", "data"}};
    for (const auto& [type, field] : types) {
        Kept kept;
        read_bytes(test::mcap_bytes({{"/t", type, "", {0, 0.1}, {0.5, -0.25}}}, "", false), kept);
        EXPECT_EQ(kept.named("/t").column(field), (std::vector<double>{0.5, -0.25})) << type;
    }
    Kept kept;
    read_bytes(test::mcap_bytes({{"/imu", "sensor_msgs/msg/Imu", "", {0}, {9.81}}}, "", false), kept);
    EXPECT_EQ(kept.named("/imu").column("orientation.pitch"), std::vector<double>{0});
    EXPECT_EQ(kept.named("/imu").column("angular_velocity.y"), std::vector<double>{0.25});
}

TEST(Logs, AnUnknownTypeIsNamedWithItsReason) {
    auto sensors = two_sensors(true);
    sensors[1].type = "acme_msgs/msg/Thrust";
    Kept kept;
    const LogEnd end = read_bytes(test::mcap_bytes(sensors, "zstd", false), kept);
    EXPECT_EQ(kept.all.size(), 1u);
    ASSERT_EQ(end.unread.size(), 1u);
    EXPECT_EQ(end.unread[0].name, "/push");
    EXPECT_EQ(end.unread[0].type, "acme_msgs/msg/Thrust");
    EXPECT_EQ(end.unread[0].count, 100u);
    EXPECT_THAT(end.unread[0].reason, HasSubstr("the definition of acme_msgs/Thrust is not known"));
}

TEST(Logs, AChunkThatWasChangedIsLeftOutAndSaid) {
    std::string bytes = test::mcap_bytes(two_sensors(true), "");
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] + 1);
    Kept kept;
    const LogEnd end = read_bytes(bytes, kept);
    ASSERT_EQ(end.problems.size(), 1u);
    EXPECT_THAT(end.problems[0].message, HasSubstr("1 chunk with a wrong checksum"));
    EXPECT_GT(kept.rows(), 200u);
}

TEST(Logs, TimesOfADamagedBagThatLieFurtherApartThan64BitsHoldAreStillTimes) {
    constexpr std::int64_t earliest = std::numeric_limits<std::int64_t>::min();
    constexpr std::int64_t latest = std::numeric_limits<std::int64_t>::max();
    Kept kept;
    dynamics::RosTopics topics("bag", kept);
    topics.add_topic(1, "/range", "sensor_msgs/msg/Range", "cdr");
    topics.message(1, earliest, test::cdr_message("sensor_msgs/msg/Range", 0, 0.01));
    topics.message(1, latest, test::cdr_message("sensor_msgs/msg/Range", 2000000000000000000, 0.02));
    const auto& range = kept.named("/range");
    ASSERT_EQ(range.time.size(), 2u);
    EXPECT_EQ(range.time[0], 0);
    EXPECT_DOUBLE_EQ(range.time[1], 18446744073.709551);
    EXPECT_DOUBLE_EQ(range.column("header.stamp")[0], 9223372036.854775);
    EXPECT_DOUBLE_EQ(range.column("header.stamp")[1], 11223372036.854775);
    EXPECT_EQ(dynamics::seconds_between(1700000000000000000, 1700000000000000001), 1e-9);
}

/// All lengths of a log: what was read is the beginning of what there is, and the cut is said.
template <typename Write>
void cut_everywhere(Write&& write) {
    const std::string bytes = write();
    Kept whole;
    read_bytes(bytes, whole);
    core::Random random(7);
    for (int trial = 0; trial < 60; ++trial) {
        Kept part;
        const std::string cut = bytes.substr(0, random.below(bytes.size()));
        try {
            read_bytes(cut, part);
        } catch (const core::InputError& error) {
            EXPECT_FALSE(error.message().empty());
            continue;
        }
        EXPECT_LE(part.rows(), whole.rows());
        for (const auto& [id, series] : part.all) {
            for (std::size_t i = 0; i < series.rows.size(); ++i) {
                ASSERT_EQ(series.time[i], whole.all.at(id).time[i]);
            }
        }
    }
}

TEST(Logs, ACutLogGivesWhatStandsBeforeTheCut) {
    cut_everywhere([] { return test::ulog_bytes(two_sensors(false)); });
    cut_everywhere([] { return test::dataflash_bytes(two_sensors(false)); });
    cut_everywhere([] { return test::mcap_bytes(two_sensors(true), "zstd"); });
    cut_everywhere([] { return test::mcap_bytes(two_sensors(true), "lz4"); });
    Kept kept;
    const std::string bytes = test::ulog_bytes(two_sensors(false));
    const LogEnd end = read_bytes(bytes.substr(0, bytes.size() - 5), kept);
    ASSERT_EQ(end.problems.size(), 1u);
    EXPECT_THAT(end.problems[0].message, HasSubstr("the log ends within a message"));
    const auto cut_at = static_cast<std::size_t>(end.problems[0].place.byte.value());
    EXPECT_THAT(end.problems[0].message,
                HasSubstr("its last " + std::to_string(bytes.size() - 5 - cut_at) + " bytes were left"));
    // A bag that ends within its messages says so too, wherever.
    const std::string bag = test::mcap_bytes(two_sensors(true), "zstd");
    Kept of_bag;
    const LogEnd half = read_bytes(bag.substr(0, bag.size() / 2), of_bag);
    ASSERT_EQ(half.problems.size(), 1u);
    EXPECT_THAT(half.problems[0].message, HasSubstr("bytes were left"));
    EXPECT_THAT(end.problems[0].message, HasSubstr("s of the log"));
}

/// Either everything is there, or it is said (or refused) that it is not.
void expect_said_or_whole(const std::function<LogEnd(Kept&)>& read, std::size_t rows, const std::string& where) {
    Kept kept;
    try {
        const LogEnd end = read(kept);
        EXPECT_TRUE(kept.rows() == rows || !end.problems.empty()) << where << ": " << kept.rows() << " of " << rows;
    } catch (const core::InputError& error) {
        EXPECT_FALSE(error.message().empty()) << where;
    }
}

TEST(Logs, AnMcapBagThatEndsBetweenTwoRecordsSaysSo) {
    const std::string bag = test::mcap_bytes(two_sensors(true), "");
    std::size_t ends = 0;
    std::uint64_t length = 0;
    for (std::size_t at = 8; at + 9 <= bag.size() && bag[at] != 0x02 && bag[at] != 0x0f; at += 9 + length) {
        std::memcpy(&length, bag.data() + at + 1, sizeof length);
        expect_said_or_whole([&](Kept& kept) { return read_bytes(bag.substr(0, at), kept); }, SIZE_MAX,
                             "cut at byte " + std::to_string(at));
        ++ends;
    }
    EXPECT_GT(ends, 3u);
    // The end of data is the last record that counts.
    Kept kept;
    EXPECT_TRUE(read_bytes(bag, kept).problems.empty());
}

TEST(Logs, ASqliteBagThatEndsBetweenTwoPagesSaysSo) {
    const core::TemporaryFolder folder;
    const auto file = folder.path() / "b.db3";
    test::write_sqlite_bag(file, two_sensors(true));
    const std::string bytes = core::read_file(file);
    const std::size_t page = 256 * static_cast<unsigned char>(bytes[16]) + static_cast<unsigned char>(bytes[17]);
    ASSERT_GT(bytes.size() / page, 5u);
    for (std::size_t size = page; size < bytes.size(); size += page) {
        core::write_file(folder.path() / "cut.db3", bytes.substr(0, size));
        expect_said_or_whole([&](Kept& kept) { return dynamics::read_log(folder.path() / "cut.db3", kept); }, 400,
                             "cut at byte " + std::to_string(size));
    }
}

TEST(Logs, MessagesThatAKilledRecorderLeftBesideABagAreMissed) {
    const core::TemporaryFolder folder;
    const auto file = folder.path() / "b.db3";
    test::write_sqlite_bag(file, two_sensors(true));
    core::write_file(folder.path() / "b.db3-wal", std::string(4152, 'x'));
    Kept kept;
    const LogEnd end = dynamics::read_log(file, kept);
    ASSERT_EQ(end.problems.size(), 1u);
    EXPECT_THAT(end.problems[0].message, HasSubstr("b.db3-wal (4152 bytes) were not read"));
    EXPECT_EQ(kept.rows(), 400u);
}

TEST(Logs, FlippedBytesNeverEndBadlyAndLoseLittle) {
    const std::string logs[] = {test::ulog_bytes(two_sensors(false)), test::dataflash_bytes(two_sensors(false)),
                                test::mcap_bytes(two_sensors(true), ""), test::dataflash_text(two_sensors(false))};
    core::Random random(11);
    for (std::size_t l = 0; l < std::size(logs); ++l) {
        for (int trial = 0; trial < 150; ++trial) {
            std::string bytes = logs[l];
            for (int flips = 0; flips < 3; ++flips) {
                bytes[random.below(bytes.size())] = static_cast<char>(random.below(256));
            }
            Kept kept;
            try {
                read_bytes(bytes, kept);
            } catch (const core::InputError&) {
            }
        }
    }
    // a hole of zeros in the middle of a log without chunks: what is behind it is read again
    for (const std::size_t l : {0, 1}) {
        std::string bytes = logs[l];
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), 100, '\0');
        Kept kept;
        const LogEnd end = read_bytes(bytes, kept);
        EXPECT_GT(kept.rows(), 385u) << l;
        ASSERT_EQ(end.problems.size(), 1u);
        EXPECT_THAT(end.problems[0].message, HasSubstr("fit no message and were skipped"));
    }
}

TEST(Logs, SqliteBagsWithDamageAreReadUpToIt) {
    const core::TemporaryFolder folder;
    const auto file = folder.path() / "b.db3";
    test::write_sqlite_bag(file, two_sensors(true));
    const std::string bytes = core::read_file(file);
    core::Random random(3);
    for (int trial = 0; trial < 40; ++trial) {
        std::string bad = trial % 2 == 0 ? bytes.substr(0, random.below(bytes.size())) : bytes;
        for (int flips = 0; trial % 2 == 1 && flips < 20; ++flips) {
            bad[random.below(bad.size())] = static_cast<char>(random.below(256));
        }
        core::write_file(folder.path() / "bad.db3", bad);
        Kept kept;
        try {
            dynamics::read_log(folder.path() / "bad.db3", kept);
        } catch (const core::InputError& error) {
            EXPECT_FALSE(error.message().empty());
        }
    }
}

TEST(Logs, WhatIsNoLogIsSaid) {
    Kept kept;
    try {
        read_bytes("time [s], gap [m]\n0, 1\n", kept);
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("PX4 ULog"));
    }
    EXPECT_EQ(dynamics::log_format(std::string_view("time [s]")), "");
}

TEST(Logs, TheSummarySaysRatesDurationAndGapsInTime) {
    auto sensors = two_sensors(false);
    sensors[0].time.erase(sensors[0].time.begin() + 100, sensors[0].time.begin() + 140);
    sensors[0].value.erase(sensors[0].value.begin() + 100, sensors[0].value.begin() + 140);
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "a.ulg", test::ulog_bytes(sensors));
    const auto summary = dynamics::summarise_log(folder.path() / "a.ulg");
    ASSERT_EQ(summary.series.size(), 2u);
    const auto& gap = summary.series[1];
    EXPECT_EQ(gap.name, "RFND");
    EXPECT_EQ(gap.count, 260u);
    EXPECT_NEAR(gap.rate, 20, 1e-6);
    ASSERT_EQ(gap.silence_count, 1u);
    EXPECT_NEAR(gap.silences[0].from, 4.95, 1e-9);
    EXPECT_NEAR(gap.silences[0].to, 7, 1e-9);
    EXPECT_NEAR(summary.duration, 14.95, 1e-9);
}

std::size_t rows_of(const dynamics::LogSummary& summary) {
    std::size_t rows = 0;
    for (const auto& one : summary.series) {
        rows += one.count;
    }
    return rows;
}

// What the samples hold was counted by other programs' eyes: the numbers of messages and spans of their SQLite tables,
// and for ULog and DataFlash by walking their messages with a script.
TEST(Logs, SampleOfPx4) {
    UNDERBODY_NEEDS_SHARED("samples/logs/sample_log_small.ulg");
    const auto summary = dynamics::summarise_log(test::shared_folder() / "samples/logs/sample_log_small.ulg");
    EXPECT_EQ(summary.end.format, "PX4 ULog");
    EXPECT_EQ(summary.series.size(), 70u);
    EXPECT_EQ(rows_of(summary), 14604u);
    EXPECT_TRUE(std::any_of(summary.end.problems.begin(), summary.end.problems.end(), [](const core::Problem& one) {
        return one.message.find("the logger itself says that it lost data 1 time,") != std::string::npos;
    }));
    EXPECT_TRUE(std::any_of(summary.series.begin(), summary.series.end(),
                            [](const auto& one) { return one.name == "vehicle_attitude" && one.count == 1298; }));
}

TEST(Logs, SampleOfArduSub) {
    UNDERBODY_NEEDS_SHARED("samples/logs/ardusub_small.BIN");
    const auto summary = dynamics::summarise_log(test::shared_folder() / "samples/logs/ardusub_small.BIN");
    EXPECT_EQ(summary.end.format, "ArduPilot DataFlash");
    const auto found =
        std::find_if(summary.series.begin(), summary.series.end(), [](const auto& one) { return one.name == "BARO"; });
    ASSERT_NE(found, summary.series.end());
    EXPECT_EQ(found->count, 237u) << "the other half of 474 is the second barometer, BARO[1]";
    EXPECT_EQ(rows_of(summary), 7158u) << "7510 messages, of which 352 describe the log";
    const auto press = std::find_if(found->fields.begin(), found->fields.end(),
                                    [](const auto& field) { return field.name == "Press"; });
    ASSERT_NE(press, found->fields.end());
    EXPECT_EQ(press->unit, "Pa");
    EXPECT_GT(press->min, 5e4);
}

TEST(Logs, SamplesOfRosBags) {
    UNDERBODY_NEEDS_SHARED("samples/logs/talker.db3");
    const auto folder = test::shared_folder() / "samples/logs";
    for (const char* file : {"talker.db3", "wbag_0.db3", "talker.mcap"}) {
        const auto summary = dynamics::summarise_log(folder / file);
        EXPECT_EQ(rows_of(summary), std::string(file) == "wbag_0.db3" ? 1246u : 20u) << file;
    }
}

}  // namespace
}  // namespace underbody
