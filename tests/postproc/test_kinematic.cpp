#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include "postproc/field/kinematic.h"

namespace underbody::postproc {
namespace {

Field kinematic_field() {
    Zone zone;
    zone.name = "base";
    zone.surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->InsertNextPoint(0, 0, 0);
    points->InsertNextPoint(1, 0, 0);
    points->InsertNextPoint(0, 1, 0);
    vtkNew<vtkCellArray> cells;
    cells->InsertNextCell({0, 1, 2});
    vtkNew<vtkDoubleArray> pressure;
    pressure->SetName("kinematic_pressure");
    pressure->InsertNextValue(0.25);
    zone.surface->SetPoints(points);
    zone.surface->SetPolys(cells);
    zone.surface->GetCellData()->AddArray(pressure);
    zone.arrays = {{"kinematic_pressure", "m^2/s^2", "p", "", Location::faces, 1}};
    Field field;
    field.zones = {zone};
    return field;
}

TEST(Kinematic, PressureBecomesPascal) {
    Field field = kinematic_field();
    const vtkSmartPointer<vtkDoubleArray> kept =
        vtkDoubleArray::SafeDownCast(field.zones[0].surface->GetCellData()->GetArray("kinematic_pressure"));
    EXPECT_TRUE(is_kinematic(field));
    multiply_by_density(field, 1000);
    EXPECT_FALSE(is_kinematic(field));
    EXPECT_EQ(field.zones[0].find("pressure")->unit, "Pa");
    EXPECT_EQ(field.zones[0].surface->GetCellData()->GetArray("pressure")->GetComponent(0, 0), 250);
    EXPECT_EQ(field.zones[0].surface->GetCellData()->GetArray("kinematic_pressure"), nullptr);
    EXPECT_EQ(kept->GetValue(0), 0.25);
}

TEST(Kinematic, TheGivenDensityCountsBeforeTheFilesOwn) {
    Field unknown = kinematic_field();
    EXPECT_FALSE(bring_to_pascal(unknown, {}));
    EXPECT_NE(unknown.zones[0].find("kinematic_pressure"), nullptr);
    for (const bool given : {false, true}) {
        Field field = kinematic_field();
        field.density = 1000;
        EXPECT_TRUE(bring_to_pascal(field, given ? std::optional<double>(800) : std::nullopt));
        EXPECT_EQ(field.zones[0].surface->GetCellData()->GetArray("pressure")->GetComponent(0, 0), given ? 200 : 250);
    }
}

}  // namespace
}  // namespace underbody::postproc
