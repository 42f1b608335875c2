// What was declared of a case against what its file shows: gap, lengths, density, copies.
#include <gmock/gmock.h>

#include <numbers>

#include "postproc/loads/declared.h"
#include "postproc/loads/loads.h"
#include "tests/postproc/made_zones.h"

namespace underbody::postproc {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A body of that length (m) whose base lies at `height`.
LoadsResult body_at(double height, double length = 0.2) {
    LoadsResult loads;
    loads.file = "body.csv";
    loads.reference = {0, 0, height};
    loads.reference_from = "centre of the base (zone 'base')";
    loads.up = {0, 0, 1};
    loads.length = length;
    return loads;
}

std::string said(const LoadsResult& loads, double gap, double pitch = 0, const Field& field = {}) {
    const auto fault = gap_fault(field, loads, gap, pitch);
    return fault ? fault->message : "";
}

TEST(DeclaredGap, IsHeldAgainstTheHeightOfTheBase) {
    EXPECT_EQ(said(body_at(0.005), 0.005), "");
    EXPECT_EQ(said(body_at(0.00511), 0.005), "");  // 2 %
    EXPECT_EQ(said(body_at(0.0014), 0.001), "");   // rounded to whole millimetres
    EXPECT_THAT(said(body_at(0.002), 2), AllOf(HasSubstr("declared as 2 m"), HasSubstr("lies 2 mm over"),
                                               HasSubstr("is it in mm, and was read in m?")));
    EXPECT_THAT(said(body_at(0.005), 0.0127), AllOf(HasSubstr("declared as 12.7 mm"), HasSubstr("is the unit right")));
    EXPECT_THAT(said(body_at(0.005), 0.007), HasSubstr("lies 5 mm over"));
    EXPECT_THAT(said(body_at(0.0508), 0.002), HasSubstr("is it in in, and was read in mm?"));
}

TEST(DeclaredGap, MayBeOfAnotherPointOfAPitchedBody) {
    EXPECT_EQ(said(body_at(0.00466), 0.005, -0.0349), "");
    EXPECT_THAT(said(body_at(0.00466), 0.0052), HasSubstr("declared as 5.2 mm"));
    EXPECT_THAT(said(body_at(0.00466), 5, -0.0349), HasSubstr("was read in m"));
}

TEST(DeclaredGap, IsNotToldByAReferenceThatWasGivenOrABodyAtItsOwnOrigin) {
    LoadsResult given = body_at(0.002);
    given.reference_from = "given";
    EXPECT_EQ(said(given, 2), "");
    EXPECT_EQ(said(body_at(0), 0.005), "");
    EXPECT_EQ(said(body_at(-0.05), 0.005), "");
}

TEST(DeclaredGap, IsCountedFromAGroundThatIsInTheFile) {
    Field field = box(false, false);  // its base is a flat wall at z = 0
    for (Zone& zone : field.zones) {
        zone.kind = ZoneKind::wall;
    }
    LoadsResult loads = body_at(0.005);
    EXPECT_EQ(said(loads, 0.005, 0, field), "");
    EXPECT_THAT(said(loads, 5, 0, field), HasSubstr("over the ground: is it in mm"));
}

TEST(DeclaredLengths, FarFromThoseOfTheBodyAreToldWithTheLikelyUnit) {
    const LoadsReferences millimetres{{}, {}, 203.2, 152, 145};
    const auto faults = size_faults(millimetres, {0.203, 0.152, 0.0725}, 10, {"body.csv", {}, {}, {}});
    ASSERT_EQ(faults.size(), 3U);
    EXPECT_THAT(faults[0].message, AllOf(HasSubstr("length of reference is 203.2 m"), HasSubstr("in the file 203 mm"),
                                         HasSubstr("is it in mm, and was read in m?")));
    EXPECT_TRUE(size_faults({{}, {}, 0.4, 0.3, 0.145}, {0.203, 0.152, 0.0725}, 10, {}).empty());
    EXPECT_TRUE(size_faults({{}, {}, 0.4, 0.3, 0.145}, {0, 0, 0}, 10, {}).empty());  // a plane case has no width
}

TEST(DeclaredLengths, AreHeldAgainstTheBodyByTheLoads) {
    LoadsOptions options;
    options.references.length = 2000;
    options.references.speed = 0.5;
    options.references.density = 998;
    const auto messages = [](const LoadsResult& result) {
        std::string all;
        for (const auto& problem : result.problems) {
            all += problem.message + "\n";
        }
        return all;
    };
    EXPECT_THAT(messages(loads(box(false, false), options)), HasSubstr("length of reference is 2000 m"));
    options.references = {998, 0.5, 2, 1, 0.5};
    EXPECT_THAT(messages(loads(box(false, false), options)), testing::Not(HasSubstr("of reference is")));
}

TEST(DeclaredPitch, OfOneCaseIsHeldAgainstTheTiltOfItsBase) {
    constexpr double deg = std::numbers::pi / 180;
    const auto pitched = [](double tilt) {
        LoadsResult loads = body_at(0.005);
        loads.forward = {1, 0, 0};
        loads.zones.resize(1);
        loads.zones[0].name = "base";
        loads.zones[0].area = 0.012;
        loads.zones[0].area_vector = {0.01 * std::sin(tilt), 0, -0.01 * std::cos(tilt)};
        return loads;
    };
    const auto told = [&](double pitch, double tilt) {
        const auto fault = pitch_fault(pitched(tilt), "*base*", pitch);
        return fault ? fault->message : "";
    };
    EXPECT_NEAR(base_tilt(pitched(-2 * deg), "*base*"), -2 * deg, 1e-12);
    EXPECT_TRUE(std::isnan(base_tilt(pitched(0), "keel")));
    EXPECT_EQ(told(2 * deg, 2 * deg), "");
    EXPECT_EQ(told(0, 0), "");
    EXPECT_EQ(told(0, 12 * deg), "") << "shapes may have such a base";
    EXPECT_EQ(told(NAN, 2 * deg), "");
    EXPECT_THAT(told(2, 2 * deg), AllOf(HasSubstr("declared as 114.59 deg"), HasSubstr("pitched by 2 deg"),
                                        HasSubstr("is it in deg, and was read in rad?")));
    EXPECT_THAT(told(-1, -1 * deg), HasSubstr("is it in deg, and was read in rad?"));
    EXPECT_THAT(told(2 * deg * deg, 2 * deg), HasSubstr("is it in rad, and was read in deg?"));
    EXPECT_THAT(told(30 * deg, 0), HasSubstr("the file the one that was meant"));
    LoadsResult without = body_at(0.005);  // no base is known
    ASSERT_TRUE(pitch_fault(without, "*base*", 2));
    EXPECT_FALSE(pitch_fault(without, "*base*", 0.5));
}

TEST(DeclaredPitch, OfCasesOfOneBodyHasToAgree) {
    constexpr double deg = std::numbers::pi / 180;
    std::vector<ConditionedLoads> cases;
    const auto add = [&](const std::string& name, double pitch, double tilt, const std::string& body = "a") {
        cases.push_back({name,
                         {{"variant", body}, {"gap", "0.005"}, {"pitch", std::to_string(pitch * deg)}},
                         {0.1 + 0.01 * static_cast<double>(cases.size())},
                         tilt * deg});
    };
    const auto told = [&] {
        std::string all;
        for (const auto& [problem, at] : other_pitches(cases)) {
            all += problem.message + "\n";
        }
        return all;
    };
    for (const double pitch : {-2, -1, 0, 1, 2}) {
        add("a" + std::to_string(static_cast<int>(pitch)), pitch, pitch);
        add("b" + std::to_string(static_cast<int>(pitch)), pitch, pitch + 3, "b");  // its base is pitched by 3 deg
    }
    add("odd", 0, NAN);
    EXPECT_EQ(told(), "");
    std::swap(cases[0].base_pitch, cases[8].base_pitch);  // a at -2 and 2
    EXPECT_EQ(other_pitches(cases).size(), 2U);
    EXPECT_THAT(told(), AllOf(HasSubstr("of 'a-2' is declared as -2 deg, but in the file the base is pitched by 2 deg"),
                              HasSubstr("is its sign turned"), HasSubstr("'a2'")));
    std::swap(cases[0].base_pitch, cases[8].base_pitch);
    add("level", 2, 0);
    EXPECT_THAT(told(), AllOf(HasSubstr("'level' is declared as 2 deg, but in the file the base is pitched by 0 deg"),
                              HasSubstr("the one that was meant")));
    cases.pop_back();
    add("of b", 1, 1, "b");
    EXPECT_THAT(told(), HasSubstr("pitched by -2 deg against the body, as other cases have it"));
    cases.clear();
    add("one", 2, -2);  // its base may be so
    EXPECT_EQ(told(), "");
    add("two", -2, 2);
    EXPECT_EQ(other_pitches(cases).size(), 2U);
    cases.clear();
    for (const double pitch : {-2, 0, 2}) {
        add("turned flow", pitch, 0);
    }
    ASSERT_EQ(other_pitches(cases).size(), 1U);
    EXPECT_THAT(told(), AllOf(HasSubstr("3 cases of one body are declared with pitches from -2 to 2 deg"),
                              HasSubstr("If the flow was turned")));
}

/// An ellipsoid in a stream, with the pressure of a round body: at rest at its nose, suction round its middle.
LoadsResult in_a_stream(Field& field, double pascal, double speed, bool heavy = false) {
    const Vector axes{0.1, 0.076, 0.0725};
    field = {};
    field.zones.push_back(ellipsoid(40, axes, [&](const Vector& p) {
        return pascal * (p[0] > 0 ? 1 - 1.9 * (1 - p[0] * p[0] / 0.01) : -0.4) - (heavy ? 998 * 9.81 * p[2] : 0);
    }));
    LoadsOptions options;
    options.references.speed = speed;
    options.references.density = 998;
    return loads(field, options);
}

TEST(DeclaredSpeed, IsHeldAgainstTheHighestPressure) {
    const auto told = [](double pascal, double speed, bool heavy = false) {
        Field field;
        const auto fault = flow_fault(field, in_a_stream(field, pascal, speed, heavy), "*base*");
        return fault ? fault->message : "";
    };
    constexpr double stagnation = 124.75;  // Pa, at 0.5 m/s
    EXPECT_EQ(told(stagnation, 0.5), "");
    EXPECT_EQ(told(stagnation, 0.5, true), "") << "with the weight of the water";
    EXPECT_EQ(told(stagnation / 100, 0.05, true), "");
    EXPECT_EQ(told(2 * stagnation, 0.5), "");
    EXPECT_THAT(told(1000 * stagnation, 0.5),
                AllOf(HasSubstr("1/2 rho U^2 = 124.8 Pa"), HasSubstr("is the pressure in Pa, and was read in kPa?")));
    EXPECT_THAT(told(stagnation / 998, 0.5), HasSubstr("over density"));
    EXPECT_THAT(told(stagnation, 5), HasSubstr("m/s comes to rest at"));
    EXPECT_THAT(told(stagnation, 500), HasSubstr("is the speed in mm/s, and was read in m/s?"));
}

// Without a density there are no coefficients: a speed wrong by a thousand passed unseen.
TEST(DeclaredSpeed, IsHeldAgainstTheHighestPressureInFreshWaterWhereNobodyStatesADensity) {
    const auto told = [](double pascal, double speed, std::optional<double> density) {
        Field field;
        LoadsResult loads = in_a_stream(field, pascal, 0.5);
        loads.coefficients.reset();
        field.density = density;
        const auto fault = flow_fault(field, loads, "*base*", speed);
        return fault ? fault->message : "";
    };
    constexpr double stagnation = 124.75;  // Pa, at 0.5 m/s
    EXPECT_EQ(told(stagnation, 0.5, {}), "");
    EXPECT_EQ(told(stagnation, NAN, {}), "") << "nobody said a speed";
    EXPECT_THAT(told(stagnation, 500, {}), AllOf(HasSubstr("(in 998 kg/m^3, since no density is given)"),
                                                 HasSubstr("is the speed in mm/s, and was read in m/s?")));
    EXPECT_EQ(told(1.2 / 998 * stagnation, 0.5, 1.2), "") << "the file's own density";
}

TEST(DeclaredReference, FarFromTheBodyIsToldWithTheLikelyUnit) {
    Field field;
    LoadsResult loads = in_a_stream(field, 100, 0.5);
    loads.reference = {0, 0, 5};
    EXPECT_FALSE(reference_fault(field, loads, 3)) << "nobody gave it";
    loads.reference_from = "given";
    const auto fault = reference_fault(field, loads, 3);
    ASSERT_TRUE(fault);
    EXPECT_THAT(fault->message, AllOf(HasSubstr("about (0, 0, 5) m, 25 lengths of the body away"),
                                      HasSubstr("is it in mm, and was read in m?")));
    EXPECT_FALSE(reference_fault(field, loads, 30));
    loads.reference = {0.3, 0, 0};
    EXPECT_FALSE(reference_fault(field, loads, 3));
    loads.reference = {500, 0, 0};
    EXPECT_THAT(reference_fault(field, loads, 3)->message, HasSubstr("is it the point that was meant"));
}

TEST(DeclaredUp, IsHeldAgainstTheSideThatTheBaseFaces) {
    LoadsResult loads = body_at(0.005);
    const auto faces = [&](Vector area) {
        loads.zones = {{}, {}};
        loads.zones[0].name = "base";
        loads.zones[0].area_vector = area;
        loads.zones[1].name = "hull";
        loads.area = 0.06;
        const auto fault = base_fault(loads, "*base*");
        return fault ? fault->message : "";
    };
    EXPECT_EQ(faces({0, 0, -0.01}), "");
    EXPECT_EQ(faces({0.005, 0, -0.0087}), "") << "a body pitched by 30 degrees";
    EXPECT_THAT(faces({0, 0, 0.01}), AllOf(HasSubstr("(zone 'base') faces up"), HasSubstr("another direction")));
    EXPECT_THAT(faces({0, -0.01, 0}), HasSubstr("faces sideways"));
    EXPECT_EQ(faces({0, 0, 0}), "") << "the pattern took a closed body";
    loads.closure = 1;  // the base alone: its outside is not known
    EXPECT_EQ(faces({0, 0, 0.01}), "");
    EXPECT_THAT(faces({0, -0.01, 0}), HasSubstr("faces sideways"));
    loads.dimension = 2;
    EXPECT_EQ(faces({0, -0.01, 0}), "");
}

TEST(OtherSizes, OneFileOfABatchInAnotherUnitIsTold) {
    // Lift over gaps that passes through nought, at two speeds.
    std::vector<ConditionedLoads> cases;
    for (const double speed : {0.1, 1.0}) {
        for (const double lift : {0.66, 0.4, 0.2, 0.01, -0.2}) {
            cases.push_back({"h" + std::to_string(cases.size()),
                             {{"gap", "0.001"}, {"speed", std::to_string(speed)}},
                             {lift * speed * speed, 0, 0}});
        }
    }
    EXPECT_TRUE(other_sizes(cases).empty());
    cases[1].loads[0] *= 1000;
    const auto found = other_sizes(cases);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].second, 1U);
    EXPECT_THAT(found[0].first.message, AllOf(HasSubstr("'h1' has forces 606 times"), HasSubstr("another unit")));
    EXPECT_EQ(odd_loads(cases).size(), 1U);
    cases[3].loads[0] = 0.004;  // no force near nought
    cases[8].loads[0] = 0.4;
    cases[1].loads[0] = 0.000002;  // 0.2 N at 1 m/s, read as of thousandths
    ASSERT_EQ(other_sizes(cases).size(), 1U);
    EXPECT_EQ(other_sizes(cases)[0].second, 1U);
    cases.resize(3);  // of three, two may as well be wrong
    EXPECT_TRUE(other_sizes(cases).empty());
}

