#include <gmock/gmock.h>

#include <cmath>

#include "core/file.h"
#include "postproc/importers/reports/reports.h"
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

TEST(Monitors, ATitleMayLookLikeANumberAndLinesMayEndInCarriageReturns) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "lift.out";
    for (const std::string title : {"12", "nan", "inf", "-1e5"}) {
        const std::string text = "\"" + title + "\"\n\"Iteration\" \"lift\"\n(\"Iteration\" \"lift\")\n1 1.5\n2 1.6\n";
        core::write_file(path, text + text);  // a restart writes its heads again
        EXPECT_TRUE(report_kinds(path).monitor) << title;
        const Monitor monitor = read_monitor(path);
        EXPECT_EQ(monitor.title, title);
        EXPECT_THAT(monitor.columns, testing::ElementsAre("Iteration", "lift"));
        EXPECT_EQ(monitor.values[0].size(), 2U);
        std::string returns = text;
        std::replace(returns.begin(), returns.end(), '\n', '\r');
        core::write_file(path, returns);
        EXPECT_TRUE(report_kinds(path).monitor);
        EXPECT_EQ(read_monitor(path).values[1].back(), 1.6);
    }
    std::string often;
    for (int run = 0; run < 12; ++run) {
        often += "\"l\"\n\"Iteration\" \"lift\"\n(\"Iteration\" \"lift\")\n" + std::to_string(run) + " 1.5\n";
    }
    core::write_file(path, often);
    EXPECT_EQ(read_monitor(path).values[0].size(), 12U);
    core::write_file(path, "\"l\"\n\"Iteration\" \"nanoparticles\"\n1 -nan(ind)\n2 1.6\n");
    EXPECT_EQ(read_monitor(path).columns[1], "nanoparticles");
    EXPECT_TRUE(std::isnan(read_monitor(path).values[1][0]));
}

TEST(Monitors, AHeadOfBracketsAloneLeavesTheColumnUnnamed) {
    const core::TemporaryFolder folder;
    const auto monitor = read_monitor(written(folder, ")\n1 0.5\n2 0.6\n"));
    EXPECT_THAT(monitor.columns, ElementsAre("Iteration", "value"));
    EXPECT_THAT(monitor.values[1], ElementsAre(0.5, 0.6));
}

TEST(Monitors, TablesOfOpenFoamHaveTheNamesOfTheirHeading) {
    const core::TemporaryFolder folder;
    const auto read = [&](const std::string& text) {
        core::write_file(folder.path() / "table.dat", text);
        EXPECT_TRUE(report_kinds(folder.path() / "table.dat").monitor) << text;
        return read_monitor(folder.path() / "table.dat");
    };
    const auto force =
        read("# Force\n# CofR : (0 0 0)\n#\n# Time\ttotal_x\ttotal_y\ttotal_z\n0.1\t1 2 3\n0.2\t4 5 6\n");
    EXPECT_EQ(force.title, "Force");
    EXPECT_THAT(force.columns, testing::ElementsAre("Time", "total_x", "total_y", "total_z"));
    EXPECT_THAT(*force.find("total_y"), testing::ElementsAre(2, 5));
    EXPECT_FALSE(force.coefficients);
    const auto brackets =
        read("# Time (total_x total_y total_z) (pressure_x pressure_y pressure_z)\n1 (1 2 3) (4 5 6)\n");
    EXPECT_THAT(brackets.columns, testing::ElementsAre("Time", "total_x", "total_y", "total_z", "pressure_x",
                                                       "pressure_y", "pressure_z"));
    const auto older = read(
        "# Forces\n# Time forces(pressure viscous) moment(pressure viscous)\n1 ((1 2 3) (4 5 6)) ((7 8 9) (10 11 "
        "12))\n");
    EXPECT_EQ(older.columns.size(), 13U);
    EXPECT_THAT(*older.find("moment_viscous_x"), testing::ElementsAre(10));
    const auto coefficients = read(
        "# Force coefficients\n# dragDir : (1 0 0)\n# liftDir : (0 0 1)\n# magUInf : 2\n# lRef : 0.5\n# Aref : 0.25\n# "
        "CofR : (0.1 0 0)\n#\n"
        "# Time Cd Cl Cl(f) CmPitch\n10 0.5 1 0.5 0.25\n");
    EXPECT_THAT(coefficients.columns, testing::ElementsAre("Time", "Cd", "Cl", "Cl(f)", "CmPitch"));
    ASSERT_TRUE(coefficients.coefficients);
    EXPECT_EQ(coefficients.coefficients->area, 0.25);
    const auto solver =
        read("# Solver information\n# Time U_solver Ux_initial p_iters\n1 smoothSolver 0.5 7\n2 smoothSolver 0.25 6\n");
    EXPECT_THAT(solver.columns, testing::ElementsAre("Time", "Ux_initial", "p_iters"));
    const auto mean = read("# Region type : patch inlet\n# Time areaAverage(U)\n1 (1 2 3)\n");
    EXPECT_THAT(mean.columns, testing::ElementsAre("Time", "areaAverage(U)_x", "areaAverage(U)_y", "areaAverage(U)_z"));
    core::write_file(folder.path() / "table.dat", "# Time Cd\n1 2\n2 3 4\n");
    EXPECT_THAT([&] { read_monitor(folder.path() / "table.dat"); },
                testing::ThrowsMessage<core::InputError>(
                    HasSubstr("table.dat:3: a row of 3 entries where there are 2 columns")));
}

