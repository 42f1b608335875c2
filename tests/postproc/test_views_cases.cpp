// The picture set of real cases.
#include <gmock/gmock.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <cmath>
#include <cstdlib>

#include "core/error.h"
#include "core/file.h"
#include "postproc/field/field.h"
#include "postproc/loads/loads.h"
#include "postproc/views/view_composer.h"
#include "postproc/views/views.h"
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
    EXPECT_THAT(possible_views(field, half_model()),
                testing::ElementsAre("pressure-underbody", "pressure-hull", "shear-underbody"));
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
    EXPECT_THAT(names, testing::IsSupersetOf({"pressure-underbody", "pressure-hull", "pressure-symmetry",
                                              "speed-symmetry", "streamlines-gap"}));
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

TEST(ViewsOfAVolume, CutAlongTheSymmetryThatTheFileKnows) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_cff/mixing_elbow.cas.h5");
    const Field field = read_field(test::shared_folder() / "samples/fluent_cff/mixing_elbow.cas.h5");
    const View known = view(field, "speed-symmetry");
    EXPECT_THAT(known.caption, testing::StartsWith("The symmetry plane"));
    EXPECT_EQ(known.range.first, 0);  // at the walls the water stands still
    // Among the cells' values, 1.66 m/s at most; without that boundary it is the middle of the body that is cut.
    EXPECT_NEAR(known.range.second, 1.66, 0.1);
    Field without = field;
    std::erase_if(without.zones, [](const Zone& zone) { return zone.kind == ZoneKind::symmetry; });
    const View middle = view(without, "speed-symmetry");
    EXPECT_EQ(middle.title, "speed in the middle plane");
    EXPECT_NE(middle.png, known.png);
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

/// Half a box from y = 0 to `width`, 2 m long, over z = 0.1; pressure `level` + 3 x, wall shear of size 2 + y. `base`:
/// its lower side is a zone of its own. `from`: all moved along y, pressure and shear with it.
Field half_box(double width, double level, bool base = true, double from = 0) {
    const auto rows = [&](std::initializer_list<std::array<double, 3>> places) {
        std::string text =
            "X [ m ], Y [ m ], Z [ m ], Pressure [ Pa ], Wall Shear X [ Pa ], Wall Shear Y [ Pa ], Wall Shear Z [ Pa "
            "]\n";
        for (const auto& [x, share, z] : places) {
            text += std::to_string(x) + "," + std::to_string(from + share * width) + "," + std::to_string(z) + "," +
                    std::to_string(level + 3 * x) + "," + std::to_string(2 + share * width) + ",0,0\n";
        }
        return text;
    };
    std::string csv;
    if (base) {
        csv += "[Name]\nbase\n\n[Data]\n" + rows({{0, 0, 0.1}, {2, 0, 0.1}, {2, 1, 0.1}, {0, 1, 0.1}}) +
               "\n[Faces]\n0,3,2,1\n\n";
    }
    csv +=
        "[Name]\nhull\n\n[Data]\n" +
        rows({{0, 0, 0.1}, {2, 0, 0.1}, {2, 1, 0.1}, {0, 1, 0.1}, {0, 0, 0.6}, {2, 0, 0.6}, {2, 1, 0.6}, {0, 1, 0.6}}) +
        "\n[Faces]\n1,2,6,5\n2,3,7,6\n3,0,4,7\n4,5,6,7\n";
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "box.csv", csv);
    return read_field(folder.path() / "box.csv");
}

