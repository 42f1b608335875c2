// info, import, loads, views and probe as a user runs them.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/table.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

using nlohmann::json;
using test::run_underbody;

/// A closed box of 2 x 1 x 0.5 m with p = 1 + z: lift is -1 N.
const std::string box_csv =
    "[Name]\nbase\n\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa "
    "]\n0,0,0,1\n2,0,0,1\n2,1,0,1\n0,1,0,1\n\n[Faces]\n0,3,2,1\n"
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

TEST_F(PostprocCommands, LoadsOfAFileThatIsCutWithinAFaceAreRefused) {
    const auto cut = [&](std::size_t missing, const std::vector<std::string>& more = {}) {
        core::write_file(folder_.path() / "cut.csv", box_csv.substr(0, box_csv.size() - missing));
        std::vector<std::string> arguments = {"loads", "cut.csv"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    };
    EXPECT_EQ(cut(1).exit_code, 0);  // an editor may have left out the last line end
    const auto refused = cut(2);     // a triangle in the place of a rectangle
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_THAT(
        refused.errors,
        testing::AllOf(testing::HasSubstr(
                           "cut.csv:33: the file does not end with a line end: it is cut short within its last face"),
                       testing::Not(testing::HasSubstr("warning"))));  // said once
    EXPECT_EQ(cut(2, {"--accept-problems"}).exit_code, 0);
    EXPECT_THAT(cut(4).errors, testing::HasSubstr("cut.csv:33:1: a row of 2 node numbers"));
}

TEST_F(PostprocCommands, TheFilesOfOneCaseAreOneCase) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_cff/mixing_elbow.cas.h5");
    const std::string stem = (test::shared_folder() / "samples/fluent_cff/mixing_elbow").string();
    const auto both = run({"loads", stem + ".cas.h5", stem + ".dat.h5", "--zones", "wall-elbow", "--json"});
    EXPECT_EQ(both.exit_code, 0) << both.errors;
    EXPECT_THAT(both.errors, testing::HasSubstr("the same case as '" + stem + ".cas.h5', counted once"));
    EXPECT_TRUE(json::parse(both.output).contains("lift_force"));  // one result, no list of two
    core::write_file(folder_.path() / "list.csv", "file, gap [mm]\n" + stem + ".cas.h5, 5\n" + stem + ".dat.h5, 6\n");
    EXPECT_THAT(run({"loads", "--manifest", "list.csv", "--zones", "wall-elbow"}).errors,
                testing::HasSubstr("are the files of one case, with different conditions"));
}

