// The bench of heave with pitch.
#include <array>
#include <cmath>

#include "bench_motion.h"
#include "tests/surrogates/discovery/pitch_rig.h"
#include "tests/surrogates/discovery/write_runs.h"

using namespace underbody;

namespace {

using discovery::Discovery;

bool moved(const Discovery& found, double seconds) {
    const dynamics::RecordReading& records = found.model.records;
    return std::abs(records.input_advance - seconds) < 0.02 && std::abs(records.others_advance - seconds) < 0.02 &&
           records.input_factor == 1 && records.factors.empty();
}

/// Of these inputs alone.
bool turned(const Discovery& found, double force, double moment) {
    const dynamics::RecordReading& records = found.model.records;
    return found.verdict == "none" && records.input_advance == 0 && records.others_advance == 0 &&
           records.factor_of("input_force") == force && records.factor_of("input_moment") == moment;
}

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
    {"late input", 0.9, [](test::PitchRig& rig) { rig.late = 5; },
     [](const Discovery& found) { return found.verdict == "none" && moved(found, 0.2); }},
    {"input late by a row", 0.9, [](test::PitchRig& rig) { rig.late = 1; },
     [](const Discovery& found) { return found.verdict == "none" && moved(found, 0.04); }},
    {"late input and linear_damping", 0,
     [](test::PitchRig& rig) {
         rig.late = 5;
         rig.force = [](const test::PitchMoment& now) { return -0.3 * now.rise; };
     },
     [](const Discovery& found) {
         return found.verdict == "effect" && found.effects.size() == 1 &&
                found.effects.front().name == "linear_damping" && moved(found, 0.2);
     }},
    {"turned force", 0, [](test::PitchRig& rig) { rig.logged_force = -1; },
     [](const Discovery& found) { return turned(found, -1, 1); }},
    {"turned moment", 0, [](test::PitchRig& rig) { rig.logged_moment = -1; },
     [](const Discovery& found) { return turned(found, 1, -1); }},
    {"zero by run", 0.9,
     [](test::PitchRig& rig) {
         rig.zero = [](std::size_t run) { return std::array{4e-3, -4e-3, 3e-3, -3e-3, 5e-3, -5e-3}[run % 6]; };
     },
     [](const Discovery& found) { return found.verdict == "unknown" && found.by_run.has_value(); }},
    {"periodic_disturbance", 0.9,
     [](test::PitchRig& rig) {
         rig.force = [](const test::PitchMoment& now) { return 4e-3 * std::sin(6.283185 * 0.37 * now.t + 1); };
     }},
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
