// The surface of few faces that stands in for one of many while it is turned.
#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkStaticCellLocator.h>

#include "postproc/views/stand_in.h"
#include "tests/postproc/made_zones.h"

namespace underbody::postproc {
namespace {

/// How far the points of one surface lie from the other, at most.
double farthest(vtkPolyData& points, vtkPolyData& surface) {
    vtkNew<vtkStaticCellLocator> locator;
    locator->SetDataSet(&surface);
    locator->BuildLocator();
    double most = 0;
    for (vtkIdType i = 0; i < points.GetNumberOfPoints(); ++i) {
        std::array<double, 3> at{}, nearest{};
        points.GetPoint(i, at.data());
        vtkIdType cell = 0;
        int part = 0;
        double square = 0;
        locator->FindClosestPoint(at.data(), nearest.data(), cell, part, square);
        most = std::max(most, square);
    }
    return std::sqrt(most);
}

/// A fine surface, x from -0.1 to 0.1 m: a picture of it is a thousand pixels wide.
Zone fine(bool half, const std::function<void(double*)>& bend = {}, int rings = 300) {
    Zone zone = ellipsoid(
        rings, {0.1, 0.07, 0.05}, [](const Vector& p) { return 1000 * p[0]; }, half);
    auto* points = zone.surface->GetPoints();
    for (vtkIdType i = 0; bend && i < points->GetNumberOfPoints(); ++i) {
        double at[3];
        points->GetPoint(i, at);
        bend(at);
        points->SetPoint(i, at);
    }
    return zone;
}

/// With flat sides, edges and corners as sharp as the faces are small: the stand-in's are sharper.
void to_box(double* at) {
    const double most = std::max({std::abs(at[0]) / 0.1, std::abs(at[1]) / 0.07, std::abs(at[2]) / 0.05});
    for (int i = 0; i < 3; ++i) {
        at[i] /= most;
    }
}

// Two pixels of a thousand, for round bodies, rims of half models, edges and corners.
TEST(StandIn, LiesWithinTwoPixelsOfTheSurface) {
    const double two_pixels = 2 * 0.2 / 1000;
    for (const auto& [name, zone] : {std::pair{"round", fine(false)},
                                     {"half", fine(true)},
                                     {"box", fine(false, to_box, 480)},
                                     {"half box", fine(true, to_box)}}) {
        const double size = stand_in_size({zone.surface}, 60000);
        EXPECT_GT(size, 3 * two_pixels) << "the cubes alone would do";
        const auto fewer = stand_in(*zone.surface, size);
        EXPECT_LT(fewer->GetNumberOfCells(), 80000) << name;
        EXPECT_GT(fewer->GetNumberOfCells(), 30000) << name;
        EXPECT_LT(farthest(*zone.surface, *fewer), two_pixels) << name;
        EXPECT_LT(farthest(*fewer, *zone.surface), two_pixels) << name;
    }
}

TEST(StandIn, KeepsValuesOnPointsAndOnFaces) {
    Zone zone = fine(false);
    vtkNew<vtkFloatArray> of_faces;
    of_faces->SetName("number");
    for (vtkIdType i = 0; i < zone.surface->GetNumberOfCells(); ++i) {
        of_faces->InsertNextValue(static_cast<float>(zone.surface->GetCell(i)->GetBounds()[1]));
    }
    zone.surface->GetCellData()->AddArray(of_faces);
    const double size = stand_in_size({zone.surface}, 20000);
    const auto fewer = stand_in(*zone.surface, size);
    auto* pressure = fewer->GetPointData()->GetArray("pressure");
    auto* number = fewer->GetCellData()->GetArray("number");
    ASSERT_TRUE(pressure != nullptr && number != nullptr);
    ASSERT_EQ(pressure->GetNumberOfTuples(), fewer->GetNumberOfPoints());
    ASSERT_EQ(number->GetNumberOfTuples(), fewer->GetNumberOfCells());
    EXPECT_EQ(fewer->GetPointData()->GetArray("wall_shear")->GetNumberOfComponents(), 3);
    for (vtkIdType i = 0; i < fewer->GetNumberOfPoints(); ++i) {
        EXPECT_NEAR(pressure->GetComponent(i, 0), 1000 * fewer->GetPoint(i)[0], 1000 * size);
    }
    for (vtkIdType i = 0; i < fewer->GetNumberOfCells(); ++i) {
        const double* box = fewer->GetCell(i)->GetBounds();
        EXPECT_NEAR(number->GetComponent(i, 0), 0.5 * (box[0] + box[1]), 2.5 * size);
    }
}

// Of an ellipsoid: along the gradient of its equation.
TEST(StandIn, NormalsAreThoseOfTheSurface) {
    const Zone zone = fine(false);
    const auto smooth = with_normals(*zone.surface);
    EXPECT_EQ(smooth->GetPoints(), zone.surface->GetPoints()) << "not copied";
    EXPECT_EQ(smooth->GetPolys(), zone.surface->GetPolys());
    auto* normals = smooth->GetPointData()->GetNormals();
    ASSERT_TRUE(normals != nullptr && zone.surface->GetPointData()->GetNormals() == nullptr);
    for (vtkIdType i = 2000; i < smooth->GetNumberOfPoints() - 2000; i += 97) {  // points at the poles are many in one
        const double* at = smooth->GetPoint(i);
        std::array<double, 3> along = {at[0] / 0.01, at[1] / 0.0049, at[2] / 0.0025};
        const double length = std::hypot(along[0], along[1], along[2]);
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(normals->GetComponent(i, k), along[static_cast<std::size_t>(k)] / length, 0.02);
        }
    }
}

TEST(StandIn, IsCancelledAndTakesNothingForNothing) {
    Zone zone = fine(false);
    core::Progress progress;
    progress.cancel();
    EXPECT_THROW(static_cast<void>(stand_in(*zone.surface, 0.001, progress)), core::Cancelled);
    vtkNew<vtkPolyData> empty;
    EXPECT_EQ(stand_in(*empty, 0.001)->GetNumberOfCells(), 0);
}

// Faces that share no point (a file of triangles alone) have no rim between them.
TEST(StandIn, FacesThatShareNoPointsHaveNoRim) {
    Zone zone = fine(false, to_box);
    vtkNew<vtkPolyData> soup;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> faces;
    for (vtkIdType i = 0; i < zone.surface->GetNumberOfCells(); ++i) {
        vtkIdType count = 0;
        const vtkIdType* corners = nullptr;
        zone.surface->GetCellPoints(i, count, corners);
        faces->InsertNextCell(static_cast<int>(count));
        for (vtkIdType k = 0; k < count; ++k) {
            faces->InsertCellPoint(points->InsertNextPoint(zone.surface->GetPoint(corners[k])));
        }
    }
    soup->SetPoints(points);
    soup->SetPolys(faces);
    const auto fewer = stand_in(*soup, stand_in_size({soup}, 60000));
    EXPECT_LT(farthest(*zone.surface, *fewer), 2 * 0.2 / 1000);
}

}  // namespace
}  // namespace underbody::postproc
