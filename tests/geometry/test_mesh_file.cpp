// Surfaces into files and back; files that are wrong.
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/file.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/certificate.h"
#include "geometry/body/mass_properties.h"
#include "geometry/mesh/mesh_file.h"
#include "geometry/mesh/mesh_reader.h"
#include "geometry/mesh/slice.h"

namespace underbody::geometry {
namespace {

SurfaceMesh sample() {
    BodyShape shape;
    shape.base = BaseKind::rectangle;
    shape.protrusion = Protrusion{};
    SurfaceOptions options;
    options.triangles = 3000;
    return make_surface(shape, options);
}

MeshReadOptions in(const char* unit) {
    MeshReadOptions options;
    options.unit = unit;
    return options;
}

TEST(MeshFile, KeepsTheSurfaceThroughEveryFormat) {
    const core::TemporaryFolder folder;
    const SurfaceMesh mesh = sample();
    const MassProperties mass = mass_properties(mesh);
    for (const auto& [name, format] : {std::pair{"a.stl", MeshFormat::stl_binary},
                                       {"b.stl", MeshFormat::stl_ascii},
                                       {"c.obj", MeshFormat::obj},
                                       {"d.ply", MeshFormat::ply},
                                       {"e.vtp", MeshFormat::vtp}}) {
        write_mesh(mesh, folder.path() / name, format, 1000);
        const SurfaceMesh back = read_mesh(folder.path() / name, in("mm"));
        EXPECT_TRUE(certify(back).passed()) << name;
        const MassProperties again = mass_properties(back);
        EXPECT_NEAR(again.volume / mass.volume, 1, format == MeshFormat::stl_binary ? 1e-6 : 1e-12) << name;
        EXPECT_EQ(back.triangles.size(), mesh.triangles.size()) << name;
        if (format != MeshFormat::stl_binary) {
            EXPECT_EQ(back.patch_names, mesh.patch_names) << name;
            EXPECT_NEAR(area(patch_of(back, "protrusion")), area(patch_of(mesh, "protrusion")), 1e-12) << name;
        }
    }
}

TEST(MeshFile, FindsPatchesByTheirSharpEdges) {
    const core::TemporaryFolder folder;
    SurfaceOptions options;
    options.triangles = 3000;
    const SurfaceMesh mesh = make_surface(BodyShape{}, options);
    write_mesh(mesh, folder.path() / "body.stl");
    const SurfaceMesh back = read_mesh(folder.path() / "body.stl", in("m"));
    EXPECT_THAT(back.patch_names, testing::UnorderedElementsAre("base", "hull"));
    EXPECT_NEAR(area(patch_of(back, "base")), area(patch_of(mesh, "base")), 1e-8);
}

TEST(MeshFile, TellsAFlatBaseFromSidesThatRunSmoothlyIntoIt) {
    const core::TemporaryFolder folder;
    const SurfaceMesh mesh = sample();  // the ends of its rectangle meet the base at a third of a degree
    write_mesh(mesh, folder.path() / "body.stl");
    const SurfaceMesh back = read_mesh(folder.path() / "body.stl", in("m"));
    EXPECT_NEAR(area(patch_of(back, "base")), area(patch_of(mesh, "base")), 1e-8);
}

template <class Call>
std::string refusal(const Call& call, const std::string& kind) {
    try {
        call();
    } catch (const core::InputError& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "was not refused";
    return {};
}

TEST(MeshFile, AsksForTheUnit) {
    const core::TemporaryFolder folder;
    write_mesh(sample(), folder.path() / "body.stl");
    EXPECT_THAT(refusal([&] { read_mesh(folder.path() / "body.stl", {}); }, "unit"),
                testing::HasSubstr("option 'unit mm'"));
    EXPECT_THROW(read_mesh(folder.path() / "body.stl", in("kg")), core::InputError);
}

TEST(MeshFile, RefusesFilesCutShort) {
    const core::TemporaryFolder folder;
    const SurfaceMesh mesh = sample();
    for (const auto& [name, format] : {std::pair{"a.stl", MeshFormat::stl_binary},
                                       {"b.stl", MeshFormat::stl_ascii},
                                       {"d.ply", MeshFormat::ply},
                                       {"e.vtp", MeshFormat::vtp}}) {
        const std::string bytes = mesh_bytes(mesh, format);
        for (const double share : {0.3, 0.9}) {
            core::write_file(folder.path() / name,
                             bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size()))));
            EXPECT_THROW(read_mesh(folder.path() / name, in("m")), core::InputError) << name;
        }
    }
    core::write_file(folder.path() / "a.stl", mesh_bytes(mesh, MeshFormat::stl_binary).substr(0, 1000));
    EXPECT_THAT(refusal([&] { read_mesh(folder.path() / "a.stl", in("m")); }, "truncated"),
                testing::HasSubstr("byte 1000"));
    core::write_file(folder.path() / "empty.stl", "");
    EXPECT_THROW(read_mesh(folder.path() / "empty.stl", in("m")), core::InputError);
}

TEST(MeshFile, RefusesWhatIsNoSurface) {
    const core::TemporaryFolder folder;
    const auto read = [&](const char* name, const std::string& text) {
        core::write_file(folder.path() / name, text);
        return read_mesh(folder.path() / name, in("m"));
    };
    EXPECT_THAT(refusal([&] { read("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n"); }, "index"), testing::HasSubstr("a.obj:3"));
    refusal([&] { read("a.obj", "v 0 0 nan\nv 1 0 0\n"); }, "number");
    refusal([&] { read("a.obj", "v 0 0 0\n"); }, "empty");
    refusal([&] { read("a.stl", "solid a\nfacet normal 0 0 1\nouter lop\n"); }, "parse");
    refusal(
        [&] {
            read("a.ply",
                 "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty double x\nend_header\n");
        },
        "truncated");
    refusal([&] { read("a.vtp", "<html></html>"); }, "parse");
}

TEST(Slice, CutsClosedCurvesOfTheRightLength) {
    SurfaceOptions options;
    options.triangles = 20000;
    const SurfaceMesh mesh = make_surface(BodyShape{}, options);
    const auto loops = slice(mesh, Axis::z, 0.054375);  // the midplane: an ellipse 203.2 x 152 mm
    ASSERT_EQ(loops.size(), 1u);
    double area = 0;
    for (std::size_t i = 0; i + 1 < loops[0].size(); ++i) {
        area += 0.5 * (loops[0][i].x * loops[0][i + 1].y - loops[0][i].y * loops[0][i + 1].x);
    }
    EXPECT_NEAR(std::abs(area), 3.14159265 * 0.1016 * 0.076, 3e-5);
    EXPECT_EQ(slice(mesh, Axis::y, 0).size(), 1u) << "a plane full of corners";
    const auto lines = feature_lines(mesh, 0.3);
    ASSERT_EQ(lines.size(), 1u) << "the edge of the base, one closed line";
    EXPECT_EQ(lines[0].front(), lines[0].back());
}

}  // namespace
}  // namespace underbody::geometry
