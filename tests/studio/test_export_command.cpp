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
    EXPECT_THAT(run.errors, HasSubstr("no force table that Underbody wrote"));
    EXPECT_EQ(core::read_file(folder.path() / "mine.h"), "int precious;\n");
    EXPECT_EQ(run_underbody({"export", "lift.csv", "--format", "d", "--out", "x"}, folder.path()).exit_code, 2);
}

TEST(ExportCommand, TakesAModelWithWhatWasFoundInIt) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv", "gap [mm], lift_force [N]\n1, .66\n2, .4\n3, .296\n5, .27\n10, .297\n");
    core::write_file(folder.path() / "model.toml",
                     "[vehicle]\nmass = \"2.2 kg\"\n[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n"
                     "scale.speed = { reference = \"0.5 m/s\", exponent = 2 }\n"
                     "[[effect]]\nname = \"sensor_gain\"\ngain = 1.1\n"
                     "[[effect]]\nname = \"speed_exponent\"\nexponent = { value = 1.5, sigma = 0.1 }\n");
    const auto run = run_underbody({"export", "model.toml", "--where", "speed=1m/s", "--format", "c", "--out", "lift.h"}, folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_THAT(run.errors, HasSubstr("sensor_gain"));
    const std::string header = core::read_file(folder.path() / "lift.h");
    EXPECT_THAT(header, HasSubstr("Holds for speed = 1 m/s"));
    EXPECT_THAT(header, HasSubstr("Of mass = 2.2 kg"));
    const auto at = run_underbody({"table", "at", "model.toml", "gap=5mm", "--where", "speed=1m/s", "--json"}, folder.path());
    ASSERT_EQ(at.exit_code, 0) << at.errors;
    EXPECT_THAT(at.output, HasSubstr("0.7636"));   // .27 N * 2^1.5
    EXPECT_EQ(run_underbody({"export", "model.toml", "--where", "sped=1", "--format", "c", "--out", "x.h"}, folder.path()).exit_code, 2);
}

}  // namespace
}  // namespace underbody
