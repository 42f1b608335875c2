// Cell values carried to nodes: linear fields exactly on every kind of cell, walls as they are.
#include <gmock/gmock.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>

#include <array>
#include <cmath>
#include <functional>

#include "core/random.h"
#include "postproc/field/field.h"
#include "postproc/field/node_values.h"
#include "postproc/probe/probe.h"

namespace underbody::postproc {
namespace {

using Point = std::array<double, 3>;
using Ids = std::vector<vtkIdType>;

constexpr std::array<int, 3> cells_along = {5, 4, 6};

vtkIdType id(int i, int j, int k) {
    return static_cast<vtkIdType>((k * (cells_along[1] + 1) + j) * (cells_along[0] + 1) + i);
}

/// The unit cube, cells growing away from z = 0; `shaken`: every inner node moved about.
vtkSmartPointer<vtkPoints> block_points(bool shaken) {
    core::Random random(3);
    auto points = vtkSmartPointer<vtkPoints>::New();
    points->SetDataTypeToDouble();
    for (int k = 0; k <= cells_along[2]; ++k) {
        for (int j = 0; j <= cells_along[1]; ++j) {
            for (int i = 0; i <= cells_along[0]; ++i) {
                Point p = {double(i) / cells_along[0], double(j) / cells_along[1],
                           std::pow(double(k) / cells_along[2], 2)};
                const bool inner =
                    i > 0 && j > 0 && k > 0 && i < cells_along[0] && j < cells_along[1] && k < cells_along[2];
                for (std::size_t c = 0; c < 3; ++c) {
                    p[c] += shaken && inner ? random.uniform(-0.02, 0.02) : 0;
                }
                points->InsertNextPoint(p.data());
            }
        }
    }
    return points;
}

/// Each hexahedron of the block, as what `split` makes of its eight nodes.
vtkSmartPointer<vtkUnstructuredGrid> block(bool shaken,
                                           const std::function<void(vtkUnstructuredGrid&, const Ids&)>& split) {
    auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    grid->SetPoints(block_points(shaken));
    grid->Allocate(1000);
    for (int k = 0; k < cells_along[2]; ++k) {
        for (int j = 0; j < cells_along[1]; ++j) {
            for (int i = 0; i < cells_along[0]; ++i) {
                split(*grid, {id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k), id(i, j, k + 1),
                              id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1)});
            }
        }
    }
    return grid;
}

void insert(vtkUnstructuredGrid& grid, int type, const Ids& nodes) {
    grid.InsertNextCell(type, static_cast<vtkIdType>(nodes.size()), nodes.data());
}

