// `underbody study` as a user meets it: first run, second run, wrong input, and what a crash may not do.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

class StudyCommand : public testing::Test {
protected:
    core::TemporaryFolder scratch;
    fs::path study = scratch.path() / "cube";
    void SetUp() override { write_small_study(study); }
    ProgramRun run(std::vector<std::string> more = {}) {
        std::vector<std::string> arguments = {"study", "run", study.string(), "--no-pictures", "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_underbody(arguments);
    }
};

TEST_F(StudyCommand, WarnsOfGapsThatTheFilesContradictAndOfCopies) {
    fs::copy_file(study / "fields/cube-h6.csv", study / "fields/cube-h9.csv");
    const json copied = json::parse(run().output);
    std::string all = copied.at("warnings").dump();
    EXPECT_THAT(all, HasSubstr("the gap is declared as 9 mm, but in the file the body (centre of the base (zone "
                               "'base')) lies 6 mm over"));
    EXPECT_THAT(all, HasSubstr("have the same loads to the last digit although their conditions differ (gap)"));
    EXPECT_THAT(all, testing::Not(HasSubstr("declared as 6 mm")));
    fs::remove(study / "fields/cube-h9.csv");
    EXPECT_TRUE(json::parse(run().output).at("warnings").empty());
    std::string text = core::read_file(study / "study.toml");
    text.replace(text.find("{gap:mm}"), 8, "{gap:m}");
    core::write_file(study / "study.toml", text);
    const ProgramRun metres = run_underbody({"study", "run", study.string(), "--no-pictures"});
    EXPECT_THAT(metres.output, HasSubstr("declared as 1 m"));
    EXPECT_THAT(metres.output, HasSubstr("is it in mm, and was read in m?"));
}

TEST_F(StudyCommand, WarnsOfPitchesAndSpeedsThatTheFilesContradict) {
    const fs::path tilted = scratch.path() / "tilted";
    for (const auto& [from, to] : {std::pair{"0", "0"}, {"1", "1"}, {"-1", "-1"}, {"2", "-2"}, {"-2", "2"}}) {
        fs::create_directories(tilted / "fields");
        fs::copy_file(test::source_folder() / "cases/evie/fields" / (std::string("ellipse-h10-p") + from + ".csv"),
                      tilted / "fields" / (std::string("ellipse-h10-p") + to + ".csv"));
    }
    const auto warnings = [&](const std::string& unit, const std::string& speed) {
        core::write_file(tilted / "study.toml",
                         "title = \"t\"\n[frame]\nsymmetry = \"y\"\n[reference]\ndensity = 998\n" +
                             ("[[case]]\nfiles = \"fields/{variant}-h{gap:mm}-p{pitch:" + unit) +
                             "}.csv\"\nconditions.speed = \"" + speed + "\"\n");
        const ProgramRun all = run_underbody({"study", "run", tilted.string(), "--no-pictures", "--json"});
        EXPECT_EQ(all.exit_code, 0) << all.errors;
        return json::parse(all.output).at("warnings").dump();
    };
    const std::string exchanged = warnings("deg", "0.5 m/s"), turned = "but in the file the base is pitched by ";
    EXPECT_THAT(exchanged, HasSubstr("declared as 2 deg, " + turned + "-2 deg"));
    EXPECT_THAT(exchanged, HasSubstr("declared as -2 deg, " + turned + "2 deg"));
    EXPECT_THAT(exchanged, testing::Not(HasSubstr("declared as 1 deg")));
    EXPECT_THAT(exchanged, testing::Not(HasSubstr("1/2 rho U^2")));
    EXPECT_THAT(warnings("rad", "0.5 m/s"), HasSubstr("is it in deg, and was read in rad?"));
    EXPECT_THAT(warnings("deg", "0.5 km/h"), HasSubstr("is the speed in m/s, and was read in km/h?"));
    EXPECT_THAT(warnings("deg", "5 m/s"), HasSubstr("1/2 rho U^2"));
}

TEST_F(StudyCommand, VerifySaysWhatTheScatterOfTheRunExcuses) {
    core::write_file(study / "forces.csv",
                     "gap [mm], lift_force [N], lift_force_scatter [N], drag_force [N]\n1, 0.6, 0, 0\n2, 0.5, 0, 0\n"
                     "3, 0.38, 0.02, 0\n4, 0.3, 0, 0\n");
    const ProgramRun shown = run_underbody({"study", "verify", study.string()});
    EXPECT_EQ(shown.exit_code, 0) << shown.errors;
    EXPECT_THAT(shown.output, HasSubstr("0 beyond it; 1 more off by up to 5 % of the force's size, excused by what "
                                        "their own run swings by"));
    const json verified = json::parse(run_underbody({"study", "verify", study.string(), "--json"}).output).at("solver");
    EXPECT_EQ(verified.at("excused"), 1);
    EXPECT_NEAR(verified.at("excused_worst").get<double>(), 0.02 / 0.4, 1e-6);
}

TEST_F(StudyCommand, TurnsFieldsIntoLoadsTableEquilibriaMapExportAndReport) {
    const ProgramRun first = run();
    ASSERT_EQ(first.exit_code, 0) << first.errors;
    const json results = json::parse(first.output);
    EXPECT_EQ(results.at("failed"), 0);
    EXPECT_EQ(results.at("reused"), 0);
    // The lift of a linear pressure on a cube: gradient times volume.
    EXPECT_NEAR(results.at("results").at("loads/cube-h2").at("lift_force").get<double>(), 0.5, 1e-9);
    const json equilibria = results.at("results").at("table/lift").at("equilibria");
    ASSERT_EQ(equilibria.size(), 1U);
    EXPECT_NEAR(equilibria[0].at("gap").get<double>(), 0.0035, 1e-9);
    EXPECT_TRUE(equilibria[0].at("stable").get<bool>());
    EXPECT_NEAR(equilibria[0].at("stiffness").get<double>(), 100, 1e-6);
    // A linear spring: sqrt(k/m)/2 pi = sqrt(100/4)/2 pi.
    EXPECT_NEAR(equilibria[0].at("frequency").get<double>(), 5 / (2 * 3.14159265358979), 1e-6);
    double total = 0;
    for (const auto& entry : results.at("results").at("region/map").at("classes")) {
        total += entry.at("fraction").get<double>();
    }
    EXPECT_NEAR(total, 1, 1e-9);
    EXPECT_EQ(results.at("results").at("verify/solver").at("failed"), 0);
    const std::string report = core::read_file(study / "report" / "index.html");
    EXPECT_THAT(report, HasSubstr("a cube"));
    EXPECT_THAT(report, HasSubstr("data:image/png;base64,"));
    EXPECT_TRUE(fs::exists(study / "report" / "exports" / "lift.h"));
    EXPECT_TRUE(fs::exists(study / "report" / "models" / "map" / "model.toml"));
}

TEST_F(StudyCommand, ReportShowsFilmTheoryBesideTheCfdAndLoadsSortedWithTheirConditions) {
    core::write_file(study / "shape.toml",
                     "[body]\nlength='203.2 mm'\nwidth='152 mm'\nheight='145 mm'\nbase_cut=0.75\n");
    core::write_file(study / "fields" / "cube-h10.csv", cube_field(0.010, 290));
    core::write_file(study / "study.toml",
                     core::read_file(study / "study.toml") + "[[body]]\nname = \"cube\"\nshape = \"shape.toml\"\n");
    ASSERT_EQ(run().exit_code, 0);
    const std::string report = core::read_file(study / "report" / "index.html");
    EXPECT_THAT(report, HasSubstr("squeeze damping (N s/m)"));
    // 12 mu G/h^3 of the elliptic base (half axes 67.2 and 50.3 mm) at the 3.5 mm where the lift holds the weight.
    const double a = 0.1016 * std::sqrt(1 - 0.75 * 0.75), b = 0.076 * std::sqrt(1 - 0.75 * 0.75), pi = 3.14159265358979;
    const auto film = run_underbody(
        {"theory", "squeeze",
         "half_length=" + core::format_number(a, 12) + ",half_width=" + core::format_number(b, 12) + ",gap=3.5mm",
         "--json"});
    const double damping = json::parse(film.output).at("values").at("damping").get<double>();
    EXPECT_NEAR(damping, 12e-3 * pi * std::pow(a * b, 3) / (4 * (a * a + b * b)) / std::pow(3.5e-3, 3), 1e-9);
    EXPECT_THAT(report, HasSubstr(core::format_number(damping, 3)));
    const std::size_t loads = report.find("Loads of all cases</h2>");
    ASSERT_NE(loads, std::string::npos);
    const std::string rows = report.substr(loads);
    EXPECT_THAT(rows, HasSubstr("variant"));
    EXPECT_LT(rows.find("cube-h6"), rows.find("cube-h10")) << "by the number, not by its digits";
    EXPECT_THAT(rows, testing::Not(HasSubstr("e-1"))) << "rounding is no opening";
}

TEST_F(StudyCommand, AddRefusesAMistypedConditionAndSaysWhatItLeavesOut) {
    const std::string before = core::read_file(study / "study.toml");
    fs::create_directories(study / "more");
    for (const char* name : {"box-h1.csv", "box-h2mm.csv"}) {
        core::write_file(study / "more" / name, cube_field(0.001, 300));
    }
    const auto typo = run_underbody(
        {"study", "add", "cube", "--files", "more/{variant}-h{gap:mm}.csv", "--condition", "sped=0.5"}, scratch.path());
    EXPECT_EQ(typo.exit_code, 2) << typo.errors;
    EXPECT_THAT(typo.errors, HasSubstr("did you mean 'speed'?"));
    EXPECT_THAT(typo.errors, HasSubstr("nothing was added to cube/study.toml\n"));
    EXPECT_THAT(typo.errors, testing::Not(HasSubstr("underbody-"))) << "no name of a temporary file";
    EXPECT_EQ(core::read_file(study / "study.toml"), before);
    const auto none = run_underbody({"study", "add", study.string(), "--files", "more/{variant}-hh{gap:mm}.csv"});
    EXPECT_EQ(none.exit_code, 3);
    EXPECT_THAT(none.errors, testing::AllOf(HasSubstr("no file fits"), HasSubstr("nothing was added"),
                                            testing::Not(HasSubstr("study.toml:"))));
    const auto added = run_underbody(
        {"study", "add", study.string(), "--files", "more/{variant}-h{gap:mm}.csv", "--condition", "speed=0.5"});
    ASSERT_EQ(added.exit_code, 0) << added.errors;
    EXPECT_THAT(added.output, testing::AllOf(HasSubstr("1 case added"), HasSubstr("1 file is left out"),
                                             HasSubstr("box-h2mm.csv: '2mm' carries its unit: write {gap:mm}mm")));
}

TEST_F(StudyCommand, OneCaseIsCountedInTheSingular) {
    const fs::path one = scratch.path() / "one";
    fs::create_directories(one);
    core::write_file(one / "cube-h3.csv", cube_field(0.003, 400));
    ASSERT_EQ(run_underbody({"study", "add", one.string(), "--files", "cube-h{gap:mm}.csv"}).exit_code, 0);
    EXPECT_THAT(run_underbody({"study", "list", one.string()}).output, HasSubstr(": 1 case\n"));
    const auto ran = run_underbody({"study", "run", one.string(), "--no-pictures"});
    EXPECT_THAT(ran.output, HasSubstr("1 result computed, 0 unchanged")) << ran.errors;
}

TEST_F(StudyCommand, RecomputesNothingWhenNothingChangedAndOnlyWhatChangedOtherwise) {
    ASSERT_EQ(run().exit_code, 0);
    const auto report_time = fs::last_write_time(study / "report" / "index.html");
    const json again = json::parse(run().output);
    EXPECT_EQ(again.at("computed"), 0);
    EXPECT_EQ(fs::last_write_time(study / "report" / "index.html"), report_time)
        << "an unchanged report is not written again";
    core::write_file(study / "fields" / "cube-h4.csv", cube_field(0.004, 310));
    const json changed = json::parse(run().output);
    std::vector<std::string> loads;
    for (const auto& step : changed.at("steps")) {
        if (step.at("kind") == "loads" && !step.at("reused").get<bool>()) {
            loads.push_back(step.at("name"));
        }
    }
    EXPECT_THAT(loads, testing::ElementsAre("cube-h4"));
}

TEST_F(StudyCommand, AWrongFileFailsAloneAndIsNamedWithItsLine) {
    core::write_file(study / "fields" / "cube-h3.csv",
                     core::read_file(study / "fields" / "cube-h3.csv") + "0, 1, 99\n");
    const ProgramRun result = run();
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.errors, HasSubstr("cube-h3.csv:"));
    const json results = json::parse(result.output);
    EXPECT_EQ(results.at("failed").get<int>(), 1);
    EXPECT_TRUE(results.at("results").contains("table/lift")) << "the other cases go on";
    EXPECT_THAT(core::read_file(study / "report" / "index.html"), HasSubstr("Not done"));
}

