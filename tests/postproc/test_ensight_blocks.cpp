// EnSight Gold that the tests write themselves: structured blocks, several steps in time, in every coding.
#include <gmock/gmock.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkMath.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <numeric>

#include "core/file.h"
#include "import_support.h"
#include "postproc/loads/loads.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using postproc::ReadOptions;
using ::testing::HasSubstr;

namespace {

namespace fs = std::filesystem;

/// Records of one file, as text, C binary in either byte order, or Fortran binary.
class Writer {
public:
    explicit Writer(std::string coding, bool geometry = true) : coding_(std::move(coding)) {
        if (geometry && coding_ != "text") {
            line(coding_ == "fortran" ? "Fortran Binary" : "C Binary");
        }
    }
    Writer& line(const std::string& text) {
        record(coding_ == "text" ? text + "\n" : text + std::string(80 - text.size(), ' '));
        return *this;
    }
    Writer& ints(const std::vector<std::int32_t>& values) {
        std::string raw;
        for (const auto value : values) {
            raw += coding_ == "text" ? std::to_string(value) + " " : four(&value);
        }
        record(coding_ == "text" ? raw + "\n" : raw);
        return *this;
    }
    Writer& reals(const std::vector<float>& values) {
        std::string raw;
        for (const auto value : values) {
            raw += coding_ == "text" ? std::to_string(value) + "\n" : four(&value);
        }
        record(raw);
        return *this;
    }
    void to(const fs::path& path) const { std::ofstream(path, std::ios::binary) << bytes_; }

private:
    [[nodiscard]] std::string four(const void* value) const {
        std::string raw(4, '\0');
        std::memcpy(raw.data(), value, 4);
        return coding_ == "big" ? std::string(raw.rbegin(), raw.rend()) : raw;
    }
    void record(const std::string& raw) {
        const auto size = static_cast<std::int32_t>(raw.size());
        std::string length(4, '\0');
        std::memcpy(length.data(), &size, 4);
        bytes_ += coding_ == "fortran" ? length + raw + length : raw;
    }

    std::string coding_;
    std::string bytes_;
};

const std::vector<std::string> codings = {"text", "little", "big", "fortran"};

void head(Writer& out) { out.line("a test").line("of blocks").line("node id assign").line("element id assign"); }

std::vector<float> counted(std::size_t count, float first = 0) {
    std::vector<float> values(count);
    std::iota(values.begin(), values.end(), first);
    return values;
}

void write_case(const fs::path& path, const std::string& body) {
    std::ofstream(path) << "FORMAT\ntype: ensight gold\n" << body;
}

/// Coordinates of 3 x 4 x 2 nodes at x = i, y = 2 j, z = 3 k, one list an axis.
std::array<std::vector<float>, 3> lattice() {
    std::array<std::vector<float>, 3> x;
    for (int k = 0; k < 2; ++k) {
        for (int j = 0; j < 4; ++j) {
            for (int i = 0; i < 3; ++i) {
                x[0].push_back(static_cast<float>(i));
                x[1].push_back(static_cast<float>(2 * j));
                x[2].push_back(static_cast<float>(3 * k));
            }
        }
    }
    return x;
}

/// A cube of one hexahedron, moved by `shift`; without its element when there is none in the step.
void cube(Writer& out, float shift, bool with_element = true) {
    head(out);
    out.line("part").ints({1}).line("cube").line("coordinates").ints({8});
    out.reals({shift, shift + 1, shift + 1, shift, shift, shift + 1, shift + 1, shift});
    out.reals({0, 0, 1, 1, 0, 0, 1, 1}).reals({0, 0, 0, 0, 1, 1, 1, 1});
    if (with_element) {
        out.line("hexa8").ints({1}).ints({1, 2, 3, 4, 5, 6, 7, 8});
    }
}

double left_of(const postproc::Field& field) {
    double bounds[6] = {};
    field.zones.at(0).volume->GetBounds(bounds);
    return bounds[0];
}

double first_value(const postproc::Field& field, const char* name) {
    return field.zones.at(0).volume->GetPointData()->GetArray(name)->GetTuple1(0);
}

}  // namespace