void as_hexahedron(vtkUnstructuredGrid& grid, const Ids& n) { insert(grid, VTK_HEXAHEDRON, n); }
void as_wedges(vtkUnstructuredGrid& grid, const Ids& n) {
    insert(grid, VTK_WEDGE, {n[0], n[1], n[2], n[4], n[5], n[6]});
    insert(grid, VTK_WEDGE, {n[0], n[2], n[3], n[4], n[6], n[7]});
}
void as_tetrahedra(vtkUnstructuredGrid& grid, const Ids& n) {
    for (const auto& [a, b] : {std::pair{1, 2}, {2, 3}, {3, 7}, {7, 4}, {4, 5}, {5, 1}}) {  // around the diagonal 0-6
        insert(grid, VTK_TETRA, {n[0], n[static_cast<std::size_t>(a)], n[static_cast<std::size_t>(b)], n[6]});
    }
}
const std::vector<std::array<std::size_t, 4>> sides = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                                       {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
void as_pyramids(vtkUnstructuredGrid& grid, const Ids& n) {
    Point middle{};
    for (const auto node : n) {
        for (std::size_t k = 0; k < 3; ++k) {
            middle[k] += grid.GetPoint(node)[k] / 8;
        }
    }
    const vtkIdType top = grid.GetPoints()->InsertNextPoint(middle.data());
    for (const auto& side : sides) {
        insert(grid, VTK_PYRAMID, {n[side[0]], n[side[3]], n[side[2]], n[side[1]], top});
    }
}
void as_polyhedron(vtkUnstructuredGrid& grid, const Ids& n) {
    vtkNew<vtkIdList> stream;
    stream->InsertNextId(6);
    for (const auto& side : sides) {
        stream->InsertNextId(4);
        for (const std::size_t corner : side) {
            stream->InsertNextId(n[corner]);
        }
    }
    grid.InsertNextCell(VTK_POLYHEDRON, stream);
}

double linear(const Point& p) { return 3 + 2 * p[0] - 5 * p[1] + 7 * p[2]; }

/// Sets a cell array to the mean of a linear function, by an integral of its own: the cell cut into tetrahedra.
Point centre_by_triangulation(vtkUnstructuredGrid& grid, vtkIdType cell) {
    vtkNew<vtkIdList> ids;
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    grid.GetCell(cell)->Triangulate(0, ids, points);
    Point sum{};
    double volume = 0;
    for (vtkIdType t = 0; t + 3 < points->GetNumberOfPoints(); t += 4) {
        std::array<Point, 4> x{};
        for (vtkIdType i = 0; i < 4; ++i) {
            points->GetPoint(t + i, x[static_cast<std::size_t>(i)].data());
        }
        const auto edge = [&](std::size_t i, std::size_t k) { return x[i][k] - x[0][k]; };
        const double v = std::abs(edge(1, 0) * (edge(2, 1) * edge(3, 2) - edge(2, 2) * edge(3, 1)) +
                                  edge(1, 1) * (edge(2, 2) * edge(3, 0) - edge(2, 0) * edge(3, 2)) +
                                  edge(1, 2) * (edge(2, 0) * edge(3, 1) - edge(2, 1) * edge(3, 0)));
        volume += v;
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] += v * (x[0][k] + x[1][k] + x[2][k] + x[3][k]) / 4;
        }
    }
    return {sum[0] / volume, sum[1] / volume, sum[2] / volume};
}

void set_cells(vtkUnstructuredGrid& grid, const std::string& name, const std::function<double(const Point&)>& value) {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name.c_str());
    for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
        array->InsertNextValue(value(centre_by_triangulation(grid, c)));
    }
    grid.GetCellData()->AddArray(array);
}

TEST(NodeValues, OfALinearFieldAreExactInEveryKindOfCell) {
    struct Kind {
        const char* name;
        std::function<void(vtkUnstructuredGrid&, const Ids&)> split;
        bool shaken;  // a face that is not flat has no one centre: only where all are
    };
    for (const auto& kind : {Kind{"hexahedra", as_hexahedron, false},
                             {"wedges", as_wedges, false},
                             {"tetrahedra", as_tetrahedra, true},
                             {"pyramids", as_pyramids, false},
                             {"polyhedra", as_polyhedron, false}}) {
        const auto grid = block(kind.shaken, kind.split);
        set_cells(*grid, "p", linear);
        const auto values = NodeValues(*grid, {}).of("p");
        double worst = 0;
        for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
            Point p{};
            grid->GetPoint(i, p.data());
            worst = std::max(worst, std::abs(values->GetValue(i) - linear(p)));
        }
        EXPECT_LT(worst, 1e-11) << kind.name;
    }
}

TEST(NodeValues, OfALinearFieldAreExactInAPlaneAndOnASurface) {
    auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    vtkNew<vtkPolyData> surface;
    vtkNew<vtkCellArray> faces;
    grid->SetPoints(block_points(false));
    grid->Allocate(100);
    vtkNew<vtkDoubleArray> array;
    array->SetName("p");
    for (int j = 0; j < cells_along[1]; ++j) {
        for (int i = 0; i < cells_along[0]; ++i) {
            const Ids quad = {id(i, j, 0), id(i + 1, j, 0), id(i + 1, j + 1, 0), id(i, j + 1, 0)};
            insert(*grid, VTK_QUAD, quad);
            faces->InsertNextCell(4, quad.data());
            array->InsertNextValue(linear({(i + 0.5) / cells_along[0], (j + 0.5) / cells_along[1], 0}));
        }
    }
    grid->GetCellData()->AddArray(array);
    surface->SetPoints(grid->GetPoints());
    surface->SetPolys(faces);
    surface->GetCellData()->AddArray(array);
    for (const auto& values : {NodeValues(*grid, {}).of("p"), NodeValues(*surface).of("p")}) {
        for (vtkIdType i = 0; i <= id(cells_along[0], cells_along[1], 0); ++i) {
            Point p{};
            grid->GetPoint(i, p.data());
            EXPECT_NEAR(values->GetValue(i), linear(p), 1e-12);
        }
        EXPECT_TRUE(std::isnan(values->GetValue(id(0, 0, 1))));  // of no cell
    }
}

