// Sweeps through a real Slurm: one node, two slots, started by tests/slurm/start for these tests and ended with them.
// The solver is the stand-in. Skipped, saying why, where Slurm cannot be started.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "core/file.h"
#include "core/text.h"
#include "tests/studio/stand_in_solver.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// Arrays of at most two tasks: indices end below MaxArraySize.
constexpr const char* max_array_size = "3";

class RealSlurm : public testing::Test {
protected:
    static void SetUpTestSuite() {
        slurm_ = std::make_unique<core::TemporaryFolder>();
        const fs::path said = slurm_->path() / "said";
        starter_ = ::fork();
        if (starter_ == 0) {
            ::setenv("UNDERBODY_SLURM_ARRAY", max_array_size, 1);
            ::dup2(::open(said.c_str(), O_WRONLY | O_CREAT, 0644), 1);
            ::dup2(1, 2);
            const std::string script = (test::source_folder() / "tests" / "slurm" / "start").string();
            const std::string folder = (slurm_->path() / "slurm").string();
            ::execl("/bin/bash", "bash", script.c_str(), folder.c_str(), nullptr);
            ::_exit(77);
        }
        for (int i = 0; i < 400 && reason_.empty(); ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            const std::string text = fs::exists(said) ? core::read_file(said) : "";
            if (text.find("ready") != std::string::npos) {
                return;
            }
            if (::waitpid(starter_, nullptr, WNOHANG) == starter_) {
                starter_ = -1;
                reason_ = text.empty() ? "tests/slurm/start does not run" : text;
            }
        }
        reason_ = reason_.empty() ? "Slurm does not start within 40 s" : reason_;
    }
    static void TearDownTestSuite() {
        if (starter_ > 0) {
            ::kill(starter_, SIGTERM);
            ::waitpid(starter_, nullptr, 0);
        }
        starter_ = -1;
        slurm_.reset();
    }
    void SetUp() override {
        if (!reason_.empty()) {
            GTEST_SKIP() << "skipped: no Slurm: " << reason_;
        }
        test::write_stand_in_solver(folder_.path() / "bin");
        write_study("study");
        hook("sleep 0.1");
    }
    void TearDown() override {
        if (reason_.empty()) {  // nothing of this test runs on into the next
            slurm("scancel", {"--user=root"});
            wait_for([&] { return slurm("squeue", {"--noheader"}).output.empty(); });
        }
    }

    void write_study(const std::string& name, const std::string& gaps = "[\"5 mm\", \"10 mm\"]") {
        fs::create_directories(folder_.path() / name);
        fs::copy_file(test::source_folder() / "cases" / "evie" / "shapes" / "ellipse.toml",
                      folder_.path() / name / "ellipse.toml", fs::copy_options::overwrite_existing);
        core::write_file(folder_.path() / name / "study.toml",
                         "title = \"a sweep\"\n[frame]\nsymmetry = \"y\"\n[reference]\ndensity = \"998 "
                         "kg/m^3\"\n[[body]]\nname = \"ellipse\"\nshape = \"ellipse.toml\"\n[sweep]\ngap = " +
                             gaps +
                             "\npitch = \"1 deg\"\nspeed = \"0.5 m/s\"\nconditions = { mesh = \"coarse\" }\n"
                             "mesher = \"snappy\"\niterations = 40\n");
    }
    void hook(const std::string& script) { core::write_file(folder_.path() / "hook", script + "\n"); }
    [[nodiscard]] fs::path runs() const { return folder_.path() / "study" / "runs"; }
    [[nodiscard]] std::map<std::string, std::string> environment() const {
        const char* path = std::getenv("PATH");
        return {{"PATH", (folder_.path() / "bin").string() + ":" + (path != nullptr ? path : "/usr/bin:/bin")},
                {"HOOK", (folder_.path() / "hook").string()},
                {"SLURM_CONF", (slurm_->path() / "slurm" / "slurm.conf").string()}};
    }
    test::ProgramRun run(const std::vector<std::string>& arguments) {
        return test::run_underbody(arguments, folder_.path(), environment());
    }
    test::ProgramRun slurm(const std::string& program, const std::vector<std::string>& arguments) {
        for (const char* where : {"/usr/bin", "/usr/local/bin"}) {
            if (fs::exists(fs::path(where) / program)) {
                return test::run_program((fs::path(where) / program).string(), arguments, folder_.path(),
                                         environment());
            }
        }
        return {127, "", program + " is not here"};
    }
    /// Number of the (last) job.
    std::string submit() {
        const auto submitted = run({"sweep", "study", "--engine", "slurm", "--json"});
        EXPECT_EQ(submitted.exit_code, 0) << submitted.errors;
        return submitted.exit_code == 0 ? json::parse(submitted.output).value("job", "") : "";
    }
    std::map<std::string, std::string> states() {
        const auto listed = run({"sweep", "study", "--list", "--json"});
        EXPECT_EQ(listed.exit_code, 0) << listed.errors;
        std::map<std::string, std::string> states;
        const json told = json::parse(listed.output);
        for (const auto& one : told.at("cases")) {
            states[one.at("name")] = one.at("state");
        }
        return states;
    }
    [[nodiscard]] static std::size_t count(const std::map<std::string, std::string>& states, const std::string& state) {
        return static_cast<std::size_t>(
            std::count_if(states.begin(), states.end(), [&](const auto& one) { return one.second == state; }));
    }
    static bool wait_for(const std::function<bool()>& done, int seconds = 60) {
        for (int i = 0; i < 5 * seconds; ++i) {
            if (done()) {
                return true;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(200));
        }
        return false;
    }
    void expect_all_solved(std::size_t cases) {
        EXPECT_TRUE(wait_for([&] { return count(states(), "solved") == cases; }))
            << json(states()) << slurm("squeue", {}).output;
        for (const auto& entry : fs::directory_iterator(runs())) {
            EXPECT_NE(entry.path().extension(), ".submitted") << entry.path();
        }
    }
    /// How often the mesher ran in a case.
    [[nodiscard]] std::size_t meshed(const std::string& name) const {
        const fs::path file = runs() / name / "meshed";
        return fs::exists(file) ? core::split(core::trimmed(core::read_file(file)), '\n').size() : 0;
    }

