// Numbers of whole curves: closed forms, tables of the same forces, curves drawn one by one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "core/angle.h"
#include "core/error.h"
#include "core/random.h"
#include "surrogates/tables/analysis/equilibria.h"
#include "surrogates/tables/analysis/pitch.h"
#include "surrogates/tables/fit/fit.h"
#include "surrogates/tables/search/curve_forces.h"
#include "surrogates/tables/search/design_search.h"
#include "surrogates/tables/search/sampling.h"

namespace {

using namespace underbody;
using namespace underbody::tables;

using core::degree;

std::vector<double> evenly(double lower, double upper, std::size_t count) {
    std::vector<double> x;
    for (std::size_t i = 0; i < count; ++i) {
        x.push_back(lower + (upper - lower) * static_cast<double>(i) / static_cast<double>(count - 1));
    }
    return x;
}

using OfGapAndPitch = std::function<double(double gap, double pitch)>;

CurveForces forces(std::vector<double> gaps, std::vector<double> pitches, const OfGapAndPitch& lift,
                   const OfGapAndPitch& moment = {}) {
    CurveForces f{std::move(gaps), std::move(pitches), {}, {}};
    for (const double pitch : f.pitches) {
        for (const double gap : f.gaps) {
            if (lift) {
                f.lift.push_back(lift(gap, pitch));
            }
            if (moment) {
                f.moment.push_back(moment(gap, pitch));
            }
        }
    }
    return f;
}

CurveAsked a_kick(double net_weight, double mass) {
    CurveAsked asked;
    asked.net_weight = net_weight;
    asked.virtual_mass = mass;
    return asked;
}

CurveAsked a_window(double about = 0) {
    CurveAsked asked;
    asked.curve = Curve::pitch_window;
    asked.about = about;
    asked.moment = "pitch_moment";
    return asked;
}

/// Stable at 3 mm, unstable at 7 mm: between them lies a (u - s)^3 / 6 of work.
TEST(Curves, AKickIsTheWorkUpToTheUnstableBalance) {
    constexpr double a = 2e4, stable = 3e-3, unstable = 7e-3, weight = 0.3, mass = 3.9;
    const auto gaps = evenly(2e-3, 9e-3, 25);
    const auto lift = [&](double h, double) { return weight + a * (h - stable) * (h - unstable); };
    const CurveNumber kick = curve_number(a_kick(weight, mass), forces(gaps, {0}, lift));
    EXPECT_NEAR(kick.value, std::sqrt(2 * a * std::pow(unstable - stable, 3) / 6 / mass), 1e-10);
    EXPECT_FALSE(kick.at_least);

    // Lift that lacks nowhere, by so much at its lowest: minus the velocity of that force over the whole range.
    const double lowest = a * std::pow(0.5 * (unstable - stable), 2), more = lowest + 0.02;
    const auto lifted = [&](double h, double pitch) { return lift(h, pitch) + more; };
    EXPECT_NEAR(curve_number(a_kick(weight, mass), forces(gaps, {0}, lifted)).value, -std::sqrt(2 * 0.02 * 7e-3 / mass),
                1e-9);
    // Continuous where the two balances meet and are gone.
    for (const double side : {-1.0, 1.0}) {
        const auto nearly = [&](double h, double pitch) { return lift(h, pitch) + lowest * (1 + side * 1e-10); };
        EXPECT_NEAR(curve_number(a_kick(weight, mass), forces(gaps, {0}, nearly)).value, 0, 2e-6);
    }
    // Unstable alone.
    const auto rising = [&](double h, double) { return weight + 5 * (h - 4e-3); };
    EXPECT_NEAR(curve_number(a_kick(weight, mass), forces(gaps, {0}, rising)).value,
                -std::sqrt(2 * 5 * 2e-3 * 7e-3 / mass), 1e-9);
}

TEST(Curves, AKickThatTheRangeCutsSaysSo) {
    constexpr double k = 40, at = 4e-3, weight = 0.2, mass = 4;
    const auto falling = [&](double h, double) { return weight - k * (h - at); };
    const CurveNumber kick = curve_number(a_kick(weight, mass), forces(evenly(3e-3, 10e-3, 25), {0}, falling));
    EXPECT_NEAR(kick.value, 1e-3 * std::sqrt(k / mass), 1e-10);  // to the lower end
    EXPECT_TRUE(kick.at_least);
}

TEST(Curves, AWindowAtAGapIsWhereTheMomentRestores) {
    constexpr double b = 0.3, edge = 2.3 * degree;
    const auto moment = [&](double, double p) { return 0.01 - b * p + b * p * p * p / (3 * edge * edge); };
    CurveAsked asked = a_window();
    asked.restoring = true;
    CurveNumber window = curve_number(asked, forces({0}, evenly(-4 * degree, 5 * degree, 17), {}, moment));
    EXPECT_NEAR(window.value, edge, 2e-3 * edge);
    EXPECT_FALSE(window.at_least);
    // About another pitch the nearer edge counts; outside, the way back.
    asked.about = 1.5 * degree;
    window = curve_number(asked, forces({0}, evenly(-4 * degree, 5 * degree, 17), {}, moment));
    EXPECT_NEAR(window.value, 0.8 * degree, 5e-3 * degree);
    asked.about = -3 * degree;
    window = curve_number(asked, forces({0}, evenly(-4 * degree, 5 * degree, 17), {}, moment));
    EXPECT_LT(window.value, 0);
    EXPECT_GE(window.value, -0.7 * degree * (1 + 5e-3));  // no more than the way to where it does
    // A narrower range cuts it.
    asked.about = 0;
    window = curve_number(asked, forces({0}, evenly(-1 * degree, 2 * degree, 17), {}, moment));
    EXPECT_NEAR(window.value, 1 * degree, 1e-12);
    EXPECT_TRUE(window.at_least);
    // Nowhere: by as much of the pitches as lacks.
    const auto unstable = [&](double, double p) { return b * p; };
    window = curve_number(asked, forces({0}, evenly(-1 * degree, 2 * degree, 17), {}, unstable));
    EXPECT_NEAR(window.value, -3 * degree * (b * 3 * degree), 1e-9);
    // A moment that may not be larger.
    asked.restoring = false;
    asked.most_moment = 0.01;
    window = curve_number(asked, forces({0}, evenly(-4 * degree, 4 * degree, 17), {}, unstable));
    EXPECT_NEAR(window.value, 0.01 / b, 1e-9);
}

TEST(Curves, AWindowWithAWeightIsWhereABalanceIs) {
    constexpr double weight = 0.3, a = 2e4, stable = 3e-3, unstable = 7e-3, edge = 3.1 * degree;
    const double lowest = a * std::pow(0.5 * (unstable - stable), 2);
    // The two balances meet at the edge.
    const auto lift = [&](double h, double p) {
        return weight + a * (h - stable) * (h - unstable) + lowest * std::pow(p / edge, 2);
    };
    CurveAsked asked = a_window();
    asked.net_weight = weight;
    const auto gaps = evenly(2e-3, 9e-3, 13), pitches = evenly(-4 * degree, 4 * degree, 9);
    CurveNumber window = curve_number(asked, forces(gaps, pitches, lift));
    EXPECT_NEAR(window.value, edge, 2e-3 * edge);
    EXPECT_FALSE(window.at_least);
    // The balance leaves the range of gaps: nobody knows whether it goes on there.
    constexpr double per_degree = 0.5e-3;
    const auto moving = [&](double h, double p) { return weight - 30 * (h - 4e-3 - per_degree * p / degree); };
    window = curve_number(asked, forces(evenly(3e-3, 9e-3, 13), pitches, moving));
    EXPECT_NEAR(window.value, 2 * degree, 1e-3 * degree);
    EXPECT_TRUE(window.at_least);
    // The moment restores along the balance, not at a gap: dM/dp + dM/dh dh/dp.
    asked.restoring = true;
    const auto moment = [&](double h, double p) { return 0.2 * p - 30 * (h - 4e-3); };
    CurveAsked at_a_gap = asked;
    at_a_gap.net_weight.reset();
    EXPECT_LT(curve_number(at_a_gap, forces({4e-3}, pitches, {}, moment)).value, 0);
    EXPECT_NEAR(curve_number(asked, forces(evenly(3e-3, 9e-3, 13), pitches, moving, moment)).value, 2 * degree,
                1e-3 * degree);
}

/// The stable equilibria of a fine table of a force over 2 to 10 mm, 0.1 N of weight and 3 kg.
std::vector<Equilibrium> balances(const std::function<double(double)>& lift) {
    core::Table points;
    std::vector<double> values;
    const auto fine = evenly(2e-3, 1e-2, 161);
    std::transform(fine.begin(), fine.end(), std::back_inserter(values), lift);
    points.add_numbers("gap", "m", fine);
    points.add_numbers("lift_force", "N", values);
    EquilibriumOptions options;
    options.net_weight = 0.1;
    options.virtual_mass = 3;
    auto found = equilibria(ForceTable::fit(points, "lift_force"), options).all;
    std::erase_if(found, [](const Equilibrium& e) { return e.stability != Stability::stable; });
    return found;
}

std::vector<double> stable_gaps(const std::function<double(double)>& lift) {
    std::vector<double> gaps;
    for (const Equilibrium& e : balances(lift)) {
        gaps.push_back(e.gap);
    }
    return gaps;
}

/// Random curves: what a kick says is what the equilibria of a table of the same points say; up to its edge a window
/// holds everywhere, and beyond it does not.
TEST(Curves, RandomOnesHoldWhatTheySay) {
    core::Random random(20);
    int kicks = 0, windows = 0, ended = 0;
    for (int trial = 0; trial < 60; ++trial) {
        std::vector<double> c;
        for (int i = 0; i < 6; ++i) {
            c.push_back(random.normal());
        }
        const auto wave = [&](double u, double v) {
            return c[0] * std::sin(4 * u + c[1]) + 0.6 * c[2] * std::sin(3 * v + c[3]) + 0.4 * c[4] * u * v +
                   0.3 * c[5];
        };
        const auto lift = [&](double h, double p) { return wave((h - 2e-3) / 8e-3, p / (4 * degree)); };
        const auto gaps = evenly(2e-3, 1e-2, 33);
        const CurveNumber kick = curve_number(a_kick(0.1, 3), forces(gaps, {0}, lift));
        double largest = -1;
        for (const Equilibrium& e : balances([&](double h) { return lift(h, 0); })) {
            largest = std::max(largest, e.kick_velocity);
        }
        if (largest > 0) {
            ++kicks;
            EXPECT_NEAR(kick.value, largest, 2e-3 * largest + 1e-6);
        } else {
            EXPECT_LE(kick.value, 0);
        }

        CurveAsked asked = a_window();
        asked.net_weight = 0.1;
        asked.most_moment = 0.7;
        const auto moment = [&](double h, double p) { return wave(0.5 + p / (4 * degree), h / 1e-2); };
        const auto pitches = evenly(-4 * degree, 4 * degree, 33);
        const CurveNumber window = curve_number(asked, forces(gaps, pitches, lift, moment));
        // By the equilibria of a table at that pitch, and the moment at their gaps.
        const auto holds = [&](double p, double most) {
            const auto stable = stable_gaps([&](double h) { return lift(h, p); });
            return std::pair{stable.size(), std::any_of(stable.begin(), stable.end(),
                                                        [&](double h) { return std::abs(moment(h, p)) <= most; })};
        };
        if (window.value > 0.1 * degree) {
            ++windows;
            for (double p = -0.98 * window.value; p <= 0.98 * window.value; p += 0.05 * window.value) {
                EXPECT_TRUE(holds(p, 1.01 * asked.most_moment).second)
                    << trial << " " << p / degree << " of " << window.value / degree;
            }
            const double beyond = window.value + 0.2 * degree;  // on one side it ends there
            const auto [fewer, down] = holds(-beyond, asked.most_moment);
            const auto [few, up] = holds(beyond, asked.most_moment);
            if (!window.at_least && few <= 1 && fewer <= 1) {
                ++ended;
                EXPECT_FALSE(up && down) << trial << " " << window.value / degree;
            }
        }
    }
    EXPECT_GT(ended, 5);
    EXPECT_GT(kicks, 15);
    EXPECT_GT(windows, 8);
}

/// Surrogates of a lift whose two balances lie apart by what the shape says, and of a moment.
struct Learned {
    std::vector<SearchVariable> shape = {{"protrusion.height", "m", 0, 4e-3}, {"body.base_cut", "1", 0.6, 0.9}};
    static constexpr double weight = 0.3, mass = 3.9, a = 2e4;
    static double apart(double height, double cut) {
        return 4e-3 * (1 - std::pow((cut - 0.7) / 0.3, 2)) - 0.4 * height;
    }
    static double lift(double height, double cut, double gap, double pitch) {
        const double middle = 5.5e-3, half = 0.5 * apart(height, cut);
        return weight + a * (std::pow(gap - middle, 2) - std::copysign(half * half, half)) + 0.3 * pitch;
    }
    static double moment(double height, double cut, double gap, double pitch) {
        return (-0.2 + 30 * height) * pitch + 60 * std::pow(pitch, 3) * (1 + cut) + 0.4 * (gap - 5e-3);
    }