TEST(ViewsWithARange, TakeItByTheirNameOrByWhatTheyShow) {
    const Field field = half_box(0.5, 0);
    ViewOptions options;
    options.symmetry = "y";
    const auto range_of_shear = [&](std::vector<std::pair<std::string, std::pair<double, double>>> ranges) {
        options.ranges = std::move(ranges);
        return view(field, "shear-underbody", options).range;
    };
    EXPECT_EQ(range_of_shear({{"wall_shear", {0, 4}}}), std::pair(0.0, 4.0));
    EXPECT_EQ(range_of_shear({{"shear", {0, 5}}, {"pressure", {0, 1}}}), std::pair(0.0, 5.0));
    EXPECT_EQ(range_of_shear({{"shear-underbody", {1, 3}}, {"wall_shear", {0, 4}}}), std::pair(1.0, 3.0));
    EXPECT_NEAR(range_of_shear({{"pressure", {0, 1}}}).second, 2.5, 1e-12);
    try {
        range_of_shear({{"wal_shear", {0, 1}}});
        FAIL() << "accepted";
    } catch (const core::UsageError& error) {
        EXPECT_THAT(error.hint(), testing::HasSubstr("wall_shear"));
    }
    EXPECT_THROW(range_of_shear({{"shear", {2, 1}}}), core::UsageError);
}

TEST(ViewsOfASurface, ShowTheShearOfABodyWithoutABaseOnItsHull) {
    EXPECT_THAT(possible_views(half_box(0.5, 0, false)), testing::ElementsAre("pressure-hull", "shear-hull"));
}

ViewOptions with_symmetry(const std::string& symmetry) {
    ViewOptions options;
    options.symmetry = symmetry;
    return options;
}

ViewOptions of_zones(std::vector<std::string> zones) {
    ViewOptions options;
    options.zones = std::move(zones);
    return options;
}

std::string refusal(const Field& field, const std::string& symmetry) {
    try {
        view(field, "pressure-underbody", with_symmetry(symmetry));
    } catch (const core::Error& error) {
        return error.what();
    }
    return {};
}

TEST(ViewsOfAHalfModel, TakeTheirPlaneWithItsUnitOrWhereTheSurfaceIsOpen) {
    const Field field = half_box(0.5, 0, true, -1);
    const ViewOptions metres = with_symmetry("y=-1");
    const ViewOptions millimetres = with_symmetry("y=-1000 mm");
    const ViewOptions open = with_symmetry("y");  // nearer to 0 lies the other side
    const std::string png = view(field, "pressure-underbody", metres).png;
    EXPECT_EQ(png, view(field, "pressure-underbody", millimetres).png);
    EXPECT_EQ(png, view(field, "pressure-underbody", open).png);
    EXPECT_THAT(view(field, "pressure-underbody", open).caption, testing::HasSubstr("taken at y = -1 m"));
    EXPECT_THAT(view(field, "pressure-underbody", metres).caption, testing::Not(testing::HasSubstr("taken at")));
    EXPECT_THROW(view(field, "pressure-underbody", with_symmetry("q")), core::UsageError);
}

TEST(ViewsOfAHalfModel, RefuseAPlaneThatItDoesNotHave) {
    EXPECT_THAT(refusal(half_box(0.5, 0), "y=0.2"), testing::HasSubstr("both sides of y = 0.2 m"));
    EXPECT_THAT(refusal(half_box(0.5, 0, true, -0.25), "y"), testing::HasSubstr("both sides of y = 0 m"));
    EXPECT_THAT(refusal(half_box(0.5, 0), "y=-1"), testing::HasSubstr("open at y = 0 m"));
}

TEST(Views, RefuseAxesThatAreNone) {
    ViewOptions parallel;
    parallel.up = parallel.forward;
    EXPECT_THROW(view(half_box(0.5, 0), "pressure-underbody", parallel), core::UsageError);
}

TEST(Views, NameTheZoneThatIsMeant) {
    try {
        view(half_box(0.5, 0), "pressure-hull", of_zones({"base", "hul"}));
        FAIL() << "accepted";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("'hul'"));
        EXPECT_EQ(error.hint(), "did you mean 'hull'?");
    }
}

