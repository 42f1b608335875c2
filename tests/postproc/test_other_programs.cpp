// What other programs name and order in their own way, what they read of ours, and what is no field at all.
#include <gmock/gmock.h>
#include <vtkCellData.h>
#include <vtkPointData.h>

#include "cgns_files.h"
#include "core/file.h"
#include "import_support.h"
#include "postproc/field/summary.h"
#include "postproc/field/vtk_files.h"
#include "postproc/loads/loads.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using ::testing::AllOf;
using ::testing::HasSubstr;

namespace {

namespace fs = std::filesystem;

fs::path written(const core::TemporaryFolder& folder, const std::string& name, const std::string& text) {
    core::write_file(folder.path() / name, text);
    return folder.path() / name;
}

const std::string square =
    "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n0 0 0 1 0 0 1 1 1 0 1 1\nPOLYGONS 1 "
    "5\n4 0 1 2 3\nPOINT_DATA 4\n";

std::string scalars(const std::string& name, const std::string& values) {
    return "SCALARS " + name + " double 1\nLOOKUP_TABLE default\n" + values + "\n";
}

}  // namespace

TEST(OtherPrograms, UAndVAreComponentsOfTheVelocity) {
    const core::TemporaryFolder folder;
    const std::string u = scalars("U", "1 2 3 4");
    const std::string v = scalars("V", "5 6 7 8");
    const auto whole = read_field(written(folder, "uvw.vtk", square + u + v + scalars("W", "9 10 11 12")));
    auto* velocity = whole.zones.at(0).surface->GetPointData()->GetArray("velocity");
    ASSERT_NE(velocity, nullptr);
    for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(velocity->GetComponent(1, k), 2 + 4 * k);
    }
    // Without the third component of a case in space there is no vector, but none of them is a magnitude.
    const auto two = read_field(written(folder, "uv.vtk", square + u + v));
    EXPECT_NE(two.zones.at(0).find("velocity_x"), nullptr);
    EXPECT_NE(two.zones.at(0).find("velocity_y"), nullptr);
    EXPECT_EQ(two.zones.at(0).find("velocity_magnitude"), nullptr);
    const auto alone = read_field(written(folder, "u.vtk", square + u));
    EXPECT_NE(alone.zones.at(0).find("velocity_magnitude"), nullptr);
    // Tecplot, a plane case: the third component is nought.
    const std::string tecplot =
        "TITLE = \"t\"\nVARIABLES = \"X\", \"Y\", \"U\", \"V\"\nZONE T=\"flow\", N=4, E=1, F=FEPOINT, "
        "ET=QUADRILATERAL\n"
        "0 0 1 5\n1 0 2 6\n1 1 3 7\n0 1 4 8\n1 2 3 4\n";
    const auto plane = read_field(written(folder, "uv.dat", tecplot));
    const auto& zone = plane.zones.at(0);
    vtkDataSet* data = zone.volume != nullptr ? static_cast<vtkDataSet*>(zone.volume) : zone.surface.Get();
    velocity = data->GetPointData()->GetArray("velocity");
    ASSERT_NE(velocity, nullptr);
    EXPECT_EQ(velocity->GetComponent(2, 0), 3);
    EXPECT_EQ(velocity->GetComponent(2, 1), 7);
    EXPECT_EQ(velocity->GetComponent(2, 2), 0);
}