    core::TemporaryFolder folder_;

private:
    static std::unique_ptr<core::TemporaryFolder> slurm_;
    static pid_t starter_;
    static std::string reason_;
};

std::unique_ptr<core::TemporaryFolder> RealSlurm::slurm_;
pid_t RealSlurm::starter_ = -1;
std::string RealSlurm::reason_;

/// Every file of a solved case that is no log, and its marker but for the seconds that it took.
std::map<std::string, std::string> results_below(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = entry.path().lexically_relative(folder).string();
        if (entry.is_regular_file() && name.find("log") == std::string::npos && !name.starts_with(".")) {
            const std::string bytes = core::read_file(entry.path());
            static const std::regex taken("\"seconds\": [^,\n]*");
            files[name] = entry.path().filename() == "case.foam" ? std::regex_replace(bytes, taken, "") : bytes;
        }
    }
    return files;
}

TEST_F(RealSlurm, AJobArrayMakesTheCasesOnceAndTheListFollowsIt) {
    const std::string job = submit();
    ASSERT_FALSE(job.empty());
    EXPECT_TRUE(wait_for([&] { return count(states(), "running") == 2; }, 20)) << json(states());
    EXPECT_THAT(run({"sweep", "study", "--engine", "slurm"}).output,
                HasSubstr("nothing is missing that does not wait or run"));
    // Begun jobs hold the lock of their case, others have its mark.
    EXPECT_THAT(run({"sweep", "study"}).output, testing::AnyOf(HasSubstr("left alone: submitted as job " + job),
                                                               HasSubstr("left alone: being made by process")));
    expect_all_solved(2);
    for (const auto& [name, state] : states()) {
        EXPECT_EQ(meshed(name), 1U) << name;
    }
    // The same bytes as on this machine.
    const fs::path by_slurm = folder_.path() / "by-slurm";
    fs::rename(runs(), by_slurm);
    hook("true");
    ASSERT_EQ(run({"sweep", "study"}).exit_code, 0);
    const auto local = results_below(runs()), remote = results_below(by_slurm);
    EXPECT_FALSE(local.empty());
    for (const auto& [name, bytes] : local) {
        ASSERT_TRUE(remote.contains(name)) << name;
        EXPECT_EQ(remote.at(name), bytes) << name;
    }
}

TEST_F(RealSlurm, ACancelledJobFreesItsCasesForTheNext) {
    hook("sleep 0.2");
    const std::string job = submit();
    ASSERT_TRUE(wait_for([&] { return count(states(), "running") == 2; }, 20)) << json(states());
    ASSERT_EQ(slurm("scancel", {job}).exit_code, 0);
    EXPECT_TRUE(wait_for([&] { return count(states(), "running") + count(states(), "waiting") == 0; }))
        << json(states());
    EXPECT_EQ(count(states(), "solved"), 0U);
    hook("true");
    EXPECT_NE(submit(), job);
    expect_all_solved(2);
}

