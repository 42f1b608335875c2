// What all exports have in common: thinning, frames, files that are there already.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/progress.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/fit/error_model.h"
#include "tests/surrogates/tables/exports_support.h"

namespace underbody {
namespace {

using tables::ExportOptions;
using tables::ForceTable;
using ::testing::HasSubstr;

TEST(Exports, ThinTheGridAndKeepTheErrorAskedFor) {
    std::vector<double> gap, pitch;
    for (int i = 0; i < 60; ++i) {
        gap.push_back(0.001 * std::pow(100.0, i / 59.0));
        pitch.push_back(-0.1 + 0.2 * i / 59);
    }
    const auto table = ForceTable::fit(
        test::grid_table(gap, pitch,
                         [](double h, double p) { return 3e-4 / h + 4 * p / (1 + 40 * h) + 0.3 * std::sin(9 * h); }),
        "lift_force", test::interpolation());
    core::TemporaryFolder folder;
    ExportOptions options;
    options.max_error = 0.005;
    const auto result = export_table(table, "csv", folder.path() / "thin.csv", options);
    ASSERT_EQ(result.grid.size(), 2u);
    EXPECT_LT(result.grid[0] * result.grid[1], 200u);
    const auto thin = ForceTable::read(folder.path() / "thin.csv", "lift_force");
    double low = 1e9, high = -1e9, worst = 0;
    core::Random random(5);
    for (int i = 0; i < 20000; ++i) {
        const double p[2] = {random.uniform(0.001, 0.1), random.uniform(-0.1, 0.1)};
        const double v = table.value(p);
        low = std::min(low, v);
        high = std::max(high, v);
        worst = std::max(worst, std::abs(v - thin.value(p)));
    }
    EXPECT_LE(worst, 0.005 * (high - low));
    EXPECT_LE(worst, result.error);
    EXPECT_GT(result.error, 0);
    EXPECT_THAT(core::read_file(folder.path() / "thin.csv"), HasSubstr("Differs from the full table by at most"));
}

// The curve of the difference is that of the file that is read back, and touches the error that is stated.
TEST(Exports, DrawTheDifferenceAlongTheFirstAxis) {
    std::vector<double> gap;
    for (int i = 0; i < 60; ++i) {
        gap.push_back(0.001 * std::pow(100.0, i / 59.0));
    }
    std::vector<double> lift;
    std::transform(gap.begin(), gap.end(), std::back_inserter(lift),
                   [](double h) { return 3e-4 / h + 0.3 * std::sin(9 * h); });
    core::Table points;
    points.add_numbers("gap", "m", gap);
    points.add_numbers("lift_force", "N", lift);
    const auto table = ForceTable::fit(points, "lift_force", test::interpolation());
    core::TemporaryFolder folder;
    ExportOptions options;
    options.max_error = 0.01;
    const auto result = export_table(table, "csv", folder.path() / "thin.csv", options);
    const auto thin = ForceTable::read(folder.path() / "thin.csv", "lift_force");
    const auto figure = export_difference_figure(table, "csv", options);
    ASSERT_EQ(figure.curves.size(), 1U);
    const auto& curve = figure.curves.front();
    double largest = 0;
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        const double h = std::clamp(core::convert(curve.x[i], figure.x.unit, "m"), 0.001, 0.1);
        EXPECT_NEAR(curve.y[i], thin.value(&h) - table.value(&h), 1e-9) << h;
        largest = std::max(largest, std::abs(curve.y[i]));
    }
    EXPECT_LE(largest, result.error);
    EXPECT_GT(largest, 0.7 * result.error);
    // Where the consumer draws straight lines, theirs.
    const auto straight = export_difference_figure(table, "jsbsim", options).curves.front();
    double of_lines = 0;
    for (const double y : straight.y) {
        of_lines = std::max(of_lines, std::abs(y));
    }
    EXPECT_GT(of_lines, 0);
    EXPECT_LE(of_lines, export_table(table, "jsbsim", folder.path() / "thin.xml", options).error);
}

TEST(Exports, SayWithTheirErrorWhatThinningCostBetweenTheLinesOfEveryAxis) {
    core::TemporaryFolder folder;
    const auto table = test::two_axes();
    ExportOptions options;
    options.max_error = 0.02;
    export_table(table, "csv", folder.path() / "thin.csv", options);
    const auto thin = ForceTable::read(folder.path() / "thin.csv", "lift_force");
    for (std::size_t k = 0; k < 2; ++k) {
        ASSERT_LT(thin.axes()[k].points.size(), table.axes()[k].points.size());
    }
    // On the lines of one axis only the other's cells can speak.
    const auto check = [&](const double* p) {
        const double off = std::abs(thin.value(p) - table.value(p));
        ASSERT_GE(thin.sigma(p), (1 - 1e-12) * (0.01 + off)) << p[0] << " " << p[1];
    };
    for (int i = 0; i <= 400; ++i) {
        const double t = i / 400.0;
        for (const double gap : thin.axes()[0].points) {
            const double p[2] = {gap, (1 - t) * table.axes()[1].lower + t * table.axes()[1].upper};
            ASSERT_NO_FATAL_FAILURE(check(p));
        }
        for (const double pitch : thin.axes()[1].points) {
            const double p[2] = {(1 - t) * table.axes()[0].lower + t * table.axes()[0].upper, pitch};
            ASSERT_NO_FATAL_FAILURE(check(p));
        }
    }
}

TEST(Exports, DoNotLoseTheErrorOfAPointThatThinningLeavesOut) {
    std::string text = "gap [m], lift_force [N], lift_force_sigma [N]\n";
    for (int i = 0; i <= 10; ++i) {
        text +=
            core::format_number(0.1 * i) + ", " + core::format_number(1 - 0.1 * i) + (i == 5 ? ", 0.2\n" : ", 0.01\n");
    }
    core::TemporaryFolder folder;
    ExportOptions options;
    options.max_error = 0.01;
    const auto result = export_table(ForceTable::fit(test::csv(text), "lift_force", test::interpolation()), "csv",
                                     folder.path() / "thin.csv", options);
    ASSERT_EQ(result.grid[0], 2u);
    const auto thin = ForceTable::read(folder.path() / "thin.csv", "lift_force");
    for (const double gap : {0.0, 0.3, 0.5, 1.0}) {
        EXPECT_NEAR(thin.sigma(&gap), 0.2, 1e-9);
    }
}

TEST(Exports, CoverTheErrorOfTheTableByNoMoreThanItRisesBetweenTheLinesThatStay) {
    core::Random random(8);
    for (int trial = 0; trial < 50; ++trial) {
        std::vector<std::vector<double>> lines(2), kept(2);
        for (std::size_t k = 0; k < 2; ++k) {
            for (int i = 0; i < 12; ++i) {
                lines[k].push_back(i == 0 ? 0 : lines[k].back() + random.uniform(0.1, 1));
                if (i == 0 || i == 11 || random.uniform() < 0.4) {
                    kept[k].push_back(lines[k].back());
                }
            }
        }
        std::vector<double> rough, convex;
        for (const double x : lines[0]) {
            for (const double y : lines[1]) {
                rough.push_back(random.uniform());
                convex.push_back(0.01 * (1 + x * x + std::exp(y)));
            }
        }
        const tables::ErrorModel full(lines, rough), growing(lines, convex);
        const tables::ErrorModel thin = full.resampled(kept), same = growing.resampled(kept);
        for (int i = 0; i < 200; ++i) {
            const double p[2] = {random.uniform(0, lines[0].back()), random.uniform(0, lines[1].back())};
            EXPECT_GE(thin.sigma(p, nullptr), (1 - 1e-12) * full.sigma(p, nullptr));
            EXPECT_GE(same.sigma(p, nullptr), (1 - 1e-12) * growing.sigma(p, nullptr));
        }
        // What bends upward lies below its chords: nothing is added at the lines.
        for (const double x : kept[0]) {
            for (const double y : kept[1]) {
                const double p[2] = {x, y};
                EXPECT_NEAR(same.sigma(p, nullptr), growing.sigma(p, nullptr), 1e-12);
            }
        }
    }
}

TEST(Exports, CanBeCancelledWhileTheyCompare) {
    core::TemporaryFolder folder;
    core::Progress progress;
    progress.cancel();
    ExportOptions options;
    options.points = {{"gap", 50}};
    EXPECT_THROW(export_table(test::two_axes(), "csv", folder.path() / "t.csv", options, progress), core::Cancelled);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "t.csv"));
}

