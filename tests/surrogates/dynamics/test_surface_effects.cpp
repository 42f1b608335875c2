// Effects on a body on the ground against their closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "surrogates/dynamics/simulate/surface_motion.h"

namespace underbody::dynamics {

namespace {

Model rig() {
    return read_model_text(
        "[vehicle]\nmass = 2\nnet_weight = 1\nyaw_inertia = 0.01\n[contact]\nfriction = 0.1\n"
        "[[jet]]\nname = \"port\"\nposition = [-0.1, -0.06, 0]\ndirection = [1, 0, 0]\nmaximum = 1\n"
        "[[jet]]\nname = \"bow\"\nposition = [0.1, 0, 0]\ndirection = [0, 1, 0]\nmaximum = 1\n",
        "rig.toml", ".");
}

TEST(SurfaceRig, TwoJetsOfOneNameAreRefused) {
    const std::string jet = "[[jet]]\nname = \"port\"\nposition = [0, 0, 0]\ndirection = [1, 0, 0]\nmaximum = 1\n";
    EXPECT_NO_THROW((void)read_model_text("[vehicle]\nmass = 2\nnet_weight = 1\n" + jet, "rig.toml", "."));
    EXPECT_THROW((void)read_model_text("[vehicle]\nmass = 2\nnet_weight = 1\n" + jet + jet, "rig.toml", "."),
                 core::InputError);
}

/// Forces along and across the body and yaw moment that an effect adds, at a moment.
std::array<double, 3> added(const EffectUse& use, const SurfaceState& y) {
    const std::vector<double> thrust{0.4, 0.1};
    SurfaceState without{}, with{};
    SurfaceMotion(rig()).rate(y, thrust, without);
    SurfaceMotion(rig().with_effect(use)).rate(y, thrust, with);
    return {2 * (with[0] - without[0]), 2 * (with[1] - without[1]), 0.01 * (with[2] - without[2])};
}

void expect_added(const EffectUse& use, const SurfaceState& y, double along, double across, double turning) {
    const std::array<double, 3> own = added(use, y);
    EXPECT_NEAR(own[0], along, 1e-9) << use.name;
    EXPECT_NEAR(own[1], across, 1e-9) << use.name;
    EXPECT_NEAR(own[2], turning, 1e-9) << use.name;
}

TEST(SurfaceEffects, AddWhatTheirFormulasSay) {
    const SurfaceState y{0.3, -0.1, 0.7, 0.5, 0, 0};
    expect_added(make_use("surge_damping", {{"coefficient", 0.2}}), y, -0.2 * 0.3, 0, 0);
    expect_added(make_use("sway_damping", {{"coefficient", 0.2}}), y, 0, 0.2 * 0.1, 0);
    expect_added(make_use("yaw_damping", {{"coefficient", 0.02}}), y, 0, 0, -0.02 * 0.7);
    expect_added(make_use("yaw_moment_offset", {{"moment", 0.003}}), y, 0, 0, 0.003);
    expect_added(make_use("thrust_gain", {{"gain", 1.1}}), y, 0.04, 0.01, 0.1 * (0.06 * 0.4 + 0.1 * 0.1));
    expect_added(make_use("cable_pull", {{"along", 0.05}, {"across", 0.02}}), y,
                 0.05 * std::cos(0.5) + 0.02 * std::sin(0.5), 0.02 * std::cos(0.5) - 0.05 * std::sin(0.5), 0);
    const double a = 0.1, c = std::cos(a), s = std::sin(a);
    expect_added(make_use("jet_misalignment", {{"angle", a}}), y, 0.4 * (c - 1) - 0.1 * s, 0.4 * s + 0.1 * (c - 1),
                 0.06 * 0.4 * (c - 1) - 0.1 * 0.4 * s + 0.1 * 0.1 * (c - 1));
    const double slip = std::sqrt(0.3 * 0.3 + 0.1 * 0.1 + 1e-6), rub = 0.1 / slip;
    expect_added(make_use("ground_friction", {{"coefficient", 0.1}}), y, -rub * 0.3, rub * 0.1, 0);
    expect_added(make_use("mass_centre_aside", {{"offset", 0.005}}), y, 0, 0, 0.005 * (0.4 - rub * 0.3));
}

TEST(SurfaceEffects, ActOnTheWholeBodyToo) {
    const auto body = [](const Model& model) {
        const RigidBody plant(model);
        BodyState y{0.3, -0.1, 0, 0, 0.7, 0, 0.5, 0, 0, -1}, d{};
        plant.rate(y, std::vector<double>{0.4, 0.1}, ContactState::free, d);
        return d;
    };
    const Model whole = rig()
                            .with_parameter("vehicle.roll_inertia", 0.01)
                            .with_parameter("vehicle.pitch_inertia", 0.01)
                            .with_parameter("vehicle.base_depth", 0.03)
                            .with_parameter("vehicle.base_half_length", 0.05);
    const SurfaceState y{0.3, -0.1, 0.7, 0.5, 0, 0};
    for (const EffectUse& use :
         {make_use("surge_damping", {{"coefficient", 0.2}}), make_use("sway_damping", {{"coefficient", 0.2}}),
          make_use("yaw_damping", {{"coefficient", 0.02}}), make_use("yaw_moment_offset", {{"moment", 0.003}}),
          make_use("thrust_gain", {{"gain", 1.1}}), make_use("jet_misalignment", {{"angle", 0.1}}),
          make_use("cable_pull", {{"along", 0.05}, {"across", 0.02}})}) {
        const BodyState before = body(whole), after = body(whole.with_effect(use));
        const std::array<double, 3> own = added(use, y);
        EXPECT_NEAR(2 * (after[state_u] - before[state_u]), own[0], 1e-9) << use.name;
        EXPECT_NEAR(2 * (after[state_v] - before[state_v]), own[1], 1e-9) << use.name;
        EXPECT_NEAR(0.01 * (after[state_r] - before[state_r]), own[2], 1e-9) << use.name;
    }
}

TEST(SurfaceEffects, LeaveHeaveAsItIs) {
    const HeavePlant without(rig()), with(rig().with_effect(make_use("yaw_damping", {{"coefficient", 0.02}})));
    HeaveSlopes slopes;
    EXPECT_EQ(with.acceleration(0.1, 0.2, {}, nullptr, slopes), without.acceleration(0.1, 0.2, {}, nullptr, slopes));
}

}  // namespace

}  // namespace underbody::dynamics