    [[nodiscard]] std::vector<SearchVariable> all() const {
        std::vector<SearchVariable> v = shape;
        v.push_back({"gap", "m", 2e-3, 9e-3, true, false});
        v.push_back({"pitch", "rad", -3 * degree, 3 * degree, false, false});
        return v;
    }
    [[nodiscard]] std::map<std::string, Surrogate> surrogates(double sigma) const {
        std::vector<SearchRun> lifts, moments;
        core::Random random(6);
        for (const std::vector<double>& u : sobol_plan(16, 2, 3)) {
            for (const double gap : {2e-3, 3.5e-3, 5.5e-3, 9e-3}) {
                for (const double pitch : {-3.0, 0.0, 3.0}) {
                    const std::vector<double> at = {shape[0].unscaled(u[0]), shape[1].unscaled(u[1]), gap,
                                                    pitch * degree};
                    lifts.push_back({at, 0, lift(at[0], at[1], at[2], at[3]) + sigma * random.normal(), sigma});
                    moments.push_back(
                        {at, 0, moment(at[0], at[1], at[2], at[3]) + 0.02 * sigma * random.normal(), 0.02 * sigma});
                }
            }
        }
        std::map<std::string, Surrogate> result;
        result.emplace("lift_force", Surrogate::fit("lift_force", "N", all(), lifts));
        result.emplace("pitch_moment", Surrogate::fit("pitch_moment", "N m", all(), moments));
        return result;
    }
};

Response kick_response() {
    return {"kick", "lift_force", {{"pitch", 0}}, "", 0, a_kick(Learned::weight, Learned::mass)};
}
Response window_response() {
    CurveAsked asked = a_window();
    asked.net_weight = Learned::weight;
    asked.restoring = true;
    asked.most_moment = 0.02;
    return {"window", "lift_force", {}, "", 0, asked};
}
Response window_at_a_gap() {
    CurveAsked asked = a_window();
    asked.restoring = true;
    return {"at a gap", "pitch_moment", {{"gap", 5e-3}}, "", 0, asked};
}

DesignSearch search_for(std::vector<Objective> objectives, std::vector<Limit> limits, double sigma = 2e-3) {
    const Learned learned;
    return {{learned.shape, std::move(objectives), std::move(limits), {}}, learned.surrogates(sigma)};
}

TEST(Curves, ValuesAlongACurveAreThoseOfPoints) {
    const Learned learned;
    const Surrogate surrogate = learned.surrogates(2e-3).at("lift_force");
    std::vector<std::vector<double>> points;
    for (const std::vector<double>& u : sobol_plan(7, 2, 4)) {
        points.push_back({1e-3, 0.7, learned.all()[2].unscaled(u[0]), learned.all()[3].unscaled(u[1])});
    }
    const SurrogateCurve curve = surrogate.along(points, Surrogate::With::slopes);
    const SurrogateCurve errors = surrogate.along(points, Surrogate::With::covariance);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const SurrogatePrediction p = surrogate.at(points[i], true);
        EXPECT_NEAR(curve.value[i], p.value, 1e-10);
        EXPECT_NEAR(std::sqrt(errors.covariance[i * 7 + i]), p.sigma, 1e-8);
        for (std::size_t v = 0; v < 4; ++v) {
            EXPECT_NEAR(curve.slope[i * 4 + v], p.slope[v], 1e-9 * (1 + std::abs(p.slope[v])));
        }
    }
}

