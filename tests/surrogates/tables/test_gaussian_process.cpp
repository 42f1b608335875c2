#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>

#include "core/error.h"
#include "core/random.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/gaussian_process.h"
#include "surrogates/tables/fit/table_batch.h"
#include "surrogates/tables/points/select.h"
#include "tests/support/support.h"
#include "tests/surrogates/tables/tables_support.h"

namespace underbody {
namespace {

using tables::FitOptions;
using tables::ForceTable;
using tables::GaussianProcess;
using tables::GpData;
using tables::GpParameters;
using tables::Kernel;
using ::testing::HasSubstr;

GpData made(std::size_t count, std::size_t axes, std::uint64_t seed) {
    core::Random random(seed);
    GpData data;
    data.axes = axes;
    data.trends = 2;
    for (std::size_t i = 0; i < count; ++i) {
        double sum = 0;
        for (std::size_t k = 0; k < axes; ++k) {
            data.x.push_back(random.uniform());
            sum += std::sin(3 * data.x.back() + static_cast<double>(k));
        }
        data.trend.insert(data.trend.end(), {1, data.x[i * axes]});
        data.noise.push_back(random.uniform(0.001, 0.01));
        data.y.push_back(sum - 1 + random.normal(0, 0.05));
    }
    return data;
}

TEST(GaussianProcess, HasTheGradientOfItsLikelihood) {
    const GpData data = made(25, 2, 3);
    for (const Kernel kernel : {Kernel::matern52, Kernel::squared_exponential}) {
        GpParameters p{{0.4, 0.8}, 1.2, 0.03};
        std::vector<double> gradient;
        GaussianProcess::log_likelihood(data, kernel, p, &gradient);
        const auto moved = [&](std::size_t i, double by) {
            GpParameters q = p;
            double& v = i < 2 ? q.length[i] : i == 2 ? q.scale : q.scatter;
            v *= std::exp(by);
            return GaussianProcess::log_likelihood(data, kernel, q, nullptr);
        };
        for (std::size_t i = 0; i < 4; ++i) {
            const double difference = (moved(i, 1e-5) - moved(i, -1e-5)) / 2e-5;
            EXPECT_NEAR(gradient[i], difference, 1e-5 * (1 + std::abs(difference))) << i;
        }
    }
}

TEST(GaussianProcess, LeavesOneOutInClosedFormAsByRefitting) {
    const GpData data = made(15, 2, 9);
    const GpParameters p{{0.5, 0.7}, 1, 0.05};
    const auto closed = GaussianProcess(data, Kernel::matern52, p).leave_one_out();
    for (std::size_t out = 0; out < data.count(); ++out) {
        GpData rest;
        rest.axes = 2;
        rest.trends = 2;
        for (std::size_t i = 0; i < data.count(); ++i) {
            if (i != out) {
                rest.x.insert(rest.x.end(), {data.x[2 * i], data.x[2 * i + 1]});
                rest.trend.insert(rest.trend.end(), {data.trend[2 * i], data.trend[2 * i + 1]});
                rest.y.push_back(data.y[i]);
                rest.noise.push_back(data.noise[i]);
            }
        }
        const GaussianProcess without(rest, Kernel::matern52, p);
        const std::span<const double> x(&data.x[2 * out], 2), h(&data.trend[2 * out], 2);
        EXPECT_NEAR(closed.mean[out], without.mean(x, h), 1e-8);
        EXPECT_NEAR(closed.variance[out], without.variance(x, h) + data.noise[out] + 0.05 * 0.05, 1e-8);
    }
}

FitOptions process() {
    FitOptions options;
    options.kind = FitOptions::Kind::gaussian_process;
    return options;
}

TEST(GaussianProcessTable, PredictsTheForcesOfAFilmAndItsSlopesFromScatteredPoints) {
    // Film force of docs/physics.md section 5.2: A3/h^3 - B2/h^2 with h* = 1.2568669 mm, minimum at 1.5 h*.
    const double h_star = 1.2568669e-3;
    const double b2 = 0.021899722 * 27 / 4 * h_star * h_star;
    const double a3 = b2 * h_star;
    core::Table data;
    std::vector<double> h, f, s;
    for (int i = 0; i < 16; ++i) {
        h.push_back(1e-3 * std::pow(20.0, i / 15.0));
        f.push_back(a3 / std::pow(h.back(), 3) - b2 / std::pow(h.back(), 2));
        s.push_back(1e-5);
    }
    data.add_numbers("gap", "m", h);
    data.add_numbers("lift_force", "N", f);
    data.add_numbers("lift_force_sigma", "N", s);
    const ForceTable table = ForceTable::fit(data, "lift_force", process());
    for (double x = 1.05e-3; x < 19e-3; x *= 1.1) {
        const double truth = a3 / std::pow(x, 3) - b2 / std::pow(x, 2);
        const double slope = -3 * a3 / std::pow(x, 4) + 2 * b2 / std::pow(x, 3);
        const auto e = table.at({&x, 1});
        EXPECT_NEAR(e.value, truth, 1e-4);
        EXPECT_NEAR(e.slope[0], slope, 0.03 * std::abs(slope) + 0.05);
        EXPECT_LT(e.sigma, 1e-3);
    }
}

TEST(GaussianProcessTable, HasSlopesThatAreTheDerivativesOfItsValueAndFollowsTheSpeedSquared) {
    core::Random random(17);
    std::vector<double> g, p, u, f;
    for (int i = 0; i < 60; ++i) {
        g.push_back(1e-3 * std::pow(100.0, random.uniform()));
        p.push_back(random.uniform(-0.05, 0.05));
        u.push_back(random.uniform(0.3, 1.0));
        f.push_back(u.back() * u.back() * (1.2 + 5e-4 / g.back() + 8 * p.back() / (1 + 30 * g.back())));
    }
    core::Table data;
    data.add_numbers("gap", "m", g);
    data.add_numbers("pitch", "rad", p);
    data.add_numbers("speed", "m/s", u);
    data.add_numbers("lift_force", "N", f);
    const ForceTable table = ForceTable::fit(data, "lift_force", process());
    EXPECT_THAT(table.remarks().back().message, HasSubstr("force over speed squared"));
    double worst = 0;
    for (int i = 0; i < 300; ++i) {
        double x[3] = {1e-3 * std::pow(100.0, random.uniform(0.03, 0.97)), random.uniform(-0.045, 0.045),
                       random.uniform(0.33, 0.97)};
        double slope[3];
        const double v = table.value(x, slope);
        worst = std::max(worst, std::abs(v - x[2] * x[2] * (1.2 + 5e-4 / x[0] + 8 * x[1] / (1 + 30 * x[0]))));
        for (int k = 0; k < 3; ++k) {
            double a[3] = {x[0], x[1], x[2]}, b[3] = {x[0], x[1], x[2]};
            const double step = k == 0 ? 1e-5 * x[0] : 1e-6;
            a[k] -= step;
            b[k] += step;
            const double difference = (table.value(b) - table.value(a)) / (2 * step);
            ASSERT_NEAR(slope[k], difference, 1e-3 * (1 + std::abs(difference)));
        }
    }
    EXPECT_LT(worst, 0.1);
}

/// A known function of axes on [0, 1], measured with noise at random places.
struct Known {
    std::size_t points;
    double noise;
    std::function<double(const double*)> f;
};

/// Share of the places between random points where the 95 % band holds the truth, over random splits of the functions
/// in turn.
double coverage(const std::vector<Known>& functions, const std::vector<std::pair<std::string, std::string>>& axes,
                int splits) {
    int inside = 0, all = 0;
    for (int split = 0; split < splits; ++split) {
        core::Random random(1000, static_cast<std::uint64_t>(split));
        const Known& known = functions[static_cast<std::size_t>(split) % functions.size()];
        std::vector<std::vector<double>> x(axes.size());
        std::vector<double> y, s;
        double at[3];
        for (std::size_t i = 0; i < known.points; ++i) {
            for (std::size_t k = 0; k < axes.size(); ++k) {
                x[k].push_back(at[k] = random.uniform());
            }
            y.push_back(known.f(at) + random.normal(0, known.noise));
            s.push_back(known.noise);
        }
        core::Table data;
        for (std::size_t k = 0; k < axes.size(); ++k) {
            data.add_numbers(axes[k].first, axes[k].second, x[k]);
        }
        data.add_numbers("lift_force", "N", y);
        data.add_numbers("lift_force_sigma", "N", s);
        const ForceTable table = ForceTable::fit(data, "lift_force", process());
        for (int i = 0; i < 25; ++i) {
            for (std::size_t k = 0; k < axes.size(); ++k) {
                at[k] = random.uniform(table.axes()[k].lower, table.axes()[k].upper);
            }
            const auto e = table.at({at, axes.size()});
            inside += std::abs(e.value - known.f(at)) <= 1.96 * e.sigma ? 1 : 0;
            ++all;
        }
    }
    return static_cast<double>(inside) / all;
}

/// All 200 splits in a long run, a share of them otherwise.
int splits(int usual) { return std::getenv("UNDERBODY_LONG_RUN") != nullptr ? 200 : usual; }

TEST(GaussianProcessTable, CoversTheTruthAsOftenAsItSaysOnOneAxis) {
    const double share = coverage(
        {{24, 0.03, [](const double* x) { return std::sin(6 * x[0]); }},
         {24, 0.03, [](const double* x) { return std::exp(-3 * x[0]) + 0.3 * x[0]; }},
         {24, 0.03, [](const double* x) { return 1 / (0.2 + x[0]) - 2 * std::exp(-20 * (x[0] - 0.5) * (x[0] - 0.5)); }},
         {12, 0.03, [](const double* x) { return x[0] * x[0] * x[0] - x[0]; }},
         {8, 0.05, [](const double* x) { return 2 * x[0]; }}},
        {{"depth", "m"}}, 200);
    std::cout << "coverage of the 95 % band, one axis: " << share << "\n";
    EXPECT_GT(share, 0.90);
    EXPECT_LT(share, 0.99);
}

TEST(GaussianProcessTable, CoversTheTruthAsOftenAsItSaysOnTwoAxes) {
    const double share = coverage({{30, 0.05, [](const double* x) { return std::sin(3 * x[0]) + std::cos(4 * x[1]); }},
                                   {30, 0.03, [](const double* x) { return std::sin(4 * x[0]) * x[1] + x[0]; }},
                                   {20, 0.02, [](const double* x) { return x[0] * x[0] + x[0] * x[1] - x[1]; }},
                                   {12, 0.05, [](const double* x) { return x[0] - 2 * x[1]; }}},
                                  {{"temperature", "K"}, {"depth", "m"}}, splits(40));
    std::cout << "coverage of the 95 % band, two axes: " << share << "\n";
    EXPECT_GT(share, 0.90);
    EXPECT_LT(share, 0.99);
}

TEST(GaussianProcessTable, CoversTheTruthAsOftenAsItSaysOnThreeAxes) {
    const double share = coverage(
        {{60, 0.1,
          [](const double* x) {
              return std::sin(4 * x[0]) + 0.7 * std::pow(std::sin(3 * x[1]), 2) + 0.3 * x[2] * std::sin(4 * x[0]);
          }},
         {40, 0.05, [](const double* x) { return std::sin(3 * x[0] * x[1]) + std::exp(-2 * x[2]); }}},
        {{"temperature", "K"}, {"depth", "m"}, {"pitch_rate", "rad/s"}}, splits(10));
    std::cout << "coverage of the 95 % band, three axes: " << share << "\n";
    EXPECT_GT(share, 0.90);
    EXPECT_LT(share, 0.99);
}

TEST(GaussianProcessTable, DrawsFromItsJointPosterior) {
    core::Random random(31);
    std::vector<double> x, y, s;
    for (int i = 0; i < 14; ++i) {
        x.push_back(i < 7 ? 0.05 * i : 0.65 + 0.05 * (i - 7));  // nothing known between 0.3 and 0.65
        y.push_back(std::sin(5 * x.back()) + random.normal(0, 0.05));
        s.push_back(0.05);
    }
    core::Table data;
    data.add_numbers("depth", "m", x);
    data.add_numbers("lift_force", "N", y);
    data.add_numbers("lift_force_sigma", "N", s);
    const ForceTable table = ForceTable::fit(data, "lift_force", process());
    const double at[4] = {0.15, 0.48, 0.50, 0.85};
    const int draws = 600;
    double mean[4] = {}, product[4][4] = {};
    for (int draw = 0; draw < draws; ++draw) {
        const auto drawn = table.drawn(static_cast<std::uint64_t>(draw));
        double deviation[4];
        for (int i = 0; i < 4; ++i) {
            deviation[i] = drawn.value(&at[i]) - table.value(&at[i]);
            mean[i] += deviation[i] / draws;
        }
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 4; ++j) {
                product[i][j] += deviation[i] * deviation[j] / draws;
            }
        }
    }
    for (int i = 0; i < 4; ++i) {
        const double sigma = table.sigma(&at[i]);
        EXPECT_NEAR(mean[i], 0, 0.2 * sigma);
        EXPECT_NEAR(std::sqrt(product[i][i]), sigma, 0.15 * sigma) << at[i];
    }
    const auto correlation = [&](int i, int j) { return product[i][j] / std::sqrt(product[i][i] * product[j][j]); };
    EXPECT_GT(correlation(1, 2), 0.95) << "neighbours in the gap of the points move together";
    EXPECT_LT(std::abs(correlation(0, 3)), 0.4) << "places that points keep apart do not";
    EXPECT_GT(table.sigma(&at[1]), 2 * table.sigma(&at[0]));
}

