#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "core/text.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

using test::run_underbody;
using ::testing::HasSubstr;

constexpr const char* lift =
    "gap [mm], lift_force [N], lift_force_sigma [N]\n1, .66, .01\n2, .4, .01\n3, .296, .01\n5, .27, .01\n10, .297, "
    ".01\n20, .324, .01\n50, .346, .01\n100, .281, .01\n";

TEST(TableCommand, GivesValuesEquilibriaAndTheirJson) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv", lift);
    auto run =
        run_underbody({"--json", "table", "at", "lift.csv", "gap=5mm", "--kind", "interpolation"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_NEAR(nlohmann::json::parse(run.output)["value"].get<double>(), 0.27, 1e-12);
    run = run_underbody({"table", "equilibria", "lift.csv", "--weight", "0.3 N", "--mass", "3.954 kg", "--json"},
                        folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto json = nlohmann::json::parse(run.output);
    ASSERT_EQ(json["equilibria"].size(), 3u) << run.output;
    EXPECT_TRUE(json["equilibria"][0]["stable"].get<bool>());
    EXPECT_NEAR(json["equilibria"][0]["gap"].get<double>(), 0.003, 3e-4);
    EXPECT_FALSE(json["equilibria"][1]["stable"].get<bool>());
    EXPECT_GT(json["equilibria"][0]["kick_velocity"].get<double>(), 0);
    run = run_underbody({"table", "continue", "lift.csv", "--along", "net_weight=0.2:0.6", "--json"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_GE(nlohmann::json::parse(run.output)["folds"].size(), 2u);
    run = run_underbody({"table", "continue", "lift.csv", "--along", "net_weight=0.2:0.6"}, folder.path());
    EXPECT_THAT(run.output, HasSubstr("stable from net_weight "));
    EXPECT_THAT(run.output, HasSubstr("unstable from net_weight "));
    EXPECT_THAT(run.output, HasSubstr(" mm"));
}

TEST(TableCommand, AWeightThatNobodyGaveIsSaidWhereNothingBalances) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv", lift);
    EXPECT_THAT(run_underbody({"table", "equilibria", "lift.csv"}, folder.path()).output,
                HasSubstr("no equilibrium: the net force is 0.66 N"));
    EXPECT_THAT(run_underbody({"table", "equilibria", "lift.csv"}, folder.path()).output,
                HasSubstr("; a net weight of 0 N was taken (--weight)"));
    EXPECT_THAT(run_underbody({"table", "equilibria", "lift.csv", "--weight", "3 N"}, folder.path()).output,
                testing::Not(HasSubstr("was taken")));
}

TEST(TableCommand, PointsWithoutErrorsAreSaidToBeExactWhereAnErrorIsRead) {
    core::TemporaryFolder folder;
    const std::string said = "points of lift_force state no errors and are taken as exact";
    core::write_file(folder.path() / "with.csv", lift);
    core::write_file(folder.path() / "without.csv",
                     "gap [mm], lift_force [N]\n1, .66\n2, .4\n3, .296\n5, .27\n10, .297\n20, .324\n50, .346\n");
    for (const bool exact : {false, true}) {
        const std::string file = exact ? "without.csv" : "with.csv";
        const auto expected = [&] {
            return exact ? testing::Matcher<std::string>(HasSubstr(said)) : testing::Not(HasSubstr(said));
        };
        for (const std::vector<std::string>& command : {std::vector<std::string>{"table", "at", file, "gap=4mm"},
                                                        {"table", "equilibria", file, "--weight", "0.3"}}) {
            EXPECT_THAT(run_underbody(command, folder.path()).output, expected()) << command[1];
            auto json = command;
            json.emplace_back("--json");
            EXPECT_EQ(nlohmann::json::parse(run_underbody(json, folder.path()).output)["points_exact"], exact);
        }
        EXPECT_THAT(run_underbody({"table", "fit", file, "--kind", "interpolation"}, folder.path()).output, expected());
        for (const char* format : {"lift.h", "lift.csv", "lift.json"}) {
            ASSERT_EQ(run_underbody({"export", file, "--out", format, "--force"}, folder.path()).exit_code, 0);
            EXPECT_THAT(core::read_file(folder.path() / format), expected()) << format;
        }
        // Read back, it says so again, once.
        ASSERT_EQ(run_underbody({"export", "lift.csv", "--out", "again.csv", "--force"}, folder.path()).exit_code, 0);
        const std::string again = core::read_file(folder.path() / "again.csv");
        EXPECT_THAT(again, expected());
        EXPECT_EQ(again.find("# The " + said), again.rfind("# The " + said));
    }
}

TEST(TableCommand, RefusesForcesThatAreNoNumbersOfThisWorld) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "huge.csv", "gap [mm], lift_force [N]\n1, 2\n2, 1e300\n3, -1e300\n");
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"table", "fit", "huge.csv"}, {"export", "huge.csv", "--out", "huge.h"}}) {
        const auto run = run_underbody(command, folder.path());
        EXPECT_EQ(run.exit_code, 3);
        EXPECT_THAT(run.errors, HasSubstr("huge.csv:3:2: lift_force is 1e+300 here"));
    }
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "huge.h"));  // was: written, with nan in it
}

