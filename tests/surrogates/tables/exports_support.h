// Tables that the tests of the exports use, points in and out of their range, and what an evaluator must give there.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "surrogates/tables/exports/export.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/sampled.h"
#include "tests/surrogates/tables/tables_support.h"

namespace underbody::test {

inline core::Table with_sigma(core::Table table, double sigma) {
    table.add_numbers("lift_force_sigma", "N", std::vector<double>(table.rows(), sigma));
    return table;
}

/// `range` as the command line takes it: "clamp", "gap=refuse,pitch=extrapolate", ...
inline tables::FitOptions interpolation(const std::string& range = "clamp") {
    tables::FitOptions options;
    options.kind = tables::FitOptions::Kind::interpolation;
    options.range = tables::parse_range_policies(range);
    return options;
}

inline tables::ForceTable one_axis(const std::string& range = "clamp") {
    return tables::ForceTable::fit(with_sigma(ref_a(), 2e-4), "lift_force", interpolation(range));
}

inline tables::ForceTable two_axes(const std::string& range = "clamp") {
    std::vector<double> gap, pitch;
    for (int i = 0; i < 24; ++i) {
        gap.push_back(0.001 * std::pow(100.0, i / 23.0));
    }
    for (int i = -6; i <= 6; ++i) {
        pitch.push_back(i * 0.012);
    }
    return tables::ForceTable::fit(
        with_sigma(
            grid_table(gap, pitch,
                       [](double h, double p) { return 3e-4 / h + 4 * p / (1 + 40 * h) + 0.3 * std::sin(9 * h); }),
            0.01),
        "lift_force", interpolation(range));
}

inline tables::ForceTable three_axes(const std::string& range = "clamp") {
    std::vector<double> g, p, u, f;
    for (const double a : {0.001, 0.003, 0.01, 0.05}) {
        for (const double b : {-0.05, 0.0, 0.05}) {
            for (const double c : {0.3, 0.5, 0.9}) {
                g.push_back(a);
                p.push_back(b);
                u.push_back(c);
                f.push_back(c * c * (1e-3 / a + 3 * b) + std::cos(100 * a));
            }
        }
    }
    core::Table table;
    table.source = "three";
    table.add_numbers("gap", "m", g);
    table.add_numbers("pitch", "rad", p);
    table.add_numbers("speed", "m/s", u);
    table.add_numbers("lift_force", "N", f);
    return tables::ForceTable::fit(table, "lift_force", interpolation(range));
}

/// Scattered points along a diagonal band: the corners of the box of their axes have no data.
inline tables::ForceTable band(const std::string& range = "clamp") {
    std::vector<double> g, p, f;
    for (int i = 0; i < 12; ++i) {
        for (const int j : {-1, 0, 1}) {
            g.push_back(0.002 + 0.001 * i);
            p.push_back(0.01 * (i + j) - 0.05);
            f.push_back(std::exp(-200 * g.back()) + 4 * p.back() + 30 * p.back() * p.back());
        }
    }
    core::Table data;
    data.source = "band";
    data.add_numbers("gap", "m", g);
    data.add_numbers("pitch", "rad", p);
    data.add_numbers("lift_force", "N", f);
    tables::FitOptions options;
    options.range = tables::parse_range_policies(range);
    return tables::ForceTable::fit(data, "lift_force", options);
}

/// A sum of two tables, one of which ends earlier: from there on it holds its value, the sum goes on changing and
/// counts as outside.
inline tables::ForceTable sum_of_tables(const std::string& range = "clamp",
                                        const std::string& quantity = "lift_force") {
    const auto long_one = two_axes(),
               short_one = tables::ForceTable::fit(csv("gap [m], lift_force [N], lift_force_sigma [N]\n.002, .5, "
                                                       ".02\n.01, .2, .01\n.03, .1, .01\n.05, .3, .03\n"),
                                                   "lift_force", interpolation());
    tables::SampledFunction sum;
    sum.quantity = quantity;
    sum.unit = "N";
    sum.kind = "force of a model";
    sum.source = "sum";
    const auto policies = tables::parse_range_policies(range);
    sum.axes = {{"gap", "m", 0.002, 0.05, policies.of("gap"), long_one.knots(0), {0.002, 0.05}},
                {"pitch",
                 "rad",
                 long_one.axes()[1].lower,
                 long_one.axes()[1].upper,
                 policies.of("pitch"),
                 long_one.knots(1),
                 {}}};
    sum.axes[0].lines.insert(sum.axes[0].lines.end(), {0.002, 0.01, 0.03, 0.05});
    std::sort(sum.axes[0].lines.begin(), sum.axes[0].lines.end());
    const double sign = quantity == "lift_force" ? 1 : -0.3;
    sum.value = [=](const double* p) { return sign * (long_one.value(p) + short_one.value(p)); };
    sum.sigma = [=](const double* p) { return std::abs(sign) * std::hypot(long_one.sigma(p), short_one.sigma(p)); };
    sum.points = long_one.points();
    if (quantity != "lift_force") {
        sum.points.add_numbers(quantity, "N", sum.points.numbers("lift_force"));
    }
    return tables::sampled_table(sum);
}

/// One to three axes under each policy and under mixtures of them; empty corners; a grid that reaches further than the
/// range.
inline std::vector<tables::ForceTable> tables_of_all_policies() {
    return {one_axis(),
            one_axis("extrapolate"),
            one_axis("refuse"),
            two_axes(),
            two_axes("extrapolate"),
            two_axes("gap=refuse,pitch=clamp"),
            two_axes("extrapolate,gap=clamp"),
            two_axes("gap=extrapolate,pitch=refuse"),
            three_axes(),
            three_axes("gap=extrapolate,pitch=clamp,speed=refuse"),
            three_axes("extrapolate,speed=clamp"),
            band(),
            band("gap=refuse,pitch=extrapolate"),
            sum_of_tables(),
            sum_of_tables("gap=refuse,pitch=clamp")};
}

/// Random points, a third of the coordinates drawn from a range three times as wide.
inline std::vector<double> random_points(const tables::ForceTable& table, std::size_t count, bool as_float = false) {
    core::Random random(1234);
    std::vector<double> points;
    for (std::size_t i = 0; i < count; ++i) {
        for (const auto& axis : table.axes()) {
            const double span = axis.upper - axis.lower;
            const bool inside = random.below(3) != 0;
            double x =
                inside ? random.uniform(axis.lower, axis.upper) : random.uniform(axis.lower - span, axis.upper + span);
            if (random.below(20) == 0) {
                x = axis.points[random.below(axis.points.size())];
            }
            points.push_back(as_float ? static_cast<double>(static_cast<float>(x)) : x);
        }
    }
    return points;
}

/// What the table says, and whether it refuses to.
struct Expected {
    tables::Evaluation at;
    bool refused = false;
};

inline Expected expected(const tables::ForceTable& table, const double* point) {
    Expected result;
    try {
        result.at = table.at({point, table.axes().size()});
    } catch (const core::InputError&) {
        result.refused = true;
        result.at.outside = true;
        result.at.no_data = true;
        result.at.sigma = table.sigma(point);
        result.at.value = std::nan("");
        result.at.slope.fill(std::nan(""));
    }
    return result;
}

/// How large values, errors and slopes are over the points: what rounding is measured by.
struct Sizes {
    double value = 0;
    double sigma = 0;
    double slope[tables::max_axes] = {};

