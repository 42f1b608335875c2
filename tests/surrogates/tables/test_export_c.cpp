// The C header, compiled by gcc and clang with all warnings as errors, evaluates like the table.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/misra.h"
#include "tests/surrogates/tables/exports_support.h"

namespace underbody {
namespace {

using tables::ForceTable;
using ::testing::HasSubstr;

/// A C program around the header: points on stdin; value, sigma, outside, refused, no_data, slopes, beyond on stdout,
/// all double.
std::string driver(const std::string& name, std::size_t axes) {
    const std::string n = std::to_string(axes);
    const std::string width = std::to_string(5 + 2 * axes);
    return "#include <stdio.h>\n#include \"table.h\"\nint main(void) {\n    double in[" + n +
           "];\n    while (fread(in, sizeof(double), " + n + ", stdin) == " + n + ") {\n        " + name + "_real p[" +
           n + "];\n        " + name + "_result r;\n        double out[" + width +
           "];\n        int k;\n        for (k = 0; k < " + n + "; ++k) {\n            p[k] = (" + name +
           "_real)in[k];\n        }\n        " + name +
           "_at(p, &r);\n        out[0] = (double)r.value;\n        out[1] = (double)r.sigma;\n        out[2] = "
           "r.outside;\n        out[3] = r.refused;\n        out[4] = r.no_data;\n        for (k = 0; k < " +
           n + "; ++k) {\n            out[5 + k] = (double)r.slope[k];\n            out[5 + " + n +
           " + k] = (double)r.beyond[k];\n        }\n        fwrite(out, sizeof(double), " + width +
           ", stdout);\n    }\n    return 0;\n}\n";
}

std::vector<double> run_header(const std::filesystem::path& folder, const std::string& compiler, std::size_t axes,
                               const std::vector<double>& points) {
    core::write_file(folder / "main.c", driver("table", axes));
    test::write_doubles(folder / "points.bin", points);
    const std::string command = "cd '" + folder.string() + "' && " + compiler +
                                " -std=c99 -O2 -Wall -Wextra -Wconversion -Werror -pedantic main.c -o main 2> "
                                "errors.txt && ./main < points.bin > out.bin";
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

    HeaderRun(const ForceTable& table, bool single, const std::string& compiler)
        : points(test::random_points(table, 10000, single)), width(5 + 2 * table.axes().size()) {
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
        ASSERT_NO_FATAL_FAILURE(
            test::expect_alike(table, point, sizes, tolerance, o[0], o + 5, o[1], o[2] != 0, o[4] != 0));
        ASSERT_EQ(o[3] != 0, e.refused);
        for (std::size_t k = 0; k < n && !e.refused; ++k) {
            ASSERT_NEAR(o[5 + n + k], e.at.beyond[k], tolerance);
        }
    }
}

/// The header knows the ends of the axes rounded to float: a point between an end and its rounded value is moved past
/// the end, to the side where the header has it. `beyond` is what the header must say, to the last bit.
std::vector<double> as_float_sees_it(const ForceTable& table, const double* point, std::vector<double>& beyond) {
    const std::size_t n = table.axes().size();
    std::vector<double> seen(n);
    beyond.assign(n, 0);
    for (std::size_t k = 0; k < n; ++k) {
        const auto& axis = table.axes()[k];
        const auto x = static_cast<float>(point[k]), lower = static_cast<float>(axis.lower),
                   upper = static_cast<float>(axis.upper);
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

/// Bounds are counts of the rounding u = 2^-24 of a float, half as much again and more as occurs: of the value 8 u of
/// its largest size (5e-7), of the standard deviation 4 u. A slope is a difference of values over the width h of a
/// cell, at a place whose coordinate x is rounded: 8 u (value/h + slope (1 + x/h)).
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
        ASSERT_EQ(o[4] != 0, e.at.no_data);
        ASSERT_NEAR(o[1], e.at.sigma, 4 * u * sizes.sigma);
        ASSERT_TRUE(e.refused ? std::isnan(o[0]) : std::abs(o[0] - e.at.value) <= 8 * u * sizes.value)
            << o[0] << " instead of " << e.at.value;
        for (std::size_t k = 0; k < n; ++k) {
            ASSERT_EQ(o[5 + n + k], beyond[k]);
            if (e.refused) {
                ASSERT_TRUE(std::isnan(o[5 + k]));
                continue;
            }
            const auto& x = table.knots(k);
            const auto above = std::clamp<std::ptrdiff_t>(std::upper_bound(x.begin(), x.end(), seen[k]) - x.begin(), 1,
                                                          std::ssize(x) - 1);
            const double h = x[above] - x[above - 1];
            ASSERT_NEAR(o[5 + k], e.at.slope[k],
                        8 * u * (sizes.value / h + sizes.slope[k] * (1 + std::abs(point[k]) / h)))
                << point[k] << " along " << table.axes()[k].name;
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
    for (const auto& table :
         {test::one_axis(), test::two_axes(), test::three_axes(), test::two_axes("gap=refuse,pitch=extrapolate")}) {
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

/// Does a C program that includes these compile and run?
bool compiles(const std::filesystem::path& folder, const std::string& program, const std::string& compiler = "gcc") {
    core::write_file(folder / "main.c", program);
    return std::system(("cd '" + folder.string() + "' && " + compiler +
                        " -std=c99 -O2 -Wall -Wextra -Wconversion -Werror -pedantic main.c -o main 2> errors.txt && "
                        "./main > out.txt")
                           .c_str()) == 0;
}

TEST(ExportOfC, OfTwoBodiesLiveInOneProgram) {
    if (!test::have("gcc")) {
        GTEST_SKIP() << "skipped: gcc is not installed";
    }
    core::TemporaryFolder folder;
    std::filesystem::create_directory(folder.path() / "other");
    const double scale = 2;
    core::Table doubled = test::ref_a();
    std::vector<double> force = doubled.numbers("lift_force");
    for (double& f : force) {
        f *= scale;
    }
    core::Table second;
    second.source = "second";
    second.add_numbers("gap", "m", doubled.numbers("gap"));
    second.add_numbers("lift_force", "N", force);
    export_table(test::one_axis(), "c", folder.path() / "ellipse.h");
    export_table(ForceTable::fit(second, "lift_force", test::interpolation()), "c", folder.path() / "rectangle-2.h");
    EXPECT_TRUE(compiles(folder.path(),
                         "#include <stdio.h>\n#include \"ellipse.h\"\n#include \"rectangle-2.h\"\n"
                         "int main(void) { printf(\"%.17g %.17g\", ellipse_value(0.043), rectangle_2_value(0.043)); "
                         "return ellipse_outside(0.1) + rectangle_2_no_data(0.1); }\n"))
        << core::read_file(folder.path() / "errors.txt");
    double one = 0, two = 0;
    ASSERT_EQ(std::sscanf(core::read_file(folder.path() / "out.txt").c_str(), "%lf %lf", &one, &two), 2);
    EXPECT_NEAR(two, 2 * one, 1e-15);
    // Of one name, as from two folders: an error of the compiler, not a table that is left out in silence; a name of
    // its own mends it.
    export_table(ForceTable::fit(second, "lift_force", test::interpolation()), "c",
                 folder.path() / "other" / "ellipse.h");
    const std::string both =
        "#include \"ellipse.h\"\n#include \"other/ellipse.h\"\nint main(void) { return ellipse_outside(0.1); }\n";
    EXPECT_FALSE(compiles(folder.path(), both));
    tables::ExportOptions named;
    named.name = "second";
    export_table(ForceTable::fit(second, "lift_force", test::interpolation()), "c",
                 folder.path() / "other" / "ellipse.h", named);
    EXPECT_TRUE(compiles(folder.path(),
                         "#include \"ellipse.h\"\n#include \"other/ellipse.h\"\nint main(void) { return "
                         "ellipse_outside(0.1) + second_outside(0.1) + ellipse_no_data(0.1) + "
                         "second_no_data(0.1) + (ellipse_value(0.1) > 1) + (second_value(0.1) > 1) + "
                         "(ellipse_sigma(0.1) > 1) + (second_sigma(0.1) > 1); }\n",
                         "gcc -Wno-unused-function"))
        << core::read_file(folder.path() / "errors.txt");
    // One header twice is one header.
    EXPECT_TRUE(
        compiles(folder.path(),
                 "#include \"ellipse.h\"\n#include \"ellipse.h\"\nint main(void) { return ellipse_outside(0.1); }\n"));
}

/// Lift and side force on one grid.
std::vector<ForceTable> two_quantities() { return {test::sum_of_tables(), test::sum_of_tables("clamp", "side_force")}; }

TEST(ExportOfC, GivesSeveralForcesInOneCall) {
    const auto both = two_quantities();
    const auto points = test::random_points(both[0], 2000);
    const test::Sizes sizes[2] = {{both[0], points}, {both[1], points}};
    for (const char* compiler : {"gcc", "clang"}) {
        if (!test::have(compiler)) {
            continue;
        }
        core::TemporaryFolder folder;
        const auto result = export_tables(both, "c", folder.path() / "body.h");
        ASSERT_EQ(result.errors.size(), 2u);
        test::write_doubles(folder.path() / "points.bin", points);
        core::write_file(
            folder.path() / "main.c",
            "#include <stdio.h>\n#include \"body.h\"\nint main(void) {\n    double p[2];\n    while (fread(p, "
            "sizeof(double), 2, stdin) == 2) {\n        body_result r;\n"
            "        double out[10];\n        body_at(p, &r);\n        out[0] = r.lift_force.value;\n        out[1] = "
            "r.lift_force.slope[0];\n        out[2] = r.lift_force.slope[1];\n"
            "        out[3] = r.lift_force.sigma;\n        out[4] = r.side_force.value;\n        out[5] = "
            "r.side_force.slope[0];\n        out[6] = r.side_force.slope[1];\n"
            "        out[7] = r.side_force.sigma;\n        out[8] = r.outside;\n        out[9] = r.no_data;\n"
            "        if (!(body_side_force_value(p[0], p[1]) >= out[4] && body_side_force_value(p[0], p[1]) <= "
            "out[4])) {\n            return 1;\n        }\n"
            "        fwrite(out, sizeof(double), 10, stdout);\n    }\n    return 0;\n}\n");
        ASSERT_EQ(std::system(("cd '" + folder.path().string() + "' && " + compiler +
                               " -std=c99 -O2 -Wall -Wextra -Wconversion -Werror -pedantic main.c -o main 2> "
                               "errors.txt && ./main < points.bin > out.bin")
                                  .c_str()),
                  0)
            << core::read_file(folder.path() / "errors.txt");
        const auto out = test::read_doubles(folder.path() / "out.bin");
        ASSERT_EQ(out.size(), 20000u);
        for (std::size_t i = 0; i < 2000; ++i) {
            for (std::size_t q = 0; q < 2; ++q) {
                const double* o = &out[10 * i + 4 * q];
                ASSERT_NO_FATAL_FAILURE(test::expect_alike(both[q], &points[2 * i], sizes[q], 1e-12, o[0], o + 1, o[3],
                                                           out[10 * i + 8] != 0, out[10 * i + 9] != 0));
            }
        }
    }
}

TEST(ExportOfC, ComesWithASelfTestThatCanFail) {
    if (!test::have("gcc")) {
        GTEST_SKIP() << "skipped: gcc is not installed";
    }
    core::TemporaryFolder folder;
    const std::string compile = "cd '" + folder.path().string() +
                                "' && gcc -std=c99 -O2 -Wall -Wextra -Wconversion -Wno-unused-function -Werror "
                                "-pedantic body_test.c -o main 2> errors.txt";
    for (const bool single : {false, true}) {
        tables::ExportOptions options;
        options.self_test = true;
        options.single_precision = single;
        std::vector<std::vector<ForceTable>> all{two_quantities()};
        for (const auto& table : test::tables_of_all_policies()) {
            all.push_back({table});
        }
        for (const auto& tables : all) {
            const auto result = export_tables(tables, "c", folder.path() / "body.h", options);
            ASSERT_EQ(result.files.size(), 2u);
            ASSERT_EQ(std::system(compile.c_str()), 0) << core::read_file(folder.path() / "errors.txt");
            EXPECT_EQ(std::system((folder.path() / "main").c_str()), 0)
                << tables.front().kind() << (single ? ", float" : ", double");
        }
        // A wrong number in the header is seen.
        std::string header = core::read_file(folder.path() / "body.h");
        const std::string right = single ? "(1.0f + 2.0f * t)" : "(1.0 + 2.0 * t)";
        ASSERT_NE(header.find(right), std::string::npos);
        header.replace(header.find(right), right.size(), single ? "(1.0f + 2.001f * t)" : "(1.0 + 2.001 * t)");
        core::write_file(folder.path() / "body.h", header);
        ASSERT_EQ(std::system(compile.c_str()), 0) << core::read_file(folder.path() / "errors.txt");
        EXPECT_NE(std::system((folder.path() / "main").c_str()), 0);
    }
    tables::ExportOptions options;
    options.self_test = true;
    EXPECT_THROW(export_table(test::one_axis(), "json", folder.path() / "t.json", options), core::UsageError);
}

TEST(ExportOfC, SelfTestSaysHowManyDifferAndByHowMuch) {
    if (!test::have("gcc")) {
        GTEST_SKIP() << "skipped: gcc is not installed";
    }
    core::TemporaryFolder folder;
    tables::ExportOptions options;
    options.self_test = true;
    for (const std::size_t points : {200U, 3000U}) {
        options.self_test_points = points;
        export_table(test::one_axis(), "c", folder.path() / "body.h", options);
        const std::string count = std::to_string(points);
        EXPECT_NE(core::read_file(folder.path() / "body_test.c").find("at " + count + " points"), std::string::npos);
        ASSERT_EQ(std::system(("cd '" + folder.path().string() +
                               "' && gcc -std=c99 body_test.c -o main -lm && ./main > said.txt")
                                  .c_str()),
                  0);
        const std::string said = core::read_file(folder.path() / "said.txt");
        EXPECT_EQ(said.find("0 of " + count + " differ; a value by "), 0U) << said;
    }
}

TEST(ExportOfC, IsCleanForCppcheck) {
    if (!test::have("cppcheck")) {
        GTEST_SKIP() << "skipped: cppcheck is not installed";
    }
    core::TemporaryFolder folder;
    export_tables(two_quantities(), "c", folder.path() / "body.h");
    export_table(test::band("gap=refuse,pitch=extrapolate"), "c", folder.path() / "band.h");
    core::write_file(folder.path() / "main.c",
                     "#include \"body.h\"\n#include \"band.h\"\nint main(void) {\n    body_result r;\n    band_result "
                     "s;\n    const double p[2] = {0.01, 0.02};\n"
                     "    body_at(p, &r);\n    band_at(p, &s);\n    return r.outside + s.no_data;\n}\n");
    EXPECT_EQ(std::system(("cd '" + folder.path().string() +
                           "' && cppcheck --std=c99 --enable=warning,performance,portability --error-exitcode=1 -q "
                           "main.c > errors.txt 2>&1")
                              .c_str()),
              0)
        << core::read_file(folder.path() / "errors.txt");
}

/// MISRA C:2012 by cppcheck's addon: nothing but advisory rules.
TEST(ExportOfC, KeepsToTheRequiredRulesOfMisra) {
    if (!test::have("cppcheck") || !test::have("python3")) {
        GTEST_SKIP() << "skipped: cppcheck (with python3 for its addon) is not installed";
    }
    core::TemporaryFolder folder;
    const auto write = [&](const char* name, const std::vector<ForceTable>& tables, bool single, bool fixed) {
        tables::ExportOptions options;
        options.single_precision = single;
        options.fixed_point = fixed;
        options.max_error = 0.05;
        export_tables(tables, "c", folder.path() / (std::string(name) + ".h"), options);
        core::write_file(
            folder.path() / (std::string(name) + ".c"),
            "#include \"" + std::string(name) + ".h\"\nint main(void);\nint main(void)\n{\n    return 0;\n}\n");
    };
    write("one", {test::one_axis("extrapolate")}, true, false);
    write("two", two_quantities(), false, false);
    write("three", {test::three_axes("gap=extrapolate,pitch=clamp,speed=refuse")}, false, false);
    write("band", {test::band("gap=refuse,pitch=extrapolate")}, false, false);
    write("fixed", two_quantities(), false, true);
    write("fixed_band", {test::band("gap=refuse,pitch=extrapolate")}, false, true);
    for (const char* name : {"one", "two", "three", "band", "fixed", "fixed_band"}) {
        const test::MisraFindings found = test::misra_findings(folder.path(), name);
        EXPECT_THAT(found.required, testing::IsEmpty()) << name << "\n" << found.text;
        EXPECT_FALSE(found.rules.empty()) << "the addon ran: it names advisory rules\n" << found.text;
    }
}

}  // namespace
}  // namespace underbody
