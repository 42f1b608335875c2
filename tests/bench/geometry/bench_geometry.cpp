// Bodies, certificates, added mass.
#include <benchmark/benchmark.h>

#include "core/parallel.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/certificate.h"
#include "geometry/water/added_mass.h"

namespace {

using namespace underbody::geometry;

BodyShape rectangle_with_bump() {
    BodyShape shape;
    shape.base = BaseKind::rectangle;
    shape.protrusion = Protrusion{};
    return shape;
}

// A body with 100,000 triangles, certified: at most 1 s on one core.
void certified_body(benchmark::State& state, const BodyShape& shape) {
    SurfaceOptions options;
    options.triangles = static_cast<std::size_t>(state.range(0));
    Certificate certificate;
    std::size_t triangles = 0;
    for (auto _ : state) {
        const SurfaceMesh mesh = make_surface(shape, options);
        certificate = certify(mesh, shape);
        triangles = mesh.triangles.size();
        benchmark::DoNotOptimize(certificate);
    }
    if (!certificate.passed()) {
        state.SkipWithError("the body did not pass its certificate");
    }
    state.counters["triangles"] = static_cast<double>(triangles);
    state.counters["smallest_angle_deg"] = certificate.smallest_angle * 57.29578;
    state.counters["distance_largest_um"] = certificate.exact->distance_largest * 1e6;
}
BENCHMARK_CAPTURE(certified_body, ellipse, BodyShape{})->Arg(100000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(certified_body, rectangle_with_bump, rectangle_with_bump())
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond);

// 500 shapes of 20,000 triangles: at most 60 s on two cores.
void many_bodies(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    for (auto _ : state) {
        underbody::core::parallel_for(count, [&](std::size_t i) {
            BodyShape shape = rectangle_with_bump();
            shape.protrusion->height = 0.0005 + 0.003 * static_cast<double>(i) / static_cast<double>(count);
            benchmark::DoNotOptimize(certify(make_surface(shape), shape));
        });
    }
}
BENCHMARK(many_bodies)->Arg(500)->Unit(benchmark::kSecond)->Iterations(1)->UseRealTime();

// Added mass with 4,000 panels: at most 10 s.
void panels(benchmark::State& state) {
    AddedMassOptions options;
    options.placement = Placement{0.005, 0, 0};
    for (auto _ : state) {
        benchmark::DoNotOptimize(added_mass(BodyShape{}, static_cast<std::size_t>(state.range(0)), options, false));
    }
}
BENCHMARK(panels)->Arg(1000)->Arg(4000)->Unit(benchmark::kSecond)->Iterations(1)->UseRealTime();

}  // namespace