TEST(Monitors, StepsThatAreNoWholeNumbersAreTimes) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.out", "0.001 5\n0.002 6\n0.003 7\n");
    EXPECT_EQ(read_monitor(folder.path() / "lift.out").columns.front(), "Time");
    core::write_file(folder.path() / "lift.out", "1 5\n2 6\n3 7\n");
    EXPECT_EQ(read_monitor(folder.path() / "lift.out").columns.front(), "Iteration");
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

TEST(Monitors, ATranscriptGoesOnWithTheEquationsThatJoin) {
    const core::TemporaryFolder folder;
    const auto residuals = read_monitor(written(folder,
                                                "  iter  continuity  x-velocity     time/iter\n"
                                                "     1  1.0000e+00  1.5543e-03  0:01:02   99\n"
                                                "     2  5.0000e-01  1.0e-03     0:01:01   98\n"
                                                "!    2 solution is converged\n"
                                                "     2  5.0000e-01  1.0e-03     0:01:01   98\n"
                                                "> /define/models/energy yes no no no yes\n"
                                                "  iter  continuity  energy  x-velocity     time/iter\n"
                                                "     3  4.0000e-01  1e-6    2.0e-03     0:01:01   98\n"));
    EXPECT_THAT(residuals.columns, ElementsAre("iter", "continuity", "x-velocity", "energy"));
    EXPECT_THAT(residuals.values[0], ElementsAre(1, 2, 3));
    EXPECT_THAT(*residuals.find("x-velocity"), ElementsAre(1.5543e-3, 1e-3, 2e-3));
    EXPECT_THAT(*residuals.find("energy"), ElementsAre(testing::IsNan(), testing::IsNan(), 1e-6));
    ASSERT_EQ(residuals.problems.size(), 1U);
    EXPECT_THAT(residuals.problems[0].message, HasSubstr("1 row repeats"));
}

