// The error that a discovery reports is the one that predict gives of what was held out, of the model as declared and
// as written. Heave with pitch and the motion on the ground: beside their own tests.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "make_data.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/dynamics/simulate/predict.h"

namespace underbody::discovery {

namespace {

DiscoverOptions quick() {
    DiscoverOptions options;
    options.consequence = options.figures = false;
    return options;
}

void expect_predicted(const Discovery& found, const dynamics::Model& declared, const dynamics::Measurements& held,
                      const std::filesystem::path& folder, const std::string& what) {
    dynamics::write_model(found.model, folder / "found" / "model.toml");
    const dynamics::Model written = dynamics::read_model(folder / "found" / "model.toml");
    ASSERT_FALSE(found.error.empty()) << what;
    for (const ErrorChange& change : found.error) {
        dynamics::PredictOptions options;
        options.horizon = change.horizon > 0 ? change.horizon : options.horizon;
        for (const bool after : {false, true}) {
            const dynamics::Prediction prediction = dynamics::predict(after ? written : declared, held, options);
            const auto own = std::find_if(prediction.channels.begin(), prediction.channels.end(),
                                          [&](const auto& channel) { return channel.name == change.channel; });
            ASSERT_NE(own, prediction.channels.end()) << what;
            EXPECT_NEAR(own->rmse, (after ? change.after : change.before).rmse, 1e-6 * own->rmse)
                << what << (after ? ", after, " : ", before, ") << change.horizon << " s: " << found.sentence;
        }
    }
}

/// A force that a declared model lacks.
struct Lacking {
    const char* name;
    double (*force)(double t, double h, double w);
};

}  // namespace

TEST(ReportedError, OfHeaveIsThatOfPredict) {
    const core::TemporaryFolder folder("reported");
    const dynamics::Model model = test::heave_model(folder.path());
    const Lacking kinds[] = {{"nothing", [](double, double, double) { return 0.0; }},
                             {"damping", [](double, double, double w) { return -0.4 * w; }},
                             {"friction", [](double, double, double w) { return -0.008 * std::tanh(w / 0.002); }},
                             {"spring", [](double, double h, double) { return -0.1 * (h - 0.12); }}};
    std::uint64_t seed = 610;
    for (const Lacking& kind : kinds) {
        dynamics::Measurements data = test::heave_runs(kind.force, 5, 50, ++seed), held = data;
        data.runs[1].use = data.runs[4].use = dynamics::RunUse::test;
        held.runs = {data.runs[1], data.runs[4]};
        expect_predicted(discover(model, data, quick()), model, held, folder.path(), kind.name);
    }
}

TEST(ReportedError, OfAStaticSetIsThatOfPredict) {
    for (const double bias : {0.0, 0.004}) {
        const core::TemporaryFolder folder("reported-static");
        const auto truth = [&](double gap, double voltage) {
            return test::lift_of(gap) * voltage * voltage / 100 + bias;
        };
        test::write_bench(folder.path(), truth, 621);
        test::write_bench(folder.path() / "held-out", truth, 622);
        const dynamics::Model model = dynamics::read_model(folder.path() / "model.toml");
        expect_predicted(discover(model, dynamics::read_measurements(folder.path()), quick()), model,
                         dynamics::read_measurements(folder.path() / "held-out"), folder.path(),
                         bias == 0 ? "nothing" : "a bias");
    }
}

TEST(ReportedError, NamesTheRunsThatAreHeldOut) {
    const core::TemporaryFolder folder("reported-runs");
    const dynamics::Model model = test::heave_model(folder.path());
    const dynamics::Measurements data = test::heave_runs([](double, double, double) { return 0.01; }, 4, 50, 631);
    const Discovery found = discover(model, data, quick());
    dynamics::Measurements held = data;
    std::erase_if(held.runs, [&](const dynamics::MeasuredRun& run) {
        return found.held_out.find(": " + run.name) == std::string::npos;
    });
    ASSERT_EQ(held.runs.size(), 1U) << found.held_out;
    expect_predicted(found, model, held, folder.path(), found.held_out);
}

}  // namespace underbody::discovery
