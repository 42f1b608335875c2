// How settled a solution is, where its numbers are read: loads, study, report, tables. And Workbench's design points.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class SettledCommands : public testing::Test {
protected:
    core::TemporaryFolder folder;
    ProgramRun run(const std::vector<std::string>& arguments) { return run_underbody(arguments, folder.path()); }
    /// A monitor of the lift, in coefficients.
    void monitor(const std::string& name, int count, double jump) {
        std::string text = "\"lift\"\n\"Iteration\" \"lift\"\n(\"Iteration\" \"lift\")\n";
        for (int i = 1; i <= count; ++i) {
            text += std::to_string(i) + " " + core::format_number(0.2 * (1 + jump * (i % 2 == 0 ? 1 : -1))) + "\n";
        }
        core::write_file(folder.path() / name, text);
    }
};

TEST_F(SettledCommands, LoadsSayItInTextJsonAndTable) {
    core::write_file(folder.path() / "a.csv", cube_field(0.003, 400));
    core::write_file(folder.path() / "b.csv", cube_field(0.004, 300));
    EXPECT_THAT(run({"loads", "a.csv"}).output, HasSubstr("settled: unknown: no history"));
    monitor("a-lift.out", 30, 0.5);
    monitor("b-lift.out", 300, 0.01);
    const auto jumping = run({"loads", "a.csv"});
    EXPECT_EQ(jumping.exit_code, 0) << jumping.errors;
    EXPECT_THAT(jumping.output, HasSubstr("not settled: lift_force scatters by"));
    const json settled = json::parse(run({"loads", "b.csv", "--json"}).output)["settled"];
    EXPECT_EQ(settled["verdict"], "settled") << settled;
    EXPECT_NEAR(settled["loads"]["lift_force"]["sigma"].get<double>(), 0.003, 1e-4);
    const auto table = run({"loads", "{case}.csv", "--out", "loads.csv"});
    ASSERT_EQ(table.exit_code, 0) << table.errors;
    const core::Table loads = core::read_csv(folder.path() / "loads.csv");
    EXPECT_EQ(loads.text("settled"), (std::vector<std::string>{"not settled", "settled"}));
    EXPECT_NEAR(loads.numbers("lift_force_sigma")[0], 0.2, 0.01);
    // The table of an earlier run is a manifest like any other.
    EXPECT_EQ(run({"loads", "--manifest", "loads.csv"}).exit_code, 0);
}

TEST_F(SettledCommands, AStudySaysItInListReportAndTables) {
    write_small_study(folder.path() / "study");
    monitor("study/fields/cube-h3-lift.out", 30, 0.5);
    monitor("study/fields/cube-h4-lift.out", 300, 0.01);
    const auto ran = run({"study", "run", "study", "--no-pictures"});
    EXPECT_EQ(ran.exit_code, 0) << ran.errors;
    EXPECT_THAT(ran.output, HasSubstr("1 of 6 solutions has not settled, 'cube-h3'"));
    EXPECT_THAT(core::read_file(folder.path() / "study" / "report" / "index.html"),
                HasSubstr("1 of 6 solutions has not settled: cube-h3"));
    const json again = json::parse(run({"study", "run", "study", "--no-pictures", "--json"}).output);
    EXPECT_EQ(again["not_settled"], json({"cube-h3"}));
    const std::string points = again["results"]["table/lift"]["points"];
    EXPECT_THAT(points, HasSubstr("lift_force_sigma"));
    EXPECT_THAT(again["results"]["table/lift"]["remarks"].dump(), HasSubstr("solution that has not settled: cube-h3"));
    // Four solutions have no history: their error is unknown, not 0.
    EXPECT_THAT(again["results"]["table/lift"]["remarks"].dump(), HasSubstr("4 of 6 points have no lift_force_sigma"));
    const json list = json::parse(run({"study", "list", "study", "--json"}).output)["cases"];
    for (const auto& one : list) {
        EXPECT_EQ(one["settled"]["verdict"], one["name"] == "cube-h3"   ? "not settled"
                                             : one["name"] == "cube-h4" ? "settled"
                                                                        : "unknown");
    }
    EXPECT_THAT(run({"study", "list", "study"}).output, HasSubstr("not settled"));
    // Another history is another result.
    monitor("study/fields/cube-h3-lift.out", 300, 0.001);
    EXPECT_THAT(run({"study", "run", "study", "--no-pictures"}).output, Not(HasSubstr("not settled")));
}