TEST_F(PostprocCommands, ImportSaysWhatIsNoNumber) {
    const std::string none =
        "[Name]\nhull\n\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa "
        "]\n0,0,0,1\n1,0,0,null\n0,1,0,\n\n[Faces]\n0,1,2\n";
    core::write_file(folder_.path() / "none.csv", none);
    const auto result = run({"import", "none.csv", "--out", "new/none.vtp"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_THAT(result.output,
                testing::HasSubstr("warning: none.csv: 'pressure' has 2 values that are not a number: written as NaN"));
    EXPECT_THAT(result.errors, testing::HasSubstr("made the folder 'new', which was not there"));
    EXPECT_THAT(run({"import", "a-h5.csv", "--out", "new/a.vtp"}).errors,
                testing::Not(testing::HasSubstr("the folder")));
}

TEST_F(PostprocCommands, WhatLibrariesCallOptionsAreFlagsHere) {
    const auto duct = run({"loads", "a-h5.csv", "--forward", "x", "--up", "x"});
    EXPECT_THAT(duct.errors, testing::AllOf(testing::HasSubstr("for instance --forward +x and --up +z"),
                                            testing::Not(testing::HasSubstr("option '"))));
    const json refused = json::parse(run({"loads", "a-h5.csv", "--time", "3", "--json"}).output);
    EXPECT_THAT(refused["error"]["hint"], testing::HasSubstr("leave --time away"));
}

TEST_F(PostprocCommands, LoadsAreNotWrittenOverWhatTheyAreMadeOf) {
    const auto refused = run({"loads", "a-h5.csv", "--out", "./a-h5.csv"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.errors, testing::HasSubstr("is one of the files to read"));
    EXPECT_EQ(core::read_file(folder_.path() / "a-h5.csv"), box_csv);
}

TEST_F(PostprocCommands, ABatchSaysOnceWhatItsFilesHaveAlike) {
    const std::string open_csv = box_csv.substr(0, box_csv.rfind("4,5,6,7"));
    for (const char* name : {"o-h1.csv", "o-h2.csv", "o-hO3.csv"}) {
        core::write_file(folder_.path() / name, open_csv);
    }
    const auto count = [](const std::string& text, const std::string& part) {
        int found = 0;
        for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
            ++found;
        }
        return found;
    };
    const auto batch = run({"loads", "o-h{gap:mm}.csv"});
    EXPECT_EQ(batch.exit_code, 0);
    EXPECT_EQ(count(batch.errors, "is not closed"), 1) << batch.errors;
    EXPECT_THAT(batch.errors, testing::AllOf(testing::HasSubstr("o-h1.csv: the surface is not closed"),
                                             testing::HasSubstr("(and alike in 1 other file)"),
                                             testing::HasSubstr("left out, for their names do not fit the pattern"),
                                             testing::HasSubstr("o-hO3.csv ('O3' is no number for {gap:mm})")));
    EXPECT_EQ(count(run({"--verbose", "loads", "o-h{gap:mm}.csv"}).errors, "is not closed"), 2);
    EXPECT_EQ(count(run({"loads", "o-h1.csv"}).errors, "alike"), 0);
}

TEST_F(PostprocCommands, InfoSaysWhatAReportOfTheSolverHolds) {
    std::string monitor = "\"lift-rfile\"\n\"Iteration\" \"lift\"\n(\"Iteration\" \"lift\")\n";
    for (int i = 1; i <= 20; ++i) {
        monitor += std::to_string(i) + " " + std::to_string(1.25 + (i % 2 == 0 ? 1e-5 : -1e-5)) + "\n";
    }
    core::write_file(folder_.path() / "lift.out", monitor);
    const json history = run_json({"info", "lift.out"});
    EXPECT_EQ(history["monitor"]["columns"][1]["name"], "lift");
    EXPECT_EQ(history["monitor"]["columns"][1]["values"].size(), 20U);
    EXPECT_NEAR(history["monitor"]["columns"][1]["tail"]["mean"].get<double>(), 1.25, 1e-5);
    EXPECT_THAT(run({"info", "lift.out"}).output, testing::HasSubstr("Iteration 1 to 20"));
    core::write_file(folder_.path() / "a.xy",
                     "(title \"Static Pressure\")\n(labels \"Position\" \"Static Pressure\")\n((xy/key/label "
                     "\"wall\")\n0\t10\n0.5\t20\n1\t15\n)\n");
    const json plot = run_json({"info", "a.xy"});
    EXPECT_EQ(plot["plot"]["curves"][0]["name"], "wall");
    EXPECT_EQ(plot["plot"]["curves"][0]["y"], json({10, 20, 15}));
    EXPECT_THAT(run({"info", "a.xy"}).output, testing::HasSubstr("10 .. 20"));
    core::write_file(folder_.path() / "forces.txt",
                     "Forces - Direction Vector (1 0 0)\n  Forces (n)   Coefficients\nZone Pressure Viscous Total "
                     "Pressure Viscous Total\n"
                     "hull 1 0.5 1.5 1 0.5 1.5\nNet 1 0.5 1.5 1 0.5 1.5\n");
    EXPECT_EQ(run_json({"info", "forces.txt"})["force_reports"][0]["rows"][0]["viscous"], 0.5);
    EXPECT_THAT(run({"info", "forces.txt"}).output, testing::HasSubstr("forces [N] along (1 0 0)"));
}

TEST_F(PostprocCommands, NamesInOldCodesAreStillNamesInJson) {
    std::string latin = box_csv;
    latin.replace(latin.find("hull"), 4, "R\xFCmpf");
    core::write_file(folder_.path() / "latin.csv", latin);
    EXPECT_EQ(run_json({"info", "latin.csv"})["zones"][1]["name"], "R\u00fcmpf");
    EXPECT_EQ(run({"import", "latin.csv", "--out", "latin.vtm"}).exit_code, 0);
    EXPECT_EQ(run_json({"info", "latin.vtm"})["zones"].size(), 2U);
    const auto missing = run({"info", "no\xFF.csv", "--json"});
    EXPECT_EQ(missing.exit_code, 3);
    EXPECT_TRUE(json::parse(missing.output).contains("error"));
}

TEST_F(PostprocCommands, ContentThatNoImporterReadsIsNamed) {
    const auto hint = [&](const std::string& name, const std::string& content) {
        core::write_file(folder_.path() / name, content);
        const auto result = run({"info", name});
        EXPECT_EQ(result.exit_code, 3) << name;
        return result.errors;
    };
    EXPECT_THAT(hint("a.msh", "$MeshFormat\n4.1 0 8\n"), testing::HasSubstr("Gmsh"));
    EXPECT_THAT(hint("a.csv", std::string("\xFF\xFE[\0N\0", 6)), testing::HasSubstr("UTF-16"));
    EXPECT_THAT(hint("a.vtk.series", "{\"file-series-version\": \"1.0\", \"files\": []}"),
                testing::HasSubstr("one of the files"));
    EXPECT_THAT(hint("a.prof", "((inlet point 2)\n(x 0 1)\n"), testing::HasSubstr("boundary profile"));
    EXPECT_THAT(hint("a.bin", std::string("\x01\x02\0\x03", 4)), testing::HasSubstr("known formats"));
    EXPECT_THAT(hint("ragged.out", "\"l\"\n\"Iteration\" \"l\"\n(\"Iteration\" \"l\")\n1 2\n2 3 4\n3 4\n"),
                testing::HasSubstr("ragged.out:5: a row of 3 numbers where there are 2 columns"));
    EXPECT_THAT(hint("b.bin", "\x01\r\x02 bytes of any kind\r\x05"), testing::HasSubstr("known formats"));
    std::string returns = box_csv;
    std::replace(returns.begin(), returns.end(), '\n', '\r');
    EXPECT_THAT(hint("mac.csv", returns), testing::HasSubstr("carriage returns alone"));
    EXPECT_THAT(hint("mac.case", "FORMAT\rtype: ensight gold\rGEOMETRY\rmodel: a.geo\r"),
                testing::HasSubstr("carriage returns alone"));
    core::write_file(folder_.path() / "rooms/constant/air/polyMesh/owner", "");
    EXPECT_THAT(run({"info", "rooms"}).errors, testing::HasSubstr("regions air"));
    core::write_file(folder_.path() / "shares/processors4/constant/polyMesh/owner", "");
    EXPECT_THAT(run({"info", "shares"}).errors, testing::HasSubstr("reconstructPar"));
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
    // One file has its loads at the top, also when it is a table as well; a manifest is a batch.
    EXPECT_NEAR(run_json({"loads", "a-h5.csv", "--out", "one.csv"})["lift_force"].get<double>(), -1, 1e-12);
    EXPECT_EQ(core::read_csv(folder_.path() / "one.csv").rows(), 1U);
    core::write_file(folder_.path() / "list.csv", "file\na-h5.csv\n");
    EXPECT_EQ(run_json({"loads", "--manifest", "list.csv"})["files"].size(), 1U);
    EXPECT_NEAR(run_json({"loads", "a-h5.csv", "--manifest", "list.csv"})["lift_force"].get<double>(), -1,
                1e-12);  // a row without conditions
}

TEST_F(PostprocCommands, LoadsWithASpeedAloneAreOfFreshWaterAndSaySo) {
    const json water = run_json({"loads", "a-h5.csv", "--speed", "0.5"});
    EXPECT_EQ(water["coefficients"]["density"], 998);
    EXPECT_THAT(water["problems"].dump(), testing::HasSubstr("no density is given: coefficients are for 998 kg/m^3"));
    const json stated = run_json({"loads", "a-h5.csv", "--speed", "0.5", "--density", "1000"});
    EXPECT_THAT(stated["problems"].dump(), testing::Not(testing::HasSubstr("no density")));
}

TEST_F(PostprocCommands, LoadsSayWhichGapsTheFilesContradict) {
    for (const int gap : {2, 5}) {
        core::write_file(folder_.path() / ("cube-h" + std::to_string(gap) + ".csv"),
                         test::cube_field(1e-3 * gap, 100.0 * gap));
    }
    core::write_file(folder_.path() / "cube-h7.csv", test::cube_field(5e-3, 500));
    const auto metres = run({"loads", "cube-h{gap:m}.csv"});
    EXPECT_EQ(metres.exit_code, 0);
    for (const std::string& stream : {metres.output, metres.errors}) {
        EXPECT_THAT(stream, testing::HasSubstr("the gap is declared as 2 m, but in the file the body"));
        EXPECT_THAT(stream, testing::HasSubstr("is it in mm, and was read in m?"));
    }
    const json table = run_json({"loads", "cube-h{gap:mm}.csv"});
    const std::string all = table.dump();
    EXPECT_THAT(all, testing::HasSubstr("declared as 7 mm"));
    EXPECT_THAT(all, testing::HasSubstr("'cube-h5.csv', 'cube-h7.csv' have the same loads to the last digit"));
    EXPECT_THAT(all, testing::Not(testing::HasSubstr("declared as 5 mm")));
    EXPECT_THAT(table["files"][2]["problems"].dump(), testing::HasSubstr("declared as 7 mm"));
}

TEST_F(PostprocCommands, LoadsAreAManifestAgain) {
    ASSERT_EQ(
        run({"loads", "{variant}-h{gap:mm}.csv", "--density", "1000", "--speed", "2", "--out", "first.csv"}).exit_code,
        0);
    const auto again =
        run({"loads", "--manifest", "first.csv", "--density", "1000", "--speed", "1", "--out", "second.csv"});
    ASSERT_EQ(again.exit_code, 0) << again.errors;
    const core::Table table = core::read_csv(folder_.path() / "second.csv");
    EXPECT_NEAR(table.numbers("lift_coefficient")[0], 4 * table.numbers("lift_coefficient_stated")[0], 1e-12);
    EXPECT_EQ(run({"loads", "--manifest", "second.csv", "--density", "1000", "--speed", "1"}).exit_code, 0);
}

TEST_F(PostprocCommands, LoadsTakeZonesByTheirNames) {
    EXPECT_EQ(run_json({"loads", "a-h5.csv", "--zones", "base, hull"})["zones"].size(), 2U);
    const auto wrong = run({"loads", "a-h5.csv", "--zones", "hull,bse"});
    EXPECT_EQ(wrong.exit_code, 3);
    EXPECT_THAT(wrong.errors, testing::HasSubstr("no zone fits 'bse'"));
    EXPECT_THAT(wrong.errors, testing::HasSubstr("did you mean 'base'?"));
}

TEST_F(PostprocCommands, AListOfAnOptionEndsAtItsWordInEveryCommand) {
    // The file stands behind the zones: a list of zones is one word, or the option again.
    for (const std::vector<std::string>& zones :
         {std::vector<std::string>{"--zones", "base,hull"}, {"--zones", "base", "--zones", "hull"}}) {
        std::vector<std::string> words = {"loads"};
        words.insert(words.end(), zones.begin(), zones.end());
        words.insert(words.end(), {"a-h5.csv", "--json"});
        const auto loads = run(words);
        ASSERT_EQ(loads.exit_code, 0) << loads.errors;
        EXPECT_EQ(nlohmann::json::parse(loads.output)["zones"].size(), 2U);
    }
    EXPECT_EQ(run({"import", "--zones", "base", "a-h5.csv", "--out", "base.vtp"}).exit_code, 0);
    EXPECT_EQ(run({"views", "--zones", "base", "a-h5.csv", "--list"}).exit_code, 0);
    EXPECT_EQ(run({"info", "--unit", "pressure=Pa", "a-h5.csv"}).exit_code, 0);
    EXPECT_EQ(run({"probe", "--point", "0,0,0", "a-h5.csv"}).exit_code, 0);
    // The other spelling says the way out.
    for (const char* command : {"loads", "import", "views"}) {
        std::vector<std::string> words = {command, "a-h5.csv", "--zones", "base", "hull"};
        if (std::string(command) != "loads") {
            words.insert(words.end(), {"--out", "elsewhere"});
        }
        const auto two = run(words);
        EXPECT_EQ(two.exit_code, 2) << command;
        EXPECT_THAT(two.errors, testing::HasSubstr("there is no file 'hull'")) << command;
        EXPECT_THAT(two.errors, testing::HasSubstr("--zones 'base,hull'")) << command;
    }
}

TEST_F(PostprocCommands, LoadsRefuseLengthsAndFlowsThatAreNone) {
    for (const char* option : {"--length", "--width", "--height", "--density", "--speed"}) {
        const auto refused = run({"loads", "a-h5.csv", option, "0"});
        EXPECT_EQ(refused.exit_code, 2) << option;
        EXPECT_THAT(refused.errors, testing::HasSubstr(std::string(option) + " is 0 "));
        EXPECT_EQ(run({"loads", "a-h5.csv", std::string(option) + "=-1"}).exit_code, 2) << option;
    }
}

TEST_F(PostprocCommands, LoadsOfABatchNameEveryFileThatCannotBeUsed) {
    std::string cut = box_csv;
    cut.resize(cut.size() - 12);
    core::write_file(folder_.path() / "c-h20.csv", cut + "4,5,6,99\n");
    core::write_file(folder_.path() / "list.csv",
                     "gap [mm], file\n5, a-h5.csv\n7, nowhere.csv\n10, b-h10.csv\n20, c-h20.csv\n");
    const auto refused = run({"loads", "--manifest", "list.csv", "--out", "loads.csv"});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_THAT(refused.errors, testing::HasSubstr("nowhere.csv"));
    EXPECT_THAT(refused.errors, testing::HasSubstr("c-h20.csv:"));
    EXPECT_THAT(refused.errors, testing::HasSubstr("2 of 4 files cannot be used"));
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "loads.csv"));
    const auto kept = run({"loads", "--manifest", "list.csv", "--out", "loads.csv", "--keep-going"});
    EXPECT_EQ(kept.exit_code, 3);
    const core::Table table = core::read_csv(folder_.path() / "loads.csv");
    ASSERT_EQ(table.rows(), 2U);
    EXPECT_NEAR(table.numbers("gap")[1], 0.01, 1e-12);
    const auto as_json = run({"loads", "a-h5.csv", "nowhere.csv", "--keep-going", "--json"});
    EXPECT_EQ(as_json.exit_code, 3);
    const json document = json::parse(as_json.output);
    EXPECT_EQ(document["files"].size(), 1U);
    EXPECT_EQ(document["failed"][0]["file"], "nowhere.csv");
    EXPECT_EQ(run({"loads", "nowhere.csv", "nor-here.csv", "--keep-going"}).exit_code, 3);
}

