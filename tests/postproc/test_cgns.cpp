// CGNS files that the tests write through libcgns: every kind of element, polyhedra, boundaries as CFX and others give
// them, in ADF and HDF5.
#include <cgns_io.h>
#include <cgnslib.h>
#include <gmock/gmock.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkPointData.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "core/file.h"
#include "import_support.h"
#include "postproc/loads/loads.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using postproc::ZoneKind;
using ::testing::HasSubstr;

namespace {

namespace fs = std::filesystem;

using Nodes = std::vector<cgsize_t>;  // from 1

/// A cube, a wedge beside it, a pyramid on top and a tetrahedron on that; and a pentagonal prism on the other side.
const std::vector<std::array<double, 3>> points = {{0, 0, 0},    {1, 0, 0},     {1, 1, 0},     {0, 1, 0}, {0, 0, 1},
                                                   {1, 0, 1},    {1, 1, 1},     {0, 1, 1},     {2, 0, 0}, {2.5, 0.5, 0},
                                                   {2, 1, 0},    {2, 0, 1},     {2.5, 0.5, 1}, {2, 1, 1}, {-1, 0.5, 0},
                                                   {-1, 0.5, 1}, {0.5, 0.5, 2}, {2, 0.5, 2}};
struct Cell {
    CGNS_ENUMT(ElementType_t) type;
    Nodes nodes;
    std::vector<Nodes> faces;
};
const std::vector<Cell> cells = {
    {CGNS_ENUMV(HEXA_8),
     {1, 2, 3, 4, 5, 6, 7, 8},
     {{1, 2, 3, 4}, {5, 6, 7, 8}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}}},
    {CGNS_ENUMV(PENTA_6), {1, 4, 15, 5, 8, 16}, {{1, 4, 15}, {5, 8, 16}, {1, 4, 8, 5}, {4, 15, 16, 8}, {15, 1, 5, 16}}},
    {CGNS_ENUMV(PYRA_5), {5, 6, 7, 8, 17}, {{5, 6, 7, 8}, {5, 6, 17}, {6, 7, 17}, {7, 8, 17}, {8, 5, 17}}},
    {CGNS_ENUMV(TETRA_4), {6, 7, 17, 18}, {{6, 7, 17}, {6, 7, 18}, {7, 17, 18}, {17, 6, 18}}}};
const Cell prism = {CGNS_ENUMV(NFACE_n),
                    {},
                    {{2, 9, 10, 11, 3},
                     {6, 12, 13, 14, 7},
                     {2, 9, 12, 6},
                     {9, 10, 13, 12},
                     {10, 11, 14, 13},
                     {11, 3, 7, 14},
                     {2, 3, 7, 6}}};
constexpr double volume = 1 + 0.5 + 1.0 / 3 + 0.25;

/// Faces that only one cell has.
std::vector<Nodes> hull(const std::vector<Cell>& of) {
    std::map<std::set<cgsize_t>, std::pair<int, Nodes>> seen;
    for (const auto& cell : of) {
        for (const auto& face : cell.faces) {
            auto& entry = seen[std::set<cgsize_t>(face.begin(), face.end())];
            ++entry.first;
            entry.second = face;
        }
    }
    std::vector<Nodes> result;
    for (const auto& [key, entry] : seen) {
        if (entry.first == 1) {
            result.push_back(entry.second);
        }
    }
    return result;
}

