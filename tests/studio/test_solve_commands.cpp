// solve and sweep as a user runs them, with a stand-in for OpenFOAM: programs of its names that write what it writes.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/file.h"
#include "core/random.h"
#include "core/table.h"
#include "core/text.h"
#include "tests/studio/stand_in_solver.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class SolveCommands : public testing::Test {
protected:
    SolveCommands() {
        // Nothing of OpenFOAM or Slurm that this machine may have is on the path of these tests.
        for (const char* tool : {"sh", "sed", "mkdir", "touch", "printf", "cat", "sleep", "rm", "cp", "tail", "dirname",
                                 "head", "mv", "date", "ln"}) {
            for (const char* where : {"/usr/bin", "/bin"}) {
                if (fs::exists(fs::path(where) / tool) && !fs::exists(folder_.path() / "tools" / tool)) {
                    fs::create_directories(folder_.path() / "tools");
                    fs::create_symlink(fs::path(where) / tool, folder_.path() / "tools" / tool);
                }
            }
        }
        test::write_stand_in_solver(folder_.path() / "bin");
    }

    void program(const std::string& name, const std::string& script) {
        test::write_program(folder_.path() / "bin" / name, script);
    }
    [[nodiscard]] std::map<std::string, std::string> environment() const {
        return {{"PATH", (folder_.path() / "bin").string() + ":" + (folder_.path() / "tools").string()},
                {"HOOK", (folder_.path() / "hook").string()}};
    }
    void hook(const std::string& script) { core::write_file(folder_.path() / "hook", script + "\n"); }
    [[nodiscard]] fs::path runs() const { return folder_.path() / "study" / "runs"; }
    json list() {
        const auto result = run({"sweep", "study", "--list", "--json"});
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        json cases = json::object();
        const json told = json::parse(result.output);  // lives as long as the loop
        for (const auto& one : told["cases"]) {
            cases[one["name"].get<std::string>()] = one;
        }
        return cases;
    }
    void replace(const fs::path& file, const std::string& what, const std::string& by) {
        std::string text = core::read_file(file);
        ASSERT_NE(text.find(what), std::string::npos) << what;
        text.replace(text.find(what), what.size(), by);
        core::write_file(file, text);
    }
    /// Runs the program without waiting for it.
    pid_t begin(const std::vector<std::string>& arguments) {
        const pid_t child = ::fork();
        if (child == 0) {
            for (const auto& [name, value] : environment()) {
                ::setenv(name.c_str(), value.c_str(), 1);
            }
            const int nowhere = ::open("/dev/null", O_RDWR);
            ::dup2(nowhere, 1);
            ::dup2(nowhere, 2);
            const std::string underbody = (test::program_folder() / "underbody").string();
            std::vector<char*> argv = {const_cast<char*>(underbody.c_str())};
            for (const auto& argument : arguments) {
                argv.push_back(const_cast<char*>(argument.c_str()));
            }
            argv.push_back(nullptr);
            if (::chdir(folder_.path().c_str()) == 0) {
                ::execv(underbody.c_str(), argv.data());
            }
            ::_exit(127);
        }
        return child;
    }
    /// Process numbers that the scripts wrote, once there are `count`.
    std::vector<long> processes(std::size_t count) {
        const fs::path file = folder_.path() / "pids";
        std::vector<long> numbers;
        for (int i = 0; i < 1500 && numbers.size() < count; ++i) {
            numbers.clear();
            const std::string text = fs::exists(file) ? core::read_file(file) : "";
            for (const auto line : core::split(text, '\n')) {
                if (const auto number = core::parse_integer(line)) {
                    numbers.push_back(static_cast<long>(*number));
                }
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return numbers;
    }
    /// Gone, or a zombie that nobody has fetched yet, within five seconds.
    static bool gone(long process) {
        for (int i = 0; i < 250; ++i) {
            std::ifstream state("/proc/" + std::to_string(process) + "/stat");
            std::string words;
            std::getline(state, words);
            if (words.empty() || words.find(") Z") != std::string::npos) {
                return true;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return false;
    }
    test::ProgramRun run(const std::vector<std::string>& arguments) {
        return test::run_underbody(arguments, folder_.path(), environment());
    }

    void write_study() {
        fs::create_directories(folder_.path() / "study");
        fs::copy(test::source_folder() / "cases" / "evie" / "shapes" / "ellipse.toml",
                 folder_.path() / "study" / "ellipse.toml");
        core::write_file(folder_.path() / "study" / "study.toml",
                         "title = \"a sweep\"\n[frame]\nsymmetry = \"y\"\n[reference]\ndensity = \"998 "
                         "kg/m^3\"\n[[body]]\nname = \"ellipse\"\nshape = \"ellipse.toml\"\n"
                         "[sweep]\ngap = [\"5 mm\", \"10 mm\"]\npitch = \"1 deg\"\nspeed = \"0.5 m/s\"\nconditions "
                         "= { mesh = \"coarse\" }\nmesher = \"snappy\"\niterations = 40\n");
    }
    core::TemporaryFolder folder_;
};

TEST_F(SolveCommands, SolveRunsACaseAndTellsItsForces) {
    ASSERT_EQ(run({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(), "--gap",
                   "10mm", "--out", "case", "--mesher", "snappy", "--iterations", "30"})
                  .exit_code,
              0);
    const auto first = run({"solve", "case", "--json"});
    ASSERT_EQ(first.exit_code, 0) << first.errors;
    const json result = json::parse(first.output);
    EXPECT_EQ(result["iterations"], 30);
    EXPECT_EQ(result["solved_before"], false);
    EXPECT_EQ(result["forces"][0]["force"], json({-1.5, 0.0, 2.0}));
    EXPECT_THAT(run({"solve", "case"}).output, HasSubstr("solved before"));
    EXPECT_THAT(run({"solve", "case", "--again"}).output, HasSubstr("solved in"));
}

TEST_F(SolveCommands, SolveSaysWhatIsMissingAndWhatFailed) {
    ASSERT_EQ(run({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(), "--gap",
                   "10mm", "--out", "case", "--mesher", "snappy"})
                  .exit_code,
              0);
    const auto none = test::run_underbody({"solve", "case", "--json"}, folder_.path(), {{"PATH", "/nowhere"}});
    EXPECT_EQ(none.exit_code, 3);
    EXPECT_THAT(json::parse(none.output)["error"]["hint"].get<std::string>(), HasSubstr("apt install openfoam"));
    EXPECT_EQ(run({"solve", "nowhere"}).exit_code, 3);
    fs::create_directories(folder_.path() / "empty");
    EXPECT_THAT(run({"solve", "empty"}).errors, HasSubstr("no Allrun"));
    program("snappyHexMesh", "echo 'reading'; echo '--> FOAM FATAL ERROR:'; echo 'no such surface body.stl'; exit 1");
    const auto failed = run({"solve", "case"});
    EXPECT_EQ(failed.exit_code, 3);
    EXPECT_THAT(failed.errors, HasSubstr("log.snappyHexMesh"));
    EXPECT_THAT(failed.errors, HasSubstr("no such surface body.stl"));
}

TEST_F(SolveCommands, SweepMakesTheMissingCasesAndOnlyThose) {
    write_study();
    EXPECT_THAT(run({"sweep", "study", "--list"}).output, HasSubstr("missing  ellipse-h5-p1-u0.5"));
    const auto one = run({"sweep", "study", "--only", "ellipse-h10-p1-u0.5"});
    EXPECT_EQ(one.exit_code, 0) << one.errors;
    EXPECT_TRUE(fs::exists(folder_.path() / "study/runs/ellipse-h10-p1-u0.5/case.foam"));
    const auto rest = run({"sweep", "study", "--json", "--jobs", "2"});
    EXPECT_EQ(rest.exit_code, 0) << rest.errors;
    ASSERT_EQ(json::parse(rest.output)["cases"].size(), 1U);
    EXPECT_EQ(json::parse(rest.output)["cases"][0]["name"], "ellipse-h5-p1-u0.5");
    EXPECT_THAT(run({"sweep", "study"}).output, HasSubstr("nothing is missing"));
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "solved");
    // The study has them with their conditions, without a [[case]].
    const auto list = run({"study", "list", "study"});
    EXPECT_EQ(list.exit_code, 0) << list.errors;
    EXPECT_THAT(list.output, HasSubstr("ellipse-h10-p1-u0.5"));
    EXPECT_EQ(run({"sweep", "study", "--only", "ellipse-h11-p1-u0.5"}).exit_code, 3);
}

TEST_F(SolveCommands, SweepGoesOnPastACaseThatFailsAndKeepsItsLogs) {
    write_study();
    program("checkMesh", "case \"$PWD\" in *h5*) echo 'mesh is bad'; exit 1;; esac; echo; echo End");
    const auto sweep = run({"sweep", "study", "--jobs", "1"});
    EXPECT_EQ(sweep.exit_code, 3);
    EXPECT_THAT(sweep.output, HasSubstr("ellipse-h10-p1-u0.5: solved"));
    EXPECT_THAT(sweep.errors, HasSubstr("mesh is bad"));
    EXPECT_TRUE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5.failed/log.checkMesh"));
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "failed");
    EXPECT_THAT(list()["ellipse-h5-p1-u0.5"]["reason"].get<std::string>(), HasSubstr("mesh is bad"));
    program("checkMesh", "echo; echo End");
    EXPECT_EQ(run({"sweep", "study"}).exit_code, 0);
    EXPECT_FALSE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5.failed"));
    EXPECT_TRUE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5/case.foam"));
}

TEST_F(SolveCommands, SweepWritesAndSubmitsAJobArray) {
    write_study();
    const auto alone = run({"sweep", "study", "--engine", "slurm"});
    EXPECT_EQ(alone.exit_code, 0) << alone.errors;
    EXPECT_THAT(alone.output, HasSubstr("'sbatch' is not here"));
    const std::string script = core::read_file(runs() / "sweep.sh");
    EXPECT_THAT(script, HasSubstr("#SBATCH --array=1-2"));
    EXPECT_THAT(script, HasSubstr("2) name='ellipse-h10-p1-u0.5' ;;"));
    program("sbatch", "cp \"$2\" submitted.sh; echo 4711");
    const auto submitted = run({"sweep", "study", "--engine", "slurm", "--json"});
    EXPECT_EQ(submitted.exit_code, 0) << submitted.errors;
    EXPECT_EQ(json::parse(submitted.output)["job"], "4711");
    // A task of the array makes its case.
    auto variables = environment();
    variables["SLURM_ARRAY_TASK_ID"] = "2";
    const auto task = test::run_program("/bin/sh", {(runs() / "sweep.sh").string()}, "/", variables);
    EXPECT_EQ(task.exit_code, 0) << task.errors;
    EXPECT_TRUE(fs::exists(runs() / "ellipse-h10-p1-u0.5/case.foam"));
    EXPECT_FALSE(fs::exists(runs() / "ellipse-h10-p1-u0.5.submitted"));
    program("squeue", "true");  // the other task is gone without a trace
    program("sbatch", "echo 'invalid partition' >&2; exit 1");
    const auto refused = run({"sweep", "study", "--engine", "slurm"});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_THAT(refused.errors, HasSubstr("invalid partition"));
    EXPECT_FALSE(fs::exists(runs() / "ellipse-h5-p1-u0.5.submitted"));
}

TEST_F(SolveCommands, ACaseOnSeveralCoresIsTriedAgainFromItsCheckpoint) {
    write_study();
    // Killed once at iteration 17 in each case, on two cores: what was decomposed is put together, and it goes on.
    hook("if [ $i = 17 ] && [ ! -e ../again ]; then touch ../again; kill -9 $$; fi");
    const auto made = run({"sweep", "study", "--jobs", "1", "--cores", "2", "--retries", "1", "--json"});
    ASSERT_EQ(made.exit_code, 0) << made.output << made.errors;
    const json told = json::parse(made.output);
    ASSERT_FALSE(told["cases"].empty());
    for (const auto& one : told["cases"]) {
        const fs::path folder = runs() / one["name"].get<std::string>();
        EXPECT_THAT(one["note"].get<std::string>(), HasSubstr("tried again (1 of 1): "));
        EXPECT_EQ(core::read_file(folder / "cores"), "2\n2\n");
        EXPECT_TRUE(fs::exists(folder / "40" / "U"));
        EXPECT_FALSE(fs::exists(folder / "processor0"));
        EXPECT_EQ(core::read_file(folder / "meshed"), "meshed\n");
        // Iterations 1 to 17, then 16 to 40.
        EXPECT_TRUE(fs::exists(folder / "postProcessing" / "forces" / "15")) << "it went on from the checkpoint";
    }
    const json all = list();
    for (const auto& [name, one] : all.items()) {
        EXPECT_EQ(one["state"], "solved") << name;
    }
}

TEST_F(SolveCommands, ACaseIsTriedAgainAsOftenAsAsked) {
    write_study();
    hook("echo x >> ../../attempts; exit 1");
    const auto made = run({"sweep", "study", "--jobs", "1", "--retries", "2", "--only", "ellipse-h5-p1-u0.5"});
    EXPECT_EQ(made.exit_code, 3);
    EXPECT_EQ(core::read_file(folder_.path() / "study" / "attempts"), "x\nx\nx\n");
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "failed");
}