/// Water between two plates, z = 0 and z = 1, with u(z) in the cells; `plates`: what the plates' faces say of u.
Field channel(const std::function<double(double)>& u, std::optional<std::array<double, 2>> plates) {
    Zone water;
    water.name = "water";
    water.kind = ZoneKind::fluid;
    water.volume = block(false, as_hexahedron);
    vtkNew<vtkDoubleArray> velocity;
    velocity->SetName("velocity");
    velocity->SetNumberOfComponents(3);
    for (vtkIdType c = 0; c < water.volume->GetNumberOfCells(); ++c) {
        velocity->InsertNextTuple3(u(centre_by_triangulation(*water.volume, c)[2]), 0, 0);
    }
    water.volume->GetCellData()->AddArray(velocity);
    water.arrays = {{"velocity", "m/s", "U", "", Location::cells, 3}};
    Field field;
    field.files = {"made"};
    field.zones = {water};
    for (const int k : {0, cells_along[2]}) {
        Zone plate;
        plate.name = k == 0 ? "ground" : "base";
        plate.kind = ZoneKind::wall;
        plate.surface = vtkSmartPointer<vtkPolyData>::New();
        vtkNew<vtkPoints> points;
        points->SetDataTypeToDouble();
        vtkNew<vtkCellArray> faces;
        vtkNew<vtkDoubleArray> on_plate;
        on_plate->SetName("velocity");
        on_plate->SetNumberOfComponents(3);
        for (vtkIdType i = id(0, 0, k); i <= id(cells_along[0], cells_along[1], k); ++i) {
            points->InsertNextPoint(water.volume->GetPoint(i));
        }
        for (int j = 0; j < cells_along[1]; ++j) {
            for (int i = 0; i < cells_along[0]; ++i) {
                faces->InsertNextCell({id(i, j, 0), id(i + 1, j, 0), id(i + 1, j + 1, 0), id(i, j + 1, 0)});
                on_plate->InsertNextTuple3(plates ? (*plates)[k == 0 ? 0 : 1] : 0, 0, 0);
            }
        }
        plate.surface->SetPoints(points);
        plate.surface->SetPolys(faces);
        if (plates) {
            plate.surface->GetCellData()->AddArray(on_plate);
            plate.arrays = {{"velocity", "m/s", "U", "", Location::faces, 3}};
        }
        field.zones.push_back(plate);
    }
    return field;
}

std::vector<double> across(const Field& field, int count) {
    const core::Table line = probe_line(field, {0.31, 0.43, 0}, {0.31, 0.43, 1}, count);
    return line.numbers("velocity_x");
}

TEST(ProbeBetweenPlates, IsExactForCouetteFlowWithAndWithoutTheWallsVelocity) {
    const auto couette = [](double z) { return 0.5 - 2 * z; };
    for (const bool walls : {true, false}) {
        const auto u = across(channel(couette, walls ? std::optional(std::array{0.5, -1.5}) : std::nullopt), 21);
        for (std::size_t i = 0; i < u.size(); ++i) {
            EXPECT_NEAR(u[i], couette(0.05 * static_cast<double>(i)), 1e-12) << walls << " " << i;
        }
    }
}

