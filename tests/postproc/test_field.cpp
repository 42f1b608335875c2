#include <gmock/gmock.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "postproc/field/field.h"
#include "postproc/field/summary.h"
#include "postproc/field/vtk_files.h"
#include "tests/support/support.h"

namespace underbody::postproc {
namespace {

TEST(CanonicalNames, KnowTheSpellingsOfTheSolvers) {
    const std::vector<std::pair<std::string, std::string>> names = {
        {"Pressure", "pressure"},
        {"SV_P", "pressure"},
        {"static-pressure", "pressure"},
        {"Total Pressure", "pressure_total"},
        {"Wall Shear X", "wall_shear_x"},
        {"x-wall-shear", "wall_shear_x"},
        {"Velocity v", "velocity_y"},
        {"VelocityZ", "velocity_z"},
        {"SV_W", "velocity_z"},
        {"U", "velocity"},
        {"u", "velocity_x"},
        {"Yplus", "y_plus"},
        {"y-plus", "y_plus"},
        {"nut", "kinematic_eddy_viscosity"},
        {"Turbulence Kinetic Energy", "turbulence_kinetic_energy"},
        {"SV_WALL_SHEAR", "wall_shear_force"},
        {"my variable", "my variable"}};
    for (const auto& [original, canonical] : names) {
        EXPECT_EQ(canonical_name(original).name, canonical) << original;
    }
    EXPECT_EQ(canonical_name("Wall Shear X").unit, "Pa");
    EXPECT_EQ(canonical_name("my variable").unit, "");
    EXPECT_EQ(vector_component("wall_shear_z")->index, 2);
    EXPECT_FALSE(vector_component("pressure_total"));
}

TEST(Patterns, MatchWithStarsAndQuestionMarks) {
    EXPECT_TRUE(matches("hull*", "Hull-upper"));
    EXPECT_TRUE(matches("*base*", "base"));
    EXPECT_TRUE(matches("wall-?", "wall-3"));
    EXPECT_TRUE(matches("*a*b*c", "xxaYYbZZbc"));
    EXPECT_FALSE(matches("wall-?", "wall-33"));
    EXPECT_FALSE(matches("hull", "hull2"));
    EXPECT_TRUE(matches_any({}, "anything"));
}

TEST(ReadField, SaysWhatItCannotRead) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "empty.csv", "");
    core::write_file(folder.path() / "prose.txt", "This is no CFD file.\n");
    const auto message = [](const std::filesystem::path& path) {
        try {
            read_field(path);
        } catch (const core::InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(message(folder.path() / "empty.csv"), testing::HasSubstr("the file is empty"));
    EXPECT_THAT(message(folder.path() / "prose.txt"), testing::HasSubstr("CFD-Post CSV"));
    EXPECT_THAT(message(folder.path() / "emty.csv"), testing::HasSubstr("did you mean 'empty.csv'?"));
}

TEST(VtkFiles, HoldWhatTheFieldHeld) {
    const core::TemporaryFolder folder;
    core::write_file(
        folder.path() / "a.csv",
        "[Name]\na\n[Data]\nX [ mm ], Y [ mm ], Z [ mm ], Pressure [ kPa ]\n0,0,0,1\n1,0,0,2\n0,1,0,3\n[Faces]\n0,1,2\n"
        "[Name]\nb\n[Data]\nX [ mm ], Y [ mm ], Z [ mm ], Pressure [ kPa ], "
        "Yplus\n0,0,1,1,5\n1,0,1,2,5\n0,1,1,3,5\n[Faces]\n0,1,2\n");
    const Field field = read_field(folder.path() / "a.csv");
    const auto left_out = write_vtk(field, folder.path() / "a.vtp");
    ASSERT_EQ(left_out.size(), 1U);
    EXPECT_THAT(left_out[0].message, testing::HasSubstr("y_plus"));
    vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName((folder.path() / "a.vtp").c_str());
    reader->Update();
    EXPECT_EQ(reader->GetOutput()->GetNumberOfPolys(), 2);
    EXPECT_EQ(reader->GetOutput()->GetPointData()->GetArray("pressure")->GetComponent(1, 0), 2000);
    EXPECT_NEAR(reader->GetOutput()->GetPoint(1)[0], 0.001, 1e-15);
    write_vtk(field, folder.path() / "a.vtm");
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "a" / "1-b.vtp"));
    write_vtk(field, folder.path() / "a.vtu");
    EXPECT_THROW(write_vtk(field, folder.path() / "a.stl"), core::UsageError);
}

TEST(Summary, GivesZonesArraysAndRanges) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "a.csv",
                     "[Name]\na\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ bar "
                     "]\n0,0,0,1\n1,0,0,2\n0,2,0,null\n[Faces]\n0,1,2\n");
    const nlohmann::json json = summarise(read_field(folder.path() / "a.csv"));
    EXPECT_EQ(json["format"], "CFD-Post CSV");
    EXPECT_EQ(json["zones"][0]["faces"], 1);
    EXPECT_EQ(json["zones"][0]["bounding_box"][1][1], 2.0);
    EXPECT_EQ(json["arrays"][0]["name"], "pressure");
    EXPECT_EQ(json["arrays"][0]["max"], 2e5);
    EXPECT_EQ(json["arrays"][0]["missing"], 1);
    EXPECT_EQ(json["problems"].size(), 1U);
}

}  // namespace
}  // namespace underbody::postproc
