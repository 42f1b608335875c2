// Exports that are killed, and two at once: the file is the old one or the new one, never half of one. A few kills in
// every run of the tests, as many as UNDERBODY_KILLS says on demand (tests/kills).
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <set>
#include <thread>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

namespace fs = std::filesystem;

class Exports : public testing::Test {
protected:
    Exports() {
        for (const auto& [name, size] : {std::pair{"old.csv", 1.0}, {"new.csv", 1.7}}) {
            std::string text = "gap [mm], pitch [deg], lift_force [N]\n";
            for (int gap = 1; gap <= 12; ++gap) {
                for (int pitch = -2; pitch <= 2; ++pitch) {
                    text += std::to_string(gap) + ", " + std::to_string(pitch) + ", " +
                            core::format_number(size * std::exp(-gap / 5.0) * (1 + 0.1 * pitch), 9) + "\n";
                }
            }
            core::write_file(folder.path() / name, text);
        }
    }
    [[nodiscard]] std::vector<std::string> arguments(const std::string& table, const std::string& file) const {
        return {"export", table, "--out", file, "--name", "lift"};
    }
    /// Runs in the background, without output.
    [[nodiscard]] pid_t begin(const std::vector<std::string>& words) const {
        const pid_t child = ::fork();
        if (child == 0) {
            ::dup2(::open("/dev/null", O_WRONLY), 1);
            ::dup2(::open("/dev/null", O_WRONLY), 2);
            const std::string program = (program_folder() / "underbody").string();
            std::vector<char*> argv = {const_cast<char*>(program.c_str())};
            for (const auto& word : words) {
                argv.push_back(const_cast<char*>(word.c_str()));
            }
            argv.push_back(nullptr);
            if (::chdir(folder.path().c_str()) == 0) {
                ::execv(program.c_str(), argv.data());
            }
            ::_exit(127);
        }
        return child;
    }
    std::string exported(const std::string& table, const std::string& file) {
        const auto run = run_underbody(arguments(table, file), folder.path());
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        return core::read_file(folder.path() / file);
    }
    /// Files that are no table and none of `expected`.
    std::set<std::string> left_behind(const std::set<std::string>& expected) const {
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder.path())) {
            const std::string name = entry.path().filename().string();
            if (name != "old.csv" && name != "new.csv" && !expected.contains(name)) {
                names.insert(name);
            }
        }
        return names;
    }
    core::TemporaryFolder folder;
};

class ExportsOf : public Exports, public testing::WithParamInterface<const char*> {};

TEST_P(ExportsOf, KilledLeaveTheOldFileOrTheNewOne) {
    const std::string file = GetParam();
    const std::string newer = exported("new.csv", file);
    ASSERT_EQ(exported("new.csv", file), newer) << "two exports of one table are the same";
    const std::string older = exported("old.csv", file);
    ASSERT_NE(older, newer);
    const char* asked = std::getenv("UNDERBODY_KILLS");
    const int kills = asked != nullptr ? std::max(1, std::stoi(asked) / 6) : 3;
    core::Random random(20261122);
    std::set<std::string> with_companions = left_behind({});
    for (int i = 0; i < kills; ++i) {
        const bool to_newer = i % 2 == 0;
        const pid_t child = begin(arguments(to_newer ? "new.csv" : "old.csv", file));
        std::this_thread::sleep_for(
            std::chrono::microseconds(static_cast<int>(std::exp(random.uniform(std::log(2e3), std::log(6e4))))));
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        const std::string now = core::read_file(folder.path() / file);
        EXPECT_TRUE(now == older || now == newer) << "half of " << file << " after kill " << i;
    }
    EXPECT_EQ(exported("new.csv", file), newer);
    for (const auto& name : left_behind(with_companions)) {
        EXPECT_THAT(name, testing::HasSubstr("underbody-")) << "only its own temporary files may stay behind";
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, ExportsOf,
                         testing::Values("lift.h", "lift.csv", "lift.json", "lift.mat", "lift.xml", "lift.fmu"),
                         [](const auto& one) { return std::string(one.param).substr(5); });

TEST_F(Exports, TwoAtOnceOfOneFileGiveOneOfThemWhole) {
    const std::string newer = exported("new.csv", "lift.h"), older = exported("old.csv", "lift.h");
    for (int i = 0; i < 6; ++i) {
        const pid_t first = begin(arguments("new.csv", "lift.h")), second = begin(arguments("old.csv", "lift.h"));
        for (const pid_t child : {first, second}) {
            int status = 0;
            ::waitpid(child, &status, 0);
            EXPECT_EQ(WEXITSTATUS(status), 0);
        }
        const std::string now = core::read_file(folder.path() / "lift.h");
        EXPECT_TRUE(now == older || now == newer);
    }
}

}  // namespace
}  // namespace underbody::test
