// solve and sweep that are cut, killed or run twice at once: nothing that was solved is lost, nothing half is taken.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/file.h"
#include "core/random.h"
#include "core/table.h"
#include "tests/studio/solve_commands.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

TEST_F(SolveCommands, CtrlCEndsTheSolverTooAndTheSweepGoesOnLater) {
    write_study();
    hook("if [ $i = 17 ] && [ ! -e " + (folder_.path() / "quick").string() + " ]; then echo $$ >> " +
         (folder_.path() / "pids").string() + "; sleep 60; fi");
    const pid_t child = begin({"sweep", "study", "--jobs", "2"});
    const auto numbers = processes(2);
    ASSERT_EQ(numbers.size(), 2U);
    ::kill(child, SIGINT);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 130);
    for (const long process : numbers) {
        EXPECT_TRUE(gone(process)) << "the solver still runs: " << process;
    }
    EXPECT_FALSE(fs::exists(runs() / "ellipse-h5-p1-u0.5"));
    EXPECT_THAT(list()["ellipse-h5-p1-u0.5"]["reason"].get<std::string>(), HasSubstr("cut at iteration 17 of 40"));
    core::write_file(folder_.path() / "quick", "");
    const auto rest = run({"sweep", "study", "--jobs", "1"});
    EXPECT_EQ(rest.exit_code, 0) << rest.errors;
    // 40 iterations are written every 5; the mesh is made once.
    EXPECT_THAT(rest.output, HasSubstr("goes on from iteration 15"));
    EXPECT_EQ(core::read_file(runs() / "ellipse-h5-p1-u0.5" / "meshed"), "meshed\n");
    EXPECT_TRUE(fs::exists(runs() / "ellipse-h5-p1-u0.5/case.foam"));
    EXPECT_FALSE(fs::exists(runs() / "ellipse-h5-p1-u0.5.unfinished"));
}

TEST_F(SolveCommands, ASolverThatIsKilledOrMeetsAFullDiskGoesOnTheNextTime) {
    write_study();
    hook("if [ $i = 22 ]; then kill -9 $$; fi");
    const auto killed = run({"sweep", "study", "--only", "ellipse-h5-p1-u0.5"});
    EXPECT_EQ(killed.exit_code, 3);
    EXPECT_THAT(killed.errors, HasSubstr("was ended by signal 9"));
    hook("if [ $i = 35 ]; then : > 35/U; exit 0; fi");
    const auto full = run({"sweep", "study", "--only", "ellipse-h5-p1-u0.5"});
    EXPECT_EQ(full.exit_code, 3);
    EXPECT_THAT(full.errors, HasSubstr("without a whole solution"));
    fs::remove(folder_.path() / "hook");
    const auto rest = run({"sweep", "study", "--only", "ellipse-h5-p1-u0.5"});
    EXPECT_EQ(rest.exit_code, 0) << rest.errors;
    EXPECT_THAT(rest.output, HasSubstr("goes on from iteration 30"));
    EXPECT_TRUE(fs::exists(runs() / "ellipse-h5-p1-u0.5" / "40" / "U"));
}

TEST_F(SolveCommands, AKilledSweepTakesMesherAndSolverWithIt) {
    write_study();
    // The solver asks for nothing and does not end by itself when it is asked to.
    hook("trap '' TERM HUP INT; echo $$ >> " + (folder_.path() / "pids").string() + "; sleep 30 & echo $! >> " +
         (folder_.path() / "pids").string() + "; wait; sleep 30");
    const pid_t child = begin({"sweep", "study", "--jobs", "2"});
    const auto numbers = processes(4);
    ASSERT_EQ(numbers.size(), 4U);
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    for (const long process : numbers) {
        EXPECT_TRUE(gone(process)) << "still runs: " << process;
    }
    fs::remove(folder_.path() / "hook");
    EXPECT_EQ(run({"sweep", "study"}).exit_code, 0);
}