TEST(GaussianProcessTable, KnowsTheHullOfItsPoints) {
    core::Random random(12);
    std::vector<double> p, d, f;
    for (int i = 0; i < 40; ++i) {  // a triangle: depth below 1 - temperature
        const double a = random.uniform(), b = random.uniform();
        p.push_back(std::min(a, b));
        d.push_back(1 - std::max(a, b));
        f.push_back(p.back() + 2 * d.back());
    }
    p.insert(p.end(), {0, 1, 0});
    d.insert(d.end(), {0, 0, 1});
    f.insert(f.end(), {0, 1, 2});
    core::Table data;
    data.add_numbers("temperature", "K", p);
    data.add_numbers("depth", "m", d);
    data.add_numbers("lift_force", "N", f);
    const ForceTable table = ForceTable::fit(data, "lift_force");
    const double inside[2] = {0.3, 0.4}, edge[2] = {0.5, 0.5}, corner[2] = {1, 1};
    EXPECT_EQ(tables::beyond_points(table, inside), 0);
    EXPECT_NEAR(tables::beyond_points(table, edge), 0, 1e-9);
    EXPECT_NEAR(tables::beyond_points(table, corner), std::sqrt(0.5), 1e-9);
    EXPECT_FALSE(table.at(corner).outside) << "no axis is exceeded";
    const auto figure = tables::map_figure(table, "temperature", "depth");
    const auto blank = std::count_if(figure.maps[0].values.begin(), figure.maps[0].values.end(),
                                     [](double v) { return std::isnan(v); });
    EXPECT_NEAR(static_cast<double>(blank) / static_cast<double>(figure.maps[0].values.size()), 0.5, 0.05);
    EXPECT_THAT(figure.caption, HasSubstr("outside the points"));
}

