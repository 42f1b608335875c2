// Names of arrays: each once, vectors only whole, in all formats alike.
#include <gmock/gmock.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <fstream>

#include "core/file.h"
#include "postproc/field/names.h"
#include "postproc/field/vtk_files.h"
#include "postproc/importers/mesh/array_names.h"
#include "postproc/importers/mesh/element_zone.h"
#include "postproc/importers/mesh/zone_values.h"

namespace underbody::postproc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> names_of(const std::vector<ArrayPlan>& plans) {
    std::vector<std::string> names;
    for (const auto& plan : plans) {
        names.push_back(plan.name);
    }
    return names;
}

std::vector<std::string> names_in(const Zone& zone) {
    std::vector<std::string> names;
    for (const auto& info : zone.arrays) {
        names.push_back(info.name);
    }
    return names;
}

TEST(ArrayNames, PlainSpellingsComeBeforeOthers) {
    EXPECT_EQ(spelling_rank("pressure", "pressure"), 0);
    EXPECT_EQ(spelling_rank("Pressure", "pressure"), 1);
    EXPECT_EQ(spelling_rank("Velocity X", "velocity_x"), 1);
    EXPECT_LT(spelling_rank("Pressure", "pressure"), spelling_rank("SV_P", "pressure"));
    EXPECT_LT(spelling_rank("Static Pressure", "pressure"), spelling_rank("Solved Pressure", "pressure"));
    EXPECT_LT(spelling_rank("Velocity u", "velocity_x"), spelling_rank("Water Velocity X", "velocity_x"));
}

TEST(ArrayNames, OfOneMeaningThePlainestHasTheNameAndAllKeepOne) {
    std::vector<ArrayPlan> plans = {{"Solved Pressure", "pressure"},
                                    {"Pressure", "pressure"},
                                    {"PRESSURE", "pressure"},
                                    {"", ""},
                                    {"T", "temperature"}};
    core::Problems problems;
    settle_names(plans, {}, problems);
    EXPECT_THAT(names_of(plans), ElementsAre("Solved Pressure", "pressure", "PRESSURE (2)", "", "temperature"));
    ASSERT_EQ(problems.size(), 2U);
    EXPECT_EQ(problems[0].message,
              "'Solved Pressure' and 'Pressure' both mean pressure: that is 'Pressure' here, the other is kept as "
              "'Solved Pressure'");
    settle_names(plans, {}, problems);
    EXPECT_EQ(problems.size(), 2U);
}

TEST(ArrayNames, VectorsAreMadeOfAllTheirComponents) {
    const auto joined = [](std::vector<std::string> names, int dimension, std::size_t warnings,
                           const std::vector<std::string>& wanted = {}) {
        std::vector<ArrayPlan> plans;
        for (const auto& name : names) {
            plans.push_back({name, name});
        }
        core::Problems problems;
        ReadOptions options;
        options.arrays = wanted;
        join_components(plans, dimension, options, {}, problems);
        EXPECT_EQ(problems.size(), warnings);
        return names_of(plans);
    };
    EXPECT_THAT(joined({"velocity_z", "velocity_x", "velocity_y"}, 3, 0),
                ElementsAre("velocity", "velocity", "velocity"));
    EXPECT_THAT(joined({"velocity_x", "velocity_y"}, 3, 1), ElementsAre("velocity_x", "velocity_y"));
    EXPECT_THAT(joined({"velocity_x", "velocity_y"}, 2, 0), ElementsAre("velocity", "velocity"));
    EXPECT_THAT(joined({"velocity_x", "velocity_z"}, 2, 1), ElementsAre("velocity_x", "velocity_z"));
    EXPECT_THAT(joined({"velocity_x"}, 3, 0, {"velocity_x"}), ElementsAre("velocity_x"));
    EXPECT_THAT(joined({"velocity_x", "velocity_y"}, 3, 1, {"vel*"}), ElementsAre("velocity_x", "velocity_y"));
    // A vector that the file has is not made again.
    EXPECT_THAT(joined({"velocity", "velocity_x", "velocity_y", "velocity_z"}, 3, 0),
                ElementsAre("velocity", "velocity_x", "velocity_y", "velocity_z"));
}

// ---- values on ids (Fluent, OpenFOAM) ----

ValueBlock block(const std::string& variable, double value) {
    ValueBlock values;
    values.variable = variable;
    values.on_cells = true;
    values.count = 2;
    values.values.grow_to(2);
    values.values.fill(value);
    return values;
}

struct Filled {
    Zone zone;
    vtkNew<vtkCellData> data;
    core::Problems problems;
};

