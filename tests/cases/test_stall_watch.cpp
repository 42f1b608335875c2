// A solver that hangs, told from one that is slow, starved or stopped.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases/stall_watch.h"

namespace {

using underbody::cases::StallWatch;

TEST(StallWatch, ProcessorTimeWithoutAWordIsALoopWithoutEnd) {
    StallWatch watch(100);
    EXPECT_EQ(watch.look(10, 0, 0, false), "");
    EXPECT_EQ(watch.look(10, 99, 100, false), "");
    EXPECT_EQ(watch.look(11, 150, 150, false), "") << "a word: it lives";
    EXPECT_EQ(watch.look(11, 249, 250, false), "");
    EXPECT_THAT(watch.look(11, 250, 251, false), testing::HasSubstr("100 s of processor time"));
}

TEST(StallWatch, ASlowMachineIsNoReason) {
    StallWatch watch(100);
    for (int hour = 0; hour < 100; ++hour) {
        EXPECT_EQ(watch.look(10, 0.99 * hour + (hour > 0 ? 1 : 0), 3600.0 * hour, false), "") << hour;
    }
}

TEST(StallWatch, WhatWaitsForEverHangs) {
    StallWatch watch(3600);
    EXPECT_EQ(watch.look(10, 5, 0, false), "");
    EXPECT_EQ(watch.look(10, 5, 7199, false), "");
    EXPECT_THAT(watch.look(10, 5.1, 7200, false), testing::HasSubstr("waits for something"));
    StallWatch brief(1);
    EXPECT_EQ(brief.look(10, 5, 0, false), "");
    EXPECT_EQ(brief.look(10, 5, 599, false), "") << "ten minutes at least";
    EXPECT_NE(brief.look(10, 5, 600, false), "");
}

TEST(StallWatch, WhoIsStoppedByHandBeginsAnew) {
    StallWatch watch(100);
    EXPECT_EQ(watch.look(10, 5, 0, false), "");
    EXPECT_EQ(watch.look(10, 5, 1e6, true), "");
    EXPECT_EQ(watch.look(10, 5, 1e6 + 100, false), "");
    EXPECT_EQ(watch.look(10, 3, 1e6 + 599, false), "") << "a process of it has ended";
    EXPECT_EQ(watch.look(10, 3, 1e6 + 1000, false), "");
}

}  // namespace
