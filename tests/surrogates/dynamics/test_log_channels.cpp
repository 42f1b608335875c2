// Channels out of logs by dataset.toml: the same run in each format gives the CSV's numbers; what is wrong is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "tests/support/log_writers.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody {
namespace {

using dynamics::Measurements;
using ::testing::HasSubstr;

/// A body of 4 kg in the water on a spring of 8 N/m about 0.1 m, pushed by steps, with 0.2 mm of noise on its gap.
struct Rig {
    std::vector<double> time, gap, push;
    Rig() {
        core::Random random(5);
        double h = 0.13, w = 0;
        constexpr int inner = 10;
        for (int i = 0; i < 600; ++i) {
            const double u = (i / 40) % 2 == 0 ? 0.05 : -0.03;
            time.push_back(0.05 * i);
            gap.push_back(static_cast<double>(static_cast<float>(h + random.normal(0, 2e-4))));
            push.push_back(u);
            for (int k = 0; k < inner; ++k) {
                const double dt = 0.05 / inner, a = (u - 8 * (h - 0.1) - 0.5 * w) / 4;
                w += dt * a;
                h += dt * w;
            }
        }
    }
    static dynamics::Model model() { return dynamics::test::spring_model(8, 4, 0.5, 0); }
    [[nodiscard]] std::vector<test::LoggedSensor> sensors(bool ros) const {
        return {{ros ? "/range" : "RFND", "sensor_msgs/msg/Range", "Dist", time, gap},
                {ros ? "/push" : "PUSH", "std_msgs/msg/Float64", "Force", time, push}};
    }
    [[nodiscard]] std::string csv() const {
        std::string text = "time [s], gap [m], input_force [N]\n";
        for (std::size_t i = 0; i < time.size(); ++i) {
            text += core::format_number(time[i]) + ", " + core::format_number(gap[i]) + ", " +
                    core::format_number(push[i]) + "\n";
        }
        return text;
    }
};

std::string mapping(const std::string& file, const std::string& gap, const std::string& push,
                    const std::string& more = {}) {
    return "kind = \"time_series\"\n[noise]\ngap = \"0.2 mm\"\n[[run]]\nfile = \"" + file +
           "\"\n[log]\nchannel.gap = { " + gap + " }\nchannel.input_force = { " + push + " }\n" + more;
}

class LogChannels : public ::testing::Test {
protected:
    Measurements read(const std::string& dataset) {
        core::write_file(folder_.path() / "dataset.toml", dataset);
        return dynamics::read_measurements(folder_.path());
    }
    std::string refusal(const std::string& dataset) {
        try {
            read(dataset);
        } catch (const core::InputError& error) {
            return error.what();
        }
        return "read without an error";
    }
    void write(const std::string& name, const std::string& bytes) { core::write_file(folder_.path() / name, bytes); }
    core::TemporaryFolder folder_;
    Rig rig_;
};

constexpr const char* plain_gap = R"(message = "RFND", field = "Dist")";
constexpr const char* plain_push = R"(message = "PUSH", field = "Force")";
constexpr const char* ros_gap = R"(message = "/range", field = "range")";
constexpr const char* ros_push = R"(message = "/push", field = "data")";

TEST_F(LogChannels, EveryFormatGivesTheNumbersOfTheCsv) {
    write("run.csv", rig_.csv());
    const Measurements csv = read("kind = \"time_series\"\n[noise]\ngap = \"0.2 mm\"\n[[run]]\nfile = \"run.csv\"\n");
    const auto expected = dynamics::predict(Rig::model(), csv);
    ASSERT_LT(expected.channels[0].in_noise, 1.5) << "the rig is the model";
    write("run.ulg", test::ulog_bytes(rig_.sensors(false)));
    write("run.bin", test::dataflash_bytes(rig_.sensors(false)));
    write("run.log", test::dataflash_text(rig_.sensors(false)));
    write("run.mcap", test::mcap_bytes(rig_.sensors(true), "zstd"));
    std::filesystem::create_directory(folder_.path() / "bag");
    test::write_sqlite_bag(folder_.path() / "bag/bag_0.db3", rig_.sensors(true));
    for (const char* file : {"run.ulg", "run.bin", "run.log", "run.mcap", "bag"}) {
        const bool ros = std::string(file) == "run.mcap" || std::string(file) == "bag";
        const Measurements data = read(mapping(file, ros ? ros_gap : plain_gap, ros ? ros_push : plain_push));
        EXPECT_TRUE(data.problems.empty()) << file;
        const core::Table& table = data.runs[0].table;
        EXPECT_EQ(table.numbers("gap"), rig_.gap) << file;
        EXPECT_EQ(table.numbers("input_force"), rig_.push) << file;
        for (std::size_t i = 0; i < rig_.time.size(); ++i) {
            ASSERT_NEAR(table.numbers("time")[i], rig_.time[i], 1e-9) << file;
        }
        const auto found = dynamics::predict(Rig::model(), data);
        EXPECT_NEAR(found.channels[0].rmse, expected.channels[0].rmse, 1e-9) << file;
        EXPECT_EQ(found.windows, expected.windows) << file;
    }
}

TEST_F(LogChannels, AClockThatIsSetLosesNoReadings) {
    const std::string csv = "kind = \"time_series\"\n[noise]\ngap = \"0.2 mm\"\n[[run]]\nfile = \"run.csv\"\n";
    write("run.csv", rig_.csv());
    const auto plain = dynamics::predict(Rig::model(), read(csv));
    // seconds since 1970: the same numbers, told at the times of the file
    const std::vector<double> time = rig_.time;
    for (double& t : rig_.time) {
        t += 1764337000;
    }
    write("run.csv", rig_.csv());
    const auto absolute = dynamics::predict(Rig::model(), read(csv));
    EXPECT_NEAR(absolute.channels[0].rmse, plain.channels[0].rmse, 1e-9);
    EXPECT_EQ(absolute.table.numbers("time").back(), rig_.time.back());
    // set on from 1970 to now half way (predict took all memory), or back by five seconds (half of the log was lost)
    for (const double step : {1764337000.0, -5.0}) {
        for (std::size_t i = 0; i < time.size(); ++i) {
            rig_.time[i] = time[i] + (i < 300 ? 0 : step);
        }
        write("run.csv", rig_.csv());
        write("run.mcap", test::mcap_bytes(rig_.sensors(true), ""));
        for (const std::string& dataset : {csv, mapping("run.mcap", ros_gap, ros_push)}) {
            const Measurements data = read(dataset);
            ASSERT_EQ(data.runs.size(), 2U);
            EXPECT_EQ(data.runs[0].table.rows() + data.runs[1].table.rows(), 600U);
            const auto found = dynamics::predict(Rig::model(), data);
            EXPECT_LT(found.channels[0].in_noise, 1.5);
            EXPECT_NEAR(found.table.numbers("time").back(), rig_.time.back(), 1e-6);
        }
    }
}

/// A channel that is read every four seconds has no twenty readings by which its own clock could be seen to be set.
TEST_F(LogChannels, AClockThatIsSetBackLosesNoReadingsBesideAChannelThatIsReadSeldom) {
    const std::vector<double> time = rig_.time;
    for (const bool once : {false, true}) {
        std::vector<test::LoggedSensor> sensors = rig_.sensors(true);
        std::vector<double> when, voltage;
        for (std::size_t i = 0; i < time.size(); i += once ? time.size() : 80) {
            when.push_back(time[i] - (i < 300 ? 0 : 5));
            voltage.push_back(static_cast<double>(i) / 80);
        }
        for (test::LoggedSensor& sensor : sensors) {
            for (std::size_t i = 300; i < time.size(); ++i) {
                sensor.time[i] = time[i] - 5;
            }
        }
        sensors.push_back({"/voltage", "std_msgs/msg/Float64", "Volt", when, voltage});
        write("run.mcap", test::mcap_bytes(sensors, ""));
        const Measurements data = read(mapping("run.mcap", ros_gap, ros_push,
                                               "channel.jet_voltage = { message = \"/voltage\", field = \"data\" }\n"));
        ASSERT_EQ(data.runs.size(), 2U) << once;
        EXPECT_EQ(data.runs[0].table.rows(), 300U) << once;
        EXPECT_EQ(data.runs[1].table.rows(), 300U) << once;
        const std::vector<double>& held = data.runs[1].table.numbers("jet_voltage");
        EXPECT_EQ(held.back(), once ? 0 : 7) << once;
        EXPECT_EQ(data.runs[0].table.numbers("jet_voltage").back(), once ? 0 : 3) << once;
        EXPECT_TRUE(std::isfinite(held.front())) << once;
    }
}

TEST_F(LogChannels, ScaleSignUnitAndOffsetGiveTheQuantity) {
    auto sensors = rig_.sensors(false);
    for (std::size_t i = 0; i < rig_.time.size(); ++i) {
        sensors[0].value[i] = -(rig_.gap[i] - 0.012) * 100 / 2;  // cm, downward, half as large, 12 mm too low
    }
    sensors[0].field = "Down";
    write("run.ulg", test::ulog_bytes(sensors));
    const Measurements data = read(
        mapping("run.ulg", R"(message = "RFND", field = "Down", unit = "cm", scale = 2, sign = -1, offset = "12 mm")",
                plain_push));
    for (std::size_t i = 0; i < rig_.time.size(); ++i) {
        ASSERT_NEAR(data.runs[0].table.numbers("gap")[i], rig_.gap[i], 1e-12);
    }
}

TEST_F(LogChannels, ClocksOfTheSenderAreUsedWhereAskedFor) {
    write("run.mcap", test::mcap_bytes(rig_.sensors(true), ""));
    const Measurements data =
        read(mapping("run.mcap", R"(message = "/range", field = "range", clock = "header.stamp")", ros_push));
    EXPECT_NEAR(data.runs[0].table.numbers("time")[0], -0.002, 1e-9) << "stamped 2 ms before it was received";
}

TEST_F(LogChannels, ClocksOfAnotherRateAndBeginAreBroughtTogether) {
    // the range has ticks of 1.0003 ms that began 0.35 s late, the input microseconds
    std::string csv = "tick,range,t_us,force\n";
    for (std::size_t i = 0; i < rig_.time.size(); ++i) {
        csv += core::format_number((rig_.time[i] - 0.35) / 1.0003e-3, 12) + "," + core::format_number(rig_.gap[i]) +
               "," + core::format_number(1e6 * rig_.time[i], 12) + "," + core::format_number(rig_.push[i]) + "\n";
    }
    write("run.csv", csv);
    const Measurements data = read(
        mapping("run.csv",
                R"(field = "range", clock = "tick", clock_unit = "ms", clock_scale = 1.0003, clock_offset = "0.35 s")",
                R"(field = "force", clock = "t_us", clock_unit = "us")"));
    const core::Table& table = data.runs[0].table;
    ASSERT_EQ(table.rows(), rig_.time.size());
    EXPECT_EQ(table.numbers("gap"), rig_.gap);
    for (std::size_t i = 0; i < rig_.time.size(); ++i) {
        ASSERT_NEAR(table.numbers("time")[i], rig_.time[i], 1e-7);
    }
    EXPECT_LT(dynamics::predict(Rig::model(), data).channels[0].in_noise, 1.5);
    EXPECT_THAT(refusal(mapping("run.csv", R"(field = "range", clock = "tick", clock_unit = "mm")", plain_push)),
                HasSubstr("'mm' is no unit of time"));
}

TEST_F(LogChannels, SensorsAtTheirOwnRates) {
    // input at another rate between the readings, fast accelerometer, slow pitch
    test::LoggedSensor push{"PUSH", "", "Force", {}, {}}, fast{"ACC", "", "Z", {}, {}},
        slow{"ATT", "", "Pitch", {}, {}};
    for (int i = 0; i < 3000; ++i) {
        fast.time.push_back(0.01 * i);
        fast.value.push_back(i % 2 == 0 ? 9.9 : 9.7);
    }
    for (int i = 0; i < 60; ++i) {
        slow.time.push_back(0.5 * i);
        slow.value.push_back(i);
        push.time.push_back(0.5 * i + 0.013);
        push.value.push_back(i % 2 == 0 ? 0.1 : 0.2);
    }
    write("run.bin", test::dataflash_bytes({rig_.sensors(false)[0], push, fast, slow}));
    const Measurements data =
        read(mapping("run.bin", plain_gap, plain_push,
                     "channel.heave_acceleration = { message = \"ACC\", field = \"Z\", offset = \"-9.8 m/s^2\" }\n"
                     "channel.pitch = { message = \"ATT\", field = \"Pitch\", unit = \"deg\" }\n"));
    const core::Table& table = data.runs[0].table;
    const auto& time = table.numbers("time");
    EXPECT_EQ(time.size(), 600u + 59u) << "every reading, and every change of the input after the first";
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (time[i] > 1 && time[i] < 28) {
            const int half = static_cast<int>(std::floor((time[i] - 0.013) / 0.5 + 1e-6));
            ASSERT_EQ(table.numbers("input_force")[i], half % 2 == 0 ? 0.1 : 0.2) << time[i];
            ASSERT_NEAR(table.numbers("pitch")[i], time[i] / 0.5 * 3.14159265358979 / 180, 1e-6);
            ASSERT_NEAR(table.numbers("heave_acceleration")[i], 0, 0.11);
            const double after = time[i] - 0.5 * half - 0.013;
            ASSERT_EQ(std::isnan(table.numbers("gap")[i]), std::abs(after) < 1e-6) << time[i];
        }
    }
}

