// A C header that is compiled and compared before anybody relies on it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "cases/child_process.h"
#include "cases/prove_export.h"
#include "core/error.h"
#include "core/file.h"
#include "surrogates/tables/points/select.h"
#include "tests/support/support.h"

namespace underbody::cases {
namespace {

using tables::ForceTable;
using testing::HasSubstr;

ForceTable lift() {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv",
                     "gap [mm], lift_force [N]\n1, .66\n2, .4\n3, .296\n5, .27\n10, .297\n");
    return ForceTable::fit(tables::read_points(folder.path() / "lift.csv"), "lift_force");
}

TEST(ProveExport, ComparesTenThousandPoints) {
    if (!find_program("cc")) {
        GTEST_SKIP() << "skipped: cc is not installed";
    }
    for (const int numbers : {0, 1, 2}) {
        tables::ExportOptions options;
        options.name = "lift";
        options.single_precision = numbers == 1;
        options.fixed_point = numbers == 2;
        const Proof proof = prove_export({lift()}, options);
        EXPECT_TRUE(proof.equal) << proof.sentence;
        EXPECT_EQ(proof.points, 10000U);
        EXPECT_THAT(proof.sentence, HasSubstr("10,000 points"));
        EXPECT_THAT(proof.sentence, HasSubstr("values differ by at most "));
    }
    tables::ExportOptions options;
    options.max_error = -1;
    EXPECT_THROW(prove_export({lift()}, options), core::UsageError);
}

TEST(ProveExport, IsCancelledWhileItCompiles) {
    if (!find_program("cc")) {
        GTEST_SKIP() << "skipped: cc is not installed";
    }
    core::Progress progress([&](double fraction, const std::string& what) {
        EXPECT_GE(fraction, 0);
        EXPECT_LE(fraction, 1);
        if (what == "compiling") {
            progress.cancel();
        }
    });
    const auto begun = std::chrono::steady_clock::now();
    EXPECT_THROW(prove_export({lift()}, {}, progress), core::Cancelled);
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(20)) << "not the whole compilation";
}

TEST(ProveExport, SaysThatThereIsNoCompiler) {
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", "/nowhere", 1);
    const Proof proof = prove_export({lift()}, {});
    ::setenv("PATH", path.c_str(), 1);
    EXPECT_FALSE(proof.equal);
    EXPECT_THAT(proof.sentence, HasSubstr("no C compiler (cc)"));
}

}  // namespace
}  // namespace underbody::cases