TEST_F(SolveCommands, OnSeveralCoresTheProgramsOfMpiAreNeeded) {
    write_study();
    fs::remove(folder_.path() / "bin" / "mpirun");
    const auto made = run({"sweep", "study", "--cores", "2"});
    EXPECT_NE(made.exit_code, 0);
    EXPECT_THAT(made.output + made.errors, HasSubstr("needs 'mpirun', which is not on the PATH"));
    EXPECT_THAT(run({"sweep", "study", "--wait"}).errors, HasSubstr("is for jobs of Slurm"));
    EXPECT_THAT(run({"sweep", "study", "--cancel"}).errors, HasSubstr("there is no 'scancel'"));
}

TEST_F(SolveCommands, WhatWaitsOrRunsInSlurmIsMadeByNobodyElse) {
    write_study();
    program("sbatch", "echo \"$@\" >> calls; echo 4711");
    ASSERT_EQ(run({"sweep", "study", "--engine", "slurm"}).exit_code, 0);
    program("squeue", "echo '1 RUNNING'; echo '2 PENDING'");
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "running");
    EXPECT_EQ(list()["ellipse-h10-p1-u0.5"]["state"], "waiting");
    EXPECT_THAT(list()["ellipse-h10-p1-u0.5"]["reason"].get<std::string>(), HasSubstr("4711_2"));
    EXPECT_THAT(run({"sweep", "study", "--engine", "slurm"}).output,
                HasSubstr("nothing is missing that does not wait or run"));
    EXPECT_EQ(core::split(core::read_file(runs() / "calls"), '\n').size(), 2U);  // one line
    const auto local = run({"sweep", "study"});
    EXPECT_EQ(local.exit_code, 0) << local.errors;
    EXPECT_THAT(local.output, HasSubstr("ellipse-h5-p1-u0.5: left alone: submitted as job 4711_1"));
    EXPECT_FALSE(fs::exists(runs() / "ellipse-h5-p1-u0.5"));
    program("squeue", "echo 'slurm_load_jobs error: Unable to contact slurm controller' >&2; exit 1");
    EXPECT_THAT(list()["ellipse-h5-p1-u0.5"]["reason"].get<std::string>(), HasSubstr("Slurm cannot be asked"));
    program("squeue", "true");  // the job was cancelled
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "missing");
    EXPECT_EQ(run({"sweep", "study"}).exit_code, 0);
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "solved");
    EXPECT_FALSE(fs::exists(runs() / "ellipse-h5-p1-u0.5.submitted"));
}