TEST_F(PostprocCommands, LoadsTakeTheSpeedOfTheirCoefficientsFromTheConditions) {
    core::write_file(folder_.path() / "list.csv", "speed [m/s], file\n2, a-h5.csv\n, b-h10.csv\n");
    ASSERT_EQ(run({"loads", "--manifest", "list.csv", "--density", "1000", "--out", "loads.csv"}).exit_code, 0);
    const core::Table table = core::read_csv(folder_.path() / "loads.csv");
    EXPECT_NEAR(table.numbers("lift_coefficient")[0], -1 / (0.5 * 1000 * 4 * M_PI / 4 * 2 * 1), 1e-12);
    EXPECT_TRUE(std::isnan(table.numbers("lift_coefficient")[1]));
    ASSERT_EQ(run({"loads", "--manifest", "list.csv", "--out", "plain.csv"}).exit_code, 0);
    EXPECT_EQ(core::read_csv(folder_.path() / "plain.csv").find("lift_coefficient"), nullptr);
}

TEST_F(PostprocCommands, LoadsSayWhichRowOfAManifestIsWrong) {
    const auto refusal = [&](const std::string& rows, std::vector<std::string> more = {}) {
        core::write_file(folder_.path() / "list.csv", rows);
        more.insert(more.begin(), {"loads", "--manifest", "list.csv"});
        const auto result = run(more);
        EXPECT_EQ(result.exit_code, 3) << result.output;
        return result.errors;
    };
    EXPECT_THAT(refusal("gap [mm], file\n5, a-h5.csv\n7, \n"),
                testing::HasSubstr("row 2 of the manifest names no file"));
    EXPECT_THAT(refusal("gap [mm], file\n5, a-h5.csv\n7, a-h5.csv\n", {"a-h5.csv"}),
                testing::HasSubstr("row 2 of the manifest lists 'a-h5.csv' once more"));
    EXPECT_THAT(refusal("cells [1], file\n1000, a-h5.csv\n, b-h10.csv\n", {"--mesh-study", "cells"}),
                testing::HasSubstr("b-h10.csv: 'cells' is missing"));
    EXPECT_THAT(refusal("cells [1], file\n1000, a-h5.csv\n0, b-h10.csv\n", {"--mesh-study", "cells"}),
                testing::HasSubstr("'cells' is 0"));
    EXPECT_THAT(refusal("reference_x [m], reference_y [m], reference_z [m], file\n0, 0, , a-h5.csv\n"),
                testing::HasSubstr("needs reference_x, reference_y and reference_z"));
    EXPECT_THAT(refusal("reference_x [s], reference_y [m], reference_z [m], file\n0, 0, 0, a-h5.csv\n"),
                testing::HasSubstr("'reference_x' is in s, not in m"));
    EXPECT_THAT(refusal("density [m], file\n1000, a-h5.csv\n"), testing::HasSubstr("'density' is in m, not in kg/m^3"));
    EXPECT_THAT(refusal("density [kg/m^3], file\n1000, a-h5.csv\n-1, b-h10.csv\n"),
                testing::HasSubstr("list.csv:3: the density is -1 kg/m^3"));
    EXPECT_THAT(refusal("lift_force_scatter [N], file\n0.1, a-h5.csv\n-0.1, b-h10.csv\n"),
                testing::HasSubstr("list.csv:3: lift_force_scatter is -0.1 N"));
    EXPECT_THAT(refusal("cells [m], file\n1000, a-h5.csv\n", {"--mesh-study", "cells"}),
                testing::HasSubstr("'cells' is in m, not in pure numbers"));
    EXPECT_THAT(refusal("gap [mm], file\n5, a-h5.csv\n, b-h10.csv\n", {"--reference", "0,0,gap"}),
                testing::HasSubstr("b-h10.csv: this case has no value of 'gap'"));
}