class File {
public:
    File(const fs::path& path, int type, std::size_t zone_cells) {
        cg_set_file_type(type);
        ok(cg_open(path.c_str(), CG_MODE_WRITE, &file_));
        cg_set_file_type(CG_FILE_NONE);
        ok(cg_base_write(file_, "Base", 3, 3, &base_));
        const cgsize_t size[3] = {static_cast<cgsize_t>(points.size()), static_cast<cgsize_t>(zone_cells), 0};
        ok(cg_zone_write(file_, base_, "Domain 1", size, CGNS_ENUMV(Unstructured), &zone_));
        const char* names[] = {"CoordinateX", "CoordinateY", "CoordinateZ"};
        for (std::size_t k = 0; k < 3; ++k) {
            std::vector<double> column;
            for (const auto& point : points) {
                column.push_back(point[k]);
            }
            int index = 0;
            ok(cg_coord_write(file_, base_, zone_, CGNS_ENUMV(RealDouble), names[k], column.data(), &index));
        }
    }
    ~File() { cg_close(file_); }
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    /// Elements of one kind, or with their kinds in front (MIXED), or with offsets alone (NGON_n, NFACE_n).
    void section(const std::string& name, CGNS_ENUMT(ElementType_t) type,
                 const std::vector<std::pair<CGNS_ENUMT(ElementType_t), Nodes>>& elements) {
        Nodes list;
        Nodes offsets = {0};
        for (const auto& [kind, nodes] : elements) {
            if (type == CGNS_ENUMV(MIXED)) {
                list.push_back(kind);
            }
            list.insert(list.end(), nodes.begin(), nodes.end());
            offsets.push_back(static_cast<cgsize_t>(list.size()));
        }
        const auto last = next_ + static_cast<cgsize_t>(elements.size()) - 1;
        int index = 0;
        const bool lists = type == CGNS_ENUMV(MIXED) || type == CGNS_ENUMV(NGON_n) || type == CGNS_ENUMV(NFACE_n);
        ok(lists ? cg_poly_section_write(file_, base_, zone_, name.c_str(), type, next_, last, 0, list.data(),
                                         offsets.data(), &index)
                 : cg_section_write(file_, base_, zone_, name.c_str(), type, next_, last, 0, list.data(), &index));
        next_ = last + 1;
    }
    void pressure(CGNS_ENUMT(GridLocation_t) where, const std::vector<float>& values) {
        int solution = 0;
        int field = 0;
        ok(cg_sol_write(file_, base_, zone_, where == CGNS_ENUMV(Vertex) ? "Flow Solution" : "Cells", where,
                        &solution));
        ok(cg_field_write(file_, base_, zone_, solution, CGNS_ENUMV(RealSingle), "Pressure", values.data(), &field));
    }
    int condition(const std::string& name, CGNS_ENUMT(BCType_t) type, CGNS_ENUMT(PointSetType_t) set,
                  CGNS_ENUMT(GridLocation_t) where, const Nodes& list) {
        int index = 0;
        ok(cg_boco_write(file_, base_, zone_, name.c_str(), type, set, static_cast<cgsize_t>(list.size()), list.data(),
                         &index));
        ok(cg_boco_gridlocation_write(file_, base_, zone_, index, where));
        return index;
    }
    void family(int condition_index, const std::string& name, CGNS_ENUMT(BCType_t) type) {
        int family = 0;
        int index = 0;
        ok(cg_family_write(file_, base_, name.c_str(), &family));
        ok(cg_fambc_write(file_, base_, family, "FamBC", type, &index));
        ok(cg_goto(file_, base_, "Zone_t", zone_, "ZoneBC_t", 1, "BC_t", condition_index, "end"));
        ok(cg_famname_write(name.c_str()));
    }
    void units(CGNS_ENUMT(MassUnits_t) mass, CGNS_ENUMT(LengthUnits_t) length) {
        ok(cg_goto(file_, base_, "end"));
        ok(cg_units_write(mass, length, CGNS_ENUMV(Second), CGNS_ENUMV(Kelvin), CGNS_ENUMV(Radian)));
    }
    [[nodiscard]] cgsize_t next() const { return next_; }

private:
    static void ok(int result) { ASSERT_EQ(result, CG_OK) << cg_get_error(); }
    int file_ = 0;
    int base_ = 0;
    int zone_ = 0;
    cgsize_t next_ = 1;
};

CGNS_ENUMT(ElementType_t) kind_of_face(const Nodes& face) {
    return face.size() == 3 ? CGNS_ENUMV(TRI_3) : CGNS_ENUMV(QUAD_4);
}

std::vector<std::pair<CGNS_ENUMT(ElementType_t), Nodes>> faces_where(const std::vector<Nodes>& all, bool floor) {
    std::vector<std::pair<CGNS_ENUMT(ElementType_t), Nodes>> result;
    for (const auto& face : all) {
        const bool low = std::all_of(face.begin(), face.end(),
                                     [](cgsize_t n) { return points[static_cast<std::size_t>(n - 1)][2] == 0; });
        if (low == floor) {
            result.emplace_back(kind_of_face(face), face);
        }
    }
    return result;
}

/// Pressure 1 + 2x + 3y + 4z at the nodes.
std::vector<float> linear() {
    std::vector<float> values;
    for (const auto& p : points) {
        values.push_back(static_cast<float>(1 + 2 * p[0] + 3 * p[1] + 4 * p[2]));
    }
    return values;
}

