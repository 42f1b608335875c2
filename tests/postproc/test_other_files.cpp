// Plain VTK and surface files, Tecplot, and Fluent's ASCII tables.
#include <gmock/gmock.h>
#include <vtkPointData.h>

#include <cmath>
#include <fstream>

#include "core/file.h"
#include "import_support.h"
#include "postproc/field/import_error.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using ::testing::HasSubstr;

namespace {

std::filesystem::path written(const core::TemporaryFolder& folder, const std::string& name, const std::string& text) {
    std::ofstream(folder.path() / name, std::ios::binary) << text;
    return folder.path() / name;
}

const char* const triangle =
    "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET POLYDATA\nPOINTS 3 double\n0 0 0 1 0 0 0 1 0\n"
    "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS Pressure double 1\nLOOKUP_TABLE default\n1 2 3\n";

}  // namespace

TEST(OtherFiles, PlainVtkAndStlComeWithCanonicalNames) {
    const core::TemporaryFolder folder;
    const auto field = read_field(written(folder, "tri.vtk", triangle));
    ASSERT_EQ(field.zones.size(), 1U);
    EXPECT_NE(field.zones[0].find("pressure"), nullptr);
    EXPECT_NEAR(test::area_of(*field.zones[0].surface), 0.5, 1e-15);
    const auto stl = read_field(written(folder, "tri.stl",
                                        "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 "
                                        "1 0\nendloop\nendfacet\nendsolid t\n"));
    EXPECT_NEAR(test::area_of(*stl.zones.at(0).surface), 0.5, 1e-6);
}

TEST(OtherFiles, ATecplotFileOfFluentHasItsCells) {
    UNDERBODY_NEEDS_SHARED("samples/tecplot/tecplot_ascii.dat");
    const auto field = read_field(test::shared_folder() / "samples/tecplot/tecplot_ascii.dat");
    EXPECT_EQ(test::cells_of(field), 120);
    EXPECT_NE(field.zones.at(0).find("velocity_x"), nullptr);  // the only component in the file
    EXPECT_EQ(field.zones.at(0).find("velocity"), nullptr);
}

namespace {

std::string understood_of(const std::filesystem::path& path) {
    try {
        read_field(path);
    } catch (const postproc::ImportError& error) {
        EXPECT_THAT(error.what(), HasSubstr("; understood so far: " + error.understood()));
        return error.understood();
    }
    return "accepted";
}

}  // namespace

TEST(OtherFiles, ThatAreDamagedSayWhatWasUnderstoodOfThem) {
    const core::TemporaryFolder folder;
    const std::string table = "nodenumber x-coordinate y-coordinate pressure\n1 0 0 5\n2 1 0 6\n";
    EXPECT_EQ(understood_of(written(folder, "a.txt", table + "3 1 1\n")),
              "columns nodenumber, x-coordinate, y-coordinate, pressure; 2 whole rows");
    const std::string block =
        "[Name]\nhull\n\n[Data]\nX [ m ], Y [ m ], Z [ m "
        "]\n0,0,0\n1,0,0\n0,1,0\n\n[Faces]\n0,1,2\n\n[Name]\nbase\n\n[Data]\nX [ m ], Y [ m ], Z [ m ]\n0,0,x\n";
    EXPECT_EQ(understood_of(written(folder, "b.csv", block)), "2 zones (hull, base); read hull with 3 nodes, 1 faces");
    EXPECT_EQ(understood_of(written(folder, "c.vtk", std::string(triangle).substr(0, 120))),
              "the format, VTK legacy, nothing else yet");
    EXPECT_EQ(
        understood_of(written(folder, "d.cas", "(0 \"x\")\n(2 3)\n(10 (0 1 8 0))\n(45 (7 wall hull)())\n(10 (1 1 8")),
        "5 sections, nodes 0 of 8, faces 0, cells 0, zones hull");
}

TEST(OtherFiles, FluentsAsciiTableIsPointsAndSaysSo) {
    const core::TemporaryFolder folder;
    const auto field = read_field(written(
        folder, "export.csv",
        "nodenumber    x-coordinate    y-coordinate    z-coordinate        pressure    x-wall-shear    x-coordinate \n"
        "         1 -3.955259915E-01  1.0E+00  2.0E+00  5.0E+00  0.5  -3.955259915E-01 \n"
        "         2  0.0E+00  1.0E+00  2.0E+00  6.0E+00  0.25  0.0E+00 \n"));
    EXPECT_EQ(field.format, "Fluent ASCII");
    const auto& zone = field.zones.at(0);
    EXPECT_EQ(zone.kind, postproc::ZoneKind::points);
    EXPECT_EQ(zone.surface->GetNumberOfPoints(), 2);
    EXPECT_EQ(zone.surface->GetPointData()->GetArray("pressure")->GetTuple1(1), 6);
    EXPECT_NE(zone.find("wall_shear_x"), nullptr);
    EXPECT_THAT(field.problems.back().message, HasSubstr("forces cannot be integrated"));
    const auto odd = read_field(
        written(folder, "odd.txt",
                "nodenumber x-coordinate y-coordinate pressure\n1 0 0 1.0-101\n2 1 0 1.#QNAN\n3 1 1 2.5+100\n"));
    auto* pressure = odd.zones.at(0).surface->GetPointData()->GetArray("pressure");
    EXPECT_EQ(pressure->GetTuple1(0), 1e-101);  // Fortran, three digits of exponent
    EXPECT_TRUE(std::isnan(pressure->GetTuple1(1)));
    EXPECT_EQ(pressure->GetTuple1(2), 2.5e100);
    EXPECT_THAT(
        test::refusal(written(folder, "cut.csv", "nodenumber x-coordinate y-coordinate pressure\n1 2 3 4\n2 3\n")),
        HasSubstr("cut.csv:3"));
}

}  // namespace underbody