TEST_F(PostprocCommands, LoadsAreCheckedAgainstAManifest) {
    core::write_file(
        folder_.path() / "stated.csv",
        "gap [mm], lift_force [N], drag_force [N], file\n5, -1.001, 0, a-h5.csv\n10, -1.2, 0, b-h10.csv\n");
    const auto wrong = run({"loads", "--manifest", "stated.csv", "--check", "0.01"});
    EXPECT_EQ(wrong.exit_code, 4);
    EXPECT_THAT(wrong.errors, testing::HasSubstr("b-h10.csv: lift_force is -1, stated -1.2"));
    EXPECT_EQ(run({"loads", "a-h5.csv", "--manifest", "stated.csv", "--check", "0.01"}).exit_code, 0);
    core::write_file(folder_.path() / "part.csv", "gap [mm], lift_force [N], file\n5, -1, a-h5.csv\n10, , b-h10.csv\n");
    const auto part = run({"loads", "--manifest", "part.csv", "--check", "0.01"});
    EXPECT_EQ(part.exit_code, 0);
    EXPECT_THAT(part.errors, testing::HasSubstr("b-h10.csv: 'lift_force' is not stated of this case"));
    EXPECT_THAT(part.errors, testing::HasSubstr("b-h10.csv: compared with nothing"));
    EXPECT_THAT(part.errors, testing::Not(testing::HasSubstr("a-h5.csv: compared with nothing")));
}

