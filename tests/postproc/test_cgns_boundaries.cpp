// Boundary conditions of CGNS files in all the ways in which they name their faces.
#include <gmock/gmock.h>
#include <vtkCellData.h>

#include "cgns_files.h"
#include "core/file.h"
#include "import_support.h"
#include "postproc/loads/loads.h"

namespace underbody {

using postproc::read_field;
using postproc::ZoneKind;
using test::CgnsWriter;
using test::told;
using ::testing::HasSubstr;

namespace {

namespace fs = std::filesystem;

double area(const postproc::Field& field, const std::string& zone) {
    const auto* found = field.find(zone);
    return found == nullptr || found->surface == nullptr ? -1 : test::area_of(*found->surface);
}

/// A block of 2 x 3 x 4 unit cells with one condition of faces or vertices.
postproc::Field block_with(const std::vector<cgsize_t>& cells, CGNS_ENUMT(PointSetType_t) set,
                           CGNS_ENUMT(GridLocation_t) where, const std::vector<cgsize_t>& numbers, int inward = 0) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns", static_cast<int>(cells.size()), static_cast<int>(cells.size()));
        file.add_block("blk", cells);
        const int condition =
            file.condition("wall", CGNS_ENUMV(BCWall), set, where, numbers, static_cast<int>(cells.size()));
        if (inward > 0) {
            std::array<int, 3> normal{};
            normal[static_cast<std::size_t>(inward - 1)] = 1;
            CgnsWriter::ok(cg_boco_normal_write(file.file, file.base, file.zone, condition, normal.data(), 0,
                                                CGNS_ENUMV(RealDouble), nullptr));
        }
    }
    return read_field(folder.path() / "a.cgns");
}

}  // namespace

TEST(CgnsBoundaries, ARangeOfFacesHasAllOfThem) {
    const std::vector<cgsize_t> cells = {2, 3, 4};
    const auto range = CGNS_ENUMV(PointRange);
    struct Side {
        CGNS_ENUMT(GridLocation_t) where;
        std::vector<cgsize_t> faces;
        std::vector<cgsize_t> vertices;
        double area;
    };
    for (const Side& side : {Side{CGNS_ENUMV(IFaceCenter), {3, 1, 1, 3, 3, 4}, {3, 1, 1, 3, 4, 5}, 12},
                             Side{CGNS_ENUMV(JFaceCenter), {1, 1, 1, 2, 1, 4}, {1, 1, 1, 3, 1, 5}, 8},
                             Side{CGNS_ENUMV(KFaceCenter), {1, 1, 5, 2, 3, 5}, {1, 1, 5, 3, 4, 5}, 6}}) {
        EXPECT_NEAR(area(block_with(cells, range, CGNS_ENUMV(Vertex), side.vertices), "blk/wall"), side.area, 1e-12);
        for (const auto where : {side.where, CGNS_ENUMV(FaceCenter)}) {
            const auto field = block_with(cells, range, where, side.faces);
            EXPECT_NEAR(area(field, "blk/wall"), side.area, 1e-12);
            EXPECT_TRUE(field.find("blk/wall")->normals_into_fluid);
            EXPECT_EQ(field.find("blk/wall")->kind, ZoneKind::wall);
        }
    }
}

TEST(CgnsBoundaries, InABlockOneCellWideTheFileSaysAcrossWhichIndexFacesLie) {
    const auto range = CGNS_ENUMV(PointRange);
    const std::vector<cgsize_t> numbers = {1, 1, 1, 3, 1, 1};  // across j or k
    for (const auto& [where, inward, y, z] :
         {std::tuple{CGNS_ENUMV(KFaceCenter), 0, 1.0, 0.0}, std::tuple{CGNS_ENUMV(JFaceCenter), 0, 0.0, 1.0},
          std::tuple{CGNS_ENUMV(FaceCenter), 2, 0.0, 1.0}, std::tuple{CGNS_ENUMV(FaceCenter), 3, 1.0, 0.0}}) {
        const auto field = block_with({3, 1, 1}, range, where, numbers, inward);
        ASSERT_NEAR(area(field, "blk/wall"), 3, 1e-12);
        EXPECT_EQ(field.find("blk/wall")->surface->GetBounds()[3], y);
        EXPECT_EQ(field.find("blk/wall")->surface->GetBounds()[5], z);
    }
    EXPECT_NEAR(area(block_with({3, 1, 1}, range, CGNS_ENUMV(FaceCenter), {1, 1, 2, 3, 1, 2}), "blk/wall"), 3,
                1e-12);  // behind the last cell
    const auto unsaid = block_with({3, 1, 1}, range, CGNS_ENUMV(FaceCenter), numbers);
    EXPECT_EQ(unsaid.find("blk/wall"), nullptr);
    EXPECT_THAT(told(unsaid), HasSubstr("'wall' (BCWall) has no faces: the file does not say across which index"));
}

