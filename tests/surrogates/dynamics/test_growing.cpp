// Logs as they grow: CSV in pieces of any size, files that are added to, cut, replaced.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <memory>
#include <thread>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/dynamics/logs/growing.h"

namespace underbody::dynamics {
namespace {

using ::testing::HasSubstr;

/// Bytes in pieces of random size.
class Pieces : public ByteStream {
public:
    Pieces(std::string text, std::uint64_t seed, std::size_t most)
        : text_(std::move(text)), random_(seed), most_(most) {}
    std::size_t read(char* into, std::size_t room) override {
        const std::size_t count = std::min({room, text_.size() - at_, 1 + random_.below(most_)});
        std::copy_n(text_.begin() + static_cast<std::ptrdiff_t>(at_), count, into);
        at_ += count;
        return count;
    }

private:
    std::string text_;
    core::Random random_;
    std::size_t most_, at_ = 0;
};

struct Read {
    std::vector<double> time, value;
    core::Problems problems;
    std::shared_ptr<std::atomic<std::size_t>> count =
        std::make_shared<std::atomic<std::size_t>>(0);  ///< readings so far
};

class KeepingSink : public ChannelSink {
public:
    KeepingSink(const LogChannels& channels, Read& into) : ChannelSink(channels, {}), into_(into) {}
    void reading(std::size_t channel, double time, double value) override {
        into_.time.push_back(time);
        into_.value.push_back(value + 1000 * static_cast<double>(channel));
        *into_.count = into_.time.size();
    }

private:
    Read& into_;
};

Read read(ByteStream& stream) {
    Read out;
    read_csv_stream(
        stream, "run.csv",
        [&](const core::Table& first) { return std::make_unique<KeepingSink>(channels_by_name(first), out); },
        out.problems);
    return out;
}

std::string rows(int count) {
    core::Random random(4);
    std::string text = "# rig 7\n\ntime [ms], gap [mm], pitch [deg]\n";
    for (int i = 0; i < count; ++i) {
        text += std::to_string(50 * i) + ", " + core::format_number(random.uniform(80, 120)) + "," +
                (i % 3 == 0 ? "" : " " + core::format_number(random.uniform(-3, 3))) + "\n";
        text += i % 50 == 7 ? "# a remark\n\n" : "";
    }
    return text;
}

TEST(CsvStream, GivesTheSameInPiecesOfAnySize) {
    Pieces whole(rows(300), 1, 1 << 20);
    const Read expected = read(whole);
    ASSERT_EQ(expected.time.size(), 300u + 200u);
    EXPECT_NEAR(expected.time.back(), 299 * 0.05, 1e-12);
    for (std::uint64_t seed = 1; seed < 40; ++seed) {
        Pieces pieces(rows(300), seed, seed % 2 == 0 ? 7 : 300);
        const Read found = read(pieces);
        EXPECT_EQ(found.time, expected.time) << seed;
        EXPECT_EQ(found.value, expected.value) << seed;
        EXPECT_TRUE(found.problems.empty());
    }
}

std::string refusal(const std::string& text) {
    Pieces pieces(text, 3, 11);
    try {
        read(pieces);
    } catch (const core::InputError& error) {
        return error.what();
    }
    return "read without an error";
}

TEST(CsvStream, ErrorsNameTheLineOfTheFile) {
    EXPECT_THAT(refusal("# a\n# b\ntime [s], gap [m]\n0, 1\n# c\n1, 1\n2, oops\n3, 1\n"), HasSubstr("run.csv:7"));
    EXPECT_THAT(refusal("time [s], gap [m]\n0, 1\n1, 1, 2\n2, 1\n"), HasSubstr("run.csv:3"));
    EXPECT_THAT(refusal("\ntime [s], gap [furlong per]\n0, 1\n"), HasSubstr("run.csv:2"));
    EXPECT_THAT(refusal("time [s], gap [m]\n"), HasSubstr("no rows"));
    EXPECT_THAT(refusal(""), HasSubstr("no rows"));
    EXPECT_THAT(refusal("gap [m]\n1\n"), HasSubstr("time"));
    EXPECT_THAT(refusal(std::string(3 << 20, 'x')), HasSubstr("no CSV"));
}

TEST(CsvStream, ALastLineThatWasCutIsLeftOutAndSaid) {
    Pieces pieces("time [s], gap [m]\n0, 1\n1, 2\n2", 5, 9);
    const Read found = read(pieces);
    EXPECT_EQ(found.time, (std::vector<double>{0, 1}));
    ASSERT_EQ(found.problems.size(), 1u);
    EXPECT_THAT(found.problems[0].message, HasSubstr("the last line has no end"));
    EXPECT_EQ(found.problems[0].place.line, 4);
    Pieces complete("time [s], gap [m]\n0, 1\n1, 2\n2, 3", 5, 9);
    EXPECT_EQ(read(complete).time, (std::vector<double>{0, 1, 2})) << "only its end of line was missing";
}

TEST(CsvStream, GoesOnBehindALineThatIsBrokenOrNotFinite) {
    std::string text = "time [s], gap [mm], input_force [N]\n";
    for (int i = 0; i < 60; ++i) {
        text += i == 7    ? "7, nan, 0.5\n"
                : i == 30 ? "30, 1\n"               // its writer was interrupted
                : i == 31 ? "31, 130 31, 131, 1\n"  // and began in the middle
                : i == 40 ? "40, inf, 1\n"
                : i == 41 ? "nan, 41, 1\n"
                : i == 50 ? "50, no echo, 1\n"
                : i == 51 ? "51, 151, -\n"
                          : std::to_string(i) + ", " + std::to_string(100 + i) + ", 1\n";
    }
    Pieces whole(text, 1, 1 << 20);
    const Read expected = read(whole);
    EXPECT_EQ(std::count_if(expected.value.begin(), expected.value.end(), [](double v) { return v < 500; }), 54);
    EXPECT_EQ(std::count(expected.time.begin(), expected.time.end(), 7), 1) << "the input of the row is used";
    EXPECT_EQ(std::count(expected.time.begin(), expected.time.end(), 31), 0);
    EXPECT_EQ(std::count(expected.time.begin(), expected.time.end(), 50), 1) << "a word in the place of the gap";
    EXPECT_EQ(std::count(expected.time.begin(), expected.time.end(), 51), 1) << "a word in the place of the input";
    ASSERT_GE(expected.problems.size(), 3u);
    EXPECT_EQ(expected.problems[0].place.line, 9);
    EXPECT_THAT(expected.problems[0].message, HasSubstr("no reading"));
    EXPECT_EQ(expected.problems[1].place.line, 32);
    EXPECT_THAT(expected.problems[1].message, HasSubstr("passed over"));
    EXPECT_THAT(expected.problems.back().message, HasSubstr("in all 2 lines were passed over, and fields of 5 lines"));
    for (std::uint64_t seed = 1; seed < 20; ++seed) {
        Pieces pieces(text, seed, 30);
        const Read found = read(pieces);
        EXPECT_EQ(found.value, expected.value) << seed;
        EXPECT_EQ(found.problems.size(), expected.problems.size());
    }
    std::string lost = text;
    for (int i = 0; i < 101; ++i) {
        lost += "oops\n";
    }
    EXPECT_THAT(refusal(lost), HasSubstr("run.csv:162"));
    EXPECT_THAT(refusal("time [s], gap [m]\n0, 1\n1\n2, 1\n"), HasSubstr("run.csv:3")) << "not read well before";
}

TEST(CsvStream, DamagedBytesAreReadOrRefusedAndNothingElse) {
    core::Random random(8);
    int read_through = 0;
    for (int trial = 0; trial < 300; ++trial) {
        std::string text = rows(40);
        for (std::size_t k = 0; k < 1 + random.below(3); ++k) {
            const bool plain = trial % 2 == 0;
            text[random.below(text.size())] =
                plain ? "0123456789,-. \n#"[random.below(16)] : static_cast<char>(random.below(256));
        }
        Pieces pieces(text, 100 + static_cast<std::uint64_t>(trial), 50);
        try {
            EXPECT_LE(read(pieces).time.size(), 70u);
            ++read_through;
        } catch (const core::InputError& error) {
            EXPECT_FALSE(std::string(error.what()).empty());
        }
    }
    EXPECT_GT(read_through, 20);
    EXPECT_LT(read_through, 290);
}

TEST(GrowingStream, WaitsForWhatIsAdded) {
    const core::TemporaryFolder folder;
    const auto file = folder.path() / "run.csv";
    core::write_file(file, "time [s], gap [m]\n0, 1\n1, 2");
    core::Progress progress;
    Read found;
    std::thread writer([&] {
        const auto until_read = [&](std::size_t count) {
            while (*found.count < count) {
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
            }
        };
        until_read(1);
        std::ofstream(file, std::ios::app) << "5\n2, 3\n3,";  // the line that was begun is 1, 25
        until_read(3);
        std::ofstream(file, std::ios::app) << " 4\n";
        until_read(4);
        progress.cancel();
    });
    GrowingStream stream(file.string(), true, progress);
    EXPECT_TRUE(stream.live());
    EXPECT_THROW(
        read_csv_stream(
            stream, "run.csv",
            [&](const core::Table& first) { return std::make_unique<KeepingSink>(channels_by_name(first), found); },
            found.problems),
        core::Cancelled);
    writer.join();
    EXPECT_EQ(found.time, (std::vector<double>{0, 1, 2, 3}));
    EXPECT_EQ(found.value, (std::vector<double>{1, 25, 3, 4}));
}

TEST(GrowingStream, AFileThatIsBegunAnewOrReplacedIsAnError) {
    for (const bool replaced : {true, false}) {
        const core::TemporaryFolder folder;
        const auto file = folder.path() / "run.csv";
        core::write_file(file, rows(10));
        core::Progress progress;
        GrowingStream stream(file.string(), true, progress);
        std::vector<char> block(1 << 16);
        ASSERT_GT(stream.read(block.data(), block.size()), 0u);
        if (replaced) {
            core::write_file(folder.path() / "other.csv", rows(20));
            std::filesystem::rename(folder.path() / "other.csv", file);
        } else {
            std::filesystem::resize_file(file, 5);
        }
        EXPECT_THROW(stream.read(block.data(), block.size()), core::InputError);
    }
}

TEST(GrowingStream, WhatCannotBeOpenedIsSaid) {
    const core::TemporaryFolder folder;
    EXPECT_THROW(GrowingStream((folder.path() / "none.csv").string(), false, core::Progress::none()), core::InputError);
    EXPECT_THROW(GrowingStream(folder.path().string(), false, core::Progress::none()), core::InputError);
}

}  // namespace
}  // namespace underbody::dynamics
