// Real Fluent HDF5 files against numbers from independent scripts (shared/samples/REFERENCE.md).
#include <gmock/gmock.h>
#include <vtkCellType.h>

#include "import_support.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using postproc::ReadOptions;
using ::testing::HasSubstr;

namespace {

std::filesystem::path sample(const char* name) { return test::shared_folder() / "samples/fluent_cff" / name; }

void expect_near(const test::Triple& found, const test::Triple& wanted, double tolerance) {
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(found[k], wanted[k], tolerance) << "component " << k;
    }
}

}  // namespace

TEST(FluentHdf5Samples, TheElbowHasTheReferenceForcesAndFluxes) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_cff/mixing_elbow.cas.h5");
    const auto field = read_field(sample("mixing_elbow.cas.h5"));
    EXPECT_EQ(field.format, "Fluent HDF5");
    EXPECT_EQ(field.files.size(), 2U);
    const auto* fluid = field.find("elbow-fluid");
    ASSERT_NE(fluid, nullptr);
    EXPECT_EQ(test::count_cells(*fluid->volume, VTK_HEXAHEDRON), 729);
    EXPECT_EQ(test::count_cells(*fluid->volume, VTK_POLYHEDRON), 17093);
    EXPECT_NEAR(test::volume_of(*fluid->volume), 0.0025006551, 1e-10);
    const auto p = test::range_of(*fluid->volume, "pressure");
    EXPECT_NEAR(p.low, -0.34598957, 1e-8);
    EXPECT_NEAR(p.high, 1.14612080, 1e-8);
    const auto* wall = field.find("wall-elbow");
    ASSERT_NE(wall, nullptr);
    EXPECT_EQ(wall->surface->GetNumberOfCells(), 2168);
    EXPECT_NEAR(test::area_of(*wall->surface), 0.0992274, 1e-7);
    expect_near(test::pressure_force(*wall->surface), {0.006362, -0.005935, 0.015525}, 1e-6);
    expect_near(test::viscous_force(*wall->surface), {3.48169e-4, 6.88041e-4, -6.73424e-5}, 1e-9);
    ASSERT_NE(wall->find("y_plus"), nullptr);
    const auto y_plus = test::range_of(*wall->surface, "y_plus");
    EXPECT_NEAR(y_plus.low, 0.3028, 1e-4);
    EXPECT_NEAR(y_plus.high, 8.004, 1e-3);
    const auto* inlet = field.find("wall-inlet");
    EXPECT_EQ(inlet->surface->GetNumberOfCells(), 268);
    expect_near(test::pressure_force(*inlet->surface), {7.98872e-5, -4.69288e-6, 1.612299e-3}, 1e-8);
    expect_near(test::viscous_force(*inlet->surface), {1.01311e-6, 7.09139e-5, 4.2214e-7}, 1e-10);
    EXPECT_NEAR(test::sum_of(*field.find("cold-inlet")->surface, "mass_flux"), -0.00476708, 1e-8);
    EXPECT_NEAR(test::sum_of(*field.find("hot-inlet")->surface, "mass_flux"), -0.000347077, 1e-9);
    EXPECT_NEAR(test::sum_of(*field.find("outlet")->surface, "mass_flux"), 0.00511418, 1e-8);
    EXPECT_EQ(field.pressure.kind, postproc::PressureReference::Kind::gauge);
}

TEST(FluentHdf5Samples, TheRoomHasTheReferenceForcesInTwoDimensions) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_cff/room.cas.h5");
    // From the data's side: the case is found by its name.
    const auto field = read_field(sample("room.dat.h5"));
    EXPECT_EQ(field.dimension, 2);
    EXPECT_EQ(test::cells_of(field), 4338);
    EXPECT_NEAR(test::volume_of(field), 8.8, 1e-6);
    const test::Triple pressure[] = {{5.256426, -21.461583, 0}, {-0.140667, 0, 0}, {-5.188832, 0, 0}};
    const test::Triple viscous[] = {{-0.006197, 0.087926, 0}, {0, -0.342234, 0}, {0, 0.406985, 0}};
    int found = 0;
    for (const auto& zone : field.zones) {
        if (zone.id >= 4 && zone.id <= 6 && zone.surface != nullptr) {
            const auto i = static_cast<std::size_t>(zone.id - 4);
            expect_near(test::pressure_force(*zone.surface), pressure[i], 2e-6);
            expect_near(test::viscous_force(*zone.surface), viscous[i], 2e-6);
            ++found;
        }
        if (zone.kind == postproc::ZoneKind::fluid) {
            const auto p = test::range_of(*zone.volume, "pressure");
            EXPECT_NEAR(p.low, -31.612629, 1e-5);
            EXPECT_NEAR(p.high, 44.531178, 1e-5);
        }
    }
    EXPECT_EQ(found, 3);
}

TEST(FluentHdf5Samples, TheSprayCaseHasItsForcesAndTheMassThatTheSprayAdds) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_cff/FFF.cas.h5");
    const auto field = read_field(sample("FFF.cas.h5"));
    EXPECT_EQ(test::cells_of(field), 1344);
    EXPECT_NEAR(test::volume_of(field), 6.0000005e-05, 1e-12);
    double in = 0;
    double out = 0;
    for (const auto& zone : field.zones) {
        if (zone.id == 6 && zone.surface != nullptr) {
            expect_near(test::pressure_force(*zone.surface), {0.004962, 0.021957, 0}, 1e-6);
            expect_near(test::viscous_force(*zone.surface), {0.007643623, 8.3394e-7, 0}, 1e-9);
        }
        if (zone.kind == postproc::ZoneKind::inlet) {
            in += test::sum_of(*zone.surface, "mass_flux");
        }
        if (zone.kind == postproc::ZoneKind::outlet) {
            out += test::sum_of(*zone.surface, "mass_flux");
        }
    }
    EXPECT_NEAR(in, -0.000771331, 1e-9);
    EXPECT_NEAR(out, 0.00109133, 1e-8);
}

TEST(FluentHdf5Samples, AMeshInSeveralPartsIsOneMesh) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_cff/simple-duct.msh.h5");
    const auto field = read_field(sample("simple-duct.msh.h5"));
    EXPECT_EQ(test::cells_of(field), 10);
    EXPECT_NEAR(test::volume_of(field), 10, 1e-6);
    EXPECT_NE(field.find("symm"), nullptr);
}

TEST(FluentHdf5Samples, OnlyTheArraysAskedForAreRead) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_cff/mixing_elbow.cas.h5");
    ReadOptions options;
    options.arrays = {"pressure", "wall_shear"};
    options.surfaces_only = true;
    const auto field = read_field(sample("mixing_elbow.cas.h5"), options);
    EXPECT_EQ(test::cells_of(field), 0);
    const auto* wall = field.find("wall-elbow");
    ASSERT_NE(wall, nullptr);
    EXPECT_EQ(wall->arrays.size(), 2U);
    expect_near(test::viscous_force(*wall->surface), {3.48169e-4, 6.88041e-4, -6.73424e-5}, 1e-9);
}

TEST(FluentHdf5Samples, DataOfAnotherCaseAreRefused) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_cff/mixing_elbow.cas.h5");
    ReadOptions options;
    options.companion = sample("FFF.dat.h5");
    EXPECT_THAT(test::refusal(sample("room.cas.h5"), options), HasSubstr("another case"));
    options.companion = sample("room.cas.h5");
    EXPECT_THAT(test::refusal(sample("mixing_elbow.dat.h5"), options), HasSubstr("another case"));
}

}  // namespace underbody
