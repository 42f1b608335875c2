// underbody watch and info of vehicles' logs, as a user runs them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "core/text.h"
#include "tests/support/support.h"
#include "tests/support/watched_rig.h"

namespace underbody::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// A rig on which a force of 10 mN appears after 200 s.
std::string changed_rig(double seconds) {
    WatchedRig rig(21);
    std::string csv = "time [s], gap [mm], input_force [N]\n";
    while (rig.time < seconds) {
        rig.force = rig.time >= 200 ? -0.01 : 0;
        rig.advance();
        csv += core::format_number(rig.time) + ", " + core::format_number(1e3 * rig.reading) + ", " +
               core::format_number(rig.input) + "\n";
    }
    return csv;
}

constexpr const char* rig_model =
    "[vehicle]\nmass = 4\nnet_weight = 0\n[drag.heave]\nlinear = 0.5\nquadratic = 0\n[[effect]]\nname = "
    "\"tether_stiffness\"\nstiffness = 8\ngap = 0.1\n";

std::vector<json> lines_of(const std::string& output) {
    std::vector<json> all;
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
        all.push_back(json::parse(line));
    }
    return all;
}

TEST(WatchCommand, SaysWhenAndWhatChanged) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml", rig_model);
    core::write_file(folder.path() / "run.csv", changed_rig(400));
    const ProgramRun run = run_underbody({"watch", "model.toml", "run.csv", "--json"}, folder.path());
    EXPECT_EQ(run.exit_code, 4) << run.errors;
    const std::vector<json> events = lines_of(run.output);
    ASSERT_GE(events.size(), 4u) << run.output;
    EXPECT_EQ(events[0]["event"], "learned");
    EXPECT_NEAR(events[0]["gap_noise"].get<double>(), 2e-4, 5e-5);
    EXPECT_EQ(events[1]["event"], "alarm");
    EXPECT_GT(events[1]["time"].get<double>(), 200);
    EXPECT_LT(events[1]["time"].get<double>(), 260);
    EXPECT_THAT(events[1]["shows"].get<std::string>(), HasSubstr("a constant force, down"));
    EXPECT_EQ(events[2]["event"], "cause");
    EXPECT_EQ(events[2]["verdict"], "effect") << events[2].dump();
    EXPECT_EQ(events.back()["event"], "end");
}

/// On a spring a force that grows and a sensor that drifts are one: both are said. The numbers found within a minute
/// are found anew when they miss; the watch sees no less for it (one alarm in half an hour before, then judged every
/// 400 s).
TEST(WatchCommand, AForceThatGrowsIsTiedWithADriftAndFoundAnewAsItGoesOn) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml", rig_model);
    WatchedRig rig(21);
    std::string csv = "time [s], gap [m], input_force [N]\n";
    constexpr double change = 200, second = 700;
    while (rig.time < 780) {
        rig.force = (rig.time > change ? 2e-5 * (rig.time - change) : 0) - (rig.time > second ? 0.01 : 0);
        rig.advance();
        csv += core::format_number(rig.time, 9) + ", " + core::format_number(rig.reading, 9) + ", " +
               core::format_number(rig.input, 9) + "\n";
    }
    core::write_file(folder.path() / "run.csv", csv);
    const ProgramRun run = run_underbody({"watch", "model.toml", "run.csv", "--json"}, folder.path());
    EXPECT_EQ(run.exit_code, 4) << run.errors;
    std::vector<json> causes, alarms;
    for (const json& event : lines_of(run.output)) {
        (event["event"] == "cause" ? causes : alarms).push_back(event);
    }
    std::erase_if(alarms, [](const json& event) { return event["event"] != "alarm"; });
    ASSERT_GE(causes.size(), 2u) << run.output;
    const std::string said = causes.front()["sentence"];
    EXPECT_THAT(said, HasSubstr("growing_force"));
    EXPECT_THAT(said, HasSubstr("gap_sensor_drift"));
    EXPECT_THAT(said, HasSubstr("cannot well tell it from"));
    EXPECT_EQ(causes.front()["goes_on_with"], "model as found");
    EXPECT_TRUE(std::any_of(alarms.begin(), alarms.end(),
                            [&](const json& event) { return event["time"] > second && event["time"] < second + 60; }))
        << "what comes after is seen as well as before: " << run.output;
}

