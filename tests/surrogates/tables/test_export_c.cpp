// The C header, compiled by gcc and clang with all warnings as errors, evaluates like the table.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/surrogates/tables/exports_support.h"

namespace underbody {
namespace {

using tables::ForceTable;
using ::testing::HasSubstr;

/// A C program around the header: points on stdin; value, sigma, outside, refused, slopes, beyond on stdout, all double.
std::string driver(const std::string& name, std::size_t axes) {
    const std::string n = std::to_string(axes);
    const std::string width = std::to_string(4 + 2 * axes);
    return "#include <stdio.h>\n#include \"table.h\"\nint main(void) {\n    double in[" + n + "];\n    while (fread(in, sizeof(double), " + n + ", stdin) == " + n +
           ") {\n        " + name + "_real p[" + n + "];\n        " + name + "_result r;\n        double out[" + width + "];\n        int k;\n        for (k = 0; k < " + n +
           "; ++k) {\n            p[k] = (" + name + "_real)in[k];\n        }\n        " + name +
           "_at(p, &r);\n        out[0] = (double)r.value;\n        out[1] = (double)r.sigma;\n        out[2] = r.outside;\n        out[3] = r.refused;\n        for (k = 0; k < " +
           n + "; ++k) {\n            out[4 + k] = (double)r.slope[k];\n            out[4 + " + n + " + k] = (double)r.beyond[k];\n        }\n        fwrite(out, sizeof(double), " +
           width + ", stdout);\n    }\n    return 0;\n}\n";
}

std::vector<double> run_header(const std::filesystem::path& folder, const std::string& compiler, std::size_t axes, const std::vector<double>& points) {
    core::write_file(folder / "main.c", driver("lift_force", axes));
    test::write_doubles(folder / "points.bin", points);
    const std::string command = "cd '" + folder.string() + "' && " + compiler +
                                " -std=c99 -O2 -Wall -Wextra -Wconversion -Werror -pedantic main.c -o main 2> errors.txt && ./main < points.bin > out.bin";
    if (std::system(command.c_str()) != 0) {
        ADD_FAILURE() << core::read_file(folder / "errors.txt");
        return {};
    }
    return test::read_doubles(folder / "out.bin");
}

void check_header(const ForceTable& table, bool single, const std::string& compiler) {
    core::TemporaryFolder folder;
    tables::ExportOptions options;
    options.single_precision = single;
    export_table(table, "c", folder.path() / "table.h", options);
    const std::size_t n = table.axes().size();
    const auto points = test::random_points(table, 10000, single);
    const auto out = run_header(folder.path(), compiler, n, points);
    const std::size_t width = 4 + 2 * n;
    ASSERT_EQ(out.size(), 10000 * width);
    const test::Sizes sizes(table, points);
    const double tolerance = single ? 1e-6 : 1e-12;
    for (std::size_t i = 0; i < 10000; ++i) {
        const double* point = &points[i * n];
        const double* o = &out[i * width];
        const auto e = test::expected(table, point);
        bool at_an_end = false;  // an end rounded to float may fall on either side
        for (std::size_t k = 0; k < n; ++k) {
            const auto& axis = table.axes()[k];
            at_an_end = at_an_end || std::abs(point[k] - axis.lower) < 1e-6 || std::abs(point[k] - axis.upper) < 1e-6;
        }
        if (single && at_an_end) {
            continue;
        }
        if (single) {
            ASSERT_EQ(o[3] != 0, e.refused);
            ASSERT_NEAR(o[1], e.at.sigma, tolerance * (1 + e.at.sigma));
            ASSERT_TRUE(e.refused ? std::isnan(o[0]) : std::abs(o[0] - e.at.value) <= tolerance * sizes.value) << o[0] << " instead of " << e.at.value;
            for (std::size_t k = 0; k < n && !e.refused; ++k) {
                ASSERT_NEAR(o[4 + k], e.at.slope[k], 1e-4 * sizes.slope[k]);
            }
            continue;
        }
        ASSERT_NO_FATAL_FAILURE(test::expect_alike(table, point, sizes, tolerance, o[0], o + 4, o[1], o[2] != 0));
        ASSERT_EQ(o[3] != 0, e.refused);
        for (std::size_t k = 0; k < n && !e.refused; ++k) {
            ASSERT_NEAR(o[4 + n + k], e.at.beyond[k], tolerance);
        }
    }
}

class CHeader : public ::testing::TestWithParam<const char*> {};

TEST_P(CHeader, EvaluatesLikeTheTableInsideAndOutside) {
    if (!test::have(GetParam())) {
        GTEST_SKIP() << "skipped: " << GetParam() << " is not installed";
    }
    for (const auto& table : test::tables_of_all_policies()) {
        check_header(table, false, GetParam());
    }
    for (const auto& table : {test::one_axis(), test::two_axes(), test::three_axes(), test::two_axes("gap=refuse,pitch=extrapolate")}) {
        check_header(table, true, GetParam());
    }
}
INSTANTIATE_TEST_SUITE_P(Compilers, CHeader, ::testing::Values("gcc", "clang"));

TEST(ExportOfC, SaysItsUnitsItsOriginAndWhatItDoesOutside) {
    core::TemporaryFolder folder;
    export_table(test::two_axes("gap=refuse,pitch=extrapolate"), "c", folder.path() / "t.h");
    const std::string text = core::read_file(folder.path() / "t.h");
    EXPECT_THAT(text, HasSubstr("Force table by Underbody: lift_force [N], vertical force, positive up (repulsion)"));
    EXPECT_THAT(text, HasSubstr("Made from grid: 312 points"));
    EXPECT_THAT(text, HasSubstr("Axis gap [m]: 0.001 to 0.1, 24 points"));
    EXPECT_THAT(text, HasSubstr("Outside the range of gap it refuses: value and slopes are not numbers there"));
    EXPECT_THAT(text, HasSubstr("Outside the range of pitch it goes on along its tangent"));
}

}  // namespace
}  // namespace underbody
