// What the tests of solve and sweep share: a study, and programs of OpenFOAM's names that write what it writes.
#pragma once

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/file.h"
#include "core/text.h"
#include "tests/studio/stand_in_solver.h"
#include "tests/support/support.h"

namespace underbody {

/// A folder with a study, a stand-in for the mesher and the solver, and ways to run the program in it.
class SolveCommands : public testing::Test {
protected:
    SolveCommands() {
        // Nothing of OpenFOAM or Slurm that this machine may have is on the path of these tests.
        for (const char* tool : {"sh", "sed", "mkdir", "touch", "printf", "cat", "sleep", "rm", "cp", "tail", "dirname",
                                 "head", "mv", "date", "ln", "grep", "seq"}) {
            for (const char* where : {"/usr/bin", "/bin"}) {
                if (std::filesystem::exists(std::filesystem::path(where) / tool) &&
                    !std::filesystem::exists(folder_.path() / "tools" / tool)) {
                    std::filesystem::create_directories(folder_.path() / "tools");
                    std::filesystem::create_symlink(std::filesystem::path(where) / tool,
                                                    folder_.path() / "tools" / tool);
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
                {"UNDERBODY_HUNG_AFTER", "3 s"},  // of processor time: the stand-ins write before that
                {"HOOK", (folder_.path() / "hook").string()}};
    }
    void hook(const std::string& script) { core::write_file(folder_.path() / "hook", script + "\n"); }
    [[nodiscard]] std::filesystem::path runs() const { return folder_.path() / "study" / "runs"; }
    nlohmann::json list() {
        const auto result = run({"sweep", "study", "--list", "--json"});
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        nlohmann::json cases = nlohmann::json::object();
        const nlohmann::json told = nlohmann::json::parse(result.output);  // lives as long as the loop
        for (const auto& one : told["cases"]) {
            cases[one["name"].get<std::string>()] = one;
        }
        return cases;
    }
    void replace(const std::filesystem::path& file, const std::string& what, const std::string& by) {
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
        const std::filesystem::path file = folder_.path() / "pids";
        std::vector<long> numbers;
        for (int i = 0; i < 1500 && numbers.size() < count; ++i) {
            numbers.clear();
            const std::string text = std::filesystem::exists(file) ? core::read_file(file) : "";
            for (const auto line : core::split(text, '\n')) {
                if (const auto number = core::parse_integer(line)) {
                    numbers.push_back(static_cast<long>(*number));
                }
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return numbers;
    }
    /// Gone, or a zombie that nobody has fetched yet, within a minute.
    static bool gone(long process) {
        for (int i = 0; i < 3000; ++i) {
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
        std::filesystem::create_directories(folder_.path() / "study");
        std::filesystem::copy(test::source_folder() / "cases" / "evie" / "shapes" / "ellipse.toml",
                              folder_.path() / "study" / "ellipse.toml");
        core::write_file(folder_.path() / "study" / "study.toml",
                         "title = \"a sweep\"\n[frame]\nsymmetry = \"y\"\n[reference]\ndensity = \"998 "
                         "kg/m^3\"\n[[body]]\nname = \"ellipse\"\nshape = \"ellipse.toml\"\n"
                         "[sweep]\ngap = [\"5 mm\", \"10 mm\"]\npitch = \"1 deg\"\nspeed = \"0.5 m/s\"\nconditions "
                         "= { mesh = \"coarse\" }\nmesher = \"snappy\"\niterations = 40\n");
    }
    core::TemporaryFolder folder_;
};

}  // namespace underbody
