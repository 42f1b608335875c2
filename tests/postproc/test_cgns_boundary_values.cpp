// Values that boundary conditions of CGNS files hold for themselves.
#include <gmock/gmock.h>
#include <vtkCellData.h>
#include <vtkPointData.h>

#include "cgns_files.h"
#include "core/file.h"
#include "import_support.h"
#include "postproc/loads/loads.h"

namespace underbody {

using postproc::Location;
using postproc::read_field;
using test::CgnsWriter;
using test::told;
using ::testing::HasSubstr;
using ::testing::Not;

namespace {

namespace fs = std::filesystem;

/// Data of a condition, one value or one each of what it names, or of a range of its own.
void write_data(const CgnsWriter& file, int condition, CGNS_ENUMT(BCDataType_t) kind, const std::string& variable,
                const std::vector<double>& values, CGNS_ENUMT(GridLocation_t) where = CGNS_ENUMV(Vertex),
                const std::vector<cgsize_t>& range = {}, std::size_t indices = 1) {
    int set = 0;
    const std::string name = "Data of " + variable;
    CgnsWriter::ok(
        cg_dataset_write(file.file, file.base, file.zone, condition, name.c_str(), CGNS_ENUMV(BCWall), &set));
    if (!range.empty()) {
        CgnsWriter::ok(cg_goto(file.file, file.base, "Zone_t", file.zone, "ZoneBC_t", 1, "BC_t", condition,
                               "BCDataSet_t", set, "end"));
        CgnsWriter::ok(
            cg_ptset_write(CGNS_ENUMV(PointRange), static_cast<cgsize_t>(range.size() / indices), range.data()));
        CgnsWriter::ok(cg_gridlocation_write(where));
    }
    CgnsWriter::ok(cg_bcdata_write(file.file, file.base, file.zone, condition, set, kind));
    CgnsWriter::ok(cg_goto(file.file, file.base, "Zone_t", file.zone, "ZoneBC_t", 1, "BC_t", condition, "BCDataSet_t",
                           set, "BCData_t", static_cast<int>(kind), "end"));
    const auto count = static_cast<cgsize_t>(values.size());
    CgnsWriter::ok(cg_array_write(variable.c_str(), CGNS_ENUMV(RealDouble), 1, &count, values.data()));
}

/// The value of the face (or of the node) of a zone that lies at a place.
double face_value(const postproc::Zone& zone, const char* array, double x, double y, double z) {
    for (vtkIdType c = 0; c < zone.surface->GetNumberOfCells(); ++c) {
        const double* box = zone.surface->GetCell(c)->GetBounds();
        if (std::abs((box[0] + box[1]) / 2 - x) + std::abs((box[2] + box[3]) / 2 - y) +
                std::abs((box[4] + box[5]) / 2 - z) <
            1e-9) {
            return zone.surface->GetCellData()->GetArray(array)->GetTuple1(c);
        }
    }
    ADD_FAILURE() << "no face at " << x << ", " << y << ", " << z;
    return 0;
}
double node_value(const postproc::Zone& zone, const char* array, double x, double y, double z) {
    for (vtkIdType i = 0; i < zone.surface->GetNumberOfPoints(); ++i) {
        const double* at = zone.surface->GetPoint(i);
        if (std::abs(at[0] - x) + std::abs(at[1] - y) + std::abs(at[2] - z) < 1e-9) {
            return zone.surface->GetPointData()->GetArray(array)->GetTuple1(i);
        }
    }
    ADD_FAILURE() << "no node at " << x << ", " << y << ", " << z;
    return 0;
}

}  // namespace

TEST(CgnsBoundaryValues, FacesOfAListHaveTheirOwn) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns");
        file.add_cube("water");
        file.section("quads", CGNS_ENUMV(QUAD_4), CgnsWriter::cube_faces(), 4);
        const int hull = file.condition("hull", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointList), CGNS_ENUMV(FaceCenter),
                                        {3, 2, 5});  // lid, floor, x = 1
        write_data(file, hull, CGNS_ENUMV(Dirichlet), "Pressure", {300, 200, 500});
        write_data(file, hull, CGNS_ENUMV(Neumann), "WallHeatFlux", {3, 2, 5});
        write_data(file, hull, CGNS_ENUMV(Neumann), "Temperature", {3, 2, 5});  // a gradient
        write_data(file, hull, CGNS_ENUMV(Dirichlet), "Density", {998});
        file.solution("Cells", CGNS_ENUMV(CellCenter), "Pressure", {7});
        CgnsWriter::ok(cg_goto(file.file, file.base, "end"));
        CgnsWriter::ok(cg_units_write(CGNS_ENUMV(Gram), CGNS_ENUMV(Meter), CGNS_ENUMV(Second), CGNS_ENUMV(Kelvin),
                                      CGNS_ENUMV(Radian)));
    }
    const auto field = read_field(folder.path() / "a.cgns");
    const auto* hull = field.find("hull");
    ASSERT_NE(hull, nullptr);
    ASSERT_NE(hull->find("pressure"), nullptr);
    EXPECT_EQ(hull->find("pressure")->on, Location::faces);
    EXPECT_NEAR(face_value(*hull, "pressure", 0.5, 0.5, 1), 0.3, 1e-12);
    EXPECT_NEAR(face_value(*hull, "pressure", 0.5, 0.5, 0), 0.2, 1e-12);
    EXPECT_NEAR(face_value(*hull, "pressure", 1, 0.5, 0.5), 0.5, 1e-12);
    EXPECT_NEAR(face_value(*hull, "wall_heat_flux", 1, 0.5, 0.5), 0.005, 1e-12);
    EXPECT_NEAR(face_value(*hull, "density", 1, 0.5, 0.5), 0.998, 1e-12);
    EXPECT_EQ(hull->find("temperature"), nullptr);
    EXPECT_THAT(told(field), HasSubstr("(BCDataSet) are not read: Temperature of 'hull'"));
    EXPECT_EQ(field.find("quads (rest)")->find("pressure")->on, Location::cells);
    EXPECT_EQ(field.find("quads (rest)")->find("density"), nullptr);
}