    Sizes(const tables::ForceTable& table, const std::vector<double>& points) {
        const std::size_t n = table.axes().size();
        for (std::size_t i = 0; i < points.size(); i += n) {
            const Expected e = expected(table, &points[i]);
            value = e.refused ? value : std::max(value, std::abs(e.at.value));
            sigma = std::max(sigma, e.at.sigma);
            for (std::size_t k = 0; k < n && !e.refused; ++k) {
                slope[k] = std::max(slope[k], std::abs(e.at.slope[k]));
            }
        }
    }
};

/// Does a coordinate lie in one of the narrow cells that stand for a kink?
inline bool at_a_kink(const tables::ForceTable& table, std::size_t k, double x) {
    const auto& lines = table.knots(k);
    const auto above = std::upper_bound(lines.begin(), lines.end(), x);
    return above != lines.begin() && above != lines.end() &&
           *above - *(above - 1) < 1e-6 * (lines.back() - lines.front());
}

/// One evaluation by a consumer, as `value, slope..., sigma, outside, no_data`, is that of the table to `tolerance` of
/// its size (slopes to ten times that, but along an axis at a kink, where they are differences of nearly equal
/// numbers).
inline void expect_alike(const tables::ForceTable& table, const double* point, const Sizes& sizes, double tolerance,
                         double value, const double* slope, double sigma, bool outside, bool no_data) {
    const Expected e = expected(table, point);
    const std::size_t n = table.axes().size();
    EXPECT_NEAR(sigma, e.at.sigma, tolerance * sizes.sigma);
    EXPECT_EQ(outside, e.at.outside);
    EXPECT_EQ(no_data, e.at.no_data);
    if (e.refused) {
        EXPECT_TRUE(std::isnan(value));
    } else {
        EXPECT_NEAR(value, e.at.value, tolerance * sizes.value);
    }
    for (std::size_t k = 0; k < n && slope != nullptr; ++k) {
        if (e.refused) {
            EXPECT_TRUE(std::isnan(slope[k]));
        } else if (!at_a_kink(table, k, point[k])) {
            EXPECT_NEAR(slope[k], e.at.slope[k], 10 * tolerance * sizes.slope[k]);
        }
    }
    if (::testing::Test::HasFailure()) {
        std::string where;
        for (std::size_t k = 0; k < n; ++k) {
            where += table.axes()[k].name + " = " + std::to_string(point[k]) + " (" + to_string(table.axes()[k].range) +
                     ") ";
        }
        FAIL() << "at " << where;
    }
}

inline bool have(const std::string& program) {
    return std::system(("command -v " + program + " > /dev/null 2>&1").c_str()) == 0;
}

inline std::vector<double> read_doubles(const std::filesystem::path& path) {
    const std::string bytes = core::read_file(path);
    std::vector<double> numbers(bytes.size() / sizeof(double));
    std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
    return numbers;
}

inline void write_doubles(const std::filesystem::path& path, const std::vector<double>& numbers) {
    core::write_file(path, {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)});
}

}  // namespace underbody::test
