// What says that a model is half of a body, and the times of a field.
#include <gtest/gtest.h>

#include "postproc/field/times.h"
#include "postproc/loads/half_model.h"
#include "tests/postproc/made_zones.h"

namespace underbody::postproc {
namespace {

Zone plane_across_y(const std::string& name, double at, ZoneKind kind) {
    Zone zone = make_zone(name, {{-1, at, -1}, {1, at, -1}, {1, at, 1}, {-1, at, 1}}, {{0, 1, 2, 3}},
                          [](const Vector&) { return 0.0; });
    zone.kind = kind;
    return zone;
}

Field half_body() {
    Zone body = ellipsoid(
        8, {0.2, 0.1, 0.05}, [](const Vector&) { return 0.0; }, true);
    body.kind = ZoneKind::wall;
    return field_of({body, plane_across_y("sym", 0, ZoneKind::symmetry)});
}

TEST(LikelyHalf, IsThePlaneThatHasTheBodyOnOneSide) {
    const auto found = likely_half(half_body());
    ASSERT_TRUE(found);
    EXPECT_EQ(found->symmetry, "y");
    EXPECT_EQ(found->zone, "sym");
    // The plane of a body that stands elsewhere is said with its place.
    Zone hull = plane_across_y("hull", 0.3, ZoneKind::wall);
    const auto moved = likely_half(field_of({hull, plane_across_y("sym", 0.25, ZoneKind::symmetry)}));
    ASSERT_TRUE(moved);
    EXPECT_EQ(moved->symmetry, "y=0.25");
}

TEST(LikelyHalf, IsNothingOfAChannelOrAWholeBody) {
    Field channel = half_body();
    channel.zones.push_back(plane_across_y("far side", 2, ZoneKind::symmetry));
    EXPECT_FALSE(likely_half(channel)) << "two planes";
    Field whole = half_body();
    whole.zones.front() = ellipsoid(8, {0.2, 0.1, 0.05}, [](const Vector&) { return 0.0; });
    whole.zones.front().kind = ZoneKind::wall;
    EXPECT_FALSE(likely_half(whole)) << "the body on both sides";
    Field none = half_body();
    none.zones.back().kind = ZoneKind::wall;
    EXPECT_FALSE(likely_half(none));
    Field flat = half_body();
    flat.dimension = 2;
    EXPECT_FALSE(likely_half(flat));
}

TEST(StatedTimes, ReadBackRisingAndOnce) {
    Field field;
    EXPECT_TRUE(stated_times(field).empty());
    state_times(field, {0.5, 0.1, 1.0 / 3, 0.1});
    EXPECT_EQ(stated_times(field), (std::vector<double>{0.1, 1.0 / 3, 0.5}));
    EXPECT_EQ(field.metadata.front(), (std::pair<std::string, std::string>("times", "3 from 0.1 to 0.5")));
}

}  // namespace
}  // namespace underbody::postproc