TEST_F(PostprocCommands, LoadsAreCheckedAgainstTheSolversOwnReport) {
    const auto report = [](const std::string& lift) {
        return "Forces - Direction Vector (0 0 1)\nZone Pressure Viscous Total Pressure Viscous Total\nbase 2 0 2 0 0 "
               "0\nhull -3 0 -3 0 0 0\nNet " +
               lift + " 0 " + lift + " 0 0 0\n";
    };
    core::write_file(folder_.path() / "right.txt", report("-1"));
    core::write_file(folder_.path() / "a-h5-forces.txt", report("-1.02"));  // found by its name
    const auto found = run({"loads", "a-h5.csv"});
    EXPECT_EQ(found.exit_code, 0) << found.errors;
    EXPECT_THAT(found.output, testing::HasSubstr("the solver's own, in a-h5-forces.txt"));
    EXPECT_THAT(found.output, testing::HasSubstr("2 % of the force apart"));
    const auto wrong = run({"loads", "a-h5.csv", "--check", "1 %", "--json"});
    EXPECT_EQ(wrong.exit_code, 4);
    EXPECT_THAT(wrong.errors, testing::HasSubstr("lift_force is -1, stated -1.02 in a-h5-forces.txt"));
    const json comparison = json::parse(wrong.output)["comparison"];
    ASSERT_EQ(comparison.size(), 9U);
    EXPECT_NEAR(comparison[6]["difference"].get<double>(), 0.02, 1e-12);
    // Named as well, or twice, it counts once.
    const auto once = run({"loads", "a-h5.csv", "--report", "a-h5-forces.txt", "--report", "./{stem}-forces.txt",
                           "--report", "right.txt", "--report", "right.txt", "--json"});
    EXPECT_EQ(json::parse(once.output)["comparison"].size(), 18U);
    const auto one_of_two = run({"loads", "a-h5.csv", "b-h10.csv", "--check", "5 %"});
    EXPECT_EQ(one_of_two.exit_code, 0);
    EXPECT_THAT(one_of_two.errors, testing::HasSubstr("b-h10.csv: compared with nothing"));
    EXPECT_EQ(run({"loads", "b-h10.csv", "--report", "right.txt", "--check", "0.1 %"}).exit_code, 0);
    EXPECT_EQ(run({"loads", "b-h10.csv", "--report", "{stem}-forces.txt", "--check", "0.1 %"}).exit_code,
              3);  // there is none
    const auto nothing = run({"loads", "b-h10.csv", "--check", "0.1 %"});
    EXPECT_EQ(nothing.exit_code, 3);
    EXPECT_THAT(nothing.errors, testing::HasSubstr("nothing to check against"));
}