TEST_F(SolveCommands, ArraysAreAsLongAsTheSiteTakesThemWithItsOptions) {
    write_study();
    replace(folder_.path() / "study" / "study.toml", "gap = [\"5 mm\", \"10 mm\"]",
            "gap = [\"5 mm\", \"6 mm\", \"7 mm\", \"8 mm\", \"10 mm\"]");
    core::write_file(folder_.path() / "study" / "study.toml",
                     core::read_file(folder_.path() / "study" / "study.toml") +
                         "[sweep.slurm]\npartition = \"cfd\"\ntime = \"02:00:00\"\nmemory = \"4G\"\nthrottle = "
                         "2\noptions = [\"--nice=100\"]\n");
    program("scontrol", "echo 'MaxArraySize            = 3'");
    program("sbatch", "echo \"$@\" >> calls; sed -n '$=' calls");
    const auto submitted = run({"sweep", "study", "--engine", "slurm", "--account", "hull", "--json"});
    ASSERT_EQ(submitted.exit_code, 0) << submitted.errors;
    const json arrays = json::parse(submitted.output)["arrays"];
    ASSERT_EQ(arrays.size(), 3U);
    EXPECT_EQ(arrays[2]["cases"].size(), 1U);
    const std::string script = core::read_file(runs() / "sweep-2.sh");
    for (const char* line : {"#SBATCH --array=1-2%2\n", "#SBATCH --partition=cfd\n", "#SBATCH --time=02:00:00\n",
                             "#SBATCH --mem=4G\n", "#SBATCH --account=hull\n", "#SBATCH --nice=100\n"}) {
        EXPECT_THAT(script, HasSubstr(line));
    }
    EXPECT_THAT(core::read_file(runs() / "calls"), HasSubstr("--dependency=afterany:1 "));
    replace(folder_.path() / "study" / "study.toml", "02:00:00", "2 h");
    EXPECT_THAT(run({"sweep", "study", "--list"}).errors, HasSubstr("Slurm takes no blanks"));
}

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

