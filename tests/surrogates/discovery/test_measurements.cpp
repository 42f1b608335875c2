#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/file.h"
#include "core/text.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/taken_as_zero.h"

using namespace underbody;
using namespace underbody::dynamics;

namespace {

class MeasurementFiles : public testing::Test {
protected:
    void write(const std::string& name, const std::string& text) { core::write_file(folder_.path() / name, text); }
    core::InputError failure() {
        try {
            (void)read_measurements(folder_.path());
        } catch (const core::InputError& error) {
            return error;
        }
        ADD_FAILURE() << "nothing was refused";
        return core::InputError("", "");
    }
    core::TemporaryFolder folder_{"measurements"};
};

}  // namespace

TEST_F(MeasurementFiles, AreReadWithUnitsNoiseAndConditionsOfEachRun) {
    write("dataset.toml",
          "kind = \"time_series\"\n[noise]\ngap = \"0.2 mm\"\ntemperature = \"0.1 degC\"\n[conditions]\nspeed = \"0.5 "
          "m/s\"\njet_voltage = \"9 V\"\n"
          "[[run]]\nfile = \"a.csv\"\nconditions.jet_voltage = \"10 V\"\nuse = \"test\"\n[[run]]\nfile = \"b.csv\"\n");
    write("a.csv", "time [s], gap [mm], input_force [mN]\n0, 10, 1\n0.02, 11,\n0.04, , 3\n");
    write("b.csv", "time [s], gap [m]\n0, 1\n0.02, 1.1\n0.05, 1.2\n");
    const Measurements data = read_measurements(folder_.path());
    ASSERT_EQ(data.runs.size(), 2U);
    EXPECT_DOUBLE_EQ(*data.declared_noise("gap"), 2e-4);
    EXPECT_NEAR(*data.declared_noise("temperature"), 0.1, 1e-12);  // a difference, not a point on the scale
    EXPECT_FALSE(data.declared_noise("heave_velocity"));
    EXPECT_EQ(data.runs[0].use, RunUse::test);
    EXPECT_EQ(data.runs[1].use, RunUse::automatic);
    EXPECT_DOUBLE_EQ(data.runs[0].conditions.at("jet_voltage"), 10);
    EXPECT_DOUBLE_EQ(data.runs[1].values("jet_voltage").at(2), 9);
    EXPECT_DOUBLE_EQ(data.runs[0].values("gap").at(0), 0.01);
    EXPECT_TRUE(data.all_have("speed"));
    EXPECT_FALSE(data.all_have("input_force"));
}

TEST_F(MeasurementFiles, TellColumnsThatNobodyReadsAndRefuseARunWhoseInputWouldVanish) {
    write("dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\n");
    for (const char* name : {"force_in [mN]", "inputforce [N]", "Input Force (N) [N]"}) {
        write("a.csv", std::string("time [s], gap [mm], ") + name + "\n0, 10, 1\n0.02, 11, 2\n0.04, 12, 3\n");
        const core::InputError error = failure();
        EXPECT_NE(error.message().find("looks like input_force, which the run lacks: its input would be taken as zero"),
                  std::string::npos)
            << error.what();
        EXPECT_NE(error.hint().find("name it 'input_force ["), std::string::npos) << error.what();
        EXPECT_EQ(error.place().column, 3);
    }
    write("a.csv", "time [s], gap [mm], vz [mm/s], battery [V]\n0, 10, 1, 9\n0.02, 11, 2, 9\n0.04, 12, 3, 9\n");
    write("b.csv", "time [s], gap [mm], vz [mm/s], note\n0, 10, 1, x\n0.02, 11, 2, y\n0.04, 13, 3, z\n");
    write("dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\n[[run]]\nfile = \"b.csv\"\n");
    const Measurements data = read_measurements(folder_.path());
    ASSERT_EQ(data.problems.size(), 2U);
    EXPECT_EQ(
        data.problems[0].message,
        "the column 'vz' is not used: if it is heave_velocity, name it 'heave_velocity [mm/s]' (alike in 1 other run)");
    EXPECT_EQ(data.problems[1].message, "the column 'battery' is not used, for no quantity has that name");
    // With its right name beside it, the other column is just another.
    write("a.csv", "time [s], gap [mm], input_force [N], force_in [mN]\n0, 10, 1, 1\n0.02, 11, 2, 1\n0.04, 12, 3, 1\n");
    EXPECT_EQ(read_measurements(folder_.path()).problems.size(), 2U);
}

TEST_F(MeasurementFiles, NameTheWindowThatNoRowLiesIn) {
    write("a.csv", "time [s], gap [m]\n5, 1\n5.02, 1.1\n5.04, 1.2\n");
    write("dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\nbegin = \"100 s\"\n");
    core::InputError error = failure();
    EXPECT_EQ(error.message(), "no row of the file lies after begin = 100 s: its time goes from 5 to 5.04 s");
    EXPECT_EQ(error.place().line, 4);  // was: "a time series of 0 rows"
    write("dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\nbegin = \"1 s\"\nend = \"2 s\"\n");
    error = failure();
    EXPECT_NE(error.message().find("after begin = 1 s and before end = 2 s: its time goes from 5"), std::string::npos);
    EXPECT_EQ(error.place().line, 5);
}