/// As CFX writes: mixed elements, one 2-D section a boundary, conditions with lists of vertices.
void write_like_cfx(const fs::path& path, int type) {
    File file(path, type, cells.size());
    std::vector<std::pair<CGNS_ENUMT(ElementType_t), Nodes>> all;
    for (const auto& cell : cells) {
        all.emplace_back(cell.type, cell.nodes);
    }
    file.section("B1.P3", CGNS_ENUMV(MIXED), all);
    file.section("in1", CGNS_ENUMV(MIXED), faces_where(hull(cells), true));
    file.section("Tank Default", CGNS_ENUMV(MIXED), faces_where(hull(cells), false));
    file.pressure(CGNS_ENUMV(Vertex), linear());
    file.condition("in1", CGNS_ENUMV(BCInflow), CGNS_ENUMV(PointList), CGNS_ENUMV(Vertex), {1, 2, 3, 4, 15});
    file.condition("Tank Default", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointList), CGNS_ENUMV(Vertex),
                   {5, 6, 7, 8, 16, 17, 18});
}

/// Sum of the area vectors (as the force of a pressure of one) and of the pressure over all surfaces.
void expect_closed_with_gauss(const postproc::Field& field, double enclosed) {
    test::Triple force{};
    test::Triple opening{};
    for (const auto& zone : field.zones) {
        if (zone.surface == nullptr) {
            continue;
        }
        EXPECT_TRUE(zone.normals_into_fluid) << zone.name;
        for (vtkIdType c = 0; c < zone.surface->GetNumberOfCells(); ++c) {
            // Linear over triangles; over the plane quadrilaterals of this mesh the mean of the corners, which are
            // parallelograms.
            auto* cell = zone.surface->GetCell(c);
            auto* values = zone.surface->GetPointData()->GetArray("pressure");
            const vtkIdType n = cell->GetNumberOfPoints();
            double mean = 0;
            std::array<std::array<double, 3>, 8> x{};
            for (vtkIdType i = 0; i < n; ++i) {
                mean += values->GetTuple1(cell->GetPointId(i)) / static_cast<double>(n);
                zone.surface->GetPoint(cell->GetPointId(i), x[static_cast<std::size_t>(i)].data());
            }
            std::array<double, 3> area{};
            for (std::size_t i = 1; i + 1 < static_cast<std::size_t>(n); ++i) {
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::size_t a = (k + 1) % 3;
                    const std::size_t b = (k + 2) % 3;
                    area[k] += ((x[i][a] - x[0][a]) * (x[i + 1][b] - x[0][b]) -
                                (x[i][b] - x[0][b]) * (x[i + 1][a] - x[0][a])) /
                               2;
                }
            }
            for (std::size_t k = 0; k < 3; ++k) {
                force[k] -= mean * area[k];
                opening[k] += area[k];
            }
        }
    }
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(opening[k], 0, 1e-12);
        EXPECT_NEAR(force[k], (2.0 + static_cast<double>(k)) * enclosed,
                    1e-5);  // gradient (2, 3, 4), normals into the fluid
    }
}

}  // namespace

TEST(Cgns, CfxFilesInBothCodingsHaveCellsBoundariesAndClosedSurfaces) {
    for (const int type : {CG_FILE_ADF, CG_FILE_HDF5}) {
        SCOPED_TRACE(type);
        const core::TemporaryFolder folder;
        write_like_cfx(folder.path() / "a.cgns", type);
        const auto field = read_field(folder.path() / "a.cgns");
        EXPECT_EQ(field.format, "CGNS");
        const auto* domain = field.find("Domain 1");
        ASSERT_NE(domain, nullptr);
        for (const int cell : {VTK_HEXAHEDRON, VTK_WEDGE, VTK_PYRAMID, VTK_TETRA}) {
            EXPECT_EQ(test::count_cells(*domain->volume, cell), 1) << cell;
        }
        EXPECT_NEAR(test::volume_of(*domain->volume), volume, 1e-12);
        EXPECT_GT(test::smallest_volume(*domain->volume), 0.2);
        ASSERT_NE(field.find("in1"), nullptr);
        EXPECT_EQ(field.find("in1")->kind, ZoneKind::inlet);
        EXPECT_EQ(field.find("in1")->surface->GetNumberOfCells(), 2);
        ASSERT_NE(field.find("Tank Default"), nullptr);
        EXPECT_EQ(field.find("Tank Default")->kind, ZoneKind::wall);
        expect_closed_with_gauss(field, volume);
    }
}

