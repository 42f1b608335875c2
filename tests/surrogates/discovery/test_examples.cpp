// The example data sets in the shared folder; their truth is read here and nowhere in the program.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "surrogates/discovery/discovery.h"
#include "tests/support/support.h"

using namespace underbody;

namespace {

void expect_truth(const std::string& name) {
    const std::filesystem::path folder = test::shared_folder() / "examples/loop" / name;
    const nlohmann::json truth = nlohmann::json::parse(core::read_file(folder / "truth.json"));
    discovery::DiscoverOptions options;
    options.figures = options.consequence = false;
    const discovery::Discovery found =
        discovery::discover(dynamics::read_model(folder / "model.toml"), dynamics::read_measurements(folder), options);
    std::vector<std::string> names;
    for (const discovery::FoundEffect& effect : found.effects) {
        names.push_back(effect.name);
    }
    EXPECT_EQ(names, truth["names"].get<std::vector<std::string>>()) << found.sentence;
    if (truth["depends_on"].is_array()) {
        EXPECT_EQ(found.depends_on, truth["depends_on"].get<std::vector<std::string>>());
    }
    EXPECT_LT(found.error.front().after.rmse, 1.12 * found.error.front().noise);
}

}  // namespace

TEST(Examples, OfStaticSetsGetTheirTruth) {
    UNDERBODY_NEEDS_SHARED("examples/loop");
    for (const char* name : {"example-03", "example-04", "example-05", "example-07"}) {
        expect_truth(name);
    }
}

TEST(Examples, OfHeaveRunsWithAnEffectGetTheirTruth) {
    UNDERBODY_NEEDS_SHARED("examples/loop");
    expect_truth("example-00");
}

TEST(Examples, OfHeaveRunsWithAConstantForceGetTheirTruth) {
    UNDERBODY_NEEDS_SHARED("examples/loop");
    expect_truth("example-01");
}

TEST(Examples, OfCleanHeaveRunsGetTheirTruth) {
    UNDERBODY_NEEDS_SHARED("examples/loop");
    expect_truth("example-02");
}

TEST(Examples, OfHeaveRunsWithMeasuredVelocityGetTheirTruth) {
    UNDERBODY_NEEDS_SHARED("examples/loop");
    expect_truth("example-06");
}
