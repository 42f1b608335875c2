// Points as people really have them: in clusters, dense along one line and sparse beside it, with errors over four
// decades, over four axes, with kinks, steep films and two regimes. The truth must lie in the band about as often as
// the band says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>

#include "core/random.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/table_batch.h"
#include "tests/surrogates/tables/tables_support.h"

namespace underbody {
namespace {

using tables::ForceTable;
using ::testing::HasSubstr;
using ::testing::Not;

using Truth = std::function<double(const std::vector<double>&)>;

/// Measured points of a known force.
struct Campaign {
    std::vector<std::string> names;
    Truth truth;
    core::Random& random;
    std::vector<std::vector<double>> x = {};
    std::vector<double> force = {}, sigma = {};

    void measure(const std::vector<double>& at, double error) {
        x.push_back(at);
        force.push_back(truth(at) + random.normal(0, error));
        sigma.push_back(error);
    }

    [[nodiscard]] ForceTable table() const {
        core::Table data;
        data.source = "campaign";
        for (std::size_t k = 0; k < names.size(); ++k) {
            std::vector<double> column;
            for (const auto& at : x) {
                column.push_back(at[k]);
            }
            data.add_numbers(names[k],
                             names[k] == "gap"     ? "m"
                             : names[k] == "pitch" ? "rad"
                             : names[k] == "speed" ? "m/s"
                                                   : "V",
                             column);
        }
        data.add_numbers("lift_force", "N", force);
        data.add_numbers("lift_force_sigma", "N", sigma);
        return ForceTable::fit(data, "lift_force");
    }
};

struct Coverage {
    int inside = 0, all = 0, far = 0;
    [[nodiscard]] double share() const { return static_cast<double>(inside) / all; }
    [[nodiscard]] double far_share() const { return static_cast<double>(far) / all; }
};

/// How often the truth lies in the 95 % band at random places among the points (gaps by their logarithm).
void judge(const Campaign& campaign, Coverage& coverage) {
    const auto table = campaign.table();
    core::Random random(99);
    for (int i = 0; i < 200; ++i) {
        std::vector<double> at;
        for (const auto& axis : table.axes()) {
            at.push_back(axis.name == "gap" ? axis.lower * std::pow(axis.upper / axis.lower, random.uniform())
                                            : random.uniform(axis.lower, axis.upper));
        }
        if (beyond_points(table, at.data()) > 0) {
            continue;
        }
        const double miss = std::abs(table.value(at.data()) - campaign.truth(at)), sigma = table.sigma(at.data());
        coverage.inside += miss <= 1.96 * sigma ? 1 : 0;
        coverage.far += miss > 4 * sigma ? 1 : 0;
        ++coverage.all;
    }
}

Coverage over_seeds(int count, const std::function<Campaign(core::Random&)>& make) {
    Coverage coverage;
    for (int seed = 0; seed < count; ++seed) {
        core::Random random(5100 + static_cast<std::uint64_t>(seed));
        judge(make(random), coverage);
    }
    std::cout << "covered " << coverage.share() << ", beyond four sigma " << coverage.far_share() << "\n";
    return coverage;
}

/// Film repulsion, two regimes and a kink in pitch.
double force_of(double h, double p) {
    return 2e-7 / (h * h) + 0.25 * std::tanh(std::log(h / 0.02) / 0.4) + 3 * std::abs(p - 0.01) / (1 + 40 * h);
}

TEST(UnusualLayouts, PointsInClusters) {
    const auto coverage = over_seeds(8, [](core::Random& random) {
        Campaign c{{"gap", "pitch"}, [](const auto& x) { return force_of(x[0], x[1]); }, random};
        for (const auto& [h, p] : {std::pair{0.002, -0.03}, {0.004, 0.03}, {0.01, 0.0}, {0.03, -0.03}, {0.06, 0.03}}) {
            for (int i = 0; i < 8; ++i) {
                c.measure({h * std::exp(random.normal(0, 0.1)), p + random.normal(0, 0.004)}, 0.005);
            }
        }
        return c;
    });
    EXPECT_GT(coverage.share(), 0.85);
    EXPECT_LT(coverage.far_share(), 0.05);
}

TEST(UnusualLayouts, OneDenseLineAndAFewPointsBesideIt) {
    const auto coverage = over_seeds(8, [](core::Random& random) {
        Campaign c{{"gap", "pitch"}, [](const auto& x) { return force_of(x[0], x[1]); }, random};
        for (int i = 0; i < 40; ++i) {
            c.measure({0.001 * std::pow(100.0, i / 39.0), 0}, 0.005);
        }
        for (int i = 0; i < 10; ++i) {
            c.measure({0.001 * std::pow(100.0, random.uniform()), random.uniform(-0.07, 0.07)}, 0.005);
        }
        return c;
    });
    EXPECT_GT(coverage.share(), 0.85);
    EXPECT_LT(coverage.far_share(), 0.05);
}

TEST(UnusualLayouts, ErrorsOverFourDecades) {
    const auto coverage = over_seeds(30, [](core::Random& random) {
        Campaign c{{"gap"}, [](const auto& x) { return force_of(x[0], 0); }, random};
        for (int i = 0; i < 30; ++i) {
            c.measure({0.001 * std::pow(100.0, i / 29.0)}, std::pow(10.0, random.uniform(-4, -0.3)));
        }
        return c;
    });
    EXPECT_GT(coverage.share(), 0.88);
    EXPECT_LT(coverage.far_share(), 0.03);
}

TEST(UnusualLayouts, SteepFilmAtSmallGaps) {
    const auto coverage = over_seeds(30, [](core::Random& random) {
        Campaign c{
            {"gap"}, [](const auto& x) { return 3e-9 / std::pow(x[0], 3) - 2e-6 / (x[0] * x[0]) + 0.1; }, random};
        for (int i = 0; i < 14; ++i) {
            const double h = 0.0002 * std::pow(300.0, i / 13.0);
            c.measure({h}, 0.002 + 0.02 * std::abs(c.truth({h})));
        }
        return c;
    });
    EXPECT_GT(coverage.share(), 0.88);
    EXPECT_LT(coverage.far_share(), 0.03);
}

TEST(UnusualLayouts, FourAxesAtOnce) {
    const auto coverage = over_seeds(4, [](core::Random& random) {
        Campaign c{{"gap", "pitch", "speed", "jet_voltage"},
                   [](const auto& x) {
                       return x[2] * x[2] * (5e-4 / x[0] + 4 * x[1] / (1 + 30 * x[0]) + 0.3) +
                              2.5e-4 * x[3] * x[3] * std::exp(-x[0] / 0.01);
                   },
                   random};
        for (int i = 0; i < 110; ++i) {
            c.measure({0.002 * std::pow(20.0, random.uniform()), random.uniform(-0.05, 0.05), random.uniform(0.3, 0.9),
                       random.uniform(4, 12)},
                      0.01);
        }
        return c;
    });
    EXPECT_GT(coverage.share(), 0.88);
    EXPECT_LT(coverage.far_share(), 0.03);
}

TEST(UnusualLayouts, ManyNoisyPointsOfOneAxisAreSmoothedCleanOnesKept) {
    core::Random random(31);
    for (const double noise : {0.05, 0.0}) {
        std::vector<double> g, f, s;
        for (int i = 0; i < 20000; ++i) {
            g.push_back(random.uniform(0.001, 0.05));
            f.push_back(5e-4 / g.back() + std::sin(60 * g.back()) + random.normal(0, noise));
            s.push_back(0.05);
        }
        core::Table data;
        data.add_numbers("gap", "m", g);
        data.add_numbers("lift_force", "N", f);
        data.add_numbers("lift_force_sigma", "N", s);
        const ForceTable table = ForceTable::fit(data, "lift_force");
        double worst = 0;
        for (int i = 0; i < 200; ++i) {
            const double at = 0.0015 + 0.048 * i / 200;
            worst = std::max(worst, std::abs(table.value(&at) - 5e-4 / at - std::sin(60 * at)));
        }
        EXPECT_EQ(table.kind(), noise > 0 ? "Gaussian process" : "monotone cubic");
        EXPECT_LT(worst, noise > 0 ? 0.02 : 1e-3) << "of forces of size 1";
    }
}

TEST(UnusualLayouts, ManyNoisyPointsOfALongNarrowGridAreJudgedOnAllItsInnerLines) {
    // 4000 gaps times 5 pitches, the pitch fastest: steps of one size through the list would meet the ends of the pitch
    // alone.
    const auto force = [](double h, double p) { return std::sin(8 * h) + 2 * p; };
    const auto noisy = [&](const std::vector<double>& pitch) {
        std::vector<double> gap;
        for (int i = 0; i < 4000; ++i) {
            gap.push_back(0.01 + i * 2.5e-4);
        }
        core::Random random(99);
        core::Table data =
            test::grid_table(gap, pitch, [&](double h, double p) { return force(h, p) + 0.05 * random.normal(); });
        data.add_numbers("lift_force_sigma", "N", std::vector<double>(data.rows(), 0.02));
        return ForceTable::fit(data, "lift_force");
    };
    const auto remarks_of = [](const ForceTable& table) {
        std::string all;
        for (const auto& remark : table.remarks()) {
            all += remark.message + "\n";
        }
        return all;
    };
    const auto table = noisy({-0.1, -0.05, 0, 0.05, 0.1});
    EXPECT_THAT(remarks_of(table), HasSubstr("Gaussian process chosen: points are missed by"));
    EXPECT_THAT(remarks_of(table), Not(HasSubstr("nan")));
    for (const double h : {0.2, 0.5, 0.8}) {
        for (const double p : {-0.08, 0.0, 0.03}) {
            const double at[2] = {h, p};
            EXPECT_NEAR(table.value(at), force(h, p), 0.02) << h << " " << p;
        }
    }
    // Between two pitches no point has neighbours on both sides.
    const auto narrow = remarks_of(noisy({-0.1, 0.1}));
    EXPECT_THAT(narrow, HasSubstr("no point lies inside the grid, so nothing can be left out"));
    EXPECT_THAT(narrow, Not(HasSubstr("nan")));
}

TEST(UnusualLayouts, TwoPointsAreNotSureOfWhatLiesBetween) {
    core::Table data;
    data.add_numbers("gap", "m", {0.005, 0.01});
    data.add_numbers("lift_force", "N", {0.09, 0.17});
    const ForceTable table = ForceTable::fit(data, "lift_force");
    const double between = 0.0075, end = 0.005;
    EXPECT_NEAR(table.sigma(&between), 0.02, 1e-12);
    EXPECT_EQ(table.sigma(&end), 0);
}

}  // namespace
}  // namespace underbody