/// A stand-in for the solver on a mesh of blocks: its forces swing by `swing`, its run ends when it finds the file for
/// which the case's function object waits.
std::string waiting_solver(const std::string& swing) {
    return "swing=" + swing + R"sh(
if [ "$1" = -case ]; then cd "$2" || exit 1; fi
end=$(sed -n 's/^endTime \([0-9]*\);.*/\1/p' system/controlDict)
from=0
for d in [1-9]*; do if [ -e "$d/U" ]; then from=$d; fi; done
mkdir -p postProcessing/forces/$from
f=postProcessing/forces/$from/force.dat
echo '# Time (total_x total_y total_z) (pressure_x pressure_y pressure_z) (viscous_x viscous_y viscous_z)' > $f
i=$from
while [ $i -lt $end ] && [ ! -e settled ]; do
    i=$((i + 1))
    echo
    echo "Time = $i"
    echo "$i (-1.5 0 2) (-1 0 $((i % 2 * swing + 200))e-2) (-0.5 0 0)" >> $f
    if [ $i -gt 240 ]; then sleep 0.1; fi
done
mkdir -p $i
for v in U p k omega nut; do
    printf 'FoamFile\n{\n    class volScalarField;\n}\ninternalField uniform 1;\n// **** //\n' > $i/$v
done
if [ -e settled ]; then
    rm settled  # as OpenFOAM 1912 does
    echo "USER REQUESTED ABORT (timeIndex=$i): stop and write data"
fi
echo
echo End
)sh";
}

