// The forces of a model as points.
#include <gtest/gtest.h>

#include <cmath>

#include "surrogates/dynamics/model/force_points.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

std::string all_remarks(const ForcePoints& found) {
    std::string text;
    for (const auto& remark : found.remarks) {
        text += remark.message + "\n";
    }
    return text;
}

/// REF-A through its points without overshoot, as models take tables by default.
Model monotone_model() {
    Model model = test::ref_a_model();
    model.forces[0].table =
        tables::ForceTable::fit(test::ref_a_table(), "lift_force", {{}, tables::FitOptions::Kind::interpolation});
    return model;
}

TEST(ForcePoints, AreTheTableItselfWhereNothingChangesIt) {
    const ForcePoints found = force_points(monotone_model());
    const core::Table table = test::ref_a_table();
    EXPECT_EQ(found.points.numbers("gap"), table.numbers("gap"));
    for (std::size_t i = 0; i < table.rows(); ++i) {
        EXPECT_NEAR(found.points.numbers("lift_force")[i], table.numbers("lift_force")[i], 1e-15);
    }
    EXPECT_TRUE(found.remarks.empty());
}

TEST(ForcePoints, AreDenseEnoughForATableThatIsNoMonotoneInterpolation) {
    // A spline overshoots between its points; a fit through these alone would not know.
    const Model model = test::ref_a_model();
    ASSERT_FALSE(model.forces[0].table.is_monotone_interpolation());
    tables::FitOptions options;
    options.kind = tables::FitOptions::Kind::interpolation;
    const auto again = tables::ForceTable::fit(force_points(model).points, "lift_force", options);
    const auto through_points = tables::ForceTable::fit(test::ref_a_table(), "lift_force", options);
    double off = 0, off_through_points = 0;
    for (double gap = -0.05; gap < 1.8; gap += 0.00137) {
        Conditions at;
        at[Channel::gap] = gap;
        const double force = static_value(model, "lift_force", at);
        off = std::max(off, std::abs(again.value(&gap) - force));
        off_through_points = std::max(off_through_points, std::abs(through_points.value(&gap) - force));
    }
    EXPECT_LT(off, 0.02 * off_through_points);
    EXPECT_LT(off, 1e-6);
}

TEST(ForcePoints, HaveTheRoughnessOfTheGroundInThemAndPointsBetween) {
    const Model smooth = test::ref_a_model();
    const Model rough =
        smooth.with_effect(make_use("surface_roughness", {{"near", 0.3}, {"far", 0.1}, {"length", 0.05}}));
    const ForcePoints found = force_points(rough);
    const std::vector<double>& gap = found.points.numbers("gap");
    ASSERT_EQ(gap.size(), 4 * (test::ref_a_table().rows() - 1) + 1);
    for (std::size_t i = 0; i < gap.size(); ++i) {
        Conditions at;
        at[Channel::gap] = gap[i];
        EXPECT_NEAR(found.points.numbers("lift_force")[i], static_value(rough, "lift_force", at), 1e-15);
    }
}

TEST(ForcePoints, LeaveOutWhatBelongsToTheRigOrTheMotionAndSaySo) {
    const Model model = monotone_model()
                            .with_effect(make_use("force_bias", {{"bias", 0.01}}))
                            .with_effect(make_use("coulomb_friction", {{"force", 0.01}}));
    const ForcePoints found = force_points(model);
    EXPECT_NEAR(found.points.numbers("lift_force")[5], 0, 1e-15);
    EXPECT_NE(all_remarks(found).find("force_bias, coulomb_friction"), std::string::npos) << all_remarks(found);
}

TEST(ForcePoints, HoldWhatOnlyScalesWhereTheyAreTold) {
    Model model = test::ref_a_model();
    model.forces[0].scales.push_back({Channel::speed, 0.5, 2, 0});
    const ForcePoints usual = force_points(model);
    EXPECT_NE(all_remarks(usual).find("speed is held at 0.5 m/s"), std::string::npos) << all_remarks(usual);
    Conditions fast;
    fast[Channel::speed] = 1;
    const ForcePoints faster = force_points(model, fast);
    EXPECT_TRUE(faster.remarks.empty());
    for (std::size_t i = 0; i < usual.points.rows(); ++i) {
        EXPECT_NEAR(faster.points.numbers("lift_force")[i], 4 * usual.points.numbers("lift_force")[i], 1e-15);
    }
}

TEST(ForcePoints, SayWhatTheyBelongTo) {
    Model model = test::ref_a_model();
    model.forces[0].scales.push_back({Channel::speed, 0.5, 2, 0});
    model.vehicle.length = 0.2;
    model.vehicle.width = std::nan("");
    const core::Table points = force_points(model).points;
    EXPECT_EQ(points.numbers("speed").back(), 0.5);
    EXPECT_EQ(points.numbers("mass").front(), model.vehicle.mass);
    EXPECT_EQ(points.numbers("length").front(), 0.2);
    EXPECT_EQ(points.find("width"), nullptr) << "what the model does not state is not stated here";
    EXPECT_EQ(points.numbers("net_weight").front(), model.vehicle.net_weight);
}

TEST(ForcePoints, AreRefusedForAModelWithoutForces) {
    EXPECT_THROW((void)force_points(test::free_model(1, 0, 0, 1)), core::InputError);
}

}  // namespace

}  // namespace underbody::dynamics