TEST(CgnsBoundaries, ListsInBlocksNameFacesOrVertices) {
    const auto list = CGNS_ENUMV(PointList);
    EXPECT_NEAR(area(block_with({2, 3, 4}, list, CGNS_ENUMV(KFaceCenter), {1, 1, 1, 2, 1, 1, 2, 3, 1}), "blk/wall"), 3,
                1e-12);
    EXPECT_NEAR(area(block_with({2, 3, 4}, list, CGNS_ENUMV(FaceCenter), {3, 1, 1, 3, 3, 4}), "blk/wall"), 2, 1e-12);
    EXPECT_NEAR(area(block_with({2, 3, 4}, list, CGNS_ENUMV(Vertex), {1, 1, 1, 2, 1, 1, 2, 2, 1, 1, 2, 1, 1, 3, 1}),
                     "blk/wall"),
                1, 1e-12);
    const auto corner = block_with({2, 3, 4}, list, CGNS_ENUMV(Vertex), {1, 1, 1});
    EXPECT_EQ(corner.find("blk/wall"), nullptr);
    EXPECT_THAT(told(corner), HasSubstr("'wall'"));
    EXPECT_THAT(told(block_with({2, 3, 4}, list, CGNS_ENUMV(CellCenter), {1, 1, 1})), HasSubstr("'wall'"));
}

TEST(CgnsBoundaries, PlaneBlocksHaveLines) {
    const auto range = CGNS_ENUMV(PointRange);
    EXPECT_NEAR(area(block_with({2, 3}, range, CGNS_ENUMV(Vertex), {1, 1, 3, 1}), "blk/wall"), 2, 1e-12);
    EXPECT_NEAR(area(block_with({2, 3}, range, CGNS_ENUMV(EdgeCenter), {3, 1, 3, 3}), "blk/wall"), 3, 1e-12);
    EXPECT_NEAR(area(block_with({2, 3}, range, CGNS_ENUMV(EdgeCenter), {1, 4, 2, 4}), "blk/wall"), 2, 1e-12);
    EXPECT_NEAR(area(block_with({2, 3}, CGNS_ENUMV(PointList), CGNS_ENUMV(EdgeCenter), {1, 1, 2, 4}, 2), "blk/wall"), 2,
                1e-12);
}

TEST(CgnsBoundaries, FacesOutsideABlockAreRefused) {
    for (const auto& numbers : {std::vector<cgsize_t>{1, 1, 1, 4, 3, 1}, std::vector<cgsize_t>{1, 1, 6, 2, 3, 6},
                                std::vector<cgsize_t>{0, 1, 1, 2, 3, 1}}) {
        EXPECT_THROW(block_with({2, 3, 4}, CGNS_ENUMV(PointRange), CGNS_ENUMV(KFaceCenter), numbers), core::InputError);
    }
    EXPECT_THROW(block_with({2, 3, 4}, CGNS_ENUMV(PointList), CGNS_ENUMV(KFaceCenter), {4, 1, 1}), core::InputError);
    EXPECT_THROW(block_with({2, 3, 4}, CGNS_ENUMV(PointList), CGNS_ENUMV(Vertex), {1, 1, 6}), core::InputError);
}

TEST(CgnsBoundaries, VerticesThatAreCalledFacesAreVertices) {
    for (const auto where : {CGNS_ENUMV(KFaceCenter), CGNS_ENUMV(FaceCenter)}) {
        const auto field = block_with({2, 3, 4}, CGNS_ENUMV(PointRange), where, {1, 1, 5, 3, 4, 5});
        EXPECT_NEAR(area(field, "blk/wall"), 6, 1e-12);
        EXPECT_THAT(told(field), HasSubstr("is taken by its vertices"));
        EXPECT_NEAR(
            area(block_with({2, 3, 4}, CGNS_ENUMV(PointList), where, {2, 3, 5, 3, 3, 5, 3, 4, 5, 2, 4, 5}), "blk/wall"),
            1, 1e-12);
    }
}

