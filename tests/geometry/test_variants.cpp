#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"
#include "core/file.h"
#include "geometry/body/body_report.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/variants.h"
#include "geometry/mesh/mesh_file.h"
#include "tests/support/support.h"

namespace underbody::geometry {
namespace {

const char* const body_text =
    "[body]\nlength='203.2 mm'\nwidth='152 mm'\nheight='145 mm'\nbase_cut=0.75\nbase='rectangle'\n";

VariantSet set_of(const core::TemporaryFolder& folder, const std::string& text) {
    core::write_file(folder.path() / "bumps.toml", body_text + text);
    return read_variants(folder.path() / "bumps.toml");
}

TEST(Variants, AreAllCombinationsWithTies) {
    const core::TemporaryFolder folder;
    const VariantSet set = set_of(folder,
                                  "[[vary]]\nkey='protrusion.height'\nvalues=['1 mm','2 mm']\n"
                                  "[[vary]]\nkey='body.base_cut'\nfrom=0.7\nto=0.8\ncount=3\n"
                                  "[[tie]]\nkey='protrusion.length'\nof='protrusion.height'\nfactor=5\n");
    ASSERT_EQ(set.variants.size(), 6u);
    EXPECT_EQ(set.variants[4].name, "bumps-005");
    EXPECT_DOUBLE_EQ(set.variants[4].shape.base_cut, 0.75);
    EXPECT_DOUBLE_EQ(set.variants[4].shape.protrusion->length, 0.01);
    EXPECT_DOUBLE_EQ(set.variants[0].shape.protrusion->length, 0.005);
    EXPECT_EQ(set.variants[0].values[0], "1 mm");
}

TEST(Variants, FindsEqualShapesAndKeepsTheReasonOfARefusal) {
    const core::TemporaryFolder folder;
    VariantSet set = set_of(folder, "[[vary]]\nkey='body.edge_radius'\nvalues=['1 mm','0.1 cm','500 mm']\n");
    EXPECT_EQ(set.variants[1].same_as, "bumps-001");
    EXPECT_THAT(set.variants[2].refused, testing::HasSubstr("body.edge_radius is 500 mm"));
    const auto made = make_variants(set, 2000);
    EXPECT_TRUE(made[0].certificate.passed());
    EXPECT_TRUE(made[1].mesh.triangles.empty());
    const core::Table rows = table(set, made);
    EXPECT_EQ(rows.rows(), 3u);
    EXPECT_EQ(rows.text("same_as")[1], "bumps-001");
    EXPECT_DOUBLE_EQ(rows.numbers("body.edge_radius")[2], 0.5) << "numbers with their unit, for plots";
    EXPECT_NEAR(rows.numbers("volume")[0], 0.002226, 1e-4);
}

TEST(Variants, RefuseUnknownParametersAndTiesOfOtherKinds) {
    const core::TemporaryFolder folder;
    EXPECT_THROW(set_of(folder, ""), core::InputError);
    EXPECT_THROW(set_of(folder, "[[vary]]\nkey='body.widht'\nvalues=['1 mm']\n"), core::InputError);
    EXPECT_THROW(
        set_of(folder, "[[vary]]\nkey='body.taper'\nvalues=[0.1]\n[[tie]]\nkey='body.taper'\nof='body.width'\n"),
        core::InputError);
}

TEST(Comparison, SaysWhatDiffersAndByHowMuch) {
    BodyShape a;
    a.base = BaseKind::rectangle;
    BodyShape b = a;
    b.protrusion = Protrusion{};
    const Comparison c = compare(a, b, 8000);
    EXPECT_FALSE(c.equal);
    EXPECT_NEAR(c.largest_distance, 0.002, 2e-5) << "the height of the bump";
    // half a lens 10 mm long and 2 mm high, 59 mm wide
    EXPECT_NEAR(c.volume_b - c.volume_a, 0.9e-6, 0.15e-6);
    EXPECT_TRUE(compare(a, a, 1000).equal);
    EXPECT_LT(compare(a, a, 1000).largest_distance, 1e-9);
}

TEST(BodyReport, RefusesAnOpenSurfaceWithTheHolesPlace) {
    const core::TemporaryFolder folder;
    SurfaceOptions options;
    options.triangles = 1000;
    SurfaceMesh mesh = make_surface(BodyShape{}, options);
    mesh.triangles.pop_back();
    mesh.patch.pop_back();
    write_mesh(mesh, folder.path() / "open.stl");
    BodyOptions reading;
    reading.unit = "m";
    try {
        read_body(folder.path() / "open.stl", reading);
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_EQ(error.kind(), "surface");
        EXPECT_THAT(error.what(), testing::HasSubstr("open edge at ("));
    }
}

TEST(BodyReport, RefusesAPitchThatPushesTheNoseThroughTheGround) {
    BodyOptions options;
    options.triangles = 3000;
    options.panels = 0;
    options.placement = Placement{0.005, -0.1, 0};
    try {
        read_body(test::source_folder() / "cases/evie/shapes/ellipse.toml", options);
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_EQ(error.kind(), "contact");
        // asin(5 mm / 67.2 mm) = 4.267 deg
        EXPECT_THAT(error.hint(), testing::HasSubstr("-4.26"));
    }
    options.placement = Placement{0.005, 0, 0};
    const Body body = read_body(test::source_folder() / "cases/evie/shapes/ellipse.toml", options);
    EXPECT_NEAR(*body.contact->nose_up, std::asin(0.005 / 0.067202), 2e-5);
    EXPECT_NEAR(*body.contact->roll, std::asin(0.005 / 0.050269), 1e-4);
}

}  // namespace
}  // namespace underbody::geometry
