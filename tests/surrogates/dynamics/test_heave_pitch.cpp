// Heave and pitch coupled, with contact, and their regions.
#include <gtest/gtest.h>

#include <cmath>

#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

/// Lift and moment over (gap, pitch): a spring about 10 mm of gap and about `trim` of pitch, given on a grid and so
/// exact for the table.
Model spring_plate(double stiffness, double pitch_stiffness, double damping, double pitch_damping, double trim = 0,
                   double weight = 0) {
    std::vector<double> gap, pitch, lift, moment;
    for (int i = 0; i <= 30; ++i) {
        for (int j = 0; j <= 20; ++j) {
            gap.push_back(1e-3 * i);
            pitch.push_back(-.1 + .01 * j);
            lift.push_back(-stiffness * (gap.back() - .01) + weight);
            moment.push_back(-pitch_stiffness * (pitch.back() - trim));
        }
    }
    core::Table table;
    table.source = "plate.csv";
    table.add_numbers("gap", "m", gap);
    table.add_numbers("pitch", "rad", pitch);
    table.add_numbers("lift_force", "N", lift);
    table.add_numbers("pitch_moment", "N m", moment);
    Model model = read_model_text(
        "[vehicle]\nmass = 2.2\nadded_mass_heave = 1.754\npitch_inertia = 0.00685\nadded_inertia_pitch = "
        "0.0005\nbase_depth = 0.0514\n"
        "base_half_length = 0.0717\nnet_weight = " +
            test::number(weight) + "\n[drag.heave]\nlinear = " + test::number(damping) +
            "\n[drag.pitch]\nlinear = " + test::number(pitch_damping) + "\n",
        "plate.toml", ".");
    tables::FitOptions options;
    options.kind = tables::FitOptions::Kind::interpolation;
    for (const char* quantity : {"lift_force", "pitch_moment"}) {
        model.forces.push_back({quantity,
                                "plate.csv",
                                "plate.csv",
                                tables::ForceTable::fit(table, quantity, options),
                                {Channel::gap, Channel::pitch},
                                {},
                                1.0});
    }
    return model;
}

TEST(HeavePitch, FindsItsEquilibriumAndItsTwoFrequencies) {
    const HeavePitch plant(spring_plate(50, .2, 1, .001, .02));
    const auto found = plant.equilibria();
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].gap, .01, 1e-9);
    EXPECT_NEAR(found[0].pitch, .02, 1e-9);
    EXPECT_TRUE(found[0].stable);
    const std::vector<Mode> both = modes(plant.linearised(.01, .02), {"heave", "heave", "pitch", "pitch"});
    for (const Mode& mode : both) {
        if (mode.name == "heave") {
            EXPECT_NEAR(mode.frequency, std::sqrt(50 / 3.954), .05);
        }
        if (mode.name == "pitch") {
            EXPECT_NEAR(mode.frequency, std::sqrt(.2 / .00735), .05);
        }
    }
    EXPECT_EQ(both.size(), 2U);
}

TEST(HeavePitch, ComesToRestAtItsTrim) {
    const HeavePitch plant(spring_plate(50, .2, 4, .01, .02));
    TrajectoryOptions options;
    options.duration = 30;
    options.output_step = .1;
    const PitchTrajectory motion = simulate(plant, {.02, 0, -.01, 0}, options);
    EXPECT_NEAR(motion.state.back()[0], .01, 1e-6);
    EXPECT_NEAR(motion.state.back()[2], .02, 1e-6);
}

TEST(HeavePitch, FallsOntoAnEdgeAndLiesDownFlat) {
    const HeavePitch plant(spring_plate(0, 0, 3, .01, 0, .3));
    // No lift: weight 0.3 N only (the table's lift is the weight: take it away)
    Model heavy = spring_plate(0, 0, 3, .01, 0, 0);
    heavy.vehicle.net_weight = .3;
    const HeavePitch sinking(heavy);
    TrajectoryOptions options;
    options.duration = 20;
    options.output_step = .02;
    const PitchTrajectory motion = simulate(sinking, {.02, 0, .05, 0}, options);
    EXPECT_EQ(motion.contact.back(), ContactState::flat);
    EXPECT_NEAR(motion.state.back()[0], 0, 1e-6);
    EXPECT_NEAR(motion.state.back()[2], 0, 1e-6);
    bool edge = false;
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
        const auto gaps = sinking.edge_gaps(motion.state[i]);
        EXPECT_GE(std::min(gaps[0], gaps[1]), -1e-6);
        edge = edge || motion.contact[i] == ContactState::tail_edge;
    }
    EXPECT_TRUE(edge);
    // Held flat, the two edges bear the weight.
    const auto normal = sinking.normal_forces({0, 0, 0, 0}, ContactState::flat);
    EXPECT_NEAR(normal[0] + normal[1], .3, 1e-9);
    EXPECT_NEAR(normal[0], normal[1], 1e-9);
    EXPECT_THROW(simulate(plant, {.001, 0, .1, 0}, options), core::InputError);
}

TEST(HeavePitch, ItsRegionAgreesWithCvodeAndIsSymmetric) {
    const Model model = spring_plate(20, .1, 1.5, .003);
    RegionOptions options;
    options.axes = {{"gap", 0, .03}, {"pitch", -.1, .1}};
    options.columns = 30;
    options.rows = 30;
    options.refine = false;
    const StabilityRegion region = stability_region(model, options);
    const HeavePitch plant(model);
    TrajectoryOptions one;
    one.stop_at_contact = true;
    one.output_step = 60;
    std::size_t odd = 0;
    for (std::size_t j = 0; j < 30; ++j) {
        for (std::size_t i = 0; i < 30; ++i) {
            const EndClass& found = region.classes[static_cast<std::size_t>(region.index[j * 30 + i])];
            odd += region.index[j * 30 + i] != region.index[(29 - j) * 30 + i] ? 1 : 0;
            if ((i + 7 * j) % 11 == 0) {
                const PitchState start{.001 * (static_cast<double>(i) + .5), 0,
                                       -.1 + .2 / 30 * (static_cast<double>(j) + .5), 0};
                const auto gaps = plant.edge_gaps(start);
                const std::string expected =
                    std::min(gaps[0], gaps[1]) <= 0 ? "contact" : simulate(plant, start, one).end;
                EXPECT_EQ(found.kind == EndKind::contact ? "contact" : "time", expected);
            }
        }
    }
    EXPECT_LE(odd, 4U);
    EXPECT_GT(region.count(EndKind::attractor), 300U);
    EXPECT_GT(region.count(EndKind::contact), 100U);
    options.through_contact = true;
    const StabilityRegion through = stability_region(model, options);
    EXPECT_GE(through.count(EndKind::attractor), region.count(EndKind::attractor));
    EXPECT_EQ(region_figure(region).classes.size(), 1U);
}

TEST(HeavePitch, SaysWhatItsModelLacks) {
    Model model = spring_plate(20, .1, 1.5, .003);
    model.vehicle.pitch_inertia = std::nan("");
    EXPECT_THROW(HeavePitch{model}, core::InputError);
}

}  // namespace

}  // namespace underbody::dynamics