TEST(GaussianProcessTable, MapsOverTheGapHaveCellsOfOneRatio) {
    std::vector<double> gap, pitch, lift;
    for (const double h : {0.001, 0.002, 0.005, 0.02, 0.1}) {
        for (const double p : {-0.05, 0.0, 0.05}) {
            gap.push_back(h);
            pitch.push_back(p);
            lift.push_back(std::log(h) + p);
        }
    }
    core::Table data;
    data.add_numbers("gap", "m", gap);
    data.add_numbers("pitch", "rad", pitch);
    data.add_numbers("lift_force", "N", lift);
    const ForceTable table = ForceTable::fit(data, "lift_force");
    const auto figure = tables::map_figure(table, "gap", "pitch");
    const core::FigureMap& map = figure.maps.at(0);
    ASSERT_TRUE(figure.x.logarithmic && map.x_by_ratio);
    EXPECT_FALSE(figure.y.logarithmic || map.y_by_ratio);
    for (const std::size_t i : {std::size_t{0}, map.columns / 3, map.columns - 1}) {
        const double h = 0.001 * std::pow(100.0, (static_cast<double>(i) + 0.5) / static_cast<double>(map.columns));
        for (const std::size_t j : {std::size_t{0}, map.rows - 1}) {
            const double p = -0.05 + 0.1 * (static_cast<double>(j) + 0.5) / static_cast<double>(map.rows);
            EXPECT_NEAR(map.values[j * map.columns + i], table.at(std::array{h, p}).value, 1e-12);
        }
    }
}

