// Real legacy files against numbers from independent scripts (shared/samples/REFERENCE.md).
#include <gmock/gmock.h>
#include <vtkCellType.h>

#include "import_support.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using postproc::ReadOptions;
using postproc::ZoneKind;
using ::testing::HasSubstr;

namespace {

struct Sample {
    const char* file;
    int dimension;
    long long cells;
    double volume;
};

// No mixed kinds here: those are looked at one by one below.
const Sample samples[] = {
    {"catalytic_converter_param.cas", 3, 29260 + 5320, 0.000583660728320 + 0.000548895886891},
    {"plate.cas.gz", 3, 3025, 48.12},
    {"mixer-ran_2019r3.cas.gz", 3, 860 + 13075, 32.0522527197},
    {"vki_turbine.cas.gz", 3, 64800, 0.00127070749799},
    {"elbow_introdemo.cas.gz", 3, 45637, 0.0205023142307},
    {"hex.cas", 3, 216, 3.2768e-05},
    {"hex.msh", 3, 216, 3.2768e-05},
    {"StaticMixer.msh", 3, 30748 + 18580, 33.3067936343},
    {"axial_comp.msh", 3, 6080 + 7776, 6.7339715e-05 + 2.55474622e-05},
    {"pro_species.cas", 2, 800, 0.000199999991},
    {"cylinder_tutorial.cas", 2, 25100 + 640, 899.215409043},
    {"lid_driven_cavity.msh", 2, 3550, 1.0},
    {"cav.msh", 2, 3525, 0.000312320038620},
    {"flap.msh", 2, 30 + 4450, 3e-05 + 0.00197},
    {"solid.msh", 2, 585, 0.00593408654182},
    {"gascomb.msh", 2, 1615, 404959.999791},
};

std::filesystem::path sample(const char* name) { return test::shared_folder() / "samples/fluent_legacy" / name; }

}  // namespace

TEST(FluentLegacySamples, AllHaveTheCellsAndTheVolumeOfTheReference) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_legacy");
    for (const auto& [file, dimension, cells, volume] : samples) {
        SCOPED_TRACE(file);
        const auto field = read_field(sample(file));
        EXPECT_EQ(field.dimension, dimension);
        EXPECT_EQ(test::cells_of(field), cells);
        EXPECT_NEAR(test::volume_of(field), volume, 4e-9 * volume);
        for (const auto& zone : field.zones) {
            if (zone.volume != nullptr) {
                EXPECT_GT(test::smallest_volume(*zone.volume), 0) << zone.name;
            }
        }
        for (const auto& problem : field.problems) {
            EXPECT_THAT(problem.message, ::testing::Not(HasSubstr("not closed"))) << problem.message;
            EXPECT_THAT(problem.message, ::testing::Not(HasSubstr("no positive volume"))) << problem.message;
        }
    }
}

TEST(FluentLegacySamples, KindsOfCellsAreTheSolversOwn) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_legacy");
    const auto mixer = read_field(sample("mixer-ran_2019r3.cas.gz"));
    ASSERT_NE(mixer.find("fluid"), nullptr);
    EXPECT_EQ(test::count_cells(*mixer.find("fluid")->volume, VTK_POLYHEDRON), 13075);
    EXPECT_EQ(test::count_cells(*mixer.find("fluid")->volume, VTK_HEXAHEDRON), 860);
    const auto turbine = read_field(sample("vki_turbine.cas.gz"));
    EXPECT_EQ(test::count_cells(*turbine.find("fluid")->volume, VTK_WEDGE), 64800);
    const auto flap = read_field(sample("flap.msh"));
    ASSERT_NE(flap.find("solid.5"), nullptr);
    EXPECT_EQ(flap.find("solid.5")->kind, ZoneKind::fluid);
    EXPECT_EQ(test::count_cells(*flap.find("solid.5")->volume, VTK_QUAD), 30);
    EXPECT_EQ(test::count_cells(*flap.find("fluid.4")->volume, VTK_TRIANGLE), 4450);
}