TEST_F(SolveCommands, ARunOnBlocksEndsWhenItsLoadsHaveSettled) {
    program("ln", "exec /bin/ln \"$@\"");
    program("simpleFoam", waiting_solver("0"));
    write_study();
    replace(folder_.path() / "study" / "study.toml", "mesher = \"snappy\"\niterations = 40",
            "mesh_density = \"coarse\"");
    const auto sweep = run({"sweep", "study", "--json", "--only", "ellipse-h5-p1-u0.5"});
    ASSERT_EQ(sweep.exit_code, 0) << sweep.errors << sweep.output;
    const fs::path made = runs() / "ellipse-h5-p1-u0.5";
    const json marker = json::parse(core::read_file(made / "case.foam"));
    EXPECT_EQ(marker["settled"], true);
    EXPECT_GE(marker["iterations"], 220);
    EXPECT_LT(marker["iterations"], 800);
    EXPECT_EQ(marker["walls"], json({"base", "hull"}));
    EXPECT_EQ(list()["ellipse-h5-p1-u0.5"]["state"], "solved");
    const json mesh = json::parse(core::read_file(made / "constant" / "mesh.json"));
    EXPECT_EQ(mesh["cells"], 57280);
    EXPECT_EQ(mesh["cells_in_gap"], 20);
    EXPECT_EQ(mesh["negative_volumes"], 0);
    // Another density is another case.
    replace(folder_.path() / "study" / "study.toml", "coarse\"\n", "medium\"\n");
    EXPECT_THAT(list()["ellipse-h5-p1-u0.5"]["reason"].get<std::string>(),
                HasSubstr("mesh density: coarse there, medium now"));
}

TEST_F(SolveCommands, ARunThatDoesNotSettleRunsToItsEndAndSaysSo) {
    program("ln", "exec /bin/ln \"$@\"");
    program("simpleFoam", waiting_solver("5"));
    ASSERT_EQ(run({"body", "domain", (test::source_folder() / "cases/evie/shapes/rectangle.toml").string(), "--gap",
                   "10mm", "--mesh-density", "coarse", "--out", "case", "--iterations", "240"})
                  .exit_code,
              0);
    const auto solved = run({"solve", "case", "--json"});
    ASSERT_EQ(solved.exit_code, 0) << solved.errors;
    EXPECT_EQ(json::parse(solved.output)["settled"], false);
    EXPECT_EQ(json::parse(solved.output)["iterations"], 240);
    EXPECT_THAT(run({"solve", "case"}).output, HasSubstr("not settled: lift, drag or pitch moment change by 2"));
    // --again solves anew on the same mesh.
    EXPECT_EQ(run({"solve", "case", "--again"}).exit_code, 0);
    EXPECT_TRUE(fs::exists(folder_.path() / "case" / "previous" / "240" / "U"));
    EXPECT_TRUE(fs::exists(folder_.path() / "case" / "constant" / "polyMesh" / "owner"));
}