TEST(Exports, AreThinnedByTheRangeOfThePointsNotOfTheCornersWithoutAny) {
    // A steep force along a diagonal band: the corners of the grid are extrapolated far beyond what was measured.
    std::vector<double> g, p, f;
    for (int i = 0; i < 12; ++i) {
        for (const int j : {-1, 0, 1}) {
            g.push_back(0.002 + 0.001 * i);
            p.push_back(0.01 * (i + j) - 0.05);
            f.push_back(std::exp(-200 * g.back()) + 4 * p.back() + 30 * p.back() * p.back());
        }
    }
    core::Table data;
    data.add_numbers("gap", "m", g);
    data.add_numbers("pitch", "rad", p);
    data.add_numbers("lift_force", "N", f);
    core::TemporaryFolder folder;
    ExportOptions options;
    options.max_error = 0.01;
    const auto result = export_table(ForceTable::fit(data, "lift_force"), "csv", folder.path() / "thin.csv", options);
    const auto [low, high] = std::minmax_element(f.begin(), f.end());
    EXPECT_GT(result.error, 0);
    EXPECT_LE(result.error, 0.01 * (*high - *low));
}

TEST(Exports, InTheDownFrameTurnTheirSigns) {
    core::TemporaryFolder folder;
    std::vector<double> w, f;
    for (const double v : {-0.2, -0.1, 0.05, 0.3}) {
        w.push_back(v);
        f.push_back(1 - 2 * v + v * v);
    }
    core::Table data;
    data.add_numbers("heave_velocity", "m/s", w);
    data.add_numbers("lift_force", "N", f);
    const auto table = ForceTable::fit(data, "lift_force", test::interpolation());
    ExportOptions options;
    options.frame = tables::Frame::ned;
    export_table(table, "csv", folder.path() / "ned.csv", options);
    const auto ned = ForceTable::read(folder.path() / "ned.csv", "z_force");
    for (double v = -0.25; v < 0.35; v += 0.01) {
        const double down = -v;
        EXPECT_NEAR(ned.value(&down), -table.value(&v), 1e-14);
        EXPECT_NEAR(ned.at({&down, 1}).slope[0], table.at({&v, 1}).slope[0], 1e-12);
    }
}