TEST(EnsightBlocks, ThreeKindsOfBlocksAreTheSameCellsWithTheirValues) {
    for (const auto& coding : codings) {
        for (const char* kind : {"block", "block rectilinear", "block uniform"}) {
            SCOPED_TRACE(coding + " " + kind);
            const core::TemporaryFolder folder;
            Writer geometry(coding);
            head(geometry);
            geometry.line("part").ints({1}).line("tank").line(kind).ints({3, 4, 2});
            if (kind == std::string("block")) {
                for (const auto& axis : lattice()) {
                    geometry.reals(axis);
                }
            } else if (kind == std::string("block uniform")) {
                geometry.reals({0, 0, 0, 1, 2, 3});
            } else {
                geometry.reals({0, 1, 2}).reals({0, 2, 4, 6}).reals({0, 3});
            }
            geometry.to(folder.path() / "a.geo");
            Writer nodes(coding, false);
            nodes.line("pressure").line("part").ints({1}).line("block").reals(counted(24));
            nodes.to(folder.path() / "a.p");
            Writer cells(coding, false);
            cells.line("velocity").line("part").ints({1}).line("block");
            cells.reals(counted(6)).reals(counted(6, 10)).reals(counted(6, 20));
            cells.to(folder.path() / "a.u");
            write_case(
                folder.path() / "a.case",
                "GEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per node: Pressure a.p\nvector per element: Velocity a.u\n");
            const auto field = read_field(folder.path() / "a.case");
            ASSERT_EQ(field.zones.size(), 1U);
            auto& grid = *field.zones[0].volume;
            EXPECT_EQ(test::count_cells(grid, VTK_HEXAHEDRON), 6);
            EXPECT_NEAR(test::volume_of(grid), 2 * 6 * 3, 1e-5);
            EXPECT_GT(test::smallest_volume(grid), 0);
            EXPECT_EQ(grid.GetPointData()->GetArray("pressure")->GetTuple1(23), 23);
            EXPECT_EQ(grid.GetCellData()->GetArray("velocity")->GetComponent(5, 1), 15);
        }
    }
}

TEST(EnsightBlocks, BlankedCellsAndGhostsAreLeftOutWithTheirValues) {
    const core::TemporaryFolder folder;
    Writer geometry("little");
    head(geometry);
    geometry.line("part")
        .ints({1})
        .line("tank")
        .line("block uniform iblanked with_ghost")
        .ints({3, 4, 2})
        .reals({0, 0, 0, 1, 2, 3});
    std::vector<std::int32_t> blank(24, 1);
    blank[0] = 0;  // a corner: one cell
    geometry.ints(blank).line("ghost_flags").ints({0, 0, 0, 0, 0, 1});
    geometry.to(folder.path() / "a.geo");
    Writer cells("little", false);
    cells.line("pressure").line("part").ints({1}).line("block").reals(counted(6));
    cells.to(folder.path() / "a.p");
    write_case(folder.path() / "a.case", "GEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per element: Pressure a.p\n");
    const auto field = read_field(folder.path() / "a.case");
    auto& grid = *field.zones.at(0).volume;
    EXPECT_EQ(grid.GetNumberOfCells(), 4);
    EXPECT_EQ(grid.GetCellData()->GetArray("pressure")->GetTuple1(0), 1);
    EXPECT_EQ(grid.GetCellData()->GetArray("pressure")->GetTuple1(3), 4);
}

