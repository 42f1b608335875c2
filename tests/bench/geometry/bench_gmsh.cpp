// The same surface from gmsh (Debian's program, called as a peer) and from Underbody: time, smallest angle, distance to
// the exact shape. Skips aloud when gmsh is not installed.
#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>

#include "core/file.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/certificate.h"
#include "geometry/mesh/mesh_file.h"
#include "geometry/mesh/mesh_reader.h"

namespace {

using namespace underbody;
using geometry::BodyShape;

// Processor seconds of this program and of those it called: another load on the machine does not count.
double processor_seconds() {
    double sum = 0;
    for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        ::getrusage(who, &usage);
        for (const timeval& t : {usage.ru_utime, usage.ru_stime}) {
            sum += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
        }
    }
    return sum;
}

// The shape as gmsh's OpenCASCADE kernel builds it: a sphere stretched and cut, a bump of a cylinder with round ends.
std::string geo(const BodyShape& s, double edge) {
    const auto n = [](double v) { return std::to_string(v); };
    const double depth = s.base_depth();
    std::string text = "SetFactory(\"OpenCASCADE\");\nSphere(1) = {0, 0, 0, 1};\nDilate {{0, 0, 0}, {" +
                       n(s.length / 2) + ", " + n(s.width / 2) + ", " + n(s.height / 2) +
                       "}} { Volume{1}; }\nTranslate {0, 0, " + n(depth) +
                       "} { Volume{1}; }\nBox(2) = {-1, -1, -1, 2, 2, 1};\n"
                       "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n";
    if (s.protrusion) {
        const double half = s.protrusion->length / 2, height = s.protrusion->height;
        const double radius = (half * half + height * height) / (2 * height), centre = radius - height;
        const double axis = geometry::protrusion_width(s) / 2 - half, x = s.base_x(s.protrusion->position);
        text += "Cylinder(4) = {" + n(x) + ", " + n(-axis) + ", " + n(centre) + ", 0, " + n(2 * axis) + ", 0, " +
                n(radius) + "};\n";
        for (const int end : {-1, 1}) {
            text += "Sphere(" + std::to_string(6 + end) + ") = {" + n(x) + ", " + n(end * axis) + ", " + n(centre) +
                    ", " + n(radius) + "};\n";
        }
        text +=
            "Box(8) = {-1, -1, -1, 2, 2, 1};\nBooleanUnion(9) = { Volume{4}; Delete; }{ Volume{5, 7}; Delete; };\n"
            "BooleanIntersection(10) = { Volume{9}; Delete; }{ Volume{8}; Delete; };\n"
            "BooleanUnion(11) = { Volume{3}; Delete; }{ Volume{10}; Delete; };\n";
    }
    return text + "Mesh.MeshSizeMin = " + n(edge) + ";\nMesh.MeshSizeMax = " + n(edge) + ";\n";
}

std::optional<geometry::SurfaceMesh> by_gmsh(const BodyShape& shape, double edge, const core::TemporaryFolder& folder) {
    core::write_file(folder.path() / "body.geo", geo(shape, edge));
    const std::string command = "cd '" + folder.path().string() +
                                "' && /usr/bin/gmsh body.geo -2 -nt 1 -format stl -bin -o body.stl >gmsh.log 2>&1";
    if (std::system(command.c_str()) != 0) {
        return {};
    }
    geometry::MeshReadOptions reading;
    reading.unit = "m";
    geometry::SurfaceMesh mesh = geometry::read_mesh(folder.path() / "body.stl", reading);
    // Patches by place: what stands below the base is the protrusion, what lies on it the base.
    mesh.patch_names = {"base", "hull", "protrusion"};
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        double low = 1, high = -1;
        for (std::size_t k = 0; k < 3; ++k) {
            low = std::min(low, mesh.corner(i, k).z);
            high = std::max(high, mesh.corner(i, k).z);
        }
        mesh.patch[i] = low < -1e-7 ? 2 : high < 1e-7 ? 0 : 1;
    }
    return mesh;
}

void state_quality(benchmark::State& state, const geometry::Certificate& certificate, std::size_t triangles) {
    state.counters["triangles"] = static_cast<double>(triangles);
    state.counters["sound"] = certificate.passed() ? 1 : 0;
    state.counters["smallest_angle_deg"] = certificate.smallest_angle * 57.29578;
    state.counters["distance_rms_um"] = certificate.exact->distance_rms * 1e6;
    state.counters["distance_largest_um"] = certificate.exact->distance_largest * 1e6;
}

// An edge length of gmsh's for about the wanted number of triangles: found once, outside the clock, from a coarse one.
double edge_for(const BodyShape& shape, std::size_t triangles, const core::TemporaryFolder& folder) {
    constexpr double trial = 0.006;
    const auto coarse = by_gmsh(shape, trial, folder);
    return coarse ? trial * std::sqrt(static_cast<double>(coarse->triangles.size()) / static_cast<double>(triangles))
                  : 0.0;
}

void gmsh_peer(benchmark::State& state, const BodyShape& shape) {
    if (::access("/usr/bin/gmsh", X_OK) != 0) {
        state.SkipWithError("skipped: gmsh is not installed (Debian: apt install gmsh)");
        return;
    }
    const core::TemporaryFolder folder;
    const double edge = edge_for(shape, static_cast<std::size_t>(state.range(0)), folder);
    std::optional<geometry::SurfaceMesh> mesh;
    for (auto _ : state) {
        const double start = processor_seconds();
        mesh = edge > 0 ? by_gmsh(shape, edge, folder) : std::nullopt;
        if (!mesh) {
            state.SkipWithError("gmsh failed");
            return;
        }
        state.SetIterationTime(processor_seconds() - start);
    }
    state_quality(state, geometry::certify(*mesh, shape), mesh->triangles.size());
}

// The same work as the peer's: made, written as STL, read back; the certificate stands outside the clock for both.
void underbody_here(benchmark::State& state, const BodyShape& shape) {
    geometry::SurfaceOptions options;
    options.triangles = static_cast<std::size_t>(state.range(0));
    geometry::SurfaceMesh mesh;
    const core::TemporaryFolder folder;
    for (auto _ : state) {
        const double start = processor_seconds();
        mesh = geometry::make_surface(shape, options);
        geometry::write_mesh(mesh, folder.path() / "body.stl");
        geometry::MeshReadOptions reading;
        reading.unit = "m";
        benchmark::DoNotOptimize(geometry::read_mesh(folder.path() / "body.stl", reading));
        state.SetIterationTime(processor_seconds() - start);
    }
    state_quality(state, geometry::certify(mesh, shape), mesh.triangles.size());
}

BodyShape bump() {
    BodyShape shape;
    shape.protrusion = geometry::Protrusion{};
    shape.protrusion->position = 0.7;
    return shape;
}

BENCHMARK_CAPTURE(underbody_here, ellipse, BodyShape{})
    ->Arg(20000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK_CAPTURE(gmsh_peer, ellipse, BodyShape{})
    ->Arg(20000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK_CAPTURE(underbody_here, ellipse_with_bump, bump())
    ->Arg(20000)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK_CAPTURE(gmsh_peer, ellipse_with_bump, bump())->Arg(20000)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