TEST_F(MeasurementFiles, SayThatNoInputIsRecordedInOneVoiceAndWhatMayBeMeantForIt) {
    const Model model;
    const auto told = [&](const std::string& columns, const std::string& conditions = "") {
        write("dataset.toml", "kind = \"time_series\"\n[conditions]\n" + conditions +
                                  "[[run]]\nfile = \"a.csv\"\n[[run]]\nfile = \"b.csv\"\n");
        write("a.csv", "time [s], gap [m]" + columns + "\n0, 1, 1\n1, 2, 3\n2, 3, 4\n");
        write("b.csv", "time [s], gap [m], input_force [N]\n0, 2, 1\n1, 2, 3\n2, 3, 4\n");
        const core::Problems all = taken_as_zero("heave", model, read_measurements(folder_.path()));
        return all.empty() ? "" : all.front().message;
    };
    EXPECT_EQ(told(", input_force [N]"), "");
    EXPECT_EQ(told(", pitch [deg]", "input_force = 0\n"), "");
    EXPECT_EQ(told(", pitch [deg]"),
              "no input_force is recorded in 1 of 2 runs; none is taken to act. "
              "conditions.input_force = 0 says that nothing pushes");
    for (const char* column : {"lift_force [N]", "jet_voltage [V]", "thrust [N]"}) {
        const std::string name = std::string(column).substr(0, std::string(column).find(' '));
        EXPECT_NE(told(std::string(", ") + column).find("(" + name + " is not taken for it"), std::string::npos);
    }
}

TEST_F(MeasurementFiles, UseARunThatStandsTwiceOnce) {
    const std::string head = "time [s], gap [mm], pitch [deg]\n";
    write("dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\n[[run]]\nfile = \"b.csv\"\n");
    write("a.csv", head + "0, 10, 1\n0.02, 10, 2\n0.04, 10, 3\n");
    write("b.csv", head + "0, 10, 1\n0.02, 10, 2\n0.04, 10, 3\n");
    EXPECT_EQ(read_measurements(folder_.path()).runs.size(), 1U);
    write("b.csv", head + "0, 10, 1\n0.02, 10, 2.5\n0.04, 10, 3\n");
    EXPECT_EQ(read_measurements(folder_.path()).runs.size(), 2U) << "a gap that stands still under another pitch";
}

TEST_F(MeasurementFiles, SayWhereTimeRunsBackwards) {
    write("dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\n");
    write("a.csv", "time [s], gap [m]\n0, 1\n0.02, 1\n0.01, 1\n");
    const core::InputError error = failure();
    EXPECT_NE(error.message().find("runs backwards"), std::string::npos);
    EXPECT_EQ(error.place().line, 4);
    EXPECT_NE(error.hint().find("two runs"), std::string::npos);
}

namespace {

/// Rows of every 20 ms whose times are `clock` of them.
std::string rows_by(const std::function<double(int)>& clock, int count = 60) {
    std::string text = "time [s], gap [mm]\n";
    for (int i = 0; i < count; ++i) {
        text += core::format_number(clock(i)) + ", " + std::to_string(10 + i) + "\n";
    }
    return text;
}

constexpr double in_2025 = 1764337000;  // s since 1970

}  // namespace

TEST_F(MeasurementFiles, CutARunWhereItsClockWasSet) {
    write("dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\nuse = \"test\"\n");
    // GPS sets the clock on from 1970: predict and discover took all memory
    write("a.csv", rows_by([](int i) { return (i < 25 ? 0 : in_2025) + 0.02 * i; }));
    Measurements data = read_measurements(folder_.path());
    ASSERT_EQ(data.runs.size(), 2U);
    EXPECT_EQ(data.runs[1].name, "a piece 2");
    EXPECT_EQ(data.runs[1].use, RunUse::test);
    EXPECT_EQ(data.runs[0].table.rows(), 25U);
    EXPECT_EQ(data.runs[1].values("gap").front(), 35e-3);
    EXPECT_NEAR(data.runs[1].table.numbers("time").front(), 0.5, 1e-6) << "by the usual step";
    EXPECT_NEAR(data.runs[1].clock_offset, in_2025, 1e-6);
    ASSERT_EQ(data.problems.size(), 1U);
    EXPECT_EQ(
        data.problems[0].message,
        "the clock was set on by 55.9 years before this row; its times are counted on from the row before: read as "
        "a run of its own");
    EXPECT_EQ(data.problems[0].place.line, 27);
    // NTP sets it back by a second: it was an error
    write("a.csv", rows_by([](int i) { return 5 + 0.02 * i - (i < 25 ? 0 : 1.013); }));
    data = read_measurements(folder_.path());
    ASSERT_EQ(data.runs.size(), 2U);
    EXPECT_NEAR(data.runs[1].table.numbers("time").front(), 5.5, 1e-9);
    EXPECT_NE(data.problems[0].message.find("set back by 0.993 s"), std::string::npos) << data.problems[0].message;
    // what is too short for a run is left out, and that is said
    write("a.csv", rows_by([](int i) { return (i < 5 ? 0 : in_2025) + 0.02 * i; }));
    data = read_measurements(folder_.path());
    ASSERT_EQ(data.runs.size(), 1U);
    EXPECT_EQ(data.runs[0].name, "a");
    EXPECT_EQ(data.runs[0].table.rows(), 55U);
    EXPECT_NE(data.problems[0].message.find("the 5 rows from here"), std::string::npos) << data.problems[0].message;
    // nothing long enough is left: said, as where times are in disorder
    write("a.csv", rows_by([](int i) { return (i < 5 ? 0 : in_2025) + 0.02 * i; }, 10));
    EXPECT_EQ(failure().message(), "time jumps from 0.08 s to 1764337000.1 s");
    write("a.csv", rows_by([](int i) { return i % 2 == 0 ? i : i - 5; }));
    EXPECT_NE(failure().message().find("runs backwards"), std::string::npos);
}