TEST(GaussianProcessTable, FindsTheFreeStreamValueThatTheForceDecaysTo) {
    core::Random random(3);
    std::vector<double> h, p, f, s;
    for (int i = 0; i < 50; ++i) {
        h.push_back(0.002 * std::pow(200.0, random.uniform()));
        p.push_back(random.uniform(-0.05, 0.05));
        f.push_back(0.25 + (4e-4 + 0.02 * p.back()) / h.back() + random.normal(0, 0.004));
        s.push_back(0.004);
    }
    core::Table data;
    data.add_numbers("gap", "m", h);
    data.add_numbers("pitch", "rad", p);
    data.add_numbers("lift_force", "N", f);
    data.add_numbers("lift_force_sigma", "N", s);
    const ForceTable table = ForceTable::fit(data, "lift_force");
    EXPECT_THAT(table.remarks().back().message, HasSubstr("decay to the free-stream value"));
    const std::string& words = table.remarks().back().message;
    const std::size_t at = words.find("free-stream value 0") + 18;
    EXPECT_NEAR(std::stod(words.substr(at)), 0.25, 0.06) << words;
    const double far[2] = {0.39, 0};
    EXPECT_NEAR(table.value(far), 0.251, 0.01);
}

/// Each set point left out in turn: how often the rest predicts it within so many stated errors.
double share_within(double sigmas, const core::Table& points, const std::string& quantity,
                    const std::vector<std::string>& axes, FitOptions::Kind kind, bool say = false) {
    int inside = 0, all = 0;
    FitOptions options;
    options.axes = axes;
    options.kind = kind;
    for (std::size_t out = 0; out < points.rows(); ++out) {
        std::vector<std::size_t> rest;
        for (std::size_t i = 0; i < points.rows(); ++i) {
            if (i != out) {
                rest.push_back(i);
            }
        }
        const ForceTable table = ForceTable::fit(points.selected(rest), quantity, options);
        std::vector<double> at;
        for (const auto& axis : axes) {
            at.push_back(points.numbers(axis)[out]);
        }
        const auto e = table.at(at);
        const double truth = points.numbers(quantity)[out];
        if (!e.outside) {  // beyond the last point nothing can be promised: it is flagged
            inside += std::abs(e.value - truth) <= sigmas * e.sigma ? 1 : 0;
            ++all;
        }
        if (say) {
            std::cout << quantity << " at " << at[0] << ": " << truth << " predicted " << e.value << " +- " << e.sigma
                      << (e.outside ? " outside" : "") << "\n";
        }
    }
    return static_cast<double>(inside) / all;
}

