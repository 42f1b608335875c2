// Where the plane of a half model lies.
#include <gmock/gmock.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include "postproc/field/surface_arrays.h"
#include "postproc/loads/mirror_plane.h"
#include "tests/support/support.h"

namespace underbody::postproc {
namespace {

/// A box of 2 x 1 x 0.5 m that begins at y = `from`, open there or not, and below where there is no `bottom`.
vtkSmartPointer<vtkPolyData> box(double from, bool open, bool bottom = true) {
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (int i = 0; i < 8; ++i) {
        points->InsertNextPoint(2 * (i & 1), from + ((i >> 1) & 1), 0.5 * (i >> 2));
    }
    vtkNew<vtkCellArray> faces;
    faces->InsertNextCell({0, 4, 6, 2});
    faces->InsertNextCell({1, 3, 7, 5});
    faces->InsertNextCell({2, 6, 7, 3});
    faces->InsertNextCell({4, 5, 7, 6});
    if (bottom) {
        faces->InsertNextCell({0, 2, 3, 1});
    }
    if (!open) {
        faces->InsertNextCell({0, 1, 5, 4});
    }
    surface->SetPoints(points);
    surface->SetPolys(faces);
    return surface;
}

struct Placed {
    double at = 0;
    std::size_t problems = 0;
};

Placed placed(const std::string& symmetry, const vtkSmartPointer<vtkPolyData>& surface) {
    const SurfaceArrays arrays(*surface);
    core::Problems problems;
    const PlacedMirror mirror = place_mirror(mirror_plane_from(symmetry), {&arrays}, {}, problems);
    return {mirror.at, problems.size()};
}

TEST(MirrorPlane, LiesWhereItWasSaidOrWhereTheSurfaceIsOpen) {
    EXPECT_EQ(placed("y", box(0, true)).at, 0);
    EXPECT_EQ(placed("y", box(1e-4, true)).at, 0);  // rounding
    EXPECT_EQ(placed("y=0.3", box(0.3, true)).problems, 0U);
    const Placed known = placed("y", box(0.3, true));
    EXPECT_DOUBLE_EQ(known.at, 0.3);
    EXPECT_EQ(known.problems, 1U);
    EXPECT_DOUBLE_EQ(placed("y", box(-3, true)).at, -3);  // the closed end is nearer to 0
    EXPECT_DOUBLE_EQ(placed("y", box(-3, true, false)).at, -3);
    EXPECT_DOUBLE_EQ(placed("y", box(-3, false)).at, -2);
}

TEST(MirrorPlane, HasTheBodyOnOneSideAndAtItsOpening) {
    EXPECT_THROW(placed("y", box(-0.5, true)), core::InputError);
    EXPECT_THROW(placed("y=0.5", box(0, true)), core::InputError);
    EXPECT_THROW(placed("y=-1", box(0, true)), core::InputError);
    EXPECT_THROW(placed("y=1", box(0, true)), core::InputError) << "its closed side";
}

TEST(MirrorPlane, LiesOffAClosedBodyThatIsOneOfTwo) {
    EXPECT_EQ(placed("y=-1", box(0, false)).at, -1);
    EXPECT_EQ(placed("y=-1", box(0, false, false)).at, -1);  // its base was not named
}

}  // namespace
}  // namespace underbody::postproc
