#include <gmock/gmock.h>

#include <cmath>

#include "core/file.h"
#include "postproc/importers/reports.h"
#include "tests/support/support.h"

namespace underbody {

using namespace postproc;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

std::filesystem::path written(const core::TemporaryFolder& folder, const std::string& text) {
    core::write_file(folder.path() / "file.out", text);
    return folder.path() / "file.out";
}

}  // namespace

TEST(Monitors, RealReportFilesAndTranscriptsAgree) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_ascii_reports");
    const auto folder = test::shared_folder() / "samples/fluent_ascii_reports";
    const auto torque = read_monitor(folder / "axialfan_baseDP_torque-rfile.out");
    EXPECT_THAT(torque.columns, ElementsAre("Iteration", "torque"));
    EXPECT_EQ(torque.title, "torque-rfile");
    EXPECT_GT(torque.values[0].size(), 500U);
    // The residuals of the transcript, and those that someone drew out of it as a table.
    const auto transcript = read_monitor(folder / "axialfan_baseDP_transcript.trn");
    const auto table = read_monitor(folder / "axialfan_baseDP_residuals-data-static.csv");
    ASSERT_NE(transcript.find("omega"), nullptr);
    ASSERT_NE(table.find("omega"), nullptr);
    EXPECT_NEAR(transcript.find("omega")->at(1), table.find("omega")->at(0), 1e-5);
    EXPECT_NEAR(transcript.find("x-velocity")->at(1), table.find("x-velocity")->at(0), 1e-7);
}

TEST(Monitors, ARestartKeepsTheLastValueAndDivergenceIsTold) {
    const core::TemporaryFolder folder;
    const auto monitor =
        read_monitor(written(folder,
                             "\"lift-rfile\"\n\"Iteration\" \"lift etc..\"\n(\"Iteration\" \"lift\" \"drag force\")\n"
                             "1 0.5 1\n2 0.6 2\n3 0.7 3\n2 0.65 2.5\n3 nan 3.5\n"));
    EXPECT_THAT(monitor.columns, ElementsAre("Iteration", "lift", "drag force"));
    EXPECT_THAT(monitor.values[0], ElementsAre(1, 2, 3));
    EXPECT_EQ(monitor.values[1][1], 0.65);
    EXPECT_TRUE(std::isnan(monitor.values[1][2]));
    EXPECT_EQ(monitor.problems.size(), 2U);
}

TEST(Monitors, ARaggedTableIsRefusedWithItsLine) {
    const core::TemporaryFolder folder;
    try {
        read_monitor(written(folder, "(\"Iteration\" \"lift\")\n1 0.5\n2 0.6 7\n"));
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("file.out:3"));
    }
}

TEST(Plots, CurvesHaveTheirNames) {
    const core::TemporaryFolder folder;
    const auto plot =
        read_plot(written(folder,
                          "(title \"Static Pressure\")\n(labels \"Position\" \"Static Pressure\")\n\n"
                          "((xy/key/label \"wall\")\n0\t1.5\n1\t2.5\n)\n((xy/key/label \"base\")\n0 3\n)\n"));
    ASSERT_EQ(plot.curves.size(), 2U);
    EXPECT_EQ(plot.curves[0].name, "wall");
    EXPECT_THAT(plot.curves[0].y, ElementsAre(1.5, 2.5));
    EXPECT_EQ(plot.y_label, "Static Pressure");
}

TEST(ForceReports, BothLayoutsAreRead) {
    const core::TemporaryFolder folder;
    const auto old = read_force_reports(written(
        folder,
        "Forces - Direction Vector (1 0 0)\n                 Forces (n)                 Coefficients\n"
        "Zone             Pressure  Viscous  Total  Pressure Viscous Total\nwall:008 0.25 0.5 0.75 0.4 0.8 1.2\n"
        "----- ----- ------ ------ ----- ----- -----\nNet 0.25 0.5 0.75 0.4 0.8 1.2\n"));
    ASSERT_EQ(old.size(), 1U);
    EXPECT_EQ(old[0].rows[0].zone, "wall:008");
    ASSERT_NE(old[0].net(), nullptr);
    EXPECT_EQ(old[0].net()->viscous, 0.5);
    EXPECT_EQ(old[0].direction[0], 1);
    const auto triples =
        read_force_reports(written(folder,
                                   "Forces\nZone Pressure Viscous Total Pressure Viscous Total\n"
                                   "hull (1 2 3) (0.1 0.2 0.3) (1.1 2.2 3.3) (4 5 6) (7 8 9) (10 11 12)\n"
                                   "Net (1 2 3) (0.1 0.2 0.3) (1.1 2.2 3.3) (4 5 6) (7 8 9) (10 11 12)\n"));
    ASSERT_EQ(triples.size(), 3U);
    EXPECT_EQ(triples[2].direction[2], 1);
    EXPECT_EQ(triples[2].net()->total, 3.3);
}

}  // namespace underbody