TEST(CgnsBoundaries, CellsAndFacesMayStandInOneSection) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns");
        file.add_zone("water", CgnsWriter::cube_nodes(), 1);
        std::vector<cgsize_t> list = {CGNS_ENUMV(HEXA_8), 1, 2, 3, 4, 5, 6, 7, 8};
        std::vector<cgsize_t> offsets = {0, 9};
        const auto faces = CgnsWriter::cube_faces();
        for (std::size_t f = 0; f < 6; ++f) {
            list.push_back(CGNS_ENUMV(QUAD_4));
            list.insert(list.end(), faces.begin() + static_cast<std::ptrdiff_t>(4 * f),
                        faces.begin() + static_cast<std::ptrdiff_t>(4 * f + 4));
            offsets.push_back(static_cast<cgsize_t>(list.size()));
        }
        int index = 0;
        CgnsWriter::ok(cg_poly_section_write(file.file, file.base, file.zone, "all", CGNS_ENUMV(MIXED), 1, 7, 0,
                                             list.data(), offsets.data(), &index));
        file.condition("hull", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointRange), CGNS_ENUMV(FaceCenter), {2, 7});
        file.solution("Cells", CGNS_ENUMV(CellCenter), "Pressure", {5});
    }
    const auto field = read_field(folder.path() / "a.cgns");
    EXPECT_NEAR(area(field, "hull"), 6, 1e-12);
    EXPECT_EQ(test::cells_of(field), 1);
    EXPECT_NE(field.find("water")->find("pressure"), nullptr);
    EXPECT_EQ(test::range_of(*field.find("hull")->surface, "pressure").low, 5);
    EXPECT_THAT(told(field), ::testing::Not(HasSubstr("cells")));
}

TEST(CgnsBoundaries, FacesThatNoConditionNamesStayThere) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns");
        file.add_cube("water");
        file.section("faces", CGNS_ENUMV(QUAD_4), CgnsWriter::cube_faces(), 4);
        file.condition("hull", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointRange), CGNS_ENUMV(FaceCenter), {2, 4});
        file.condition("nothing", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointRange), CGNS_ENUMV(FaceCenter), {8, 2000000000});
        file.condition("beyond", CGNS_ENUMV(BCInflow), CGNS_ENUMV(PointList), CGNS_ENUMV(FaceCenter), {7, 9});
    }
    const auto field = read_field(folder.path() / "a.cgns");
    EXPECT_NEAR(area(field, "hull"), 3, 1e-12);
    EXPECT_NEAR(area(field, "beyond"), 1, 1e-12);
    EXPECT_NEAR(area(field, "faces (rest)"), 2, 1e-12);
    EXPECT_EQ(field.find("faces (rest)")->kind, ZoneKind::unknown);
    EXPECT_EQ(field.find("nothing"), nullptr);
    EXPECT_THAT(told(field), HasSubstr("'nothing' (BCWall) has no faces: none of the elements"));
    EXPECT_THAT(told(field), HasSubstr("is not whole: of 2 elements that it names 1 are faces in the file"));
}

TEST(CgnsBoundaries, VerticesNameTheFacesBetweenThem) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns");
        file.add_cube("water");
        file.section("quads", CGNS_ENUMV(QUAD_4), CgnsWriter::cube_faces(), 4);
        file.condition("floor", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointList), CGNS_ENUMV(Vertex), {4, 3, 2, 1});
        file.condition("lid", CGNS_ENUMV(BCInflow), CGNS_ENUMV(PointRange), CGNS_ENUMV(Vertex), {5, 8});
        file.condition("edge", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointList), CGNS_ENUMV(Vertex), {1, 5});
    }
    const auto field = read_field(folder.path() / "a.cgns");
    ASSERT_NEAR(area(field, "floor"), 1, 1e-12);
    EXPECT_EQ(field.find("floor")->kind, ZoneKind::wall);
    EXPECT_EQ(field.find("floor")->surface->GetBounds()[5], 0);
    EXPECT_NEAR(area(field, "lid"), 1, 1e-12);
    EXPECT_EQ(field.find("lid")->kind, ZoneKind::inlet);
    EXPECT_NEAR(area(field, "quads (rest)"), 4, 1e-12);
    EXPECT_THAT(told(field), HasSubstr("'edge'"));
}