TEST_F(LogChannels, AsynchronousInputsGiveTheSamePrediction) {
    write("run.csv", rig_.csv());
    const auto expected =
        dynamics::predict(Rig::model(), read("kind = \"time_series\"\n[[run]]\nfile = \"run.csv\"\n"));
    auto sensors = rig_.sensors(false);
    test::LoggedSensor& push = sensors[1];
    for (double& t : push.time) {
        t -= t > 0.01 ? 0.0013 : 0;  // what acts is logged a little before the reading
    }
    write("run.bin", test::dataflash_bytes(sensors));
    const auto found = dynamics::predict(Rig::model(), read(mapping("run.bin", plain_gap, plain_push)));
    EXPECT_NEAR(found.channels[0].rmse, expected.channels[0].rmse, 0.05 * expected.channels[0].rmse);
}

TEST_F(LogChannels, PiecesOfALogAreRuns) {
    write("run.ulg", test::ulog_bytes(rig_.sensors(false)));
    std::string text = mapping("run.ulg", plain_gap, plain_push);
    text.insert(text.find("[log]"), "begin = \"2 s\"\nend = \"10 s\"\n[[run]]\nfile = \"run.ulg\"\nbegin = \"10 s\"\n");
    const Measurements data = read(text);
    ASSERT_EQ(data.runs.size(), 2u);
    EXPECT_NEAR(data.runs[0].table.numbers("time").front(), 2, 1e-9);
    EXPECT_NEAR(data.runs[0].table.numbers("time").back(), 10, 1e-9);
    EXPECT_NE(data.runs[0].name, data.runs[1].name);
    text.insert(text.find("[log]"), "[[run]]\nfile = \"run.ulg\"\nbegin = \"9 s\"\n");
    EXPECT_THAT(refusal(text), HasSubstr("named twice"));
}