TEST(OtherPrograms, TensorsHaveTheOrderAndTheNamesOfVtk) {
    const core::TemporaryFolder folder;
    const auto vtk =
        read_field(written(folder, "tensor.vtk",
                           square + "FIELD data 1\nR 6 4 double\n" +
                               "11 22 33 12 23 13\n11 22 33 12 23 13\n11 22 33 12 23 13\n11 22 33 12 23 13\n"));
    EXPECT_STREQ(vtk.zones.at(0).surface->GetPointData()->GetArray("R")->GetComponentName(5), "XZ");
    const auto summary = postproc::summarise(vtk);
    EXPECT_THAT(summary.arrays.at(0).component_names, testing::ElementsAre("XX", "YY", "ZZ", "XY", "YZ", "XZ"));
    // EnSight states 11, 22, 33, 12, 13, 23.
    for (const char* ending : {".geo", ".scl1", ".vel"}) {
        fs::copy_file(test::data_folder() / "ensight" / (std::string("ascii") + ending),
                      folder.path() / (std::string("ascii") + ending));
    }
    std::string values = "stress\npart\n         4\ncoordinates\n";
    for (const char* value : {"11", "22", "33", "12", "13", "23"}) {
        for (int node = 0; node < 18; ++node) {
            values += std::string(value) + "\n";
        }
    }
    written(folder, "stress", values);
    const auto path = written(
        folder, "case.encas",
        "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: ascii.geo\nVARIABLE\ntensor symm per node: stress stress\n"
        "complex scalar per node: sound ascii.scl1 ascii.scl1 50\n");
    const auto ensight = read_field(path);
    auto* tensor = ensight.find("water")->volume->GetPointData()->GetArray("stress");
    ASSERT_NE(tensor, nullptr);
    const double wanted[] = {11, 22, 33, 12, 23, 13};
    for (int k = 0; k < 6; ++k) {
        EXPECT_EQ(tensor->GetComponent(3, k), wanted[k]) << k;
    }
    EXPECT_STREQ(tensor->GetComponentName(4), "YZ");
    EXPECT_THAT(test::told(ensight),
                HasSubstr("the complex variable 'sound' is not read: it is an amplitude and a phase"));
}

TEST(OtherPrograms, PartsThatCountFromNoughtAreNamed) {
    const core::TemporaryFolder folder;
    fs::copy_file(test::data_folder() / "ensight/ascii.geo", folder.path() / "ascii.geo");
    std::string text = core::read_file(folder.path() / "ascii.geo");
    text.replace(text.find("         4\n"), 11, "         0\n");
    written(folder, "ascii.geo", text);
    EXPECT_THAT(
        test::refusal(written(folder, "case.encas", "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: ascii.geo\n")),
        AllOf(HasSubstr("a part has the number 0: EnSight counts parts from 1"), HasSubstr("counts from 0")));
}

TEST(OtherPrograms, BasesOfACgnsFileThatAreNotReadAreNamedAndCanBeChosen) {
    const core::TemporaryFolder folder;
    const fs::path path = folder.path() / "two.cgns";
    {
        test::CgnsWriter file(path);
        file.add_cube("water");
        file.solution("Flow", CGNS_ENUMV(CellCenter), "Pressure", {5});
        file.add_base("Solid");
        file.add_cube("steel");
        file.solution("Flow", CGNS_ENUMV(CellCenter), "Temperature", {300});
    }
    const auto last = read_field(path);
    EXPECT_NE(last.find("steel"), nullptr);
    EXPECT_THAT(test::told(last),
                AllOf(HasSubstr("the file has 2 bases, of which the last is read, 'Solid': what is in "),
                      HasSubstr("Base"), HasSubstr("is not here")));
    for (const char* name : {"Base", "1"}) {
        postproc::ReadOptions options;
        options.base = name;
        const auto first = read_field(path, options);
        EXPECT_NE(first.find("water"), nullptr);
        EXPECT_EQ(first.find("steel"), nullptr);
        EXPECT_THAT(test::told(first), testing::Not(HasSubstr("is not here")));
    }
    postproc::ReadOptions options;
    options.base = "Sold";
    EXPECT_THAT(test::refusal(path, options),
                AllOf(HasSubstr("there is no base 'Sold'"), HasSubstr("did you mean 'Solid'")));
    options.base = "3";
    EXPECT_THAT(test::refusal(path, options), HasSubstr("there is no base '3'"));
    EXPECT_THAT(test::refusal(written(folder, "a.vtk", square + scalars("p", "1 2 3 4")), options),
                HasSubstr("a base is asked for"));
}