TEST_F(SolveCommands, KilledSweepsLoseNothingThatWasSolvedAndTheNextOneFinishes) {
    write_study();
    replace(folder_.path() / "study" / "study.toml", "gap = [\"5 mm\", \"10 mm\"]",
            "gap = [\"5 mm\", \"7 mm\", \"10 mm\"]");
    hook("sleep 0.002");
    // Some kills in every run of the tests, many on demand (tests/kills).
    const char* asked = std::getenv("UNDERBODY_KILLS");
    const int kills = asked != nullptr ? std::stoi(asked) : 6;
    core::Random random(20261122);
    std::map<std::string, std::string> solved;  // what was whole stays as it is
    for (int i = 0; i < kills; ++i) {
        if (i % 6 == 0) {
            fs::remove_all(runs());
            solved.clear();
        }
        const pid_t child = begin({"sweep", "study", "--jobs", std::to_string(1 + i % 3)});
        std::this_thread::sleep_for(
            std::chrono::microseconds(static_cast<int>(std::exp(random.uniform(std::log(5e3), std::log(1.5e6))))));
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        const json now = list();
        for (const auto& [name, one] : now.items()) {
            const fs::path velocity = runs() / name / "40" / "U";
            if (one["state"] == "solved") {
                const std::string bytes = core::read_file(velocity);
                EXPECT_TRUE(!solved.contains(name) || solved[name] == bytes) << name << " after kill " << i;
                solved[name] = bytes;
            } else {
                EXPECT_FALSE(solved.contains(name)) << name << " was lost by kill " << i << ": " << one;
                EXPECT_FALSE(fs::exists(runs() / name)) << name << " has half a result after kill " << i;
            }
        }
        if (i % 6 == 5 || i + 1 == kills) {
            const auto rest = run({"sweep", "study", "--jobs", "3"});
            ASSERT_EQ(rest.exit_code, 0) << "after kill " << i << ": " << rest.errors;
            for (const char* gap : {"5", "7", "10"}) {
                const fs::path folder = runs() / ("ellipse-h" + std::string(gap) + "-p1-u0.5");
                EXPECT_EQ(list()[folder.filename().string()]["state"], "solved") << "after kill " << i;
                EXPECT_EQ(core::read_file(folder / "meshed"), "meshed\n") << "a mesh that was whole is made once";
            }
            for (const auto& entry : fs::directory_iterator(runs())) {
                EXPECT_NE(entry.path().extension(), ".unfinished");
            }
        }
    }
}

TEST_F(SolveCommands, AKilledDesignRunLosesNoRowAndTheNextOneFinishes) {
    write_study();
    const fs::path study = folder_.path() / "search", results = study / "design" / "results.csv";
    core::write_file(study / "evie.toml", core::read_file(folder_.path() / "study" / "ellipse.toml"));
    core::write_file(study / "study.toml",
                     "title = \"search\"\n[frame]\nsymmetry = \"y\"\n[design]\nshape = \"evie.toml\"\npoints = 1\n"
                     "gap = [\"5 mm\", \"7 mm\", \"10 mm\"]\n[[design.vary]]\nkey = \"body.base_cut\"\nfrom = 0.74\n"
                     "to = 0.76\n[[design.fidelity]]\nname = \"snappy\"\nmesher = \"snappy\"\niterations = 40\n");
    hook("sleep 0.002");
    core::Random random(20261123);
    const auto rows = [&] {
        std::map<double, std::string> states;
        if (fs::exists(results)) {
            const core::Table table = core::read_csv(results);
            for (std::size_t i = 0; i < table.rows(); ++i) {
                EXPECT_TRUE(states.emplace(table.numbers("gap")[i], table.text("state")[i]).second) << "a row twice";
                EXPECT_NE(table.text("state")[i], "");
            }
        }
        return states;
    };
    std::size_t had = 0;
    for (int i = 0; i < 4; ++i) {
        const pid_t child = begin({"design", "run", "search"});
        std::this_thread::sleep_for(
            std::chrono::microseconds(static_cast<int>(std::exp(random.uniform(std::log(2e4), std::log(1.5e6))))));
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        const auto now = rows();
        EXPECT_GE(now.size(), had) << "lost by kill " << i;
        had = now.size();
    }
    (void)run({"design", "run", "search"});  // the stand-in's fields hold no loads: none can be used
    EXPECT_EQ(rows().size(), 3u);
    EXPECT_EQ(core::read_csv(study / "design" / "plan.csv").rows(), 1u) << "planned once";
    for (const char* gap : {"5", "7", "10"}) {
        EXPECT_TRUE(fs::exists(study / "design/runs/snappy" / ("design-001-h" + std::string(gap) + "-p0-u0.5")));
    }
}