TEST_F(SolveCommands, ADesignTakesWhatPeopleTypedAndSaysWhenAllFailed) {
    program("ln", "exec /bin/ln \"$@\"");
    program("simpleFoam", waiting_solver("0"));
    write_study();
    const fs::path study = folder_.path() / "search";
    core::write_file(study / "evie.toml", core::read_file(folder_.path() / "study" / "ellipse.toml"));
    core::write_file(study / "study.toml",
                     "title = \"search\"\n[frame]\nsymmetry = \"y\"\n[design]\nshape = \"evie.toml\"\npoints = 1\n"
                     "gap = \"3 mm\"\npitch = [\"-6 deg\", \"-5 deg\"]\nkinematic_viscosity = \"1.1e-6 m^2/s\"\n"
                     "[[design.vary]]\nkey = \"body.base_cut\"\nfrom = 0.74\nto = 0.76\n"
                     "[[design.fidelity]]\nname = \"draft\"\niterations = 240\n");
    core::write_file(study / "design" / "plan.csv",
                     "design,body.base_cut [1],fidelity,why,state,remark\nmine,0.75,draft,typed,planned,see above\n");
    const auto failed = run({"design", "run", "search", "--json"});
    EXPECT_EQ(failed.exit_code, 3) << "not one case gave loads";
    ASSERT_TRUE(fs::exists(study / "design" / "results.csv")) << failed.errors << failed.output;
    EXPECT_EQ(json::parse(failed.output)["usable"], 0);
    core::Table table = core::read_csv(study / "design" / "results.csv");
    ASSERT_EQ(table.rows(), 2u);
    for (const std::string& state : table.text("state")) {
        EXPECT_THAT(state, HasSubstr("below the ground"));  // was: no such file, of the shape that was typed
    }
    EXPECT_TRUE(fs::exists(study / "design/shapes/mine.toml"));
    // A remark beside the results, and a pitch at which there is room.
    std::string text = core::read_file(study / "design" / "results.csv");
    text.insert(text.find('\n'), ", remark");
    text.insert(text.find('\n', text.find('\n') + 1), ", touches");
    text.insert(text.rfind('\n'), ", touches too");
    fs::remove(study / "design" / "results.csv");
    std::ofstream(study / "design" / "results.csv") << text;
    replace(study / "study.toml", "\"-5 deg\"", "\"1 deg\"");
    (void)run({"design", "run", "search", "--json"});  // the stand-in's fields hold no loads
    table = core::read_csv(study / "design" / "results.csv");
    ASSERT_EQ(table.rows(), 3u);
    EXPECT_EQ(table.text("remark")[0], "touches");
    EXPECT_EQ(table.text("remark")[1], "touches too");
    EXPECT_EQ(core::read_csv(study / "design" / "plan.csv").text("remark")[0], "see above");
    EXPECT_THAT(core::read_file(study / "design/runs/draft/mine-h3-p1-u0.5/constant/transportProperties"),
                HasSubstr("nu 1.1e-06"));
}

TEST_F(SolveCommands, WhatBelongsToOneMesherIsRefusedWithTheOther) {
    write_study();
    const fs::path toml = folder_.path() / "study" / "study.toml";
    replace(toml, "mesher = \"snappy\"", "mesher = \"blocks\"\nlayers = 2");
    EXPECT_THAT(run({"sweep", "study", "--list"}).errors, HasSubstr("snappyHexMesh's"));
    replace(toml, "mesher = \"blocks\"\nlayers = 2", "mesher = \"snappy\"\nmesh_density = \"fine\"");
    EXPECT_THAT(run({"sweep", "study", "--list"}).errors, HasSubstr("mesh_density is that of the blocks"));
    replace(toml, "mesher = \"snappy\"\nmesh_density = \"fine\"", "mesh_density = \"finer\"");
    EXPECT_THAT(run({"sweep", "study", "--list"}).errors, HasSubstr("fine"));
    const auto nowhere = run({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(),
                              "--gap", "5mm", "--pitch", "6deg", "--out", "case"});
    EXPECT_EQ(nowhere.exit_code, 3);
    EXPECT_THAT(nowhere.errors, HasSubstr("below the ground"));
    EXPECT_FALSE(fs::exists(folder_.path() / "case"));
}

