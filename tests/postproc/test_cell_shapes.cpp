// Cells out of faces in any order, from any corner, looking either way: kind, order of nodes and size against
// determinants.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>

#include "core/random.h"
#include "postproc/importers/mesh/cell_shapes.h"

namespace underbody::postproc {
namespace {

using Faces = std::vector<std::vector<std::uint32_t>>;

/// Outward faces over nodes 1, 2, ...
const Faces hexahedron = {{4, 3, 2, 1}, {5, 6, 7, 8}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}};
const Faces wedge = {{1, 3, 2}, {4, 5, 6}, {1, 2, 5, 4}, {2, 3, 6, 5}, {3, 1, 4, 6}};
const Faces pyramid = {{4, 3, 2, 1}, {1, 2, 5}, {2, 3, 5}, {3, 4, 5}, {4, 1, 5}};
const Faces tetrahedron = {{1, 3, 2}, {1, 2, 4}, {2, 3, 4}, {3, 1, 4}};

/// Faces as a file may have them: shuffled, each from any of its corners, half of them with the normal inward.
struct Stored {
    Stored(Faces outward, core::Random& random) : faces(std::move(outward)) {
        for (std::size_t i = faces.size(); i > 1; --i) {
            std::swap(faces[i - 1], faces[static_cast<std::size_t>(random.uniform() * double(i))]);
        }
        for (auto& face : faces) {
            std::rotate(face.begin(),
                        face.begin() + static_cast<std::ptrdiff_t>(random.uniform() * double(face.size())), face.end());
            const bool inward = random.uniform() < 0.5;
            if (inward) {
                std::reverse(face.begin(), face.end());
            }
            looks_in.push_back(inward);
        }
    }
    [[nodiscard]] CellShape cell(bool called_polyhedron = false) const {
        CellShape shape;
        for (std::size_t i = 0; i < faces.size(); ++i) {
            shape.faces.push_back({faces[i].data(), static_cast<std::uint32_t>(faces[i].size()), looks_in[i]});
        }
        recognise(shape, 3, called_polyhedron);
        return shape;
    }
    Faces faces;
    std::vector<bool> looks_in;
};

/// The corners of the unit cube through a random matrix and shift; with it the determinant.
std::vector<double> skewed(const std::vector<std::array<double, 3>>& corners, core::Random& random,
                           double& determinant) {
    double m[3][3];
    do {
        for (auto& row : m) {
            for (double& x : row) {
                x = random.uniform(-1, 1);
            }
        }
        determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                      m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                      m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    } while (determinant < 0.05);
    std::vector<double> points;
    for (const auto& p : corners) {
        for (const auto& row : m) {
            points.push_back(7 + row[0] * p[0] + row[1] * p[1] + row[2] * p[2]);
        }
    }
    return points;
}

struct Kind {
    const Faces& faces;
    std::vector<std::array<double, 3>> corners;
    CellType type;
    double volume;  ///< of the undistorted one
};

std::vector<Kind> kinds() {
    return {{hexahedron,
             {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
             vtk_hexahedron,
             1},
            {wedge, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, vtk_wedge, 0.5},
            {pyramid, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}}, vtk_pyramid, 1.0 / 3},
            {tetrahedron, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, vtk_tetra, 1.0 / 6}};
}

/// Every face of VTK's cell, by the order of its nodes, must be one of the cell's, looking the way VTK has it look.
void expect_faces_of(const CellShape& cell, const Faces& by_place) {
    for (const auto& places : by_place) {
        std::vector<std::uint32_t> nodes;
        for (const std::uint32_t place : places) {
            nodes.push_back(cell.nodes.at(place - 1));
        }
        const bool found = std::any_of(cell.faces.begin(), cell.faces.end(), [&](const FaceView& face) {
            std::vector<std::uint32_t> outward;
            for (std::uint32_t i = 0; i < face.size; ++i) {
                outward.push_back(face.node(i, false));
            }
            for (std::uint32_t turn = 0; turn < face.size; ++turn) {
                std::rotate(outward.begin(), outward.begin() + 1, outward.end());
                if (outward == nodes) {
                    return true;
                }
            }
            return false;
        });
        EXPECT_TRUE(found) << testing::PrintToString(nodes);
    }
}