TEST(OtherPrograms, WhatIsNoFieldIsSaidToBeWhatItIs) {
    const core::TemporaryFolder folder;
    EXPECT_THAT(test::refusal(written(folder, "a.cas.h5",
                                      "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n")),
                AllOf(HasSubstr("a pointer of Git LFS in place of the file"), HasSubstr("git lfs pull")));
    fs::create_directory(folder.path() / "empty");
    EXPECT_THAT(test::refusal(folder.path() / "empty"), HasSubstr("an empty folder"));
    EXPECT_THAT(
        test::refusal(written(folder, "a.sos",
                              "FORMAT\ntype: master_server gold\nSERVERS\nnumber of servers: 2\ncasefile: a.case\n")),
        AllOf(HasSubstr("several parts (.sos)"), HasSubstr("one of the .case files")));
    const std::string control =
        "FoamFile\n{\n    version 2.0; format ascii; class dictionary; object controlDict;\n}\napplication "
        "simpleFoam;\n";
    written(folder, "case/system/controlDict", control);
    written(folder, "case/case.foam", "");
    fs::create_directories(folder.path() / "case/constant");
    for (const char* name : {"case", "case/case.foam", "case/system/controlDict"}) {
        EXPECT_THAT(test::refusal(folder.path() / name),
                    HasSubstr("an OpenFOAM case without a mesh: there is no constant/polyMesh"))
            << name;
    }
    EXPECT_THAT(test::refusal(written(folder, "none.csv", "")), HasSubstr("the file is empty"));
}

TEST(OtherPrograms, MeshioAndVtkReadWhatImportWritesOfVolumes) {
    const char* python = "/usr/bin/python3";
    if (test::run_program(python, {"-c", "import meshio, vtk"}).exit_code != 0) {
        GTEST_SKIP() << "skipped: meshio or VTK is not there for " << python
                     << " (packages python3-meshio, python3-vtk9)";
    }
    const core::TemporaryFolder folder;
    const auto field = read_field(test::data_folder() / "openfoam/ascii");
    postproc::write_vtk(field, folder.path() / "box.vtu");
    const auto* cells = field.find("internalMesh");
    auto* pressure = cells->volume->GetCellData()->GetArray("kinematic_pressure");
    double sum = 0;
    for (vtkIdType i = 0; i < pressure->GetNumberOfTuples(); ++i) {
        sum += pressure->GetTuple1(i);
    }
    // Both readers give the number of points and cells, the sum of an array and its unit.
    const std::string script =
        "import meshio, vtk, sys\n"
        "from vtk.util.numpy_support import vtk_to_numpy\n"
        "m = meshio.read(sys.argv[1])\n"
        "print(len(m.points), sum(len(c.data) for c in m.cells), '%.12g' % sum(a.sum() for a in "
        "m.cell_data['kinematic_pressure']), m.cells[0].type)\n"
        "r = vtk.vtkXMLUnstructuredGridReader()\n"
        "r.SetFileName(sys.argv[1])\n"
        "r.Update()\n"
        "g = r.GetOutput()\n"
        "a = g.GetCellData().GetArray('kinematic_pressure')\n"
        "print(g.GetNumberOfPoints(), g.GetNumberOfCells(), '%.12g' % vtk_to_numpy(a).sum(), "
        "a.GetInformation().Get(vtk.vtkDataArray.UNITS_LABEL()))\n";
    written(folder, "read.py", script);
    const auto run =
        test::run_program(python, {(folder.path() / "read.py").string(), (folder.path() / "box.vtu").string()});
    char line[100];
    std::snprintf(line, sizeof line, "75 32 %.12g", sum);
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_EQ(run.output, std::string(line) + " hexahedron\n" + line + " m^2/s^2\n") << run.errors;
    // Ours is as whole as before.
    const auto again = read_field(folder.path() / "box.vtu");
    EXPECT_EQ(again.density, field.density);
    EXPECT_EQ(again.find("internalMesh")->find("kinematic_pressure")->unit, "m^2/s^2");
}

}  // namespace underbody
