#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>

#include "core/error.h"
#include "core/random.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/grid.h"
#include "surrogates/tables/fit/table_batch.h"
#include "tests/surrogates/tables/tables_support.h"

namespace underbody {
namespace {

using core::InputError;
using tables::FitOptions;
using tables::ForceTable;
using test::csv;
using ::testing::HasSubstr;

ForceTable monotone(const core::Table& table, const std::string& quantity = "lift_force") {
    FitOptions options;
    options.kind = FitOptions::Kind::interpolation;
    return ForceTable::fit(table, quantity, options);
}

std::string message_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

TEST(ForceTable, SplineOfRefAMatchesTheOracles) {
    const ForceTable table = test::ref_a_spline();
    const double at[] = {.005, .065, .155, .275, .75};
    const double expected[] = {-0.0021467003, -0.014388284, -0.0010682339, 0.015453207, 0.01457831};
    for (int i = 0; i < 5; ++i) {
        EXPECT_NEAR(table.value(&at[i]), expected[i], 1e-8) << at[i];
    }
    const double slope_at[] = {0, .1, .25};
    const double slopes[] = {-0.44735064, 0.14001682, 0.093303695};
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(table.at({&slope_at[i], 1}).slope[0], slopes[i], 1e-6) << slope_at[i];
    }
}

TEST(ForceTable, GoesThroughItsPointsAndNeverLeavesTheRangeOfItsCell) {
    core::Random random(20260101);
    for (int trial = 0; trial < 100; ++trial) {
        std::vector<double> x, y;
        double at = random.uniform();
        const std::size_t n = 2 + random.below(12);
        for (std::size_t i = 0; i < n; ++i) {
            x.push_back(at);
            y.push_back(random.below(3) == 0 && i > 0 ? y.back() : random.normal());
            at += std::exp(random.uniform(-6, 1));
        }
        core::Table data;
        data.add_numbers("gap", "m", x);
        data.add_numbers("lift_force", "N", y);
        const ForceTable table = monotone(data);
        for (std::size_t i = 0; i < n; ++i) {
            ASSERT_NEAR(table.value(&x[i]), y[i], 1e-14 * std::abs(y[i]) + 1e-15);
        }
        for (std::size_t i = 0; i + 1 < n; ++i) {
            double last = y[i];
            for (int j = 0; j <= 50; ++j) {
                const double u = x[i] + (x[i + 1] - x[i]) * j / 50;
                const double v = table.value(&u);
                ASSERT_LE(v, std::max(y[i], y[i + 1]) + 1e-13);
                ASSERT_GE(v, std::min(y[i], y[i + 1]) - 1e-13);
                ASSERT_GE((v - last) * (y[i + 1] - y[i]), -1e-13) << "not monotone";
                last = v;
            }
        }
    }
}

TEST(ForceTable, OfTwoAxesNeverLeavesTheRangeOfTheCornersOfItsCell) {
    core::Random random(7);
    for (int trial = 0; trial < 60; ++trial) {
        std::vector<double> x, y;
        double a = 0, b = -1;
        for (std::size_t i = 0, n = 2 + random.below(5); i < n; ++i) {
            x.push_back(a);
            a += std::exp(random.uniform(-4, 0));
        }
        for (std::size_t i = 0, n = 2 + random.below(5); i < n; ++i) {
            y.push_back(b);
            b += std::exp(random.uniform(-4, 0));
        }
        std::vector<double> z;
        const auto data = test::grid_table(x, y, [&](double, double) {
            z.push_back(random.below(3) == 0 ? 0 : random.normal());
            return z.back();
        });
        const ForceTable table = monotone(data);
        const std::size_t columns = y.size();
        for (std::size_t i = 0; i + 1 < x.size(); ++i) {
            for (std::size_t j = 0; j + 1 < columns; ++j) {
                const auto [low, high] = std::minmax({z[i * columns + j], z[i * columns + j + 1],
                                                      z[(i + 1) * columns + j], z[(i + 1) * columns + j + 1]});
                for (int k = 0; k < 144; ++k) {
                    const double p[2] = {x[i] + (x[i + 1] - x[i]) * (k % 12) / 11,
                                         y[j] + (y[j + 1] - y[j]) * (k / 12) / 11.0};
                    const double v = table.value(p);
                    ASSERT_LE(v, high + 1e-12);
                    ASSERT_GE(v, low - 1e-12);
                }
                const double corner[2] = {x[i], y[j]};
                ASSERT_NEAR(table.value(corner), z[i * columns + j], 1e-14);
            }
        }
    }
}

TEST(ForceTable, GivesManyPointsAtOnceTheSameBitsAsOneByOne) {
    const auto same = [](double a, double b) {
        return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
    };
    core::Random random(21);
    for (const bool wide : {false, true}) {
        std::vector<double> x, y;
        for (int i = 0; i < 37; ++i) {
            x.push_back(wide ? 0.001 * std::pow(300.0, i / 36.0) : 0.002 * (i + 1));
            y.push_back(-0.1 + 0.005 * i);
        }
        const ForceTable table =
            monotone(test::grid_table(x, y, [](double a, double b) { return std::sin(70 * a) + b * std::cos(9 * a); }));
        for (const std::size_t count : {0, 1, 3, 4, 127, 128, 129, 1001}) {
            std::vector<double> points, value(count), slope(2 * count);
            for (std::size_t i = 0; i < count; ++i) {
                points.push_back(random.below(10) == 0 ? x[random.below(37)] : random.uniform(-0.05, 0.4));
                points.push_back(random.below(10) == 0 ? y[random.below(37)] : random.uniform(-0.15, 0.12));
                points.back() = random.below(50) == 0 ? std::nan("") : points.back();
            }
            tables::values(table, points.data(), count, value.data(), slope.data());
            for (std::size_t i = 0; i < count; ++i) {
                double one_slope[2];
                const double one = table.value(&points[2 * i], one_slope);
                ASSERT_TRUE(same(one, value[i]));
                ASSERT_TRUE(same(one_slope[0], slope[2 * i]));
                ASSERT_TRUE(same(one_slope[1], slope[2 * i + 1]));
            }
            std::vector<double> alone(count);
            tables::values(table, points.data(), count, alone.data());
            for (std::size_t i = 0; i < count; ++i) {
                ASSERT_TRUE(same(alone[i], value[i]));
            }
        }
    }
}

TEST(ForceTable, FindsTheCellOnAxesHoweverUneven) {
    core::Random random(5);
    for (int trial = 0; trial < 40; ++trial) {
        std::vector<double> x{random.uniform(-3, 3)};
        for (std::size_t i = 0, n = 1 + random.below(40); i < n; ++i) {
            x.push_back(x.back() + std::exp(random.uniform(-12, 2)));
        }
        const tables::GridAxis axis(x);
        for (int i = 0; i < 400; ++i) {
            const double at = i < 2 * static_cast<int>(x.size())
                                  ? std::nextafter(x[i / 2], i % 2 == 0 ? x.front() : x.back())
                                  : random.uniform(x.front(), x.back());
            const std::size_t cell = axis.cell(at);
            ASSERT_LT(cell + 1, x.size());
            ASSERT_TRUE(at >= x[cell] && (at < x[cell + 1] || cell + 2 == x.size())) << at;
        }
    }
}

TEST(ForceTable, ConvergesWithTheFourthOrderOnSmoothMonotoneData) {
    const auto error = [](int n) {
        std::vector<double> x, y;
        for (int i = 0; i <= n; ++i) {
            x.push_back(0.5 + 2.0 * i / n);
            y.push_back(std::exp(-x.back()));
        }
        core::Table data;
        data.add_numbers("gap", "m", x);
        data.add_numbers("lift_force", "N", y);
        const ForceTable table = monotone(data);
        double worst = 0;
        for (int i = 0; i <= 1000; ++i) {
            const double u = 0.5 + 2.0 * i / 1000;
            worst = std::max(worst, std::abs(table.value(&u) - std::exp(-u)));
        }
        return worst;
    };
    EXPECT_GT(std::log2(error(16) / error(32)), 3.7);
    EXPECT_GT(std::log2(error(32) / error(64)), 3.8);
    const auto error2 = [](int n) {
        std::vector<double> x;
        for (int i = 0; i <= n; ++i) {
            x.push_back(0.5 + 2.0 * i / n);
        }
        const ForceTable table =
            monotone(test::grid_table(x, x, [](double a, double b) { return std::exp(-a - 0.7 * b) + a + b; }));
        double worst = 0;
        for (int i = 0; i < 10000; ++i) {
            const double p[2] = {0.5 + 0.02 * (i % 100), 0.5 + 0.02 * (i / 100)};
            worst = std::max(worst, std::abs(table.value(p) - std::exp(-p[0] - 0.7 * p[1]) - p[0] - p[1]));
        }
        return worst;
    };
    EXPECT_GT(std::log2(error2(16) / error2(32)), 3.5);
}

TEST(ForceTable, GivesSlopesThatAreTheDerivativesOfItsValue) {
    const std::vector<double> x = {0.001, 0.002, 0.005, 0.01, 0.02, 0.05};
    const std::vector<double> y = {-0.07, -0.03, 0.0, 0.03, 0.07};
    for (const auto kind : {FitOptions::Kind::interpolation, FitOptions::Kind::spline}) {
        FitOptions options;
        options.kind = kind;
        const ForceTable table = ForceTable::fit(
            test::grid_table(
                x, y, [](double h, double p) { return 0.3 + 0.001 / h * std::cos(20 * p) + 5 * p + std::sin(80 * h); }),
            "lift_force", options);
        core::Random random(3);
        for (int i = 0; i < 500; ++i) {
            double p[2] = {random.uniform(0.001, 0.05), random.uniform(-0.07, 0.07)};
            double slope[2];
            (void)table.value(p, slope);
            for (int k = 0; k < 2; ++k) {
                const double step = k == 0 ? 1e-7 : 1e-6;
                double a[2] = {p[0], p[1]}, b[2] = {p[0], p[1]};
                a[k] -= step;
                b[k] += step;
                if (a[k] < table.axes()[k].lower || b[k] > table.axes()[k].upper) {
                    continue;
                }
                const double difference = (table.value(b) - table.value(a)) / (2 * step);
                EXPECT_NEAR(slope[k], difference, 2e-3 * (1 + std::abs(difference)));
            }
        }
    }
}

TEST(ForceTable, EvaluatesThreeAndFourAxesLikeTheProductOfItsFactors) {
    // A sum of cubics in each axis and their products is in the span of the spline: it must come back exactly.
    const auto f = [](const double* p) {
        const double a = 1 + p[0] - 2 * p[0] * p[0] * p[0];
        const double b = 2 - p[1] + p[1] * p[1];
        const double c = 1 + 0.5 * p[2] - p[2] * p[2] * p[2];
        const double d = 1 - 0.3 * p[3];
        return a * b * c * d;
    };
    const std::vector<double> x[4] = {{0, .3, .5, .8, 1}, {-1, -.4, .2, 1}, {0, .25, .5, .75, 1}, {0, .5, 1, 2}};
    std::vector<double> values;
    double p[4];
    for (const double a : x[0]) {
        for (const double b : x[1]) {
            for (const double c : x[2]) {
                for (const double d : x[3]) {
                    p[0] = a, p[1] = b, p[2] = c, p[3] = d;
                    values.push_back(f(p));
                }
            }
        }
    }
    const tables::CubicGrid grid({x[0], x[1], x[2], x[3]}, values, tables::SlopeRule::not_a_knot);
    core::Random random(11);
    for (int i = 0; i < 300; ++i) {
        for (int k = 0; k < 4; ++k) {
            p[k] = random.uniform(x[k].front(), x[k].back());
        }
        double slope[4];
        EXPECT_NEAR(grid.value(p, slope), f(p), 1e-12);
        for (int k = 0; k < 4; ++k) {
            double a[4] = {p[0], p[1], p[2], p[3]}, b[4] = {p[0], p[1], p[2], p[3]};
            a[k] -= 1e-6;
            b[k] += 1e-6;
            EXPECT_NEAR(slope[k], (f(b) - f(a)) / 2e-6, 1e-7);
        }
    }
}

TEST(ForceTable, HoldsItsEndValueOutsideItsRangeAndSaysByHowMuch) {
    const ForceTable table = monotone(csv("gap [mm], lift_force [N]\n1, 3\n2, 2\n4, 1\n"));
    const double below = 0.0005, above = 0.0055;
    const auto low = table.at({&below, 1});
    EXPECT_TRUE(low.outside);
    EXPECT_DOUBLE_EQ(low.value, 3);
    EXPECT_DOUBLE_EQ(low.slope[0], 0);
    EXPECT_NEAR(low.beyond[0], -0.0005, 1e-15);
    EXPECT_GT(low.sigma, 0);
    const auto high = table.at({&above, 1});
    EXPECT_NEAR(high.value, 1, 1e-14);
    EXPECT_NEAR(high.beyond[0], 0.0015, 1e-15);
    const double inside = 0.003;
    EXPECT_FALSE(table.at({&inside, 1}).outside);
    const double nothing = std::nan("");
    EXPECT_TRUE(std::isnan(table.value(&nothing)));
}

TEST(ForceTable, RefusesOrExtrapolatesWhenToldTo) {
    FitOptions options;
    options.kind = FitOptions::Kind::interpolation;
    options.range = tables::RangePolicy::refuse;
    const auto data = csv("gap [mm], lift_force [N]\n1, 3\n2, 2\n4, 1\n");
    const double above = 0.005, further = 0.008;
    const auto refusing = ForceTable::fit(data, "lift_force", options);
    EXPECT_THAT(message_of([&] { (void)refusing.at({&above, 1}); }), HasSubstr("outside the table"));
    options.range = tables::RangePolicy::extrapolate;
    const auto going_on = ForceTable::fit(data, "lift_force", options);
    const double end = 0.004;
    const auto at_end = going_on.at({&end, 1});
    const auto beyond = going_on.at({&above, 1});
    EXPECT_NEAR(beyond.value, at_end.value + 0.001 * at_end.slope[0], 1e-12);
    EXPECT_TRUE(beyond.outside);
    EXPECT_GT(going_on.at({&further, 1}).sigma, beyond.sigma);
}

TEST(ForceTable, FollowsThePolicyOfEachAxis) {
    const auto data = test::grid_table({0.001, 0.002, 0.005, 0.01}, {-0.07, -0.02, 0.03, 0.07},
                                       [](double h, double p) { return 3e-3 / h + 5 * p * p + 0.01 * p / h; });
    FitOptions options;
    options.kind = FitOptions::Kind::interpolation;
    options.range = tables::parse_range_policies("gap=refuse,pitch=clamp");
    const auto mixed = ForceTable::fit(data, "lift_force", options);
    const double beyond_pitch[2] = {0.003, 0.1}, at_its_end[2] = {0.003, 0.07}, beyond_gap[2] = {0.02, 0};
    EXPECT_DOUBLE_EQ(mixed.at(beyond_pitch).value, mixed.at(at_its_end).value);
    EXPECT_EQ(mixed.at(beyond_pitch).slope[1], 0);
    EXPECT_TRUE(mixed.at(beyond_pitch).outside);
    EXPECT_THAT(message_of([&] { (void)mixed.at(beyond_gap); }),
                HasSubstr("gap 20 mm is outside the table, which covers 1 to 10 mm"));
    EXPECT_NO_THROW((void)mixed.value(beyond_gap)) << "the hot path holds the ends";
    options.range = tables::parse_range_policies("refuse,pitch=extrapolate");
    const auto other = ForceTable::fit(data, "lift_force", options);
    EXPECT_NEAR(other.at(beyond_pitch).value, other.at(at_its_end).value + 0.03 * other.at(at_its_end).slope[1], 1e-12);
    EXPECT_THAT(message_of([&] { (void)other.at(beyond_gap); }), HasSubstr("gap"));
}

TEST(ForceTable, HasTheSlopesOfItsValueBeyondItsEndsToo) {
    const auto data = test::grid_table({0.001, 0.002, 0.005, 0.01}, {-0.07, -0.02, 0.03, 0.07},
                                       [](double h, double p) { return 3e-3 / h + 5 * p * p + 0.01 * p / h; });
    core::Random random(4);
    for (const char* range : {"extrapolate", "gap=extrapolate,pitch=clamp", "clamp,pitch=extrapolate"}) {
        FitOptions options;
        options.kind = FitOptions::Kind::interpolation;
        options.range = tables::parse_range_policies(range);
        const auto table = ForceTable::fit(data, "lift_force", options);
        for (int i = 0; i < 400; ++i) {
            const double p[2] = {random.uniform(-0.005, 0.016), random.uniform(-0.15, 0.15)};
            const auto e = table.at(p);
            for (int k = 0; k < 2; ++k) {
                double a[2] = {p[0], p[1]}, b[2] = {p[0], p[1]};
                const double step = k == 0 ? 1e-8 : 1e-7;
                a[k] -= step;
                b[k] += step;
                const double difference = (table.at(b).value - table.at(a).value) / (2 * step);
                EXPECT_NEAR(e.slope[k], difference, 1e-4 * (1 + std::abs(difference)))
                    << range << " at " << p[0] << ", " << p[1];
            }
        }
    }
}

TEST(ForceTable, SaysWhatIsWrongWithRangePolicies) {
    const auto error_of = [](const std::string& range) {
        try {
            FitOptions options;
            options.range = tables::parse_range_policies(range);
            ForceTable::fit(csv("gap [mm], lift_force [N]\n1, 3\n2, 2\n4, 1\n"), "lift_force", options);
        } catch (const core::UsageError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_THAT(error_of("clam"), HasSubstr("clamp"));
    EXPECT_THAT(error_of("gap=hold"), HasSubstr("there is no range policy 'hold'"));
    EXPECT_THAT(error_of("gop=refuse"), HasSubstr("gap"));
    EXPECT_THAT(error_of("pitch=refuse"), HasSubstr("no axis 'pitch'"));
    EXPECT_THAT(error_of("pitch=refuse"), HasSubstr("known: gap"));
    EXPECT_THAT(error_of("clamp,refuse"), HasSubstr("twice"));
    EXPECT_THAT(error_of("gap=clamp,gap=refuse"), HasSubstr("twice"));
    EXPECT_THAT(error_of("=clamp"), HasSubstr("names no axis"));
    EXPECT_EQ(error_of(" gap = refuse , extrapolate"), "no error");
}

TEST(ForceTable, CarriesTheErrorsOfItsPoints) {
    const ForceTable table =
        monotone(csv("gap [mm], lift_force [N], lift_force_sigma [N]\n1, 3, 0.1\n2, 2, 0.2\n3, 1, 0.1\n4, 0, 0.1\n"));
    const double at = 0.002;
    EXPECT_NEAR(table.at({&at, 1}).sigma, 0.2, 1e-12);
    const auto drawn = table.drawn(5);
    EXPECT_NE(drawn.value(&at), table.value(&at));
    EXPECT_EQ(drawn.value(&at), table.drawn(5).value(&at));
    double sum = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        sum += std::pow(table.drawn(seed).value(&at) - 2, 2);
    }
    EXPECT_NEAR(std::sqrt(sum / 400), 0.2, 0.03);
}

TEST(ForceTable, DrawsWhatItsInterpolationMayMissBetweenExactPoints) {
    const ForceTable table = monotone(csv("gap [mm], lift_force [N]\n1, 3\n2, 1\n3, 2\n4, 0\n5, 2\n"));
    const double at = 0.002, between = 0.0025;
    double sum = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        const auto drawn = table.drawn(seed);
        ASSERT_NEAR(drawn.value(&at), 1, 1e-12);
        sum += std::pow(drawn.value(&between) - table.value(&between), 2);
    }
    EXPECT_GT(table.sigma(&between), 0.05);
    EXPECT_NEAR(std::sqrt(sum / 400), table.sigma(&between), 0.15 * table.sigma(&between));
}

TEST(ForceTable, FindsItsAxesAndConditions) {
    const auto data =
        csv("gap [mm], pitch [deg], speed [m/s], lift_force [N]\n1,0,0.5,1\n2,0,0.5,2\n2,1,0.5,4\n1,1,0.5,3\n");
    const ForceTable table = monotone(data);
    ASSERT_EQ(table.axes().size(), 2u);
    EXPECT_EQ(table.axes()[0].name, "gap");
    EXPECT_EQ(table.axes()[1].name, "pitch");
    ASSERT_EQ(table.conditions().size(), 1u);
    EXPECT_EQ(table.conditions()[0].first, "speed");
    const double at[2] = {0.002, 0};
    EXPECT_DOUBLE_EQ(table.value(at), 2);
}

TEST(ForceTable, SaysWhatIsWrongWithItsPoints) {
    const auto error_of = [](const std::string& text, const std::string& quantity = "lift_force") {
        return message_of([&] { monotone(csv(text), quantity); });
    };
    EXPECT_THAT(error_of("gap [mm], lift_force [N]\n1, 2\n"), HasSubstr("one point only"));
    EXPECT_THAT(error_of("gap [mm], lift_force [N]\n1, 2\n2, 3\n", "lift_forze"), HasSubstr("lift_force"));
    EXPECT_THAT(error_of("gap [mm], lift_force [N]\n1, 2\n2, 3\n1, 2.5\n"), HasSubstr("made.csv:4"));
    EXPECT_THAT(error_of("gap [mm], lift_force [N]\n1, 2\n2, 3\n1, 2.5\n"), HasSubstr("occurs twice"));
    EXPECT_THAT(error_of("gap [mm], lift_force [N], lift_force_sigma [N]\n1, 2, 0.1\n2, 3, 0\n"),
                HasSubstr("made.csv:3:3"));
    EXPECT_THAT(error_of("gap [mm], lift_force [N], lift_force_sigma [N]\n1, 2, 0.1\n2, 3, -1\n"),
                HasSubstr("positive"));
    EXPECT_THAT(error_of("gap [mm], lift_force [N]\n1, 2\n1, 2\n"), HasSubstr("no axis"));
    EXPECT_THAT(error_of("gap [mm], lift_force [N]\n1, 2\n , 3\n2, 1\n"), HasSubstr("made.csv:3:1"));
    EXPECT_THAT(error_of("gap [mm], pitch [deg], lift_force [N]\n1, 0, 1\n1, 1, 2\n2, 0, 3\n"),
                HasSubstr("gap 2 mm, pitch 1 deg"));
}

TEST(ForceTable, MergesRepeatsThatAgree) {
    const ForceTable table =
        monotone(csv("gap [mm], lift_force [N], lift_force_sigma [N]\n1, 2, 0.1\n1, 2.1, 0.1\n2, 3, 0.1\n"));
    const double at = 0.001;
    EXPECT_NEAR(table.value(&at), 2.05, 1e-12);
    EXPECT_NEAR(table.at({&at, 1}).sigma, 0.1 / std::sqrt(2), 1e-12);
    EXPECT_FALSE(table.remarks().empty());
}

}  // namespace
}  // namespace underbody