TEST(TableCommand, SaysWhatIsWrong) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv", lift);
    core::write_file(folder.path() / "one.csv", "gap [mm], lift_force [N]\n1, 2\n");
    EXPECT_EQ(run_underbody({"table", "fit", "one.csv"}, folder.path()).exit_code, 3);
    EXPECT_EQ(run_underbody({"table", "fit", "none.csv"}, folder.path()).exit_code, 3);
    EXPECT_EQ(run_underbody({"table", "fit", "lift.csv", "--kind", "magic"}, folder.path()).exit_code, 2);
    const auto swapped =
        run_underbody({"table", "continue", "lift.csv", "--along", "net_weight=0.6:0.2"}, folder.path());
    EXPECT_EQ(swapped.exit_code, 2);
    EXPECT_THAT(swapped.errors, HasSubstr("swapped"));
    const auto outside = run_underbody({"table", "at", "lift.csv", "gap=200mm"}, folder.path());
    EXPECT_EQ(outside.exit_code, 0);
    EXPECT_THAT(outside.output, HasSubstr("outside the table by 100 mm"));
    EXPECT_THAT(outside.output, HasSubstr("   outside the table"));
    const auto below = run_underbody({"table", "at", "lift.csv", "gap=-5mm"}, folder.path());
    EXPECT_EQ(below.exit_code, 2);
    EXPECT_THAT(below.errors, HasSubstr("a gap of -5 mm lies in the ground"));
    const auto bare = run_underbody({"table", "at", "lift.csv", "gap=5"}, folder.path());
    EXPECT_THAT(
        bare.output,
        HasSubstr(
            "outside the table by 4900 mm: the end value is held; it is 5 m (a bare number is SI), and 5 mm would lie "
            "inside"));
    ASSERT_EQ(run_underbody({"export", "lift.csv", "--out", "lift.h"}, folder.path()).exit_code, 0);
    const auto header = run_underbody({"table", "at", "lift.h", "gap=5mm"}, folder.path());
    EXPECT_EQ(header.exit_code, 3);
    EXPECT_THAT(header.errors, HasSubstr("exported as c, which is not read back"));
    // What would be passed over in silence.
    const auto wrong = [&](const std::vector<std::string>& words, const char* message) {
        const auto run = run_underbody(words, folder.path());
        EXPECT_EQ(run.exit_code, 2);
        EXPECT_THAT(run.errors, HasSubstr(message));
    };
    wrong({"table", "equilibria", "lift.csv", "--held", "gap=5mm"}, "gap cannot be held: it is what varies");
    wrong({"table", "at", "lift.csv", "gap=5mm,gap=6mm"}, "'gap' is given twice");
    wrong({"table", "fit", "lift.csv", "--where", "gap=5mm,gap=6mm"}, "gap=a|b takes either");
    wrong({"export", "lift.csv", "--out", "l.h", "--points", "gap=5,gap=6"}, "'gap' is given twice");
    wrong({"export", "lift.csv", "--out", "l.foo"}, "or end it in .h, .csv, .json");
    wrong({"table", "continue", "lift.csv", "--weight", "0.3", "--along", "speed=0.3:0.8"},
          "does not say at which speed it was made");
    wrong({"table", "continue", "lift.csv", "--weight", "0.3", "--along", "speed=0.3:0.8", "--reference", "0"},
          "must be positive");
    wrong({"table", "continue", "lift.csv", "--weight", "0.3", "--along", "speed=0.3:0.8", "--reference", "1",
           "--exponent", "nan"},
          "exponent a number");
    // A unit that is none of a force is a mistake of the command line.
    const auto unit = run_underbody({"table", "equilibria", "lift.csv", "--weight", "3 mm"}, folder.path());
    EXPECT_EQ(unit.exit_code, 2);
    EXPECT_THAT(unit.errors, HasSubstr("--weight"));
    EXPECT_EQ(run_underbody({"table", "equilibria", "lift.csv", "--mass", "heavy"}, folder.path()).exit_code, 2);
    EXPECT_EQ(
        run_underbody({"table", "continue", "lift.csv", "--along", "net_weight=0.2 kg:0.6"}, folder.path()).exit_code,
        2);
}