TEST(Curves, OfSurrogatesAreThoseOfATableOfTheSameForces) {
    const DesignSearch search = search_for({{kick_response(), Objective::Sense::maximise}}, {});
    const Learned learned;
    const auto surrogates = learned.surrogates(2e-3);
    for (const std::vector<double>& u : sobol_plan(12, 2, 9)) {
        const std::vector<double> x = {learned.shape[0].unscaled(u[0]), learned.shape[1].unscaled(u[1])};
        core::Table points;
        std::vector<double> gaps, lift;
        for (int i = 0; i <= 60; ++i) {
            gaps.push_back(learned.all()[2].unscaled(i / 60.0));
            lift.push_back(surrogates.at("lift_force").at(std::vector<double>{x[0], x[1], gaps.back(), 0}).value);
        }
        points.add_numbers("gap", "m", gaps);
        points.add_numbers("lift_force", "N", lift);
        EquilibriumOptions options;
        options.net_weight = Learned::weight;
        options.virtual_mass = Learned::mass;
        const auto found = equilibria(ForceTable::fit(points, "lift_force"), options);
        double largest = 0;
        for (const Equilibrium& e : found.all) {
            largest = e.stability == Stability::stable ? std::max(largest, e.kick_velocity) : largest;
        }
        const double kick = search.evaluate(kick_response(), x).value;
        EXPECT_NEAR(std::max(0.0, kick), largest, 2e-3 * largest) << x[0] << " " << x[1];
        const double apart = std::max(0.0, Learned::apart(x[0], x[1]));
        EXPECT_NEAR(std::max(0.0, kick), std::sqrt(2 * Learned::a * std::pow(apart, 3) / 6 / Learned::mass), 4e-3);
    }
}

