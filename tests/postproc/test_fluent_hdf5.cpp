// Fluent HDF5 files that the tests write themselves: zones, phases, arrays in several parts, damaged ones.
#include <gmock/gmock.h>
#include <hdf5.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkUnstructuredGrid.h>

#include <array>
#include <fstream>
#include <limits>

#include "core/file.h"
#include "import_support.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using postproc::ReadOptions;
using ::testing::HasSubstr;

namespace {

namespace fs = std::filesystem;

/// Writes groups, data sets and attributes by their paths.
class Writer {
public:
    explicit Writer(const fs::path& path)
        : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)), links_(H5Pcreate(H5P_LINK_CREATE)) {
        H5Pset_create_intermediate_group(links_, 1);
    }
    ~Writer() {
        H5Pclose(links_);
        H5Fclose(file_);
    }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    void group(const std::string& path) { H5Gclose(H5Gcreate2(file_, path.c_str(), links_, H5P_DEFAULT, H5P_DEFAULT)); }
    void ints(const std::string& path, const std::vector<std::int32_t>& values) {
        const hsize_t size = values.size();
        set(path, H5T_STD_I32LE, H5T_NATIVE_INT32, 1, &size, values.data());
    }
    /// In chunks and deflated, as Fluent does it.
    void reals(const std::string& path, const std::vector<double>& values, hsize_t columns = 0) {
        const std::array<hsize_t, 2> size = {values.size() / std::max<hsize_t>(1, columns), columns};
        set(path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, columns > 0 ? 2 : 1, size.data(), values.data());
    }
    /// Strings of variable length.
    void texts(const std::string& path, const std::vector<const char*>& values) {
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, H5T_VARIABLE);
        const hsize_t size = values.size();
        if (H5Lexists(file_, path.substr(0, path.find('/', 1)).c_str(), H5P_DEFAULT) > 0 &&
            H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0) {
            H5Ldelete(file_, path.c_str(), H5P_DEFAULT);
        }
        set(path, type, type, 1, &size, values.data(), false);
        H5Tclose(type);
    }
    void text(const std::string& path, const std::string& value) {
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, value.size() + 1);
        const hsize_t size = 1;
        set(path, type, type, 1, &size, value.c_str(), false);
        H5Tclose(type);
    }
    void attribute(const std::string& path, const std::string& name, std::int64_t value) {
        const hid_t object = H5Oopen(file_, path.c_str(), H5P_DEFAULT);
        const hid_t space = H5Screate(H5S_SCALAR);
        const hid_t attribute = H5Acreate2(object, name.c_str(), H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT);
        H5Awrite(attribute, H5T_NATIVE_INT64, &value);
        H5Aclose(attribute);
        H5Sclose(space);
        H5Oclose(object);
    }
    void text_attribute(const std::string& path, const std::string& name, const std::string& value,
                        bool variable = false) {
        const hid_t object = H5Oopen(file_, path.c_str(), H5P_DEFAULT);
        const hid_t space = H5Screate(H5S_SCALAR);
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, variable ? H5T_VARIABLE : value.size() + 1);
        const hid_t attribute = H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
        const char* text = value.c_str();
        H5Awrite(attribute, type, variable ? static_cast<const void*>(&text) : text);
        H5Aclose(attribute);
        H5Tclose(type);
        H5Sclose(space);
        H5Oclose(object);
    }
    void ids(const std::string& path, std::int64_t first, std::int64_t last) {
        attribute(path, "minId", first);
        attribute(path, "maxId", last);
    }

private:
    void set(const std::string& path, hid_t stored, hid_t type, int rank, const hsize_t* size, const void* values,
             bool packed = true) {
        const hid_t space = H5Screate_simple(rank, size, nullptr);
        const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
        if (packed && size[0] > 0) {
            const std::array<hsize_t, 2> chunk = {std::min<hsize_t>(size[0], 4), rank > 1 ? size[1] : 1};
            H5Pset_chunk(properties, rank, chunk.data());
            H5Pset_deflate(properties, 4);
        }
        const hid_t data = H5Dcreate2(file_, path.c_str(), stored, space, links_, properties, H5P_DEFAULT);
        H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
        H5Dclose(data);
        H5Pclose(properties);
        H5Sclose(space);
    }
    hid_t file_;
    hid_t links_;
};