TEST(TableCommand, BalancesOfAModelsTablesAreNotTheVehicles) {
    core::TemporaryFolder folder;
    std::string table = "gap [mm], pitch [deg], lift_force [N], pitch_moment [N m]\n";
    for (const int gap : {2, 5, 10, 20, 40}) {
        for (const int pitch : {-4, -2, 0, 2, 4}) {
            table += std::to_string(gap) + ", " + std::to_string(pitch) + ", " +
                     core::format_number(2.0 / gap + 0.01 * pitch, 6) + ", " +
                     core::format_number(0.004 - 0.002 * pitch, 6) + "\n";
        }
    }
    core::write_file(folder.path() / "t.csv", table);
    core::write_file(folder.path() / "m.toml",
                     "[vehicle]\nmass = 2.2\nadded_mass_heave = 1.7\nnet_weight = 0.2\npitch_inertia = 0.007\n"
                     "added_inertia_pitch = 0\nbase_depth = \"50 mm\"\nbase_half_length = \"70 mm\"\n"
                     "buoyancy_height = \"5 mm\"\n[[force]]\nquantity = \"lift_force\"\ntable = \"t.csv\"\n"
                     "[[force]]\nquantity = \"pitch_moment\"\ntable = \"t.csv\"\n");
    const auto model = run_underbody({"table", "pitch", "m.toml", "--weight", "0.2 N"}, folder.path());
    EXPECT_EQ(model.exit_code, 0) << model.errors;
    EXPECT_THAT(model.output, HasSubstr("buoyancy and its centre of gravity are left out"));
    const auto alone = run_underbody({"table", "pitch", "t.csv", "--weight", "0.2 N"}, folder.path());
    EXPECT_EQ(alone.exit_code, 0) << alone.errors;
    EXPECT_EQ(alone.output.find("left out"), std::string::npos);
}