/// Derivatives against differences of the values themselves, away from kinks.
TEST(Curves, SlopesAreTheDerivatives) {
    const DesignSearch search = search_for({{kick_response(), Objective::Sense::maximise}}, {});
    const Learned learned;
    for (const Response& response : {kick_response(), window_response(), window_at_a_gap()}) {
        for (const std::vector<double>& at : {std::vector<double>{1e-3, 0.68}, {2.2e-3, 0.75}, {3.9e-3, 0.89}}) {
            const ResponseSlopes slopes = search.slopes(response, at);
            const ResponseValue here = search.evaluate(response, at);
            EXPECT_EQ(slopes.value.value, here.value);
            EXPECT_EQ(slopes.value.sigma, here.sigma);
            for (std::size_t v = 0; v < 2; ++v) {
                const double range = learned.shape[v].upper - learned.shape[v].lower, step = 7e-4 * range;
                auto above = at, below = at;
                above[v] += step;
                below[v] -= step;
                const auto rate = [&](double ResponseValue::*of) {
                    return (search.evaluate(response, above).*of - search.evaluate(response, below).*of) / (2 * step);
                };
                EXPECT_NEAR(slopes.by_value[v] * range, rate(&ResponseValue::value) * range,
                            2e-3 * (std::abs(here.value) + std::abs(slopes.by_value[v]) * range))
                    << response.name << " " << at[0] << " " << v;
                EXPECT_NEAR(slopes.by_sigma[v] * range, rate(&ResponseValue::sigma) * range,
                            0.1 * (here.sigma + std::abs(slopes.by_sigma[v]) * range))
                    << response.name << " " << at[0] << " " << v;
            }
        }
    }
}

