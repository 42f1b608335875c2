#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "core/parallel.h"
#include "core/progress.h"

namespace underbody::core {
namespace {

TEST(Parallel, ALoopWithinALoopDoesAllItsPartsThoughAnotherPartThrows) {
    if (threads() < 2) {
        GTEST_SKIP() << "skipped: one thread alone";
    }
    constexpr int parts = 2000;
    for (int round = 0; round < 100; ++round) {
        Progress progress;
        std::atomic<bool> begun{false}, whole{true};
        const auto outer = [&](std::size_t i) {
            if (i == 1) {
                for (int wait = 0; wait < 1000000 && !begun; ++wait) {
                    std::this_thread::yield();
                }
                throw std::runtime_error("the other part");
            }
            std::atomic<int> done{0};
            parallel_for(
                parts,
                [&](std::size_t) {
                    begun = true;
                    ++done;
                    std::this_thread::yield();
                },
                progress);
            whole = done == parts;
        };
        EXPECT_THROW(parallel_for(2, outer, progress), std::runtime_error);
        ASSERT_TRUE(whole) << "round " << round << ": the inner loop ended early without a word";
    }
}

}  // namespace
}  // namespace underbody::core
