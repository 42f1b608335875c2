// Sweeps through a real Slurm. The solver is the stand-in.
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/file.h"
#include "core/text.h"
#include "tests/studio/real_slurm.h"

namespace underbody {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// Cases as `sweep --list --json` has them.
json listed(const std::string& output) { return json::parse(output).at("cases"); }

bool all_past(const json& cases, int iteration) {
    return std::all_of(cases.begin(), cases.end(), [&](const json& one) { return one.at("iteration") >= iteration; });
}

/// How often the solver began in a case: each time from another iteration.
std::size_t starts(const fs::path& folder) {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder / "postProcessing" / "forces")) {
        count += entry.is_directory() ? 1 : 0;
    }
    return count;
}

TEST_F(RealSlurm, AJobArrayMakesTheCasesOnceAndTheListFollowsIt) {
    const std::string job = submit();
    ASSERT_FALSE(job.empty());
    EXPECT_TRUE(wait_for([&] { return count(states(), "running") == 2; })) << json(states());
    EXPECT_THAT(run({"sweep", "study", "--engine", "slurm"}).output,
                HasSubstr("nothing is missing that does not wait or run"));
    // Begun jobs hold the lock of their case, others have its mark.
    EXPECT_THAT(run({"sweep", "study"}).output, testing::AnyOf(HasSubstr("left alone: submitted as job " + job),
                                                               HasSubstr("left alone: being made by process")));
    release();
    expect_all_solved(2);
    for (const auto& [name, state] : states()) {
        EXPECT_EQ(meshed(name), 1U) << name;
    }
    // The same bytes as on this machine.
    const fs::path by_slurm = folder_.path() / "by-slurm";
    fs::rename(runs(), by_slurm);
    ASSERT_EQ(run({"sweep", "study"}).exit_code, 0);
    const auto local = results_below(runs()), remote = results_below(by_slurm);
    EXPECT_FALSE(local.empty());
    for (const auto& [name, bytes] : local) {
        ASSERT_TRUE(remote.contains(name)) << name;
        EXPECT_EQ(remote.at(name), bytes) << name;
    }
}

TEST_F(RealSlurm, ACancelledJobFreesItsCasesForTheNext) {
    const std::string job = submit();
    ASSERT_TRUE(wait_for([&] { return count(states(), "running") == 2; })) << json(states());
    ASSERT_TRUE(wait_for([&] {
        return all_past(listed(run({"sweep", "study", "--list", "--json"}).output), 7);
    })) << json(states());
    ASSERT_EQ(slurm("scancel", {job}).exit_code, 0);
    EXPECT_TRUE(wait_for([&] { return count(states(), "running") + count(states(), "waiting") == 0; }))
        << json(states());
    EXPECT_EQ(count(states(), "solved"), 0U);
    release();
    EXPECT_NE(submit(), job);
    expect_all_solved(2);
    for (const auto& [name, state] : states()) {
        EXPECT_EQ(meshed(name), 1U) << name;
        EXPECT_EQ(starts(runs() / name), 2U) << name << " went on from its checkpoint";
    }
}

TEST_F(RealSlurm, AKilledTaskIsMissingAgainAndTheOtherGoesOn) {
    const std::string job = submit();
    ASSERT_TRUE(wait_for([&] { return count(states(), "running") == 2; })) << json(states());
    ASSERT_EQ(slurm("scancel", {"--signal=KILL", "--full", job + "_1"}).exit_code, 0);
    ASSERT_TRUE(wait_for([&] { return count(states(), "running") == 1; })) << json(states());
    release();
    EXPECT_TRUE(wait_for([&] { return count(states(), "solved") == 1 && count(states(), "running") == 0; }))
        << json(states());
    EXPECT_EQ(count(states(), "waiting"), 0U);
    submit();
    expect_all_solved(2);
}

TEST_F(RealSlurm, ACaseThatFailsIsListedWithItsReasonAndTriedAgain) {
    hook("if [ $i = 17 ]; then exit 1; fi");
    const auto made = run({"sweep", "study", "--engine", "slurm", "--wait"});
    EXPECT_EQ(made.exit_code, 3) << made.output << made.errors;
    const json cases = listed(run({"sweep", "study", "--list", "--json"}).output);
    ASSERT_EQ(cases.size(), 2U);
    for (const auto& one : cases) {
        EXPECT_EQ(one.at("state"), "failed");
        EXPECT_THAT(one.at("reason").get<std::string>(), HasSubstr("simpleFoam")) << one;
    }
    hook("true");
    submit();
    expect_all_solved(2);
}

TEST_F(RealSlurm, ARequeuedTaskWaitsForItsSecondRunAndFinishes) {  // as one that was preempted
    const std::string job = submit();
    ASSERT_TRUE(wait_for([&] { return count(states(), "running") == 2; })) << json(states());
    ASSERT_EQ(slurm("scontrol", {"requeue", job + "_1"}).exit_code, 0);
    EXPECT_TRUE(wait_for([&] { return count(states(), "waiting") == 1; })) << json(states());
    EXPECT_THAT(run({"sweep", "study", "--engine", "slurm"}).output,
                HasSubstr("nothing is missing that does not wait or run"));
    release();
    start_now(job + "_1");
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
    release();
    expect_all_solved(2);
}