TEST_F(SettledCommands, WhatRestsOnForceTablesSaysItInTextAndJson) {
    core::write_file(folder.path() / "lift.csv",
                     "gap [mm], lift_force [N], lift_force_sigma [N], settled\n5, 1, 0.01, settled\n"
                     "6, 0.9, 0.01, not settled\n7, 0.82, 0.01, settled\n8, 0.77, 0.01, settled\n"
                     "9, 0.73, 0.01, settled\n10, 0.70, 0.01, settled\n12, 0.66, 0.01, settled\n"
                     "15, 0.62, 0.01, settled\n");
    core::write_file(folder.path() / "model.toml",
                     "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.7 kg\"\nnet_weight = \"0.8 N\"\n"
                     "[drag.heave]\nquadratic = \"6 N s^2/m^2\"\n"
                     "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n");
    for (const char* number : {"1", "2", "3"}) {
        ASSERT_EQ(run({"simulate", "model.toml", "--from", "gap=" + std::string(number) + "1mm", "--for", "3", "--step",
                       "20ms", "--out", "data/run-" + std::string(number) + ".csv"})
                      .exit_code,
                  0);
    }
    core::write_file(folder.path() / "data" / "dataset.toml",
                     "kind = \"time_series\"\n[noise]\ngap = \"0.05 mm\"\n[[run]]\nfile = \"run-1.csv\"\n"
                     "[[run]]\nfile = \"run-2.csv\"\n[[run]]\nfile = \"run-3.csv\"\n");
    // Free runs: their column of input is nought all along, and no law of it may be looked for.
    const std::string sentence = "1 of 8 points is of a solution that has not settled: row 2";
    for (std::vector<std::string> words : std::vector<std::vector<std::string>>{
             {"table", "at", "lift.csv", "gap=6mm"},
             {"table", "at", "model.toml", "gap=6mm"},
             {"table", "equilibria", "lift.csv", "--weight", "0.8 N"},
             {"table", "equilibria", "model.toml"},
             {"predict", "model.toml", "--data", "data"},
             {"estimate", "model.toml", "--data", "data"},
             {"learn", "model.toml"},
             {"control", "model.toml", "--hold", "8mm", "--from", "gap=9mm", "--for", "2"},
             {"discover", "model.toml", "--data", "data", "--out", "found", "--candidates", "constant_force"}}) {
        const auto text = run(words);
        EXPECT_EQ(text.exit_code, 0) << text.errors;
        EXPECT_THAT(text.output, HasSubstr("warning: ")) << words[0];
        EXPECT_THAT(text.output, HasSubstr(sentence)) << words[0];
        EXPECT_THAT(text.errors, HasSubstr(sentence)) << words[0];
        words.insert(words.end(), {"--json", "--force"});
        const auto document = run(words);
        ASSERT_EQ(document.exit_code, 0) << document.errors;
        EXPECT_THAT(json::parse(document.output).at("warnings").dump(), HasSubstr(sentence)) << words[0];
    }
}