TEST_F(StudyCommand, VerifyEndsWithFourWhenTheSolverDisagrees) {
    EXPECT_EQ(run_underbody({"study", "verify", study.string()}).exit_code, 0);
    core::write_file(study / "forces.csv", "gap [mm], lift_force [N], drag_force [N]\n1, 0.7, 0\n");
    const ProgramRun result = run_underbody({"study", "verify", study.string()});
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_THAT(result.output, HasSubstr("cube-h1"));
    const ProgramRun whole = run_underbody({"study", "run", study.string(), "--no-pictures"});
    EXPECT_THAT(whole.output, HasSubstr("check 'solver': 1 of 2 values lies beyond its tolerance"));
    const json warnings = json::parse(run().output).at("warnings");
    EXPECT_THAT(warnings.dump(), HasSubstr("check 'solver': 1 of 2 values lies beyond its tolerance"));
}

TEST_F(StudyCommand, AReadOnlyFolderIsToldWithTheWayOut) {
    if (::geteuid() == 0) {
        // Root may write anywhere: a file in the place of the folder refuses it too.
        core::write_file(study / ".underbody", "in the way");
    } else {
        ::chmod(study.c_str(), 0500);
    }
    const ProgramRun result = run();
    ::chmod(study.c_str(), 0700);
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.errors, HasSubstr("--store"));
    EXPECT_EQ(run({"--store", (scratch.path() / "s.sqlite").string(), "--report", (scratch.path() / "r.html").string()})
                  .exit_code,
              0);
    EXPECT_TRUE(fs::exists(scratch.path() / "r.html"));
}

