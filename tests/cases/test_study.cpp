#include "cases/study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases/store.h"
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

TEST_F(StudyFolder, TakesConditionsFromNamesAndFromTheCase) {
    put("fields/ellipse-h5-p-2.csv", "x");
    put("fields/ellipse-h10-p0.csv", "x");
    put("study.toml", "title = \"t\"\n[[case]]\nfiles = \"fields/{variant}-h{gap:mm}-p{pitch:deg}.csv\"\nconditions.speed = \"0.5 m/s\"\n");
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
    EXPECT_THAT(refused(head + "[[table]]\nname = \"l\"\nquantity = \"lift_forze\"\naxes = [\"gap\"]\n").hint(), HasSubstr("'lift_force'"));
    EXPECT_THAT(refused(head + "[[table]]\nname = \"l\"\nquantity = \"lift_force\"\naxes = [\"gap\"]\nwhere.variant = \"b\"\n").message(),
                HasSubstr("no case fits"));
    EXPECT_THAT(refused(head + "[frame]\nforward = \"+x\"\nup = \"-x\"\n").message(), HasSubstr("one axis"));
    EXPECT_THAT(refused(head + "[[compare]]\nname = \"c\"\ntables = [\"lift\"]\n").message(), HasSubstr("no [[table]]"));
    EXPECT_THAT(refused(head + "[[body]]\nname = \"../b\"\nshape = \"x.toml\"\n").message(), HasSubstr("cannot be a name"));
    const auto error = refused(head + "[frame]\nforward = \"x+\"\n");
    EXPECT_EQ(error.place().line.value_or(0), 5);
}

TEST_F(StudyFolder, AMissingFolderAndAFolderWithoutStudyAreTold) {
    EXPECT_THROW((void)Study::open(folder.path() / "nowhere"), core::InputError);
    EXPECT_THROW((void)Study::open(folder.path()), core::InputError);
}

TEST(Store, GivesBackWhatWasPutUnderTheSameKeyOnly) {
    const core::TemporaryFolder folder;
    const std::string bytes("a\0b\n\xff", 5);
    {
        Store store(folder.path() / "deep" / "s.sqlite");
        store.put("k1", "loads", "case", bytes);
        EXPECT_EQ(store.find("k1"), bytes);
        EXPECT_FALSE(store.find("k2").has_value());
    }
    Store again(folder.path() / "deep" / "s.sqlite");
    EXPECT_EQ(again.find("k1"), bytes);
    EXPECT_EQ(again.latest("loads", "case"), bytes);
    EXPECT_FALSE(again.latest("loads", "other").has_value());
}

TEST(Store, ForgetsOldValuesOfTheSameName) {
    const core::TemporaryFolder folder;
    Store store(folder.path() / "s.sqlite");
    for (int i = 0; i < 10; ++i) {
        store.put("k" + std::to_string(i), "loads", "case", std::to_string(i));
    }
    store.put("other", "loads", "other case", "x");
    EXPECT_FALSE(store.find("k5").has_value());
    EXPECT_TRUE(store.find("k6").has_value());
    EXPECT_EQ(store.latest("loads", "case"), "9");
    EXPECT_TRUE(store.find("other").has_value());
}

TEST(Store, RefusesWhatIsNoStore) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "s.sqlite", std::string(5000, 'x'));
    EXPECT_THROW(Store store(folder.path() / "s.sqlite"), core::SystemError);
}

}  // namespace
}  // namespace underbody::cases