TEST_F(RealSlurm, AKilledTaskIsMissingAgainAndTheOtherGoesOn) {
    hook("sleep 0.1");
    const std::string job = submit();
    ASSERT_TRUE(wait_for([&] { return count(states(), "running") == 2; }, 20)) << json(states());
    ASSERT_EQ(slurm("scancel", {"--signal=KILL", "--full", job + "_1"}).exit_code, 0);
    EXPECT_TRUE(wait_for([&] { return count(states(), "solved") == 1 && count(states(), "running") == 0; }))
        << json(states());
    EXPECT_EQ(count(states(), "waiting"), 0U);
    hook("true");
    submit();
    expect_all_solved(2);
}

TEST_F(RealSlurm, ARequeuedTaskWaitsForItsSecondRunAndFinishes) {  // as one that was preempted
    hook("sleep 0.1");
    const std::string job = submit();
    ASSERT_TRUE(wait_for([&] { return count(states(), "running") == 2; }, 20)) << json(states());
    ASSERT_EQ(slurm("scontrol", {"requeue", job + "_1"}).exit_code, 0);
    EXPECT_TRUE(wait_for([&] { return count(states(), "waiting") == 1; }, 20)) << json(states());
    EXPECT_THAT(run({"sweep", "study", "--engine", "slurm"}).output,
                HasSubstr("nothing is missing that does not wait or run"));
    hook("true");
    // Slurm lets it wait for two minutes; what was killed has ended long before, here it is given three seconds.
    std::this_thread::sleep_for(std::chrono::seconds(3));
    ASSERT_EQ(slurm("scontrol", {"update", "JobId=" + job + "_1", "StartTime=now"}).exit_code, 0);
    expect_all_solved(2);
}

TEST_F(RealSlurm, WhatWaitsForADrainedNodeIsLeftToIt) {
    const std::string node(core::trimmed(slurm("sinfo", {"--noheader", "--format", "%n"}).output));
    ASSERT_EQ(slurm("scontrol", {"update", "NodeName=" + node, "State=DRAIN", "Reason=test"}).exit_code, 0);
    const std::string job = submit();
    std::this_thread::sleep_for(std::chrono::seconds(1));
    EXPECT_EQ(count(states(), "waiting"), 2U) << json(states());
    const auto local = run({"sweep", "study"});
    EXPECT_EQ(local.exit_code, 0) << local.errors;
    EXPECT_THAT(local.output, HasSubstr("left alone: submitted as job " + job));
    ASSERT_EQ(slurm("scontrol", {"update", "NodeName=" + node, "State=RESUME"}).exit_code, 0);
    expect_all_solved(2);
}

TEST_F(RealSlurm, MoreCasesThanTheSiteTakesInOneArrayMakeSeveral) {
    write_study("study", "[\"5 mm\", \"6 mm\", \"7 mm\", \"8 mm\", \"10 mm\"]");
    hook("true");
    const auto submitted = run({"sweep", "study", "--engine", "slurm", "--json"});
    ASSERT_EQ(submitted.exit_code, 0) << submitted.errors;
    EXPECT_EQ(json::parse(submitted.output).at("arrays").size(), 3U);
    expect_all_solved(5);
    for (const auto& [name, state] : states()) {
        EXPECT_EQ(meshed(name), 1U) << name;
    }
    // The site's own refusal comes through in its words, and leaves nothing claimed.
    fs::remove_all(runs());
    const auto refused = run({"sweep", "study", "--engine", "slurm", "--max-array", "5"});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_THAT(refused.errors, HasSubstr("sbatch refused the job"));
    EXPECT_EQ(count(states(), "missing"), 5U);
    const auto elsewhere = run({"sweep", "study", "--engine", "slurm", "--partition", "none-such"});
    EXPECT_EQ(elsewhere.exit_code, 3);
    EXPECT_THAT(elsewhere.errors, HasSubstr("invalid partition"));
}

/// Cases as `sweep --list --json` has them.
json listed(const std::string& output) { return json::parse(output).at("cases"); }