TEST(GaussianProcessTable, PredictsHeldOutGapsOfTheSharedCfd) {
    UNDERBODY_NEEDS_SHARED("cfd/forces.csv");
    const auto all = core::read_csv(test::shared_folder() / "cfd/forces.csv");
    const auto level = tables::selected_rows(all, "variant=ellipse, mesh=medium, pitch=0, speed=0.5");
    const auto front = tables::selected_rows(all, "variant=ellipse_front, mesh=medium, pitch=0, speed=0.5");
    const auto pitched = tables::selected_rows(all, "variant=ellipse, mesh=medium, speed=0.5");
    const bool say = std::getenv("UNDERBODY_SAY") != nullptr;
    const auto share = [&](double sigmas, const std::vector<core::Table>& sets, const std::vector<std::string>& axes,
                           FitOptions::Kind kind) {
        double sum = 0, count = 0;
        for (const auto& points : sets) {
            for (const char* quantity : {"lift_force", "drag_force", "pitch_moment"}) {
                sum += share_within(sigmas, points, quantity, axes, kind, say);
                ++count;
            }
        }
        return sum / count;
    };
    // Meant are 68 %; eleven left-out points a quantity leave their own chance.
    const double gaps = share(1, {level, front}, {"gap"}, FitOptions::Kind::automatic);
    const double gaps_by_process = share(1, {level, front}, {"gap"}, FitOptions::Kind::gaussian_process);
    const double gaps_within_two = share(2, {level, front}, {"gap"}, FitOptions::Kind::gaussian_process);
    // Scattered gaps and pitches: what is left to miss is a cliff that one point alone shows (3 mm, 2 degrees nose
    // down: 0.41 N where the rest says -0.2 N).
    const double pitches = share(1, {pitched}, {"gap", "pitch"}, FitOptions::Kind::automatic);
    std::cout << "held-out gaps within the stated error: " << gaps << ", by Gaussian process " << gaps_by_process
              << " (within twice " << gaps_within_two << "), over gap and pitch " << pitches << "\n";
    EXPECT_GE(gaps, 0.58);
    EXPECT_LE(gaps, 0.78);
    EXPECT_GE(gaps_by_process, 0.60);
    EXPECT_LE(gaps_by_process, 0.80);
    EXPECT_GE(gaps_within_two, 0.90);
    EXPECT_GE(pitches, 0.58);
    EXPECT_LE(pitches, 0.78);
}