TEST_F(PostprocCommands, LoadsTakeTheirScatterFromAMonitor) {
    std::string monitor = "\"lift\"\n\"Iteration\" \"lift\"\n(\"Iteration\" \"lift\")\n";
    for (int i = 1; i <= 100; ++i) {
        monitor += std::to_string(i) + (i % 2 == 0 ? " -1.01\n" : " -0.99\n");
    }
    core::write_file(folder_.path() / "a-h5-lift.out", monitor);
    core::write_file(folder_.path() / "b-h10-lift.out", monitor);
    const auto table =
        run({"loads", "{variant}-h{gap:mm}.csv", "--monitor", "lift_force={stem}-lift.out", "--out", "loads.csv"});
    EXPECT_EQ(table.exit_code, 0) << table.errors;
    const core::Table read = core::read_csv(folder_.path() / "loads.csv");
    EXPECT_NEAR(read.numbers("lift_force_sigma")[1], 0.01, 1e-3);
    const auto elsewhere = run_underbody(
        {"loads", (folder_.path() / "a-h5.csv").string(), "--monitor", "lift_force [N]= {stem}-lift.out:lift"}, "/");
    EXPECT_EQ(elsewhere.exit_code, 0) << elsewhere.errors;
    EXPECT_THAT(elsewhere.output, testing::HasSubstr("a-h5-lift.out"));
    EXPECT_EQ(run({"loads", "a-h5.csv", "--monitor", "lift_force=a-h5-lift.out", "--check", "0.5 %"}).exit_code, 4);
    EXPECT_EQ(run({"loads", "a-h5.csv", "--monitor", "lift_force=a-h5-lift.out", "--check", "1.5 %"}).exit_code, 0);
    EXPECT_EQ(run({"loads", "a-h5.csv", "--monitor", "lift=a-h5-lift.out"}).exit_code, 2);
    EXPECT_THAT(run({"loads", "a-h5.csv", "--monitor", "lift_force=a-h5-lift.out"}).output,
                testing::HasSubstr("sigma"));
}

TEST_F(PostprocCommands, LoadsSayTheirReferencePointAndTakeAStatedOne) {
    EXPECT_THAT(run({"loads", "a-h5.csv"}).output,
                testing::HasSubstr("about 1, 0.5, 0 m: centre of the base (zone 'base')"));
    EXPECT_NEAR(run_json({"loads", "a-h5.csv", "--reference", "0,0.5,5 mm"})["pitch_moment"].get<double>(), -1, 1e-12);
    const auto by_gap = run({"loads", "{variant}-h{gap:mm}.csv", "--reference", "0,0.5,gap"});
    EXPECT_EQ(by_gap.exit_code, 0) << by_gap.errors;
    const core::Table table = core::read_csv(by_gap.output, "stdout");
    EXPECT_NEAR(table.numbers("reference_z")[1], 0.01, 1e-12);
    core::write_file(
        folder_.path() / "points.csv",
        "reference_x [mm], reference_y [mm], reference_z [mm], file\n0, 500, 0, a-h5.csv\n2000, 500, 0, b-h10.csv\n");
    const core::Table stated = core::read_csv(run({"loads", "--manifest", "points.csv"}).output, "stdout");
    EXPECT_NEAR(stated.numbers("pitch_moment")[0], -1, 1e-12);
    EXPECT_NEAR(stated.numbers("pitch_moment")[1], 1, 1e-12);
    EXPECT_EQ(stated.numbers("reference_x")[1], 2);
    EXPECT_EQ(run({"loads", "a-h5.csv", "--reference", "0,0"}).exit_code, 2);
    EXPECT_EQ(run({"loads", "a-h5.csv", "--reference", "0,0,gap"}).exit_code, 2);
}

TEST_F(PostprocCommands, LoadsOfThreeMeshesGetTheirUncertaintyFromPatterns) {
    UNDERBODY_NEEDS_SHARED("cfd/fields/ellipse-h5-p0-fine.csv");
    std::filesystem::create_directory_symlink(test::shared_folder() / "cfd" / "fields", folder_.path() / "fields");
    const auto run_it =
        run({"loads", "fields/{variant}-h{gap:mm}-p{pitch:deg}.csv",
             "fields/{variant}-h{gap:mm}-p{pitch:deg}-coarse.csv", "fields/{variant}-h{gap:mm}-p{pitch:deg}-fine.csv",
             "--symmetry", "y", "--mesh-study", "faces", "--out", "loads.csv"});
    EXPECT_EQ(run_it.exit_code, 0) << run_it.errors;
    EXPECT_THAT(run_it.errors, testing::HasSubstr("no convergence"));  // lift at 5 mm
    EXPECT_THAT(run_it.errors, testing::HasSubstr("GCI"));
    const core::Table table = core::read_csv(folder_.path() / "loads.csv");
    EXPECT_EQ(table.rows(), 43U);
    std::size_t with_sigma = 0;
    for (std::size_t i = 0; i < table.rows(); ++i) {
        const double sigma = table.numbers("lift_force_sigma")[i];
        with_sigma += std::isfinite(sigma) ? 1 : 0;
        if (std::isfinite(sigma)) {
            EXPECT_LT(sigma, 0.1 * std::abs(table.numbers("lift_force")[i]));
            EXPECT_GT(sigma, 0);
        }
    }
    EXPECT_EQ(with_sigma, 2U);
}

TEST_F(PostprocCommands, ImportWritesVtkFiles) {
    EXPECT_EQ(run({"import", "a-h5.csv", "--out", "a.vtp"}).exit_code, 0);
    EXPECT_EQ(run({"import", "*-h*.csv", "--out", "all.vtm"}).exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "a.vtp"));
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "all-b-h10.vtm"));
    EXPECT_EQ(run({"import", "a-h5.csv", "--out", "trimmed.vtp", "--arrays", "wall_shear, pressure"}).exit_code, 0);
    EXPECT_EQ(run_json({"info", "trimmed.vtp"})["arrays"][0]["name"], "pressure");
    EXPECT_EQ(run({"import", "a-h5.csv", "--out", "a.xyz"}).exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "a.xyz"));
}