TEST_F(SettledCommands, InitialValuesAndDivergedFieldsAreNoSolutions) {
    fs::copy(data_folder() / "openfoam" / "ascii", folder.path() / "case", fs::copy_options::recursive);
    fs::remove_all(folder.path() / "case" / "0.0025");
    ASSERT_EQ(run({"loads", "case", "--density", "998 kg/m^3", "--zones", "*"}).exit_code, 0);
    fs::rename(folder.path() / "case" / "0.005", folder.path() / "case" / "0");
    const fs::path pressure = folder.path() / "case" / "0" / "p";
    const std::regex list("nonuniform\\s+List<scalar>\\s+\\d*\\s*\\([^)]*\\)");
    core::write_file(pressure, std::regex_replace(core::read_file(pressure), list, "uniform 0"));
    const auto initial = run({"loads", "case", "--density", "998 kg/m^3", "--zones", "*"});
    EXPECT_EQ(initial.exit_code, 3) << initial.output;
    EXPECT_THAT(initial.errors, HasSubstr("no time but 0"));
    core::write_file(folder.path() / "wild.csv", cube_field(0.003, 1e20));
    const auto wild = run({"loads", "wild.csv"});
    EXPECT_EQ(wild.exit_code, 3);
    EXPECT_THAT(wild.errors, HasSubstr("the solution has diverged"));
}

TEST_F(SettledCommands, ARunInTimeBecomesItsMeanWithAnErrorThatKnowsItsCorrelation) {
    constexpr int count = 64;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const double lift = 0.4 + 0.1 * std::sin(2 * M_PI * i / 16);
        sum += lift / count;
        core::write_file(folder.path() / ("wake-" + core::format_number(0.01 * i) + ".csv"),
                         cube_field(0.003, lift / 1e-3));
    }
    const auto mean = run({"loads", "wake-{time:s}.csv", "--mean", "--out", "mean.csv"});
    ASSERT_EQ(mean.exit_code, 0) << mean.errors;
    const core::Table table = core::read_csv(folder.path() / "mean.csv");
    ASSERT_EQ(table.rows(), 1U);
    EXPECT_NEAR(table.numbers("lift_force")[0], sum, 1e-6);
    EXPECT_EQ(table.numbers("samples")[0], count);
    EXPECT_GT(table.numbers("correlation_time")[0], 2);  // sixteen to a cycle
    EXPECT_GT(table.numbers("lift_force_sigma")[0], 0.1 / std::sqrt(2.0 * count));
    EXPECT_LT(table.numbers("lift_force_sigma")[0], 0.1);
}

TEST_F(SettledCommands, TheErrorOfAMeanAndThatOfTheMeshBothReachTheTable) {
    for (const int cells : {1000, 8000}) {
        for (int i = 0; i < 32; ++i) {
            const double lift = 0.4 + 40.0 / cells + 0.05 * std::sin(2 * M_PI * i / 8);
            core::write_file(folder.path() / ("w-c" + std::to_string(cells) + "-t" + std::to_string(i) + ".csv"),
                             cube_field(0.003, lift / 1e-3));
        }
    }
    const std::vector<std::string> mean = {"loads", "w-c{cells:1}-t{time:s}.csv", "--mean", "--out"};
    const auto with = [&](const std::string& file, const std::vector<std::string>& more) {
        auto words = mean;
        words.push_back(file);
        words.insert(words.end(), more.begin(), more.end());
        const auto done = run(words);
        EXPECT_EQ(done.exit_code, 0) << done.errors;
        return core::read_csv(folder.path() / file);
    };
    const core::Table alone = with("time.csv", {});
    ASSERT_EQ(alone.rows(), 2U);
    const core::Table both = with("both.csv", {"--mesh-study", "cells"});
    ASSERT_EQ(both.rows(), 1U) << "the times of a mean are no conditions that tell meshes apart";
    EXPECT_EQ(both.find("first_time")->unit, "s");
    const double in_time = alone.numbers("lift_force_sigma")[1], sigma = both.numbers("lift_force_sigma")[0];
    EXPECT_GT(sigma, 1.2 * in_time);
    const json said =
        json::parse(run({"--json", "loads", "w-c{cells:1}-t{time:s}.csv", "--mean", "--mesh-study", "cells"}).output);
    const json& one = said.contains("files") ? said.at("files").at(0) : said;  // one row stands alone
    EXPECT_NEAR(one.at("sigma").at("lift_force").get<double>(), sigma, 1e-6 * sigma);
    const double mesh = one.at("mesh_uncertainty").at("lift_force").at("standard_uncertainty").get<double>();
    EXPECT_NEAR(std::hypot(mesh, in_time), sigma, 1e-3 * sigma);
}