TEST(TableCommand, RefusesAnAxisUnderAnotherName) {
    core::TemporaryFolder folder;
    for (const auto& [heading, name] :
         {std::pair{"Gap (mm)", "'gap [mm]'"}, {"Gap [mm]", "'gap [mm]'"}, {"trim angle [deg]", "'pitch [deg]'"}}) {
        core::write_file(folder.path() / "f.csv",
                         std::string("speed [m/s], ") + heading +
                             ", lift_force [N]\n0.4,1,1\n0.4,2,2\n0.5,1,3\n0.5,2,4\n0.6,1,4\n0.6,2,5\n");
        const auto run = run_underbody({"table", "fit", "f.csv"}, folder.path());
        EXPECT_EQ(run.exit_code, 3);
        EXPECT_THAT(run.errors,
                    testing::AllOf(HasSubstr("which the table lacks"), HasSubstr(std::string("name it ") + name)));
    }
    // It may be something else: then the axes are named.
    EXPECT_THAT(run_underbody({"table", "fit", "f.csv", "--axes", "speed"}, folder.path()).errors,
                testing::Not(HasSubstr("which the table lacks")));
}

TEST(TableCommand, TakesARangePolicyForEachAxis) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv",
                     "gap [mm], pitch [deg], lift_force [N]\n1,-2,.66\n1,2,.7\n2,-2,.4\n2,2,.45\n5,-2,.27\n5,2,.3\n");
    const auto at = [&](const std::string& point, const std::string& range) {
        return run_underbody({"table", "at", "lift.csv", point, "--range", range, "--json"}, folder.path());
    };
    const auto refused = at("gap=6mm,pitch=0", "gap=refuse,pitch=clamp");
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_THAT(refused.output, HasSubstr("gap 6 mm is outside the table, which covers 1 to 5 mm"));
    const auto held = at("gap=5mm,pitch=3deg", "gap=refuse,pitch=clamp");
    ASSERT_EQ(held.exit_code, 0) << held.errors;
    EXPECT_NEAR(nlohmann::json::parse(held.output)["value"].get<double>(), 0.3, 1e-12);
    const auto further = at("gap=5mm,pitch=3deg", "refuse,pitch=extrapolate");
    ASSERT_EQ(further.exit_code, 0) << further.errors;
    EXPECT_NEAR(nlohmann::json::parse(further.output)["value"].get<double>(), 0.3075, 1e-9);
    EXPECT_EQ(at("gap=5mm,pitch=3deg", "pich=clamp").exit_code, 2);
    EXPECT_THAT(at("gap=5mm,pitch=3deg", "pich=clamp").output, HasSubstr("pitch"));
    EXPECT_EQ(at("gap=5mm,pitch=3deg", "gap=clam").exit_code, 2);
    // An exported table keeps the policies of its axes.
    ASSERT_EQ(run_underbody({"export", "lift.csv", "--format", "json", "--out", "t.json", "--range", "gap=refuse"},
                            folder.path())
                  .exit_code,
              0);
    EXPECT_EQ(run_underbody({"table", "at", "t.json", "gap=6mm,pitch=0"}, folder.path()).exit_code, 3);
    EXPECT_EQ(run_underbody({"table", "at", "t.json", "gap=6mm,pitch=0", "--range", "clamp"}, folder.path()).exit_code,
              0);
    const auto fit = run_underbody({"table", "fit", "t.json", "--json"}, folder.path());
    EXPECT_EQ(nlohmann::json::parse(fit.output)["tables"][0]["axes"][0]["range_policy"], "refuse");
}