TEST_F(RealSlurm, AnUrgentJobPreemptsCasesWhichGoOnFromTheirCheckpoints) {
    const std::string job = submit();
    // Checkpoints are written every five iterations; the stand-in says that each takes a second.
    ASSERT_TRUE(wait_for([&] {
        const json cases = listed(run({"sweep", "study", "--list", "--json"}).output);
        return std::all_of(cases.begin(), cases.end(), [](const json& one) { return one.at("iteration") >= 7; });
    })) << json(states());
    const json running = listed(run({"sweep", "study", "--list", "--json"}).output).at(0);
    EXPECT_EQ(running.at("iterations"), 40);
    EXPECT_EQ(running.at("seconds_left"), 40 - running.at("iteration").get<int>());
    EXPECT_THAT(running.at("reason").get<std::string>(), HasSubstr(" s left"));
    ASSERT_EQ(
        slurm("sbatch", {"--partition=urgent", "--ntasks=2", "--output=/dev/null", "--wrap", "sleep 1"}).exit_code, 0);
    EXPECT_TRUE(wait_for([&] { return count(states(), "waiting") == 2; })) << json(states());
    hook("true");
    // Slurm lets them wait for two minutes; what was killed has ended long before, here it is given three seconds.
    std::this_thread::sleep_for(std::chrono::seconds(3));
    for (const char* task : {"_1", "_2"}) {
        ASSERT_EQ(slurm("scontrol", {"update", "JobId=" + job + task, "StartTime=now"}).exit_code, 0);
    }
    expect_all_solved(2);
    for (const auto& [name, state] : states()) {
        EXPECT_EQ(meshed(name), 1U) << name;
        std::size_t starts = 0;
        for (const auto& entry : fs::directory_iterator(runs() / name / "postProcessing" / "forces")) {
            starts += entry.is_directory() ? 1 : 0;
        }
        EXPECT_EQ(starts, 2U) << name << " went on";
    }
}

TEST_F(RealSlurm, AJobRunsTheStudyWhenTheArraysHaveEnded) {
    hook("true");
    const auto made = run({"sweep", "study", "--engine", "slurm", "--run-study", "--wait", "--json"});
    ASSERT_EQ(made.exit_code, 0) << made.output << made.errors;
    for (const auto& one : listed(made.output)) {
        EXPECT_EQ(one.at("state"), "solved");
    }
    EXPECT_THAT(core::read_file(runs() / "sweep-study.sh"), HasSubstr(" study run "));
    // Its output stands beside the cases.
    const auto output = [&] {
        std::string text;
        for (const auto& entry : fs::directory_iterator(runs())) {
            const std::string name = entry.path().filename().string();
            if (name.starts_with("slurm-") && name.find('_') == std::string::npos) {
                text += core::read_file(entry.path());
            }
        }
        return text;
    };
    EXPECT_TRUE(wait_for([&] { return slurm("squeue", {"--noheader"}).output.empty(); }));
    EXPECT_THAT(output(), HasSubstr("ellipse-h5-p1-u0.5")) << "the study ran, with the cases of the sweep";
}

TEST_F(RealSlurm, OneCaseAtATimeUntilAllIsCancelled) {
    const auto submitted = run({"sweep", "study", "--engine", "slurm", "--run-study", "--throttle", "1", "--json"});
    ASSERT_EQ(submitted.exit_code, 0) << submitted.errors;
    const json told = json::parse(submitted.output);
    EXPECT_THAT(slurm("squeue", {"--noheader", "--format", "%E", "--jobs", told.at("study").at("job")}).output,
                HasSubstr("afterany:" + told.at("job").get<std::string>()));
    ASSERT_TRUE(wait_for([&] { return count(states(), "running") == 1; })) << json(states());
    EXPECT_EQ(count(states(), "waiting"), 1U);
    const auto cancelled = run({"sweep", "study", "--cancel", "--json"});
    ASSERT_EQ(cancelled.exit_code, 0) << cancelled.errors;
    EXPECT_EQ(json::parse(cancelled.output).at("cancelled"), json::array({told.at("job")}));
    EXPECT_TRUE(wait_for([&] { return slurm("squeue", {"--noheader"}).output.empty(); }))
        << "the job that runs the study is cancelled too";
    EXPECT_TRUE(wait_for([&] { return count(states(), "running") + count(states(), "waiting") == 0; }))
        << json(states());
    EXPECT_EQ(count(states(), "solved"), 0U);
    EXPECT_THAT(run({"sweep", "study", "--cancel"}).output, HasSubstr("Slurm has no job of this sweep"));
    hook("true");
    submit();
    expect_all_solved(2);
}

TEST_F(RealSlurm, CasesOnTwoCoresAreTriedAgainWhenTheirSolverIsKilled) {
    const fs::path file = folder_.path() / "study" / "study.toml";
    core::write_file(file, core::read_file(file) + "[sweep.slurm]\ncores = 2\nretries = 1\n");
    hook("if [ $i = 17 ] && [ ! -e ../again ]; then touch ../again; kill -9 $$; fi");
    const auto made = run({"sweep", "study", "--engine", "slurm", "--wait"});
    ASSERT_EQ(made.exit_code, 0) << made.output << made.errors;
    expect_all_solved(2);
    EXPECT_THAT(core::read_file(runs() / "sweep.sh"), HasSubstr("#SBATCH --ntasks=2\n"));
    for (const auto& [name, state] : states()) {
        EXPECT_EQ(core::read_file(runs() / name / "cores"), "2\n2\n") << name;
        EXPECT_EQ(meshed(name), 1U) << name;
    }
}

}  // namespace
}  // namespace underbody
