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

}  // namespace
}  // namespace underbody::core