TEST(Cgns, SectionsOfOneKindWithFacesInConditionsAndFamilies) {
    const core::TemporaryFolder folder;
    {
        File file(folder.path() / "a.cgns", CG_FILE_HDF5, cells.size());
        for (const auto& cell : cells) {
            file.section("kind " + std::to_string(cell.type), cell.type, {{cell.type, cell.nodes}});
        }
        const cgsize_t first = file.next();
        std::vector<std::pair<CGNS_ENUMT(ElementType_t), Nodes>> triangles;
        std::vector<std::pair<CGNS_ENUMT(ElementType_t), Nodes>> quads;
        for (const auto& face : hull(cells)) {
            (face.size() == 3 ? triangles : quads).emplace_back(kind_of_face(face), face);
        }
        file.section("triangles", CGNS_ENUMV(TRI_3), triangles);
        const cgsize_t middle = file.next();
        file.section("quads", CGNS_ENUMV(QUAD_4), quads);
        file.pressure(CGNS_ENUMV(Vertex), linear());
        file.pressure(CGNS_ENUMV(CellCenter), {10, 20, 30, 40});
        Nodes list;
        for (cgsize_t e = first; e < middle; ++e) {
            list.push_back(e);
        }
        const int body =
            file.condition("body", CGNS_ENUMV(FamilySpecified), CGNS_ENUMV(PointList), CGNS_ENUMV(FaceCenter), list);
        file.condition("far", CGNS_ENUMV(BCFarfield), CGNS_ENUMV(PointRange), CGNS_ENUMV(FaceCenter),
                       {middle, file.next() - 1});
        file.family(body, "hulls", CGNS_ENUMV(BCWallViscous));
    }
    const auto field = read_field(folder.path() / "a.cgns");
    EXPECT_NEAR(test::volume_of(field), volume, 1e-12);
    ASSERT_NE(field.find("body"), nullptr);
    EXPECT_EQ(field.find("body")->kind, ZoneKind::wall);
    ASSERT_NE(field.find("far"), nullptr);
    EXPECT_EQ(field.find("far")->kind, ZoneKind::farfield);
    EXPECT_EQ(field.find("triangles"), nullptr);  // shown by its condition
    auto* on_cells = field.find("Domain 1")->volume->GetCellData()->GetArray("pressure");
    ASSERT_NE(on_cells, nullptr);
    EXPECT_EQ(on_cells->GetTuple1(3), 40);
    expect_closed_with_gauss(field, volume);
}

TEST(Cgns, PolyhedraOfFacesAreWhole) {
    const core::TemporaryFolder folder;
    {
        std::vector<Cell> all = cells;
        all.push_back(prism);
        File file(folder.path() / "a.cgns", CG_FILE_HDF5, all.size());
        std::map<std::set<cgsize_t>, cgsize_t> numbers;
        std::vector<std::pair<CGNS_ENUMT(ElementType_t), Nodes>> faces;
        std::vector<std::pair<CGNS_ENUMT(ElementType_t), Nodes>> bodies;
        for (const auto& cell : all) {
            Nodes list;
            std::array<double, 3> centre{};
            std::set<cgsize_t> used;
            for (const auto& face : cell.faces) {
                used.insert(face.begin(), face.end());
            }
            for (const cgsize_t n : used) {
                for (std::size_t k = 0; k < 3; ++k) {
                    centre[k] += points[static_cast<std::size_t>(n - 1)][k] / static_cast<double>(used.size());
                }
            }
            for (const auto& face : cell.faces) {
                const std::set<cgsize_t> key(face.begin(), face.end());
                const bool fresh = !numbers.contains(key);
                if (fresh) {
                    faces.emplace_back(CGNS_ENUMV(NGON_n), face);
                    numbers[key] = static_cast<cgsize_t>(faces.size());
                }
                // The sign says whether the stored order looks out of this cell.
                const Nodes& stored = faces[static_cast<std::size_t>(numbers[key] - 1)].second;
                const auto& a = points[static_cast<std::size_t>(stored[0] - 1)];
                const auto& b = points[static_cast<std::size_t>(stored[1] - 1)];
                const auto& c = points[static_cast<std::size_t>(stored[2] - 1)];
                double out = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::size_t m = (k + 1) % 3;
                    const std::size_t n = (k + 2) % 3;
                    out += ((b[m] - a[m]) * (c[n] - a[n]) - (b[n] - a[n]) * (c[m] - a[m])) * (a[k] - centre[k]);
                }
                list.push_back(out > 0 ? numbers[key] : -numbers[key]);
            }
            bodies.emplace_back(CGNS_ENUMV(NFACE_n), list);
        }
        file.section("faces", CGNS_ENUMV(NGON_n), faces);
        file.section("cells", CGNS_ENUMV(NFACE_n), bodies);
        const cgsize_t pentagon = numbers[std::set<cgsize_t>(prism.faces[0].begin(), prism.faces[0].end())];
        file.condition("end", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointList), CGNS_ENUMV(FaceCenter), {pentagon});
    }
    const auto field = read_field(folder.path() / "a.cgns");
    const auto* domain = field.find("Domain 1");
    ASSERT_NE(domain, nullptr);
    EXPECT_EQ(test::count_cells(*domain->volume, VTK_POLYHEDRON), 5);
    EXPECT_NEAR(test::volume_of(*domain->volume), volume + 1.25, 1e-12);
    EXPECT_GT(test::smallest_volume(*domain->volume), 0.2);
    ASSERT_NE(field.find("end"), nullptr);
    EXPECT_NEAR(test::area_of(*field.find("end")->surface), 1.25, 1e-12);
}

