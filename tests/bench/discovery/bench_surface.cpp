// The bench of the motion on the ground.
#include <cmath>

#include "bench_motion.h"
#include "tests/surrogates/discovery/surface_rig.h"
#include "tests/surrogates/discovery/write_runs.h"

using namespace underbody;

namespace {

const std::vector<bench::Kind<test::SurfaceRig>> kinds{
    {"none", 0, [](test::SurfaceRig&) {}},
    {"none", 0.9, [](test::SurfaceRig&) {}},
    {"thrust_gain", 0, [](test::SurfaceRig& rig) { rig.thrust_gain = 0.95; }},
    {"jet_misalignment", 0, [](test::SurfaceRig& rig) { rig.jet_angle = 0.02; }},
    {"ground_friction", 0, [](test::SurfaceRig& rig) { rig.more_friction = 0.03; }},
    {"surge_damping", 0,
     [](test::SurfaceRig& rig) { rig.surge = [](const test::SurfaceMoment& now) { return -0.3 * now.speed; }; }},
    {"sway_damping", 0,
     [](test::SurfaceRig& rig) { rig.sway = [](const test::SurfaceMoment& now) { return -0.5 * now.across; }; }},
    {"yaw_damping", 0,
     [](test::SurfaceRig& rig) { rig.turn = [](const test::SurfaceMoment& now) { return -0.004 * now.rate; }; }},
    {"yaw_moment_offset", 0, [](test::SurfaceRig& rig) { rig.turn = [](const test::SurfaceMoment&) { return 5e-4; }; }},
    {"cable_pull", 0,
     [](test::SurfaceRig& rig) {
         rig.surge = [](const test::SurfaceMoment& now) { return 0.03 * std::cos(now.heading); };
         rig.sway = [](const test::SurfaceMoment& now) { return -0.03 * std::sin(now.heading); };
     }},
};

}  // namespace

int main(int argc, char** argv) {
    const bench::MotionOptions asked = bench::motion_options(argc, argv);
    if (!asked.understood) {
        return 2;
    }
    const core::TemporaryFolder folder("bench-surface");
    return bench::judge(
        kinds, test::surface_rig_model(folder.path()), asked,
        [](const test::SurfaceRig& rig, std::uint64_t seed) { return test::surface_rig_runs(rig, 6, seed); },
        [](const dynamics::Measurements& data, const std::filesystem::path& where, const char* kind) {
            test::write_runs(data, where / "runs", "surface", kind);
            test::surface_rig_model(where);
        });
}
