#include <gtest/gtest.h>

#include "core/file.h"
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
