// solve and sweep as a user runs them, with a stand-in for OpenFOAM: programs of its names that write what it writes.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/file.h"
#include "core/text.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class SolveCommands : public testing::Test {
protected:
    SolveCommands() {
        program("blockMesh", "mkdir -p constant/polyMesh && touch constant/polyMesh/points");
        program("surfaceFeatureExtract", "true");
        program("snappyHexMesh", "true");
        program("checkMesh", "true");
        program("simpleFoam",
                "end=$(sed -n 's/^endTime \\([0-9]*\\);.*/\\1/p' system/controlDict)\n"
                "echo \"\nTime = 1\"\necho \"\nTime = $end\"\nmkdir -p $end postProcessing/forces/0\ntouch $end/U $end/p\n"
                "echo '# Time (total_x total_y total_z) (pressure_x pressure_y pressure_z) (viscous_x viscous_y viscous_z)' > postProcessing/forces/0/force.dat\n"
                "echo \"$end (-1.5 0 2) (-1 0 2) (-0.5 0 0)\" >> postProcessing/forces/0/force.dat");
    }

    void program(const std::string& name, const std::string& script) {
        const fs::path file = folder_.path() / "bin" / name;
        core::write_file(file, "#!/bin/sh\n" + script + "\n");
        fs::permissions(file, fs::perms::owner_all);
    }
    [[nodiscard]] std::map<std::string, std::string> environment() const { return {{"PATH", (folder_.path() / "bin").string() + ":/usr/bin:/bin"}}; }
    test::ProgramRun run(const std::vector<std::string>& arguments) { return test::run_underbody(arguments, folder_.path(), environment()); }

    void write_study() {
        fs::create_directories(folder_.path() / "study");
        fs::copy(test::source_folder() / "cases" / "evie" / "shapes" / "ellipse.toml", folder_.path() / "study" / "ellipse.toml");
        core::write_file(folder_.path() / "study" / "study.toml",
                         "title = \"a sweep\"\n[frame]\nsymmetry = \"y\"\n[reference]\ndensity = \"998 kg/m^3\"\n[[body]]\nname = \"ellipse\"\nshape = \"ellipse.toml\"\n"
                         "[sweep]\ngap = [\"5 mm\", \"10 mm\"]\npitch = \"1 deg\"\nspeed = \"0.5 m/s\"\nconditions = { mesh = \"coarse\" }\niterations = 40\n");
    }
    core::TemporaryFolder folder_;
};

TEST_F(SolveCommands, SolveRunsACaseAndTellsItsForces) {
    ASSERT_EQ(run({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(), "--gap", "10mm", "--out", "case", "--iterations", "30"}).exit_code, 0);
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
    ASSERT_EQ(run({"body", "domain", (test::source_folder() / "cases/evie/shapes/ellipse.toml").string(), "--gap", "10mm", "--out", "case"}).exit_code, 0);
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
    // The study has them with their conditions, without a [[case]].
    const auto list = run({"study", "list", "study"});
    EXPECT_EQ(list.exit_code, 0) << list.errors;
    EXPECT_THAT(list.output, HasSubstr("ellipse-h10-p1-u0.5"));
    EXPECT_EQ(run({"sweep", "study", "--only", "ellipse-h11-p1-u0.5"}).exit_code, 3);
}

TEST_F(SolveCommands, SweepGoesOnPastACaseThatFailsAndKeepsItsLogs) {
    write_study();
    program("checkMesh", "case \"$PWD\" in *h5*) echo 'mesh is bad'; exit 1;; esac");
    const auto sweep = run({"sweep", "study", "--jobs", "1"});
    EXPECT_EQ(sweep.exit_code, 3);
    EXPECT_THAT(sweep.output, HasSubstr("ellipse-h10-p1-u0.5: solved"));
    EXPECT_THAT(sweep.errors, HasSubstr("mesh is bad"));
    EXPECT_TRUE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5.failed/log.checkMesh"));
    program("checkMesh", "true");
    EXPECT_EQ(run({"sweep", "study"}).exit_code, 0);
    EXPECT_FALSE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5.failed"));
    EXPECT_TRUE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5/case.foam"));
}