TEST(CgnsBoundaryValues, TheSolutionAtNodesGoesBefore) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns");
        file.add_cube("water");
        file.section("quads", CGNS_ENUMV(QUAD_4), CgnsWriter::cube_faces(), 4);
        const int hull =
            file.condition("hull", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointRange), CGNS_ENUMV(FaceCenter), {2, 7});
        write_data(file, hull, CGNS_ENUMV(Dirichlet), "Pressure", {1, 2, 3, 4, 5, 6});
        file.solution("Nodes", CGNS_ENUMV(Vertex), "Pressure", std::vector<double>(8, 9));
    }
    const auto field = read_field(folder.path() / "a.cgns");
    EXPECT_EQ(field.find("hull")->surface->GetCellData()->GetArray("pressure"), nullptr);
    EXPECT_EQ(node_value(*field.find("hull"), "pressure", 0, 0, 0), 9);
}

TEST(CgnsBoundaryValues, VerticesHaveTheirOwn) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns");
        file.add_cube("water");
        file.section("quads", CGNS_ENUMV(QUAD_4), CgnsWriter::cube_faces(), 4);
        const int floor =
            file.condition("floor", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointList), CGNS_ENUMV(Vertex), {4, 3, 2, 1});
        write_data(file, floor, CGNS_ENUMV(Dirichlet), "Pressure", {40, 30, 20, 10});
        const int lid = file.condition("lid", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointRange), CGNS_ENUMV(Vertex), {5, 8});
        write_data(file, lid, CGNS_ENUMV(Dirichlet), "Pressure", {50, 60, 70, 80});
    }
    const auto field = read_field(folder.path() / "a.cgns");
    EXPECT_EQ(node_value(*field.find("floor"), "pressure", 0, 0, 0), 10);
    EXPECT_EQ(node_value(*field.find("floor"), "pressure", 0, 1, 0), 40);
    EXPECT_EQ(node_value(*field.find("lid"), "pressure", 1, 1, 1), 70);
    EXPECT_EQ(field.find("lid")->find("pressure")->on, Location::nodes);
    EXPECT_THAT(told(field), Not(HasSubstr("BCDataSet")));
}