TEST(EnsightWalls, LookIntoTheVolumeThatIsInTheFile) {
    const core::TemporaryFolder folder;
    const std::vector<float> x = {0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 1, 1,
                                  0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1};  // a unit cube: x, y, z
    Writer geometry("little");
    head(geometry);
    geometry.line("part")
        .ints({1})
        .line("water")
        .line("coordinates")
        .ints({8})
        .reals(x)
        .line("hexa8")
        .ints({1})
        .ints({1, 2, 3, 4, 5, 6, 7, 8});
    // The same corners in another order, the faces now in, now out.
    const std::vector<float> turned = {1, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 1, 1, 1, 1, 0, 0, 0, 0};
    geometry.line("part").ints({2}).line("walls").line("coordinates").ints({8}).reals(turned);
    geometry.line("quad4").ints({6}).ints({1, 2, 3, 4, 5, 6, 7, 8, 1, 2, 6, 5, 3, 2, 6, 7, 3, 4, 8, 7, 1, 4, 8, 5});
    geometry.to(folder.path() / "a.geo");
    Writer pressure("little", false);
    pressure.line("pressure").line("part").ints({2}).line("quad4").reals({20, 10, 15, 15, 15, 15});  // rises with z
    pressure.to(folder.path() / "a.p");
    write_case(folder.path() / "a.case", "GEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per element: Pressure a.p\n");
    for (const bool surfaces_only : {false, true}) {
        ReadOptions options;
        options.surfaces_only = surfaces_only;
        options.zones = {"walls"};
        const auto field = read_field(folder.path() / "a.case", options);
        ASSERT_EQ(field.zones.size(), 1U);
        EXPECT_TRUE(field.zones[0].normals_into_fluid);
        // The water is inside: it pushes the lid up.
        EXPECT_NEAR(test::pressure_force(*field.zones[0].surface)[2], 10, 1e-6);
    }
}

TEST(EnsightWalls, LookIntoACellWhoseCentreLiesOutsideIt) {
    // An L of 10 x 10 x 1 with arms 1 thick: the mean of its corners lies off the arms.
    const core::TemporaryFolder folder;
    const std::vector<float> points = {0, 10, 10, 1, 1,  0,  0, 10, 10, 1, 1, 0, 0, 0, 1, 1, 10, 10,
                                       0, 0,  1,  1, 10, 10, 0, 0,  0,  0, 0, 0, 1, 1, 1, 1, 1,  1};
    const std::vector<std::int32_t> sizes = {6, 6, 4, 4, 4, 4, 4, 4};
    const std::vector<std::int32_t> faces = {1, 2, 3, 4, 5, 6,  7, 8, 9,  10, 11, 12, 1,  2,  8, 7, 2, 3,
                                             9, 8, 4, 3, 9, 10, 4, 5, 11, 10, 5,  6,  12, 11, 6, 1, 7, 12};
    Writer geometry("little");
    head(geometry);
    geometry.line("part")
        .ints({1})
        .line("water")
        .line("coordinates")
        .ints({12})
        .reals(points)
        .line("nfaced")
        .ints({1})
        .ints({8})
        .ints(sizes)
        .ints(faces);
    geometry.line("part")
        .ints({2})
        .line("walls")
        .line("coordinates")
        .ints({12})
        .reals(points)
        .line("nsided")
        .ints({8})
        .ints(sizes)
        .ints(faces);
    geometry.to(folder.path() / "a.geo");
    write_case(folder.path() / "a.case", "GEOMETRY\nmodel: a.geo\n");
    const auto field = read_field(folder.path() / "a.case");
    const auto* walls = field.find("walls");
    ASSERT_NE(walls, nullptr);
    EXPECT_TRUE(walls->normals_into_fluid);
    double enclosed = 0;
    for (vtkIdType c = 0; c < walls->surface->GetNumberOfCells(); ++c) {
        auto* nodes = walls->surface->GetCell(c)->GetPoints();
        double a[3], b[3], d[3];
        nodes->GetPoint(0, a);
        for (vtkIdType i = 1; i + 1 < nodes->GetNumberOfPoints(); ++i) {
            nodes->GetPoint(i, b);
            nodes->GetPoint(i + 1, d);
            enclosed += vtkMath::Determinant3x3(a, b, d) / 6;
        }
    }
    EXPECT_NEAR(enclosed, -19, 1e-6);
}