/// The stated error beside that of four thousand curves drawn one by one, each whole.
TEST(Curves, ErrorsAreThoseOfCurvesDrawnWhole) {
    const Learned learned;
    const DesignSearch search = search_for({{kick_response(), Objective::Sense::maximise}}, {}, 0.02);
    const Surrogate lift = learned.surrogates(0.02).at("lift_force");
    for (const std::vector<double>& at : {std::vector<double>{0.5e-3, 0.7}, {2e-3, 0.8}, {3.9e-3, 0.89}}) {
        const auto gaps = [&] {
            std::vector<double> x;
            for (int i = 0; i <= 20; ++i) {
                x.push_back(learned.all()[2].unscaled(i / 20.0));
            }
            return x;
        }();
        std::vector<std::vector<double>> points;
        for (const double gap : gaps) {
            points.push_back({at[0], at[1], gap, 0});
        }
        const SurrogateCurve curve = lift.along(points, Surrogate::With::covariance);
        const auto n = static_cast<Eigen::Index>(gaps.size());
        Eigen::MatrixXd c = Eigen::Map<const Eigen::MatrixXd>(curve.covariance.data(), n, n);
        c.diagonal().array() += 1e-9 * c.diagonal().mean();
        const Eigen::MatrixXd root = c.llt().matrixL();
        CurveForces f{gaps, {0}, curve.value, {}};
        const double value = curve_number(a_kick(Learned::weight, Learned::mass), f).value;
        core::Random random(11);
        double square = 0;
        constexpr int draws = 4000;
        for (int d = 0; d < draws; ++d) {
            Eigen::VectorXd z(n);
            for (Eigen::Index i = 0; i < n; ++i) {
                z(i) = random.normal();
            }
            const Eigen::VectorXd moved = root * z;
            for (std::size_t i = 0; i < gaps.size(); ++i) {
                f.lift[i] = curve.value[i] + moved(static_cast<Eigen::Index>(i));
            }
            square += std::pow(curve_number(a_kick(Learned::weight, Learned::mass), f).value - value, 2) / draws;
        }
        const ResponseValue stated = search.evaluate(kick_response(), at);
        EXPECT_NEAR(stated.value, value, 2e-3 * std::abs(value) + 1e-5);
        EXPECT_NEAR(stated.sigma / std::sqrt(square), 1, 0.15) << at[0];
    }
}

