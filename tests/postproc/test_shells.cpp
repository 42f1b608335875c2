// Connected parts of a surface: by nodes, by places, with their values.
#include <gmock/gmock.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <cmath>

#include "core/parallel.h"
#include "postproc/field/connected_components.h"

namespace underbody::postproc {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Triangles of a fan around (at, 0, 0); `own` nodes for each, or one list for all.
void add_fan(vtkPolyData& surface, double at, int triangles, bool own) {
    vtkPoints& points = *surface.GetPoints();
    const auto rim = [&](int i) { return points.InsertNextPoint(at + std::cos(i), std::sin(i), 0); };
    vtkIdType middle = points.InsertNextPoint(at, 0, 0);
    vtkIdType last = rim(0);
    for (int i = 1; i <= triangles; ++i) {
        const vtkIdType next = rim(i);
        surface.GetPolys()->InsertNextCell({middle, last, next});
        if (own && i < triangles) {
            middle = points.InsertNextPoint(at, 0, 0);
            last = rim(i);
        } else {
            last = next;
        }
    }
}

vtkSmartPointer<vtkPolyData> empty_surface() {
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    surface->SetPoints(points);
    vtkNew<vtkCellArray> faces;
    surface->SetPolys(faces);
    return surface;
}

std::vector<std::uint32_t> parts_of(vtkPolyData& surface) {
    const SurfaceArrays arrays(surface);
    return ConnectedFaces(arrays).parts();
}

bool leaves_points_out(vtkPolyData& surface) {
    const SurfaceArrays arrays(surface);
    return ConnectedFaces(arrays).leaves_points_out();
}

TEST(ConnectedFaces, AreOnePartWhereTheyShareNodesOrPlaces) {
    for (const bool own : {false, true}) {
        const auto surface = empty_surface();
        add_fan(*surface, 0, 5, own);
        EXPECT_THAT(parts_of(*surface), IsEmpty()) << own;
        EXPECT_FALSE(leaves_points_out(*surface)) << own;
        surface->GetPoints()->InsertNextPoint(7, 7, 7);  // of no face
        EXPECT_TRUE(leaves_points_out(*surface)) << own;
        EXPECT_THAT(parts_of(*surface), IsEmpty()) << own;
    }
    EXPECT_THAT(parts_of(*empty_surface()), IsEmpty());
}

TEST(ConnectedFaces, AreNumberedInTheirOrder) {
    const auto surface = empty_surface();
    add_fan(*surface, 0, 2, true);
    add_fan(*surface, 5, 1, false);
    add_fan(*surface, 0, 1, false);  // of the first again, by its places
    EXPECT_THAT(parts_of(*surface), ElementsAre(0, 0, 1, 0));
}

TEST(ConnectedFaces, AreTheSameWithAnyNumberOfThreads) {
    // Strips of triangles, many blocks of faces long, each strip a part; their faces take turns.
    constexpr std::uint32_t strips = 7;
    constexpr vtkIdType length = 60000;
    const auto surface = empty_surface();
    for (vtkIdType i = 0; i < length; ++i) {
        for (std::uint32_t s = 0; s < strips; ++s) {
            surface->GetPoints()->InsertNextPoint(double(i / 2), double(i % 2) + 10.0 * s, 0);
        }
    }
    for (vtkIdType i = 0; i + 2 < length; ++i) {
        for (vtkIdType s = 0; s < strips; ++s) {
            surface->GetPolys()->InsertNextCell({strips * i + s, strips * (i + 1) + s, strips * (i + 2) + s});
        }
    }
    for (const int threads : {1, 2, 5, 0}) {
        core::set_threads(threads);
        const auto parts = parts_of(*surface);
        ASSERT_EQ(parts.size(), strips * (length - 2));
        for (std::size_t f = 0; f < parts.size(); ++f) {
            ASSERT_EQ(parts[f], f % strips) << threads;
        }
    }
    core::set_threads(0);
}

TEST(SurfaceOfFaces, BringsItsPointsAndValuesAlong) {
    const auto surface = empty_surface();
    add_fan(*surface, 0, 2, false);
    add_fan(*surface, 5, 2, false);
    vtkNew<vtkDoubleArray> x;
    x->SetName("x");
    for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
        x->InsertNextValue(surface->GetPoint(i)[0]);
    }
    vtkNew<vtkDoubleArray> number;
    number->SetName("number");
    for (const double value : {10.0, 11.0, 12.0, 13.0}) {
        number->InsertNextValue(value);
    }
    surface->GetPointData()->AddArray(x);
    surface->GetCellData()->AddArray(number);
    const auto part = surface_of_faces(*surface, SurfaceArrays(*surface), std::vector<std::size_t>{3, 0});
    ASSERT_EQ(part->GetNumberOfPolys(), 2);
    EXPECT_EQ(part->GetNumberOfPoints(), 6);
    EXPECT_EQ(part->GetCellData()->GetArray("number")->GetTuple1(0), 13);
    EXPECT_EQ(part->GetCellData()->GetArray("number")->GetTuple1(1), 10);
    for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i) {
        EXPECT_EQ(part->GetPointData()->GetArray("x")->GetTuple1(i), part->GetPoint(i)[0]);
    }
}

}  // namespace
}  // namespace underbody::postproc