TEST(EnsightWalls, ThatFitTheCellsInPartTakeTheSideOfThatPart) {
    const core::TemporaryFolder folder;
    // Two cubes side by side; the second lid of the walls is cut into triangles that no cell has.
    std::vector<float> points;
    for (int axis = 0; axis < 3; ++axis) {
        for (int z = 0; z < 2; ++z) {
            for (int y = 0; y < 2; ++y) {
                for (int x = 0; x < 3; ++x) {
                    points.push_back(static_cast<float>(axis == 0 ? x : axis == 1 ? y : z));
                }
            }
        }
    }
    Writer geometry("little");
    head(geometry);
    geometry.line("part").ints({1}).line("water").line("coordinates").ints({12}).reals(points).line("hexa8").ints({2});
    geometry.ints({1, 2, 5, 4, 7, 8, 11, 10, 2, 3, 6, 5, 8, 9, 12, 11});
    geometry.line("part").ints({2}).line("lid").line("coordinates").ints({12}).reals(points);
    geometry.line("tria3").ints({2}).ints({8, 9, 12, 8, 12, 11}).line("quad4").ints({1}).ints({7, 8, 11, 10});
    geometry.to(folder.path() / "a.geo");
    Writer pressure("little", false);
    pressure.line("pressure").line("part").ints({2}).line("tria3").reals({5, 5}).line("quad4").reals({5});
    pressure.to(folder.path() / "a.p");
    write_case(folder.path() / "a.case", "GEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per element: Pressure a.p\n");
    const auto field = read_field(folder.path() / "a.case");
    EXPECT_TRUE(field.find("lid")->normals_into_fluid);
    EXPECT_NEAR(test::pressure_force(*field.find("lid")->surface)[2], 10, 1e-6);  // the water below pushes it up
}

TEST(EnsightBlocks, MayHoldTheIdsThatTheHeaderPromisesOrNot) {
    const core::TemporaryFolder folder;
    for (const auto& coding : codings) {
        for (const bool there : {true, false}) {
            Writer geometry(coding);
            geometry.line("a title").line("a second one").line("node id given").line("element id given");
            geometry.line("part")
                .ints({1})
                .line("tank")
                .line("block uniform")
                .ints({2, 2, 2})
                .reals({0, 0, 0, 1, 1, 1});
            if (there) {
                geometry.line("node_ids").ints({1, 2, 3, 4, 5, 6, 7, 8}).line("element_ids").ints({1});
            }
            geometry.line("part")
                .ints({2})
                .line("pool")
                .line("block uniform")
                .ints({3, 2, 2})
                .reals({5, 0, 0, 1, 1, 1});
            if (there) {
                geometry.line("node_ids")
                    .ints({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12})
                    .line("element_ids")
                    .ints({1, 2});
            }
            geometry.to(folder.path() / "a.geo");
            write_case(folder.path() / "a.case", "GEOMETRY\nmodel: a.geo\n");
            const auto field = read_field(folder.path() / "a.case");
            ASSERT_EQ(field.zones.size(), 2U) << coding << there;
            EXPECT_EQ(field.zones[1].volume->GetNumberOfCells(), 2) << coding << there;
        }
    }
}

TEST(EnsightBlocks, ABlockOneNodeThickIsASurfaceAndUndefinedValuesAreMissing) {
    const core::TemporaryFolder folder;
    Writer geometry("text");
    head(geometry);
    geometry.line("part").ints({1}).line("").line("block uniform").ints({3, 1, 2}).reals({0, 0, 0, 1, 1, 1});
    geometry.line("part").ints({2}).line("tank").line("block uniform").ints({3, 2, 2}).reals({0, 0, 0, 1, 1, 1});
    geometry.to(folder.path() / "a.geo");
    Writer values("text", false);
    values.line("pressure").line("part").ints({1}).line("block undef").reals({-99}).reals({1, -99, 3, 4, 5, 6});
    values.line("part").ints({2}).line("block partial").ints({2}).ints({1, 12}).reals({7, 8});
    values.to(folder.path() / "a.p");
    write_case(folder.path() / "a.case", "GEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per node: Pressure a.p\n");
    const auto field = read_field(folder.path() / "a.case");
    const auto* wall = field.find("part 1");
    ASSERT_NE(wall, nullptr);
    EXPECT_EQ(wall->surface->GetNumberOfPolys(), 2);
    EXPECT_TRUE(std::isnan(wall->surface->GetPointData()->GetArray("pressure")->GetTuple1(1)));
    EXPECT_EQ(wall->surface->GetPointData()->GetArray("pressure")->GetTuple1(2), 3);
    auto* partial = field.find("tank")->volume->GetPointData()->GetArray("pressure");
    EXPECT_EQ(partial->GetTuple1(11), 8);
    EXPECT_TRUE(std::isnan(partial->GetTuple1(5)));
}