/// A real case, coarse: 20 iterations, killed on the way and gone on with.
TEST(RealOpenFoam, ACaseIsMeshedSolvedAndReadAsItsOwnForcesSay) {
    if (!fs::exists("/usr/bin/simpleFoam")) {
        GTEST_SKIP() << "skipped: OpenFOAM is not here (Debian: openfoam)";
    }
    const core::TemporaryFolder folder;
    ASSERT_EQ(
        test::run_underbody(
            {"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(), "--gap", "30mm",
             "--out", "case", "--iterations", "20", "--cell", "0.5", "--surface-level", "1", "--layers", "0"},
            folder.path())
            .exit_code,
        0);
    const auto solved = test::run_underbody({"solve", "case", "--json"}, folder.path());
    ASSERT_EQ(solved.exit_code, 0) << solved.errors;
    const json result = json::parse(solved.output);
    EXPECT_EQ(result["iterations"], 20);
    const auto loads = test::run_underbody(
        {"loads", "case", "--symmetry", "y", "--zones", "hull,base", "--json", "--check", "1 %"}, folder.path());
    EXPECT_EQ(loads.exit_code, 0) << loads.errors;
    // A checkpoint: what was written last is lost, the one before is whole.
    fs::remove_all(folder.path() / "case" / "20");
    const auto again = test::run_underbody({"solve", "case", "--json"}, folder.path());
    ASSERT_EQ(again.exit_code, 0) << again.errors;
    const json rest = json::parse(again.output);
    EXPECT_GT(rest["went_on_from"].get<double>(), 0);
    EXPECT_EQ(rest["iterations"], 20);
    for (std::size_t k = 0; k < 3; ++k) {
        const double before = result["forces"][0]["force"][k];
        EXPECT_NEAR(rest["forces"][0]["force"][k].get<double>(), before, 1e-4 * std::abs(before) + 1e-9) << k;
    }
}

/// Blocks: the start in first order, then second order; cut on the way and gone on with.
TEST(RealOpenFoam, ACaseOfBlocksIsSolvedAndReadAsItsOwnForcesSay) {
    if (!fs::exists("/usr/bin/simpleFoam")) {
        GTEST_SKIP() << "skipped: OpenFOAM is not here (Debian: openfoam)";
    }
    const core::TemporaryFolder folder;
    const auto made = test::run_underbody(
        {"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse_front_bump1.toml").string(), "--gap",
         "5mm", "--out", "case", "--iterations", "12", "--mesh-density", "coarse", "--json"},
        folder.path());
    ASSERT_EQ(made.exit_code, 0) << made.errors;
    EXPECT_EQ(json::parse(made.output)["mesher"], "blocks");
    EXPECT_EQ(json::parse(made.output)["cells_in_gap"], 20);
    const auto solved = test::run_underbody({"solve", "case", "--json"}, folder.path());
    ASSERT_EQ(solved.exit_code, 0) << solved.errors;
    EXPECT_EQ(json::parse(solved.output)["iterations"], 12);
    EXPECT_TRUE(json::parse(solved.output)["settled"].is_null());  // too few to say
    const auto loads = test::run_underbody(
        {"loads", "case", "--symmetry", "y", "--zones", "hull,base,protrusion", "--json", "--check", "1 %"},
        folder.path());
    EXPECT_EQ(loads.exit_code, 0) << loads.errors;
    EXPECT_THAT(core::read_file(folder.path() / "case" / "log.checkMesh"), HasSubstr("Mesh OK."));
    fs::remove_all(folder.path() / "case" / "12");
    const auto again = test::run_underbody({"solve", "case", "--json"}, folder.path());
    ASSERT_EQ(again.exit_code, 0) << again.errors;
    EXPECT_GE(json::parse(again.output)["went_on_from"].get<double>(), 4);
}

}  // namespace
/// The file that ends a run is gone when OpenFOAM has ended: the case counts as solved all the same.
TEST(RealOpenFoam, ARunThatIsEndedByItsFileIsSolved) {
    if (!fs::exists("/usr/bin/simpleFoam")) {
        GTEST_SKIP() << "skipped: OpenFOAM is not here (Debian: openfoam)";
    }
    const core::TemporaryFolder folder;
    ASSERT_EQ(
        test::run_underbody({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(),
                             "--gap", "5mm", "--out", "case", "--iterations", "800", "--mesh-density", "draft"},
                            folder.path())
            .exit_code,
        0);
    const std::string script = "cd " + (folder.path() / "case").string() +
                               " && (until [ -e postProcessing/forces ]; do sleep 0.05; done; touch settled) & cd " +
                               (folder.path() / "case").string() + " && ./Allrun > out 2>&1; wait";
    ASSERT_EQ(std::system(script.c_str()), 0);
    EXPECT_FALSE(fs::exists(folder.path() / "case" / "settled"));
    const auto solved = test::run_underbody({"solve", "case", "--json"}, folder.path());
    ASSERT_EQ(solved.exit_code, 0) << solved.errors;
    EXPECT_EQ(json::parse(solved.output)["solved_before"], true);
    EXPECT_LT(json::parse(solved.output)["iterations"], 400);
}

