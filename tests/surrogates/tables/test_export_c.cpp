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

/// The header of a table, run at 10000 points: the points, and what it says there.
struct HeaderRun {
    std::vector<double> points, out;
    std::size_t width = 0;

    HeaderRun(const ForceTable& table, bool single, const std::string& compiler) : points(test::random_points(table, 10000, single)), width(4 + 2 * table.axes().size()) {
        core::TemporaryFolder folder;
        tables::ExportOptions options;
        options.single_precision = single;
        export_table(table, "c", folder.path() / "table.h", options);
        out = run_header(folder.path(), compiler, table.axes().size(), points);
    }
};

void check_double(const ForceTable& table, const std::string& compiler) {
    const std::size_t n = table.axes().size();
    const HeaderRun run(table, false, compiler);
    ASSERT_EQ(run.out.size(), 10000 * run.width);
    const test::Sizes sizes(table, run.points);
    const double tolerance = 1e-12;
    for (std::size_t i = 0; i < 10000; ++i) {
        const double* point = &run.points[i * n];
        const double* o = &run.out[i * run.width];
        const auto e = test::expected(table, point);
        ASSERT_NO_FATAL_FAILURE(test::expect_alike(table, point, sizes, tolerance, o[0], o + 4, o[1], o[2] != 0));
        ASSERT_EQ(o[3] != 0, e.refused);
        for (std::size_t k = 0; k < n && !e.refused; ++k) {
            ASSERT_NEAR(o[4 + n + k], e.at.beyond[k], tolerance);
        }
    }
}

/// The header knows the ends of the axes rounded to float: a point between an end and its rounded value is moved past the end, to the side where the header
/// has it. `beyond` is what the header must say, to the last bit.
std::vector<double> as_float_sees_it(const ForceTable& table, const double* point, std::vector<double>& beyond) {
    const std::size_t n = table.axes().size();
    std::vector<double> seen(n);
    beyond.assign(n, 0);
    for (std::size_t k = 0; k < n; ++k) {
        const auto& axis = table.axes()[k];
        const auto x = static_cast<float>(point[k]), lower = static_cast<float>(axis.lower), upper = static_cast<float>(axis.upper);
        if (x < lower) {
            beyond[k] = static_cast<double>(x - lower);
            seen[k] = std::min(point[k], std::nextafter(axis.lower, -INFINITY));
        } else if (x > upper) {
            beyond[k] = static_cast<double>(x - upper);
            seen[k] = std::max(point[k], std::nextafter(axis.upper, INFINITY));
        } else {
            seen[k] = std::clamp(point[k], axis.lower, axis.upper);
        }
    }
    return seen;
}

/// Bounds are counts of the rounding u = 2^-24 of a float, half as much again and more as occurs: of the value 8 u of its largest size (5e-7), of the standard
/// deviation 4 u. A slope is a difference of values over the width h of a cell, at a place whose coordinate x is rounded: 8 u (value/h + slope (1 + x/h)).
void check_single(const ForceTable& table, const std::string& compiler) {
    const std::size_t n = table.axes().size();
    const HeaderRun run(table, true, compiler);
    ASSERT_EQ(run.out.size(), 10000 * run.width);
    const test::Sizes sizes(table, run.points);
    constexpr double u = 0x1p-24;
    for (std::size_t i = 0; i < 10000; ++i) {
        const double* point = &run.points[i * n];
        const double* o = &run.out[i * run.width];
        std::vector<double> beyond;
        const auto seen = as_float_sees_it(table, point, beyond);
        const auto e = test::expected(table, seen.data());
        ASSERT_EQ(o[2] != 0, e.at.outside);
        ASSERT_EQ(o[3] != 0, e.refused);
        ASSERT_NEAR(o[1], e.at.sigma, 4 * u * sizes.sigma);
        ASSERT_TRUE(e.refused ? std::isnan(o[0]) : std::abs(o[0] - e.at.value) <= 8 * u * sizes.value) << o[0] << " instead of " << e.at.value;
        for (std::size_t k = 0; k < n; ++k) {
            ASSERT_EQ(o[4 + n + k], beyond[k]);
            if (e.refused) {
                ASSERT_TRUE(std::isnan(o[4 + k]));
                continue;
            }
            const auto& x = table.knots(k);
            const auto above = std::clamp<std::ptrdiff_t>(std::upper_bound(x.begin(), x.end(), seen[k]) - x.begin(), 1, std::ssize(x) - 1);
            const double h = x[above] - x[above - 1];
            ASSERT_NEAR(o[4 + k], e.at.slope[k], 8 * u * (sizes.value / h + sizes.slope[k] * (1 + std::abs(point[k]) / h))) << point[k] << " along " << table.axes()[k].name;
        }
    }
}

class CHeader : public ::testing::TestWithParam<const char*> {};

TEST_P(CHeader, EvaluatesLikeTheTableInsideAndOutside) {
    if (!test::have(GetParam())) {
        GTEST_SKIP() << "skipped: " << GetParam() << " is not installed";
    }
    for (const auto& table : test::tables_of_all_policies()) {
        check_double(table, GetParam());
    }
    for (const auto& table : {test::one_axis(), test::two_axes(), test::three_axes(), test::two_axes("gap=refuse,pitch=extrapolate")}) {
        check_single(table, GetParam());
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