/// A run in the background, without output.
pid_t start_run(const fs::path& study) {
    const pid_t child = ::fork();
    if (child == 0) {
        ::dup2(::open("/dev/null", O_WRONLY), 1);
        ::dup2(::open("/dev/null", O_WRONLY), 2);
        const std::string program = (program_folder() / "underbody").string();
        ::execl(program.c_str(), program.c_str(), "study", "run", study.c_str(), "--no-pictures", nullptr);
        ::_exit(127);
    }
    return child;
}

/// Whether the process has come so far that Ctrl-C is its own affair; a process that has ended is none that will.
bool catches_interrupts(pid_t process) {
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("State:") && line.find('Z') != std::string::npos) {
            return true;
        }
        if (line.starts_with("SigCgt:")) {
            return (std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1U) != 0;
        }
    }
    return true;
}

json results_of(const ProgramRun& run) {
    json all = json::parse(run.output);
    return all.at("results");
}

/// A report without its pictures: how a plot is smoothed depends on which were drawn before it in the same process.
std::string report_text(const fs::path& file) {
    std::string text = core::read_file(file);
    for (auto at = text.find("base64,"); at != std::string::npos; at = text.find("base64,", at + 1)) {
        text.erase(at + 7, text.find('"', at) - at - 7);
    }
    return text;
}