TEST_F(RealSlurm, MoreCasesThanTheSiteTakesInOneArrayMakeSeveral) {
    write_study("study", "[\"5 mm\", \"6 mm\", \"7 mm\", \"8 mm\", \"10 mm\"]");
    release();
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

TEST_F(RealSlurm, JobsHaveWhatTheStudyAsksFor) {
    write_study("study", "[\"5 mm\", \"10 mm\", \"20 mm\"]");
    const fs::path file = folder_.path() / "study" / "study.toml";
    core::write_file(file, core::read_file(file) +
                               "[sweep.slurm]\npartition = \"tests\"\ntime = \"00:30:00\"\nmemory = \"300M\"\naccount "
                               "= \"hull\"\nthrottle = 1\ncores = 2\nmax_array = 2\noptions = [\"--nice=100\"]\n");
    const auto submitted = run({"sweep", "study", "--engine", "slurm", "--json"});
    ASSERT_EQ(submitted.exit_code, 0) << submitted.errors;
    const json arrays = json::parse(submitted.output).at("arrays");
    ASSERT_EQ(arrays.size(), 2U);
    for (const auto& array : arrays) {
        const std::string job = slurm("scontrol", {"show", "job", array.at("job").get<std::string>()}).output;
        for (const char* has : {"Partition=tests", "TimeLimit=00:30:00", "MinMemoryNode=300M", "Account=hull",
                                "NumCPUs=2", "NumNodes=1", "Nice=100", "Requeue=1"}) {
            EXPECT_THAT(job, HasSubstr(has)) << array;
        }
    }
    // One at a time: also the second array waits for the first.
    EXPECT_THAT(slurm("scontrol", {"show", "job", arrays.at(0).at("job")}).output, HasSubstr("ArrayTaskThrottle=1"));
    EXPECT_THAT(slurm("scontrol", {"show", "job", arrays.at(1).at("job")}).output,
                HasSubstr("Dependency=afterany:" + arrays.at(0).at("job").get<std::string>()));
}

TEST_F(RealSlurm, ACasePastItsTimeGoesOnFromItsCheckpointInTheNextJob) {
    const std::string job = submit();
    ASSERT_TRUE(wait_for([&] {
        return all_past(listed(run({"sweep", "study", "--list", "--json"}).output), 7);
    })) << json(states());
    // Its limit is a minute at least: shortened once it runs, it is over at once.
    for (const char* task : {"_1", "_2"}) {
        EXPECT_EQ(slurm("scontrol", {"update", "JobId=" + job + task, "TimeLimit=00:00:01"}).exit_code, 0);
    }
    ASSERT_TRUE(wait_for([&] { return count(states(), "missing") == 2; }, 120)) << json(states());
    for (const auto& one : listed(run({"sweep", "study", "--list", "--json"}).output)) {
        EXPECT_THAT(one.at("reason").get<std::string>(), HasSubstr("cut at iteration"));
    }
    release();
    EXPECT_NE(submit(), job);
    expect_all_solved(2);
    for (const auto& [name, state] : states()) {
        EXPECT_EQ(meshed(name), 1U) << name;
        EXPECT_EQ(starts(runs() / name), 2U) << name << " went on from its checkpoint";
    }
}

TEST_F(RealSlurm, AnUrgentJobPreemptsCasesWhichGoOnFromTheirCheckpoints) {
    const std::string job = submit();
    // Checkpoints are written every five iterations; the stand-in says that each takes a second.
    ASSERT_TRUE(wait_for([&] {
        return all_past(listed(run({"sweep", "study", "--list", "--json"}).output), 7);
    })) << json(states());
    const json running = listed(run({"sweep", "study", "--list", "--json"}).output).at(0);
    EXPECT_EQ(running.at("iterations"), 40);
    EXPECT_EQ(running.at("seconds_left"), 40 - running.at("iteration").get<int>());
    EXPECT_THAT(running.at("reason").get<std::string>(), HasSubstr(" s left"));
    ASSERT_EQ(
        slurm("sbatch", {"--partition=urgent", "--ntasks=2", "--output=/dev/null", "--wrap", "sleep 1"}).exit_code, 0);
    EXPECT_TRUE(wait_for([&] { return count(states(), "waiting") == 2; })) << json(states());
    release();
    for (const char* task : {"_1", "_2"}) {
        start_now(job + task);
    }
    expect_all_solved(2);
    for (const auto& [name, state] : states()) {
        EXPECT_EQ(meshed(name), 1U) << name;
        EXPECT_EQ(starts(runs() / name), 2U) << name << " went on";
    }
}

TEST_F(RealSlurm, AJobRunsTheStudyWhenTheArraysHaveEnded) {
    release();
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
    release();
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