TEST(CgnsBoundaries, PolygonsOfOneCellStayThereWithoutACondition) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns");
        file.add_zone("water", CgnsWriter::cube_nodes(), 1);
        const auto faces = CgnsWriter::cube_faces();
        const std::vector<cgsize_t> starts = {0, 4, 8, 12, 16, 20, 24};
        const std::vector<cgsize_t> cell = {1, 2, 3, 4, 5, 6};
        const std::vector<cgsize_t> cell_starts = {0, 6};
        int index = 0;
        CgnsWriter::ok(cg_poly_section_write(file.file, file.base, file.zone, "faces", CGNS_ENUMV(NGON_n), 1, 6, 0,
                                             faces.data(), starts.data(), &index));
        CgnsWriter::ok(cg_poly_section_write(file.file, file.base, file.zone, "cells", CGNS_ENUMV(NFACE_n), 7, 7, 0,
                                             cell.data(), cell_starts.data(), &index));
        file.condition("floor", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointList), CGNS_ENUMV(Vertex), {1, 2, 3, 4});
        file.condition("lid", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointList), CGNS_ENUMV(FaceCenter), {2});
    }
    const auto field = read_field(folder.path() / "a.cgns");
    EXPECT_NEAR(area(field, "floor"), 1, 1e-12);
    EXPECT_NEAR(area(field, "lid"), 1, 1e-12);
    EXPECT_NEAR(area(field, "faces (rest)"), 4, 1e-12);
}

TEST(CgnsBoundaries, AHundredThousandFacesInOneConditionAreReadAtOnce) {
    constexpr cgsize_t n = 350;
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns");
        std::array<std::vector<double>, 3> x;
        std::vector<cgsize_t> cells;
        std::vector<cgsize_t> faces;
        const auto node = [](cgsize_t i, cgsize_t j, cgsize_t k) { return (k * (n + 1) + j) * (n + 1) + i + 1; };
        for (cgsize_t k = 0; k < 2; ++k) {
            for (cgsize_t j = 0; j <= n; ++j) {
                for (cgsize_t i = 0; i <= n; ++i) {
                    x[0].push_back(i);
                    x[1].push_back(j);
                    x[2].push_back(k);
                    if (k == 0 && i < n && j < n) {
                        const std::array<cgsize_t, 8> corners = {
                            node(i, j, 0), node(i + 1, j, 0), node(i + 1, j + 1, 0), node(i, j + 1, 0),
                            node(i, j, 1), node(i + 1, j, 1), node(i + 1, j + 1, 1), node(i, j + 1, 1)};
                        cells.insert(cells.end(), corners.begin(), corners.end());
                        faces.insert(faces.end(), corners.begin(), corners.begin() + 4);
                    }
                }
            }
        }
        file.add_zone("water", x, n * n);
        file.section("cells", CGNS_ENUMV(HEXA_8), cells, 8);
        file.section("bottom", CGNS_ENUMV(QUAD_4), faces, 4);
        file.condition("wall", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointRange), CGNS_ENUMV(FaceCenter),
                       {n * n + 1, 2 * n * n});
    }
    postproc::ReadOptions surfaces;
    surfaces.surfaces_only = true;
    EXPECT_NEAR(area(read_field(folder.path() / "a.cgns", surfaces), "wall"), n * n,
                1e-6);  // was refused after a minute
}

namespace {

/// Two cubes one on the other, 10 Pa in the lower and 20 in the upper, and the face between them; hexahedra or
/// polyhedra.
void write_two_cubes(const fs::path& path, CGNS_ENUMT(BCType_t) type, bool polyhedra, bool upward) {
    CgnsWriter file(path);
    std::array<std::vector<double>, 3> x;
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 2; ++j) {
            for (int i = 0; i < 2; ++i) {
                x[0].push_back(i);
                x[1].push_back(j);
                x[2].push_back(k);
            }
        }
    }
    file.add_zone("water", x, 2);
    const std::vector<cgsize_t> plate = upward ? std::vector<cgsize_t>{5, 6, 8, 7} : std::vector<cgsize_t>{7, 8, 6, 5};
    if (!polyhedra) {
        file.section("cells", CGNS_ENUMV(HEXA_8), {1, 2, 4, 3, 5, 6, 8, 7, 5, 6, 8, 7, 9, 10, 12, 11}, 8);
        file.section("faces", CGNS_ENUMV(QUAD_4), plate, 4);
        file.condition("plate", type, CGNS_ENUMV(PointList), CGNS_ENUMV(FaceCenter), {3});
    } else {
        std::vector<cgsize_t> faces = plate;
        for (const cgsize_t up : {0, 4}) {
            for (const cgsize_t node : {1, 2, 6, 5, 2, 4, 8, 6, 4, 3, 7, 8, 3, 1, 5, 7}) {
                faces.push_back(node + up);
            }
        }
        faces.insert(faces.end(), {1, 3, 4, 2, 9, 10, 12, 11});
        std::vector<cgsize_t> starts;
        for (cgsize_t f = 0; f <= 11; ++f) {
            starts.push_back(4 * f);
        }
        const cgsize_t out = upward ? 1 : -1;
        const std::vector<cgsize_t> cells = {out, 2, 3, 4, 5, 10, -out, 6, 7, 8, 9, 11};
        const std::vector<cgsize_t> cell_starts = {0, 6, 12};
        int index = 0;
        CgnsWriter::ok(cg_poly_section_write(file.file, file.base, file.zone, "faces", CGNS_ENUMV(NGON_n), 1, 11, 0,
                                             faces.data(), starts.data(), &index));
        CgnsWriter::ok(cg_poly_section_write(file.file, file.base, file.zone, "cells", CGNS_ENUMV(NFACE_n), 12, 13, 0,
                                             cells.data(), cell_starts.data(), &index));
        file.condition("plate", type, CGNS_ENUMV(PointList), CGNS_ENUMV(FaceCenter), {1});
    }
    file.solution("Cells", CGNS_ENUMV(CellCenter), "Pressure", {10, 20});
}

}  // namespace