TEST(Cgns, APlaneCaseHasAreasAndLines) {
    for (const int type : {CG_FILE_HDF5, CG_FILE_ADF}) {
        const core::TemporaryFolder folder;
        const fs::path path = folder.path() / "plane.cgns";
        int file = 0;
        int base = 0;
        int zone = 0;
        int index = 0;
        cg_set_file_type(type);
        ASSERT_EQ(cg_open(path.c_str(), CG_MODE_WRITE, &file), CG_OK);
        cg_set_file_type(CG_FILE_NONE);
        cg_base_write(file, "Base", 2, 2, &base);
        const cgsize_t size[3] = {5, 2, 0};  // a unit square and a triangle beside it
        cg_zone_write(file, base, "plane", size, CGNS_ENUMV(Unstructured), &zone);
        const double x[] = {0, 1, 1, 0, 2};
        const double y[] = {0, 0, 1, 1, 0};
        cg_coord_write(file, base, zone, CGNS_ENUMV(RealDouble), "CoordinateX", x, &index);
        cg_coord_write(file, base, zone, CGNS_ENUMV(RealDouble), "CoordinateY", y, &index);
        const cgsize_t quads[] = {1, 2, 3, 4};
        const cgsize_t triangles[] = {2, 5, 3};
        const cgsize_t rim[] = {1, 2, 2, 5, 5, 3, 3, 4, 4, 1};
        cg_section_write(file, base, zone, "quads", CGNS_ENUMV(QUAD_4), 1, 1, 0, quads, &index);
        cg_section_write(file, base, zone, "triangles", CGNS_ENUMV(TRI_3), 2, 2, 0, triangles, &index);
        cg_section_write(file, base, zone, "rim", CGNS_ENUMV(BAR_2), 3, 7, 0, rim, &index);
        const cgsize_t range[] = {3, 7};
        cg_boco_write(file, base, zone, "wall", CGNS_ENUMV(BCWall), CGNS_ENUMV(PointRange), 2, range, &index);
        cg_boco_gridlocation_write(file, base, zone, index, CGNS_ENUMV(EdgeCenter));
        const double pressure[] = {0, 1, 1, 0, 2};  // x
        int solution = 0;
        cg_sol_write(file, base, zone, "Flow Solution", CGNS_ENUMV(Vertex), &solution);
        cg_field_write(file, base, zone, solution, CGNS_ENUMV(RealDouble), "Pressure", pressure, &index);
        ASSERT_EQ(cg_close(file), CG_OK);
        const auto field = read_field(path);
        EXPECT_EQ(field.dimension, 2);
        EXPECT_EQ(test::cells_of(field), 2);
        EXPECT_NEAR(test::volume_of(field), 1.5, 1e-12);
        const auto* wall = field.find("wall");
        ASSERT_NE(wall, nullptr);
        EXPECT_EQ(wall->kind, ZoneKind::wall);
        EXPECT_EQ(wall->surface->GetNumberOfLines(), 5);
        EXPECT_NEAR(test::area_of(*wall->surface), 1 + 1 + std::sqrt(2.0) + 1 + 1, 1e-12);
        EXPECT_NE(wall->find("pressure"), nullptr);
    }
}

TEST(Cgns, BoundariesTakeThePressureOfTheCellsBehindThem) {
    const core::TemporaryFolder folder;
    {
        File file(folder.path() / "a.cgns", CG_FILE_HDF5, cells.size());
        std::vector<std::pair<CGNS_ENUMT(ElementType_t), Nodes>> all;
        for (const auto& cell : cells) {
            all.emplace_back(cell.type, cell.nodes);
        }
        file.section("cells", CGNS_ENUMV(MIXED), all);
        file.section("floor", CGNS_ENUMV(MIXED), faces_where(hull(cells), true));
        file.section("rest", CGNS_ENUMV(MIXED), faces_where(hull(cells), false));
        file.pressure(CGNS_ENUMV(CellCenter), {10, 20, 30, 40});
    }
    const auto field = read_field(folder.path() / "a.cgns");
    const auto* floor = field.find("floor");
    ASSERT_NE(floor->find("pressure"), nullptr);
    EXPECT_EQ(floor->find("pressure")->on, postproc::Location::cells);
    std::multiset<double> found;
    for (vtkIdType i = 0; i < floor->surface->GetNumberOfCells(); ++i) {
        const double value = floor->surface->GetCellData()->GetArray("pressure")->GetTuple1(i);
        EXPECT_EQ(floor->surface->GetCell(i)->GetNumberOfPoints(), value == 10 ? 4 : 3);
        found.insert(value);
    }
    EXPECT_EQ(found, (std::multiset<double>{10, 20}));  // the cube and the wedge stand on the floor
    EXPECT_EQ(test::range_of(*field.find("rest")->surface, "pressure").high, 40);
}