struct Face {
    std::array<std::int32_t, 4> nodes;
    std::int32_t c0;
    std::int32_t c1;
};

struct FaceZone {
    int id;
    int kind;
    std::string name;
    std::vector<Face> faces;
};

/// Two unit cubes beside each other along x; nodes by x, y, z. Normals point into c0.
std::vector<FaceZone> zones() {
    const auto node = [](int i, int j, int k) { return 1 + i + 3 * (j + 2 * k); };
    std::vector<FaceZone> result = {
        {5, 2, "interior-tank", {}}, {6, 3, "hull", {}}, {7, 10, "inlet", {}}, {8, 5, "outlet", {}}};
    result[0].faces = {{{node(1, 0, 0), node(1, 1, 0), node(1, 1, 1), node(1, 0, 1)}, 2, 1}};
    result[2].faces = {{{node(0, 0, 0), node(0, 1, 0), node(0, 1, 1), node(0, 0, 1)}, 1, 0}};
    result[3].faces = {{{node(2, 0, 0), node(2, 0, 1), node(2, 1, 1), node(2, 1, 0)}, 2, 0}};
    for (int i = 0; i < 2; ++i) {
        const std::int32_t cell = i + 1;
        result[1].faces.push_back(
            {{node(i, 0, 0), node(i + 1, 0, 0), node(i + 1, 1, 0), node(i, 1, 0)}, cell, 0});  // floor
        result[1].faces.push_back({{node(i, 0, 1), node(i, 1, 1), node(i + 1, 1, 1), node(i + 1, 0, 1)}, cell, 0});
        result[1].faces.push_back({{node(i, 0, 0), node(i, 0, 1), node(i + 1, 0, 1), node(i + 1, 0, 0)}, cell, 0});
        result[1].faces.push_back({{node(i, 1, 0), node(i + 1, 1, 0), node(i + 1, 1, 1), node(i, 1, 1)}, cell, 0});
    }
    return result;
}