TEST(TableCommand, BalancesHeaveAndPitchAtAHeldSpeedWithTrimAndMasses) {
    // Lift (1 - 2 (h - 0.5) + 3 p) v^2, moment (-0.5 p + 0.2 (h - 0.5)) v^2.
    std::string text =
        "gap [m], pitch [rad], speed [m/s], lift_force [N], lift_force_sigma [N], pitch_moment [N m], "
        "pitch_moment_sigma [N m]\n";
    for (const double h : {0.1, 0.3, 0.5, 0.65, 0.7, 0.9}) {  // it balances at one of them: no cell adds to the error
        for (const double p : {-0.2, -0.1, 0.0, 0.1, 0.2}) {
            for (const double v : {1.0, 2.0}) {
                std::ostringstream line;
                line << h << ", " << p << ", " << v << ", " << (1 - 2 * (h - 0.5) + 3 * p) * v * v << ", 0.01, "
                     << (-0.5 * p + 0.2 * (h - 0.5)) * v * v << ", 0.002\n";
                text += line.str();
            }
        }
    }
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "t.csv", text);
    const auto pitch = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"table", "pitch", "t.csv", "--kind", "interpolation"});
        return run_underbody(more, folder.path());
    };
    const auto run = pitch({"--held", "speed=2", "--weight", "4", "--trim", "80 mN m", "--mass", "2", "--inertia",
                            "0.5", "--picture", "balance.png", "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto json = nlohmann::json::parse(run.output);
    ASSERT_EQ(json["equilibria"].size(), 1u) << run.output;
    const auto& e = json["equilibria"][0];
    EXPECT_NEAR(e["gap"].get<double>(), 0.65, 1e-6);
    EXPECT_NEAR(e["pitch"].get<double>(), 0.1, 1e-6);
    EXPECT_NEAR(e["frequency"][0].get<double>(), std::sqrt(4 * (1 - std::sqrt(0.6))) / (2 * M_PI), 1e-6);
    EXPECT_NEAR(e["gap_sigma"].get<double>(), std::hypot(0.5 * 0.01, 3 * 0.002) / 0.4 / 4, 1e-5);
    EXPECT_TRUE(json["windows"].empty());
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "balance.png"));
    // With a gap there are windows at it too, and the picture is theirs.
    const auto both = pitch({"--held", "speed=2,gap=500mm", "--weight", "4", "--picture", "moment.png"});
    EXPECT_THAT(both.output, HasSubstr("restores from"));
    EXPECT_THAT(both.output, HasSubstr("balance of heave and pitch at gap 500 mm +- "));
    EXPECT_THAT(both.output, HasSubstr("without --mass and --inertia"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "moment.png"));
    // Where nothing balances, what torque would: at v = 2 lift holds 4 N on h - 0.5 = 1.5 p, with the moment -0.2 p v^2
    // there.
    const auto none = pitch({"--held", "speed=2", "--weight", "4", "--trim", "0.5"});
    EXPECT_THAT(none.output, HasSubstr("the trim torque would be -0.16 to 0.16 N m nose up"));
    EXPECT_THAT(pitch({"--held", "speed=2", "--weight", "400"}).output, HasSubstr("lift holds the weight nowhere"));
    // What is missing is said.
    EXPECT_EQ(pitch({"--held", "speed=2"}).exit_code, 2);
    EXPECT_THAT(pitch({"--held", "speed=2"}).errors, HasSubstr("'gap' whose value is not given"));
    EXPECT_THAT(pitch({"--weight", "4"}).errors, HasSubstr("'speed' whose value is not given"));
    EXPECT_EQ(pitch({"--held", "speed=2", "--weight", "4", "--mass", "2"}).exit_code, 2);
    EXPECT_EQ(pitch({"--held", "speed=2,gap=0.5", "--trim", "1"}).exit_code, 2);
}