TEST_F(StudyCommand, AKilledRunLosesNothingAndTheNextOneFinishes) {
    const fs::path other = scratch.path() / "undisturbed";
    write_small_study(other);
    const json truth = results_of(run_underbody({"study", "run", other.string(), "--no-pictures", "--json"}));
    const std::string report = report_text(other / "report" / "index.html");
    // Some kills in every run of the tests; a long campaign on demand (UNDERBODY_KILLS=200).
    const char* asked = std::getenv("UNDERBODY_KILLS");
    const int kills = asked != nullptr ? std::stoi(asked) : 8;
    core::Random random(20261122);
    for (int i = 0; i < kills; ++i) {
        if (i % 8 == 0) {  // from the beginning again
            fs::remove_all(study / ".underbody");
            fs::remove_all(study / "report");
        }
        const pid_t child = start_run(study);
        std::this_thread::sleep_for(
            std::chrono::microseconds(static_cast<int>(std::exp(random.uniform(std::log(2e3), std::log(4e5))))));
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        if (fs::exists(study / "report" / "index.html")) {
            EXPECT_EQ(report_text(study / "report" / "index.html"), report);
        }
        if (i % 8 == 7 || i + 1 == kills) {
            const ProgramRun result = run();
            ASSERT_EQ(result.exit_code, 0) << result.errors;
            EXPECT_EQ(results_of(result), truth) << "after kill " << i;
            EXPECT_EQ(report_text(study / "report" / "index.html"), report);
        }
    }
}