/// A box of 1 x 0.2 x 0.2 m, z from 0.1, with p = 100 z; a hatch of 0.2 x 0.08 m in its lower side is the base. A
/// ground under it.
Field box_with_a_small_base() {
    const auto rows = [](std::initializer_list<std::array<double, 3>> places) {
        std::string text = "X [ m ], Y [ m ], Z [ m ], Pressure [ Pa ]\n";
        for (const auto& [x, y, z] : places) {
            text += std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(z) + "," +
                    std::to_string(100 * z) + "\n";
        }
        return text;
    };
    const std::string csv =
        "[Name]\nbase\n\n[Data]\n" +
        rows({{-0.1, -0.04, 0.1}, {0.1, -0.04, 0.1}, {0.1, 0.04, 0.1}, {-0.1, 0.04, 0.1}}) + "\n[Faces]\n0,3,2,1\n\n" +
        "[Name]\nhull\n\n[Data]\n" +
        rows({{-0.1, -0.04, 0.1},
              {0.1, -0.04, 0.1},
              {0.1, 0.04, 0.1},
              {-0.1, 0.04, 0.1},
              {-0.5, -0.1, 0.1},
              {0.5, -0.1, 0.1},
              {0.5, 0.1, 0.1},
              {-0.5, 0.1, 0.1},
              {-0.5, -0.1, 0.3},
              {0.5, -0.1, 0.3},
              {0.5, 0.1, 0.3},
              {-0.5, 0.1, 0.3}}) +
        "\n[Faces]\n0,1,5,4\n1,2,6,5\n2,3,7,6\n3,0,4,7\n4,5,9,8\n5,6,10,9\n6,7,11,10\n7,4,8,11\n8,9,10,11\n\n" +
        "[Name]\nground\n\n[Data]\n" + rows({{-2, -1, 0}, {2, -1, 0}, {2, 1, 0}, {-2, 1, 0}}) + "\n[Faces]\n0,1,2,3\n";
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "box.csv", csv);
    return read_field(folder.path() / "box.csv");
}

TEST(ViewsOfASurface, ShowTheBodyThatLoadsAreSummedOver) {
    const Field field = box_with_a_small_base();
    const View hull = view(field, "pressure-hull");
    EXPECT_NEAR(hull.range.first, 10, 1e-9);
    EXPECT_NEAR(hull.range.second, 30, 1e-9);
    EXPECT_EQ(hull.png, view(field, "pressure-hull", of_zones({"base", "hull"})).png);
    EXPECT_NEAR(view(field, "pressure-hull", of_zones({"*"})).range.first, 0, 1e-9);  // what is named is shown
    std::vector<std::string> summed;
    for (const auto& zone : loads(field).zones) {
        summed.push_back(zone.name);
    }
    EXPECT_THAT(summed, testing::ElementsAre("base", "hull"));
}

Field without_shear_on_base() {
    Field field = half_box(0.5, 0);
    Zone& base = field.zones.front();
    base.surface->GetPointData()->RemoveArray("wall_shear");
    std::erase_if(base.arrays, [](const ArrayInfo& info) { return info.name == "wall_shear"; });
    return field;
}

TEST(ViewsOfASurface, TakeTheirColoursFromWhatIsDrawn) {
    const View shear = view(without_shear_on_base(), "shear-underbody", with_symmetry("y"));
    EXPECT_NEAR(shear.range.first, 2, 1e-9);
    EXPECT_NEAR(shear.range.second, 2.5, 1e-9);
    EXPECT_THAT(shear.caption, testing::HasSubstr("The base has no wall shear"));
    Field nothing = half_box(0.5, 0);
    for (auto& zone : nothing.zones) {
        zone.surface->GetPointData()->GetArray("wall_shear")->Fill(std::nan(""));
    }
    EXPECT_THAT(possible_views(nothing, with_symmetry("y")), testing::Not(testing::Contains("shear-underbody")));
}

TEST(ViewsOfASurface, PassOverPointsThatNoFaceHas) {
    Field field = half_box(0.5, 0);
    const View clean = view(field, "pressure-hull", with_symmetry("y"));
    for (auto& zone : field.zones) {
        zone.surface->GetPoints()->InsertNextPoint(9, 9, 9);
        zone.surface->GetPointData()->GetArray("pressure")->InsertNextTuple1(1000);
        const double none[3] = {0, 0, 0};
        zone.surface->GetPointData()->GetArray("wall_shear")->InsertNextTuple(none);
        zone.surface->Modified();
    }
    const View stray = view(field, "pressure-hull", with_symmetry("y"));
    EXPECT_EQ(stray.range, clean.range);
    EXPECT_EQ(stray.png, clean.png);
}

