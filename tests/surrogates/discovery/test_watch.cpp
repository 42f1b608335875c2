// The watch: its rate of false alarms is what theory says, changes are seen and named by their direction.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/error.h"
#include "core/file.h"
#include "surrogates/discovery/watch/sequential_test.h"
#include "surrogates/discovery/watch/still_reading.h"
#include "surrogates/discovery/watch/watch.h"
#include "surrogates/discovery/watch/watch_residuals.h"
#include "tests/support/support.h"
#include "tests/support/watched_rig.h"

namespace underbody::discovery {
namespace {

using test::false_alarms;
using test::WatchedRig;
using ::testing::HasSubstr;

TEST(SequentialTest, TheThresholdGivesTheStatedMeanTime) {
    core::Random random(1);
    for (const auto& [reference, mean] : {std::pair(0.5, 300.0), std::pair(0.15, 1000.0)}) {
        const double threshold = cusum_threshold(reference, mean);
        double sum = 0, steps = 0;
        int alarms = 0;
        for (; alarms < 600; ++steps) {
            sum = std::max(0.0, sum + random.normal() - reference);
            if (sum > threshold) {
                ++alarms;
                sum = 0;
            }
        }
        EXPECT_NEAR(steps / alarms, mean, 0.15 * mean) << reference;  // 4 % of counting, the rest Siegmund's own
    }
}

TEST(SequentialTest, AMeanWithinTheAllowanceIsNoChangeAndALargerOneIs) {
    constexpr double allowance = 0.4;
    const auto steps_to_alarm = [](double mean, double allowed) {
        core::Random random(3);
        TwoSidedCusum test(1e8, false, allowed);
        int steps = 0;
        while (steps < 200000 && !test.take(random.normal(mean, 1))) {
            ++steps;
        }
        return steps;
    };
    EXPECT_EQ(steps_to_alarm(allowance, allowance), 200000);
    EXPECT_EQ(steps_to_alarm(-allowance, allowance), 200000);
    EXPECT_LT(steps_to_alarm(allowance, 0), 500);
    EXPECT_LT(steps_to_alarm(1.2, allowance), 100);
}

TEST(SequentialTest, SelfStartingNumbersAreStandardNormalWhateverTheScale) {
    core::Random random(2);
    double sum = 0, squares = 0, tails = 0, neighbours = 0, count = 0;
    for (int series = 0; series < 3000; ++series) {
        SelfStartingScore score;
        SelfStartingLevel level;
        const double scale = std::pow(10, random.uniform(-5, 5)), mean = random.uniform(-10, 10) * scale;
        double before = 0;
        for (int i = 0; i < 40; ++i) {
            const double own = score.normal(random.normal(0, scale)), other = level.normal(random.normal(mean, scale));
            if (i >= 8) {
                neighbours += own * before;
                for (const double u : {own, other}) {
                    sum += u;
                    squares += u * u;
                    tails += std::abs(u) > 2.5758 ? 1 : 0;
                    count += 1;
                }
            }
            before = own;
        }
    }
    EXPECT_NEAR(sum / count, 0, 0.01);
    EXPECT_NEAR(squares / count, 1, 0.015);
    EXPECT_NEAR(tails / count, 0.01, 0.0012);
    EXPECT_NEAR(2 * neighbours / count, 0, 0.015) << "they are independent of each other";
}

TEST(WatchNoise, IsFoundWithItsColour) {
    const auto plant = std::make_shared<const dynamics::HeavePlant>(WatchedRig::model());
    for (const double colour : {0.0, 0.9}) {
        WatchedRig rig(31);
        rig.colour = colour;
        rig.wild = 0.01;
        std::deque<WatchStep> steps;
        while (rig.time < 200) {
            WatchStep step;
            step.input = rig.input;
            rig.advance();
            step.time = rig.time;
            step.gap = rig.reading;
            step.velocity = std::nan("");
            steps.push_back(step);
        }
        HeaveNoise begin;
        begin.gap = 5e-5;
        const WatchNoise found = learn_noise(plant, steps, begin);
        EXPECT_NEAR(std::hypot(found.noise.gap, found.noise.slow), 2e-4, colour > 0 ? 6e-5 : 1e-5);
        EXPECT_NEAR(found.correlation_time, colour > 0 ? -0.05 / std::log(colour) : 0, 0.25);
        EXPECT_EQ(found.correlation_time > 0, colour > 0);
        EXPECT_TRUE(found.colours[0].white());
        EXPECT_NEAR(found.colours[0].scale, 1, 0.05);
    }
}

/// Alarms over ten hours at 240 a day: 100 at most are meant. A rate twice as high would pass 130 nearly always.
TEST(Watch, FalseAlarmsComeAtMostAsOftenAsStated) {
    WatchedRig plain(3), coloured(4), disturbed(5), wild(6);
    coloured.colour = 0.9;
    disturbed.colour = 0.7;
    disturbed.disturbance = 0.002;
    wild.wild = 0.01;
    wild.lost = 0.05;
    const int alarms = false_alarms(plain, 10, 240);
    EXPECT_LE(alarms, 130);
    EXPECT_GE(alarms, 20) << "a test that never speaks would not be one";
    EXPECT_LE(false_alarms(coloured, 10, 240), 130);
    EXPECT_LE(false_alarms(disturbed, 10, 240), 130);
    EXPECT_LE(false_alarms(wild, 10, 240), 130);
}

TEST(Watch, RowsLostWithTheirInputAreNoChangeAndHideNone) {
    WatchedRig losing(7);
    losing.colour = 0.9;
    losing.lost_rows = 0.02;
    EXPECT_LE(false_alarms(losing, 10, 240), 130);
    for (const double share : {0.02, 0.05}) {
        WatchedRig rig(8);
        rig.lost_rows = share;
        Watch watch(WatchedRig::model(), {});
        bool early = false, seen = false;
        while (!seen && rig.time < 1800) {
            rig.force = rig.time > 900 ? 0.02 : 0;
            seen = rig.show(watch).has_value();
            early = early || (seen && rig.time < 900);
        }
        EXPECT_TRUE(seen) << share;
        EXPECT_FALSE(early) << share;
    }
}

struct Seen {
    std::optional<WatchAlarm> alarm;
    double changed = 600;
};

template <typename Change>
Seen watch_change(Change&& change, double colour = 0) {
    WatchedRig rig(6);
    rig.colour = colour;
    Watch watch(WatchedRig::model(), {});
    Seen seen;
    while (rig.time < seen.changed + 900 && !seen.alarm) {
        if (rig.time >= seen.changed) {
            change(rig);
        }
        seen.alarm = rig.show(watch);
    }
    return seen;
}

TEST(Watch, AConstantForceIsSeenWithItsSideAndTime) {
    const Seen seen = watch_change([](WatchedRig& rig) { rig.force = -0.004; });
    ASSERT_TRUE(seen.alarm);
    EXPECT_THAT(seen.alarm->shows, ::testing::StartsWith("a constant force, down"));
    EXPECT_NEAR(seen.alarm->force, -0.004, 0.002);
    EXPECT_GT(seen.alarm->time, seen.changed);
    EXPECT_LT(seen.alarm->time, seen.changed + 120);
    EXPECT_NEAR(seen.alarm->since, seen.changed, 60);
}

TEST(Watch, OtherChangesAreSeen) {
    EXPECT_TRUE(watch_change([](WatchedRig& rig) { rig.friction = 0.004; }).alarm);
    EXPECT_TRUE(watch_change([](WatchedRig& rig) { rig.more_damping = 0.4; }).alarm);
    const Seen scatter = watch_change([](WatchedRig& rig) { rig.noise = 3e-4; });
    ASSERT_TRUE(scatter.alarm);
    EXPECT_EQ(scatter.alarm->shows, "more scatter than before");
    const Seen gain = watch_change([](WatchedRig& rig) { rig.gain = 0.8; });
    ASSERT_TRUE(gain.alarm);
    EXPECT_GT(gain.alarm->time, gain.changed);
    EXPECT_FALSE(watch_change([](WatchedRig&) {}).alarm);
}

// Blocks are long where the noise is correlated, and a jump of 250 noises passed unseen within one.
TEST(Watch, AJumpNeedsNoBlock) {
    for (const double colour : {0.0, 0.9}) {
        const Seen seen = watch_change([](WatchedRig& rig) { rig.bias = 0.05; }, colour);
        ASSERT_TRUE(seen.alarm) << colour;
        EXPECT_EQ(seen.alarm->shows.find("a jump of the gap") == 0, colour > 0) << "blocks of a second tell it too";
        EXPECT_NEAR(seen.alarm->time, seen.changed, 3) << colour;
        EXPECT_NEAR(seen.alarm->since, seen.changed, colour > 0 ? 2 : 12) << colour;
    }
}

// Where one row in twenty is lost the state is never quite known: a doubled reading was told after 38 s.
TEST(Watch, AJumpIsToldAmongLostRows) {
    for (const double colour : {0.0, 0.9}) {
        for (int seed = 100; seed < 106; ++seed) {
            WatchedRig rig(static_cast<std::uint64_t>(seed));
            rig.colour = colour;
            rig.lost_rows = 0.05;
            const double change = 180 + 0.37 * (seed - 100);
            Watch watch(WatchedRig::model(), {});
            std::optional<WatchAlarm> alarm;
            while (!alarm && rig.time < change + 60) {
                rig.advance();
                if (!rig.silent) {
                    alarm = watch.gap(rig.time, (rig.time < change ? 1 : 2) * rig.reading);
                    watch.input(rig.time, rig.input);
                }
            }
            EXPECT_GT(rig.time, change) << colour << " " << seed;
            EXPECT_LT(rig.time, change + 8) << colour << " " << seed;
        }
    }
}

/// A rig whose readings are rounded, and stand still after 300 s.
std::optional<WatchAlarm> watch_stuck(double colour, double rounded, std::uint64_t seed, double& stood_still) {
    WatchedRig rig(seed);
    rig.colour = colour;
    Watch watch(WatchedRig::model(), {});
    double stuck = std::nan("");
    while (rig.time < 330) {
        rig.advance();
        double reading = rounded > 0 ? rounded * std::round(rig.reading / rounded) : rig.reading;
        if (rig.time >= 300) {
            stuck = std::isnan(stuck) ? reading : stuck;
            stood_still = std::isnan(stood_still) ? rig.time : stood_still;
            reading = stuck;
        }
        const auto alarm = watch.gap(rig.time, reading);
        watch.input(rig.time, rig.input);
        if (alarm && (alarm->sensor || rig.time < 300)) {
            return alarm;
        }
    }
    return {};
}

// It was seen by the forces that it seems to show: within a minute, as one of them.
TEST(Watch, ASensorThatStandsStillIsToldSoonAsOne) {
    for (const double colour : {0.0, 0.9}) {
        for (const double rounded : {0.0, 1e-6, 1e-4}) {
            for (std::uint64_t seed = 51; seed < 54; ++seed) {
                double begun = std::nan("");
                const auto alarm = watch_stuck(colour, rounded, seed, begun);
                ASSERT_TRUE(alarm) << colour << " " << rounded;
                EXPECT_TRUE(alarm->sensor) << colour << " " << rounded << ": " << alarm->shows;
                EXPECT_THAT(alarm->shows, ::testing::StartsWith("the gap stands still at "));
                EXPECT_LT(alarm->time, begun + (rounded < 1e-5 ? 0.7 : 3.5)) << colour << " " << rounded;
                EXPECT_NEAR(alarm->since, begun, 0.5);
            }
        }
    }
}

TEST(StillReading, ReadingsThatAreRoundedCoarselyOrLoggedSeveralTimesAreNone) {
    core::Random random(5);
    for (const double rounded : {2e-5, 1e-4, 3e-4, 1e-3, 2e-3}) {
        for (const int times : {1, 5}) {
            StillReading still;
            double noise = 0, value = 0;
            for (int i = 0; i < 200000; ++i) {
                if (i % times == 0) {
                    noise = 0.9 * noise + std::sqrt(1 - 0.81) * random.normal(0, 2e-4);
                    const double motion = i % 60000 < 30000 ? 0.01 * std::sin(1e-3 * i) : 0;  // it rests for long
                    value = rounded * std::round((0.1 + motion + noise) / rounded);
                }
                ASSERT_FALSE(still.take(0.05 * i, value)) << rounded << " " << times << " at " << i;
            }
        }
    }
}

TEST(StillReading, OneThatIsLoggedSeveralTimesIsToldAndToldAgain) {
    core::Random random(6);
    StillReading still;
    double value = 0;
    int told = 0;
    for (int i = 0; i < 20000; ++i) {
        const bool stuck = i % 5000 > 4000;
        value = stuck || i % 5 != 0 ? value : random.normal(0.1, 1e-4);
        told += still.take(0.01 * i, value) ? 1 : 0;
        EXPECT_TRUE(!still.still() || stuck);
    }
    EXPECT_EQ(told, 4);
}

TEST(StillReading, NothingThatEverChangesIsTold) {
    StillReading still;
    double told = 0;
    for (double time = 0; time < 60 && told == 0; time += 0.05) {
        told = still.take(time, 0.1) ? time : 0;
    }
    EXPECT_NEAR(told, 30, 0.1);
}

/// What a watch says of a log: `as_logged` changes the reading and the input as they are written.
template <typename Change>
std::string doubted(const dynamics::Model& model, Change&& as_logged, double seconds = 70) {
    WatchedRig rig(31);
    Watch watch(model, {});
    while (rig.time < seconds && !watch.doubt()) {
        rig.advance();
        double reading = rig.reading, input = rig.input;
        as_logged(reading, input);
        (void)watch.gap(rig.time, reading);
        watch.input(rig.time, input);
    }
    return watch.doubt() ? watch.doubt()->text + " | " + watch.doubt()->hint : "";
}

// Each was watched: alarms about forces of 200 N, or nothing judged at all.
TEST(Watch, ALogOfOtherUnitsOrColumnsIsToldInWordsAboutTheLog) {
    const dynamics::Model model = WatchedRig::model();
    EXPECT_EQ(doubted(model, [](double&, double&) {}), "");
    EXPECT_THAT(doubted(model, [](double& gap, double&) { gap *= 1000; }),
                HasSubstr("gap of 0.001 times the recorded one | is the column's unit mm, and was it read in m?"));
    EXPECT_THAT(doubted(model, [](double& gap, double&) { gap *= -1; }), HasSubstr("turn its sign"));
    EXPECT_THAT(doubted(model, [](double&, double& input) { input *= -1; }),
                HasSubstr("the motion fits an input_force -1 times the recorded one: its sign is turned round"));
    EXPECT_THAT(doubted(model, [](double&, double& input) { input *= 1000; }),
                HasSubstr("its unit is wrong by a thousand"));
    EXPECT_THAT(doubted(model, [](double& gap, double& input) { std::swap(gap, input); }),
                HasSubstr("gap and input_force look exchanged"));
}

TEST(Watch, GapsBesideTheTablesAreToldAfterASecondOrLeftOut) {
    const core::TemporaryFolder folder("watch-tables");
    core::write_file(folder.path() / "lift.csv", "gap [m], lift_force [N]\n0.02, 0\n0.1, 0\n0.2, 0\n");
    const dynamics::Model model = dynamics::read_model_text(
        "[vehicle]\nmass = 4\nnet_weight = 0\n[drag.heave]\nlinear = 0.5\nquadratic = 0\n[[effect]]\nname = "
        "\"tether_stiffness\"\nstiffness = 8\ngap = 0.1\n[[force]]\nquantity = \"lift_force\"\ntable = "
        "\"lift.csv\"\n",
        "rig.toml", folder.path());
    EXPECT_EQ(doubted(model, [](double&, double&) {}), "");
    EXPECT_THAT(doubted(
                    model, [](double& gap, double&) { gap *= 1000; }, 1.5),
                HasSubstr("outside the tables of the declared model (0.02 to 0.2 m): a thousandth would fit"));
    WatchedRig rig(32);
    Watch watch(model, {});
    while (rig.time < 400) {
        rig.advance();
        const bool beyond = rig.time > 200 && rig.time < 230;
        EXPECT_FALSE(watch.gap(rig.time, rig.reading + (beyond ? 1 : 0))) << rig.time;
        watch.input(rig.time, rig.input);
    }
    EXPECT_NEAR(static_cast<double>(watch.outside()), 600, 2);
    EXPECT_FALSE(watch.doubt());
}

TEST(Watch, WhatWasJudgedIsCountedOverAll) {
    WatchedRig rig(12);
    Watch watch(WatchedRig::model(), {});
    while (rig.time < 1000) {
        rig.show(watch);
    }
    EXPECT_GT(watch.judged(), 880) << "of 1,000 s, 60 of them learned from";
    EXPECT_LT(watch.judged() + watch.not_judged(), 945);
    EXPECT_LE(watch.not_judged(), watch.block() + 0.1);
}

TEST(Watch, AColouredNoiseHidesLittle) {
    const Seen seen = watch_change([](WatchedRig& rig) { rig.force = 0.004; }, 0.9);
    ASSERT_TRUE(seen.alarm);
    EXPECT_THAT(seen.alarm->shows, HasSubstr("a constant force, up"));
    EXPECT_GT(seen.alarm->time, seen.changed);
    EXPECT_LT(seen.alarm->time, seen.changed + 300);
}

TEST(Watch, SilencesAndWildReadingsAreNoChange) {
    WatchedRig rig(8);
    Watch watch(WatchedRig::model(), {});
    core::Random random(9);
    for (int i = 0; rig.time < 3000; ++i) {
        rig.advance();
        const bool silent = std::fmod(rig.time, 300) > 280;
        if (!silent) {
            const double wild = random.uniform() < 0.002 ? 0.5 : 0;
            EXPECT_FALSE(watch.gap(rig.time, rig.reading + wild)) << rig.time;
        }
        watch.input(rig.time, rig.input);
    }
    EXPECT_GT(watch.judged(), 2500);
}

TEST(Watch, AClockThatBeginsAnewIsNoChange) {
    WatchedRig rig(12);
    Watch watch(WatchedRig::model(), {});
    double passed_by = 0;
    while (rig.time < 1200) {
        rig.advance();
        const double time = rig.time < 600 ? rig.time : rig.time - 600 + 0.01;
        EXPECT_FALSE(watch.gap(time, rig.reading)) << rig.time;
        watch.input(time, rig.input);
        passed_by = watch.judged();
    }
    EXPECT_GT(passed_by, 1050);
    EXPECT_EQ(watch.passed_over(), 20u);
}

/// How long the rows took that are passed over nobody knows: the body went on meanwhile.
TEST(Watch, AClockThatIsSetOnAndBackALittleIsNoChange) {
    for (const double jump : {0.3, 0.9, 5.0}) {
        WatchedRig rig(12);
        Watch watch(WatchedRig::model(), {});
        while (rig.time < 2400) {
            rig.advance();
            const double time = rig.time + (std::fmod(rig.time, 400) > 200 ? jump : 0);
            EXPECT_FALSE(watch.gap(time, rig.reading)) << rig.time << " " << jump;
            watch.input(time, rig.input);
        }
        EXPECT_GT(watch.judged(), 2200);
    }
}

TEST(Watch, ReadingsSinceTheChangeAreRuns) {
    WatchedRig rig(10);
    Watch watch(WatchedRig::model(), {});
    while (rig.time < 200) {
        rig.show(watch);
    }
    const dynamics::Measurements data = watch.since(100);
    ASSERT_EQ(data.runs.size(), 8u);
    EXPECT_GE(data.runs[0].table.numbers("time").front(), 100);
    EXPECT_TRUE(data.all_have("input_force"));
    WatchOptions forgetful;
    forgetful.remember = 50;
    Watch short_of(WatchedRig::model(), forgetful);
    WatchedRig again(10);
    while (again.time < 200) {
        again.show(short_of);
    }
    EXPECT_GE(short_of.since(0).runs[0].table.numbers("time").front(), 149);
}

/// Fields that hold no number take the reading or the input with them, and nothing else: what an input that was not
/// read did is told from what is missing (11 a day in white noise before). UNDERBODY_WATCH_HOURS=N counts over so many
/// hours.
TEST(Watch, TextBetweenWildReadingsIsNoChange) {
    const char* asked = std::getenv("UNDERBODY_WATCH_HOURS");
    const double hours = asked != nullptr ? std::atof(asked) : 24;
    for (const double colour : {0.0, 0.9}) {
        WatchedRig rig(colour > 0 ? 8000 : 7000);
        rig.colour = colour;
        rig.wild = 0.01;
        rig.text = 0.005;
        const int alarms = false_alarms(rig, hours, 1);
        std::printf("%d false alarms in %g hours, correlation %g\n", alarms, hours, colour);
        EXPECT_LE(alarms, 3 + hours / 12) << "one a day is stated; more than this comes less than once in a thousand";
    }
}

/// A model whose sensor drifts was followed with the bias alone: the drift became noise, of 0.47 mm for 0.19.
TEST(Watch, ADriftThatTheModelHasIsNoChange) {
    constexpr double rate = 5e-6;
    const dynamics::Model model =
        WatchedRig::model().with_effect(dynamics::make_use("gap_sensor_drift", {{"rate", rate}, {"bias", 0}}));
    WatchedRig rig(14);
    Watch watch(model, {});
    while (rig.time < 1500) {
        rig.bias = rate * rig.time;
        EXPECT_FALSE(rig.show(watch)) << rig.time;
    }
    EXPECT_NEAR(watch.noise(), 2e-4, 1e-5);
    EXPECT_EQ(watch.correlation_time(), 0);
}

/// What was found is not quite what happens: the rest is a change again, not noise.
TEST(Watch, GoesOnWithAFoundModelAndTheNoiseFromBefore) {
    WatchedRig rig(15);
    Watch watch(WatchedRig::model(), {});
    constexpr double change = 400, rate = 2e-5;
    const auto alarm_until = [&](double end, double scale) {
        std::optional<WatchAlarm> alarm;
        while (!alarm && rig.time < end) {
            rig.force = rig.time > change ? scale * rate * (rig.time - change) : 0;
            alarm = rig.show(watch);
        }
        return alarm;
    };
    const auto alarm = alarm_until(700, 1);
    ASSERT_TRUE(alarm);
    const double noise = watch.noise();
    watch.go_on_with(WatchedRig::model().with_effect(
                         dynamics::make_use("growing_force", {{"rate", 1.2 * rate}, {"force", -1.2 * rate * change}})),
                     rig.time - alarm->since);
    EXPECT_EQ(watch.noise(), noise);
    EXPECT_EQ(watch.correlation_time(), 0);
    const double begun = rig.time;
    EXPECT_TRUE(alarm_until(2400, 1)) << "a fifth less growth than the model says";
    EXPECT_LT(rig.time, begun + 600);
    // an alarm that goes on does not widen the scale of the scores
    for (int again = 0; again < 4; ++again) {
        watch.reset();
        const double reset = rig.time;
        EXPECT_TRUE(alarm_until(2400, 1));
        EXPECT_LT(rig.time, reset + 120) << again;
    }
    watch.go_on_with(WatchedRig::model().with_effect(
                         dynamics::make_use("growing_force", {{"rate", rate}, {"force", -rate * change}})),
                     1000);
    EXPECT_FALSE(alarm_until(rig.time + 900, 1));
}

/// A body without a spring whose sensor drifts by v moves as under a force of v times its drag: found from the minute
/// after an alarm to 0.57 +- 0.06 mN for 0.5. It shows in the readings of a free body long before such an error is
/// small: an alarm 15 s later, and another one after each number that was found anew.
TEST(Watch, ANumberThatWasFoundIsAsSureAsItSaysAndNoFurtherChangeWithin) {
    constexpr double change = 300, rate = 1e-3;  // s, m/s
    const dynamics::Model free = dynamics::read_model_text(
        "[vehicle]\nmass = 4\nnet_weight = 0\n[drag.heave]\nlinear = 0.5\nquadratic = 0\n", "free.toml", ".");
    for (const double colour : {0.0, 0.9}) {
        WatchedRig rig(11);
        rig.spring = 0;
        rig.colour = colour;
        Watch watch(free, {});
        const auto alarm_until = [&](double end) {
            std::optional<WatchAlarm> alarm;
            while (!alarm && rig.time < end) {
                rig.bias = rig.time > change ? rate * (rig.time - change) : 0;
                alarm = rig.show(watch);
            }
            return alarm;
        };
        ASSERT_TRUE(alarm_until(400)) << colour;
        ASSERT_GT(rig.time, change) << colour;
        dynamics::EffectUse found = dynamics::make_use("constant_force", {{"force", 0.568e-3}});
        found.sigmas = {0.059e-3};
        watch.go_on_with(free.with_effect(found), 60);
        EXPECT_FALSE(alarm_until(3000)) << colour << ": alarm at " << rig.time;
        // what comes then is seen
        rig.force = 2e-3;
        const double begun = rig.time;
        EXPECT_TRUE(alarm_until(begun + 120)) << colour;
    }
}

/// A loss of more than all of a thrust would turn it round.
TEST(Watch, ADoubtedNumberStaysInItsRange) {
    dynamics::EffectUse use = dynamics::make_use("thrust_by_gap", {{"loss", 0.9}, {"length", 0.1}});
    use.sigmas = {0.05, 0};
    EXPECT_DOUBLE_EQ(moved_by_its_error(use, 0), 0.95);
    use.sigmas = {0.3, 0};
    EXPECT_DOUBLE_EQ(moved_by_its_error(use, 0), 0.6) << "1.2 is more than all of it";
    use.sigmas = {10, 0};
    EXPECT_DOUBLE_EQ(moved_by_its_error(use, 0), -2) << "neither is in its range";
}

/// What was said when noise had been learned for the first time, and what of it.
std::optional<WatchFault> fault_of(WatchedRig rig, std::optional<double> declared, double until) {
    WatchOptions options;
    if (declared) {
        options.noise["gap"] = *declared;
    }
    Watch watch(WatchedRig::model(), options);
    while (rig.time < until && !watch.fault()) {
        rig.show(watch);
    }
    return watch.fault();
}

TEST(Watch, AForceThatIsMissingFromTheFirstReadingIsNoNoise) {
    for (const double colour : {0.0, 0.9}) {
        for (const double force : {0.02, -0.05}) {
            WatchedRig rig(21);
            rig.colour = colour;
            rig.force = force;
            const auto fault = fault_of(rig, {}, 90);
            ASSERT_TRUE(fault) << colour << " " << force;
            EXPECT_EQ(fault->shows, force > 0 ? "a constant force, up" : "a constant force, down") << colour;
            EXPECT_NEAR(fault->force, force, 0.1 * std::abs(force)) << colour;
            EXPECT_FALSE(fault->noisier) << "nothing was declared";
        }
    }
}

TEST(Watch, ASensorThatIsNoisierThanDeclaredIsTold) {
    WatchedRig rig(22);
    const auto fault = fault_of(rig, rig.noise / 4, 90);
    ASSERT_TRUE(fault);
    EXPECT_TRUE(fault->noisier);
    EXPECT_NEAR(fault->noise, rig.noise, 0.1 * rig.noise);
    EXPECT_EQ(fault->shows, "");
    EXPECT_FALSE(fault_of(rig, rig.noise / 2, 300)) << "sensors are worse than their sheets";
}

TEST(Watch, NothingIsToldOfARigThatIsItsModelFromTheBeginning) {
    for (const double colour : {0.0, 0.9}) {
        for (std::uint64_t seed = 31; seed < 34; ++seed) {
            WatchedRig rig(seed);
            rig.colour = colour;
            EXPECT_FALSE(fault_of(rig, rig.noise, 700)) << colour << " " << seed;
        }
    }
}

TEST(Watch, RatesThatAreNoneAreRefused) {
    WatchOptions options;
    options.false_alarms_per_day = 0;
    EXPECT_THROW(Watch(WatchedRig::model(), options), core::UsageError);
}

}  // namespace
}  // namespace underbody::discovery
