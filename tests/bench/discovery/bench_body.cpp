// The bench of the motion of the whole body.
#include <cmath>

#include "bench_motion.h"
#include "tests/surrogates/discovery/body_rig.h"
#include "tests/surrogates/discovery/write_runs.h"

using namespace underbody;

namespace {

using test::BodyLoads;
using test::BodyMoment;
using test::BodyRig;

const std::vector<bench::Kind<BodyRig>> kinds{
    {"none", 0, [](BodyRig&) {}},
    {"none", 0.9, [](BodyRig&) {}},
    {"thrust_gain", 0, [](BodyRig& rig) { rig.thrust_gain = 0.95; }},
    {"jet_misalignment", 0, [](BodyRig& rig) { rig.jet_angle = 0.02; }},
    {"mass_centre_offset", 0, [](BodyRig& rig) { rig.mass_forward = 1e-4; }},
    {"mass_centre_aside", 0, [](BodyRig& rig) { rig.mass_aside = 5e-3; }},
    {"added_mass", 0, [](BodyRig& rig) { rig.added_mass = 0.8; }},
    {"declared_parameter", 0, [](BodyRig& rig) { rig.lift_factor = 1.4; }},
    {"constant_force", 0, [](BodyRig& rig) { rig.missing = [](const BodyMoment&) {
                                                 return BodyLoads{0, 0, 0.005};
                                             }; }},
    {"moment_offset", 0,
     [](BodyRig& rig) { rig.missing = [](const BodyMoment&) {
                            return BodyLoads{0, 0, 0, 5e-4};
                        }; }},
    {"yaw_moment_offset", 0,
     [](BodyRig& rig) { rig.missing = [](const BodyMoment&) {
                            return BodyLoads{0, 0, 0, 0, 5e-4};
                        }; }},
    {"cable_pull", 0,
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment& now) {
             return BodyLoads{0.02 * std::cos(now.heading), -0.02 * std::sin(now.heading)};
         };
     }},
    {"tether_with_arm", 0,
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment& now) {
             const double pull = -0.15 * (now.gap + 0.05 * std::sin(now.pitch) - 0.15);
             return BodyLoads{0, 0, pull, 0.05 * (std::cos(now.pitch) + std::sin(now.pitch)) * pull};
         };
     }},
    {"surface_roughness", 0,
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment& now) {
             const double x = now.gap / 0.1, lift = test::pitch_rig_lift(now.gap, now.pitch),
                          up = lift * (0.8 / (1 + x * x) - 0.3 * x * x / (1 + x * x));
             return BodyLoads{0, 0, up, 0.05 * std::sin(now.pitch) * up};
         };
     }},
    {"sway_damping", 0,
     [](BodyRig& rig) { rig.missing = [](const BodyMoment& now) {
                            return BodyLoads{0, -0.5 * now.across};
                        }; }},
    {"linear_damping", 0,
     [](BodyRig& rig) { rig.missing = [](const BodyMoment& now) {
                            return BodyLoads{0, 0, -0.5 * now.rise};
                        }; }},
    {"pitch_damping", 0,
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment& now) { return BodyLoads{0, 0, 0, -0.005 * now.nose_rate}; };
     }},
    {"yaw_damping", 0,
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment& now) { return BodyLoads{0, 0, 0, 0, -0.004 * now.turn_rate}; };
     }},
    // outside the catalogue: a side force over the gap, a moment over the speed
    {"side force by gap", 0,
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment& now) { return BodyLoads{0, 0.08 * std::exp(-now.gap / 0.05)}; };
     }},
    {"moment by speed", 0,
     [](BodyRig& rig) {
         rig.missing = [](const BodyMoment& now) { return BodyLoads{0, 0, 0, 0.05 * now.speed * now.speed}; };
     }},
};

}  // namespace

int main(int argc, char** argv) {
    const bench::MotionOptions asked = bench::motion_options(argc, argv);
    if (!asked.understood) {
        return 2;
    }
    const core::TemporaryFolder folder("bench-body");
    return bench::judge(
        kinds, test::body_rig_model(folder.path()), asked,
        [](const BodyRig& rig, std::uint64_t seed) { return test::body_rig_runs(rig, 6, seed); },
        [](const dynamics::Measurements& data, const std::filesystem::path& where, const char* kind) {
            test::write_runs(data, where / "runs", "body", kind);
            test::body_rig_model(where);
        });
}