/// `parts`: into how many pieces nodes and faces are cut, regardless of zones. `placeholders`: an interface whose two
/// faces have no nodes, only the cell beside them.
void write_mesh(Writer& out, int parts = 1, bool placeholders = false) {
    const std::string root = "/meshes/1";
    out.group(root);
    out.attribute(root, "dimension", 3);
    out.attribute(root, "nodeCount", 12);
    out.attribute(root, "cellCount", 2);
    std::vector<double> points;
    for (int k = 0; k < 2; ++k) {
        for (int j = 0; j < 2; ++j) {
            for (int i = 0; i < 3; ++i) {
                points.insert(points.end(), {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
            }
        }
    }
    for (int p = 0; p < parts; ++p) {
        const int first = 12 * p / parts;
        const int last = 12 * (p + 1) / parts;
        const std::string path = root + "/nodes/coords/" + std::to_string(p + 1);
        out.reals(path, {points.begin() + 3 * first, points.begin() + 3 * last}, 3);
        out.ids(path, first + 1, last);
    }
    const std::string cells = root + "/cells/zoneTopology/";
    out.ints(cells + "id", {2, 3});
    out.ints(cells + "minId", {1, 2});
    out.ints(cells + "maxId", {1, 2});
    out.ints(cells + "cellType", {4, 4});
    out.ints(cells + "zoneType", {1, 1});
    out.text(cells + "name", "water;more water");
    std::vector<std::int32_t> ids, first, last, kinds, sizes, nodes, c0, c1;
    std::string names;
    for (const auto& zone : zones()) {
        ids.push_back(zone.id);
        kinds.push_back(zone.kind);
        names += (names.empty() ? "" : ";") + zone.name;
        first.push_back(static_cast<std::int32_t>(c0.size()) + 1);
        for (const auto& face : zone.faces) {
            sizes.push_back(4);
            nodes.insert(nodes.end(), face.nodes.begin(), face.nodes.end());
            c0.push_back(face.c0);
            c1.push_back(face.c1);
        }
        last.push_back(static_cast<std::int32_t>(c0.size()));
    }
    if (placeholders) {
        ids.push_back(9);
        kinds.push_back(24);
        names += ";mate";
        first.push_back(static_cast<std::int32_t>(c0.size()) + 1);
        sizes.insert(sizes.end(), {0, 0});
        c0.insert(c0.end(), {1, 2});
        last.push_back(static_cast<std::int32_t>(c0.size()));
    }
    const auto count = static_cast<int>(c0.size());
    out.attribute(root, "faceCount", count);
    const std::string faces = root + "/faces/zoneTopology/";
    out.ints(faces + "id", ids);
    out.ints(faces + "minId", first);
    out.ints(faces + "maxId", last);
    out.ints(faces + "zoneType", kinds);
    out.text(faces + "name", names);
    for (int p = 0; p < parts; ++p) {
        const int from = count * p / parts;
        const int to = count * (p + 1) / parts;
        const std::string part = std::to_string(p + 1);
        out.ints(root + "/faces/nodes/" + part + "/nnodes", {sizes.begin() + from, sizes.begin() + to});
        out.ints(root + "/faces/nodes/" + part + "/nodes",
                 {nodes.begin() + 4 * from, placeholders ? nodes.end() : nodes.begin() + 4 * to});
        out.ids(root + "/faces/nodes/" + part, from + 1, to);
        out.ints(root + "/faces/c0/" + part, {c0.begin() + from, c0.begin() + to});
        out.ids(root + "/faces/c0/" + part, from + 1, to);
    }
    out.ints(root + "/faces/c1/1", {c1[0]});
    out.ids(root + "/faces/c1/1", 1, 1);
}

void write_case(const fs::path& path, int parts = 1) {
    Writer out(path);
    write_mesh(out, parts);
    out.text("/settings/Origin", "ANSYS_FLUENT 99.1 Build 1");
    out.text("/settings/Rampant Variables", "((operating-pressure 101325)(case-file-units \"si\"))");
    out.text("/settings/Thread Variables", "(39 (6 wall hull 1)(\n))(39 (2 fluid water 1)())");
}

/// Two phases beside the mixture; pressure 10 x at the middle of each face; a force of (1, 0, 0) N per face of the
/// hull.
void write_data(const fs::path& path) {
    Writer out(path);
    const auto put = [&](const std::string& where, int part, int first, int last, const std::vector<double>& values,
                         hsize_t columns = 0) {
        const std::string name = "/results/1/" + where + "/" + std::to_string(part);
        out.reals(name, values, columns);
        out.ids(name, first, last);
    };
    put("phase-1/cells/SV_P", 1, 1, 1, {5});
    put("phase-1/cells/SV_P", 2, 2, 2, {15});
    put("phase-2/cells/SV_VOF", 1, 1, 2, {0.25, 0.75});
    put("phase-3/cells/SV_VOF", 1, 1, 2, {0.75, 0.25});
    put("phase-1/faces/SV_P", 1, 1, 11, {10, 5, 5, 5, 5, 15, 15, 15, 15, 0, 20});
    put("phase-1/faces/SV_WALL_SHEAR", 1, 2, 9,
        {-1, 0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0}, 3);
    out.text("/settings/Case File", "elsewhere/other.cas.h5");
}

}  // namespace

TEST(FluentHdf5, ZonesPhasesAndForcesAreRight) {
    for (const int parts : {1, 3, 5}) {
        SCOPED_TRACE(parts);
        const core::TemporaryFolder folder;
        write_case(folder.path() / "tank.cas.h5", parts);
        write_data(folder.path() / "tank.dat.h5");
        for (const char* name : {"tank.cas.h5", "tank.dat.h5"}) {
            const auto field = read_field(folder.path() / name);
            EXPECT_EQ(field.format, "Fluent HDF5");
            EXPECT_EQ(field.writer, "ANSYS_FLUENT 99.1 Build 1");
            EXPECT_EQ(field.pressure.operating_pressure, 101325);
            ASSERT_NE(field.find("more water"), nullptr);
            EXPECT_NEAR(test::volume_of(field), 2, 1e-14);
            EXPECT_EQ(field.find("more water")->volume->GetCellData()->GetArray("pressure")->GetTuple1(0), 15);
            EXPECT_EQ(field.find("water")->volume->GetCellData()->GetArray("volume_fraction.phase-2")->GetTuple1(0),
                      0.25);
            EXPECT_EQ(field.find("water")->volume->GetCellData()->GetArray("volume_fraction.phase-3")->GetTuple1(0),
                      0.75);
            // Gauss: the gradient of the pressure is (10, 0, 0).
            test::Triple force{};
            for (const char* zone : {"hull", "inlet", "outlet"}) {
                const auto part = test::pressure_force(*field.find(zone)->surface);
                for (std::size_t k = 0; k < 3; ++k) {
                    force[k] += part[k];
                }
            }
            EXPECT_NEAR(force[0], 20, 1e-12);
            EXPECT_NEAR(force[1], 0, 1e-12);
            EXPECT_NEAR(test::viscous_force(*field.find("hull")->surface)[0], 8, 1e-12);
        }
    }
}

TEST(FluentHdf5, SurfacesAloneAreTheSameSurfacesWithTheirOwnNodesOnly) {
    const core::TemporaryFolder folder;
    write_case(folder.path() / "tank.cas.h5", 3);
    write_data(folder.path() / "tank.dat.h5");
    ReadOptions options;
    options.surfaces_only = true;
    const auto field = read_field(folder.path() / "tank.cas.h5", options);
    const auto whole = read_field(folder.path() / "tank.cas.h5");
    EXPECT_EQ(test::cells_of(field), 0);
    for (const char* zone : {"hull", "inlet", "outlet"}) {
        ASSERT_NE(field.find(zone), nullptr);
        EXPECT_EQ(test::pressure_force(*field.find(zone)->surface), test::pressure_force(*whole.find(zone)->surface));
        EXPECT_EQ(field.find(zone)->surface->GetNumberOfPoints(), whole.find(zone)->surface->GetNumberOfPoints());
    }
}

TEST(FluentHdf5, ASolidNeedsNoValuesAndAWallTakesThePressureOfItsCells) {
    const core::TemporaryFolder folder;
    {
        Writer out(folder.path() / "tank.cas.h5");
        write_mesh(out);
        out.text("/settings/Rampant Variables", "((operating-pressure 101325))");
        out.text("/settings/Thread Variables",
                 "(39 (6 wall hull 1)(\n))(39 (2 fluid water 1)())(39 (3 solid more 1)())");
        Writer data(folder.path() / "tank.dat.h5");
        data.reals("/results/1/phase-1/cells/SV_P/1", {5});
        data.ids("/results/1/phase-1/cells/SV_P/1", 1, 1);
    }
    for (const bool surfaces_only : {false, true}) {
        ReadOptions options;
        options.surfaces_only = surfaces_only;
        const auto field = read_field(folder.path() / "tank.cas.h5", options);
        const auto* hull = field.find("hull");
        ASSERT_NE(hull->find("pressure"), nullptr);
        EXPECT_EQ(hull->find("pressure")->on, postproc::Location::cells);
        EXPECT_EQ(test::range_of(*hull->surface, "pressure").low, 5);
        EXPECT_EQ(test::range_of(*hull->surface, "pressure").high, 5);
    }
    // The same values for a mesh of fluid alone are another case's.
    write_case(folder.path() / "tank.cas.h5");
    ReadOptions options;
    options.companion = folder.path() / "tank.cas.h5";
    EXPECT_THAT(test::refusal(folder.path() / "tank.dat.h5", options), HasSubstr("its cells end at 1"));
}

TEST(FluentHdf5, AnInterfaceWhoseFacesHaveNoNodesIsLeftOutAndSaid) {
    const core::TemporaryFolder folder;
    {
        Writer out(folder.path() / "tank.cas.h5");
        write_mesh(out, 1, true);
    }
    const auto field = read_field(folder.path() / "tank.cas.h5");
    EXPECT_EQ(test::cells_of(field), 2);
    EXPECT_NEAR(test::volume_of(field), 2, 1e-12);
    EXPECT_EQ(field.find("mate"), nullptr);
    EXPECT_THAT(
        test::told(field),
        HasSubstr(
            "the faces of interface 'mate' have no corners in the file, only the cells beside them: it is left out"));
    for (const auto& problem : field.problems) {
        EXPECT_NE(problem.severity, core::Problem::Severity::error) << problem.message;
    }
}

TEST(FluentHdf5, AMeshIsInTheUnitThatItStates) {
    for (const bool variable : {false, true}) {
        const core::TemporaryFolder folder;
        {
            Writer out(folder.path() / "tank.msh.h5");
            write_mesh(out);
            out.text_attribute("/meshes/1", "units", "in", variable);
        }
        const auto field = read_field(folder.path() / "tank.msh.h5");
        EXPECT_NEAR(test::volume_of(field), 2 * 0.0254 * 0.0254 * 0.0254, 1e-14);
    }
}

TEST(FluentHdf5, NamesMayBeStringsOfVariableLengthInOneOrOneForEachZone) {
    const std::string cells = "/meshes/1/cells/zoneTopology/name";
    const std::string faces = "/meshes/1/faces/zoneTopology/name";
    for (const bool in_one : {true, false}) {
        SCOPED_TRACE(in_one);
        const core::TemporaryFolder folder;
        {
            Writer out(folder.path() / "tank.cas.h5");
            write_mesh(out);
            if (in_one) {
                out.texts(cells, {"water;more water"});
                out.texts(faces, {"interior-tank; hull;inlet;outlet"});
            } else {
                out.texts(cells, {"water", "more water"});
                out.texts(faces, {"interior-tank", "hull", "inlet", "outlet"});
            }
            out.texts("/settings/Rampant Variables", {"((operating-pressure 90000)", "(case-file-units \"si\"))"});
        }
        const auto field = read_field(folder.path() / "tank.cas.h5");
        for (const char* name : {"water", "more water", "hull", "inlet", "outlet"}) {
            EXPECT_NE(field.find(name), nullptr) << name;
        }
        EXPECT_EQ(field.pressure.operating_pressure, 90000);
    }
}

TEST(FluentHdf5, CellsOfAnotherKindAmongManyAlikeAreFoundWhereTheFileDoesNotSayWhatTheyAre) {
    // A row of squares, one of them cut into two triangles whose ids lie far from it.
    constexpr int columns = 100;
    constexpr int cut = 2;
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "row.msh.h5";
    const auto bottom = [](int i) { return 1 + i; };
    const auto top = [](int i) { return 2 + columns + i; };
    std::array<int, columns> cell_of{};
    int next = 1;
    for (int c = 0; c < columns; ++c) {
        next += next == 3 || next == 6 ? 1 : 0;
        cell_of[static_cast<std::size_t>(c)] = c == cut ? 0 : next++;
    }
    const auto cell = [&](int column, bool upper) {
        return column == cut ? (upper ? 6 : 3) : cell_of[static_cast<std::size_t>(column)];
    };
    std::vector<std::int32_t> nodes, c0, c1;
    const auto face = [&](int a, int b, int left, int right = 0) {
        nodes.insert(nodes.end(), {a, b});
        c0.push_back(left);
        c1.push_back(right);
    };
    for (int c = 1; c < columns; ++c) {
        face(bottom(c), top(c), cell(c - 1, false), cell(c, true));
    }
    face(bottom(cut), top(cut + 1), 6, 3);
    const auto inside = static_cast<int>(c0.size());
    face(top(0), bottom(0), cell(0, true));
    face(bottom(columns), top(columns), cell(columns - 1, false));
    for (int c = 0; c < columns; ++c) {
        face(bottom(c), bottom(c + 1), cell(c, false));
        face(top(c + 1), top(c), cell(c, true));
    }
    {
        Writer out(path);
        const std::string root = "/meshes/1";
        const auto faces = static_cast<int>(c0.size());
        out.group(root);
        out.attribute(root, "dimension", 2);
        out.attribute(root, "nodeCount", 2 * (columns + 1));
        out.attribute(root, "cellCount", columns + 1);
        out.attribute(root, "faceCount", faces);
        std::vector<double> points;
        for (const double y : {0.0, 1.0}) {
            for (int i = 0; i <= columns; ++i) {
                points.insert(points.end(), {static_cast<double>(i), y});
            }
        }
        out.reals(root + "/nodes/coords/1", points, 2);
        out.ids(root + "/nodes/coords/1", 1, 2 * (columns + 1));
        const auto zones = [&](const std::string& where, const std::vector<std::vector<std::int32_t>>& lists) {
            for (std::size_t i = 0; i < lists.size(); ++i) {
                out.ints(root + where + "/zoneTopology/" + std::array{"id", "minId", "maxId", "zoneType"}[i], lists[i]);
            }
        };
        zones("/cells", {{2}, {1}, {columns + 1}, {1}});
        zones("/faces", {{3, 4}, {1, inside + 1}, {inside, faces}, {2, 3}});
        out.ints(root + "/faces/nodes/1/nnodes", std::vector<std::int32_t>(c0.size(), 2));
        out.ints(root + "/faces/nodes/1/nodes", nodes);
        out.ids(root + "/faces/nodes/1", 1, faces);
        out.ints(root + "/faces/c0/1", c0);
        out.ids(root + "/faces/c0/1", 1, faces);
        out.ints(root + "/faces/c1/1", {c1.begin(), c1.begin() + inside});
        out.ids(root + "/faces/c1/1", 1, inside);
    }
    const auto field = read_field(path);
    ASSERT_EQ(test::cells_of(field), columns + 1);
    vtkUnstructuredGrid& grid = *field.find("fluid-2")->volume;
    EXPECT_EQ(test::count_cells(grid, VTK_TRIANGLE), 2);
    EXPECT_EQ(test::count_cells(grid, VTK_QUAD), columns - 1);
    EXPECT_EQ(grid.GetCellType(2), VTK_TRIANGLE);
    EXPECT_EQ(grid.GetCellType(5), VTK_TRIANGLE);
    EXPECT_NEAR(test::volume_of(field), columns, 1e-12);
}

TEST(FluentHdf5, AFileCutAnywhereIsRefusedOrWhole) {
    const core::TemporaryFolder folder;
    write_case(folder.path() / "whole.cas.h5", 2);
    write_data(folder.path() / "whole.dat.h5");
    const std::string mesh = core::read_file(folder.path() / "whole.cas.h5");
    for (std::size_t size = 1; size < mesh.size(); size += mesh.size() / 40) {
        std::ofstream(folder.path() / "cut.cas.h5", std::ios::binary) << mesh.substr(0, size);
        EXPECT_THAT(test::refusal(folder.path() / "cut.cas.h5"), HasSubstr("cut.cas.h5")) << size;
    }
    const std::string data = core::read_file(folder.path() / "whole.dat.h5");
    ReadOptions options;
    options.companion = folder.path() / "whole.cas.h5";
    for (std::size_t size = 1; size < data.size(); size += data.size() / 40) {
        std::ofstream(folder.path() / "cut.dat.h5", std::ios::binary) << data.substr(0, size);
        EXPECT_THAT(test::refusal(folder.path() / "cut.dat.h5", options), HasSubstr("cut.dat.h5")) << size;
    }
}

TEST(FluentHdf5, AZoneOfParentsIsNoPartOfTheMesh) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "split.cas.h5";
    write_case(path);
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t types = H5Dopen2(file, "/meshes/1/cells/zoneTopology/zoneType", H5P_DEFAULT);
    const std::array<std::int32_t, 2> fluid_and_parents = {1, 32};
    H5Dwrite(types, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, fluid_and_parents.data());
    H5Dclose(types);
    H5Fclose(file);
    EXPECT_EQ(test::cells_of(read_field(path)), 1);
}