TEST(GaussianProcessTable, RefusesPointsThatCannotTellTheAxesApart) {
    const auto error = [](const std::string& text) {
        try {
            ForceTable::fit(test::csv(text), "lift_force");
        } catch (const core::InputError& e) {
            return std::string(e.what());
        }
        return std::string("no error");
    };
    EXPECT_THAT(error("gap [mm], pitch [deg], lift_force [N]\n1,1,1\n2,2,2\n3,3,3\n4,4,2\n5,5,1\n"),
                HasSubstr("lie on a line"));
    EXPECT_THAT(error("gap [mm], pitch [deg], lift_force [N]\n1,1,1\n2,2,2\n3,5,3\n"), HasSubstr("too few"));
}

TEST(GaussianProcessTable, TakesAGridWithMissingCornersAndSaysSo) {
    std::string text = "gap [mm], pitch [deg], lift_force [N]\n";
    for (int g = 1; g <= 5; ++g) {
        for (int p = -2; p <= 2; ++p) {
            if (!(g == 1 && p == -2) && !(g == 5 && p == 2)) {
                text += std::to_string(g) + "," + std::to_string(p) + "," + std::to_string(1.0 / g + 0.1 * p) + "\n";
            }
        }
    }
    const ForceTable table = ForceTable::fit(test::csv(text), "lift_force");
    EXPECT_EQ(table.kind(), "Gaussian process");
    std::string remarks;
    for (const auto& r : table.remarks()) {
        remarks += r.message + "\n";
    }
    EXPECT_THAT(remarks, HasSubstr("lacks 2 of 25"));
    EXPECT_THAT(remarks, HasSubstr("gap 1 mm, pitch -2 deg"));
    const double corner[2] = {0.001, -2 * M_PI / 180};
    EXPECT_NEAR(table.value(corner), 0.8, 0.1);
}

TEST(GaussianProcessTable, ChoosesByLeavingOneOutAndSaysSo) {
    core::Random random(4);
    std::vector<double> g, f, s;
    for (int i = 0; i < 40; ++i) {
        g.push_back(0.01 + 0.002 * i);
        f.push_back(std::sin(40 * g.back()) + random.normal(0, 0.1));
        s.push_back(0.1);
    }
    core::Table data;
    data.add_numbers("gap", "m", g);
    data.add_numbers("lift_force", "N", f);
    data.add_numbers("lift_force_sigma", "N", s);
    const ForceTable noisy = ForceTable::fit(data, "lift_force");
    EXPECT_EQ(noisy.kind(), "Gaussian process");
    EXPECT_THAT(noisy.remarks().back().message, HasSubstr("leave-one-out error"));
    const ForceTable exact = ForceTable::fit(test::ref_a(), "lift_force");
    EXPECT_EQ(exact.kind(), "monotone cubic");
}

TEST(GaussianProcessTable, ThinsAMillionPointsAndSaysSo) {
    core::Random random(8);
    std::vector<double> g, p, f;
    for (int i = 0; i < 1000000; ++i) {
        g.push_back(random.uniform(0.01, 0.03));
        p.push_back(random.uniform(-0.05, 0.05));
        f.push_back(std::sin(100 * g.back()) + 3 * p.back() + random.normal(0, 0.05));
    }
    core::Table data;
    data.add_numbers("gap", "m", g);
    data.add_numbers("pitch", "rad", p);
    data.add_numbers("lift_force", "N", f);
    const auto begin = std::chrono::steady_clock::now();
    const ForceTable table = ForceTable::fit(data, "lift_force");
    std::cout << "a million points: " << std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()
              << " s\n";
    const double at[2] = {0.02, 0.01};
    EXPECT_NEAR(table.value(at), std::sin(2.0) + 0.03, 0.02);
}

}  // namespace
}  // namespace underbody