TEST(EnsightBlocks, ABlockThatAsksForMoreThanTheCaseHoldsIsRefused) {
    const core::TemporaryFolder folder;
    Writer geometry("little");
    head(geometry);
    geometry.line("part")
        .ints({1})
        .line("tank")
        .line("block uniform")
        .ints({1000, 1000, 1000})
        .reals({0, 0, 0, 1, 1, 1});
    geometry.to(folder.path() / "a.geo");
    write_case(folder.path() / "a.case", "GEOMETRY\nmodel: a.geo\n");
    EXPECT_THAT(test::refusal(folder.path() / "a.case"), HasSubstr("1000000000 nodes"));
}

TEST(EnsightTimes, StepsInFilesOfTheirOwnAreChosenByTime) {
    const core::TemporaryFolder folder;
    for (int step = 0; step < 3; ++step) {
        Writer geometry("little");
        cube(geometry, static_cast<float>(step));
        geometry.to(folder.path() / ("a.geo0" + std::to_string(2 * step)));
        Writer values("little", false);
        values.line("pressure")
            .line("part")
            .ints({1})
            .line("coordinates")
            .reals(counted(8, static_cast<float>(100 * step)));
        values.to(folder.path() / ("a.p0" + std::to_string(2 * step)));
    }
    write_case(folder.path() / "a.case",
               "GEOMETRY\nmodel: 1 a.geo**\nVARIABLE\nscalar per node: 1 Pressure a.p**\nTIME\ntime set: 1\nnumber of "
               "steps: 3\n"
               "filename start number: 0\nfilename increment: 2\ntime values: 0.0\n0.5\n1.5\n");
    EXPECT_EQ(left_of(read_field(folder.path() / "a.case")), 2);
    ReadOptions options;
    options.time = 0.5;
    const auto middle = read_field(folder.path() / "a.case", options);
    EXPECT_EQ(left_of(middle), 1);
    EXPECT_EQ(first_value(middle, "pressure"), 100);
    EXPECT_THAT(middle.metadata, testing::Contains(std::pair<std::string, std::string>("time", "0.5")));
    options.time = 0.7;
    EXPECT_THAT(test::refusal(folder.path() / "a.case", options), HasSubstr("the nearest is 0.5 s"));
}

TEST(EnsightTimes, StepsInOneFileAreFoundInEveryCoding) {
    for (const auto& coding : codings) {
        SCOPED_TRACE(coding);
        const core::TemporaryFolder folder;
        Writer geometry(coding);
        Writer values(coding, false);
        for (int step = 0; step < 3; ++step) {
            geometry.line("BEGIN TIME STEP");
            cube(geometry, static_cast<float>(step));
            geometry.line("END TIME STEP");
            values.line("BEGIN TIME STEP").line("pressure").line("part").ints({1}).line("coordinates");
            values.reals(counted(8, static_cast<float>(100 * step))).line("END TIME STEP");
        }
        geometry.to(folder.path() / "a.geo");
        values.to(folder.path() / "a.p");
        write_case(folder.path() / "a.case",
                   "GEOMETRY\nmodel: 1 1 a.geo\nVARIABLE\nscalar per node: 1 1 Pressure a.p\nTIME\ntime set: 1\n"
                   "number of steps: 3\ntime values: 0.0 0.5 1.5\nFILE\nfile set: 1\nnumber of steps: 3\n");
        EXPECT_EQ(left_of(read_field(folder.path() / "a.case")), 2);
        ReadOptions options;
        options.time = 0.5;
        const auto middle = read_field(folder.path() / "a.case", options);
        EXPECT_EQ(left_of(middle), 1);
        EXPECT_EQ(first_value(middle, "pressure"), 100);
        // A file that has fewer steps than the case says.
        const std::string whole = core::read_file(folder.path() / "a.p");
        std::ofstream(folder.path() / "a.p", std::ios::binary) << whole.substr(0, whole.size() / 2);
        EXPECT_NE(test::refusal(folder.path() / "a.case"), "");
    }
}

