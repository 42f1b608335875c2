// The picture set of real cases.
#include <gmock/gmock.h>

#include <cstdlib>

#include "core/error.h"
#include "core/file.h"
#include "postproc/field.h"
#include "postproc/views.h"
#include "tests/support/support.h"

namespace underbody::postproc {
namespace {

void keep(const View& view, const std::string& prefix) {
    if (const char* folder = std::getenv("UNDERBODY_PICTURES")) {
        core::write_file(std::filesystem::path(folder) / (prefix + view.name + ".png"), view.png);
    }
}

ViewOptions half_model() {
    ViewOptions options;
    options.symmetry = "y";
    options.case_name = "ellipse, gap 5 mm, pitch 0 deg, 0.5 m/s";
    return options;
}

TEST(ViewsOfASurface, ShowUnderbodyAndHull) {
    UNDERBODY_NEEDS_SHARED("cfd/fields/ellipse-h5-p0.csv");
    const Field field = read_field(test::shared_folder() / "cfd/fields/ellipse-h5-p0.csv");
    EXPECT_THAT(possible_views(field, half_model()), testing::ElementsAre("pressure-underbody", "pressure-hull", "shear-underbody"));
    for (const auto& view : views(field, half_model())) {
        EXPECT_THAT(view.png, testing::StartsWith("\x89PNG")) << view.name;
        EXPECT_GT(view.png.size(), 20000U) << view.name;
        EXPECT_LT(view.range.first, view.range.second);
        keep(view, "csv-");
    }
    EXPECT_THROW(view(field, "pressure-underbdy", half_model()), core::InputError);
}

TEST(ViewsOfAVolume, ShowTheSymmetryPlaneAndTheGap) {
    UNDERBODY_NEEDS_SHARED("cfd/volume/ellipse-h5-coarse.cas.gz");
    const Field field = read_field(test::shared_folder() / "cfd/volume/ellipse-h5-coarse.cas.gz");
    ViewOptions options = half_model();
    options.zones = {"base", "hull"};
    const auto made = views(field, options);
    std::vector<std::string> names;
    for (const auto& view : made) {
        names.push_back(view.name);
        keep(view, "volume-");
    }
    EXPECT_THAT(names, testing::IsSupersetOf({"pressure-underbody", "pressure-hull", "pressure-symmetry", "speed-symmetry", "streamlines-gap"}));
}

TEST(ViewsOfAPlaneCase, ShowItsCellsAndNoHull) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_cff/room.cas.h5");
    const Field field = read_field(test::shared_folder() / "samples/fluent_cff/room.cas.h5");
    EXPECT_THAT(possible_views(field), testing::ElementsAre("pressure-plane", "speed-plane"));
    const View pressure = view(field, "pressure-plane");
    EXPECT_GT(pressure.png.size(), 20000U);
    // Within the cells' -31.6 and 44.5 Pa (the reference lists them), a little less at the nodes between.
    EXPECT_NEAR(pressure.range.first, -31.6, 5);
    EXPECT_NEAR(pressure.range.second, 44.5, 1);
    keep(pressure, "room-");
}

TEST(ViewsOfAVolume, LeaveAGroundOutThatWouldHideTheBody) {
    UNDERBODY_NEEDS_SHARED("cfd/volume/ellipse-h5-coarse.cas.gz");
    ReadOptions surfaces;
    surfaces.surfaces_only = true;
    const Field field = read_field(test::shared_folder() / "cfd/volume/ellipse-h5-coarse.cas.gz", surfaces);
    ViewOptions named = half_model();
    named.zones = {"base", "hull"};
    EXPECT_EQ(view(field, "pressure-underbody", half_model()).png, view(field, "pressure-underbody", named).png);
}

TEST(ViewsOfTwoCases, ShareRangesAndShowTheirDifference) {
    UNDERBODY_NEEDS_SHARED("cfd/fields/ellipse-h5-p0-coarse.csv");
    const auto folder = test::shared_folder() / "cfd/fields";
    const Field coarse = read_field(folder / "ellipse-h5-p0-coarse.csv");
    const Field medium = read_field(folder / "ellipse-h5-p0.csv");
    ViewOptions options = half_model();
    options.case_name.clear();
    const ViewOptions shared = shared_view_options({&coarse, &medium}, options);
    const View a = view(coarse, "pressure-underbody", shared);
    const View b = view(medium, "pressure-underbody", shared);
    EXPECT_EQ(a.range, b.range);
    ASSERT_TRUE(shared.box);  // and the camera: both halves of both bodies
    EXPECT_NEAR((*shared.box)[2], -(*shared.box)[3], 1e-6);
    const View difference = difference_view(coarse, medium, "pressure", options);
    EXPECT_EQ(difference.range.first, -difference.range.second);
    EXPECT_LT(difference.range.second, 60);
    keep(difference, "");
    // A case less itself is nothing but rounding.
    EXPECT_LT(difference_view(medium, medium, "pressure", options).range.second, 1e-3);
}

}  // namespace
}  // namespace underbody::postproc