TEST(ForceReports, ATranscriptWithSeveralReportsGivesThemAll) {
    const core::TemporaryFolder folder;
    const auto reports = read_force_reports(written(
        folder,
        "\xEF\xBB\xBF  iter  continuity  x-velocity\r\n  10 1e-3 2e-4\r\n\r\nForces\r\n      Forces [N]     "
        "Coefficients\r\n"
        "Zone Pressure Viscous Total Pressure Viscous Total\r\n"
        "hull (1 2 3) (0.1 0.2 0.3) (1.1 2.2 3.3) (4 5 6) (7 8 9) (10 11 12)\r\n----- -----\r\n"
        "Net (1 2 3) (0.1 0.2 0.3) (1.1 2.2 3.3) (4 5 6) (7 8 9) (10 11 12)\r\n\r\n"
        "Forces - Direction Vector (0 0 -1)\r\n   Forces [lbf]   Coefficients\r\nZone Pressure Viscous Total Pressure "
        "Viscous Total\r\n"
        "hull 1 0.5 1.5 1 2 3\r\nbase:012 2 0.5 2.5 1 2 3\r\n-----\r\nNet 3 1 4 2 4 6\r\n"
        "Moments - Moment Center (-1.5 0 0.25) Moment Axis (0 1 0)\r\n   Moments (n-m)  Coefficients\r\n"
        "Zone Pressure Viscous Total Pressure Viscous Total\r\nhull -1 -2 -3 0 0 0\r\n-----\r\nNet -1 -2 -3 0 0 0\r\n"
        "reversed flow in 3 faces on pressure-outlet 8.\r\n"));
    ASSERT_EQ(reports.size(), 5U);
    EXPECT_EQ(reports[1].direction[1], 1);
    EXPECT_EQ(reports[3].direction[2], -1);
    ASSERT_EQ(reports[3].rows.size(), 3U);
    EXPECT_EQ(reports[3].rows[1].zone, "base:012");
    EXPECT_NEAR(reports[3].net()->total, 4 * 4.4482216, 1e-5);
    EXPECT_EQ(reports[3].net()->total_coefficient, 6);
    EXPECT_TRUE(reports[4].moments);
    EXPECT_EQ(reports[4].centre[0], -1.5);
    EXPECT_EQ(reports[4].direction[1], 1);
    EXPECT_EQ(reports[4].net()->viscous, -2);
}

TEST(ForceReports, TheLayoutOfFluent6IsRead) {
    const core::TemporaryFolder folder;
    const auto reports = read_force_reports(written(
        folder,
        "Force vector: (1 0 0)\n                pressure   viscous     total    pressure     viscous       total\n"
        "zone name          force     force     force coefficient coefficient coefficient\n"
        "                       n         n         n\n--------- ------ -----\n"
        "cylinder 1.5 0.5 2 3 1 4\n--------- ------ -----\nnet 1.5 0.5 2 3 1 4\n"));
    ASSERT_EQ(reports.size(), 1U);
    ASSERT_NE(reports[0].net(), nullptr);
    EXPECT_EQ(reports[0].net()->total, 2);
    EXPECT_EQ(reports[0].rows[0].zone, "cylinder");
    const auto pounds = read_force_reports(written(
        folder,
        "Force vector: (1 0 0)\n                pressure   viscous     total    pressure     viscous       total\n"
        "zone name          force     force     force coefficient coefficient coefficient\n"
        "                     lbf       lbf       lbf\n--------- ------ -----\n"
        "net-cage 1.5 0.5 2 3 1 4\n--------- ------ -----\nnet 1.5 0.5 2 3 1 4\n"));
    EXPECT_NEAR(pounds.at(0).net()->total, 2 * 4.4482216152605, 1e-9);
    EXPECT_EQ(pounds[0].rows[0].zone, "net-cage");
}

TEST(ForceReports, ATextThatEndsWithinAReportIsRefused) {
    const core::TemporaryFolder folder;
    try {
        read_force_reports(written(folder, "Forces - Direction Vector (1 0 0)\nForces (n)\nhull 1 2 3 4 5 6\n"));
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("net row is missing"));
    }
}

TEST(ForceReports, ALineOfBracketsAloneEndsNothing) {
    const core::TemporaryFolder folder;
    const auto reports = read_force_reports(
        written(folder, "Forces - Direction Vector (1 0 0)\nForces (n)\nhull 1 2 3 4 5 6\n)\nnet 1 2 3 4 5 6\n"));
    ASSERT_EQ(reports.size(), 1U);
    EXPECT_EQ(reports[0].rows.back().zone, "Net");
    EXPECT_EQ(reports[0].rows.back().total, 3);
}