TEST_F(SolveCommands, TwoSweepsAtOnceMakeEachCaseOnce) {
    write_study();
    hook("if [ $i = 1 ]; then echo made >> made; echo $$ >> " + (folder_.path() / "pids").string() +
         "; fi; while [ ! -e " + (folder_.path() / "go").string() + " ]; do sleep 0.05; done");
    const pid_t first = begin({"sweep", "study", "--jobs", "1"});
    ASSERT_EQ(processes(1).size(), 1U);
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "running");
    EXPECT_THAT(list()["ellipse-h5-p1-u0.5"]["reason"].get<std::string>(),
                HasSubstr("process " + std::to_string(first)));
    const pid_t second = begin({"sweep", "study", "--jobs", "2"});
    ASSERT_EQ(processes(2).size(), 2U);  // the other case
    EXPECT_TRUE(fs::exists(runs() / "ellipse-h5-p1-u0.5.unfinished" / "made"));
    const auto third = run({"sweep", "study", "--jobs", "2"});
    EXPECT_EQ(third.exit_code, 0) << third.errors;
    EXPECT_THAT(third.output,
                HasSubstr("ellipse-h5-p1-u0.5: left alone: being made by process " + std::to_string(first)));
    EXPECT_THAT(third.output,
                HasSubstr("ellipse-h10-p1-u0.5: left alone: being made by process " + std::to_string(second)));
    core::write_file(folder_.path() / "go", "");
    for (const pid_t child : {first, second}) {
        int status = 0;
        ::waitpid(child, &status, 0);
        EXPECT_EQ(WEXITSTATUS(status), 0);
    }
    for (const char* name : {"ellipse-h5-p1-u0.5", "ellipse-h10-p1-u0.5"}) {
        EXPECT_EQ(core::read_file(runs() / name / "made"), "made\n") << name;
        EXPECT_FALSE(fs::exists(runs() / (std::string(name) + ".lock")));
    }
}