TEST_F(MeasurementFiles, CutARunWhereItPauses) {
    write("dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\n");
    write("a.csv", rows_by([](int i) { return (i < 25 ? 0 : 3600) + 0.02 * i; }));
    const Measurements data = read_measurements(folder_.path());
    ASSERT_EQ(data.runs.size(), 2U);
    EXPECT_NEAR(data.runs[1].table.numbers("time").front(), 3600.5, 1e-9) << "an hour went by";
    EXPECT_EQ(data.runs[1].clock_offset, 0);
    EXPECT_EQ(data.problems[0].message, "nothing was logged for 3600 s before this row: read as a run of its own");
    // a row a minute is slow and no pause; one of 30 s is bridged
    write("a.csv", rows_by([](int i) { return 60.0 * i; }));
    EXPECT_EQ(read_measurements(folder_.path()).runs.size(), 1U);
    write("a.csv", rows_by([](int i) { return (i < 25 ? 0 : 30) + 0.02 * i; }));
    EXPECT_EQ(read_measurements(folder_.path()).runs.size(), 1U);
}

TEST_F(MeasurementFiles, CountAbsoluteTimesFromTheFirstReading) {
    write("dataset.toml",
          "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\n[[run]]\nfile = \"b.csv\"\n[[run]]\nfile = "
          "\"c.csv\"\n");
    write("a.csv", rows_by([](int i) { return in_2025 + 100.25 + 0.02 * i; }));
    write("b.csv", rows_by([](int i) { return in_2025 + 0.5 + 0.03 * i; }));
    write("c.csv", rows_by([](int i) { return 7 + 0.04 * i; }, 50));
    const Measurements data = read_measurements(folder_.path());
    ASSERT_EQ(data.runs.size(), 3U);
    EXPECT_EQ(data.runs[0].table.numbers("time").front(), 100.25) << "one clock";
    EXPECT_EQ(data.runs[1].table.numbers("time").front(), 0.5);
    EXPECT_EQ(data.runs[1].clock_offset, in_2025);
    EXPECT_EQ(data.runs[2].table.numbers("time").front(), 7);
    ASSERT_EQ(data.problems.size(), 1U);
    EXPECT_EQ(data.problems[0].severity, core::Problem::Severity::note);
    EXPECT_EQ(data.problems[0].message,
              "times are counted from 1764337000 s of the clock of the logs (2025-11-28 13:36:40 UTC if it counts from "
              "1970)");
    // written with too few digits
    write("a.csv", rows_by([](int i) { return in_2025 + std::floor(0.02 * i); }));
    EXPECT_EQ(failure().message(), "time stands still from 1764337000 s to 1764337000 s");
    EXPECT_NE(failure().hint().find("twelve digits"), std::string::npos) << failure().hint();
}

TEST_F(MeasurementFiles, RefuseWhatCannotBeMeant) {
    write("a.csv", "time [s], gap [m]\n0, 1\n0.02, 1\n0.03, 1\n");
    write("dataset.toml", "kind = \"timeseries\"\n[[run]]\nfile = \"a.csv\"\n");
    EXPECT_NE(failure().hint().find("time_series"), std::string::npos);
    write("dataset.toml", "kind = \"time_series\"\n[noise]\ngapp = \"1 mm\"\n[[run]]\nfile = \"a.csv\"\n");
    EXPECT_NE(failure().hint().find("gap"), std::string::npos);
    write("dataset.toml", "kind = \"time_series\"\n[noise]\ngap = \"-1 mm\"\n[[run]]\nfile = \"a.csv\"\n");
    EXPECT_NE(failure().message().find("not positive"), std::string::npos);
    write("dataset.toml", "kind = \"time_series\"\n[[run]]\nfile = \"a.csv\"\n[[run]]\nfile = \"./a.csv\"\n");
    EXPECT_NE(failure().message().find("twice"), std::string::npos);
    write("dataset.toml", "kind = \"time_series\"\n");
    EXPECT_NE(failure().message().find("without a run"), std::string::npos);
    write("dataset.toml", "kind = \"static\"\n[[run]]\nfile = \"a.csv\"\n");
    EXPECT_NE(failure().message().find("force"), std::string::npos);
}
