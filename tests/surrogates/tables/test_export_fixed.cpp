// The header in whole numbers, compiled and run, is within what it says of the table, and needs no floating point.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/text.h"
#include "tests/surrogates/tables/exports_support.h"

namespace underbody {
namespace {

using tables::ForceTable;

const char* const program = R"(
#include <stdio.h>
#include <math.h>
#include "t.h"
static const int axis_bits[] = {AXIS_BITS};
static const int slope_bits[] = {SLOPE_BITS};
int main(void) {
    double p[AXES];
    while (fread(p, sizeof(double), AXES, stdin) == AXES) {
        int32_t point[AXES];
        t_result r;
        double out[4 + AXES];
        int k;
        for (k = 0; k < AXES; ++k) { point[k] = (int32_t)lround(ldexp(p[k], axis_bits[k])); }
        if (T_GAP_RAW(p[0]) != point[0] || T_GAP_RAW(1e9) != INT32_MAX || T_GAP_RAW(-1e9) != -INT32_MAX) { return 1; }
        t_at(point, &r);
        out[0] = ldexp((double)r.lift_force.value, -T_LIFT_FORCE_BITS);
        out[1] = ldexp((double)r.lift_force.sigma, -T_LIFT_FORCE_BITS);
        out[2] = r.outside + 2 * r.refused;
        out[3] = r.no_data;
        for (k = 0; k < AXES; ++k) { out[4 + k] = ldexp((double)r.lift_force.slope[k], -slope_bits[k]); }
        fwrite(out, sizeof(double), 4 + AXES, stdout);
    }
    return 0;
}
)";

class FixedPoint : public ::testing::TestWithParam<const char*> {};

/// A place that whole numbers may see on the other side of an end or of a line of the cells without data.
bool near_a_line(const ForceTable& table, const double* p, double rounding) {
    for (std::size_t k = 0; k < table.axes().size(); ++k) {
        const auto& axis = table.axes()[k];
        const double r = rounding * std::max(std::abs(axis.lower), std::abs(axis.upper));
        if (std::abs(p[k] - axis.lower) < r || std::abs(p[k] - axis.upper) < r) {
            return true;
        }
    }
    return false;
}

TEST_P(FixedPoint, IsWithinWhatItSaysOfTheTable) {
    if (!test::have(GetParam())) {
        GTEST_SKIP() << "skipped: " << GetParam() << " is not installed";
    }
    for (const ForceTable& table : {test::one_axis(), test::one_axis("refuse"), test::two_axes(),
                                    test::two_axes("gap=extrapolate,pitch=refuse"), test::three_axes(), test::band()}) {
        core::TemporaryFolder folder;
        tables::ExportOptions options;
        options.fixed_point = true;
        const auto result = export_table(table, "c", folder.path() / "t.h", options);
        const std::size_t n = table.axes().size();
        std::string axis_bits, slope_bits;
        for (const auto& axis : table.axes()) {
            std::string name = axis.name;
            std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
            axis_bits += "T_" + name + "_BITS,";
            slope_bits += "T_LIFT_FORCE_PER_" + name + "_BITS,";
        }
        core::write_file(folder.path() / "main.c", program);
        const auto points = test::random_points(table, 2000);
        test::write_doubles(folder.path() / "points.bin", points);
        ASSERT_EQ(std::system(("cd '" + folder.path().string() + "' && " + GetParam() +
                               " -std=c99 -O2 -Wall -Wextra -Wconversion -Werror -pedantic -DAXES=" +
                               std::to_string(n) + " '-DAXIS_BITS=" + axis_bits + "' '-DSLOPE_BITS=" + slope_bits +
                               "' main.c -o main -lm 2> errors.txt && ./main < points.bin > out.bin")
                                  .c_str()),
                  0)
            << core::read_file(folder.path() / "errors.txt");
        const auto out = test::read_doubles(folder.path() / "out.bin");
        ASSERT_EQ(out.size(), 2000 * (4 + n));
        const test::Sizes sizes(table, points);
        for (std::size_t i = 0; i < 2000; ++i) {
            const double *o = &out[(4 + n) * i], *p = &points[n * i];
            const auto e = test::expected(table, p);
            if (near_a_line(table, p, 1e-8)) {
                continue;
            }
            ASSERT_EQ(o[2], (e.at.outside ? 1 : 0) + (e.refused ? 2 : 0)) << i;
            ASSERT_EQ(o[3], e.at.no_data ? 1 : 0) << i;
            std::vector<double> held(n);
            for (std::size_t k = 0; k < n; ++k) {
                held[k] = std::clamp(p[k], table.axes()[k].lower, table.axes()[k].upper);
            }
            if (e.refused) {
                ASSERT_EQ(o[0], 0);
                continue;
            }
            const double inside = std::abs(o[0] - e.at.value);
            if (!e.at.outside) {
                ASSERT_LE(inside, result.error) << "point " << i;
                ASSERT_GE(o[1], (1 - 1e-6) * (e.at.sigma + inside) - 1e-8 * sizes.sigma);
            } else {
                // Beyond an end the value goes on with the slope there; sigma grows as the table's.
                ASSERT_GE(o[1], (1 - 1e-5) * e.at.sigma);
            }
            for (std::size_t k = 0; k < n && !e.at.outside; ++k) {
                ASSERT_LE(std::abs(o[4 + k] - e.at.slope[k]), 0.5 * sizes.slope[k]) << "of the right sign and size";
            }
        }
        EXPECT_LE(result.error, 0.03 * sizes.value);
    }
}
INSTANTIATE_TEST_SUITE_P(Compilers, FixedPoint, ::testing::Values("gcc", "clang"));

TEST(ExportOfFixedPoint, NeedsNoFloatingPointAndNoDivision) {
    if (!test::have("arm-none-eabi-gcc")) {
        GTEST_SKIP() << "skipped: arm-none-eabi-gcc is not installed (gcc-arm-none-eabi)";
    }
    core::TemporaryFolder folder;
    tables::ExportOptions options;
    options.fixed_point = true;
    export_table(test::band("extrapolate"), "c", folder.path() / "t.h", options);
    core::write_file(folder.path() / "use.c",
                     "#include \"t.h\"\nvoid use(const int32_t *p, t_result *r);\nvoid use(const int32_t *p, t_result "
                     "*r) { t_at(p, r); }\n");
    ASSERT_EQ(std::system(("cd '" + folder.path().string() +
                           "' && arm-none-eabi-gcc -std=c99 -ffreestanding -O2 -mcpu=cortex-m4 -mthumb "
                           "-mgeneral-regs-only -Wall -Wextra -Werror -c use.c -o use.o 2> errors.txt && "
                           "arm-none-eabi-nm -u use.o > undefined.txt")
                              .c_str()),
              0)
        << core::read_file(folder.path() / "errors.txt");
    EXPECT_EQ(core::read_file(folder.path() / "undefined.txt"), "") << "nothing of a library";
}

TEST(ExportOfFixedPoint, ComesWithASelfTestInWholeNumbersThatCanFail) {
    if (!test::have("gcc")) {
        GTEST_SKIP() << "skipped: gcc is not installed";
    }
    core::TemporaryFolder folder;
    const std::string compile = "cd '" + folder.path().string() +
                                "' && gcc -std=c99 -O2 -Wall -Wextra -Wconversion -Wno-unused-function -Werror "
                                "-pedantic body_test.c -o main 2> errors.txt";
    tables::ExportOptions options;
    options.self_test = true;
    options.fixed_point = true;
    for (const ForceTable& table :
         {test::one_axis(), test::one_axis("refuse"), test::two_axes(), test::two_axes("gap=extrapolate,pitch=refuse"),
          test::three_axes(), test::band(), test::band("extrapolate")}) {
        const auto result = export_table(table, "c", folder.path() / "body.h", options);
        ASSERT_EQ(result.files.size(), 2U);
        const std::string test = core::read_file(folder.path() / "body_test.c");
        EXPECT_EQ(test.find("double"), std::string::npos) << "a core without floating point runs it";
        ASSERT_EQ(std::system(compile.c_str()), 0) << core::read_file(folder.path() / "errors.txt");
        EXPECT_EQ(std::system((folder.path() / "main").c_str()), 0) << table.kind();
    }
    // A number that is a thousandth off is seen, and so is a wrong flag.
    const std::string header = core::read_file(folder.path() / "body.h");
    for (const auto& [right, wrong] : {std::pair{"return (a < 0) ? -r : r;", "return (a < 0) ? -r : (r - (r >> 10));"},
                                       {"result->outside = 1;", "result->outside = 0;"}}) {
        std::string changed = header;
        ASSERT_NE(changed.find(right), std::string::npos);
        changed.replace(changed.find(right), std::string(right).size(), wrong);
        core::write_file(folder.path() / "body.h", changed);
        ASSERT_EQ(std::system(compile.c_str()), 0) << core::read_file(folder.path() / "errors.txt");
        EXPECT_NE(std::system((folder.path() / "main").c_str()), 0) << wrong;
    }
}

TEST(ExportOfFixedPoint, TakesForcesThatHardlyOrNeverDependOnAnAxis) {
    core::TemporaryFolder folder;
    for (const double slope : {0.0, 1e-14, 1e-6}) {
        std::string rows = "gap [mm], jet_voltage [V], lift_force [N]\n";
        for (const double gap : {2., 4., 8., 16.}) {
            for (const double voltage : {0., 6., 12.}) {
                rows += core::format_number(gap) + ", " + core::format_number(voltage) + ", " +
                        core::format_number(1 / gap + slope * voltage) + "\n";
            }
        }
        tables::ExportOptions options;
        options.fixed_point = true;
        options.self_test = true;
        const auto table =
            ForceTable::fit(test::csv(rows), "lift_force", test::interpolation("jet_voltage=extrapolate"));
        ASSERT_NO_THROW(export_table(table, "c", folder.path() / "t.h", options))
            << slope;  // was: too far from its values
        if (test::have("gcc")) {
            ASSERT_EQ(std::system(("cd '" + folder.path().string() +
                                   "' && gcc -std=c99 -Wall -Wextra -Werror -Wno-unused-function t_test.c -o main && "
                                   "./main")
                                      .c_str()),
                      0);
        }
    }
}

TEST(ExportOfFixedPoint, IsRefusedWhereItMakesNoSense) {
    core::TemporaryFolder folder;
    tables::ExportOptions options;
    options.fixed_point = true;
    EXPECT_THROW(export_table(test::one_axis(), "json", folder.path() / "t.json", options), core::UsageError);
    options.single_precision = true;
    EXPECT_THROW(export_table(test::one_axis(), "c", folder.path() / "t.h", options), core::UsageError);
}

}  // namespace
}  // namespace underbody