TEST(CellShapes, AreRecognisedHoweverTheirFacesAreStored) {
    core::Random random(20261122);
    for (const auto& kind : kinds()) {
        for (int trial = 0; trial < 200; ++trial) {
            double determinant = 0;
            const auto points = skewed(kind.corners, random, determinant);
            const Stored stored(kind.faces, random);
            const CellShape cell = stored.cell();
            ASSERT_EQ(cell.type, kind.type);
            EXPECT_EQ(cell.sound_hexahedron, kind.type == vtk_hexahedron);
            const CellSize size = size_of(cell, points.data(), 3);
            EXPECT_NEAR(size.volume, kind.volume * determinant, 1e-13);
            EXPECT_LE(size.opening, 1e-13);
            // VTK's wedge has its first triangle look outward, the other cells their base inward.
            expect_faces_of(cell, kind.type == vtk_wedge
                                      ? Faces{{1, 2, 3}, {4, 6, 5}, {1, 4, 5, 2}, {2, 5, 6, 3}, {3, 6, 4, 1}}
                                      : kind.faces);
            EXPECT_EQ(stored.cell(true).type, vtk_polyhedron);
            EXPECT_NEAR(size_of(stored.cell(true), points.data(), 3).volume, kind.volume * determinant, 1e-13);
        }
    }
}

TEST(CellShapes, AWarpedHexahedronHasOneVolumeByFacesAndByNodes) {
    core::Random random(7);
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<double> points;
        const auto all = kinds();
        for (const auto& corner : all[0].corners) {
            for (const double x : corner) {
                points.push_back(1e3 + x + random.uniform(-0.2, 0.2));
            }
        }
        const Stored stored(hexahedron, random);
        CellShape cell = stored.cell();
        ASSERT_TRUE(cell.sound_hexahedron);
        const double by_nodes = size_of(cell, points.data(), 3).volume;
        cell.sound_hexahedron = false;
        const CellSize by_faces = size_of(cell, points.data(), 3);
        EXPECT_NEAR(by_nodes, by_faces.volume, 1e-12);
        EXPECT_LE(by_faces.opening, 1e-12 * by_faces.area);
    }
}

TEST(CellShapes, AFaceThatLooksTheWrongWayOpensTheCell) {
    core::Random random(8);
    for (const auto& kind : kinds()) {
        double determinant = 0;
        const auto points = skewed(kind.corners, random, determinant);
        for (std::size_t wrong = 0; wrong < kind.faces.size(); ++wrong) {
            Stored stored(kind.faces, random);
            stored.looks_in[wrong] = !stored.looks_in[wrong];
            const CellShape cell = stored.cell();
            EXPECT_FALSE(cell.sound_hexahedron);
            const CellSize size = size_of(cell, points.data(), 3);
            EXPECT_GT(size.opening, 1e-3 * size.area) << int(kind.type) << " " << wrong;
        }
    }
}

TEST(CellShapes, FacesThatMakeNoPrismStayAPolyhedron) {
    core::Random random(9);
    // Two side faces on one edge and none on the opposite one; a lid that crosses over; a node twice.
    for (const Faces& faces :
         {Faces{{4, 3, 2, 1}, {5, 6, 7, 8}, {1, 2, 6, 5}, {1, 2, 6, 5}, {3, 4, 8, 7}, {4, 1, 5, 8}},
          Faces{{4, 3, 2, 1}, {5, 7, 6, 8}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}},
          Faces{{4, 3, 2, 1}, {5, 6, 7, 7}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 7, 7}, {4, 1, 5, 7}},
          Faces{{4, 3, 2, 1}, {5, 6, 7, 8}, {9, 10, 11, 12}, {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}}}) {
        const Stored stored(faces, random);
        EXPECT_EQ(stored.cell().type, vtk_polyhedron);
    }
}

TEST(CellShapes, NoFacesMakeNoCell) {
    CellShape cell;
    recognise(cell, 3, false);
    EXPECT_EQ(cell.type, vtk_empty);
}

}  // namespace
}  // namespace underbody::postproc