TEST(FluentLegacySamples, ZonesHaveTheirNamesAndTheirOwnPoints) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_legacy");
    const auto field = read_field(sample("vki_turbine.cas.gz"));
    const auto* blade = field.find("wall-blade");
    ASSERT_NE(blade, nullptr);
    EXPECT_EQ(blade->kind, ZoneKind::wall);
    EXPECT_EQ(blade->surface->GetNumberOfCells(), 0x3160 - 0x26c1 + 1);
    EXPECT_LT(blade->surface->GetNumberOfPoints(), blade->surface->GetNumberOfCells() * 2);
    EXPECT_EQ(field.find("inlet")->kind, ZoneKind::inlet);
    EXPECT_EQ(field.find("interface-a")->kind, ZoneKind::interface);
    EXPECT_EQ(field.pressure.kind, postproc::PressureReference::Kind::gauge);
    EXPECT_THAT(field.writer, HasSubstr("fluent21.2.0"));
}

TEST(FluentLegacySamples, ADamagedDataFileIsRefusedWithAReason) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_legacy");
    const std::string reason = test::refusal(sample("cylinder_tutorial.dat"));
    EXPECT_THAT(reason, HasSubstr("cylinder_tutorial.dat (byte "));
    EXPECT_THAT(reason, HasSubstr("bytes were lost or added"));
    EXPECT_THAT(reason, HasSubstr("understood so far"));
    // The case itself is whole; it says that the data beside it are not used.
    const auto field = read_field(sample("cylinder_tutorial.cas"));
    EXPECT_THAT(field.problems.front().message + field.problems.back().message, HasSubstr("not used"));
    // Data of another case.
    ReadOptions options;
    options.companion = sample("hex.cas");
    EXPECT_THAT(test::refusal(sample("cylinder_tutorial.dat"), options), HasSubstr("belong to another case"));
}

TEST(FluentLegacySamples, SurfacesAloneAreTheSameSurfaces) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_legacy");
    ReadOptions alone;
    alone.surfaces_only = true;
    for (const char* file : {"mixer-ran_2019r3.cas.gz", "hex.cas", "flap.msh", "vki_turbine.cas.gz"}) {
        const auto whole = read_field(sample(file));
        const auto surfaces = read_field(sample(file), alone);
        EXPECT_EQ(test::cells_of(surfaces), 0);
        for (const auto& zone : whole.zones) {
            if (zone.surface != nullptr) {
                const auto* same = surfaces.find(zone.name);
                ASSERT_NE(same, nullptr) << zone.name;
                EXPECT_EQ(same->surface->GetNumberOfPoints(), zone.surface->GetNumberOfPoints());
                EXPECT_EQ(test::area_of(*same->surface), test::area_of(*zone.surface)) << zone.name;
            }
        }
    }
}

TEST(FluentLegacySamples, FaceValuesGiveTheSolversForces) {
    UNDERBODY_NEEDS_SHARED("cfd/volume/ellipse-h5-coarse.cas.gz");
    const auto field = read_field(test::shared_folder() / "cfd/volume/ellipse-h5-coarse.cas.gz");
    EXPECT_EQ(test::cells_of(field), 57280);
    EXPECT_EQ(field.files.size(), 2U);
    test::Triple force{};
    for (const char* name : {"base", "hull"}) {
        const auto* zone = field.find(name);
        ASSERT_NE(zone, nullptr);
        ASSERT_NE(zone->find("pressure"), nullptr);
        EXPECT_EQ(zone->find("pressure")->on, postproc::Location::faces);
        const auto part = test::pressure_force(*zone->surface);
        for (std::size_t k = 0; k < 3; ++k) {
            force[k] += 2 * part[k];
        }
    }
    const auto csv = read_field(test::shared_folder() / "cfd/volume/ellipse-h5-coarse.dat.gz");
    EXPECT_EQ(test::cells_of(csv), 57280);
    // Pressure parts of the solver's own forces on the whole body (shared/cfd/forces.csv), x forward, z up.
    EXPECT_NEAR(force[2], 0.26721, 0.001 * 0.26721);
    EXPECT_NEAR(-force[0], 0.59656, 0.001 * 0.59656);
}

}  // namespace underbody
