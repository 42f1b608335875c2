#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"
#include "geometry/body/body_surface.h"
#include "geometry/water/placement.h"
#include "geometry/water/trim.h"

namespace underbody::geometry {
namespace {

MassProperties evie() {
    SurfaceOptions options;
    options.triangles = 4000;
    return mass_properties(make_surface(BodyShape{}, options));
}

Loading loading_of(const char* text) {
    const core::TomlTable root = core::read_toml_text(text, "shape.toml");
    Loading loading = *loading_from(root);
    root.finish();
    return loading;
}

TEST(Trim, OfAUniformBodyIsLevelAndIndifferent) {
    const MassProperties body = evie();
    const Trim t = trim(body, loading_of("[mass]\ndensity='998 kg/m^3'\n"));
    EXPECT_NEAR(t.net_weight, 0, 1e-12);
    EXPECT_NEAR(t.righting_stiffness, 0, 1e-12);
    EXPECT_TRUE(t.neutral);
    EXPECT_FALSE(t.stable);
    EXPECT_NEAR(t.inertia[1][1], 998 * body.inertia[1][1], 1e-12);
}

TEST(Trim, PutsTheCentreOfBuoyancyAboveTheCentreOfGravity) {
    const MassProperties body = evie();
    const Loading loading = loading_of(
        "[mass]\nhull='1.5 kg'\n[[mass.point]]\nname='battery'\nmass='0.7 kg'\nposition=['-20 mm','5 mm','12 mm']\n");
    const Trim t = trim(body, loading);
    EXPECT_TRUE(t.stable);
    EXPECT_NEAR(t.mass, 2.2, 1e-12);
    EXPECT_GT(t.pitch, 0) << "tail heavy: nose up";
    EXPECT_LT(t.roll, 0) << "heavy to port: port down";
    const Placement rest{0, t.pitch, t.roll};
    const Vec3 up = placed(t.centre_of_buoyancy, rest) - placed(t.centre_of_gravity, rest);
    EXPECT_NEAR(up.x, 0, 1e-12);
    EXPECT_NEAR(up.y, 0, 1e-12);
    EXPECT_NEAR(up.z * t.buoyancy, t.righting_stiffness, 1e-12);
}

TEST(Trim, FindsWhereTheBallastGivesAWantedTrim) {
    const MassProperties body = evie();
    Loading loading = loading_of(
        "[mass]\nhull='1.5 kg'\n[[mass.point]]\nname='ballast'\nmass='0.7 kg'\nposition=['0 mm','0 mm','10 mm']\n");
    const double pitch = -0.05, roll = 0.02;
    loading.points[0].position = ballast_position(body, loading, "ballast", pitch, roll);
    const Trim t = trim(body, loading);
    EXPECT_NEAR(t.pitch, pitch, 1e-12);
    EXPECT_NEAR(t.roll, roll, 1e-12);
    EXPECT_NEAR(t.pitch_moment(0), t.righting_stiffness * std::sin(pitch), 1e-4 * t.righting_stiffness);
    EXPECT_THROW(ballast_position(body, loading, "balast", 0, 0), core::InputError);
    try {
        ballast_position(body, loading, "ballast", 1.2, 0);
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.hint(), testing::HasSubstr("the nearest allowed trim"));
    }
}

TEST(Loading, RefusesNegativeMassesAndDoubleStatements) {
    EXPECT_THROW(loading_of("[mass]\nhull='-1 kg'\n"), core::InputError);
    EXPECT_THROW(loading_of("[mass]\nhull='1 kg'\ndensity='1 kg/m^3'\n"), core::InputError);
    EXPECT_THROW(loading_of("[mass]\nhul='1 kg'\n"), core::InputError);
}

}  // namespace
}  // namespace underbody::geometry