namespace {

std::string cfx_output() { return core::read_file(test::data_folder() / "reports" / "cfx_001.out"); }

std::string changed(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

std::string reason_against(const std::filesystem::path& path) {
    try {
        read_force_reports(path);
    } catch (const core::InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST(OutputOfCfx, GivesTheResidualsOfEveryIterationThroughNoticesBetweenAndWithin) {
    const core::TemporaryFolder folder;
    const auto residuals = read_monitor(written(folder, cfx_output()));
    EXPECT_THAT(residuals.columns,
                ElementsAre("Iteration", "U-Mom", "U-Mom max", "P-Mass", "P-Mass max", "K-TurbKE", "K-TurbKE max"));
    EXPECT_THAT(residuals.values[0], ElementsAre(1, 2));
    EXPECT_THAT(*residuals.find("K-TurbKE"), ElementsAre(0.11, 0.033));
    EXPECT_THAT(*residuals.find("U-Mom max"), ElementsAre(0.3, 0.14));
    EXPECT_TRUE(residuals.problems.empty());
}

TEST(OutputOfCfx, CountsTimeStepsByTheirLastLoopAndTellsDivergence) {
    const core::TemporaryFolder folder;
    const auto table = [](const std::string& rms) {
        return " |       Equation       | Rate | RMS Res | Max Res |  Linear Solution |\n +------+------+\n | U-Mom    "
               "            | 0.00 | " +
               rms + " | 3.0E-01 |       8.2E-03  OK|\n +------+------+\n";
    };
    const std::string loop = " COEFFICIENT LOOP ITERATION =  1             CPU SECONDS = 1.0E+00\n";
    const auto residuals = read_monitor(
        written(folder, " TIME STEP =  1 SIMULATION TIME = 1.0E-02 CPU SECONDS = 1\n" + loop + table("2.0E-02") + loop +
                            table("1.0E-03") + " TIME STEP =  2 SIMULATION TIME = 2.0E-02 CPU SECONDS = 2\n" + loop +
                            table("NaN")));
    EXPECT_THAT(residuals.values[0], ElementsAre(1, 2));
    EXPECT_EQ(residuals.columns[0], "Time Step");
    EXPECT_EQ(residuals.find("U-Mom")->at(0), 1e-3);
    ASSERT_EQ(residuals.problems.size(), 1U);
    EXPECT_THAT(residuals.problems[0].message, HasSubstr("diverged"));
}

TEST(OutputOfCfx, GivesTheForcesAndMomentsOnEachWall) {
    const core::TemporaryFolder folder;
    const auto reports = read_force_reports(written(folder, cfx_output()));
    ASSERT_EQ(reports.size(), 6U);
    const auto& lift = reports[2];
    EXPECT_EQ(lift.direction[2], 1);
    ASSERT_EQ(lift.rows.size(), 3U);
    EXPECT_EQ(lift.rows[0].zone, "hull");
    EXPECT_NEAR(lift.net()->pressure, 0.27, 1e-12);
    EXPECT_NEAR(lift.net()->total, 0.2712, 1e-12);
    const auto& pitch = reports[4];
    EXPECT_TRUE(pitch.moments);
    EXPECT_EQ(pitch.direction[1], 1);
    EXPECT_NEAR(pitch.net()->total, 0.0102, 1e-12);
    // In the units of the run.
    const auto in_feet =
        read_force_reports(written(folder, changed(changed(cfx_output(), "Length Units = [m]", "Length Units = [ft]"),
                                                   "Mass Units = [kg]", "Mass Units = [lb]")));
    EXPECT_NEAR(in_feet[2].net()->pressure, 0.27 * 0.45359237 * 0.3048, 1e-12);
    EXPECT_NEAR(in_feet[4].net()->pressure, 0.009 * 0.45359237 * 0.3048 * 0.3048, 1e-14);
}

TEST(OutputOfCfx, KeepsWallsOfOneNameInTwoDomainGroupsApart) {
    const core::TemporaryFolder folder;
    const auto table = [](const std::string& title) {
        return " |  " + title +
               " On Walls  |\n        X-Comp.  Y-Comp.  Z-Comp.\n\n Domain Group: R1\n\n Blade  1 2 3\n Hub Default  4 "
               "5 6\n       -----  -----  -----\n"
               " Domain Group Totals :  5 7 9\n\n Domain Group: S1\n\n Blade  10 20 30\n       -----  -----  -----\n "
               "Domain Group Totals :  10 20 30\n\n";
    };
    const auto reports = read_force_reports(written(folder, " OUTER LOOP ITERATION =    1    CPU SECONDS = 1.2E+00\n" +
                                                                table("Pressure Force") + table("Viscous Force")));
    ASSERT_EQ(reports.size(), 3U);
    ASSERT_EQ(reports[0].rows.size(), 4U);
    EXPECT_EQ(reports[0].rows[0].zone, "R1: Blade");
    EXPECT_EQ(reports[0].rows[0].total, 2);
    EXPECT_EQ(reports[0].rows[1].zone, "Hub Default");
    EXPECT_EQ(reports[0].rows[2].zone, "S1: Blade");
    EXPECT_EQ(reports[0].rows[2].total, 20);
    EXPECT_EQ(reports[0].net()->total, 30);
}

TEST(OutputOfCfx, ThatLostLinesIsRefused) {
    const core::TemporaryFolder folder;
    const std::string base = " base                          2.0000E-03    0.0000E+00   -8.6000E-01\n";
    EXPECT_THAT(reason_against(written(folder, changed(cfx_output(), base, ""))),
                HasSubstr("lines are missing or damaged"));
    EXPECT_THAT(reason_against(written(folder, changed(cfx_output(), "-8.6000E-01", " 8.6000E-01"))),
                HasSubstr("add up to"));
    EXPECT_THAT(reason_against(written(folder, cfx_output().substr(0, cfx_output().find("Viscous Force")))),
                HasSubstr("incomplete: 2 walls with a pressure part, 0 with a viscous one"));
    EXPECT_THAT(reason_against(written(folder, changed(cfx_output(), " hull                         -3.0000E-02",
                                                       " keel                         -3.0000E-02"))),
                HasSubstr("wall 'hull' has no viscous part"));
}

TEST(Monitors, EveryHeadOfFluentIsUnderstood) {
    const core::TemporaryFolder folder;
    const auto transient = read_monitor(written(folder,
                                                "\"lift-rfile\"\r\n\"Time Step\" \"lift etc..\"\r\n(\"Time Step\" "
                                                "\"lift\" \"flow-time\")\r\n1 0.5 0.01\r\n2 0.6 0.02\r\n"));
    EXPECT_THAT(transient.columns, ElementsAre("Time Step", "lift", "flow-time"));
    EXPECT_TRUE(transient.problems.empty());
    const auto old =
        read_monitor(written(folder, "\"Convergence history of Lift\"\n\"Iterations\"\"cl-1\"\n1\t0.5\n2\t0.6\n"));
    EXPECT_THAT(old.columns, ElementsAre("Iterations", "cl-1"));
    const auto bare = read_monitor(written(folder, "1\t0.5\n2\t0.6"));
    EXPECT_THAT(bare.values[1], ElementsAre(0.5, 0.6));
    ASSERT_EQ(bare.problems.size(), 1U);
    EXPECT_THAT(bare.problems[0].message, HasSubstr("cut short"));
}

TEST(Reports, TextsCutAnywhereAreReadOrRefused) {
    const core::TemporaryFolder folder;
    const std::string plot = "(title \"P\")\n(labels \"x\" \"y\")\n\n((xy/key/label \"wall\")\n0\t1.5\n1\t2.5\n)\n";
    for (std::size_t size = 0; size < plot.size() - 2; ++size) {
        EXPECT_THROW(read_plot(written(folder, plot.substr(0, size))), core::InputError) << size;
    }
    const std::string monitor = "\"l\"\n(\"Iteration\" \"lift\" \"drag\")\n1 0.5 1\n2 0.6 2\n";
    for (std::size_t size = 0; size < monitor.size(); ++size) {
        try {
            const auto table = read_monitor(written(folder, monitor.substr(0, size)));
            EXPECT_TRUE(monitor[size - 1] == '\n' || !table.problems.empty()) << size;
        } catch (const core::InputError&) {
            SUCCEED();
        }
    }
}

}  // namespace underbody