TEST(EnsightTimes, CoordinatesThatChangeAloneTakeTheElementsFromTheirStep) {
    const core::TemporaryFolder folder;
    for (int step = 0; step < 2; ++step) {
        Writer geometry("big");
        cube(geometry, static_cast<float>(step), step == 0);
        geometry.to(folder.path() / ("a.geo" + std::to_string(step)));
    }
    write_case(folder.path() / "a.case",
               "GEOMETRY\nmodel: 1 a.geo* change_coords_only\nTIME\ntime set: 1\nnumber of steps: 2\nfilename start "
               "number: 0\n"
               "filename increment: 1\ntime values: 0 1\n");
    const auto field = read_field(folder.path() / "a.case");
    EXPECT_EQ(test::cells_of(field), 1);
    EXPECT_EQ(left_of(field), 1);
}

TEST(EnsightLines, ThatGoRoundInAPlaneAreTheBoundaryOfAPlaneCase) {
    const auto write = [](const fs::path& folder, const std::string& coding, bool closed, float z) {
        Writer geometry(coding);
        head(geometry);
        geometry.line("part").ints({4}).line("body").line("coordinates").ints({4});
        geometry.reals({0, 1, 1, 0}).reals({0, 0, 1, 1}).reals({z, 0, 0, 0});
        geometry.line("bar2").ints({closed ? 4 : 3});
        geometry.ints({1, 2}).ints({2, 3}).ints({3, 4});
        if (closed) {
            geometry.ints({4, 1});
        }
        geometry.line("part").ints({5}).line("inlet").line("coordinates").ints({2});
        geometry.reals({5, 5}).reals({-1, 2}).reals({0, 0}).line("bar2").ints({1}).ints({1, 2});
        geometry.to(folder / "a.geo");
        Writer pressure(coding, false);
        pressure.line("pressure").line("part").ints({4}).line("coordinates").reals({1, 2, 3, 4});
        pressure.to(folder / "a.p");
        write_case(folder / "a.case", "GEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per node: pressure a.p\n");
    };
    const core::TemporaryFolder folder;
    write(folder.path(), "text", true, 0);
    const auto field = read_field(folder.path() / "a.case");
    EXPECT_EQ(field.dimension, 2);
    postproc::LoadsOptions body;
    body.zones = {"body"};
    // 1.5 Pa on the floor, 3.5 Pa on the lid, 2.5 Pa on either side.
    const auto result = postproc::loads(field, body);
    EXPECT_NEAR(result.total.force[0], 0, 1e-12);
    EXPECT_NEAR(result.total.force[1], -2, 1e-12);
    const bool told = std::any_of(field.problems.begin(), field.problems.end(), [](const auto& problem) {
        return problem.message.find("boundaries of a plane case") != std::string::npos;
    });
    EXPECT_TRUE(told);
    for (const bool closed : {true, false}) {  // lines in space; lines through a flow
        write(folder.path(), "little", closed, closed ? 1.0F : 0.0F);
        const auto lines = read_field(folder.path() / "a.case");
        EXPECT_EQ(lines.dimension, 3);
        EXPECT_EQ(lines.find("body")->kind, postproc::ZoneKind::line);
        for (const auto& zones : {std::vector<std::string>{}, std::vector<std::string>{"body"}}) {
            try {
                postproc::LoadsOptions options;
                options.zones = zones;
                (void)postproc::loads(lines, options);
                ADD_FAILURE() << "lines were summed";
            } catch (const core::InputError& error) {
                EXPECT_THAT(error.hint(), HasSubstr("export these too"));
            }
        }
    }
}

}  // namespace underbody