TEST(Cgns, BoundariesKeepThePressureOfTheirNodesWhereTheCellsHaveOneToo) {
    for (const bool cells_first : {false, true}) {
        SCOPED_TRACE(cells_first ? "cells first" : "nodes first");
        const core::TemporaryFolder folder;
        {
            File file(folder.path() / "a.cgns", CG_FILE_HDF5, cells.size());
            std::vector<std::pair<CGNS_ENUMT(ElementType_t), Nodes>> all;
            for (const auto& cell : cells) {
                all.emplace_back(cell.type, cell.nodes);
            }
            file.section("cells", CGNS_ENUMV(MIXED), all);
            file.section("hull", CGNS_ENUMV(MIXED), faces_where(hull(cells), false));
            file.section("floor", CGNS_ENUMV(MIXED), faces_where(hull(cells), true));
            if (cells_first) {
                file.pressure(CGNS_ENUMV(CellCenter), {10, 20, 30, 40});
            }
            file.pressure(CGNS_ENUMV(Vertex), linear());
            if (!cells_first) {
                file.pressure(CGNS_ENUMV(CellCenter), {10, 20, 30, 40});
            }
        }
        const auto field = read_field(folder.path() / "a.cgns");
        for (const char* name : {"hull", "floor"}) {
            const auto* zone = field.find(name);
            ASSERT_NE(zone, nullptr);
            ASSERT_NE(zone->find("pressure"), nullptr);
            EXPECT_EQ(zone->find("pressure")->on, postproc::Location::nodes);
            EXPECT_EQ(zone->surface->GetCellData()->GetArray("pressure"), nullptr);
            auto* pressure = zone->surface->GetPointData()->GetArray("pressure");
            ASSERT_NE(pressure, nullptr);
            for (vtkIdType i = 0; i < zone->surface->GetNumberOfPoints(); ++i) {
                const double* p = zone->surface->GetPoint(i);
                EXPECT_NEAR(pressure->GetTuple1(i), 1 + 2 * p[0] + 3 * p[1] + 4 * p[2], 1e-6);
            }
        }
        expect_closed_with_gauss(field, volume);
        EXPECT_EQ(test::range_of(*field.find("Domain 1")->volume, "pressure").high, 40);
    }
}

/// As a later library would have written it: its version is all that the one here looks at.
void set_version(const fs::path& path, float version) {
    int file = 0;
    double root = 0;
    double node = 0;
    ASSERT_EQ(cgio_open_file(path.c_str(), CGIO_MODE_MODIFY, CGIO_FILE_NONE, &file), CGIO_ERR_NONE);
    ASSERT_EQ(cgio_get_root_id(file, &root), CGIO_ERR_NONE);
    ASSERT_EQ(cgio_get_node_id(file, root, "CGNSLibraryVersion", &node), CGIO_ERR_NONE);
    ASSERT_EQ(cgio_write_all_data(file, node, &version), CGIO_ERR_NONE);
    ASSERT_EQ(cgio_close_file(file), CGIO_ERR_NONE);
}

TEST(Cgns, FilesOfALaterLibraryAreRead) {
    const core::TemporaryFolder folder;
    for (const int type : {CG_FILE_HDF5, CG_FILE_ADF}) {
        const fs::path path = folder.path() / "a.cgns";
        write_like_cfx(path, type);
        const auto before = read_field(path);
        set_version(path, 4.4F);
        int file = 0;
        ASSERT_NE(cg_open(path.c_str(), CG_MODE_READ, &file), CG_OK)
            << "the library reads it itself: the detour may go";
        const auto field = read_field(path);
        EXPECT_EQ(test::volume_of(field), test::volume_of(before));
        ASSERT_EQ(field.zones.size(), before.zones.size());
        for (std::size_t z = 0; z < field.zones.size(); ++z) {
            EXPECT_EQ(field.zones[z].name, before.zones[z].name);
            EXPECT_EQ(field.zones[z].kind, before.zones[z].kind);
            EXPECT_EQ(field.zones[z].arrays.size(), before.zones[z].arrays.size());
        }
        const auto told = [](const auto& problem) {
            return problem.message.find("written by CGNS 4.4") != std::string::npos;
        };
        EXPECT_TRUE(std::any_of(field.problems.begin(), field.problems.end(), told));
        EXPECT_NE(test::refusal((core::write_file(folder.path() / "cut.cgns", core::read_file(path).substr(0, 3000)),
                                 folder.path() / "cut.cgns")),
                  "");
    }
}