TEST(CgnsBoundaryValues, BlocksHaveThemInTheOrderOfTheirIndices) {
    const core::TemporaryFolder folder;
    std::vector<double> values;
    for (int face = 0; face < 6; ++face) {
        values.push_back(100 + face);
    }
    std::vector<double> at_nodes;
    for (int node = 0; node < 12; ++node) {
        at_nodes.push_back(node);
    }
    {
        CgnsWriter file(folder.path() / "a.cgns");
        file.add_block("blk", {2, 3, 4});
        const int faces = file.condition("faces", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointRange), CGNS_ENUMV(KFaceCenter),
                                         {1, 1, 1, 2, 3, 1}, 3);
        write_data(file, faces, CGNS_ENUMV(Dirichlet), "Pressure", values);
        const int vertices = file.condition("vertices", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointRange), CGNS_ENUMV(Vertex),
                                            {1, 1, 5, 3, 4, 5}, 3);
        write_data(file, vertices, CGNS_ENUMV(Dirichlet), "Temperature", at_nodes);
    }
    const auto field = read_field(folder.path() / "a.cgns");
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 2; ++i) {
            EXPECT_EQ(face_value(*field.find("blk/faces"), "pressure", i + 0.5, j + 0.5, 0), 100 + 2 * j + i);
        }
    }
    EXPECT_EQ(node_value(*field.find("blk/vertices"), "temperature", 1, 2, 4), 7);
}

TEST(CgnsBoundaryValues, TheyMayNameTheirFacesThemselves) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "block.cgns");
        file.add_block("blk", {2, 3, 4});
        const int wall = file.condition("wall", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointRange), CGNS_ENUMV(Vertex),
                                        {1, 1, 5, 3, 4, 5}, 3);
        write_data(file, wall, CGNS_ENUMV(Dirichlet), "Pressure", {100, 101, 102, 103, 104, 105},
                   CGNS_ENUMV(KFaceCenter), {1, 1, 5, 2, 3, 5}, 3);
        write_data(file, wall, CGNS_ENUMV(Dirichlet), "Temperature", {7, 8}, CGNS_ENUMV(KFaceCenter),
                   {1, 1, 5, 2, 1, 5}, 3);
    }
    const auto block = read_field(folder.path() / "block.cgns");
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 2; ++i) {
            EXPECT_EQ(face_value(*block.find("blk/wall"), "pressure", i + 0.5, j + 0.5, 4), 100 + 2 * j + i);
        }
    }
    EXPECT_THAT(told(block), HasSubstr("Temperature of 'blk/wall'"));
    {
        CgnsWriter file(folder.path() / "cube.cgns");
        file.add_cube("water");
        file.section("quads", CGNS_ENUMV(QUAD_4), CgnsWriter::cube_faces(), 4);
        const int hull =
            file.condition("hull", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointList), CGNS_ENUMV(FaceCenter), {3, 2});
        write_data(file, hull, CGNS_ENUMV(Dirichlet), "Pressure", {2, 3, 4, 5}, CGNS_ENUMV(FaceCenter), {2, 5});
    }
    const auto cube = read_field(folder.path() / "cube.cgns");
    EXPECT_EQ(face_value(*cube.find("hull"), "pressure", 0.5, 0.5, 0), 2);
    EXPECT_EQ(face_value(*cube.find("hull"), "pressure", 0.5, 0.5, 1), 3);
}

}  // namespace underbody