/// From shapes most of which have no balance at all to the one that survives most, under a limit on a window.
TEST(Curves, ASearchFollowsThem) {
    const auto wide = search_for({{kick_response(), Objective::Sense::maximise}}, {});
    auto best = wide.optimum(1, 1);
    ASSERT_TRUE(best);
    EXPECT_NEAR(best->at[0], 0, 2e-4);
    EXPECT_NEAR(best->at[1], 0.7, 0.02);
    const auto limited =
        search_for({{kick_response(), Objective::Sense::minimise}}, {{kick_response(), 0.005, core::no_limit}});
    best = limited.optimum(1, 1);
    ASSERT_TRUE(best);
    EXPECT_NEAR(best->limits[0].value - best->limits[0].sigma, 0.005, 1e-6);
    const auto front =
        search_for({{kick_response(), Objective::Sense::maximise}, {window_at_a_gap(), Objective::Sense::maximise}}, {})
            .pareto_front(6, 1, 1);
    EXPECT_GE(front.size(), 1U);
    DesignSearch::NextOptions options;
    options.count = 2;
    options.solved = {{3e-3, 0.65}};
    const auto next = wide.next_designs(options);
    ASSERT_EQ(next.size(), 2U);
    EXPECT_GT(wide.evaluate(kick_response(), next[0].at).value, wide.evaluate(kick_response(), {{3e-3, 0.65}}).value);
    EXPECT_GT(next[0].sigma_now, next[0].sigma_after);
    EXPECT_EQ(wide.unit_of(kick_response()), "m/s");
    EXPECT_EQ(wide.unit_of(window_response()), "rad");
    const auto numbers = table(wide, {*best});
    EXPECT_NE(numbers.find("kick_at_least"), nullptr);
}

TEST(Curves, WhatTheRunsDoNotVaryIsSaid) {
    const auto refused = [](Response response, const std::string& words) {
        try {
            (void)search_for({{std::move(response), Objective::Sense::maximise}}, {});
            FAIL() << words;
        } catch (const core::InputError& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr(words));
        }
    };
    Response response = kick_response();
    response.conditions.clear();
    refused(response, "does not say at which pitch");
    response = window_at_a_gap();
    response.curve->moment = "roll_moment";
    refused(response, "of which there is no surrogate");
}

}  // namespace