TEST_F(LogChannels, CsvFilesWithHeadingsOfTheirOwn) {
    std::string text = "t_us,rng_cm,thr\n";
    for (std::size_t i = 0; i < rig_.time.size(); ++i) {
        text += core::format_number(1e6 * rig_.time[i]) + "," + core::format_number(100 * rig_.gap[i]) + "," +
                core::format_number(rig_.push[i]) + "\n";
    }
    write("run.csv", text);
    const std::string dataset = mapping("run.csv", R"(field = "rng_cm", unit = "cm")", R"(field = "thr", unit = "N")",
                                        "clock = \"t_us\"\nclock_unit = \"us\"\n");
    const Measurements data = read(dataset);
    ASSERT_EQ(data.runs[0].table.rows(), rig_.time.size());
    EXPECT_NEAR(data.runs[0].table.numbers("gap")[7], rig_.gap[7], 1e-12);
    EXPECT_NEAR(data.runs[0].table.numbers("time")[7], rig_.time[7], 1e-12);
    write("run.csv", text + "1e9,broken,0\n");
    EXPECT_THAT(refusal(dataset), HasSubstr("'broken' is no number"));
    EXPECT_THAT(refusal(dataset), HasSubstr("run.csv:602"));
}

TEST_F(LogChannels, WhatIsWrongIsSaidWithTheNearestName) {
    write("run.ulg", test::ulog_bytes(rig_.sensors(false)));
    EXPECT_THAT(refusal("kind = \"time_series\"\n[[run]]\nfile = \"run.ulg\"\n"), HasSubstr("[log.channel.gap]"));
    EXPECT_THAT(refusal(mapping("run.ulg", R"(message = "RFNDD", field = "Dist")", plain_push)),
                HasSubstr("did you mean 'RFND'?"));
    EXPECT_THAT(refusal(mapping("run.ulg", R"(message = "RFND", field = "Dst")", plain_push)),
                HasSubstr("did you mean 'Dist'?"));
    EXPECT_THAT(refusal(mapping("run.ulg", R"(message = "RFND", field = "Dist", unit = "s")", plain_push)),
                HasSubstr("is in s, and gap is a quantity in m"));
    EXPECT_THAT(refusal(mapping("run.ulg", R"(message = "RFND", field = "Dist", sign = 2)", plain_push)),
                HasSubstr("sign of gap must be 1 or -1"));
    EXPECT_THAT(refusal(mapping("run.ulg", R"(message = "RFND", field = "Dist", clock = "stamp")", plain_push)),
                HasSubstr("which is asked for as the clock of gap"));
    EXPECT_THAT(refusal(mapping("run.ulg", plain_gap, plain_push, "channel.gapp = { field = \"x\" }\n")),
                HasSubstr("a channel: there is no quantity 'gapp'"));
    EXPECT_THAT(refusal(mapping("run.ulg", R"(mesage = "RFND", field = "Dist")", plain_push)),
                HasSubstr("did you mean 'message'?"));
    auto sensors = rig_.sensors(true);
    sensors[1].type = "acme_msgs/msg/Thrust";
    write("run.mcap", test::mcap_bytes(sensors, "", false));
    EXPECT_THAT(refusal(mapping("run.mcap", ros_gap, ros_push)),
                HasSubstr("(acme_msgs/msg/Thrust), asked for as input_force, cannot be read"));
}

TEST_F(LogChannels, ACutLogIsUsedAndTheCutIsSaid) {
    const std::string bytes = test::ulog_bytes(rig_.sensors(false));
    write("run.ulg", bytes.substr(0, bytes.size() - 7));
    const Measurements data = read(mapping("run.ulg", plain_gap, plain_push));
    ASSERT_FALSE(data.problems.empty());
    EXPECT_THAT(data.problems[0].message, HasSubstr("the log ends within a message"));
}

}  // namespace
}  // namespace underbody