TEST_F(SettledCommands, LoadsThatAManifestStatesDoNotTellRunsApart) {
    std::string manifest = "file, time [s], lift_force [N]\n";
    for (int i = 0; i < 16; ++i) {
        const double lift = 0.4 + 0.1 * std::sin(2 * M_PI * i / 8);
        const std::string file = "m-" + std::to_string(i) + ".csv";
        core::write_file(folder.path() / file, cube_field(0.003, lift / 1e-3));
        manifest += file + ", " + std::to_string(i) + ", " + core::format_number(lift) + "\n";
    }
    core::write_file(folder.path() / "list.csv", manifest);
    const auto mean = run({"loads", "--manifest", "list.csv", "--mean", "--out", "m.csv"});
    ASSERT_EQ(mean.exit_code, 0) << mean.errors;
    EXPECT_EQ(core::read_csv(folder.path() / "m.csv").rows(), 1U);
    const auto none = run({"loads", "m-{gap:mm}.csv", "--mean"});
    EXPECT_THAT(none.errors, HasSubstr("nothing to take a mean of"));
}

TEST_F(SettledCommands, DesignPointsOfWorkbenchBecomeConditions) {
    for (int i = 0; i < 4; ++i) {
        core::write_file(
            folder.path() / "study" / "hull_files" / ("dp" + std::to_string(i)) / "FFF" / "Fluent" / "FFF-1.csv",
            cube_field(0.003 + 0.001 * i, 400));
    }
    core::write_file(folder.path() / "points.csv",
                     "# ,P1 - h [mm],P2 - inlet velocity [m s^-1],P3 - lift-op [N]\nName,P1,P2,P3\nDP 0,3,0.5,0.4\nDP "
                     "1,4,0.5,0.4\nDP 2,5,0.5,0.4\nDP 7,9,0.5,\n");
    const std::vector<std::string> add = {
        "study",           "add",       "study", "--files", "hull_files/dp{design_point}/FFF/Fluent/*.csv",
        "--design-points", "points.csv"};
    const auto unknown = run(add);
    EXPECT_EQ(unknown.exit_code, 3);
    EXPECT_THAT(unknown.errors, HasSubstr("'P1 - h'"));
    EXPECT_FALSE(fs::exists(folder.path() / "study" / "study.toml"));
    auto named = add;
    named.insert(named.end(), {"--parameter", "P1=gap"});
    const auto added = run(named);
    ASSERT_EQ(added.exit_code, 0) << added.errors;
    EXPECT_THAT(added.output, HasSubstr("3 cases added"));
    EXPECT_THAT(added.output, HasSubstr("DP 7"));   // no file
    EXPECT_THAT(added.output, HasSubstr("/dp3/"));  // no point
    const json list = json::parse(run({"study", "list", "study", "--json"}).output);
    ASSERT_EQ(list["cases"].size(), 3U);
    EXPECT_EQ(list["cases"][1]["name"], "dp1");
    EXPECT_NEAR(list["cases"][1]["conditions"]["gap"].get<double>(), 0.004, 1e-12);
    EXPECT_EQ(list["cases"][1]["conditions"]["speed"], 0.5);
    EXPECT_EQ(list["notes"].size(), 3U);
    EXPECT_EQ(run({"study", "run", "study", "--no-pictures"}).exit_code, 0);
}

}  // namespace
}  // namespace underbody::test