/// A free body whose sensor drifts moves as under a force: one alarm, and silence with the model as found. (There was
/// another alarm about every minute, told at "1.7643371e+09 s".)
TEST(WatchCommand, ADriftOfAFreeBodyIsSaidOnceByAClockThatCountsFrom1970) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml",
                     "[vehicle]\nmass = 4\nnet_weight = 0\n[drag.heave]\nlinear = 0.5\nquadratic = 0\n");
    WatchedRig rig(23);
    rig.spring = 0;
    std::string csv = "time [s], gap [m], input_force [N]\n";
    constexpr double change = 200, set_back = 600;
    while (rig.time < 900) {
        rig.bias = rig.time > change ? 1e-3 * (rig.time - change) : 0;
        rig.advance();
        csv += core::format_number(1764337000 + rig.time - (rig.time > set_back ? 100 : 0), 13) + ", " +
               core::format_number(rig.reading, 9) + ", " + core::format_number(rig.input, 9) + "\n";
    }
    core::write_file(folder.path() / "run.csv", csv);
    const ProgramRun run = run_underbody({"watch", "model.toml", "run.csv"}, folder.path());
    EXPECT_EQ(run.exit_code, 4) << run.errors;
    EXPECT_THAT(run.output, HasSubstr("\n17643372"));
    EXPECT_THAT(run.output, HasSubstr("; 1 alarm"));
    EXPECT_THAT(run.output, HasSubstr("goes on with the model as found"));
}

TEST(WatchCommand, IsSilentWhileNothingChanges) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml", rig_model);
    core::write_file(folder.path() / "run.csv", changed_rig(199));
    const ProgramRun run = run_underbody({"watch", "model.toml", "run.csv"}, folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.output << run.errors;
    EXPECT_THAT(run.output, HasSubstr("nothing changed: the gap followed the model"));
}

TEST(WatchCommand, GoesOnBehindBrokenLinesAndSaysThem) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml", rig_model);
    std::string csv = changed_rig(120);
    const std::size_t middle = csv.find('\n', csv.size() / 2) + 1;
    csv.insert(middle, "60.0, 10\n60.001, nan,\n");
    core::write_file(folder.path() / "run.csv", csv);
    const ProgramRun run = run_underbody({"watch", "model.toml", "run.csv"}, folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.output << run.errors;
    EXPECT_THAT(run.errors, HasSubstr("passed over: this line has 2 fields, the header 3"));
    EXPECT_THAT(run.errors, HasSubstr("no reading"));
    EXPECT_THAT(run.output, HasSubstr("predict and discover); 2 warnings about the log"));
}

TEST(WatchCommand, ReadsHeadingsByADatasetAndNamesBadLines) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml", rig_model);
    core::write_file(folder.path() / "dataset.toml",
                     "kind = \"time_series\"\n[log]\nclock = \"t_ms\"\nclock_unit = \"ms\"\nchannel.gap = { field = "
                     "\"rng\", unit = \"mm\" }\n");
    core::write_file(folder.path() / "run.csv", "# rig 7\nt_ms,rng\n0,100\n50,100.1\n100,oops\n");
    const ProgramRun run =
        run_underbody({"watch", "model.toml", "run.csv", "--data", "dataset.toml", "--json"}, folder.path());
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_THAT(run.errors, HasSubstr("run.csv:5"));
    EXPECT_THAT(run.errors, HasSubstr("'oops' is no number"));
}

/// Runs a line of the shell with $UNDERBODY in it.
ProgramRun run_shell(const std::string& line, const std::filesystem::path& folder) {
    return run_program("/bin/sh", {"-c", line}, folder, {{"UNDERBODY", (program_folder() / "underbody").string()}});
}

TEST(WatchCommand, ReadsAPipeAndGoesOnWhileItLooksForWhatChanged) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml", rig_model);
    const std::string csv = changed_rig(500);
    core::write_file(folder.path() / "run.csv", csv);
    const ProgramRun run = run_shell("cat run.csv | \"$UNDERBODY\" watch model.toml --json", folder.path());
    EXPECT_EQ(run.exit_code, 4) << run.errors;
    const std::vector<json> events = lines_of(run.output);
    std::vector<std::string> names;
    for (const json& event : events) {
        names.push_back(event["event"]);
    }
    EXPECT_THAT(names, ::testing::IsSupersetOf({"learned", "alarm", "searching", "cause", "end"}));
    EXPECT_EQ(names.back(), "end");
    EXPECT_EQ(events.back()["readings"], std::count(csv.begin(), csv.end(), '\n') - 1);
    EXPECT_NEAR(events.back()["time"].get<double>(), 500, 0.1) << "nothing is lost meanwhile";
}