void fill(Filled& out, std::vector<ValueBlock> values, int dimension, const ReadOptions& options = {}) {
    ZoneValues(values, "a.cas", dimension, options, core::Progress::none())
        .add_to(out.zone, *out.data, Ids(1, 2), true, {}, out.problems);
}

std::vector<ValueBlock> velocities(std::initializer_list<const char*> names) {
    std::vector<ValueBlock> values;
    double value = 1;
    for (const char* name : names) {
        values.push_back(block(name, value++));
    }
    return values;
}

TEST(ZoneValues, AVelocityOfOneComponentIsNoVector) {
    ReadOptions options;
    for (const char* name : {"SV_U", "velocity_x", "*_x"}) {
        options.arrays = {name};
        Filled filled;
        fill(filled, velocities({"SV_U", "SV_V", "SV_W"}), 3, options);
        EXPECT_THAT(names_in(filled.zone), ElementsAre("velocity_x")) << name;
        EXPECT_EQ(filled.data->GetArray("velocity_x")->GetComponent(1, 0), 1);
        EXPECT_THAT(filled.problems, IsEmpty());
    }
    Filled whole;
    options.arrays = {"velocity"};
    fill(whole, velocities({"SV_U", "SV_V", "SV_W"}), 3, options);
    ASSERT_THAT(names_in(whole.zone), ElementsAre("velocity"));
    EXPECT_EQ(whole.data->GetArray("velocity")->GetComponent(1, 2), 3);
    EXPECT_EQ(whole.zone.arrays[0].original_name, "SV_U, SV_V, SV_W");
}

TEST(ZoneValues, InSpaceWhatTheFileDoesNotStateIsNotNought) {
    Filled space;
    fill(space, velocities({"SV_U", "SV_V"}), 3);
    EXPECT_THAT(names_in(space.zone), ElementsAre("velocity_x", "velocity_y"));
    ASSERT_EQ(space.problems.size(), 1U);
    EXPECT_THAT(space.problems[0].message, HasSubstr("velocity has no z component here"));
    Filled plane;
    fill(plane, velocities({"SV_U", "SV_V"}), 2);
    EXPECT_THAT(names_in(plane.zone), ElementsAre("velocity"));
    EXPECT_EQ(plane.data->GetArray("velocity")->GetComponent(1, 2), 0);
    EXPECT_THAT(plane.problems, IsEmpty());
}

TEST(ZoneValues, PhasesHaveTheirOwnVectors) {
    auto values = velocities({"SV_U", "SV_V", "SV_W", "SV_U", "SV_V", "SV_W"});
    for (std::size_t i = 3; i < 6; ++i) {
        values[i].phase = 2;
    }
    Filled filled;
    fill(filled, std::move(values), 3);
    EXPECT_THAT(names_in(filled.zone), ElementsAre("velocity", "velocity.phase-2"));
    EXPECT_EQ(filled.data->GetArray("velocity.phase-2")->GetComponent(0, 1), 5);
}

TEST(ZoneValues, AUnitStatedAgainstTheFileIsTakenAndTold) {
    ReadOptions options;
    options.units = {{"SV_P", "kPa"}};
    Filled filled;
    fill(filled, velocities({"SV_P"}), 3, options);
    EXPECT_EQ(filled.data->GetArray("pressure")->GetComponent(0, 0), 1000);
    ASSERT_EQ(filled.problems.size(), 1U);
    EXPECT_THAT(filled.problems[0].message, HasSubstr("the file has 'SV_P' in Pa; kPa is taken"));
}

// ---- elements with nodes (EnSight, CGNS, Fluent's tables) ----

Zone tetrahedron_with(const std::vector<std::string>& variables, core::Problems& problems,
                      const ReadOptions& options = {}) {
    ElementPart part;
    part.name = "water";
    part.points.grow_to(12);
    const std::array<double, 12> points = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::copy(points.begin(), points.end(), part.points.begin());
    const std::array<std::int64_t, 4> nodes = {0, 1, 2, 3};
    part.add(VTK_TETRA, nodes.data(), nodes.size());
    std::vector<PartValues> values;
    for (const auto& variable : variables) {
        values.push_back({variable, true, 1, Buffer<double>(4)});
        values.back().values.fill(static_cast<double>(values.size()));
    }
    return zone_from(std::move(part), std::move(values), 3, options, "a.cgns", problems);
}