TEST(CgnsBoundaries, AWallBetweenTwoCellsHasTwoSides) {
    const core::TemporaryFolder folder;
    for (const bool polyhedra : {false, true}) {
        for (const bool upward : {false, true}) {
            write_two_cubes(folder.path() / "a.cgns", CGNS_ENUMV(BCWall), polyhedra, upward);
            const auto field = read_field(folder.path() / "a.cgns");
            ASSERT_NE(field.find("plate-shadow"), nullptr);
            EXPECT_TRUE(field.find("plate")->normals_into_fluid);
            EXPECT_TRUE(field.find("plate-shadow")->normals_into_fluid);
            EXPECT_EQ(field.find("plate-shadow")->kind, ZoneKind::wall);
            EXPECT_NEAR(postproc::loads(field).total.force[2], 10 - 20, 1e-12);
            EXPECT_THAT(told(field), HasSubstr("the other side is 'plate-shadow'"));
        }
    }
    write_two_cubes(folder.path() / "a.cgns", CGNS_ENUMV(BCInflow), false, true);
    const auto fan = read_field(folder.path() / "a.cgns");
    EXPECT_EQ(fan.find("plate-shadow"), nullptr);
    EXPECT_EQ(fan.find("plate")->surface->GetCellData()->GetArray("pressure")->GetTuple1(0), 15);
}

TEST(CgnsBoundaries, LinesOnASurfaceInSpaceHaveNoSides) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns", 2, 3);
        file.add_zone("skin", {{{0, 1, 0, 1, 0, 1}, {0, 0, 1, 1, 1, 1}, {0, 0, 0, 0, 1, 1}}}, 2);
        file.section("faces", CGNS_ENUMV(QUAD_4), {1, 2, 4, 3, 3, 4, 6, 5}, 4);
        file.section("edge", CGNS_ENUMV(BAR_2), {3, 4}, 2);
    }
    const auto field = read_field(folder.path() / "a.cgns");
    EXPECT_NE(field.find("edge"), nullptr);
    EXPECT_EQ(field.find("edge-shadow"), nullptr);
}

TEST(CgnsBoundaries, PlaneWallsHaveTheFluidOnTheirLeft) {
    const core::TemporaryFolder folder;
    {
        CgnsWriter file(folder.path() / "a.cgns", 2, 2);
        file.add_zone("water", {{{0, 1, 0, 1, 0, 1}, {0, 0, 1, 1, 2, 2}, {}}}, 2);
        file.section("cells", CGNS_ENUMV(QUAD_4), {1, 2, 4, 3, 3, 4, 6, 5}, 4);
        file.section("lines", CGNS_ENUMV(BAR_2), {2, 1, 3, 4}, 2);
        file.condition("floor", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointList), CGNS_ENUMV(EdgeCenter), {3});
        file.condition("plate", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointList), CGNS_ENUMV(EdgeCenter), {4});
        file.solution("Cells", CGNS_ENUMV(CellCenter), "Pressure", {10, 20});
    }
    const auto field = read_field(folder.path() / "a.cgns");
    const auto force_on = [&](const std::string& zones) {
        postproc::LoadsOptions options;
        options.zones = {zones};
        return postproc::loads(field, options).total.force[1];
    };
    EXPECT_TRUE(field.find("floor")->normals_into_fluid);
    EXPECT_NEAR(force_on("floor"), -10, 1e-12);
    EXPECT_NEAR(force_on("plate*"), 10 - 20, 1e-12);
}

}  // namespace underbody
