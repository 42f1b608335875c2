#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

using test::run_underbody;
using ::testing::HasSubstr;

TEST(ExportCommand, WritesEveryFormatAndLeavesFilesOfOthersAlone) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv", "gap [mm], lift_force [N]\n1, .66\n2, .4\n3, .296\n5, .27\n10, .297\n");
    for (const char* format : {"c", "csv", "json", "mat", "jsbsim", "fmu"}) {
        const std::string out = std::string("out.") + format;
        const auto run = run_underbody({"export", "lift.csv", "--format", format, "--out", out}, folder.path());
        EXPECT_EQ(run.exit_code, 0) << format << run.errors;
        EXPECT_THAT(run.output, HasSubstr(out));
        EXPECT_TRUE(std::filesystem::exists(folder.path() / out)) << format;
    }
    core::write_file(folder.path() / "mine.h", "int precious;\n");
    const auto run = run_underbody({"export", "lift.csv", "--format", "c", "--out", "mine.h"}, folder.path());
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_THAT(run.errors, HasSubstr("not written by Underbody"));
    EXPECT_EQ(core::read_file(folder.path() / "mine.h"), "int precious;\n");
    EXPECT_EQ(run_underbody({"export", "lift.csv", "--format", "d", "--out", "x"}, folder.path()).exit_code, 2);
}

}  // namespace
}  // namespace underbody
