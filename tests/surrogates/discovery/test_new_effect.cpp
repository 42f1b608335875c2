// A new effect is one class: nothing in discovery knows its name, and it is found like the others.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "make_data.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/hypothesis.h"
#include "surrogates/dynamics/plant/heave_terms.h"
#include "tests/support/support.h"

using namespace underbody;
using namespace underbody::discovery;

namespace {

/// F = force exp(-((h - 0.14 m)/25 mm)^2): an obstacle in the stream at one height.
class Obstacle final : public dynamics::Effect {
public:
    [[nodiscard]] const dynamics::EffectInfo& info() const override {
        static const dynamics::EffectInfo the =
            dynamics::searched(dynamics::EffectInfo{"obstacle",
                                                    "obstacle at one height",
                                                    "F = force exp(-((h - 0.14 m)/25 mm)^2)",
                                                    dynamics::SeenIn::time_series,
                                                    {"gap"},
                                                    {{"force", "N", -10, 10, 0.01, 0, false, "up"}},
                                                    "this test"},
                               {.kin = {"place"}});
        return the;
    }
    void add_to(dynamics::HeaveTerms& terms, const dynamics::EffectUse& use, const dynamics::Model&) const override {
        terms.extras.push_back({[](const double* p, double, double h, double) {
                                    return p[0] * std::exp(-std::pow((h - 0.14) / 0.025, 2));
                                },
                                {use.values[0]}});
    }
};

}  // namespace

TEST(NewEffect, IsFoundWithoutALineInDiscovery) {
    static const Obstacle obstacle;
    const dynamics::RegisteredEffect known(obstacle);
    EXPECT_THROW(dynamics::RegisteredEffect again(obstacle), core::InputError);
    core::TemporaryFolder folder("new-effect");
    const dynamics::Model model = test::heave_model(folder.path());
    DiscoverOptions options;
    options.figures = options.consequence = false;
    // without it this law is called unknown over the gap
    const Discovery found = discover(
        model,
        test::heave_runs([](double, double h, double) { return 0.006 * std::exp(-std::pow((h - 0.14) / 0.025, 2)); }, 4,
                         50, 4),
        options);
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    EXPECT_EQ(found.effects.at(0).name, "obstacle");
    EXPECT_NEAR(found.effects.at(0).parameters.at(0).value, 0.006, 5e-4);
}

TEST(NewEffect, NoNameOfTheCatalogueStandsInDiscovery) {
    std::vector<std::string> seen;
    const std::filesystem::path root = test::source_folder() / "surrogates/discovery";
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
        if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") {
            continue;
        }
        std::ifstream file(entry.path());
        for (std::string line; std::getline(file, line);) {
            if (line.find("//") != std::string::npos) {
                line.resize(line.find("//"));
            }
            for (const dynamics::Effect* effect : dynamics::effects()) {
                const std::string& name = effect->info().name;
                // words that are something else as well: a verdict, and a channel
                if (name != "unknown" && name != "temperature" && line.find('"' + name + '"') != std::string::npos) {
                    seen.push_back(entry.path().filename().string() + ": " + line);
                }
            }
        }
    }
    EXPECT_TRUE(seen.empty()) << seen.size() << " names, first " << (seen.empty() ? "" : seen.front());
}