TEST_F(SolveCommands, ACaseOfOtherInputsIsStaleAndSolvedAgainBesideTheOldOne) {
    write_study();
    const fs::path toml = folder_.path() / "study" / "study.toml";
    const std::string name = "ellipse-h5-p1-u0.5";
    ASSERT_EQ(run({"sweep", "study"}).exit_code, 0);
    struct Change {
        fs::path file;
        std::string what, by, said;
    };
    const fs::path shape = folder_.path() / "study" / "ellipse.toml";
    for (const auto& [file, what, by, said] :
         {Change{toml, "iterations = 40", "iterations = 60", "iterations: 40 there, 60 now"},
          Change{toml, "iterations = 40", "iterations = 40\nlayers = 2", "layers: 3 there, 2 now"},
          Change{toml, "\"998 kg/m^3\"", "\"1025 kg/m^3\"", "density: 998 kg/m^3 there, 1025 kg/m^3 now"},
          Change{shape, "152 mm", "150 mm", "body.width: 0.152 m there, 0.15 m now"}}) {
        replace(file, what, by);
        const json stale = list()[name];
        EXPECT_EQ(stale["state"], "stale") << said;
        EXPECT_EQ(stale["present"], false);
        EXPECT_THAT(stale["reason"].get<std::string>(), HasSubstr(said));
        // A study does not take what was solved for something else.
        EXPECT_EQ(json::parse(run({"study", "list", "study", "--json"}).output)["cases"].size(), 0U);
        replace(file, by, what);
        EXPECT_EQ(list()[name]["state"], "solved") << said;
    }
    replace(toml, "iterations = 40", "iterations = 60");
    replace(toml, "\"998 kg/m^3\"", "\"1025 kg/m^3\"");
    replace(shape, "152 mm", "150 mm");
    EXPECT_THAT(run({"study", "list", "study"}).output, HasSubstr("left out: " + name));
    EXPECT_THAT(run({"sweep", "study", "--stale", "keep"}).output, HasSubstr("nothing is missing"));
    const auto again = run({"sweep", "study", "--jobs", "1"});
    EXPECT_EQ(again.exit_code, 0) << again.errors;
    EXPECT_THAT(again.output, HasSubstr("density: 998 kg/m^3 there, 1025 kg/m^3 now"));
    EXPECT_TRUE(fs::exists(runs() / "set_aside" / name / "40" / "U"));
    EXPECT_TRUE(fs::exists(runs() / name / "60" / "U"));
    EXPECT_EQ(list()[name]["state"], "solved");
    replace(toml, "iterations = 60", "iterations = 40");
    ASSERT_EQ(run({"sweep", "study", "--stale", "replace"}).exit_code, 0);
    EXPECT_FALSE(fs::exists(runs() / "set_aside" / (name + "-2")));
    // The same shape in other units, with a default written out, is the same shape.
    replace(shape, "150 mm", "15 cm");
    replace(shape, "[body]", "[body]\nbase_pitch = \"0 deg\"");
    EXPECT_EQ(list()[name]["state"], "solved") << list()[name]["reason"];
}

TEST_F(SolveCommands, ASolvedCaseThatIsNoLongerWholeIsNotTakenAsSolved) {
    write_study();
    const std::string name = "ellipse-h5-p1-u0.5";
    // The marker alone is nothing.
    core::write_file(runs() / name / "case.foam", "{\"walls\": [\"hull\"]}");
    EXPECT_EQ(list()[name]["state"], "stale");
    ASSERT_EQ(run({"sweep", "study"}).exit_code, 0);
    ASSERT_EQ(list()[name]["state"], "solved");
    const fs::path velocity = runs() / name / "40" / "U";
    const std::string whole = core::read_file(velocity);
    core::write_file(velocity, whole.substr(0, whole.size() / 2));
    EXPECT_EQ(list()[name]["state"], "stale");
    EXPECT_THAT(list()[name]["reason"].get<std::string>(), HasSubstr("40/U has "));
    core::write_file(velocity, whole);
    EXPECT_EQ(list()[name]["state"], "solved");
    replace(runs() / name / "system" / "fvSolution", "0.3", "0.2");
    EXPECT_THAT(list()[name]["reason"].get<std::string>(), HasSubstr("changed since it was solved: system/fvSolution"));
    // Also where the time of the file, which anybody can set, says that nothing happened.
    fs::last_write_time(runs() / name / "system" / "fvSolution",
                        fs::last_write_time(runs() / name / "case.foam") - std::chrono::hours(1));
    EXPECT_THAT(list()[name]["reason"].get<std::string>(), HasSubstr("changed since it was solved: system/fvSolution"));
    EXPECT_EQ(run({"sweep", "study"}).exit_code, 0);
    EXPECT_EQ(list()[name]["state"], "solved");
}

