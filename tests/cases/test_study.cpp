#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases/study.h"
#include "core/file.h"
#include "tests/support/support.h"

namespace underbody::cases {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class StudyFolder : public testing::Test {
protected:
    core::TemporaryFolder folder;
    void put(const std::string& name, const std::string& text) { core::write_file(folder.path() / name, text); }
    core::InputError refused(const std::string& text) {
        put("study.toml", text);
        try {
            (void)Study::open(folder.path());
        } catch (const core::InputError& error) {
            return error;
        }
        ADD_FAILURE() << "accepted: " << text;
        return {"", ""};
    }
};

TEST_F(StudyFolder, AsksAboutSharesThatMayBePerCent) {
    put("fields/ellipse-h5.csv", "x");
    put("solver.csv", "case, lift_force [N]\nellipse-h5, 1\n");
    const auto said = [&](const std::string& tolerance, const std::string& sigma) {
        put("study.toml",
            "title = \"t\"\n[[case]]\nfiles = \"fields/{variant}-h{gap:mm}.csv\"\n[[verify]]\nname = \"v\"\n"
            "table = \"solver.csv\"\nquantities = [\"lift_force\"]\ntolerance = " +
                tolerance +
                "\n[[table]]\nname = \"l\"\nquantity = \"lift_force\"\naxes = [\"gap\"]\nrelative_sigma = " + sigma +
                "\n");
        std::string all;
        for (const core::Problem& note : Study::open(folder.path()).notes) {
            all += note.message + "\n";
        }
        return all;
    };
    EXPECT_EQ(said("0.01", "0.02"), "");
    EXPECT_EQ(said("\"100 %\"", "\"200 %\""), "") << "said with its sign";
    EXPECT_THAT(said("1", "2"),
                testing::AllOf(HasSubstr("tolerance = 1 is 100 % of the force: \"1 %\" is with the sign"),
                               HasSubstr("relative_sigma = 2 is 200 % of each value")));
}

TEST_F(StudyFolder, TakesConditionsFromNamesAndFromTheCase) {
    put("fields/ellipse-h5-p-2.csv", "x");
    put("fields/ellipse-h10-p0.csv", "x");
    put("study.toml",
        "title = \"t\"\n[[case]]\nfiles = \"fields/{variant}-h{gap:mm}-p{pitch:deg}.csv\"\nconditions.speed = \"0.5 "
        "m/s\"\n");
    const Study study = Study::open(folder.path());
    ASSERT_EQ(study.cases.size(), 2U);
    EXPECT_EQ(study.cases[1].name, "ellipse-h5-p-2");
    EXPECT_DOUBLE_EQ(study.cases[1].conditions.number("gap").value(), 0.005);
    EXPECT_DOUBLE_EQ(study.cases[1].conditions.number("speed").value(), 0.5);
    EXPECT_EQ(study.cases[1].conditions.text("variant").value(), "ellipse");
    Conditions where;
    where.numbers = {{"gap", 0.01}};
    EXPECT_EQ(study.select(where).size(), 1U);
}

TEST_F(StudyFolder, IsRefusedWithPlaceAndHint) {
    put("fields/a-h5.csv", "x");
    const std::string head = "title = \"t\"\n[[case]]\nfiles = \"fields/{variant}-h{gap:mm}.csv\"\n";
    EXPECT_THAT(refused("titel = \"t\"\n").what(), HasSubstr("did you mean 'title'"));
    EXPECT_THAT(refused("summary = \"t\"\n").what(), HasSubstr("'title' is missing"));
    EXPECT_THAT(refused(head + "[[regoin]]\nname = \"r\"\n").hint(), HasSubstr("'region'"));
    EXPECT_THAT(refused("title = \"t\"\n[[case]]\nfiles = \"field/*.csv\"\n").message(), HasSubstr("no file fits"));
    EXPECT_THAT(refused(head + "[[case]]\nfiles = \"fields/*.csv\"\n").message(), HasSubstr("occurs twice"));
    EXPECT_THAT(refused(head + "[[table]]\nname = \"l\"\nquantity = \"lift_forze\"\naxes = [\"gap\"]\n").hint(),
                HasSubstr("'lift_force'"));
    EXPECT_THAT(
        refused(head + "[[table]]\nname = \"l\"\nquantity = \"lift_force\"\naxes = [\"gap\"]\nwhere.variant = \"b\"\n")
            .message(),
        HasSubstr("no case fits"));
    EXPECT_THAT(refused(head + "[frame]\nforward = \"+x\"\nup = \"-x\"\n").message(), HasSubstr("one axis"));
    EXPECT_THAT(refused(head + "[[compare]]\nname = \"c\"\ntables = [\"lift\"]\n").message(),
                HasSubstr("no [[table]]"));
    EXPECT_THAT(refused(head + "[[body]]\nname = \"../b\"\nshape = \"x.toml\"\n").message(),
                HasSubstr("cannot be a name"));
    const auto error = refused(head + "[frame]\nforward = \"x+\"\n");
    EXPECT_EQ(error.place().line.value_or(0), 5);
}

TEST_F(StudyFolder, AMissingFolderAndAFolderWithoutStudyAreTold) {
    EXPECT_THROW((void)Study::open(folder.path() / "nowhere"), core::InputError);
    EXPECT_THROW((void)Study::open(folder.path()), core::InputError);
}

TEST_F(StudyFolder, NamesThatOccurTwiceGetTheFoldersThatTellThemApart) {
    put("coarse/run-h5.csv", "x");
    put("fine/run-h5.csv", "x");
    put("fine/run-h6.csv", "x");
    put("study.toml", "title = \"t\"\n[[case]]\nfiles = \"{mesh}/run-h{gap:mm}.csv\"\n");
    const Study study = Study::open(folder.path());
    ASSERT_EQ(study.cases.size(), 3U);
    EXPECT_EQ(study.cases[0].name, "coarse/run-h5");
    EXPECT_EQ(study.cases[1].name, "fine/run-h5");
    EXPECT_EQ(study.cases[2].name, "run-h6");
}

TEST_F(StudyFolder, AFolderMayBeACaseAndAMarkerAPattern) {
    fs::create_directories(folder.path() / "runs");
    for (const char* name : {"a", "b"}) {
        fs::copy(test::data_folder() / "openfoam" / "ascii", folder.path() / "runs" / (std::string(name) + "-h5"),
                 fs::copy_options::recursive);
        put("runs/" + std::string(name) + "-h5/case.foam", "");
    }
    fs::create_directories(folder.path() / "runs" / "c-h7");
    for (const char* pattern : {"runs/{variant}-h{gap:mm}", "runs/{variant}-h{gap:mm}/case.foam",
                                "runs/{variant}-h{gap:mm}/system/controlDict"}) {
        put("study.toml", "title = \"t\"\n[[case]]\nfiles = \"" + std::string(pattern) + "\"\n");
        const Study study = Study::open(folder.path());
        ASSERT_EQ(study.cases.size(), 2U) << pattern;
        EXPECT_EQ(study.cases[0].name, "a-h5") << pattern;
        EXPECT_EQ(study.cases[1].name, "b-h5") << pattern;
        EXPECT_DOUBLE_EQ(study.cases[1].conditions.number("gap").value(), 0.005);
    }
    const auto error = refused("title = \"t\"\n[[case]]\nfiles = \"runs/c-h*\"\n");
    EXPECT_THAT(error.hint(), HasSubstr("no OpenFOAM case"));
}

TEST_F(StudyFolder, AMirrorPlaneThatMakesEveryLiftZeroIsRefused) {
    put("fields/a-h5.csv", "x");
    const std::string head = "title = \"t\"\n[[case]]\nfiles = \"fields/{variant}-h{gap:mm}.csv\"\n[frame]\n";
    const auto error = refused(head + "symmetry = \"z\"\n");
    EXPECT_THAT(error.message(), HasSubstr("every lift would be zero"));
    EXPECT_THAT(error.hint(), HasSubstr("symmetry = \"y\""));
    EXPECT_EQ(error.place().line.value_or(0), 5);
    EXPECT_THAT(refused(head + "symmetry = \"x\"\n").message(), HasSubstr("every drag would be zero"));
    EXPECT_THAT(refused(head + "symmetry = \"w\"\n").hint(), HasSubstr("normal axis"));
    put("study.toml", head + "symmetry = \"y=0.1\"\n");
    EXPECT_EQ(Study::open(folder.path()).symmetry, "y=0.1");
}

}  // namespace
}  // namespace underbody::cases