TEST(TellingRange, NamesTheEndThatWasCut) {
    const auto said = [](double low, double high) {
        std::vector<double> values(1000);
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = 0.001 * static_cast<double>(i);
        }
        values.front() = low;
        values.back() = high;
        std::string text;
        robust_colour_range(values, text, "Pa");
        return text;
    };
    EXPECT_EQ(said(0, 1), "");
    EXPECT_EQ(said(-9, 1), " Colours begin at the 1st percentile; the lowest is -9 Pa.");
    EXPECT_EQ(said(0, 8), " Colours end at the 99th percentile; the highest is 8 Pa.");
    EXPECT_EQ(said(-9, 8), " Colours end at the 1st and 99th percentile; the extremes are -9 and 8 Pa.");
}

TEST(ViewsOfTwoCases, KeepTheRangeOfAViewBesideThatOfItsArray) {
    const Field a = half_box(0.5, 0);
    const Field b = half_box(0.5, 7);
    ViewOptions options = with_symmetry("y");
    options.ranges = {{"pressure-hull", {-50, 50}}, {"pressure", {-10, 10}}};
    const ViewOptions shared = shared_view_options({&a, &b}, options);
    EXPECT_EQ(view(a, "pressure-hull", shared).range, std::pair(-50.0, 50.0));
    EXPECT_EQ(view(a, "pressure-underbody", shared).range, std::pair(-10.0, 10.0));
    EXPECT_NEAR(view(a, "shear-underbody", shared).range.second, 2.5, 1e-9);  // computed
}

TEST(ViewsOfTwoCases, TakeARangeForTheirDifferenceAlone) {
    const Field a = half_box(0.5, 0);
    const Field b = half_box(0.5, 7);
    const auto with = [&](const std::string& key) {
        ViewOptions options = with_symmetry("y");
        options.ranges = {{key, {-3, 3}}};
        return difference_view(a, b, "pressure", options).range;
    };
    EXPECT_EQ(with("difference"), std::pair(-3.0, 3.0));
    EXPECT_EQ(with("difference-pressure"), std::pair(-3.0, 3.0));
    for (const char* key : {"pressure", "difference-nosuch", "difference-wall_shear"}) {
        EXPECT_THROW(with(key), core::UsageError) << key;
    }
    ViewOptions options = with_symmetry("y");
    options.ranges = {{"difference", {-3, 3}}};
    EXPECT_THROW(view(a, "pressure-hull", options), core::UsageError);
}

TEST(ViewsOfTwoCases, SayThatSizesAreCompared) {
    const View shear = difference_view(half_box(0.5, 0), half_box(0.5, 0), "wall_shear", with_symmetry("y"));
    EXPECT_EQ(shear.title, "difference of the size of wall shear on the underbody");
    EXPECT_THAT(shear.caption, testing::HasSubstr("not their directions"));
    EXPECT_EQ(difference_view(half_box(0.5, 0), half_box(0.5, 0), "pressure", with_symmetry("y")).title,
              "difference of pressure on the underbody");
}

TEST(ViewsOfTwoCases, BringPressuresToOneReference) {
    using Kind = PressureReference::Kind;
    Field gauge = half_box(0.5, 0);
    Field absolute = half_box(0.5, 101330);
    const auto range = [&] { return difference_view(gauge, absolute, "pressure", with_symmetry("y")); };
    const View unknown = range();
    EXPECT_GT(unknown.range.second, 1e5);
    EXPECT_THAT(unknown.caption, testing::HasSubstr("is one of the two an absolute pressure?"));
    gauge.pressure = {Kind::gauge, 101325};
    absolute.pressure = {Kind::absolute, 0};
    EXPECT_NEAR(range().range.second, 5, 1e-6);
    EXPECT_THAT(range().caption, testing::HasSubstr("101325 Pa were added to the pressures of the first case"));
    gauge.pressure.operating_pressure = 0;
    EXPECT_THROW(range(), core::InputError);
    absolute.pressure = {Kind::gauge, 1000};
    gauge.pressure.operating_pressure = 102325;
    EXPECT_NEAR(range().range.second, 5, 1e-6);
}