TEST(WatchCommand, CtrlCEndsItWithASummary) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml", rig_model);
    const std::string csv = changed_rig(150);
    core::write_file(folder.path() / "run.csv", csv + "150.1, 10");  // the last line is still being written
    const auto rows = std::count(csv.begin(), csv.end(), '\n') - 1;
    const ProgramRun run = run_shell(
        "\"$UNDERBODY\" watch model.toml run.csv --follow > said.txt & until grep -q watching said.txt; do sleep 0.1; "
        "done; "
        "sleep 2; kill -INT $!; wait $!; code=$?; "
        "cat said.txt; exit $code",
        folder.path());
    EXPECT_EQ(run.exit_code, 130) << run.errors;
    EXPECT_THAT(run.output, HasSubstr("watching, noise of the gap"));
    EXPECT_THAT(run.output, HasSubstr("ended by you; " + std::to_string(rows) + " readings"));
    EXPECT_THAT(run.output, HasSubstr("nothing changed: the gap followed the model"));
}

// A log in mm was watched, with a noise of 4.9 m and a force of 230 N; a sensor that stood still was a force, looked
// for.
TEST(WatchCommand, SaysOfALogThatItIsNotTheModelsAndOfASensorThatItStandsStill) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml", rig_model);
    std::string csv = changed_rig(90);
    csv.replace(csv.find("[mm]"), 4, "[m]");
    core::write_file(folder.path() / "run.csv", csv);
    const ProgramRun in_mm = run_underbody({"watch", "model.toml", "run.csv"}, folder.path());
    EXPECT_EQ(in_mm.exit_code, 3) << in_mm.output;
    EXPECT_THAT(in_mm.errors, HasSubstr("this log is not the model's"));
    EXPECT_THAT(in_mm.errors, HasSubstr("is the column's unit mm, and was it read in m?"));

    WatchedRig rig(21);
    csv = "time [s], gap [m], input_force [N]\n";
    double stuck = 0;
    while (rig.time < 400) {
        rig.advance();
        stuck = rig.time < 200 ? rig.reading : stuck;
        csv += core::format_number(rig.time) + ", " + core::format_number(stuck, 9) + ", " +
               core::format_number(rig.input) + "\n";
    }
    core::write_file(folder.path() / "run.csv", csv);
    const ProgramRun still = run_underbody({"watch", "model.toml", "run.csv", "--json"}, folder.path());
    EXPECT_EQ(still.exit_code, 4) << still.errors;
    const std::vector<json> events = lines_of(still.output);
    ASSERT_EQ(events.size(), 3U) << still.output;
    EXPECT_EQ(events[1]["event"], "alarm");
    EXPECT_EQ(events[1]["sensor"], true);
    EXPECT_LT(events[1]["time"].get<double>(), 201);
    EXPECT_THAT(events[1]["shows"].get<std::string>(), HasSubstr("the gap stands still at"));
    EXPECT_EQ(events[2]["alarms"], 1);
}

TEST(WatchCommand, NeedsAGap) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml", rig_model);
    core::write_file(folder.path() / "run.csv", "time [s], depth [m]\n0, 1\n1, 1\n");
    const ProgramRun run = run_underbody({"watch", "model.toml", "run.csv"}, folder.path());
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_THAT(run.errors, HasSubstr("nothing says which number is the gap"));
}

// A vehicle that its jets hold up: without their thrusts each of them would be an alarm.
TEST(WatchCommand, RefusesRunsThatJetsDrive) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "model.toml", rig_model);
    core::write_file(folder.path() / "run.csv",
                     "time [s], gap [m], pitch [rad], thrust_up [N]\n0, 1, 0, 1\n1, 1, 0, 1\n");
    core::write_file(folder.path() / "dataset.toml",
                     "kind = \"time_series\"\nmotion = \"body\"\n[[run]]\nfile = \"run.csv\"\n");
    const ProgramRun run = run_underbody({"watch", "model.toml", "run.csv", "--data", "dataset.toml"}, folder.path());
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_THAT(run.errors, HasSubstr("motion = \"body\", driven by jets"));
    EXPECT_THAT(run.errors, HasSubstr("discover and predict follow them"));
}

TEST(InfoOfLogs, ListsMessagesOfTheSamples) {
    UNDERBODY_NEEDS_SHARED("samples/logs/ardusub_small.BIN");
    const std::string file = (shared_folder() / "samples/logs/ardusub_small.BIN").string();
    const ProgramRun run = run_underbody({"info", file, "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const json info = json::parse(run.output);
    EXPECT_EQ(info["format"], "ArduPilot DataFlash");
    EXPECT_GT(info["messages"].size(), 20u);
    EXPECT_THAT(run_underbody({"info", file}).output, HasSubstr("BARO.Press"));
}

}  // namespace
}  // namespace underbody::test
