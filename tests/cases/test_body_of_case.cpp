// A shape that was changed after its CFD is no longer the body of its cases.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases/body_of_case.h"
#include "cases/known_lift.h"
#include "core/file.h"
#include "core/own_files.h"

namespace {

using namespace underbody;
using namespace underbody::cases;

class BodyOfACase : public testing::Test {
protected:
    BodyOfACase() { shape("145 mm"); }
    void shape(const std::string& height) const {
        const core::ReplacingAllowed by_hand;
        core::write_file(
            folder_.path() / "plain.toml",
            "[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"" + height + "\"\nbase_cut = 0.75\n");
    }
    [[nodiscard]] Study study(double pitch = 0) const {
        core::write_file(folder_.path() / "x-h5.csv", "");
        Study study = Study::from_text("title = \"t\"\n[[body]]\nname = \"ellipse\"\nshape = \"plain.toml\"\n",
                                       folder_.path() / "study.toml");
        Case one;
        one.name = "x-h5";
        one.conditions.set("gap", 5e-3);
        one.conditions.set("pitch", pitch);
        one.conditions.texts.emplace_back("variant", "ellipse");
        study.cases.push_back(one);
        return study;
    }
    /// As its file has it: 126.9 mm high.
    static CaseLoads loads() {
        CaseLoads one;
        one.values.push_back({"lift_force", "N", 0.3});
        one.body_length = 0.2032;
        one.body_height = 0.1269;
        return one;
    }
    static std::optional<core::Problem> fault(const Study& study, const CaseLoads& loads) {
        return BodiesOfCases(study).fault(loads);
    }
    core::TemporaryFolder folder_;
};

TEST_F(BodyOfACase, IsHeldAgainstTheFile) {
    EXPECT_FALSE(fault(study(), loads()));
    shape("100 mm");
    const auto found = fault(study(), loads());
    ASSERT_TRUE(found);
    EXPECT_THAT(found->message, testing::HasSubstr("not the shape 'ellipse' (plain.toml): it is 126.9 mm high in the "
                                                   "file, 87.5 mm in the shape"));
    CaseLoads longer = loads();
    longer.body_length = 0.3;
    EXPECT_THAT(fault(study(), longer)->message, testing::HasSubstr("300 mm long in the file"));
    CaseLoads unknown = loads();
    unknown.body_length = unknown.body_height = NAN;
    EXPECT_FALSE(fault(study(), unknown));
}

/// A pitched body is higher than it is long in its own axes: no fault of the shape.
TEST_F(BodyOfACase, APitchedBodyIsTheSame) {
    CaseLoads pitched = loads();
    pitched.body_height = 0.1269 + 0.134 / 2 * std::sin(5 * M_PI / 180);
    EXPECT_FALSE(fault(study(5 * M_PI / 180), pitched));
}

TEST_F(BodyOfACase, ItsTableIsNoLongerCfdOfThisShape) {
    Study of = study();
    TableSpec table;
    table.name = "lift";
    table.quantity = "lift_force";
    table.axes = {"gap"};
    table.where.texts.emplace_back("variant", "ellipse");
    of.tables.push_back(table);
    StudyResults results;
    results.case_loads.push_back(loads());
    const auto known = [&] {
        const auto shape = geometry::read_shape(folder_.path() / "plain.toml");
        return known_lift(of,
                          {{"ellipse", folder_.path() / "plain.toml", shape, is_of_its_cases(of, results, "ellipse")}},
                          nullptr, shape);
    };
    EXPECT_EQ(known().basis, KnownLift::Basis::this_shape);
    shape("100 mm");
    EXPECT_EQ(known().basis, KnownLift::Basis::nearest_shape);
    EXPECT_THAT(known().words(), testing::HasSubstr("as it was when its cases were computed; not CFD of this one"));
}

}  // namespace