TEST(ProbeBetweenPlates, FollowsPoiseuilleFlowToTheWalls) {
    const auto poiseuille = [](double z) { return 4 * z * (1 - z); };
    const auto known = across(channel(poiseuille, std::array{0.0, 0.0}), 41);
    const auto unknown = across(channel(poiseuille, std::nullopt), 41);
    EXPECT_NEAR(known.front(), 0, 1e-12);
    EXPECT_NEAR(known.back(), 0, 1e-12);
    // Without: a straight line through the two cells beside the wall, whose middles lie 1/72 and 5/72, 11/72 and 31/72
    // from it. The change over half a cell, which a mean would be off by, is 0.05 and 0.52.
    EXPECT_NEAR(unknown.front(), 4.0 * 1 / 72 * 5 / 72, 1e-9);
    EXPECT_NEAR(unknown.back(), 4.0 * 11 / 72 * 31 / 72, 1e-9);
    for (std::size_t i = 0; i < known.size(); ++i) {
        // The straight line over the largest cell sags by 8 (11/36)^2 / 8 = 0.093 under the parabola.
        EXPECT_NEAR(known[i], poiseuille(0.025 * static_cast<double>(i)), 0.11) << i;
    }
}

TEST(Probe, LooksIntoSolidsAndZonesThatLackAnArray) {
    // A block of steel alone: there is nothing that flows, and still a temperature.
    Field field;
    field.files = {"made"};
    Zone steel;
    steel.name = "steel";
    steel.kind = ZoneKind::solid;
    steel.volume = block(false, as_hexahedron);
    set_cells(*steel.volume, "temperature", linear);
    steel.arrays = {{"temperature", "K", "T", "", Location::cells, 1}};
    field.zones = {steel};
    EXPECT_NEAR(probe_points(field, {{0.3, 0.4, 0.5}}).numbers("temperature")[0], linear({0.3, 0.4, 0.5}), 1e-11);
    Field bare_mesh = field;
    bare_mesh.zones[0].arrays.clear();
    EXPECT_THROW(probe_points(bare_mesh, {{0.3, 0.4, 0.5}}), core::InputError);
    // Two waters side by side, one without the array: the other keeps its own.
    Zone warm = steel;
    warm.kind = ZoneKind::fluid;
    Zone bare = warm;
    bare.arrays.clear();
    bare.volume = block(false, as_hexahedron);
    for (vtkIdType i = 0; i < bare.volume->GetNumberOfPoints(); ++i) {
        const double* x = bare.volume->GetPoint(i);
        bare.volume->GetPoints()->SetPoint(i, x[0] + 2, x[1], x[2]);
    }
    field.zones = {warm, bare};
    const core::Table both = probe_points(field, {{0.3, 0.4, 0.5}, {2.3, 0.4, 0.5}});
    EXPECT_NEAR(both.numbers("temperature")[0], linear({0.3, 0.4, 0.5}), 1e-11);
    EXPECT_TRUE(std::isnan(both.numbers("temperature")[1]));
}

TEST(NodeValues, OfWhatIsNowhereNegativeStaySo) {
    const auto grid = block(false, as_hexahedron);
    set_cells(*grid, "energy", [](const Point& p) { return std::pow(p[2], 3); });
    const auto values = NodeValues(*grid, {}).of("energy");
    for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
        EXPECT_GE(values->GetValue(i), 0);
    }
    EXPECT_THROW(NodeValues(*grid, {}).of("enrgy"), core::InputError);
}

TEST(NodeValues, LeaveOutCellsWithoutAValue) {
    const auto grid = block(false, as_hexahedron);
    set_cells(*grid, "p", linear);
    auto* p = grid->GetCellData()->GetArray("p");
    p->SetTuple1(0, std::nan(""));
    const auto values = NodeValues(*grid, {}).of("p");
    EXPECT_TRUE(std::isnan(values->GetValue(id(0, 0, 0))));  // the corner of that cell alone
    Point q{};
    grid->GetPoint(id(1, 1, 1), q.data());
    EXPECT_NEAR(values->GetValue(id(1, 1, 1)), linear(q), 1e-11);
}

}  // namespace
}  // namespace underbody::postproc
