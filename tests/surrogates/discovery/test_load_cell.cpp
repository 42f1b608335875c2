// A load cell's log against the force that was put into it.
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "surrogates/discovery/static/load_cell.h"

using namespace underbody;
using namespace underbody::discovery;

namespace {

struct Log {
    std::vector<double> time, gap, voltage, direction, force;

    void block(double h, double v, double way, double value, double drift, double noise, core::Random& random,
               int rows = 100) {
        for (int k = 0; k < rows; ++k) {
            const double t = time.empty() ? 0 : time.back() + 0.2;
            time.push_back(t);
            gap.push_back(h);
            voltage.push_back(v);
            direction.push_back(way);
            force.push_back(0.49 + value + drift * t + noise * random.normal());
        }
    }
    [[nodiscard]] core::Table table() const {
        core::Table log;
        log.source = "log.csv";
        log.add_numbers("time", "s", time);
        log.add_numbers("gap", "m", gap);
        log.add_numbers("jet_voltage", "V", voltage);
        log.add_numbers("approach_direction", "1", direction);
        log.add_numbers("lift_force", "N", force);
        return log;
    }
};

double lift(double h, double v) { return (0.02 - 0.3 * h) * v * v / 100; }

Log measured(double drift, double noise, double friction, std::uint64_t seed) {
    Log log;
    core::Random random(seed);
    for (const double way : {1.0, -1.0}) {
        for (const double h : {0.005, 0.02, 0.1}) {
            log.block(h, 0, way, 0, drift, noise, random);
            for (const double v : {6.0, 10.0}) {
                log.block(h, v, way, lift(h, v) + friction * way, drift, noise, random);
            }
            log.block(h, 0, way, 0, drift, noise, random);
        }
    }
    return log;
}

}  // namespace

TEST(LoadCell, TakesPreloadAndALinearDriftOutExactlyWhenThereIsNoNoise) {
    const LoadCellReduction reduction = reduce_load_cell(measured(1e-5, 0, 0, 1).table());
    ASSERT_EQ(reduction.table.rows(), 12U);
    for (std::size_t i = 0; i < 12; ++i) {
        EXPECT_NEAR(reduction.table.numbers("lift_force")[i],
                    lift(reduction.table.numbers("gap")[i], reduction.table.numbers("jet_voltage")[i]), 1e-12);
    }
    EXPECT_NEAR(reduction.drift_rate, 1e-5, 1e-9);
    EXPECT_NEAR(reduction.friction, 0, 1e-12);
}

TEST(LoadCell, StatesSigmasThatTheErrorsKeep) {
    double square = 0;
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        const LoadCellReduction reduction = reduce_load_cell(measured(1e-5, 1e-3, 0, seed).table());
        EXPECT_NEAR(reduction.noise, 1e-3, 2e-4);
        for (std::size_t i = 0; i < reduction.table.rows(); ++i) {
            const double error = reduction.table.numbers("lift_force")[i] -
                                 lift(reduction.table.numbers("gap")[i], reduction.table.numbers("jet_voltage")[i]);
            square += std::pow(error / reduction.table.numbers("lift_force_sigma")[i], 2);
            ++count;
        }
    }
    EXPECT_NEAR(square / count, 1, 0.35);
}

TEST(LoadCell, FindsTheFrictionOfTheSlideBetweenTheTwoWays) {
    const LoadCellReduction reduction = reduce_load_cell(measured(0, 1e-4, 2e-3, 4).table());
    // two readings at +f and -f: their standard deviation is f sqrt 2
    EXPECT_NEAR(reduction.friction, 2e-3 * std::sqrt(2.0), 2e-4);
    EXPECT_NEAR(reduction.hysteresis, 2e-3, 1e-4);
    EXPECT_NE(reduction_text(reduction).find("hysteresis of the slide +-2"), std::string::npos)
        << reduction_text(reduction);
    EXPECT_GT(reduction.table.numbers("lift_force_sigma")[0], 2e-3);
}

TEST(LoadCell, CanTakeTheThrustOfTheFreeJetOff) {
    LoadCellOptions options;
    options.without_thrust = true;
    const LoadCellReduction reduction = reduce_load_cell(measured(0, 0, 0, 1).table(), options);
    for (std::size_t i = 0; i < reduction.table.rows(); ++i) {
        const double v = reduction.table.numbers("jet_voltage")[i];
        EXPECT_NEAR(reduction.table.numbers("lift_force")[i], lift(reduction.table.numbers("gap")[i], v) - lift(0.1, v),
                    1e-12);
    }
}

TEST(LoadCell, SaysWhatIsMissing) {
    core::Random random(1);
    Log log;
    log.block(0.01, 8, 1, 0.01, 0, 0, random, 10);
    try {
        (void)reduce_load_cell(log.table());
        FAIL() << "nothing was refused";
    } catch (const core::InputError& error) {
        EXPECT_NE(error.message().find("pump off"), std::string::npos);
    }
    log.block(0.01, 0, 1, 0, 0, 0, random, 10);
    const LoadCellReduction reduction = reduce_load_cell(log.table());
    EXPECT_EQ(reduction.table.rows(), 1U);
    EXPECT_EQ(reduction.problems.size(), 2U);  // held zero, nothing repeated
    EXPECT_FALSE(is_load_cell_log(log.table()));
    EXPECT_TRUE(is_load_cell_log(measured(0, 0, 0, 1).table()));
}