TEST_F(StudyCommand, TwoRunsAtOnceMakeEachResultOnce) {
    const pid_t first = start_run(study);
    const ProgramRun second = run();
    int status = 0;
    ::waitpid(first, &status, 0);
    EXPECT_EQ(status, 0);
    ASSERT_EQ(second.exit_code, 0) << second.errors;
    EXPECT_EQ(json::parse(second.output).at("failed"), 0);
    EXPECT_EQ(json::parse(run().output).at("computed"), 0);
    // A run that was killed keeps nobody waiting.
    fs::remove_all(study / ".underbody");
    const pid_t killed = start_run(study);
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    ::kill(killed, SIGKILL);
    ::waitpid(killed, nullptr, 0);
    EXPECT_EQ(run().exit_code, 0);
}

TEST_F(StudyCommand, AStudyOnAReadOnlyDiskIsListedAndReported) {
    ASSERT_EQ(run().exit_code, 0);
    ASSERT_EQ(run().exit_code, 0);
    std::vector<std::string> program = {"study", "list", study.string(), "--json"};
    std::string tool = (program_folder() / "underbody").string();
    if (::geteuid() == 0) {  // root may write anywhere: nobody may not
        if (run_program("setpriv", {"--version"}).exit_code != 0) {
            GTEST_SKIP() << "skipped: setpriv (util-linux) is not here";
        }
        program.insert(program.begin(), {"--reuid=65534", "--clear-groups", tool});
        tool = "setpriv";
    }
    fs::permissions(scratch.path(), fs::perms::group_all | fs::perms::others_all, fs::perm_options::add);
    for (const auto& entry : fs::recursive_directory_iterator(study)) {
        fs::permissions(entry.path(),
                        fs::perms::others_read | (entry.is_directory() ? fs::perms::others_exec : fs::perms::none),
                        fs::perm_options::add);
    }
    std::vector<fs::path> folders = {study};
    for (const auto& entry : fs::recursive_directory_iterator(study)) {
        if (entry.is_directory()) {
            folders.push_back(entry.path());
        }
    }
    const auto allow = [&](bool write) {
        for (const auto& folder : folders) {
            fs::permissions(folder, fs::perms::owner_write | fs::perms::others_write,
                            write ? fs::perm_options::add : fs::perm_options::remove);
        }
    };
    allow(false);
    fs::permissions(study, fs::perms::others_read | fs::perms::others_exec, fs::perm_options::add);
    const ProgramRun list = run_program(tool, program);
    for (auto& word : program) {
        word = word == "list" ? "report" : word;
    }
    program.push_back("--no-pictures");
    const ProgramRun reported = run_program(tool, program);
    program.push_back("--report");
    program.push_back((scratch.path() / "elsewhere.html").string());
    const ProgramRun elsewhere = run_program(tool, program);
    allow(true);
    if (list.errors.find("Permission denied") != std::string::npos && list.exit_code == 126) {
        GTEST_SKIP() << "skipped: nobody may not run " << tool;
    }
    ASSERT_EQ(list.exit_code, 0) << list.errors;
    EXPECT_EQ(json::parse(list.output).at("cases")[0].at("state"), "unchanged");
    EXPECT_EQ(reported.exit_code, 0) << reported.errors;
    EXPECT_EQ(elsewhere.exit_code, 0) << elsewhere.errors;
    EXPECT_EQ(core::read_file(scratch.path() / "elsewhere.html"), core::read_file(study / "report" / "index.html"));
}