/// Points that scatter and state no errors: what is taken as theirs stands wherever the error is read.
TEST(TableCommand, ScatterThatIsTakenAsTheErrorOfPointsIsSaidWhereAnErrorIsRead) {
    core::TemporaryFolder folder;
    std::string scattered = "gap [mm], pitch [deg], lift_force [N]\n";
    for (int i = 0; i < 25; ++i) {
        const double gap = 3 + std::fmod(7.3 * i, 11), pitch = -2 + std::fmod(1.7 * i, 4),
                     off = 0.02 * std::sin(12.9898 * i * i);
        scattered += core::format_number(gap, 5) + ", " + core::format_number(pitch, 4) + ", " +
                     core::format_number(0.9 * std::exp(-gap / 8) + 0.05 * pitch + off, 5) + "\n";
    }
    core::write_file(folder.path() / "scattered.csv", scattered);
    const std::string said = "points of lift_force state no errors: what they scatter by about the fit, about 0.01";
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"table", "fit", "scattered.csv"},
          {"table", "at", "scattered.csv", "gap=7mm,pitch=0.5deg"},
          {"table", "equilibria", "scattered.csv", "--weight", "0.3", "--held", "pitch=0"}}) {
        EXPECT_THAT(run_underbody(command, folder.path()).output, HasSubstr(said)) << command[1];
    }
    const auto json = nlohmann::json::parse(
        run_underbody({"table", "at", "scattered.csv", "gap=7mm,pitch=0.5deg", "--json"}, folder.path()).output);
    EXPECT_EQ(json["points_exact"], false);
    EXPECT_NEAR(json["points_scatter"].get<double>(), 0.015, 0.005);
    for (const char* format : {"lift.h", "lift.csv", "lift.json"}) {
        ASSERT_EQ(run_underbody({"export", "scattered.csv", "--out", format, "--force"}, folder.path()).exit_code, 0);
        EXPECT_THAT(core::read_file(folder.path() / format), HasSubstr(said)) << format;
    }
    EXPECT_THAT(run_underbody({"table", "at", "lift.csv", "gap=7mm,pitch=0.5deg"}, folder.path()).output,
                HasSubstr(said))
        << "an exported table";
}

/// Texts tell angles in degrees, slopes over them too; the JSON is SI and says so.
TEST(TableCommand, SlopesOverAnglesArePerDegreeInTheText) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "m.csv",
                     "pitch [deg], pitch_moment [N m]\n-2, 0.004\n-1, 0.002\n0, 0\n1, -0.002\n2, -0.004\n");
    const auto text = run_underbody({"table", "at", "m.csv", "pitch=0.5deg"}, folder.path());
    EXPECT_THAT(text.output, HasSubstr("slope -0.002 N m/deg along pitch")) << text.errors;
    const auto json =
        nlohmann::json::parse(run_underbody({"table", "at", "m.csv", "pitch=0.5deg", "--json"}, folder.path()).output);
    EXPECT_NEAR(json["slope"]["pitch"].get<double>(), -0.002 * 180 / M_PI, 1e-6);
    EXPECT_EQ(json["slope_unit"]["pitch"], "N m/rad");
}

/// A blank in place of a comma: no number before the error about the second point.
TEST(TableCommand, NothingIsPrintedBeforeAnErrorOfALaterPoint) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv", lift);
    const auto run = run_underbody({"table", "at", "lift.csv", "gap=4mm", "pitch=1deg"}, folder.path());
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.output, "");
    EXPECT_THAT(run.errors, HasSubstr("the table has no axis 'pitch'"));
    const auto both = run_underbody({"table", "at", "lift.csv", "gap=4mm", "gap=5mm"}, folder.path());
    EXPECT_EQ(both.exit_code, 0);
    EXPECT_NE(both.output.find("along gap"), both.output.rfind("along gap")) << "two numbers: " << both.output;
}

TEST(TableCommand, GapsBelowZeroAreToldWithTheirPlace) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv",
                     "gap [mm], lift_force [N]\n-1, 0.9\n2, 0.8\n4, 0.6\n6, 0.5\n8, 0.45\n");
    const std::string said = "1 of 5 points is at a gap below 0, -1 mm";
    for (const std::vector<std::string>& command : {std::vector<std::string>{"table", "fit", "lift.csv"},
                                                    {"table", "at", "lift.csv", "gap=3mm"},
                                                    {"table", "equilibria", "lift.csv", "--weight", "0.6"}}) {
        EXPECT_THAT(run_underbody(command, folder.path()).output, HasSubstr(said)) << command[1];
    }
    const auto made = run_underbody({"export", "lift.csv", "--out", "lift.h"}, folder.path());
    EXPECT_THAT(made.errors, HasSubstr("lift.csv:2"));
    EXPECT_THAT(made.errors, HasSubstr(said));
    EXPECT_THAT(core::read_file(folder.path() / "lift.h"), HasSubstr(said));
}

}  // namespace
}  // namespace underbody