TEST(FluentHdf5, ACaseTakesNoDataOfAnotherRun) {
    const core::TemporaryFolder folder;
    write_case(folder.path() / "wing-10.cas.h5");
    write_case(folder.path() / "run.cas.h5");
    write_data(folder.path() / "wing.dat.h5");
    write_data(folder.path() / "run-1-00010.dat.h5");
    EXPECT_EQ(read_field(folder.path() / "wing-10.cas.h5").files.size(), 1U);
    const auto later =
        read_field(folder.path() / "run-1-00010.dat.h5");  // results of a series belong to the case they began with
    ASSERT_EQ(later.files.size(), 2U);
    EXPECT_THAT(later.files[0], HasSubstr("run-1-00010.dat.h5"));  // the one that was asked for
    EXPECT_THAT(later.files[1], HasSubstr("run.cas.h5"));
}

TEST(FluentHdf5, WrongCountsAreRefusedWithTheirPath) {
    const core::TemporaryFolder folder;
    const auto path = folder.path() / "wrong.cas.h5";
    const auto damaged = [&](const auto& damage) {
        write_case(path);
        const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
        damage(file);
        H5Fclose(file);
        return test::refusal(path);
    };
    const auto set = [](hid_t file, const char* object, const char* name, std::int64_t value) {
        const hid_t owner = H5Oopen(file, object, H5P_DEFAULT);
        const hid_t attribute = H5Aopen(owner, name, H5P_DEFAULT);
        H5Awrite(attribute, H5T_NATIVE_INT64, &value);
        H5Aclose(attribute);
        H5Oclose(owner);
    };
    EXPECT_THAT(damaged([&](hid_t f) { set(f, "/meshes/1", "nodeCount", 13); }), HasSubstr("13 nodes"));
    EXPECT_THAT(damaged([&](hid_t f) { set(f, "/meshes/1", "nodeCount", 1LL << 40); }), HasSubstr("/meshes/1"));
    EXPECT_THAT(damaged([&](hid_t f) { set(f, "/meshes/1", "faceCount", 12); }), HasSubstr("missing"));
    EXPECT_THAT(damaged([&](hid_t f) { set(f, "/meshes/1", "cellCount", 3); }), HasSubstr("cells"));
    EXPECT_THAT(damaged([&](hid_t f) { set(f, "/meshes/1/faces/c0/1", "maxId", -5); }), HasSubstr("ids 1 to -5"));
    EXPECT_THAT(
        damaged([&](hid_t f) { set(f, "/meshes/1/faces/c0/1", "maxId", std::numeric_limits<std::int64_t>::max()); }),
        HasSubstr("ids 1 to 9223372036854775807"));
    EXPECT_THAT(damaged([&](hid_t f) {  // an attribute of a number with bits elsewhere
                    const hid_t owner = H5Oopen(f, "/meshes/1/faces/c0/1", H5P_DEFAULT);
                    H5Adelete(owner, "maxId");
                    const hid_t odd = H5Tcopy(H5T_STD_I64LE);
                    H5Tset_precision(odd, 40);
                    H5Tset_offset(odd, 24);
                    const hid_t space = H5Screate(H5S_SCALAR);
                    H5Aclose(H5Acreate2(owner, "maxId", odd, space, H5P_DEFAULT, H5P_DEFAULT));
                    H5Sclose(space);
                    H5Tclose(odd);
                    H5Oclose(owner);
                }),
                HasSubstr("its attribute maxId is not one whole number"));
    EXPECT_THAT(damaged([&](hid_t f) { H5Ldelete(f, "/meshes/1/faces/nodes/1/nodes", H5P_DEFAULT); }),
                HasSubstr("faces/nodes/1"));
    EXPECT_THAT(damaged([&](hid_t f) { H5Ldelete(f, "/meshes/1/faces/c0", H5P_DEFAULT); }),
                HasSubstr("understood so far"));
    const auto values = [](hid_t file, const char* name, std::vector<std::int32_t> list) {
        const hid_t data = H5Dopen2(file, name, H5P_DEFAULT);
        H5Dwrite(data, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, list.data());
        H5Dclose(data);
    };
    // A type wider than any number: what the library would take beside the values is not theirs.
    EXPECT_THAT(damaged([&](hid_t f) {
                    const char* name = "/meshes/1/cells/zoneTopology/minId";
                    H5Ldelete(f, name, H5P_DEFAULT);
                    const hid_t wide = H5Tcopy(H5T_NATIVE_INT32);
                    H5Tset_size(wide, 32);
                    const hsize_t two = 2;
                    const hid_t space = H5Screate_simple(1, &two, nullptr);
                    const hid_t data = H5Dcreate2(f, name, wide, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
                    const std::array<char, 64> numbers{};
                    H5Dwrite(data, wide, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
                    H5Dclose(data);
                    H5Sclose(space);
                    H5Tclose(wide);
                }),
                HasSubstr("its numbers of 32 bytes are of no kind that is read"));
    EXPECT_THAT(damaged([&](hid_t f) {
                    values(f, "/meshes/1/faces/nodes/1/nnodes", {4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 400});
                }),
                HasSubstr("more nodes"));
    EXPECT_THAT(damaged([&](hid_t f) {
                    values(f, "/meshes/1/faces/nodes/1/nnodes", {4, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4});
                }),
                HasSubstr("43 corners together, and 44 nodes"));
    EXPECT_THAT(damaged([&](hid_t f) {
                    values(f, "/meshes/1/cells/zoneTopology/maxId", {1, 2000000});
                    set(f, "/meshes/1", "cellCount", 2000000);
                }),
                HasSubstr("2000000 cells, but its faces have only"));
    EXPECT_THAT(damaged([&](hid_t f) { set(f, "/meshes/1", "cellCount", 2000000000); }),
                HasSubstr("cellCount is 2000000000, more than a file of"));
    EXPECT_THAT(damaged([&](hid_t f) {
                    values(f, "/meshes/1/cells/zoneTopology/maxId", {2, 2});
                }),
                HasSubstr("cells beyond the 2"));
    EXPECT_THAT(damaged([&](hid_t f) {
                    values(f, "/meshes/1/cells/zoneTopology/minId", {1, 1}),
                        values(f, "/meshes/1/cells/zoneTopology/maxId", {1, 1});
                }),
                HasSubstr("have numbers in common, from 1 on"));
    // Nodes 9 to 12 twice, 5 to 8 never: their sum is right.
    write_case(path, 3);
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    set(file, "/meshes/1/nodes/coords/2", "minId", 9);
    set(file, "/meshes/1/nodes/coords/2", "maxId", 12);
    H5Fclose(file);
    EXPECT_THAT(test::refusal(path), HasSubstr("its ids begin at 9"));
    EXPECT_THAT(damaged([&](hid_t f) { values(f, "/meshes/1/faces/c1/1", {-7}); }), HasSubstr("names cell"));
    EXPECT_THAT(damaged([&](hid_t f) {
                    values(f, "/meshes/1/faces/c0/1", {2, 1, 1, 1, 1, 2, 2, 2, 2, 1, 77});
                }),
                HasSubstr("names cell 77"));
}

}  // namespace underbody
