// Studies of third-party measurements, held to what is known of each (shared/measured/README.md).
#include <gtest/gtest.h>

#include "cases/measured/studies.h"
#include "tests/support/support.h"

using namespace underbody;

TEST(MeasuredStudies, ABearingDeclaredViscousLacksATorqueThatNoSpeedChanges) {
    UNDERBODY_NEEDS_SHARED("measured/rm2_tow_tank");
    const cases::MeasuredStudy study = cases::bearing_study(cases::measured_folder(test::shared_folder()));
    EXPECT_EQ(study.found.verdict, "effect") << study.found.sentence;
    // one direction of rotation only: Coulomb's torque is a constant there, which an offset of the speed would be as well: a tie
    bool bias = false;
    for (const auto* list : {&study.found.effects, &study.found.alternatives}) {
        for (const discovery::FoundEffect& effect : *list) {
            bias = bias || (effect.name.find("force_bias") != std::string::npos && effect.probability > 0.2);
        }
    }
    EXPECT_TRUE(bias) << study.found.sentence;
    EXPECT_LT(study.found.error.front().after.rmse, study.found.error.front().before.rmse);
}

TEST(MeasuredStudies, HeavyBallsFallByTheirWeightAloneAndBasketballsDoNot) {
    UNDERBODY_NEEDS_SHARED("measured/ball_drops");
    for (const cases::MeasuredStudy& study : cases::ball_drop_studies(cases::measured_folder(test::shared_folder()))) {
        if (study.name.find("Golf") != std::string::npos || study.name.find("Bowling") != std::string::npos) {
            EXPECT_EQ(study.found.verdict, "none") << study.name << ": " << study.found.sentence;
        }
        if (study.name.find("Basketball") != std::string::npos || study.name.find("Tennis") != std::string::npos) {
            EXPECT_NE(study.found.verdict, "none") << study.name;
            EXPECT_LT(study.found.error.front().after.rmse, 0.5 * study.found.error.front().before.rmse) << study.name;
        }
    }
}