TEST(SameLoads, OfCasesWithOtherConditionsAreToldAsCopies) {
    const std::vector<double> lift = {0.25, 0.6, 0, 0.08}, other = {0.2, 0.6, 0, 0.08}, nothing = {0, 0, 0, 0};
    const auto found = same_loads({{"h5", {{"gap", "0.005"}, {"time", "1"}}, lift},
                                   {"h6", {{"gap", "0.006"}}, other},
                                   {"h7", {{"gap", "0.007"}, {"time", "2"}}, lift},
                                   {"a", {{"gap", "1"}}, nothing},
                                   {"b", {{"gap", "2"}}, nothing}});
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].first.message,
              "'h5', 'h7' have the same loads to the last digit although their conditions differ (gap): is one file a "
              "copy of the other?");
    EXPECT_EQ(found[0].second, 2U);
    // A run that stands still gives the same at every time; one file named twice alike is no fault of its conditions.
    EXPECT_TRUE(same_loads({{"t1", {{"time", "1"}}, lift}, {"t2", {{"time", "2"}}, lift}}).empty());
    EXPECT_TRUE(same_loads({{"a", {{"gap", "1"}}, lift}, {"b", {{"gap", "1"}}, lift}}).empty());
}

TEST(SameLoads, OfManyCopiesAreGathered) {
    std::vector<ConditionedLoads> one, many;
    for (int i = 0; i < 40; ++i) {
        const std::string gap = std::to_string(i);
        one.push_back({"h" + gap, {{"gap", gap}}, {0.25, 0.6}});
        many.push_back({"h" + gap, {{"gap", gap}}, {0.1 * (i / 2) + 0.1, 0.6}});
    }
    const auto group = same_loads(one), groups = same_loads(many);
    ASSERT_EQ(group.size(), 1U);
    EXPECT_THAT(group[0].first.message, HasSubstr("'h4', 'h5' and 34 more have the same loads"));
    ASSERT_EQ(groups.size(), 6U);  // was: 20
    EXPECT_THAT(groups[5].first.message, HasSubstr("and 15 more groups of cases have the same loads"));
    EXPECT_EQ(groups[5].second, 39U);
}

}  // namespace
}  // namespace underbody::postproc