/// A new HDF5 file with an empty base 1.
int new_file(const fs::path& path, int cell_dimension) {
    int file = 0;
    int base = 0;
    cg_set_file_type(CG_FILE_HDF5);
    EXPECT_EQ(cg_open(path.c_str(), CG_MODE_WRITE, &file), CG_OK);
    cg_set_file_type(CG_FILE_NONE);
    EXPECT_EQ(cg_base_write(file, "Base", cell_dimension, 3, &base), CG_OK);
    return file;
}

/// An unstructured zone with one section of elements of a kind; its number.
int add_zone(int file, const char* name, const std::array<std::vector<double>, 3>& x, CGNS_ENUMT(ElementType_t) kind,
             cgsize_t elements, const Nodes& nodes) {
    int zone = 0;
    int index = 0;
    const cgsize_t size[3] = {static_cast<cgsize_t>(x[0].size()), elements, 0};
    EXPECT_EQ(cg_zone_write(file, 1, name, size, CGNS_ENUMV(Unstructured), &zone), CG_OK);
    const char* names[] = {"CoordinateX", "CoordinateY", "CoordinateZ"};
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(cg_coord_write(file, 1, zone, CGNS_ENUMV(RealDouble), names[k], x[k].data(), &index), CG_OK);
    }
    EXPECT_EQ(cg_section_write(file, 1, zone, "elements", kind, 1, elements, 0, nodes.data(), &index), CG_OK);
    return zone;
}

TEST(Cgns, FacesInSpaceAreASurfaceAndOneComponentIsNoVector) {
    const core::TemporaryFolder folder;
    const fs::path path = folder.path() / "shell.cgns";
    const int file = new_file(path, 2);
    // A unit cube, its lower side in a zone of its own, all normals outward.
    const std::array<std::vector<double>, 3> x = {
        {{0, 1, 1, 0, 0, 1, 1, 0}, {0, 0, 1, 1, 0, 0, 1, 1}, {0, 0, 0, 0, 1, 1, 1, 1}}};
    const auto add = [&](const char* name, const Nodes& quads) {
        const int zone = add_zone(file, name, x, CGNS_ENUMV(QUAD_4), static_cast<cgsize_t>(quads.size() / 4), quads);
        int solution = 0;
        int index = 0;
        ASSERT_EQ(cg_sol_write(file, 1, zone, "Solution", CGNS_ENUMV(Vertex), &solution), CG_OK);
        ASSERT_EQ(cg_field_write(file, 1, zone, solution, CGNS_ENUMV(RealDouble), "Pressure", x[2].data(), &index),
                  CG_OK);
        ASSERT_EQ(cg_field_write(file, 1, zone, solution, CGNS_ENUMV(RealDouble), "VelocityX", x[0].data(), &index),
                  CG_OK);
    };
    add("base", {1, 4, 3, 2});
    add("hull", {5, 6, 7, 8, 1, 2, 6, 5, 2, 3, 7, 6, 3, 4, 8, 7, 4, 1, 5, 8});
    ASSERT_EQ(cg_close(file), CG_OK);
    postproc::ReadOptions options;
    options.surfaces_only = true;
    const auto field = read_field(path, options);
    ASSERT_EQ(field.zones.size(), 2U);
    double lift = 0;
    for (const auto& one : field.zones) {
        ASSERT_NE(one.surface, nullptr) << one.name;
        lift += postproc::loads(field).total.force[2] / 2;
        ASSERT_NE(one.find("velocity_x"), nullptr);
        EXPECT_EQ(one.find("velocity"), nullptr);
    }
    EXPECT_NEAR(lift, -1, 1e-12);  // p = z pushes the lid down
}

