// What CGNS files say of their numbers: units, classes of data, conversions.
#include <gmock/gmock.h>
#include <vtkCellData.h>
#include <vtkPointData.h>

#include "cgns_files.h"
#include "core/file.h"
#include "import_support.h"
#include "postproc/loads/loads.h"

namespace underbody {

using postproc::read_field;
using test::CgnsWriter;
using test::told;
using ::testing::HasSubstr;
using ::testing::Not;

namespace {

namespace fs = std::filesystem;

void state_units(CGNS_ENUMT(LengthUnits_t) length, CGNS_ENUMT(TemperatureUnits_t) temperature) {
    CgnsWriter::ok(cg_units_write(CGNS_ENUMV(Kilogram), length, CGNS_ENUMV(Second), temperature, CGNS_ENUMV(Radian)));
}

double value_of(const postproc::Field& field, const char* array) {
    return field.find("water")->volume->GetPointData()->GetArray(array)->GetTuple1(0);
}

/// A cube with one variable of 20 everywhere; `more` writes what the file says of it.
template <typename More>
postproc::Field cube_of(const char* variable, const postproc::ReadOptions& options, More&& more) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns");
        file.add_cube("water");
        file.solution("Sol", CGNS_ENUMV(Vertex), variable, std::vector<double>(8, 20));
        more(file);
    }
    return read_field(folder.path() / "a.cgns", options);
}

void go_to_variable(const CgnsWriter& file) {
    CgnsWriter::ok(cg_goto(file.file, file.base, "Zone_t", file.zone, "FlowSolution_t", 1, "DataArray_t", 1, "end"));
}

}  // namespace

TEST(CgnsUnits, TemperaturesHaveTheUnitThatTheFileStates) {
    const auto read = [](CGNS_ENUMT(TemperatureUnits_t) unit, bool at_base) {
        return value_of(cube_of("Temperature", {},
                                [&](const CgnsWriter& file) {
                                    at_base ? CgnsWriter::ok(cg_goto(file.file, file.base, "end"))
                                            : go_to_variable(file);
                                    state_units(CGNS_ENUMV(Meter), unit);
                                }),
                        "temperature");
    };
    for (const bool at_base : {true, false}) {
        EXPECT_NEAR(read(CGNS_ENUMV(Kelvin), at_base), 20, 1e-9);
        EXPECT_NEAR(read(CGNS_ENUMV(Celsius), at_base), 293.15, 1e-9);
        EXPECT_NEAR(read(CGNS_ENUMV(Fahrenheit), at_base), (20 + 459.67) * 5 / 9, 1e-9);
        EXPECT_NEAR(read(CGNS_ENUMV(Rankine), at_base), 20.0 * 5 / 9, 1e-9);
    }
}

TEST(CgnsUnits, NormalisedValuesAreConvertedAsTheFileSays) {
    for (const bool single : {false, true}) {
        const auto field = cube_of("Pressure", {}, [&](const CgnsWriter& file) {
            go_to_variable(file);
            CgnsWriter::ok(cg_dataclass_write(CGNS_ENUMV(NormalizedByDimensional)));
            const std::array<double, 2> factors = {50000, 7};
            const std::array<float, 2> small = {50000, 7};
            CgnsWriter::ok(single ? cg_conversion_write(CGNS_ENUMV(RealSingle), small.data())
                                  : cg_conversion_write(CGNS_ENUMV(RealDouble), factors.data()));
        });
        EXPECT_NEAR(value_of(field, "pressure"), 1000007, 1e-6);
        EXPECT_THAT(told(field), Not(HasSubstr("no dimensions")));
    }
    const auto unsaid = cube_of("Pressure", {}, [](const CgnsWriter& file) {
        go_to_variable(file);
        CgnsWriter::ok(cg_dataclass_write(CGNS_ENUMV(NormalizedByDimensional)));
    });
    EXPECT_THAT(told(unsaid), HasSubstr("Pressure has no dimensions (NormalizedByDimensional without a conversion)"));
}

