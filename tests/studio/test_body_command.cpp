#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

std::string shape(const char* name) {
    return (source_folder() / "cases/evie/shapes" / (std::string(name) + ".toml")).string();
}

TEST(BodyCommand, MakesTheBodyOfAShape) {
    const core::TemporaryFolder folder;
    const auto run = run_underbody({"body", shape("ellipse"), "--out", "evie.stl", "--json"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const nlohmann::json document = nlohmann::json::parse(run.output);
    EXPECT_NEAR(document.at("volume").get<double>(), 0.0022442, 3e-6);
    EXPECT_TRUE(document.at("watertight").get<bool>());
    EXPECT_TRUE(document.at("quality").at("passed").get<bool>());
    EXPECT_EQ(document.at("added_mass").size(), 6u);
    // 1.536 kg at 4000 panels; the whole ellipsoid has 1.457 (Lamb), and the sharp edge of the base adds to it.
    EXPECT_NEAR(document.at("added_mass")[2][2].get<double>(), 1.535, 0.01);
    EXPECT_TRUE(document.at("gap").is_null());
    std::size_t faces = 0;
    for (const auto& patch : document.at("patches")) {
        faces += patch.at("faces").get<std::size_t>();
    }
    EXPECT_EQ(std::filesystem::file_size(folder.path() / "evie.stl"), 84 + 50 * faces);
}

TEST(BodyCommand, TakesASurfaceFileWithItsUnitOnly) {
    const core::TemporaryFolder folder;
    ASSERT_EQ(run_underbody({"body", shape("rectangle_bump2"), "--out", "a.stl", "--out-unit", "mm", "--triangles",
                             "3000", "--panels", "0"},
                            folder.path())
                  .exit_code,
              0);
    const auto without = run_underbody({"body", "a.stl"}, folder.path());
    EXPECT_EQ(without.exit_code, 3);
    EXPECT_THAT(without.errors, testing::HasSubstr("--unit"));
    const auto with = run_underbody({"body", "a.stl", "--unit", "mm", "--panels", "0", "--json"}, folder.path());
    ASSERT_EQ(with.exit_code, 0) << with.errors;
    EXPECT_NEAR(nlohmann::json::parse(with.output).at("volume").get<double>(), 0.002227, 1.5e-5);
}

TEST(BodyCommand, SaysTheOuterSizeAndWhatTheKeyHeightMeans) {
    const core::TemporaryFolder folder;
    const auto run = run_underbody({"body", shape("ellipse"), "--panels", "0"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_THAT(run.output, testing::HasSubstr("length 203.2, width 152, height 126.875 mm over all"));
    EXPECT_THAT(run.output,
                testing::HasSubstr("body.height, 145 mm, is that of the whole ellipsoid before its base is cut"));
    const auto json = run_underbody({"body", shape("ellipse"), "--panels", "0", "--json"}, folder.path());
    const nlohmann::json document = nlohmann::json::parse(json.output);
    EXPECT_NEAR(document.at("outer_size").at("height").get<double>(), 0.126875, 1e-9);
    EXPECT_EQ(document.at("mass_from"), "exact shape");
}

TEST(BodyCommand, PrintsTheTrimOfTheMassThatItMoved) {
    const core::TemporaryFolder folder;
    std::ofstream(folder.path() / "s.toml")
        << "[body]\nlength='203.2 mm'\nwidth='152 mm'\nheight='145 mm'\nbase_cut=0.75\n[mass]\nhull='1.5 kg'\n"
           "[[mass.point]]\nname='lead'\nmass='0.7 kg'\nposition=['-20 mm','5 mm','12 mm']\n";
    for (const double wanted : {0.0, 1.0, -3.0}) {
        const auto run = run_underbody({"body", "s.toml", "--panels", "0", "--ballast", "lead", "--trim-pitch",
                                        std::to_string(wanted) + "deg", "--json"},
                                       folder.path());
        ASSERT_EQ(run.exit_code, 0) << run.errors;
        const nlohmann::json document = nlohmann::json::parse(run.output);
        EXPECT_NEAR(document.at("trim").at("pitch").get<double>(), wanted * 3.14159265358979 / 180, 1e-9);
        EXPECT_NEAR(document.at("trim").at("roll").get<double>(), 0, 1e-9);
        EXPECT_FALSE(document.contains("remarks"));
    }
    const auto text =
        run_underbody({"body", "s.toml", "--panels", "0", "--ballast", "lead", "--trim-pitch", "1deg"}, folder.path());
    EXPECT_THAT(text.output, testing::HasSubstr("ballast     moved to"));
    EXPECT_THAT(text.output, testing::HasSubstr("pitch 1 deg, roll 0 deg"));
    const auto steep =
        run_underbody({"body", "s.toml", "--panels", "0", "--ballast", "lead", "--trim-pitch", "25deg"}, folder.path());
    EXPECT_THAT(steep.output, testing::HasSubstr("its base no longer lies along the ground"));
    EXPECT_EQ(run_underbody({"body", "s.toml", "--panels", "0", "--trim-pitch", "1deg"}, folder.path()).exit_code, 2)
        << "a wanted trim without a ballast would do nothing";
}

TEST(BodyCommand, DoubtsAGapWithoutAUnitThatIsManyBodyLengths) {
    const core::TemporaryFolder folder;
    const auto run = run_underbody({"body", shape("ellipse"), "--panels", "0", "--gap", "4"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_THAT(run.output, testing::HasSubstr("--gap 4 is 4000 mm, 19.7 lengths of the body: a bare number is in "
                                               "metres; for millimetres write --gap 4mm"));
    const auto json = run_underbody({"body", shape("ellipse"), "--panels", "0", "--gap", "4", "--json"}, folder.path());
    EXPECT_THAT(nlohmann::json::parse(json.output).at("remarks").at(0).get<std::string>(),
                testing::HasSubstr("4000 mm"));
    EXPECT_THAT(run_underbody({"body", shape("ellipse"), "--panels", "0", "--gap", "4mm"}, folder.path()).output,
                testing::Not(testing::HasSubstr("remark")));
    const auto angle =
        run_underbody({"body", shape("ellipse"), "--panels", "0", "--gap", "4mm", "--pitch", "2"}, folder.path());
    EXPECT_EQ(angle.exit_code, 2);
    EXPECT_THAT(angle.errors, testing::HasSubstr("write 2deg"));
}

TEST(BodyCommand, SaysWhatTheFacetsOfASurfaceFileLeaveOut) {
    const core::TemporaryFolder folder;
    ASSERT_EQ(run_underbody({"body", shape("ellipse"), "--out", "a.stl", "--triangles", "2000", "--panels", "0"},
                            folder.path())
                  .exit_code,
              0);
    const auto run = run_underbody({"body", "a.stl", "--unit", "m", "--panels", "0"}, folder.path());
    EXPECT_THAT(run.output,
                testing::HasSubstr("of its facets; a smooth surface through their corners holds about 0.7"));
}

TEST(BodyCommand, RefusesAShapeThatCannotBe) {
    const core::TemporaryFolder folder;
    std::ofstream(folder.path() / "s.toml")
        << "[body]\nlength='203.2 mm'\nwidth='-152 mm'\nheight='145 mm'\nbase_cut=0.75\n";
    const auto run = run_underbody({"body", "s.toml", "--out", "s.stl"}, folder.path());
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_THAT(run.errors, testing::HasSubstr("s.toml:3"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "s.stl"));
    EXPECT_EQ(run_underbody({"body"}, folder.path()).exit_code, 2);
    EXPECT_EQ(run_underbody({"body", shape("ellipse"), "--out", "s.step"}, folder.path()).exit_code, 2);
}

TEST(BodyCommand, DrawsSectionUndersideAndGap) {
    const core::TemporaryFolder folder;
    const auto run = run_underbody({"body",          shape("ellipse_front_bump2"),
                                    "--gap",         "5mm",
                                    "--pitch",       "1deg",
                                    "--triangles",   "6000",
                                    "--panels",      "0",
                                    "--section",     "s.png",
                                    "--underbody",   "u.png",
                                    "--gap-picture", "g.png",
                                    "--area-curve",  "a.csv",
                                    "--area-up-to",  "20mm"},
                                   folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    for (const char* name : {"s.png", "u.png", "g.png"}) {
        EXPECT_GT(std::filesystem::file_size(folder.path() / name), 5000u) << name;
    }
    EXPECT_THAT(run.output, testing::HasSubstr("clearance"));
    EXPECT_THAT(run.output, testing::HasSubstr("nose down"));
    const core::Table curve = core::read_csv(folder.path() / "a.csv");
    EXPECT_DOUBLE_EQ(curve.numbers("height").back(), 0.02);
    EXPECT_GT(curve.numbers("area").back(), 0.007) << "more than the flat base";
    EXPECT_EQ(run_underbody({"body", shape("ellipse"), "--area-curve", "a.png"}, folder.path()).exit_code, 2)
        << "over what ground?";
}

TEST(BodyCommand, TabulatesTheAddedMassOfASurfaceFile) {
    const core::TemporaryFolder folder;
    ASSERT_EQ(run_underbody({"body", shape("ellipse"), "--out", "a.stl", "--panels", "0"}, folder.path()).exit_code, 0);
    const auto run = run_underbody(
        {"body", "added-mass", "a.stl", "--unit", "m", "--gap", "5mm", "--panels", "600", "--json"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto at_gap = nlohmann::json::parse(run.output).at("gaps")[0];
    EXPECT_NEAR(at_gap.at("added_mass")[2][2].get<double>(), 3.503, 0.035);
    EXPECT_GT(at_gap.at("panel_fit").at("distance_largest").get<double>(), 0);
}

TEST(BodyCommand, ComparesTablesAndSweeps) {
    const core::TemporaryFolder folder;
    const auto compared =
        run_underbody({"body", "compare", shape("rectangle"), shape("rectangle_bump1"), "--json"}, folder.path());
    ASSERT_EQ(compared.exit_code, 0) << compared.errors;
    EXPECT_NEAR(nlohmann::json::parse(compared.output).at("largest_distance").get<double>(), 0.001, 1e-5);
    const auto mass = run_underbody({"body", "added-mass", shape("ellipse"), "--gap", "2mm:50mm", "--count", "3",
                                     "--panels", "600", "--out", "a.csv"},
                                    folder.path());
    ASSERT_EQ(mass.exit_code, 0) << mass.errors;
    const core::Table table = core::read_csv(folder.path() / "a.csv");
    EXPECT_GT(table.numbers("added_mass_heave")[0], table.numbers("added_mass_heave")[2]);
    std::ofstream(folder.path() / "v.toml")
        << core::read_file(shape("rectangle"))
        << "\n[[vary]]\nkey = 'body.edge_radius'\nvalues = ['1 mm', '2 mm', '1 mm']\n";
    const auto sweep = run_underbody({"body", "sweep", "v.toml", "--out", "v", "--triangles", "2000"}, folder.path());
    ASSERT_EQ(sweep.exit_code, 0) << sweep.errors;
    EXPECT_THAT(sweep.output, testing::HasSubstr("2 made, 1 equal"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "v/sheet.png"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "v/v-002.stl"));
}

// What the options vary and keep is what a file with [[vary]] gives, row by row.
TEST(BodyCommand, SweepsByOptionsAndKeepsWhatLiesWithin) {
    const core::TemporaryFolder folder;
    std::ofstream(folder.path() / "hull.toml") << core::read_file(shape("rectangle"));
    std::filesystem::create_directories(folder.path() / "v");
    std::ofstream(folder.path() / "v" / "hull.toml")
        << core::read_file(shape("rectangle"))
        << "\n[[vary]]\nkey = 'body.base_cut'\nfrom = 0.6\nto = 0.8\ncount = 3\n";
    const auto sweep = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"body", "sweep"});
        more.insert(more.end(), {"--triangles", "2000"});
        return run_underbody(more, folder.path());
    };
    const auto of_file = sweep({"v/hull.toml"});
    ASSERT_EQ(of_file.exit_code, 0) << of_file.errors;
    const auto of_options = sweep({"hull.toml", "--vary", "body.base_cut=0.6:0.8:3"});
    EXPECT_EQ(of_options.output, of_file.output) << of_options.errors;
    EXPECT_EQ(sweep({"hull.toml", "--vary", "body.base_cut=0.6,0.7,0.8"}).output, of_file.output);

    const core::Table all = core::read_csv(of_file.output, "all");
    const double middle = all.numbers("volume")[1];
    const auto kept = sweep({"hull.toml", "--vary", "body.base_cut=0.6:0.8:3", "--where",
                             "volume=" + core::format_number(1e6 * (middle - 1e-6)) +
                                 "cm^3:" + core::format_number(1e6 * (middle + 1e-6)) + "cm^3"});
    ASSERT_EQ(kept.exit_code, 0) << kept.errors;
    const core::Table one = core::read_csv(kept.output, "kept");
    ASSERT_EQ(one.rows(), 1U);
    EXPECT_EQ(one.text("name")[0], "hull-002");
    EXPECT_EQ(sweep({"hull.toml", "--vary", "body.base_cut=0.6:0.8:3", "--where", "volume=1:2"}).exit_code, 4);
    const auto wrong = sweep({"hull.toml", "--vary", "body.base_cut=0.6:0.8:3", "--where", "volme=1:2"});
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.errors, testing::HasSubstr("volume"));
    EXPECT_EQ(sweep({"hull.toml", "--vary", "body.base_cut=0.6:0.8:1"}).exit_code, 2);
    EXPECT_EQ(sweep({"hull.toml", "--vary", "body.base_cut"}).exit_code, 2);
    EXPECT_EQ(sweep({"hull.toml", "--set", "body.base_cut=0.7"}).exit_code, 2);
}

TEST(BodyCommand, WritesACaseForASolver) {
    const core::TemporaryFolder folder;
    const auto run = run_underbody({"body", "domain", shape("ellipse"), "--gap", "10mm", "--triangles", "4000",
                                    "--mesher", "snappy", "--out", "case"},
                                   folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "case/system/snappyHexMeshDict"));
    EXPECT_EQ(
        run_underbody({"body", "domain", shape("ellipse"), "--gap", "10mm", "--out", "case"}, folder.path()).exit_code,
        3)
        << "never over another";
}

TEST(BodyCommand, SaysThatAGapIsThinnerThanAnyThatWasChecked) {
    const core::TemporaryFolder folder;
    const auto errors = [&](const std::string& gap, const std::string& out) {
        return run_underbody(
                   {"body", "domain", shape("ellipse"), "--gap", gap, "--mesh-density", "draft", "--out", out},
                   folder.path())
            .errors;
    };
    EXPECT_THAT(errors("0.9um", "thin"), testing::HasSubstr("gap of 0.0009 mm is thinner than any"));
    EXPECT_EQ(errors("1mm", "checked"), "");
}

}  // namespace
}  // namespace underbody::test
