// Studies of third-party measurements, held to what is known of each (shared/measured/README.md).
#include <gtest/gtest.h>

#include <algorithm>

#include "cases/measured/studies.h"
#include "tests/support/support.h"

using namespace underbody;

namespace {

/// Probability that the verdict gives a name (or a part of one), alone or together with others.
double probability_of(const discovery::Discovery& found, const std::string& name) {
    double sum = 0;
    bool own = false;
    for (const discovery::FoundEffect& effect : found.effects) {
        own = own || effect.name.find(name) != std::string::npos;
    }
    sum += own ? found.effects.front().probability : 0;
    for (const discovery::FoundEffect& rival : found.alternatives) {
        sum += rival.name.find(name) != std::string::npos ? rival.probability : 0;
    }
    return sum;
}

std::filesystem::path folder() { return test::shared_folder() / "measured"; }

}  // namespace

TEST(MeasuredStudies, ABearingDeclaredViscousLacksATorqueThatHardlyGrowsWithTheSpeed) {
    UNDERBODY_NEEDS_SHARED("measured/rm2_tow_tank");
    const cases::MeasuredStudy study = cases::bearing_study(folder());
    EXPECT_NE(study.found.verdict, "none") << study.found.sentence;
    // in one direction of rotation Coulomb's torque is a constant; with the slope that falls it is a power of the speed
    // near zero
    EXPECT_LT(study.found.error.front().after.rmse, 0.1 * study.found.error.front().before.rmse)
        << study.found.sentence;
    EXPECT_LT(study.found.error.front().after.rmse, 0.035) << study.found.sentence;
    ASSERT_EQ(study.found.effects.size(), 2U) << study.found.sentence;
    EXPECT_EQ(study.found.effects[0].name, "force_bias");
    EXPECT_EQ(study.found.effects[0].parameters.at(0).unit, "N m");
    EXPECT_EQ(study.found.effects[1].name, "sensor_gain");
    EXPECT_EQ(study.found.effects[1].depends_on, std::vector<std::string>{"yaw_moment"});
}

TEST(MeasuredStudies, StrutsDeclaredQuadraticTakeATorqueOfALowerPower) {
    UNDERBODY_NEEDS_SHARED("measured/rm2_tow_tank");
    const cases::MeasuredStudy study = cases::strut_study(folder());
    ASSERT_NE(study.found.verdict, "none") << study.found.sentence;
    EXPECT_LT(study.found.error.front().after.rmse, 0.4 * study.found.error.front().before.rmse)
        << study.found.sentence;
    EXPECT_EQ(study.found.depends_on, std::vector<std::string>{"speed"}) << study.found.sentence;
}

TEST(MeasuredStudies, AShipAlongABankSinksByMoreThanTheSquareOfItsSpeedAndMoreNearTheBank) {
    UNDERBODY_NEEDS_SHARED("measured/mashcon2009_bank");
    for (const cases::MeasuredStudy& study : cases::bank_studies(folder())) {
        EXPECT_NE(study.found.verdict, "none") << study.name << ": " << study.found.sentence;
        const std::vector<std::string>& on = study.found.depends_on;
        EXPECT_TRUE(std::find(on.begin(), on.end(), "speed") != on.end()) << study.name << ": " << study.found.sentence;
        if (study.name.find("sinkage") != std::string::npos) {
            EXPECT_TRUE(std::find(on.begin(), on.end(), "gap") != on.end()) << study.found.sentence;
            EXPECT_LT(study.found.error.front().after.rmse, 0.6 * study.found.error.front().before.rmse)
                << study.found.sentence;
        }
    }
}

TEST(MeasuredStudies, TheThrustOfADroneFollowsItsBattery) {
    UNDERBODY_NEEDS_SHARED("measured/cf21_thrust_stand");
    const cases::MeasuredStudy study = cases::thrust_stand_study(folder());
    EXPECT_NE(study.found.verdict, "none") << study.found.sentence;
    const bool over_voltage = std::find(study.found.depends_on.begin(), study.found.depends_on.end(), "jet_voltage") !=
                              study.found.depends_on.end();
    EXPECT_TRUE(over_voltage || probability_of(study.found, "declared_parameter") > 0.2) << study.found.sentence;
    EXPECT_LT(study.found.error.front().after.rmse, study.found.error.front().before.rmse) << study.found.sentence;
}

TEST(MeasuredStudies, UnderAPlateSuctionAndABiasOfTheOpticsAreATie) {
    UNDERBODY_NEEDS_SHARED("measured/air_garage_ceiling");
    const cases::MeasuredStudy study = cases::ceiling_study(folder());
    EXPECT_EQ(study.found.verdict, "effect") << study.found.sentence;
    EXPECT_GT(probability_of(study.found, "force_bias"), 0.15) << study.found.sentence;
    EXPECT_GT(probability_of(study.found, "gap_offset"), 0.15) << study.found.sentence;
    EXPECT_LT(study.found.effects.front().probability, 0.6) << study.found.sentence;
    EXPECT_NE(discovery::report_html(study.found, study.model, study.measured, {})
                  .find("The model lacks: gap offset, or force bias"),
              std::string::npos);
}

TEST(MeasuredStudies, HeavyBallsFallByTheirWeightAloneAndLightOnesDoNot) {
    UNDERBODY_NEEDS_SHARED("measured/ball_drops");
    const std::vector<cases::MeasuredStudy> studies = cases::ball_drop_studies(folder());
    EXPECT_EQ(studies.size(), 11U);
    for (const cases::MeasuredStudy& study : studies) {
        const auto is = [&](const char* ball) { return study.name.find(ball) != std::string::npos; };
        if (is("Bowling")) {
            EXPECT_EQ(study.found.verdict, "none") << study.name << ": " << study.found.sentence;
        } else if (is("Golf")) {
            // no effect of the ball: fitted alone, its drops fall at 9.72 and 9.05 m/s^2. What the second leaves is no
            // noise: that forbids "none", and is said
            EXPECT_EQ(study.found.verdict, "unknown") << study.found.sentence;
            EXPECT_TRUE(study.found.model.effects.empty()) << study.found.sentence;
            EXPECT_FALSE(study.found.rest.is_noise);
            EXPECT_EQ(study.found.depends_on, std::vector<std::string>{"time"});
            EXPECT_NE(study.found.sentence.find("is unexplained and follows no variable that was measured"),
                      std::string::npos)
                << study.found.sentence;
        } else if (!is("Baseball")) {
            EXPECT_NE(study.found.verdict, "none") << study.name;
            EXPECT_LT(study.found.error.front().after.rmse, 0.5 * study.found.error.front().before.rmse)
                << study.name << ": " << study.found.sentence;
        }
        // a fall of three seconds shows no wave, and a later look at a fall is a fall
        EXPECT_DOUBLE_EQ(probability_of(study.found, "gap_sensor_delay"), 0) << study.name;
        EXPECT_LT(probability_of(study.found, "periodic_disturbance"), 1e-12) << study.name;
    }
}

TEST(MeasuredStudies, PerforatedBallsSlowDownByDrag) {
    UNDERBODY_NEEDS_SHARED("measured/ball_drops");
    for (const cases::MeasuredStudy& study : cases::ball_drop_studies(folder())) {
        if (study.name.find("Whiffle") != std::string::npos) {
            // steady or unsteady (the owner of the data: linear drag fits better than the quadratic one that physics
            // expects)
            EXPECT_GT(probability_of(study.found, "damping") + probability_of(study.found, "history_force"), 0.5)
                << study.name << ": " << study.found.sentence;
        }
    }
}