TEST(ElementZones, KeepComponentsApartWhereOneIsMissingAndNamesOnce) {
    core::Problems problems;
    EXPECT_THAT(names_in(tetrahedron_with({"VelocityX", "VelocityY"}, problems)),
                ElementsAre("velocity_x", "velocity_y"));
    EXPECT_THAT(problems.at(0).message, HasSubstr("velocity has no z component here"));
    problems.clear();
    const Zone zone = tetrahedron_with({"Static Pressure", "Pressure"}, problems);
    EXPECT_THAT(names_in(zone), ElementsAre("Static Pressure", "pressure"));
    EXPECT_EQ(zone.volume->GetPointData()->GetArray("pressure")->GetComponent(0, 0), 2);
    EXPECT_THAT(problems.at(0).message, HasSubstr("both mean pressure"));
    ReadOptions options;
    options.arrays = {"velocity_z"};
    const Zone one = tetrahedron_with({"VelocityX", "VelocityY", "VelocityZ"}, problems, options);
    ASSERT_THAT(names_in(one), ElementsAre("velocity_z"));
    EXPECT_EQ(one.volume->GetPointData()->GetArray("velocity_z")->GetComponent(0, 0), 3);
}

// ---- VTK ----

TEST(VtkZones, KeepComponentsApartWhereOneIsMissingAndNamesOnce) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "a.vtk";
    std::ofstream(path) << "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET POLYDATA\nPOINTS 3 double\n0 0 0 1 0 0 0 "
                           "1 0\nPOLYGONS 1 4\n3 0 1 2\n"
                           "CELL_DATA 1\nFIELD attributes 6\nvelocity_x 1 1 double\n1\nvelocity_y 1 1 "
                           "double\n2\nStaticPressure 1 1 double\n3\n"
                           "Static_Pressure 1 1 double\n4\npressure 1 1 double\n5\nDensity[g/cm^3] 1 1 double\n6\n";
    ReadOptions options;
    options.units = {{"density", "kg/m^3"}};
    const Field field = read_field(path, options);
    auto* data = field.zones.at(0).surface->GetCellData();
    EXPECT_THAT(names_in(field.zones[0]),
                ElementsAre("velocity_x", "velocity_y", "StaticPressure", "Static_Pressure", "pressure", "density"));
    EXPECT_EQ(data->GetNumberOfArrays(), 6);
    EXPECT_EQ(data->GetArray("pressure")->GetComponent(0, 0), 5);
    EXPECT_EQ(data->GetArray("Static_Pressure")->GetComponent(0, 0), 4);
    EXPECT_EQ(data->GetArray("density")->GetComponent(0, 0), 6);
    std::string words;
    for (const auto& problem : field.problems) {
        words += problem.message + "\n";
    }
    EXPECT_THAT(words, HasSubstr("velocity has no z component here"));
    EXPECT_THAT(words, HasSubstr("'Static_Pressure' and 'pressure' both mean pressure"));
    EXPECT_THAT(words, HasSubstr("the file has 'Density' in g/cm^3; kg/m^3 is taken"));
}

TEST(VtkZones, WhatImportWritesKeepsItsNamesAndUnits) {
    const core::TemporaryFolder folder;
    std::ofstream(folder.path() / "a.csv")
        << "[Name]\nbody\n[Data]\nX [ m ],Y [ m ],Z [ m ],T [ s ],Temperature,Static Pressure [ Pa ],Pressure [ kPa "
           "],h [ W m^-2 C^-1 ],Enthalpy [ furlongish ],Velocity u [ m/s ]\n"
           "0,0,0,1,2,3,4,5,6,7\n1,0,0,1,2,3,4,5,6,7\n0,1,0,1,2,3,4,5,6,7\n0,0,1,1,2,3,4,5,6,7\n[Faces]\n0,2,1\n0,1,"
           "3\n";
    const Field written = read_field(folder.path() / "a.csv");
    for (const char* name : {"b.vtp", "b.vtu", "b.vtm"}) {
        write_vtk(written, folder.path() / name);
        const Field again = read_field(folder.path() / name);
        ASSERT_NE(again.zones.at(0).surface, nullptr) << name;
        for (const auto& info : written.zones.at(0).arrays) {
            const ArrayInfo* found = again.zones.at(0).find(info.name);
            ASSERT_NE(found, nullptr) << name << " " << info.name;
            EXPECT_EQ(found->unit, info.unit) << name << " " << info.name;
            EXPECT_EQ(again.zones[0].surface->GetPointData()->GetArray(info.name.c_str())->GetComponent(1, 0),
                      written.zones[0].surface->GetPointData()->GetArray(info.name.c_str())->GetComponent(1, 0));
        }
        EXPECT_EQ(again.zones[0].find("temperature"), nullptr);
    }
}

}  // namespace
}  // namespace underbody::postproc
