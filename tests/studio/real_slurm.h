// A real Slurm of one node with two slots, started by tests/slurm/start for the tests of a program and ended with them.
// Tests are skipped, saying why, where it cannot be started.
#pragma once

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

/// Arrays of at most two tasks: indices end below MaxArraySize.
inline constexpr const char* max_array_size = "3";

class RealSlurm : public testing::Test {
protected:
    static void SetUpTestSuite() {
        slurm_ = std::make_unique<core::TemporaryFolder>();
        const std::filesystem::path said = slurm_->path() / "said";
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
            const std::string text = std::filesystem::exists(said) ? core::read_file(said) : "";
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
        hold();
    }
    void TearDown() override {
        if (reason_.empty()) {  // nothing of this test runs on into the next
            slurm("scancel", {"--user=root"});
            wait_for([&] { return slurm("squeue", {"--noheader"}).output.empty(); });
        }
    }

    void write_study(const std::string& name, const std::string& gaps = "[\"5 mm\", \"10 mm\"]") {
        std::filesystem::create_directories(folder_.path() / name);
        std::filesystem::copy_file(test::source_folder() / "cases" / "evie" / "shapes" / "ellipse.toml",
                                   folder_.path() / name / "ellipse.toml",
                                   std::filesystem::copy_options::overwrite_existing);
        core::write_file(folder_.path() / name / "study.toml",
                         "title = \"a sweep\"\n[frame]\nsymmetry = \"y\"\n[reference]\ndensity = \"998 "
                         "kg/m^3\"\n[[body]]\nname = \"ellipse\"\nshape = \"ellipse.toml\"\n[sweep]\ngap = " +
                             gaps +
                             "\npitch = \"1 deg\"\nspeed = \"0.5 m/s\"\nconditions = { mesh = \"coarse\" }\n"
                             "mesher = \"snappy\"\niterations = 40\n");
    }
    /// Cases that are begun stop at half their iterations until they are released: none ends before its test has seen
    /// it.
    void hold() {
        const std::string held = (folder_.path() / "held").string();
        core::write_file(held, "");
        hook("while [ $i -ge 20 ] && [ -e '" + held + "' ]; do sleep 0.1; done");
    }
    void release() { std::filesystem::remove(folder_.path() / "held"); }
    void hook(const std::string& script) { core::write_file(folder_.path() / "hook", script + "\n"); }
    [[nodiscard]] std::filesystem::path runs() const { return folder_.path() / "study" / "runs"; }
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
            if (std::filesystem::exists(std::filesystem::path(where) / program)) {
                return test::run_program((std::filesystem::path(where) / program).string(), arguments, folder_.path(),
                                         environment());
            }
        }
        return {127, "", program + " is not here"};
    }
    /// Number of the (last) job.
    std::string submit() {
        const auto submitted = run({"sweep", "study", "--engine", "slurm", "--json"});
        EXPECT_EQ(submitted.exit_code, 0) << submitted.errors;
        return submitted.exit_code == 0 ? nlohmann::json::parse(submitted.output).value("job", "") : "";
    }
    std::map<std::string, std::string> states() {
        const auto listed = run({"sweep", "study", "--list", "--json"});
        EXPECT_EQ(listed.exit_code, 0) << listed.errors;
        std::map<std::string, std::string> states;
        const nlohmann::json told = nlohmann::json::parse(listed.output);
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
    /// A task that was queued again: Slurm lets it wait for two minutes; what was killed has ended long before, here it
    /// is given three seconds.
    void start_now(const std::string& task) {
        std::this_thread::sleep_for(std::chrono::seconds(3));
        EXPECT_TRUE(wait_for([&] {
            return slurm("scontrol", {"update", "JobId=" + task, "StartTime=now"}).exit_code == 0;
        }));
    }
    void expect_all_solved(std::size_t cases) {
        EXPECT_TRUE(wait_for([&] { return count(states(), "solved") == cases; }))
            << nlohmann::json(states()) << slurm("squeue", {}).output;
        // A case is solved a moment before its task ends, which takes the claim away.
        const auto claimed = [this] {
            std::string claims;
            for (const auto& entry : std::filesystem::directory_iterator(runs())) {
                claims += entry.path().extension() == ".submitted" ? entry.path().string() + "\n" : "";
            }
            return claims;
        };
        EXPECT_TRUE(wait_for([&] { return claimed().empty(); })) << claimed();
    }
    /// How often the mesher ran in a case.
    [[nodiscard]] std::size_t meshed(const std::string& name) const {
        const std::filesystem::path file = runs() / name / "meshed";
        return std::filesystem::exists(file) ? core::split(core::trimmed(core::read_file(file)), '\n').size() : 0;
    }

    core::TemporaryFolder folder_;

private:
    static inline std::unique_ptr<core::TemporaryFolder> slurm_;
    static inline pid_t starter_ = -1;
    static inline std::string reason_;
};

/// Every file of a solved case that is no log, and its marker but for the seconds that it took.
inline std::map<std::string, std::string> results_below(const std::filesystem::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::string name = entry.path().lexically_relative(folder).string();
        if (entry.is_regular_file() && name.find("log") == std::string::npos && !name.starts_with(".")) {
            const std::string bytes = core::read_file(entry.path());
            static const std::regex taken("\"seconds\": [^,\n]*");
            files[name] = entry.path().filename() == "case.foam" ? std::regex_replace(bytes, taken, "") : bytes;
        }
    }
    return files;
}

}  // namespace underbody
