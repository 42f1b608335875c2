#include <gtest/gtest.h>

#include "make_data.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/heave_experiment.h"
#include "surrogates/discovery/residual.h"

using namespace underbody;
using namespace underbody::discovery;

namespace {

Discovery found_on(const std::function<double(double, double, double)>& extra, std::uint64_t seed, double rate = 50) {
    core::TemporaryFolder folder("heave");
    const dynamics::Model model = test::heave_model(folder.path());
    DiscoverOptions options;
    options.figures = options.consequence = false;
    return discover(model, test::heave_runs(extra, 4, rate, seed), options);
}

}  // namespace

TEST(HeaveDiscovery, SaysNoneOnCleanRuns) {
    const Discovery found = found_on([](double, double, double) { return 0.0; }, 1);
    EXPECT_EQ(found.verdict, "none");
    EXPECT_TRUE(found.model.effects.empty());
    EXPECT_EQ(found.error.front().before.rmse, found.error.front().after.rmse);
    EXPECT_NEAR(found.error.front().before.rmse, 2e-4, 3e-5);
}

TEST(HeaveDiscovery, NamesFrictionInsideTheClosedLoop) {
    const Discovery found = found_on([](double, double, double w) { return -0.004 * std::tanh(w / 5e-4); }, 2);
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    EXPECT_EQ(found.effects.at(0).name, "coulomb_friction");
    EXPECT_NEAR(found.effects.at(0).parameters.at(0).value, 0.004, 3e-4);
    EXPECT_LT(found.error.front().after.rmse, 0.5 * found.error.front().before.rmse);
    EXPECT_EQ(found.depends_on, std::vector<std::string>{"heave_velocity"});
}

TEST(HeaveDiscovery, GivesTheSameVerdictAtFiveHundredHertz) {
    const auto tether = [](double, double h, double) { return -0.06 * (h - 0.12); };
    const Discovery slow = found_on(tether, 3, 50);
    const Discovery fast = found_on(tether, 3, 500);
    ASSERT_EQ(slow.verdict, "effect");
    ASSERT_EQ(fast.verdict, "effect");
    EXPECT_EQ(slow.effects.at(0).name, "tether_stiffness");
    EXPECT_EQ(fast.effects.at(0).name, "tether_stiffness");
}

TEST(HeaveDiscovery, CallsALawOutsideTheCatalogueUnknownOverItsVariable) {
    const Discovery found = found_on([](double, double h, double) { return 0.006 * std::exp(-std::pow((h - 0.14) / 0.025, 2)); }, 4);
    EXPECT_EQ(found.verdict, "unknown") << found.sentence;
    EXPECT_EQ(found.depends_on, std::vector<std::string>{"gap"});
    EXPECT_LT(found.error.front().after.rmse, 0.6 * found.error.front().before.rmse);
}

TEST(HeaveDiscovery, SaysWhatIsWrongWithTheData) {
    core::TemporaryFolder folder("heave");
    const dynamics::Model model = test::heave_model(folder.path());
    dynamics::Measurements data = test::heave_runs([](double, double, double) { return 0.0; }, 2, 50, 5);
    // units wrong by a thousand
    dynamics::Measurements wrong = data;
    std::vector<double> millimetres = data.runs[0].table.numbers("gap");
    for (double& value : millimetres) {
        value *= 1000;
    }
    core::Table table;
    table.source = "run-1.csv";
    table.add_numbers("time", "s", data.runs[0].table.numbers("time"));
    table.add_numbers("gap", "m", millimetres);
    table.add_numbers("input_force", "N", data.runs[0].table.numbers("input_force"));
    wrong.runs[0].table = table;
    try {
        (void)prepare_heave_records(model, wrong);
        ADD_FAILURE() << "a gap of a hundred metres was taken";
    } catch (const core::InputError& error) {
        EXPECT_EQ(error.kind(), "unit");
        EXPECT_NE(error.hint().find("mm"), std::string::npos);
    }
    // a sensor that stands still
    core::Table stuck;
    stuck.source = "run-1.csv";
    stuck.add_numbers("time", "s", data.runs[0].table.numbers("time"));
    stuck.add_numbers("gap", "m", std::vector<double>(millimetres.size(), 0.1));
    dynamics::Measurements still = data;
    still.runs[0].table = stuck;
    const HeaveRecords records = prepare_heave_records(model, still);
    EXPECT_EQ(records.records.size(), 1U);
    ASSERT_FALSE(records.problems.empty());
    EXPECT_NE(records.problems.front().message.find("stuck"), std::string::npos);
}

TEST(HeaveResidual, IsTheForceThatWasLeftOut) {
    core::TemporaryFolder folder("heave");
    const dynamics::Model model = test::heave_model(folder.path());
    const std::vector<Residual> residual = measured_residual(model, test::heave_runs([](double, double, double) { return 0.005; }, 3, 50, 6));
    ASSERT_EQ(residual.size(), 1U);
    EXPECT_NEAR(residual.front().mean, 0.005, 5e-4);
    ASSERT_EQ(residual.front().curves.size(), 2U);
    for (const double value : residual.front().curves.front().mean) {
        EXPECT_NEAR(value, 0.005, 2.5e-3);
    }
}

TEST(HeaveFilter, InnovationsOfTheTruthAreWhiteAndOfUnitSize) {
    core::TemporaryFolder folder("heave");
    const dynamics::Model model = test::heave_model(folder.path());
    const dynamics::Measurements data = test::heave_runs([](double, double, double) { return 0.0; }, 2, 50, 7);
    const HeaveRecords records = prepare_heave_records(model, data);
    const HeaveExperiment experiment(model, records, {0, 1}, 2e-4, {});
    HeaveNoise noise = experiment.noise();
    experiment.fit_process({}, noise);
    std::vector<double> innovations;
    experiment.evaluate({}, nullptr, noise, innovations);
    EXPECT_NEAR(root_mean_square(innovations), 1, 0.05);
    for (const std::size_t lag : {1U, 5U, 25U}) {
        EXPECT_LT(std::abs(autocorrelation(innovations, lag)), 0.08) << lag;
    }
}
