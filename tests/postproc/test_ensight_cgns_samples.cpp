// Real EnSight and CGNS files against numbers from independent scripts.
#include <gmock/gmock.h>
#include <vtkCellType.h>
#include <vtkPointData.h>

#include "import_support.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using postproc::ReadOptions;
using ::testing::HasSubstr;

TEST(EnsightSamples, FluentsExportHasItsPartsAndPressures) {
    UNDERBODY_NEEDS_SHARED("samples/ensight/CylinderCrossflow");
    const auto field = read_field(test::shared_folder() / "samples/ensight/CylinderCrossflow/cylinder_Re35.case");
    EXPECT_EQ(field.format, "EnSight Gold");
    EXPECT_EQ(field.dimension, 2);
    const auto* fluid = field.find("fluid");
    ASSERT_NE(fluid, nullptr);
    EXPECT_EQ(fluid->volume->GetNumberOfPoints(), 14831);
    EXPECT_EQ(test::count_cells(*fluid->volume, VTK_TRIANGLE), 39);
    EXPECT_EQ(test::count_cells(*fluid->volume, VTK_QUAD), 14555);
    double range[2] = {};
    fluid->volume->GetPointData()->GetArray("pressure")->GetRange(range);
    EXPECT_NEAR(range[0], -724.72412, 1e-4);
    EXPECT_NEAR(range[1], 1050.97864, 1e-4);
    EXPECT_NE(field.find("wall_cylinder"), nullptr);
}

TEST(EnsightSamples, OpenFoamsPressureWaitsForItsUnit) {
    UNDERBODY_NEEDS_SHARED("cfd/volume/ensight/expc.case");
    const auto path = test::shared_folder() / "cfd/volume/ensight/expc.case";
    const auto field = read_field(path);
    EXPECT_EQ(test::cells_of(field), 57280);
    ASSERT_NE(field.find("hull"), nullptr);
    EXPECT_EQ(field.find("hull")->find("pressure"), nullptr);
    EXPECT_EQ(field.find("hull")->surface->GetNumberOfCells(), 1360);
    EXPECT_THAT(field.problems.front().message, HasSubstr("option 'unit p=m^2/s^2'"));
    ASSERT_NE(field.find("hull")->find("p (unit not stated)"), nullptr);
    EXPECT_EQ(field.find("hull")->find("p (unit not stated)")->original_name, "p");  // what loads asks for by its name
    ReadOptions options;
    options.units = {{"p", "m^2/s^2"}};
    const auto stated = read_field(path, options);
    EXPECT_NE(stated.find("hull")->find("kinematic_pressure"), nullptr);
    // The same mesh as the Fluent files beside it, in single precision.
    const auto fluent = read_field(test::shared_folder() / "cfd/volume/ellipse-h5-coarse.cas.gz");
    EXPECT_NEAR(test::volume_of(field) / test::volume_of(fluent), 1, 1e-5);
}

TEST(CgnsSamples, AStructuredWingComesWithItsWalls) {
    UNDERBODY_NEEDS_SHARED("samples/cgns/mdolab_717_wl_L2.cgns");
    const auto field = read_field(test::shared_folder() / "samples/cgns/mdolab_717_wl_L2.cgns");
    EXPECT_EQ(field.format, "CGNS");
    EXPECT_EQ(test::cells_of(field), 2 * 6480 + 3 * 720);
    int walls = 0;
    for (const auto& zone : field.zones) {
        walls += zone.kind == postproc::ZoneKind::wall ? 1 : 0;
        EXPECT_TRUE(zone.surface == nullptr || zone.normals_into_fluid) << zone.name;
        if (zone.volume != nullptr) {
            EXPECT_GT(test::smallest_volume(*zone.volume), 0) << zone.name;
        }
    }
    EXPECT_EQ(walls, 5);
}

}  // namespace underbody