TEST(Exports, OnPointsTooFewForTheErrorAskedForSaySo) {
    core::TemporaryFolder folder;
    ExportOptions options;
    options.max_error = 0.001;
    options.points = {{"gap", 4}};
    const auto result = export_table(test::one_axis(), "csv", folder.path() / "t.csv", options);
    ASSERT_EQ(result.remarks.size(), 1u);
    EXPECT_THAT(result.remarks[0].message, HasSubstr("too few for the error asked for"));
    EXPECT_EQ(result.grid, (std::vector<std::size_t>{4}));
}

TEST(Exports, DoNotTouchAFileThatIsNotOurs) {
    core::TemporaryFolder folder;
    const auto path = folder.path() / "mine.h";
    core::write_file(path, "int precious;\n");
    EXPECT_THROW(export_table(test::one_axis(), "c", path), core::InputError);
    EXPECT_EQ(core::read_file(path), "int precious;\n");
    ExportOptions options;
    options.overwrite = true;
    export_table(test::one_axis(), "c", path, options);
    export_table(test::one_axis(), "c", path);  // ours now
    EXPECT_THAT(core::read_file(path), HasSubstr("Underbody"));
    // A file that only speaks of the program is none of its own, nor is the function beside a .mat.
    core::write_file(folder.path() / "mine.csv", "# measured for Underbody\ngap [mm], lift_force [N]\n1, 2\n2, 3\n");
    EXPECT_THROW(export_table(test::one_axis(), "csv", folder.path() / "mine.csv"), core::InputError);
    core::write_file(folder.path() / "lift_at.m", "disp('precious')\n");
    EXPECT_THROW(export_table(test::one_axis(), "mat", folder.path() / "lift.mat"), core::InputError);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "lift.mat"));
    EXPECT_THROW(export_table(test::one_axis(), "c", folder.path()), core::InputError);
    EXPECT_THROW(export_table(test::one_axis(), "cc", path), core::UsageError);
}

TEST(Exports, ReplaceTheirOwnFilesOfEveryFormat) {
    core::TemporaryFolder folder;
    for (const auto& format : tables::export_formats()) {
        const auto path = folder.path() / ("t" + format.ending);
        for (int i = 0; i < 2; ++i) {
            EXPECT_NO_THROW(export_table(test::two_axes(), format.name, path)) << format.name;
        }
    }
}

TEST(Exports, NeverReplaceTheFileThatTheTableWasMadeOf) {
    core::TemporaryFolder folder;
    const auto path = folder.path() / "lift.csv";
    const std::string text = "gap [mm], lift_force [N]\n1, 3\n2, 2\n4, 1\n";
    core::write_file(path, text);
    ExportOptions options;
    options.overwrite = true;
    EXPECT_THROW(export_table(ForceTable::read(path, "lift_force"), "csv", path, options), core::InputError);
    EXPECT_EQ(core::read_file(path), text);
}

}  // namespace
}  // namespace underbody