TEST(Cgns, ATimeIsChosenAmongTheSolutionsOfSteps) {
    const core::TemporaryFolder folder;
    const fs::path path = folder.path() / "steps.cgns";
    const int file = new_file(path, 3);
    const int zone =
        add_zone(file, "water", {{{0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}, CGNS_ENUMV(TETRA_4), 1, {1, 2, 3, 4});
    int index = 0;
    std::string pointers;
    for (int step = 1; step <= 3; ++step) {
        const std::string name = "Solution" + std::to_string(step);
        int solution = 0;
        ASSERT_EQ(cg_sol_write(file, 1, zone, name.c_str(), CGNS_ENUMV(Vertex), &solution), CG_OK);
        const double pressure[4] = {10.0 * step, 0, 0, 0};
        ASSERT_EQ(cg_field_write(file, 1, zone, solution, CGNS_ENUMV(RealDouble), "Pressure", pressure, &index), CG_OK);
        pointers += name + std::string(32 - name.size(), ' ');
    }
    const double times[3] = {0.5, 1, 1.5};
    const cgsize_t three = 3;
    const cgsize_t text[2] = {32, 3};
    ASSERT_EQ(cg_biter_write(file, 1, "Steps", 3), CG_OK);
    ASSERT_EQ(cg_goto(file, 1, "BaseIterativeData_t", 1, "end"), CG_OK);
    ASSERT_EQ(cg_array_write("TimeValues", CGNS_ENUMV(RealDouble), 1, &three, times), CG_OK);
    ASSERT_EQ(cg_ziter_write(file, 1, zone, "ZoneSteps"), CG_OK);
    ASSERT_EQ(cg_goto(file, 1, "Zone_t", zone, "ZoneIterativeData_t", 1, "end"), CG_OK);
    ASSERT_EQ(cg_array_write("FlowSolutionPointers", CGNS_ENUMV(Character), 2, text, pointers.c_str()), CG_OK);
    ASSERT_EQ(cg_close(file), CG_OK);
    const auto pressure_at = [&](std::optional<double> time) {
        postproc::ReadOptions options;
        options.time = time;
        const auto field = read_field(path, options);
        return field.zones.at(0).volume->GetPointData()->GetArray("pressure")->GetTuple1(0);
    };
    EXPECT_EQ(pressure_at({}), 30);
    EXPECT_EQ(pressure_at(0.5), 10);
    EXPECT_EQ(pressure_at(1), 20);
    postproc::ReadOptions options;
    options.time = 0.7;
    EXPECT_THAT(test::refusal(path, options), HasSubstr("0.5"));
}

TEST(Cgns, EveryValueIsInTheUnitsThatTheFileStates) {
    const core::TemporaryFolder folder;
    {
        File file(folder.path() / "a.cgns", CG_FILE_HDF5, cells.size());
        file.units(CGNS_ENUMV(Gram), CGNS_ENUMV(Centimeter));
        std::vector<std::pair<CGNS_ENUMT(ElementType_t), Nodes>> all;
        for (const auto& cell : cells) {
            all.emplace_back(cell.type, cell.nodes);
        }
        file.section("cells", CGNS_ENUMV(MIXED), all);
        file.pressure(CGNS_ENUMV(Vertex), linear());
    }
    const auto field = read_field(folder.path() / "a.cgns");
    EXPECT_NEAR(test::volume_of(field), volume * 1e-6, 1e-15);
    auto* pressure = field.find("Domain 1")->volume->GetPointData()->GetArray("pressure");
    EXPECT_NEAR(pressure->GetTuple1(6), 0.1 * (1 + 2 + 3 + 4), 1e-7);  // 1 dyn/cm^2 is 0.1 Pa
}

TEST(Cgns, FilesCutAnywhereOrChangedAreReadOrRefused) {
    for (const int type : {CG_FILE_ADF, CG_FILE_HDF5}) {
        const core::TemporaryFolder folder;
        write_like_cfx(folder.path() / "whole.cgns", type);
        const std::string whole = core::read_file(folder.path() / "whole.cgns");
        for (std::size_t size = 1; size < whole.size(); size += whole.size() / 60 + 1) {
            std::ofstream(folder.path() / "cut.cgns", std::ios::binary) << whole.substr(0, size);
            try {
                const auto field = read_field(folder.path() / "cut.cgns");
                EXPECT_EQ(test::cells_of(field), 4) << "cut at " << size;
                EXPECT_NEAR(test::volume_of(field), volume, 1e-12) << "cut at " << size;
            } catch (const core::InputError& error) {
                EXPECT_THAT(error.what(), HasSubstr("cut.cgns"));
            }
        }
    }
}

TEST(Cgns, ElementsThatNameMissingNodesAreRefused) {
    const core::TemporaryFolder folder;
    {
        File file(folder.path() / "a.cgns", CG_FILE_HDF5, 1);
        file.section("tets", CGNS_ENUMV(TETRA_4), {{CGNS_ENUMV(TETRA_4), {1, 2, 3, 99}}});
    }
    const std::string reason = test::refusal(folder.path() / "a.cgns");
    EXPECT_THAT(reason, HasSubstr("names node 99 of 18"));
    EXPECT_THAT(reason, HasSubstr("understood so far"));
}

}  // namespace underbody