TEST_F(PostprocCommands, InfoNamesTheFileOfTheUserAndSaysWhatItCounts) {
    const std::string data = (test::data_folder() / "fluent_legacy/ascii.dat").string();
    const json info = run_json({"info", data});
    EXPECT_EQ(info["file"], data);
    EXPECT_TRUE(info.contains("points_counted"));
    EXPECT_THAT(run({"info", data}).output,
                testing::AllOf(testing::StartsWith(data), testing::HasSubstr("points zone by zone")));
    core::write_file(folder_.path() / "wall.vtk",
                     "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 3 double\n0 0 0 1 0 0 0 1 "
                     "0\nPOLYGONS 1 4\n3 0 1 2\nCELL_DATA 1\n"
                     "VECTORS wallShearStress double\n1 2 3\n");
    EXPECT_THAT(run({"info", "wall.vtk", "--unit", "wallShearStress=Pa", "--verbose"}).errors,
                testing::HasSubstr("turned round"));
}

TEST_F(PostprocCommands, OptionsThatAFileHasNoUseForAreTold) {
    const auto refused = [&](const std::vector<std::string>& arguments) {
        const auto result = run(arguments);
        EXPECT_EQ(result.exit_code, 3) << result.output;
        return result.errors;
    };
    EXPECT_THAT(refused({"loads", "a-h5.csv", "--unit", "Presure=kPa"}),
                testing::HasSubstr("did you mean 'Pressure'?"));
    EXPECT_THAT(refused({"info", "a-h5.csv", "--unit", "Helicity=m/s^2"}),
                testing::HasSubstr("there is no variable 'Helicity'"));
    EXPECT_EQ(run({"loads", "a-h5.csv", "--unit", "pressure=Pa"}).exit_code, 0);
    EXPECT_EQ(run({"loads", "a-h5.csv", "--unit", "X=m"}).exit_code, 0);
    EXPECT_THAT(refused({"loads", "a-h5.csv", "--time", "3"}), testing::HasSubstr("of one time each"));
    EXPECT_THAT(refused({"loads", "a-h5.csv", "--mesh", "b-h10.csv"}), testing::HasSubstr("leave --mesh away"));
    EXPECT_EQ(run({"import", "a-h5.csv", "--out", "a.vtp"}).exit_code, 0);
    const auto lengths = run({"info", "a.vtp", "--length-unit", "mm", "--json"});
    EXPECT_EQ(lengths.exit_code, 0);
    EXPECT_THAT(lengths.errors, testing::HasSubstr("its lengths are in m, as it says"));
    EXPECT_EQ(json::parse(lengths.output)["zones"][0]["bounding_box"][1][0], 2.0);
    const std::string box = (test::data_folder() / "openfoam/ascii").string();
    EXPECT_THAT(run({"info", box, "--length-unit", "mm"}).output,
                testing::HasSubstr("its lengths are in m, as it says"));
}

TEST_F(PostprocCommands, PatternsTakeFoldersThatAreCases) {
    const auto data = test::data_folder() / "openfoam/ascii";
    const auto copy_of = [&](const char* name) {
        std::filesystem::create_directories(folder_.path() / "runs");
        std::filesystem::copy(data, folder_.path() / "runs" / name, std::filesystem::copy_options::recursive);
    };
    copy_of("gap5");
    copy_of("gap10");
    std::filesystem::create_directories(folder_.path() / "runs" / "notes");
    core::write_file(folder_.path() / "runs" / "notes" / "why.txt", "notes\n");
    const json all = run_json({"loads", "runs/*", "--zones", "*Wall*"});
    ASSERT_EQ(all["files"].size(), 2U);
    const json by_gap = run_json({"loads", "runs/gap{gap:mm}", "--zones", "*Wall*"});
    ASSERT_EQ(by_gap["files"].size(), 2U);
    EXPECT_DOUBLE_EQ(by_gap["files"][0]["conditions"]["gap"].get<double>(), 0.005);
    EXPECT_DOUBLE_EQ(by_gap["files"][1]["conditions"]["gap"].get<double>(), 0.01);
    EXPECT_EQ(by_gap["files"][0]["drag_force"], all["files"][0]["drag_force"]);
    const auto none = run({"loads", "runs/no*"});
    EXPECT_EQ(none.exit_code, 3);
    EXPECT_THAT(none.errors, testing::HasSubstr("what fits is a folder, and no OpenFOAM case"));
    copy_of("gap1O");
    const auto missed = run({"loads", "runs/gap{gap:mm}", "--zones", "*Wall*"});
    EXPECT_EQ(missed.exit_code, 0);
    EXPECT_THAT(missed.output + missed.errors, testing::HasSubstr("gap1O ('1O' is no number"));
    const auto added = run({"study", "add", "campaign", "--files", "../runs/gap{gap:mm}"});
    EXPECT_EQ(added.exit_code, 0) << added.errors;
    EXPECT_THAT(added.output, testing::AllOf(testing::HasSubstr("2 cases added"), testing::HasSubstr("gap1O"),
                                             testing::Not(testing::HasSubstr("notes"))));
}

