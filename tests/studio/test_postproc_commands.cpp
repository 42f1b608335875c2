// info, import, loads, views and probe as a user runs them.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/table.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

using nlohmann::json;
using test::run_underbody;

/// A closed box of 2 x 1 x 0.5 m with p = 1 + z: lift is -1 N.
const std::string box_csv =
    "[Name]\nbase\n\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa ]\n0,0,0,1\n2,0,0,1\n2,1,0,1\n0,1,0,1\n\n[Faces]\n0,3,2,1\n"
    "\n[Name]\nhull\n\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa ]\n"
    "0,0,0,1\n2,0,0,1\n2,1,0,1\n0,1,0,1\n0,0,0.5,1.5\n2,0,0.5,1.5\n2,1,0.5,1.5\n0,1,0.5,1.5\n"
    "\n[Faces]\n0,1,5,4\n1,2,6,5\n2,3,7,6\n3,0,4,7\n4,5,6,7\n";

class PostprocCommands : public testing::Test {
protected:
    PostprocCommands() {
        core::write_file(folder_.path() / "a-h5.csv", box_csv);
        core::write_file(folder_.path() / "b-h10.csv", box_csv);
    }
    test::ProgramRun run(const std::vector<std::string>& arguments) { return run_underbody(arguments, folder_.path()); }
    json run_json(std::vector<std::string> arguments) {
        arguments.emplace_back("--json");
        const auto result = run(arguments);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        return json::parse(result.output);
    }
    core::TemporaryFolder folder_;
};

TEST_F(PostprocCommands, InfoSaysWhatAFileHolds) {
    const json info = run_json({"info", "a-h5.csv"});
    EXPECT_EQ(info["format"], "CFD-Post CSV");
    EXPECT_EQ(info["zones"].size(), 2U);
    EXPECT_EQ(info["zones"][1]["faces"], 5);
    EXPECT_EQ(info["arrays"][0]["name"], "pressure");
    EXPECT_EQ(info["arrays"][0]["max"], 1.5);
    EXPECT_THAT(run({"info", "a-h5.csv"}).output, testing::HasSubstr("hull"));
}

TEST_F(PostprocCommands, LoadsGiveOneResultOrATable) {
    const json one = run_json({"loads", "a-h5.csv"});
    EXPECT_NEAR(one["lift_force"].get<double>(), -1, 1e-12);
    EXPECT_NEAR(one["closure"].get<double>(), 0, 1e-12);
    EXPECT_EQ(one["reference"], json({1.0, 0.5, 0.0}));
    EXPECT_EQ(one["values_from"], "nodes");
    const auto table = run({"loads", "{variant}-h{gap:mm}.csv", "--out", "loads.csv"});
    EXPECT_EQ(table.exit_code, 0) << table.errors;
    const core::Table read = core::read_csv(folder_.path() / "loads.csv");
    EXPECT_EQ(read.rows(), 2U);
    EXPECT_NEAR(read.numbers("gap")[0], 0.005, 1e-12);
    EXPECT_EQ(read.text("variant")[1], "b");
    EXPECT_NEAR(read.numbers("lift_force")[1], -1, 1e-12);
    const json both = run_json({"loads", "a-h5.csv", "b-h10.csv"});
    EXPECT_EQ(both["files"].size(), 2U);
}

TEST_F(PostprocCommands, LoadsAreCheckedAgainstAManifest) {
    core::write_file(folder_.path() / "stated.csv", "gap [mm], lift_force [N], drag_force [N], file\n5, -1.001, 0, a-h5.csv\n10, -1.2, 0, b-h10.csv\n");
    const auto wrong = run({"loads", "--manifest", "stated.csv", "--check", "0.01"});
    EXPECT_EQ(wrong.exit_code, 4);
    EXPECT_THAT(wrong.errors, testing::HasSubstr("b-h10.csv: lift_force is -1, stated -1.2"));
    EXPECT_EQ(run({"loads", "a-h5.csv", "--manifest", "stated.csv", "--check", "0.01"}).exit_code, 0);
}

TEST_F(PostprocCommands, ImportWritesVtkFiles) {
    EXPECT_EQ(run({"import", "a-h5.csv", "--out", "a.vtp"}).exit_code, 0);
    EXPECT_EQ(run({"import", "*-h*.csv", "--out", "all.vtm"}).exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "a.vtp"));
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "all-b-h10.vtm"));
    EXPECT_EQ(run({"import", "a-h5.csv", "--out", "a.xyz"}).exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "a.xyz"));
}

TEST_F(PostprocCommands, ErrorsNameFileAndLine) {
    std::string damaged = box_csv;
    damaged.replace(damaged.find("2,1,0,1\n"), 8, "2,1,0,nan\n");
    core::write_file(folder_.path() / "bad.csv", damaged);
    const auto result = run({"loads", "bad.csv", "--json"});
    EXPECT_EQ(result.exit_code, 3);
    const json error = json::parse(result.output)["error"];
    EXPECT_EQ(error["file"], "bad.csv");
    EXPECT_EQ(error["line"], 8);
    EXPECT_EQ(error["column"], 7);
    EXPECT_EQ(run({"loads", "a-h5.csv", "--zones", "keel"}).exit_code, 3);
    EXPECT_EQ(run({"loads", "a-h5.csv", "--up", "q"}).exit_code, 2);
    EXPECT_EQ(run({"loads", "none.csv"}).exit_code, 3);
}

TEST_F(PostprocCommands, ViewsAreDrawnWithoutADisplay) {
    const auto result = run_underbody({"views", "a-h5.csv", "--out", "pictures", "--view", "pressure-underbody", "--json"}, folder_.path(), {{"DISPLAY", ""}});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_THAT(core::read_file(folder_.path() / "pictures" / "pressure-underbody.png"), testing::StartsWith("\x89PNG"));
    EXPECT_EQ(json::parse(result.output)["views"][0]["name"], "pressure-underbody");
    EXPECT_EQ(run({"views", "a-h5.csv", "--view", "nothing"}).exit_code, 3);
}

TEST_F(PostprocCommands, ProbeLooksAtPointsAndLines) {
    const json line = run_json({"probe", "a-h5.csv", "--line", "0,0,0:0,0,0.5", "--count", "3", "--arrays", "pressure"});
    EXPECT_EQ(line["rows"], 3);
    for (const auto& column : line["columns"]) {
        if (column["name"] == "pressure") {
            EXPECT_NEAR(column["values"][1].get<double>(), 1.25, 1e-12);
        }
    }
    EXPECT_EQ(run({"probe", "a-h5.csv"}).exit_code, 2);
    EXPECT_EQ(run({"probe", "a-h5.csv", "--point", "0,0,0", "--arrays", "presure"}).exit_code, 3);
    EXPECT_EQ(run({"probe", "a-h5.csv", "--gap", "3"}).exit_code, 3);  // no volume
}

}  // namespace
}  // namespace underbody
