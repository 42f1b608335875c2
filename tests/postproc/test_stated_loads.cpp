// Loads against what a solver states of itself: force reports, monitors, OpenFOAM's forces.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "postproc/loads/loads_table.h"
#include "postproc/loads/mesh_study.h"
#include "postproc/loads/settled.h"
#include "postproc/loads/stated_loads.h"
#include "tests/support/support.h"

namespace underbody::postproc {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A box of 2 x 1 x 0.5 m with p = 1 + z and a shear of (0.1, 0, 0) Pa on its base: base (0.2, 0, 2) N, hull (0, 0, -3)
/// N. The half of it with y > 0 when asked for.
std::string box(bool half) {
    const std::string y0 = half ? "0.5" : "0";
    const std::string head =
        "[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa ], Wall Shear X [ Pa ], Wall Shear Y [ Pa ], Wall Shear Z [ "
        "Pa ]\n";
    const auto node = [&](const char* x, const std::string& y, const char* z, const char* p, const char* shear) {
        return std::string(x) + "," + y + "," + z + "," + p + "," + shear + ",0,0\n";
    };
    std::string bottom;
    std::string all;
    for (const auto& [z, p] : {std::pair{"0", "1"}, {"0.5", "1.5"}}) {
        for (const auto& [x, y] : {std::pair{"0", y0}, {"2", y0}, {"2", std::string("1")}, {"0", std::string("1")}}) {
            all += node(x, y, z, p, "0");
            bottom += *z == '0' && z[1] == 0 ? node(x, y, z, p, "0.1") : "";
        }
    }
    return "[Name]\nbase\n\n" + head + bottom + "\n[Faces]\n0,3,2,1\n\n[Name]\nhull\n\n" + head + all + "\n[Faces]\n" +
           (half ? "" : "0,1,5,4\n") + "1,2,6,5\n2,3,7,6\n3,0,4,7\n4,5,6,7\n";
}

class StatedLoads : public testing::Test {
protected:
    LoadsResult loads_of(bool half = false) {
        core::write_file(folder_.path() / "box.csv", box(half));
        LoadsOptions options;
        if (half) {
            options.symmetry = "y=0.5";
        }
        return loads(read_field(folder_.path() / "box.csv"), options);
    }
    fs::path written(const std::string& name, const std::string& text) {
        core::write_file(folder_.path() / name, text);
        return folder_.path() / name;
    }
    core::TemporaryFolder folder_;
};

const std::string report =
    "Forces - Direction Vector (0 0 1)\n"
    "                 Forces (n)                                  Coefficients\n"
    "Zone             Pressure         Viscous          Total            Pressure         Viscous          Total\n"
    "base             2                0                2                3.2              0                3.2\n"
    "hull             -3               0                -3               -4.8             0                -4.8\n"
    "---------------- ---------------- ---------------- ---------------- ---------------- ---------------- "
    "----------------\n"
    "Net              -1               0                -1               -1.6             0                -1.6\n\n"
    "Forces - Direction Vector (-2 0 0)\n"
    "Zone             Pressure         Viscous          Total            Pressure         Viscous          Total\n"
    "base             0                -0.2             -0.2             0                0                0\n"
    "hull             0                0                0                0                0                0\n"
    "---------------- ---------------- ---------------- ---------------- ---------------- ---------------- "
    "----------------\n"
    "Net              0                -0.2             -0.2             0                0                0\n\n"
    "Moments - Moment Center (0 0 0) Moment Axis (0 1 0)\n"
    "Zone             Pressure         Viscous          Total            Pressure         Viscous          Total\n"
    "base             -2               0                -2               0                0                0\n"
    "hull             3                0                3                0                0                0\n"
    "---------------- ---------------- ---------------- ---------------- ---------------- ---------------- "
    "----------------\n"
    "Net              1                0                1                0                0                0\n";

TEST_F(StatedLoads, OfAForceReportAreComparedRowByRow) {
    const LoadsResult result = loads_of();
    const auto stated = stated_in_report(written("forces.txt", report));
    ASSERT_EQ(stated.size(), 27U);
    core::Problems notes;
    const auto comparisons = compare_with_solver(result, stated, notes);
    EXPECT_TRUE(notes.empty());
    ASSERT_EQ(comparisons.size(), 27U);
    for (const auto& one : comparisons) {
        EXPECT_NEAR(one.value, one.stated, 1e-12) << one.quantity;
        EXPECT_LT(one.of_force, 1e-12);
    }
    EXPECT_EQ(comparisons[0].quantity, "lift_force on 'base'");
    EXPECT_EQ(comparisons[6].quantity, "lift_force");
    EXPECT_EQ(comparisons[15].quantity, "drag_force");
    EXPECT_EQ(comparisons[16].quantity, "pressure part of drag_force");
    EXPECT_THAT(comparisons[24].quantity, HasSubstr("moment about (0, 1, 0) at (0, 0, 0) m"));
}

TEST_F(StatedLoads, ThatDifferAreSeenWithTheirShareOfTheForce) {
    const LoadsResult result = loads_of();
    std::string off = report;
    off.replace(off.find("Net              -1 "), 20, "Net              -1.1");
    core::Problems notes;
    const auto comparisons = compare_with_solver(result, stated_in_report(written("forces.txt", off)), notes);
    const auto net = std::find_if(comparisons.begin(), comparisons.end(),
                                  [](const Comparison& c) { return c.quantity == "pressure part of lift_force"; });
    ASSERT_NE(net, comparisons.end());
    EXPECT_NEAR(net->of_force, 0.1 / std::hypot(1, 0.2), 1e-12);
}

TEST_F(StatedLoads, AreFarFromAForceOfNothing) {
    LoadsResult nothing = loads_of();
    nothing.total = nothing.pressure = nothing.viscous = {};
    nothing.named = {};
    for (auto& zone : nothing.zones) {
        zone.pressure = zone.viscous = {};
    }
    core::Problems notes;
    const auto comparisons = compare_with_solver(nothing, stated_in_report(written("forces.txt", report)), notes);
    const auto of = [&](const std::string& quantity) {
        return std::find_if(comparisons.begin(), comparisons.end(),
                            [&](const Comparison& c) { return c.quantity == quantity; })
            ->of_force;
    };
    EXPECT_EQ(of("lift_force"), 1);
    EXPECT_EQ(of("drag_force"), 0.2);  // of the report's force, the lift of 1 N
    EXPECT_NEAR(of("moment about (0, 1, 0) at (0, 0, 0) m"), 1 / nothing.length, 1e-12);
    // A report of moments alone: then over the moment itself.
    const std::string moments = report.substr(report.find("Moments"));
    EXPECT_EQ(compare_with_solver(nothing, stated_in_report(written("moments.txt", moments)), notes)[6].of_force, 1);
    // A manifest that states a force, and one that states none where there is one.
    LoadsCase one;
    one.loads = nothing;
    one.numbers = {{"lift_force", -1}};
    EXPECT_EQ(compare_with_stated({one}, notes)[0].of_force, 1);
    one.loads = loads_of();
    one.numbers = {{"lift_force", 0}, {"drag_force", 0}, {"side_force", 0}};
    EXPECT_NEAR(compare_with_stated({one}, notes)[0].of_force, 1 / std::hypot(1, 0.2), 1e-12);
}

TEST_F(StatedLoads, OfZonesThatWereNotIntegratedAreLeftOutAloud) {
    const LoadsResult result = loads_of();
    std::string other = report;
    for (auto at = other.find("hull"); at != std::string::npos; at = other.find("hull")) {
        other.replace(at, 4, "keel");
    }
    core::Problems notes;
    const auto comparisons = compare_with_solver(result, stated_in_report(written("forces.txt", other)), notes);
    EXPECT_EQ(comparisons.size(), 9U);  // those of the base
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_THAT(notes[0].message, HasSubstr("'keel'"));
}

TEST_F(StatedLoads, OfAHalfModelAreDoubledAndWhatBothHalvesCancelIsLeftOut) {
    const LoadsResult result = loads_of(true);
    EXPECT_NEAR(result.named.lift_force, -1, 1e-12);
    const std::string half =
        "Forces\nZone Pressure Viscous Total Pressure Viscous Total\n"
        "base (0 0 1) (0.1 0 0) (0.1 0 1) (0 0 0) (0 0 0) (0 0 0)\n"
        "hull (0 0.7 -1.5) (0 0 0) (0 0.7 -1.5) (0 0 0) (0 0 0) (0 0 0)\n"
        "Net (0 0.7 -0.5) (0.1 0 0) (0.1 0.7 -0.5) (0 0 0) (0 0 0) (0 0 0)\n";
    core::Problems notes;
    const auto comparisons = compare_with_solver(result, stated_in_report(written("forces.txt", half)), notes);
    EXPECT_EQ(comparisons.size(), 18U);  // x and z
    for (const auto& one : comparisons) {
        EXPECT_NEAR(one.value, one.stated, 1e-12) << one.quantity;
    }
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_THAT(notes[0].message, HasSubstr("9 that both halves cancel"));
}

TEST_F(StatedLoads, OfATranscriptAreThoseOfItsLastReports) {
    const LoadsResult result = loads_of();
    std::string early = report;
    for (auto at = early.find("-1 "); at != std::string::npos; at = early.find("-1 ")) {
        early.replace(at, 3, "-9 ");
    }
    const auto stated = stated_in_report(written("run.trn", early + "\n" + early + "\n" + report));
    ASSERT_EQ(stated.size(), 27U);
    core::Problems notes;
    for (const auto& one : compare_with_solver(result, stated, notes)) {
        EXPECT_NEAR(one.value, one.stated, 1e-12) << one.quantity;
    }
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_THAT(notes[0].message, HasSubstr("3 reports of the force along (0, 0, 1)"));
    // Reports of other zones along the same direction stand beside each other.
    const std::string head =
        "Forces - Direction Vector (0 0 1)\nZone             Pressure         Viscous          Total            "
        "Pressure         Viscous          Total\n";
    EXPECT_EQ(stated_in_report(written("two.txt", head + "base 2 0 2 0 0 0\nNet 2 0 2 0 0 0\n\n" + head +
                                                      "hull -3 0 -3 0 0 0\nNet -3 0 -3 0 0 0\n"))
                  .size(),
              6U);
}

TEST_F(StatedLoads, LieBesideAFileUnderItsName) {
    const LoadsResult result = loads_of();
    EXPECT_TRUE(stated_beside(folder_.path() / "box.csv", result).empty());
    written("box-forces.txt", report);
    written("boxes.txt", report);              // another case
    written("box-notes.txt", "nothing here");  // no report
    EXPECT_EQ(stated_beside(folder_.path() / "box.csv", result).size(), 27U);
}

TEST_F(StatedLoads, AreOfTheFileWithTheLongestNameThatFits) {
    const LoadsResult result = loads_of();
    written("box-coarse.csv", box(false));
    written("box-coarse.txt", report);
    EXPECT_TRUE(stated_beside(folder_.path() / "box.csv", result).empty());
    EXPECT_EQ(stated_beside(folder_.path() / "box-coarse.csv", result).size(), 27U);
    written("box-forces.csv", "gap [mm], file\n5, box.csv\n");  // a table is no CFD file
    written("box-forces.txt", report);
    EXPECT_EQ(stated_beside(folder_.path() / "box.csv", result).size(), 27U);
}

/// The same of CFX's solver: a summary of the walls at the end of its output.
std::string cfx_summary() {
    const auto table = [](const char* title, const char* base, const char* hull, const char* total) {
        return std::string(" +----------+\n |  ") + title +
               " On Walls  |\n +----------+\n        X-Comp.  Y-Comp.  Z-Comp.\n\n Domain Group: water\n\n base  " +
               base + "\n hull  " + hull + "\n       -----  -----  -----\n Domain Group Totals :  " + total + "\n\n";
    };
    return " OUTER LOOP ITERATION =    1    CPU SECONDS = 1.2E+00\n" +
           table("Pressure Force", "0 0 2.0E+00", "0 0 -3.0E+00", "0 0 -1.0E+00") +
           table("Viscous Force", "2.0E-01 0 0", "0 0 0", "2.0E-01 0 0") +
           table("Pressure Moment", "1.0E+00 -2.0E+00 0", "-1.5E+00 3.0E+00 0", "-5.0E-01 1.0E+00 0") +
           table("Viscous Moment", "0 0 -1.0E-01", "0 0 0", "0 0 -1.0E-01");
}

TEST_F(StatedLoads, OfCfxAreFoundBesideItsExportAndAgree) {
    const LoadsResult result = loads_of();
    written("box_001.out", cfx_summary());
    const auto stated = stated_beside(folder_.path() / "box.csv", result);
    ASSERT_EQ(stated.size(), 54U);  // three axes of forces and moments, two walls and their sum, three parts
    core::Problems notes;
    const auto comparisons = compare_with_solver(result, stated, notes);
    EXPECT_TRUE(notes.empty());
    ASSERT_EQ(comparisons.size(), 54U);
    for (const auto& one : comparisons) {
        EXPECT_NEAR(one.value, one.stated, 1e-12) << one.quantity;
    }
}

// ---- monitors ----

std::string monitor(double mean, double scatter, std::uint64_t seed = 3) {
    core::Random random(seed);
    std::string text = "\"lift-rfile\"\n\"Iteration\" \"lift etc..\"\n(\"Iteration\" \"lift\" \"drag\")\n";
    for (int i = 1; i <= 600; ++i) {
        const double approach = 3 * std::exp(-i / 25.0);
        text += std::to_string(i) + " " + core::format_number(mean + approach + scatter * random.normal()) + " " +
                core::format_number(0.2 + approach) + "\n";
    }
    return text;
}

TEST_F(StatedLoads, OfAMonitorGiveTheirLastValueAndTheScatterOfTheirTail) {
    const LoadsResult result = loads_of();
    const auto path = written("report.out", monitor(-1, 0.01));
    MonitorSource source = monitor_source("lift_force=" + path.string() + ":lift");
    EXPECT_EQ(source.column, "lift");
    const StatedLoad lift = stated_by_monitor(source, result);
    ASSERT_TRUE(lift.history);
    EXPECT_NEAR(lift.history->standard_uncertainty, 0.01, 0.001);
    EXPECT_NEAR(lift.value, -1, 0.04);
    const auto sigmas = iteration_sigmas(result, {lift});
    ASSERT_EQ(sigmas.size(), 1U);
    EXPECT_EQ(sigmas[0].first, "lift_force");
    core::Problems notes;
    EXPECT_LT(compare_with_solver(result, {lift}, notes)[0].of_force, 0.04);
    // A coefficient with its scale as the unit.
    source = monitor_source("lift_force [2.5 N]=" + path.string() + ":lift");
    EXPECT_NEAR(stated_by_monitor(source, result).value, 2.5 * lift.value, 1e-12);
    // Of a half model both count twice.
    const LoadsResult half = loads_of(true);
    EXPECT_NEAR(iteration_sigmas(half, {lift})[0].second, 2 * sigmas[0].second, 1e-15);
}

TEST_F(StatedLoads, AreMeasuredByTheForceOnTheSameZonesAndTheLengthOfTheBodyEverywhere) {
    LoadsResult result = loads_of();
    EXPECT_EQ(result.length, 2);
    const double force = norm(result.total.force);
    LoadsCase one{"box.csv",
                  {{"pitch_moment", result.named.pitch_moment + 0.01 * force * 2},
                   {"lift_force", result.named.lift_force - 0.03 * force}},
                  {},
                  result,
                  {},
                  {}};
    core::Problems notes;
    const auto by_manifest = compare_with_stated({one}, notes);
    ASSERT_EQ(by_manifest.size(), 2U);
    EXPECT_NEAR(by_manifest[0].of_force, 0.03, 1e-12);
    EXPECT_NEAR(by_manifest[1].of_force, 0.01, 1e-12);
    StatedLoad moment;
    moment.quantity = "pitch_moment";
    moment.moment = true;
    moment.direction = result.starboard;
    moment.centre = result.reference;
    moment.value = result.named.pitch_moment + 0.01 * force * 2;
    EXPECT_NEAR(compare_with_solver(result, {moment}, notes)[0].of_force, 0.01, 1e-12);
    // A length that is given is the one that counts.
    LoadsOptions options;
    options.references.length = 4;
    EXPECT_NEAR(
        compare_with_solver(loads(read_field(folder_.path() / "box.csv"), options), {moment}, notes)[0].of_force, 0.005,
        1e-12);
}

TEST_F(StatedLoads, OfTheOtherSignOrOfHalfABodySaySo) {
    const LoadsResult result = loads_of();
    const auto hint = [&](double value) {
        StatedLoad lift;
        lift.quantity = "lift_force";
        lift.direction = result.up;
        lift.value = value;
        core::Problems notes;
        return compare_with_solver(result, {lift}, notes)[0].hint;
    };
    EXPECT_EQ(hint(-1), "");
    EXPECT_THAT(hint(1), HasSubstr("it has the other sign"));
    EXPECT_THAT(hint(0.98), HasSubstr("lift_force [-1 N]=FILE"));
    EXPECT_THAT(hint(-0.5), HasSubstr("twice of it would fit"));
    EXPECT_THAT(hint(-2), HasSubstr("half of it would fit"));
    EXPECT_EQ(hint(-0.8), "");
    EXPECT_EQ(hint(5), "");
}

TEST_F(StatedLoads, OfCoefficientsBecomeForcesByTheReferenceValuesOfTheSolver) {
    LoadsResult result = loads_of();
    // OpenFOAM's own table states all but the density: 1/2 1000 2^2 0.25 = 500 N. Its drag counts along -x here.
    const auto table = written("coefficient.dat",
                               "# Force coefficients\n# dragDir : (-1 0 0)\n# liftDir : (0 0 1)\n# pitchAxis : (0 1 "
                               "0)\n# magUInf : 2\n# lRef : 0.5\n# Aref : 0.25\n"
                               "# CofR : (0 0 0)\n# Time Cd Cl CmPitch\n1 0 0 0\n2 0 0 0\n3 0 0 0\n4 0 0 0\n5 0 0 0\n6 "
                               "0 0 0\n7 0 0 0\n8 -0.0004 -0.002 0.004\n");
    const auto of = [&](const std::string& what, const std::string& column) {
        return stated_by_monitor(monitor_source(what + "=" + table.string() + ":" + column), result);
    };
    EXPECT_THAT(
        [&] { of("lift_coefficient", "Cl"); },
        testing::ThrowsMessage<core::InputError>(HasSubstr("the reference density that they refer to is not given")));
    result.solver_references.density = 1000;
    EXPECT_NEAR(of("lift_coefficient", "Cl").value, -1, 1e-12);
    core::Problems notes;
    for (const auto& [what, column] :
         {std::pair{"lift_coefficient", "Cl"}, {"drag_coefficient", "Cd"}, {"pitch_moment_coefficient", "CmPitch"}}) {
        EXPECT_LT(compare_with_solver(result, {of(what, column)}, notes)[0].of_force, 1e-9) << what;
    }
    // Fluent's monitors state nothing, but its case does.
    const auto monitor = written("cl.out",
                                 "(\"Iteration\" \"cl\")\n1 -0.0004\n2 -0.0004\n3 -0.0004\n4 -0.0004\n5 -0.0004\n6 "
                                 "-0.0004\n7 -0.0004\n8 -0.0004\n");
    EXPECT_THAT([&] { stated_by_monitor(monitor_source("lift_coefficient=" + monitor.string()), result); },
                testing::ThrowsMessage<core::InputError>(
                    testing::AllOf(HasSubstr("the reference speed"), HasSubstr("lift_force [2.4 N]=FILE"))));
    result.solver_references = {1000, 1, 5, 1};
    EXPECT_NEAR(stated_by_monitor(monitor_source("lift_coefficient=" + monitor.string()), result).value, -1, 1e-12);
    EXPECT_THROW(monitor_source("lift_coefficient [N]=cl.out"), core::UsageError);
    EXPECT_THROW(monitor_source("lift_coeficient=cl.out"), core::UsageError);
}

TEST_F(StatedLoads, OfAMonitorAreThoseOfTheFieldsTime) {
    LoadsResult result = loads_of();
    std::string by_time = "\"lift\"\n\"Time Step\" \"lift etc..\"\n(\"Time Step\" \"lift\" \"flow-time\")\n";
    std::string by_iteration = "(\"Iteration\" \"lift\")\n";
    for (int i = 1; i <= 100; ++i) {
        by_time += std::to_string(i) + " " + std::to_string(-i) + " " + core::format_number(0.01 * i) + "\n";
        by_iteration += std::to_string(i) + " " + std::to_string(-i) + "\n";
    }
    const auto at = [&](const fs::path& path, std::optional<double> time) {
        result.time = time;
        return stated_by_monitor(monitor_source("lift_force=" + path.string()), result);
    };
    const auto steps = written("steps.out", by_time);
    const StatedLoad half = at(steps, 0.5);
    EXPECT_EQ(half.value, -50);
    EXPECT_EQ(half.time, 0.5);
    EXPECT_EQ(half.later, 50U);
    ASSERT_TRUE(half.history);
    EXPECT_EQ(half.history->first + half.history->count, 50U);
    core::Problems notes;
    EXPECT_EQ(compare_with_solver(result, {half}, notes)[0].stated, -50);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_THAT(notes[0].message, HasSubstr("the field is of 0.5: 50 later rows"));
    EXPECT_EQ(at(steps, {}).value, -100);
    EXPECT_FALSE(at(steps, 0.03).history);  // three rows tell no scatter
    EXPECT_EQ(at(steps, 0.03).value, -3);
    const StatedLoad beyond = at(steps, 2.0);
    notes.clear();
    compare_with_solver(result, {beyond}, notes);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_THAT(notes[0].message, HasSubstr("no row of the field's time 2"));
    // Iterations: those of a steady field. Seconds are none.
    const auto iterations = written("iterations.out", by_iteration);
    EXPECT_EQ(at(iterations, 40.0).value, -40);
    EXPECT_EQ(at(iterations, 40.5).value, -100);
    EXPECT_EQ(at(iterations, 2.0).value, -100);
    EXPECT_FALSE(at(iterations, 2.0).time);
}

TEST_F(StatedLoads, ThatDriftAreWarnedOfUnlessTheyAreRounding) {
    const LoadsResult result = loads_of();
    const auto drifting = [&](double size) {
        std::string text = "(\"Iteration\" \"side\")\n";
        for (int i = 1; i <= 100; ++i) {
            text += std::to_string(i) + " " + core::format_number(size * i) + "\n";
        }
        return stated_by_monitor(monitor_source("side_force=" + written("side.out", text).string()), result);
    };
    core::Problems notes;
    const fs::path nowhere = "/nowhere/case.csv";
    const Settled judged = settled_by(result, {drifting(1e-3)}, nowhere, notes);
    EXPECT_EQ(judged.verdict, SettledVerdict::not_settled);
    EXPECT_THAT(judged.why, HasSubstr("side_force drifts by"));
    EXPECT_THAT(judged.loads.at(0).file, HasSubstr("side.out"));
    ASSERT_FALSE(drifting(1e-16).history->settled);
    EXPECT_EQ(settled_by(result, {drifting(1e-16)}, nowhere, notes).verdict, SettledVerdict::settled);
    // Of a body without a force there is nothing that it could be small beside, but what the solver states.
    LoadsResult nothing = result;
    nothing.total = {};
    nothing.named = {};
    EXPECT_EQ(settled_by(nothing, {drifting(1e-16)}, nowhere, notes).verdict, SettledVerdict::not_settled);
    EXPECT_TRUE(notes.empty());
}

TEST_F(StatedLoads, OfAMonitorAreRefusedWhenTheyAreNotClear) {
    const LoadsResult result = loads_of();
    const auto path = written("report.out", monitor(-1, 0.01));
    const auto message = [](auto&& act) {
        try {
            act();
        } catch (const core::Error& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    EXPECT_THAT(message([&] { stated_by_monitor(monitor_source("lift_force=" + path.string()), result); }),
                HasSubstr("several columns"));
    EXPECT_THAT(message([&] { stated_by_monitor(monitor_source("lift_force=" + path.string() + ":lft"), result); }),
                HasSubstr("did you mean 'lift'?"));
    const auto none = written("none.out", "\"Iteration\"\n1\n2\n");
    EXPECT_THAT(message([&] { stated_by_monitor(monitor_source("lift_force=" + none.string()), result); }),
                HasSubstr("no column of values, only 'Iteration'"));
    EXPECT_THAT(message([] { monitor_source("lift_froce=a.out"); }), HasSubstr("did you mean 'lift_force'?"));
    EXPECT_THAT(message([] { monitor_source("lift_force [m]=a.out"); }), HasSubstr("no unit of lift_force"));
    EXPECT_THAT(message([] { monitor_source("a.out"); }), HasSubstr("no QUANTITY=FILE"));
    const auto brief = written("short.out", "(\"Iteration\" \"lift\")\n1 2\n2 2\n");
    EXPECT_THAT(message([&] { stated_by_monitor(monitor_source("lift_force=" + brief.string()), result); }),
                HasSubstr("too short"));
}

// ---- OpenFOAM ----

/// Force and moment files of a case whose forces settle on those of the box, moments about the origin.
void write_openfoam(const fs::path& folder, int from, int to, double error) {
    std::string force =
        "# Force\n# CofR       : (0 0 0)\n#\n# Time        \t(total_x total_y total_z)\t(pressure_x pressure_y "
        "pressure_z)\t(viscous_x viscous_y viscous_z)\n";
    std::string moment =
        "# Moment\n# CofR       : (0 0 0)\n#\n# Time        \t(total_x total_y total_z)\t(pressure_x pressure_y "
        "pressure_z)\t(viscous_x viscous_y viscous_z)\n";
    for (int i = from; i <= to; ++i) {
        const double z = -1 + error * (i % 2 == 0 ? 1 : -1);
        const std::string time = std::to_string(i) + "\t";
        const auto triple = [](double x, double y, double w) {
            return "(" + core::format_number(x) + " " + core::format_number(y) + " " + core::format_number(w) + ")";
        };
        force += time + triple(0.2, 0, z) + "\t" + triple(0, 0, z) + "\t" + triple(0.2, 0, 0) + "\n";
        // r x F with the pressure at (1, 0.5, 0) and the shear at (1, 0.5, 0): (0.5 z, -z, 0) and (0, 0, -0.1)
        moment += time + triple(0.5 * z, -z, -0.1) + "\t" + triple(0.5 * z, -z, 0) + "\t" + triple(0, 0, -0.1) + "\n";
    }
    core::write_file(folder / "postProcessing" / "forces" / std::to_string(from - 1) / "force.dat", force);
    core::write_file(folder / "postProcessing" / "forces" / std::to_string(from - 1) / "moment.dat", moment);
}

TEST_F(StatedLoads, OfOpenFoamCarryOverRestartsAndMoveToTheReferencePoint) {
    const LoadsResult result = loads_of();
    write_openfoam(folder_.path(), 1, 100, 0.5);
    write_openfoam(folder_.path(), 51, 150, 0.001);
    core::write_file(folder_.path() / "system" / "controlDict",
                     "functions { other { type x; } forces { type forces; // patches (keel);\n patches (base "
                     "\"hul.*\"); rho rhoInf; rhoInf 998; } }\n");
    const auto stated = stated_by_openfoam(folder_.path(), result);
    ASSERT_EQ(stated.size(), 18U);
    EXPECT_THAT(stated[0].zones, testing::ElementsAre("base", "hull"));
    core::Problems notes;
    const auto comparisons = compare_with_solver(result, stated, notes);
    ASSERT_EQ(comparisons.size(), 18U);
    for (const auto& one : comparisons) {
        EXPECT_NEAR(one.value, one.stated, 0.0011) << one.quantity;
    }
    EXPECT_EQ(comparisons[0].quantity, "lift_force");
    EXPECT_NEAR(comparisons[0].stated, -0.999, 1e-12);  // the last row of the restart
    ASSERT_TRUE(stated[0].history);
    EXPECT_NEAR(stated[0].history->deviation, 0.001, 1e-4);
    const auto sigmas = iteration_sigmas(result, stated);
    EXPECT_EQ(sigmas.size(), 6U);
}

TEST_F(StatedLoads, OfOpenFoamAreThoseOfTheFieldsTime) {
    LoadsResult result = loads_of();
    EXPECT_FALSE(result.time);
    write_openfoam(folder_.path(), 1, 100, 0.5);
    core::write_file(folder_.path() / "system" / "controlDict",
                     "functions { forces { type forces; patches (base hull); } }\n");
    const auto compared = [&](double time, core::Problems& notes) {
        result.time = time;
        return compare_with_solver(result, stated_by_openfoam(folder_.path(), result), notes)[0].stated;
    };
    core::Problems notes;
    EXPECT_NEAR(compared(20, notes), -0.5, 1e-12);
    EXPECT_NEAR(compared(21, notes), -1.5, 1e-12);
    EXPECT_TRUE(notes.empty());
    EXPECT_EQ(stated_by_openfoam(folder_.path(), result)[0].history->count +
                  stated_by_openfoam(folder_.path(), result)[0].history->first,
              21U);
    EXPECT_NEAR(compared(22.2, notes), -0.5, 1e-12);  // no such row: the nearest, and said once
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_THAT(notes[0].message, HasSubstr("time 22.2"));
    EXPECT_THAT(notes[0].message, HasSubstr("row of 22"));
    // Nothing near: not compared.
    result.time = 200;
    notes.clear();
    EXPECT_TRUE(compare_with_solver(result, stated_by_openfoam(folder_.path(), result), notes).empty());
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_THAT(notes[0].message, HasSubstr("too far off to be compared"));
}

TEST_F(StatedLoads, OfOpenFoamAreOfThePatchesOfTheirEntry) {
    const LoadsResult result = loads_of();
    write_openfoam(folder_.path(), 1, 10, 0.5);
    const auto zones = [&](const std::string& functions, core::Problems& notes) {
        core::write_file(folder_.path() / "system" / "controlDict", functions);
        const auto stated = stated_by_openfoam(folder_.path(), result);
        compare_with_solver(result, stated, notes);
        return stated[0].zones;
    };
    core::Problems notes;
    // A dictionary within, before the patches; an entry whose name ends alike; a comment; brackets of patterns and
    // names.
    EXPECT_THAT(
        zones("functions { forces { type forces; binData { nBin 20; patches (keel); } patches (base); } }\n", notes),
        testing::ElementsAre("base"));
    EXPECT_THAT(zones("functions { myforces { patches (hull); } forces { patches (base); } }\n", notes),
                testing::ElementsAre("base"));
    EXPECT_THAT(
        zones("functions { /* forces { patches (base); } */ forces { patches\n(\n\"(hull|keel)\" );\n} }\n", notes),
        testing::ElementsAre("hull"));
    EXPECT_THAT(zones("functions { \"forces\" { patches(base hull); rho rhoInf; } }\n", notes),
                testing::ElementsAre("base", "hull"));
    EXPECT_TRUE(notes.empty());
    EXPECT_THAT(zones("functions { forces { patches (wall(1) base); } }\n", notes), testing::ElementsAre("base"));
    // What is said elsewhere, or not at all, is said once.
    for (const char* elsewhere : {"functions { #include \"forces\" }\n", "functions { forces { patches $walls; } }\n",
                                  "functions { forces { patches ($walls); } }\n"}) {
        notes.clear();
        EXPECT_TRUE(zones(elsewhere, notes).empty());
        ASSERT_EQ(notes.size(), 1U) << elsewhere;
        EXPECT_THAT(notes[0].message, HasSubstr("does not say which patches"));
    }
}

TEST_F(StatedLoads, OfOlderOpenFoamAreReadFromOneFile) {
    const LoadsResult result = loads_of();
    std::string text =
        "# Forces\n# CofR : (1 0.5 0)\n# Time forces(pressure viscous porous) moment(pressure viscous porous)\n";
    for (int i = 1; i <= 10; ++i) {
        text += std::to_string(i) + "\t((0 0 -1) (0.2 0 0) (0 0 0)) ((0 0 0) (0 0 0) (0 0 0))\n";
    }
    core::write_file(folder_.path() / "postProcessing" / "forces1" / "0" / "forces.dat", text);
    core::Problems notes;
    const auto comparisons = compare_with_solver(result, stated_by_openfoam(folder_.path(), result), notes);
    ASSERT_EQ(comparisons.size(), 18U);
    for (const auto& one : comparisons) {
        EXPECT_NEAR(one.value, one.stated, 1e-12) << one.quantity;
    }
    core::write_file(folder_.path() / "postProcessing" / "forces1" / "0" / "forces.dat",
                     text + "11 ((0 0 -1) (0.2 0\n");
    EXPECT_THROW(stated_by_openfoam(folder_.path(), result), core::InputError);
}

// ---- into the table ----

TEST_F(StatedLoads, BecomeSigmasOfTheTableTogetherWithTheMesh) {
    LoadsCase one;
    one.file = "a.csv";
    one.numbers = {{"gap", 0.005}, {"cells", 8000}, {"drag_force_scatter", 0.02}};
    one.loads = loads_of();
    one.scatters = {{"lift_force", 0.01}};
    LoadsCase fine = one;
    fine.file = "b.csv";
    fine.numbers[1].second = 64000;
    fine.loads.named.lift_force -= 0.03;
    const auto alone = loads_table(with_iteration_sigmas({one}));
    EXPECT_NEAR(alone.numbers("lift_force_sigma")[0], 0.01, 1e-15);
    EXPECT_NEAR(alone.numbers("drag_force_sigma")[0], 0.02, 1e-15);
    EXPECT_EQ(alone.find("pitch_moment_sigma"), nullptr);
    EXPECT_EQ(alone.numbers("reference_x")[0], 1);
    EXPECT_EQ(alone.text("values_from")[0], "nodes");
    // Two meshes, ratio 2, order 2: 3 * 0.03 / 3 is the 95 % interval.
    core::Problems notes;
    const auto both = loads_table(mesh_studies({one, fine}, "cells", notes));
    ASSERT_EQ(both.rows(), 1U);
    EXPECT_NEAR(both.numbers("lift_force_sigma")[0], std::hypot(0.015, 0.01), 1e-12);
    EXPECT_EQ(both.find("side_force_sigma"), nullptr);  // nought on both meshes
    // By the faces of the surface: the same number of them is no study, and the error names both files.
    try {
        mesh_studies({one, fine}, "faces", notes);
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("'b.csv' and 'a.csv'"));
    }
}

}  // namespace
}  // namespace underbody::postproc
