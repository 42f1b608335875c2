#include <gtest/gtest.h>

#include <cstddef>

#include "core/counted.h"

namespace underbody::core {
namespace {

TEST(Counted, OneIsSingularAndAllElseIsPlural) {
    EXPECT_EQ(counted(0, "case"), "0 cases");
    EXPECT_EQ(counted(1, "case"), "1 case");
    EXPECT_EQ(counted(std::size_t{2}, "case"), "2 cases");
    EXPECT_EQ(counted(1, "run has", "runs have"), "1 run has");
    EXPECT_EQ(counted(10000, "run has", "runs have"), "10000 runs have");
}

TEST(Counted, AShareAgreesWithWhatIsCountedNotWithTheWhole) {
    EXPECT_EQ(counted_of(1, 9, "point", "lies", "lie"), "1 of 9 points lies");
    EXPECT_EQ(counted_of(2, std::size_t{9}, "point", "lies", "lie"), "2 of 9 points lie");
    EXPECT_EQ(counted_of(1, 1, "point", "lies", "lie"), "1 of 1 point lies");
}

TEST(Counted, ANumberThatIsWrittenAlready) {
    EXPECT_EQ(counted_text("1", "standard deviation"), "1 standard deviation");
    EXPECT_EQ(counted_text("1.5", "standard deviation"), "1.5 standard deviations");
}

}  // namespace
}  // namespace underbody::core
