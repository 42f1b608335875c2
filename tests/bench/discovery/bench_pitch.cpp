// The bench of heave with pitch.
#include <cmath>

#include "bench_motion.h"
#include "tests/surrogates/discovery/pitch_rig.h"
#include "tests/surrogates/discovery/write_runs.h"

using namespace underbody;

namespace {

const std::vector<bench::Kind<test::PitchRig>> kinds{
    {"none", 0, [](test::PitchRig&) {}},
    {"none", 0.9, [](test::PitchRig&) {}},
    {"input_arm", 0,
     [](test::PitchRig& rig) {
         rig.moment = [](const test::PitchMoment& now) { return 0.008 * std::cos(now.pitch) * now.input; };
     }},
    {"moment_offset", 0, [](test::PitchRig& rig) { rig.moment = [](const test::PitchMoment&) { return 3e-4; }; }},
    {"pitch_damping", 0,
     [](test::PitchRig& rig) { rig.moment = [](const test::PitchMoment& now) { return -0.003 * now.rate; }; }},
    {"pitch_stiffness", 0,
     [](test::PitchRig& rig) {
         rig.moment = [](const test::PitchMoment& now) { return -0.006 * std::sin(now.pitch); };
     }},
    {"added_pitch_inertia", 0, [](test::PitchRig& rig) { rig.added_inertia = 0.002; }},
    {"linear_damping", 0,
     [](test::PitchRig& rig) { rig.force = [](const test::PitchMoment& now) { return -0.3 * now.rise; }; }},
    {"constant_force", 0, [](test::PitchRig& rig) { rig.force = [](const test::PitchMoment&) { return 0.01; }; }},
};

}  // namespace

int main(int argc, char** argv) {
    const bench::MotionOptions asked = bench::motion_options(argc, argv);
    if (!asked.understood) {
        return 2;
    }
    const core::TemporaryFolder folder("bench-pitch");
    return bench::judge(
        kinds, test::pitch_rig_model(folder.path()), asked,
        [](const test::PitchRig& rig, std::uint64_t seed) { return test::pitch_rig_runs(rig, 6, seed); },
        [](const dynamics::Measurements& data, const std::filesystem::path& where, const char* kind) {
            test::write_runs(data, where / "runs", "heave_pitch", kind);
            test::pitch_rig_model(where);
        });
}
