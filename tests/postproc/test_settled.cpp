// The verdict on a solution, from what its solver leaves beside it.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <tuple>

#include "core/file.h"
#include "core/text.h"
#include "postproc/field/beside.h"
#include "postproc/importers/reports/reports.h"
#include "postproc/loads/settled.h"
#include "tests/support/support.h"

namespace underbody::postproc {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// Values with the correlation phi^lag about a mean.
std::vector<double> correlated(std::size_t count, double phi, double mean, std::mt19937& random) {
    std::normal_distribution<double> normal;
    std::vector<double> values;
    double x = normal(random);
    for (std::size_t i = 0; i < count; ++i) {
        values.push_back(mean + x);
        x = phi * x + std::sqrt(1 - phi * phi) * normal(random);
    }
    return values;
}

TEST(MeanInTimeTest, KnowsTheCorrelationOfItsValues) {
    std::mt19937 random(7);
    for (const double phi : {0.0, 0.5, 0.9}) {
        const double expected = (1 + phi) / (1 - phi);  // of a first-order autoregression
        EXPECT_NEAR(mean_in_time(correlated(200000, phi, 3, random)).correlation_time, expected, 0.08 * expected)
            << phi;
        int within = 0;
        constexpr int runs = 400;
        for (int i = 0; i < runs; ++i) {
            const MeanInTime result = mean_in_time(correlated(2000, phi, 3, random));
            within += std::abs(result.mean - 3) <= result.error ? 1 : 0;
        }
        EXPECT_GE(within, 0.60 * runs) << phi;
        EXPECT_LE(within, 0.76 * runs) << phi;
    }
}

// A campaign of hundreds: where a third of the histories that stand still are said to drift, nobody reads the verdict.
TEST(IterationScatterTest, CallsFewOfThoseThatStandStillDriftingAndEveryRamp) {
    std::mt19937 random(11);
    for (const auto& [count, phi, most] : {std::tuple{60, 0.0, 0.04},
                                           {60, 0.5, 0.10},
                                           {60, 0.9, 0.22},
                                           {150, 0.5, 0.06},
                                           {150, 0.9, 0.11},
                                           {400, 0.0, 0.02},
                                           {400, 0.9, 0.06},
                                           {2000, 0.9, 0.06}}) {
        int drifting = 0, missed = 0;
        constexpr int runs = 200;
        for (int i = 0; i < runs; ++i) {
            auto values = correlated(static_cast<std::size_t>(count), phi, 0, random);
            for (double& v : values) {
                v = 100 + 0.3 * v;  // 0.3 % of scatter
            }
            drifting += iteration_scatter(values).settled ? 0 : 1;  // 26 to 41 % of 60 and 150 before
            for (int k = 0; k < count; ++k) {
                values[static_cast<std::size_t>(k)] += 5.0 * k / count;
            }
            missed += iteration_scatter(values).settled ? 1 : 0;
        }
        EXPECT_LE(drifting, most * runs) << count << " values, correlation " << phi;
        EXPECT_EQ(missed, 0) << count << " values, correlation " << phi;
    }
}

TEST(MeanInTimeTest, OfAWholeNumberOfCyclesIsExactAndOfAConstantWithoutError) {
    std::vector<double> wave;
    for (int i = 0; i < 400; ++i) {
        wave.push_back(2 + std::sin(2 * M_PI * i / 40));
    }
    const MeanInTime result = mean_in_time(wave);
    EXPECT_NEAR(result.mean, 2, 1e-12);
    EXPECT_NEAR(result.deviation, std::sqrt(0.5), 0.01);
    EXPECT_GT(result.error, 0.0);
    const std::vector<double> constant(20, 1.5);
    EXPECT_EQ(mean_in_time(constant).error, 0);
    EXPECT_THROW((void)mean_in_time(std::vector<double>{1}), core::InputError);
    EXPECT_THROW((void)mean_in_time(std::vector<double>{1, std::nan(""), 2}), core::InputError);
}

class SettledTest : public testing::Test {
protected:
    core::TemporaryFolder folder;
    core::Problems notes;
    LoadsResult body() {
        LoadsResult result;
        result.named.lift_force = -3;
        result.named.drag_force = 1;
        result.total.force = {-1, 0, -3};
        result.area = 0.04;
        result.forward = {1, 0, 0};
        result.up = {0, 0, 1};
        result.starboard = {0, -1, 0};
        return result;
    }
    void put(const std::string& name, const std::string& text) { core::write_file(folder.path() / name, text); }
    void monitor(const std::string& name, const std::string& column, int count,
                 const std::function<double(int)>& value) {
        std::string text = "\"" + column + "\"\n\"Iteration\" \"" + column + "\"\n(\"Iteration\" \"" + column + "\")\n";
        for (int i = 1; i <= count; ++i) {
            text += std::to_string(i) + " " + core::format_number(value(i)) + "\n";
        }
        put(name, text);
    }
    Settled judged(const LoadsResult& result) { return settled_by(result, {}, folder.path() / "case.cas.h5", notes); }
    void residuals(double last) {
        std::string text = "  iter  continuity  x-velocity  time/iter\n";
        for (int i = 1; i <= 100; ++i) {
            const double r = std::pow(last, i / 100.0);
            text += "  " + std::to_string(i) + "  " + core::format_number(r, 5) + "  " +
                    core::format_number(r / 10, 5) + "  0:00:01  " + std::to_string(100 - i) + "\n";
        }
        put("case.trn", text);
    }
};

TEST_F(SettledTest, NothingBesideTheFileIsUnknown) {
    const Settled nothing = judged(body());
    EXPECT_EQ(nothing.verdict, SettledVerdict::unknown);
    EXPECT_THAT(nothing.why, HasSubstr("no history"));
}

TEST_F(SettledTest, AMonitorCountsByItsShareWhateverItsUnit) {
    // A coefficient, of half the body, of the other sign.
    monitor("lift-rfile.out", "lift", 200, [](int i) { return 0.25 * (1 + 0.01 * std::sin(i * 1.7)); });
    const Settled steady = judged(body());
    EXPECT_EQ(steady.verdict, SettledVerdict::settled) << steady.why;
    ASSERT_EQ(steady.loads.size(), 1U);
    EXPECT_EQ(steady.loads[0].quantity, "lift_force");
    EXPECT_NEAR(steady.loads[0].sigma, 3 * 0.01 / std::sqrt(2.0), 0.002);
    EXPECT_THAT(steady.why, HasSubstr("lift_force scatters by 0.67"));  // 0.0212 N of 3.16 N
    nlohmann::json json = steady;
    EXPECT_EQ(json["verdict"], "settled");
    EXPECT_EQ(json["loads"]["lift_force"]["settled"], true);
    EXPECT_NEAR(json["loads"]["lift_force"]["sigma"].get<double>(), 0.0212, 0.002);
}

TEST_F(SettledTest, ADragThatJumpsByHalfHasNotSettled) {
    monitor("case-drag.out", "drag", 30, [](int i) { return i % 3 == 0 ? 1.5 : 0.8; });
    const Settled jumping = judged(body());
    EXPECT_EQ(jumping.verdict, SettledVerdict::not_settled) << jumping.why;
    EXPECT_THAT(jumping.why, HasSubstr("drag_force scatters by"));
    EXPECT_GT(jumping.loads.at(0).sigma, 0.2);
    const nlohmann::json json = jumping;  // its word and that of the load are one
    EXPECT_EQ(json["verdict"], "not settled");
    EXPECT_EQ(json["loads"]["drag_force"]["settled"], false);
    EXPECT_EQ(json["loads"]["drag_force"]["stationary"], true);
    EXPECT_THAT(json["loads"]["drag_force"]["why_not"].get<std::string>(), HasSubstr("scatters by"));
}

TEST_F(SettledTest, ACoefficientThatSwingsAboutZeroIsNoForceInNewton) {
    // The lift of -3 N is the coefficient's -0.1 at the last iteration: it swings by two thirds of the force of 3.16 N.
    // In newton it would be a fiftieth.
    const auto swing = [](double end) { return [end](int i) { return 0.1 * std::sin(0.7 * (i - 200) + end); }; };
    monitor("case-cl.out", "cl", 200, swing(-M_PI / 2));
    const Settled swinging = judged(body());
    EXPECT_EQ(swinging.verdict, SettledVerdict::not_settled) << swinging.why;
    EXPECT_THAT(swinging.why, HasSubstr("lift_force scatters by"));
    ASSERT_EQ(swinging.loads.size(), 1U);
    EXPECT_NEAR(swinging.loads[0].sigma, 3 / std::sqrt(2.0), 0.3);
    // At its zero it shows no unit: alone it says nothing, beside a drag coefficient it has that one's.
    monitor("case-cl.out", "cl", 200, swing(0.001));
    const Settled unknown = judged(body());
    EXPECT_EQ(unknown.verdict, SettledVerdict::unknown) << unknown.why;
    EXPECT_THAT(unknown.why, HasSubstr("lift_force swings about zero in a unit that nothing"));
    monitor("case-cd.out", "cd", 200, [](int) { return 0.1 / 3; });
    const Settled beside = judged(body());
    EXPECT_EQ(beside.verdict, SettledVerdict::not_settled) << beside.why;
    EXPECT_THAT(beside.why, HasSubstr("lift_force scatters by"));
    // A side force that is nought but for rounding is none either way.
    put("case-cl.out", "\"Iteration\" \"cl\"\n");
    monitor("case-side.out", "side", 200, [](int i) { return 1e-9 * std::sin(i * 1.3); });
    EXPECT_EQ(judged(body()).verdict, SettledVerdict::settled) << judged(body()).why;
}

TEST_F(SettledTest, ADriftOrAShortHistoryIsSaid) {
    monitor("case-lift.out", "lift", 100, [](int i) { return -3.0 + 0.004 * i; });
    EXPECT_EQ(judged(body()).verdict, SettledVerdict::not_settled);
    EXPECT_THAT(judged(body()).why, HasSubstr("lift_force drifts by"));
    monitor("case-lift.out", "lift", 5, [](int) { return -3.0; });
    EXPECT_EQ(judged(body()).verdict, SettledVerdict::unknown);
    EXPECT_THAT(judged(body()).why, HasSubstr("too short"));
    put("case-lift.out", "\"lift\"\n\"Iteration\" \"lift\"\n(\"Iteration\" \"lift\")\n1 -3\n2 -3e9\n3 nan\n");
    EXPECT_EQ(judged(body()).verdict, SettledVerdict::not_settled);
    EXPECT_THAT(judged(body()).why, HasSubstr("not finite"));
}

TEST_F(SettledTest, ResidualsAloneSayItWhenTheyAreLow) {
    residuals(1e-5);
    const Settled low = judged(body());
    EXPECT_EQ(low.verdict, SettledVerdict::settled) << low.why;
    EXPECT_THAT(low.why, HasSubstr("its scatter is not known"));
    EXPECT_NEAR(low.residuals.at(0).decades, 5, 0.1);
    residuals(0.02);
    EXPECT_EQ(judged(body()).verdict, SettledVerdict::not_settled);
    EXPECT_THAT(judged(body()).why, HasSubstr("residual of continuity is 0.02"));
    // A load that is still weighs more than a residual that has stalled, but not one that never fell.
    monitor("case-lift.out", "lift", 100, [](int) { return -3.0; });
    EXPECT_EQ(judged(body()).verdict, SettledVerdict::settled) << judged(body()).why;
    residuals(0.5);
    EXPECT_EQ(judged(body()).verdict, SettledVerdict::not_settled);
}

TEST_F(SettledTest, OtherCasesOfTheFolderHaveTheirOwnHistories) {
    put("case.cas.h5", "x");
    put("case-coarse.csv", "x");
    monitor("case-coarse-lift.out", "lift", 100, [](int i) { return 0.1 * i; });
    monitor("lift.out", "lift", 100, [](int i) { return 0.1 * i; });  // whose?
    EXPECT_EQ(judged(body()).verdict, SettledVerdict::unknown);
    EXPECT_THAT(histories_beside(folder.path() / "case-coarse.csv"),
                ElementsAre(folder.path() / "case-coarse-lift.out"));
    fs::remove(folder.path() / "case-coarse.csv");
    EXPECT_EQ(judged(body()).verdict, SettledVerdict::not_settled);
}

TEST_F(SettledTest, HistoriesCountUpToTheTimeOfTheField) {
    monitor("case-lift.out", "lift", 200, [](int i) { return i <= 100 ? -3.0 : -3.0 + 0.1 * (i - 100); });
    LoadsResult early = body();
    early.time = 100;
    EXPECT_EQ(judged(early).verdict, SettledVerdict::settled) << judged(early).why;
    early.time = 200;
    EXPECT_EQ(judged(early).verdict, SettledVerdict::not_settled);
}

TEST_F(SettledTest, ResidualsOfAnOpenFoamLogAreReadByTime) {
    std::string log = "/* OpenFOAM */\n";
    for (int i = 1; i <= 30; ++i) {
        const std::string r = core::format_number(std::pow(10, -i / 10.0), 6);
        log += "\nTime = " + std::to_string(i) + "\n\nsmoothSolver:  Solving for Ux, Initial residual = " + r +
               ", Final residual = 1e-9, No Iterations 3\n" + "GAMG:  Solving for p, Initial residual = " + r +
               ", Final residual = 1e-9, No Iterations 3\nGAMG:  Solving for p, Initial residual = 1e-8, Final "
               "residual = 1e-9, No Iterations 1\n" +
               "ExecutionTime = 1 s  ClockTime = 1 s\n";
    }
    put("log.simpleFoam", log);
    const Monitor monitor = read_monitor(folder.path() / "log.simpleFoam");
    EXPECT_THAT(monitor.columns, ElementsAre("Iteration", "Ux", "p"));
    EXPECT_EQ(monitor.title, "residuals");
    ASSERT_EQ(monitor.values[0].size(), 30U);
    EXPECT_NEAR(monitor.values[2].back(), 1e-3, 1e-8);  // the first pressure equation of the step
    EXPECT_TRUE(report_kinds(folder.path() / "log.simpleFoam").monitor);
}

TEST(SettledSamples, RealTranscriptsAreJudged) {
    UNDERBODY_NEEDS_SHARED("samples/fluent_ascii_reports");
    core::Problems notes;
    std::size_t judged = 0;
    for (const auto& entry :
         fs::recursive_directory_iterator(test::shared_folder() / "samples" / "fluent_ascii_reports")) {
        if (!entry.is_regular_file()) {
            continue;
        }
        const core::TemporaryFolder folder;
        fs::copy(entry.path(), folder.path() / ("case" + entry.path().extension().string()));
        const Settled settled = settled_by({}, {}, folder.path() / "case.cas", notes);
        judged += settled.verdict != SettledVerdict::unknown ? 1 : 0;
        for (const auto& level : settled.residuals) {
            EXPECT_TRUE(level.last >= 0 || std::isnan(level.last)) << entry.path();
        }
    }
    EXPECT_GT(judged, 0U);
}

}  // namespace
}  // namespace underbody::postproc