TEST_F(SolveCommands, SweepWritesAndSubmitsAJobArray) {
    write_study();
    const auto alone = run({"sweep", "study", "--engine", "slurm"});
    EXPECT_EQ(alone.exit_code, 0) << alone.errors;
    const std::string script = core::read_file(folder_.path() / "study/runs/sweep.sh");
    EXPECT_THAT(script, HasSubstr("#SBATCH --array=1-2"));
    EXPECT_THAT(script, HasSubstr("2) name='ellipse-h10-p1-u0.5' ;;"));
    program("sbatch", "cp \"$2\" submitted.sh; echo 4711");
    const auto submitted = run({"sweep", "study", "--engine", "slurm", "--json"});
    EXPECT_EQ(submitted.exit_code, 0) << submitted.errors;
    EXPECT_EQ(json::parse(submitted.output)["job"], "4711");
    // A task of the array makes its case.
    auto variables = environment();
    variables["SLURM_ARRAY_TASK_ID"] = "2";
    const auto task = test::run_program("/bin/sh", {(folder_.path() / "study/runs/sweep.sh").string()}, "/", variables);
    EXPECT_EQ(task.exit_code, 0) << task.errors;
    EXPECT_TRUE(fs::exists(folder_.path() / "study/runs/ellipse-h10-p1-u0.5/case.foam"));
    program("sbatch", "echo 'invalid partition' >&2; exit 1");
    const auto refused = run({"sweep", "study", "--engine", "slurm"});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_THAT(refused.errors, HasSubstr("invalid partition"));
}

TEST_F(SolveCommands, CtrlCEndsTheSolverTooAndTheSweepGoesOnLater) {
    write_study();
    const fs::path pids = folder_.path() / "pids";
    core::write_file(folder_.path() / "slow", "");
    program("checkMesh", "if [ -e '" + (folder_.path() / "slow").string() + "' ]; then echo $$ >> '" + pids.string() + "'; sleep 60; fi");
    const pid_t child = ::fork();
    if (child == 0) {
        const auto path = environment().at("PATH");
        ::setenv("PATH", path.c_str(), 1);
        const int nowhere = ::open("/dev/null", O_RDWR);
        ::dup2(nowhere, 1);
        ::dup2(nowhere, 2);
        const std::string underbody = (test::program_folder() / "underbody").string();
        const std::string study = (folder_.path() / "study").string();
        ::execl(underbody.c_str(), underbody.c_str(), "sweep", study.c_str(), "--jobs", "2", nullptr);
        ::_exit(127);
    }
    const auto lines = [&] { return fs::exists(pids) ? core::split(core::read_file(pids), '\n').size() - 1 : 0; };
    for (int i = 0; i < 1500 && lines() < 2; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ASSERT_EQ(lines(), 2U);
    ::kill(child, SIGINT);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 130);
    const std::string text = core::read_file(pids);
    for (const auto line : core::split(text, '\n')) {
        if (const auto pid = core::parse_integer(line)) {
            // Gone, or a zombie that nobody has fetched yet.
            std::ifstream state("/proc/" + std::to_string(*pid) + "/stat");
            std::string words;
            std::getline(state, words);
            EXPECT_TRUE(words.empty() || words.find(") Z") != std::string::npos) << "the solver still runs: " << words;
        }
    }
    EXPECT_FALSE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5"));
    fs::remove(folder_.path() / "slow");
    EXPECT_EQ(run({"sweep", "study"}).exit_code, 0);
    EXPECT_TRUE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5/case.foam"));
    EXPECT_FALSE(fs::exists(folder_.path() / "study/runs/ellipse-h5-p1-u0.5.unfinished"));
}

}  // namespace
}  // namespace underbody