TEST_F(SolveCommands, CasesOfAnotherVersionAreComparedFileByFile) {
    write_study();
    const std::string name = "ellipse-h5-p1-u0.5";
    ASSERT_EQ(run({"sweep", "study"}).exit_code, 0);
    const fs::path record = runs() / name / "underbody-case.json";
    json written = json::parse(core::read_file(record));
    written["code"] = "another";
    core::write_file(record, written.dump());
    EXPECT_EQ(list()[name]["state"], "solved");  // it would write the same
    fs::remove(record);
    EXPECT_EQ(list()[name]["state"], "solved");  // 0.1.0 left no record
    EXPECT_THAT(run({"sweep", "study"}).output, HasSubstr("nothing is missing"));
    EXPECT_EQ(json::parse(core::read_file(record))["made_of"], written["made_of"]);
    fs::remove(record);
    replace(runs() / name / "constant" / "transportProperties", "nu", "nu ");
    EXPECT_EQ(list()[name]["state"], "stale");
    EXPECT_THAT(list()[name]["reason"].get<std::string>(), HasSubstr("constant/transportProperties"));
}

TEST_F(SolveCommands, ASolveThatWasCutIsNeverSolved) {
    ASSERT_EQ(run({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(), "--gap",
                   "10mm", "--out", "case", "--mesher", "snappy", "--iterations", "30"})
                  .exit_code,
              0);
    struct Cut {
        std::string hook, said;
    };
    // A full disk does not stop a solver that does not look at its streams.
    for (const auto& [script, said] :
         {Cut{"if [ $i = 30 ]; then head -c 200 30/p > cut; mv cut 30/p; fi",
              "time 30 is not whole: p stops before its end"},
          Cut{"if [ $i = 30 ]; then : > 30/nut; fi", "nut is empty"},
          Cut{"if [ $i = 30 ]; then rm 30/k; fi", "there is no k"},
          Cut{"if [ $i = 30 ]; then sed 's/^4$/5/' 30/p > cut; mv cut 30/p; fi", "p has 5 values for 4 cells"},
          Cut{"if [ $i = 30 ]; then sed '$d' $f > cut; mv cut $f; fi", "end at 29"},
          Cut{"if [ $i = 30 ]; then printf '31 (-1 0' >> $f; fi", "forces"},
          Cut{"if [ $i = 30 ]; then sed '$s/-0.5/nan/' $f > cut; mv cut $f; fi", "diverged"},
          Cut{"if [ $i = 30 ]; then exit 0; fi", "log.simpleFoam has no End"}}) {
        hook(script);
        const auto cut = run({"solve", "case", "--again"});
        EXPECT_EQ(cut.exit_code, 3) << script;
        EXPECT_THAT(cut.errors, HasSubstr(said)) << script;
        fs::remove(folder_.path() / "hook");
        const auto whole = run({"solve", "case", "--json"});
        EXPECT_EQ(whole.exit_code, 0) << script << whole.errors;
        EXPECT_EQ(json::parse(whole.output)["solved_before"], false) << script;
        EXPECT_THAT(run({"solve", "case"}).output, HasSubstr("solved before"));
    }
    EXPECT_TRUE(fs::exists(folder_.path() / "case" / "previous" / "30"));  // --again loses nothing
}

TEST_F(SolveCommands, ASolveIsNotRunTwiceAtOnce) {
    ASSERT_EQ(run({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(), "--gap",
                   "10mm", "--out", "case", "--mesher", "snappy", "--iterations", "30"})
                  .exit_code,
              0);
    hook("if [ $i = 1 ]; then echo $$ >> " + (folder_.path() / "pids").string() + "; fi; while [ ! -e " +
         (folder_.path() / "go").string() + " ]; do sleep 0.05; done");
    const pid_t first = begin({"solve", "case"});
    ASSERT_EQ(processes(1).size(), 1U);
    const auto second = run({"solve", "case"});
    EXPECT_EQ(second.exit_code, 3);
    EXPECT_THAT(second.errors, HasSubstr("is being solved by process " + std::to_string(first)));
    core::write_file(folder_.path() / "go", "");
    int status = 0;
    ::waitpid(first, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace underbody