TEST_F(StudyCommand, AStoreOfGarbageIsRefusedInPlainWordsAndKept) {
    core::write_file(study / ".underbody" / "store.sqlite", "this is my shopping list");
    for (const char* command : {"run", "list", "compare"}) {
        const ProgramRun result = run_underbody({"study", command, study.string()});
        EXPECT_EQ(result.exit_code, 3) << command;
        EXPECT_THAT(result.errors, HasSubstr("not a store of results"));
        EXPECT_THAT(result.errors, HasSubstr("--store FILE"));
    }
    EXPECT_EQ(core::read_file(study / ".underbody" / "store.sqlite"), "this is my shopping list");
}

TEST_F(StudyCommand, HalfModelsAreToldInListAndRunAndAddTakesTheirPlaneAndZones) {
    const fs::path halves = scratch.path() / "halves";
    for (int gap = 2; gap <= 3; ++gap) {
        core::write_file(halves / "fields" / ("half-h" + std::to_string(gap) + ".csv"),
                         half_cube_field(1e-3 * gap, 500));
    }
    const std::vector<std::string> add = {"study", "add", halves.string(), "--files", "fields/{variant}-h{gap:mm}.csv"};
    ASSERT_EQ(run_underbody(add).exit_code, 0);
    const ProgramRun first = run_underbody({"study", "run", halves.string(), "--no-pictures"});
    EXPECT_THAT(first.output, HasSubstr("half model"));
    EXPECT_THAT(run_underbody({"study", "list", halves.string()}).output, HasSubstr("half model"));
    const json listed = json::parse(run_underbody({"study", "list", halves.string(), "--json"}).output);
    EXPECT_THAT(listed.at("cases")[0].at("warnings").dump(), HasSubstr("half model"));
    EXPECT_NEAR(listed.at("cases")[0].at("lift_force").get<double>(), 0.25, 1e-9);
    const json table =
        json::parse(run_underbody({"loads", (halves / "fields/half-h{gap:mm}.csv").string(), "--json"}).output);
    EXPECT_THAT(table.at("files")[0].at("problems").dump(), HasSubstr("half model"));
    EXPECT_THAT(run_underbody({"loads", (halves / "fields/half-h{gap:mm}.csv").string()}).output,
                testing::ContainsRegex("# ?warning: [^\n]*half model"));
    fs::remove(halves / "study.toml");
    std::vector<std::string> with_plane = add;
    with_plane.insert(with_plane.end(), {"--symmetry", "y", "--zones", "hull,base"});
    const ProgramRun added = run_underbody(with_plane);
    ASSERT_EQ(added.exit_code, 0) << added.errors;
    EXPECT_THAT(core::read_file(halves / "study.toml"),
                testing::AllOf(HasSubstr("[frame]\nsymmetry = \"y\""), HasSubstr("zones = [\"hull\", \"base\"]")));
    const ProgramRun second = run_underbody({"study", "run", halves.string(), "--no-pictures"});
    EXPECT_THAT(second.output, testing::Not(HasSubstr("half model")));
    const json whole = json::parse(run_underbody({"study", "list", halves.string(), "--json"}).output);
    EXPECT_NEAR(whole.at("cases")[0].at("lift_force").get<double>(), 0.5, 1e-9);
    // A plane across the lift, or another one than the study has.
    fs::remove(halves / "study.toml");
    std::vector<std::string> wrong = add;
    wrong.insert(wrong.end(), {"--symmetry", "z"});
    const ProgramRun refused = run_underbody(wrong);
    EXPECT_EQ(refused.exit_code, 2) << "an option is wrong, no file";
    EXPECT_THAT(refused.errors, testing::AllOf(HasSubstr("every lift would be zero"), HasSubstr("nothing was added")));
    EXPECT_FALSE(fs::exists(halves / "study.toml"));
}