TEST(ViewsOfTwoCases, CompareWhereTheBodiesMeet) {
    ViewOptions options;
    options.symmetry = "y";
    // As wide: 2 Pa everywhere. Twice as wide: the planes of symmetry lie on each other all the same.
    const View same = difference_view(half_box(0.5, 1), half_box(0.5, 3), "pressure", options);
    EXPECT_THAT(same.caption, testing::Not(testing::HasSubstr("grey where")));
    EXPECT_NEAR(same.range.second, 2, 1e-6);
    const View wider = difference_view(half_box(0.25, 1), half_box(0.5, 3), "pressure", options);
    EXPECT_THAT(wider.caption, testing::HasSubstr("moved by (0, 0, 0) mm"));
    EXPECT_THAT(wider.caption, testing::HasSubstr("grey where"));
    EXPECT_NEAR(wider.range.second, 2, 1e-6);
}

// Several in one range of colours, which is known before anything is drawn; one that cannot be says why.
TEST(ViewsOfTwoCases, DrawSeveralDifferencesInOneRange) {
    const Field first = half_box(0.5, 0);
    const Field little = half_box(0.5, 2);
    const Field much = half_box(0.5, 9);
    const Field elsewhere = [&] {
        Field field = half_box(0.5, 1);
        for (auto& zone : field.zones) {
            zone.surface->GetPointData()->Initialize();
            zone.surface->GetCellData()->Initialize();
            zone.arrays.clear();
        }
        return field;
    }();
    const auto views = difference_views(first, {&little, &much, &elsewhere}, "pressure", with_symmetry("y"));
    ASSERT_EQ(views.size(), 3U);
    ASSERT_TRUE(views[0].view && views[1].view);
    EXPECT_NEAR(views[0].view->range.second, 9, 1e-6);
    EXPECT_EQ(views[0].view->range, views[1].view->range);
    EXPECT_EQ(views[1].view->png, difference_view(first, much, "pressure", with_symmetry("y")).png);
    EXPECT_FALSE(views[2].view);
    EXPECT_THAT(views[2].why, testing::HasSubstr("not on the surface of both"));
    ViewOptions given = with_symmetry("y");
    given.ranges = {{"difference", {-3, 3}}};
    EXPECT_EQ(difference_views(first, {&little, &much}, "pressure", given)[0].view->range, std::pair(-3.0, 3.0));
}

// The named cameras look along the vehicle's axes, however these lie in the file.
TEST(ViewsOfASurface, AreSeenFromWhereItIsAsked) {
    using Point = std::array<double, 3>;
    const Point forward = {0, -1, 0}, up = {0, 0, 1};  // starboard is forward x up = (-1, 0, 0)
    EXPECT_EQ(named_camera("bottom", forward, up).towards, up);
    EXPECT_EQ(named_camera("side", forward, up).towards, (Point{1, 0, 0}));
    EXPECT_EQ(named_camera("front", forward, up).towards, (Point{0, 1, 0}));
    EXPECT_EQ(named_camera("top", forward, up).up, (Point{1, 0, 0}));
    for (const auto& name : camera_names()) {
        const NamedCamera camera = named_camera(name, forward, up);
        EXPECT_NEAR(dot(camera.towards, camera.towards), 1, 1e-12) << name;
        EXPECT_LT(std::abs(dot(camera.towards, camera.up)), 0.5) << name;
    }
    EXPECT_THROW(named_camera("botom", forward, up), core::UsageError);
    const Field field = half_box(0.5, 0);
    ViewOptions options = with_symmetry("y");
    const View usual = view(field, "pressure-hull", options);
    options.camera = "front";
    const View front = view(field, "pressure-hull", options);
    EXPECT_NE(front.png, usual.png);
    EXPECT_THAT(front.caption, testing::HasSubstr("seen from ahead"));
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