TEST(CgnsUnits, AClassBelowTheBaseCounts) {
    const auto of_zone = cube_of("Pressure", {}, [](const CgnsWriter& file) {
        CgnsWriter::ok(cg_goto(file.file, file.base, "end"));
        state_units(CGNS_ENUMV(Millimeter), CGNS_ENUMV(Kelvin));
        CgnsWriter::ok(cg_goto(file.file, file.base, "Zone_t", file.zone, "end"));
        CgnsWriter::ok(cg_dataclass_write(CGNS_ENUMV(NormalizedByUnknownDimensional)));
    });
    EXPECT_THAT(
        told(of_zone),
        HasSubstr(
            "CoordinateX, CoordinateY, CoordinateZ, Pressure have no dimensions (NormalizedByUnknownDimensional)"));
    EXPECT_EQ(value_of(of_zone, "pressure"), 20);
    EXPECT_NEAR(test::volume_of(of_zone), 1, 1e-12);
    // Of the whole file, but not of the pressure.
    const auto all_but_one = cube_of("Pressure", {}, [](const CgnsWriter& file) {
        CgnsWriter::ok(cg_goto(file.file, file.base, "end"));
        CgnsWriter::ok(cg_dataclass_write(CGNS_ENUMV(NondimensionalParameter)));
        go_to_variable(file);
        CgnsWriter::ok(cg_dataclass_write(CGNS_ENUMV(Dimensional)));
    });
    EXPECT_THAT(told(all_but_one), HasSubstr("CoordinateX, CoordinateY, CoordinateZ have no dimensions"));
    // What has no dimensions anyway is nothing to tell.
    const auto mach = cube_of("Mach", {}, [](const CgnsWriter& file) {
        go_to_variable(file);
        CgnsWriter::ok(cg_dataclass_write(CGNS_ENUMV(NondimensionalParameter)));
    });
    EXPECT_THAT(told(mach), Not(HasSubstr("no dimensions")));
}

TEST(CgnsUnits, WhatTheUserStatesReplacesWhatTheFileStates) {
    const auto in_millimetres = [](const CgnsWriter& file) {
        CgnsWriter::ok(cg_goto(file.file, file.base, "end"));
        state_units(CGNS_ENUMV(Millimeter), CGNS_ENUMV(Kelvin));
    };
    postproc::ReadOptions options;
    EXPECT_NEAR(value_of(cube_of("VelocityX", options, in_millimetres), "velocity_x"), 0.02, 1e-15);
    options.units = {{"VelocityX", "mm/s"}};
    EXPECT_NEAR(value_of(cube_of("VelocityX", options, in_millimetres), "velocity_x"), 0.02, 1e-15);
    options.units = {{"velocityx", "mm/s"}};
    EXPECT_NEAR(value_of(cube_of("VelocityX", options, in_millimetres), "velocity_x"), 0.02, 1e-15);
    options.units = {{"VelocityX", "km/h"}};
    EXPECT_NEAR(value_of(cube_of("VelocityX", options, in_millimetres), "velocity_x"), 20 / 3.6, 1e-12);
}

TEST(CgnsUnits, ALengthUnitIsTakenWhereTheFileStatesNone) {
    postproc::ReadOptions options;
    options.length_unit = "mm";
    EXPECT_NEAR(test::volume_of(cube_of("Pressure", options, [](const CgnsWriter&) {})), 1e-9, 1e-18);
    EXPECT_NEAR(test::volume_of(cube_of("Pressure", options,
                                        [](const CgnsWriter& file) {
                                            CgnsWriter::ok(cg_goto(file.file, file.base, "end"));
                                            state_units(CGNS_ENUMV(Meter), CGNS_ENUMV(Kelvin));
                                        })),
                1, 1e-12);
}

TEST(CgnsUnits, AZoneWithoutAllItsCoordinatesIsRefused) {
    const core::TemporaryFolder folder;
    for (const std::size_t axes : {0U, 2U}) {
        const fs::path path = folder.path() / "a.cgns";
        {
            CgnsWriter file(path);
            file.add_zone("water", {}, 1);
            int index = 0;
            const auto x = CgnsWriter::cube_nodes();
            const char* names[] = {"CoordinateX", "CoordinateZ"};
            for (std::size_t k = 0; k < axes; ++k) {
                CgnsWriter::ok(cg_coord_write(file.file, file.base, file.zone, CGNS_ENUMV(RealDouble), names[k],
                                              x[k].data(), &index));
            }
        }
        EXPECT_THAT(test::refusal(path), HasSubstr(axes == 0 ? "no coordinates" : "no CoordinateY"));
    }
}

TEST(CgnsUnits, APlaneCaseInSpaceIsTwoDimensional) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns", 2, 3);
        file.add_zone("water", {{{0, 1, 1, 0}, {0, 0, 1, 1}, {0, 0, 0, 0}}}, 1);
        file.section("cells", CGNS_ENUMV(QUAD_4), {1, 2, 3, 4}, 4);
        file.section("wall", CGNS_ENUMV(BAR_2), {1, 2, 2, 3, 3, 4, 4, 1}, 2);
        file.solution("Sol", CGNS_ENUMV(Vertex), "Pressure", {0, 0, 1, 1});
    }
    const auto field = read_field(folder.path() / "a.cgns");
    EXPECT_EQ(field.dimension, 2);
    postproc::LoadsOptions options;
    options.zones = {"wall"};
    EXPECT_NEAR(std::abs(postproc::loads(field, options).total.force[1]), 1, 1e-12);
}

}  // namespace underbody
