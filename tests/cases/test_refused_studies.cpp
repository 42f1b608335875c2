// What a study.toml may not say: each is refused with what is wrong, the line and what to write instead.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases/study.h"
#include "core/file.h"

namespace underbody::cases {
namespace {

using testing::HasSubstr;

struct Refused {
    const char* says;     ///< after the title and one [[case]]
    const char* message;  ///< part of what is wrong
};

class RefusedStudies : public testing::TestWithParam<Refused> {};

TEST_P(RefusedStudies, SayWhatIsWrongAndWhere) {
    const core::TemporaryFolder folder("refused-study");
    for (const char* file : {"fields/a-h5.csv", "fields/b-h5.csv", "shapes/s.toml", "m.toml", "t.csv"}) {
        core::write_file(folder.path() / file, "x");
    }
    const std::string head = "title = \"t\"\n[[case]]\nfiles = \"fields/{variant}-h{gap:mm}.csv\"\n";
    core::write_file(folder.path() / "study.toml", head + GetParam().says);
    try {
        (void)Study::open(folder.path());
        FAIL() << "accepted: " << GetParam().says;
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.message(), HasSubstr(GetParam().message));
        EXPECT_THAT(error.place().file, HasSubstr("study.toml"));
        EXPECT_GT(error.place().line.value_or(0), 3);
    }
}

INSTANTIATE_TEST_SUITE_P(
    OfCasesAndTables, RefusedStudies,
    testing::Values(
        Refused{"mean = true\n", "is not known, so that it has no place among the others"},
        Refused{"[frame]\nmoments_about = [\"0 m\", \"1 m\"]\n", "needs three coordinates"},
        Refused{"[frame]\nforward = \"-z\"\n", "forward and up lie along one axis"},
        Refused{"[frame]\nsymmetry = \"yy\"\n", "yy"},
        Refused{"[frame]\nsymmetry = \"z\"\n", "every lift would be zero"},
        Refused{"[frame]\nsymmetry = \"x\"\n", "every drag would be zero"},
        Refused{
            "[[body]]\nname = \"b\"\nshape = \"shapes/s.toml\"\n[[body]]\nname = \"b\"\nshape = \"shapes/s.toml\"\n",
            "the name 'b' occurs twice"},
        Refused{"[[picture]]\nname = \"p\"\nviews = [\"bottom\"]\nrange = [\"2 Pa\", \"1 Pa\"]\n", "two pressures"},
        Refused{"[[picture]]\nname = \"p\"\nviews = [\"bottom\"]\nrange = [\"2 Pa\"]\n", "two pressures"},
        Refused{"[[mesh_uncertainty]]\nname = \"m\"\nquantities = [\"lift_force\"]\ncells.fine = 100\n",
                "fewer than two meshes"},
        Refused{"[frame]\nsymmetry = \"y\"\n[[table]]\nname = \"s\"\nquantity = \"side_force\"\naxes = [\"gap\"]\n",
                "cancel its side_force"},
        Refused{"[[table]]\nname = \"l\"\nquantity = \"lift_force\"\naxes = [\"gap\"]\nfit = \"splin\"\n",
                "'splin' is not known"},
        Refused{"[[table]]\nname = \"l\"\nquantity = \"lift_force\"\naxes = []\n", "axes"},
        Refused{"[[table]]\nname = \"l\"\nquantity = \"lift_force\"\naxes = [\"gap\"]\nmesh_uncertainty = \"m\"\n",
                "there is no [[mesh_uncertainty]] named 'm'"},
        Refused{"[[region]]\nname = \"r\"\nmodel = \"m.toml\"\nforces = [\"lift\"]\naxes = [\"gap=0:1\"]\n",
                "there is no [[table]] named 'lift'"},
        Refused{"[[verify]]\nname = \"v\"\ntable = \"t.csv\"\nquantities = [\"lift_force\"]\ntolerance = 0\n",
                "a share of the force greater than nought"}));

const std::string body = "[[body]]\nname = \"b\"\nshape = \"shapes/s.toml\"\n";

TEST(RefusedSweeps, SayWhatIsWrong) {
    const core::TemporaryFolder folder("refused-sweep");
    core::write_file(folder.path() / "shapes/s.toml", "x");
    const auto message = [&](const std::string& says) {
        try {
            (void)Study::from_text("title = \"t\"\n" + body + says, folder.path() / "study.toml");
        } catch (const core::InputError& error) {
            return error.message();
        }
        return std::string("accepted");
    };
    const std::string sweep = "[sweep]\ngap = \"5 mm\"\nspeed = \"0.5 m/s\"\n";
    EXPECT_EQ(message(sweep), "accepted");
    EXPECT_THAT(message(sweep + "bodies = [\"c\"]\n"), HasSubstr("there is no [[body]] named 'c'"));
    EXPECT_THAT(message(sweep + "bodies = []\n"), HasSubstr("a sweep needs a [[body]], a gap and a speed"));
    EXPECT_THAT(message("[sweep]\nspeed = \"0.5 m/s\"\n"), HasSubstr("gap"));
    EXPECT_THAT(message("[sweep]\ngap = []\nspeed = \"0.5 m/s\"\n"), HasSubstr("a gap and a speed"));
    EXPECT_THAT(message(sweep + "mesher = \"snappy\"\njet_flow = \"1e-5 m^3/s\"\n"),
                HasSubstr("a jet needs a mesh of blocks"));
    EXPECT_THAT(message(sweep + "mesher = \"blocks\"\nlayers = 3\n"), HasSubstr("blocks have none"));
    EXPECT_THAT(message(sweep + "[sweep.slurm]\npartition = \"a b\"\n"), HasSubstr("Slurm takes no blanks there"));
    EXPECT_THAT(message(sweep + "[sweep.slurm]\nthrottle = -1\n"), HasSubstr("cannot be negative"));
    EXPECT_THAT(message(sweep + "[sweep.slurm]\nmax_array = 5000000\n"), HasSubstr("Slurm's own 4000000"));
    EXPECT_THAT(message(sweep + "[sweep.slurm]\ncores = 0\n"), HasSubstr("1 to 4096"));
    EXPECT_THAT(message(sweep + "[sweep.slurm]\nretries = 101\n"), HasSubstr("0 to 100"));
    EXPECT_THAT(message(sweep + "[sweep.slurm]\noptions = [\"nice\"]\n"), HasSubstr("is no option of sbatch"));
}

TEST(RefusedSweeps, OfJetsThatCannotBe) {
    const core::TemporaryFolder folder("refused-jets");
    core::write_file(folder.path() / "shapes/s.toml", "x");
    const auto message = [&](const std::string& says) {
        try {
            (void)Study::from_text("title = \"t\"\n" + body + "[sweep]\ngap = \"5 mm\"\nspeed = \"0.5 m/s\"\n" + says,
                                   folder.path() / "study.toml");
        } catch (const core::InputError& error) {
            EXPECT_TRUE(error.place().line.has_value()) << says;
            return error.message();
        }
        return std::string("accepted");
    };
    const std::string volts = "jet_voltage = [\"0 V\", \"12 V\"]\n", gain = "jet_flow_per_volt = \"2.2 mL/s/V\"\n";
    EXPECT_THAT(message(volts + gain + "jet_flow = \"10 mL/s\"\n"), HasSubstr("two words for one jet"));
    EXPECT_THAT(message(gain), HasSubstr("is of a jet_voltage, and there is none"));
    EXPECT_THAT(message(volts + "jet_flow_per_volt = \"0 mL/s/V\"\n"), HasSubstr("must be above zero"));
    EXPECT_THAT(message("jet_flow = []\n"), HasSubstr("jet_flow is empty"));
    EXPECT_THAT(message("jet_flow = \"-1 mL/s\"\n"), HasSubstr("jet_flow is below zero: a nozzle blows"));
    EXPECT_THAT(message(volts + gain + "jet_dead_band = \"-1 V\"\n"), HasSubstr("jet_dead_band is below zero"));
    EXPECT_THAT(message("jet_flow = [\"10 mL/s\", \"0.01 L/s\"]\n"), HasSubstr("jet_flow says a value twice"));
}

TEST(RefusedDesigns, SayWhatIsWrong) {
    const core::TemporaryFolder folder("refused-design");
    core::write_file(folder.path() / "shapes/s.toml", "x");
    const auto message = [&](const std::string& says) {
        try {
            (void)Study::from_text("title = \"t\"\n[design]\nshape = \"shapes/s.toml\"\n" + says,
                                   folder.path() / "study.toml");
        } catch (const core::InputError& error) {
            EXPECT_TRUE(error.place().line.has_value()) << says;
            return error.message();
        }
        return std::string("accepted");
    };
    const std::string vary = "[[design.vary]]\nkey = \"protrusion.height\"\nfrom = \"1 mm\"\nto = \"3 mm\"\n";
    const std::string two = "gap = [\"3 mm\", \"9 mm\"]\n", lift = "quantity = \"lift_force\"\n";
    const std::string wanted = "[[design.objective]]\n" + lift + "sense = \"maximise\"\n";
    EXPECT_EQ(message(vary + wanted), "accepted");
    EXPECT_THAT(message("points = 0\n" + vary), HasSubstr("points is 0"));
    EXPECT_THAT(message("points = 100001\n" + vary), HasSubstr("points is 100001"));
    EXPECT_THAT(message("gap = []\n" + vary), HasSubstr("gap is empty"));
    EXPECT_THAT(message("gap = [\"5 mm\", \"0 mm\"]\n" + vary), HasSubstr("it must be above zero"));
    EXPECT_THAT(message("pitch = \"90 deg\"\n" + vary), HasSubstr("it must lie within +-90 deg"));
    EXPECT_THAT(message("kinematic_viscosity = \"0 m^2/s\"\n" + vary), HasSubstr("must be above zero"));
    EXPECT_THAT(message(""), HasSubstr("[design] varies nothing"));
    EXPECT_THAT(message(vary + vary), HasSubstr("varies twice"));
    EXPECT_THAT(message("[[design.vary]]\nkey = \"protrusion.height\"\nfrom = \"3 mm\"\nto = \"1 mm\"\n"),
                HasSubstr("the range is empty"));
    EXPECT_THAT(message("[[design.vary]]\nkey = \"protrusion.height\"\nfrom = \"0 mm\"\nto = \"1 mm\"\n"
                        "logarithmic = true\n"),
                HasSubstr("must be above zero on a logarithmic range"));
    EXPECT_THAT(message(vary + "[[design.tie]]\nkey = \"protrusion.height\"\nof = \"protrusion.length\"\n"),
                HasSubstr("varies by itself, too"));
    const std::string tie = "[[design.tie]]\nkey = \"protrusion.length\"\nof = \"protrusion.height\"\n";
    EXPECT_THAT(message(vary + tie + tie), HasSubstr("is tied twice"));
    const std::string coarse = "[[design.fidelity]]\nname = \"coarse\"\n";
    EXPECT_THAT(message(vary + coarse + coarse), HasSubstr("there are two fidelities coarse"));
    EXPECT_THAT(message(vary + coarse + "cost = \"0 s\"\n"), HasSubstr("must be above zero"));
    EXPECT_THAT(message(vary + wanted + wanted), HasSubstr("there are two objectives"));
    EXPECT_THAT(message(vary + "[[design.objective]]\nquantity = \"side_force\"\nsense = \"maximise\"\n"),
                HasSubstr("is none of design.quantities"));
    EXPECT_THAT(message(vary + wanted + "at = { gop = \"5 mm\" }\n"), HasSubstr("is no condition"));
    EXPECT_THAT(message(vary + "[[design.limit]]\n" + lift + "at_least = \"2 N\"\nat_most = \"1 N\"\n"),
                HasSubstr("no design can meet both"));
    EXPECT_THAT(message(vary + "[[design.limit]]\n" + lift), HasSubstr("at_least"));
    EXPECT_THAT(message(vary + "[design.volume]\nat_least = \"2 L\"\nat_most = \"1 L\"\n"),
                HasSubstr("no design can meet both"));
    // what an objective has to say when there are several gaps
    const auto responses = [&](const std::string& says) {
        const Study study = Study::from_text("title = \"t\"\n[design]\nshape = \"shapes/s.toml\"\n" + two + vary + says,
                                             folder.path() / "study.toml");
        try {
            check_responses(*study.design);
        } catch (const core::InputError& error) {
            return error.message();
        }
        return std::string("accepted");
    };
    EXPECT_THAT(responses(wanted), HasSubstr("does not say at which gap"));
    EXPECT_EQ(responses(wanted + "at = { gap = \"5 mm\" }\n"), "accepted");
    EXPECT_THAT(responses(wanted + "at = { gap = \"20 mm\" }\n"), HasSubstr("[design] computes 3 mm to 9 mm"));
    EXPECT_THAT(responses(wanted + "at = { gap = \"5 mm\", speed = \"1 m/s\" }\n"),
                HasSubstr("has one value in [design]"));
    EXPECT_THAT(responses(wanted + "slope_along = \"pitch\"\nat = { gap = \"5 mm\" }\n"),
                HasSubstr("[design] has no two values"));
    EXPECT_THAT(responses(wanted + "slope_along = \"gap\"\nhalf_width = \"1 mm\"\nat = { gap = \"3 mm\" }\n"),
                HasSubstr("+-"));
}

}  // namespace
}  // namespace underbody::cases