TEST_F(PostprocCommands, ImportLosesNoFile) {
    const auto exists = [&](const char* name) { return std::filesystem::exists(folder_.path() / name); };
    for (const char* name : {"a/body.csv", "b/body.csv", "b/body.vtk.csv"}) {
        core::write_file(folder_.path() / name, box_csv);
    }
    EXPECT_EQ(run({"import", "a/body.csv", "b/body.csv", "--out", "imp.vtp"}).exit_code, 0);
    EXPECT_TRUE(exists("imp-a-body.vtp") && exists("imp-b-body.vtp") && !exists("imp-body.vtp"));
    EXPECT_EQ(run({"import", "a/body.csv", "a/../a/body.csv", "--out", "twice.vtp"}).exit_code, 2);
    EXPECT_FALSE(exists("twice-body.vtp"));
    // What is read stays.
    for (const char* out : {"imp-a-body.vtp", "./imp-a-body.vtp"}) {
        const auto over = run({"import", "imp-a-body.vtp", "--out", out, "--zones", "base"});
        EXPECT_EQ(over.exit_code, 2);
        EXPECT_THAT(over.errors, testing::HasSubstr("would be written over"));
    }
    EXPECT_EQ(run({"import", "a/body.csv", "--out", "x.vtm"}).exit_code, 0);
    EXPECT_EQ(run({"import", "x/0-base.vtp", "--out", "x.vtm"}).exit_code, 2);
    core::write_file(folder_.path() / "bad.csv", "[Name]\n");
    const auto half = run({"import", "a-h5.csv", "bad.csv", "b-h10.csv", "--out", "half.vtp"});
    EXPECT_EQ(half.exit_code, 3);
    EXPECT_THAT(half.errors, testing::HasSubstr("written before: half-a-h5.vtp; the other 2 files were not"));
    EXPECT_THAT(run({"import", "a-h5.csv", "--arrays", "presure", "--out", "slip.vtp"}).output,
                testing::HasSubstr("there is no array 'presure'"));
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
    core::write_file(folder_.path() / "ragged.csv", box_csv.substr(0, box_csv.find("0,1,0,1")) + "0,1\n");
    const json ragged = json::parse(run({"info", "ragged.csv", "--json"}).output)["error"];
    EXPECT_EQ(ragged["understood"], "1 zone (base)");
    EXPECT_EQ(run({"loads", "a-h5.csv", "--zones", "keel"}).exit_code, 3);
    EXPECT_EQ(run({"loads", "a-h5.csv", "--up", "q"}).exit_code, 2);
    EXPECT_EQ(run({"loads", "none.csv"}).exit_code, 3);
}

TEST_F(PostprocCommands, ViewsAreDrawnWithoutADisplay) {
    const auto result =
        run_underbody({"views", "a-h5.csv", "--out", "pictures", "--view", "pressure-underbody", "--json"},
                      folder_.path(), {{"DISPLAY", ""}});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_THAT(core::read_file(folder_.path() / "pictures" / "pressure-underbody.png"),
                testing::StartsWith("\x89PNG"));
    EXPECT_EQ(json::parse(result.output)["views"][0]["name"], "pressure-underbody");
    EXPECT_EQ(run({"views", "a-h5.csv", "--view", "nothing"}).exit_code, 3);
}

TEST_F(PostprocCommands, ViewsOfFilesOfOneNameAreKeptApart) {
    for (const char* folder : {"a", "b"}) {
        std::filesystem::create_directories(folder_.path() / folder);
        core::write_file(folder_.path() / folder / "case.csv", box_csv);
    }
    const json views = run_json({"views", "a/case.csv", "b/case.csv", "a-h5.csv", "./a/case.csv", "--out", "pictures",
                                 "--view", "pressure-hull"})["views"];
    ASSERT_EQ(views.size(), 3U);
    EXPECT_EQ(views[0]["file"], "pictures/a-case-pressure-hull.png");
    EXPECT_EQ(views[1]["file"], "pictures/b-case-pressure-hull.png");
    EXPECT_EQ(views[2]["file"], "pictures/a-h5-pressure-hull.png");
    const json listed = run_json({"views", "a/case.csv", "b/case.csv", "--list"})["views"];
    ASSERT_EQ(listed.size(), 4U);
    EXPECT_EQ(listed[0]["name"], "pressure-underbody");
    EXPECT_EQ(listed[2]["of"], "b/case.csv");
    EXPECT_THAT(run({"views", "a/case.csv", "--list"}).output, testing::StartsWith("pressure-underbody\n"));
}

TEST_F(PostprocCommands, ViewsSayWhatMeansNothingWithADifference) {
    const auto difference = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"views",    "a-h5.csv", "b-h10.csv", "--difference",
                                              "pressure", "--out",    "pictures"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments).exit_code;
    };
    EXPECT_EQ(difference({"--view", "pressure-hull"}), 2);
    EXPECT_EQ(difference({"--list"}), 2);
    EXPECT_EQ(difference({"--range", "pressure=-1:1"}), 2);
    EXPECT_EQ(difference({"--range", "difference=-1:1"}), 0);
}

TEST_F(PostprocCommands, ATimeThatChoosesNothingIsSaid) {
    EXPECT_THAT(run({"probe", "a-h5.csv", "--point", "0,0,0", "--time", "3"}).errors,
                testing::HasSubstr("states no times"));
    EXPECT_THAT(run({"probe", "a-h5.csv", "--point", "0,0,0"}).errors,
                testing::Not(testing::HasSubstr("states no times")));
}

TEST_F(PostprocCommands, ProbeLooksAtPointsAndLines) {
    const json line =
        run_json({"probe", "a-h5.csv", "--line", "0,0,0:0,0,0.5", "--count", "3", "--arrays", "pressure"});
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