TEST_F(StudyCommand, CtrlCEndsWithOneHundredAndThirty) {
    // A map that takes long enough to be interrupted.
    std::string text = core::read_file(study / "study.toml");
    text.replace(text.find("columns = 40\nrows = 40"), 22, "columns = 4000\nrows = 4000");
    core::write_file(study / "study.toml", text);
    const pid_t child = start_run(study);
    while (!catches_interrupts(child)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    ::kill(child, SIGINT);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 130);
}

TEST_F(StudyCommand, AddsCasesOnlyWhenTheStudyStaysRight) {
    core::write_file(study / "more" / "ball-h2.csv", cube_field(0.002, 1));
    const std::string before = core::read_file(study / "study.toml");
    const ProgramRun wrong = run_underbody({"study", "add", study.string(), "--files", "none/*.csv"});
    EXPECT_EQ(wrong.exit_code, 3);
    EXPECT_EQ(core::read_file(study / "study.toml"), before);
    const ProgramRun right = run_underbody(
        {"study", "add", study.string(), "--files", "more/{variant}-h{gap:mm}.csv", "--condition", "speed=0.5m/s"});
    EXPECT_EQ(right.exit_code, 0) << right.errors;
    EXPECT_THAT(run_underbody({"study", "list", study.string()}).output, HasSubstr("ball-h2"));
}

TEST(CommandLine, TellsWrongUseFromWrongInput) {
    EXPECT_EQ(run_underbody({}).exit_code, 2);
    const ProgramRun typo = run_underbody({"studdy"});
    EXPECT_EQ(typo.exit_code, 2);
    EXPECT_THAT(typo.errors, HasSubstr("'underbody study'"));
    EXPECT_EQ(run_underbody({"study", "run"}).exit_code, 2);
    const ProgramRun missing = run_underbody({"study", "run", "/no/such/folder", "--json"});
    EXPECT_EQ(missing.exit_code, 3);
    EXPECT_TRUE(json::parse(missing.output).contains("error"));
    EXPECT_EQ(run_underbody({"--help"}).exit_code, 0);
    EXPECT_EQ(run_underbody({"study", "--help"}).exit_code, 0);
    EXPECT_THAT(run_underbody({"--version"}).output, HasSubstr("."));
}

}  // namespace
}  // namespace underbody::test