/// [design]: planned shapes at their conditions on meshes of blocks; what cannot be placed is kept with its reason.
TEST(RealOpenFoam, ADesignIsRunOnBlocks) {
    if (!fs::exists("/usr/bin/simpleFoam")) {
        GTEST_SKIP() << "skipped: OpenFOAM is not here (Debian: openfoam)";
    }
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "evie.toml",
                     "[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 mm\"\nbase_cut = 0.75\n");
    core::write_file(
        folder.path() / "study.toml",
        "title = \"search\"\n[frame]\nsymmetry = \"y\"\n[design]\nshape = \"evie.toml\"\npoints = 1\ngap = \"3 mm\"\n"
        "pitch = [\"-5 deg\", \"1 deg\"]\n"
        "quantities = [\"lift_force\", \"drag_force\", \"pitch_moment\", \"pitch_moment_at_buoyancy\"]\n"
        "[[design.vary]]\nkey = \"body.base_cut\"\nfrom = 0.74\nto = 0.76\n"
        "[[design.fidelity]]\nname = \"draft\"\niterations = 12\n");
    const auto ran = test::run_underbody({"design", "run", ".", "--json"}, folder.path());
    ASSERT_EQ(ran.exit_code, 0) << ran.errors;
    EXPECT_EQ(json::parse(ran.output)["runs"], 2);
    const fs::path results = folder.path() / "design" / "results.csv";
    const core::Table table = core::read_csv(results);
    ASSERT_EQ(table.rows(), 2u);
    const std::size_t made = table.numbers("pitch")[0] > 0 ? 0 : 1;
    EXPECT_THAT(table.text("state")[1 - made], HasSubstr("below the ground"));
    EXPECT_TRUE(std::isnan(table.numbers("lift_force")[1 - made]));
    // Twelve iterations settle nothing.
    EXPECT_EQ(table.text("state")[made], "not settled");
    const json mesh =
        json::parse(core::read_file(folder.path() / "design/runs/draft/design-001-h3-p1-u0.5/constant/mesh.json"));
    EXPECT_GE(mesh["cells_in_gap"], 15);
    // About the centre of buoyancy of that body, by the centroid of its surface.
    const json mass = json::parse(
        test::run_underbody({"body", "design/shapes/design-001.toml", "--json", "--panels", "0"}, folder.path())
            .output);
    const double x = mass["centroid"][0], z = mass["centroid"][2], a = M_PI / 180;
    EXPECT_NEAR(table.numbers("pitch_moment_at_buoyancy")[made],
                table.numbers("pitch_moment")[made] -
                    (x * std::cos(a) - z * std::sin(a)) * table.numbers("lift_force")[made] -
                    (x * std::sin(a) + z * std::cos(a)) * table.numbers("drag_force")[made],
                1e-5);
    // What the run's own criterion says of it counts, not the trend that the loads have at its end.
    const fs::path marker = folder.path() / "design/runs/draft/design-001-h3-p1-u0.5/case.foam";
    json said = json::parse(core::read_file(marker));
    said["settled"] = true;
    core::write_file(marker, said.dump(2));
    EXPECT_EQ(test::run_underbody({"design", "run", "."}, folder.path()).exit_code, 0);
    EXPECT_EQ(core::read_csv(results).text("state")[made], "solved");
    said["settled"] = false;
    core::write_file(marker, said.dump(2));
    fs::remove(results);
    EXPECT_EQ(test::run_underbody({"design", "run", "."}, folder.path()).exit_code, 0);
    EXPECT_EQ(core::read_csv(results).text("state")[0], "not settled");
    // What is there is not made again; what lost its fields keeps its row.
    const std::string before = core::read_file(results);
    EXPECT_EQ(test::run_underbody({"design", "run", "."}, folder.path()).exit_code, 0);
    EXPECT_EQ(core::read_file(results), before);
    std::string trusted = before;
    trusted.replace(trusted.find("not settled"), 11, "solved");
    core::write_file(results, trusted);
    fs::remove_all(folder.path() / "design" / "runs");
    EXPECT_EQ(test::run_underbody({"design", "run", "."}, folder.path()).exit_code, 0);
    EXPECT_EQ(core::read_file(results), trusted);
    EXPECT_FALSE(fs::exists(folder.path() / "design/runs/draft/design-001-h3-p1-u0.5"));
}

}  // namespace underbody
