// The rules that hold whatever is fitted, on rigs drawn at random. UNDERBODY_RIGS=N asks for more than the few of the
// test run, UNDERBODY_FIRST_RIG=K for others.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "make_data.h"
#include "surrogates/discovery/calibration.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/dynamics/simulate/predict.h"

using namespace underbody;
using namespace underbody::discovery;

namespace {

/// What the model lacks, and of which kind: "", an effect, or a law that no name has.
struct Lacking {
    std::string kind;
    std::function<double(double, double, double)> force;
};

Lacking drawn(core::Random& random) {
    const double size = std::pow(10.0, -0.5 + random.uniform());  // about a noise of the 2 s prediction and more
    switch (random.below(8)) {
        case 0:
        case 1:
            return {"nothing", [](double, double, double) { return 0.0; }};
        case 2:
            return {"constant", [size](double, double, double) { return 0.002 * size; }};
        case 3:
            return {"damping", [size](double, double, double w) { return -0.1 * size * w; }};
        case 4:
            return {"spring", [size](double, double h, double) { return -0.05 * size * (h - 0.12); }};
        case 5:
            return {"friction", [size](double, double, double w) { return -0.003 * size * std::tanh(w / 0.002); }};
        case 6:
            return {"ripple over the gap",
                    [size](double, double h, double) { return 0.004 * size * std::sin(h / 0.012); }};
        default:
            return {"a slow wander", [size](double t, double, double) {
                        return 0.003 * size * (std::sin(0.31 * t) + std::sin(0.83 * t + 1) + std::sin(2.1 * t + 2));
                    }};
    }
}

double error_of(const dynamics::Model& model, const dynamics::Measurements& data) {
    return dynamics::predict(model, data).channels.front().rmse;
}

std::size_t asked(const char* name, std::size_t otherwise) {
    const char* text = std::getenv(name);
    return text != nullptr ? static_cast<std::size_t>(std::atoll(text)) : otherwise;
}

void check_rules(const Discovery& found, const std::string& rig) {
    const Calibration numbers = heave_calibration();
    const ErrorChange& chief = found.error.front();
    double most = 0;
    for (const FoundEffect& effect : found.effects) {
        most = std::max(most, effect.probability);
    }
    // 1: no name, no probability above one half, without a held-out error that falls
    if (found.verdict == "effect") {
        EXPECT_LT(chief.after.rmse, chief.before.rmse) << rig;
    } else if (found.verdict == "none") {
        for (const FoundEffect& rival : found.alternatives) {
            EXPECT_LE(rival.probability, 0.5) << rig;
        }
    }
    // 2: "nothing is missing" and a name both need the rest to be noise, or say what is left
    if (found.verdict == "none") {
        EXPECT_TRUE(found.rest.is_noise) << rig;
    }
    if (found.verdict == "effect" && !found.rest.is_noise) {
        EXPECT_NE(found.sentence.find("unexplained"), std::string::npos) << rig;
    }
    // 3: no shift in time below a sample is a finding
    for (const FoundEffect& effect : found.effects) {
        if (effect.name == "input_delay" || effect.name == "gap_sensor_delay") {
            EXPECT_GE(std::abs(effect.parameters.front().value), 0.02) << rig;
        }
        for (const FoundParameter& parameter : effect.parameters) {
            if (parameter.sigma > 0 && effect.parameters.size() == 1 && found.verdict == "effect") {
                const double neutral = dynamics::neutral_use(effect.name).values.front();
                EXPECT_GT(std::abs(parameter.value - neutral), numbers.neutral_sigmas * parameter.sigma) << rig;
            }
        }
        // 4: corrections run over no time
        for (const dynamics::EffectUse& use : effect.uses) {
            for (const tables::TableAxis& axis : use.table ? use.table->axes() : std::vector<tables::TableAxis>{}) {
                EXPECT_NE(axis.name, "time") << rig;
            }
        }
    }
    double sum = found.none_probability;
    for (const FoundEffect& effect : found.effects) {
        sum += &effect == &found.effects.front() ? effect.probability : 0;
    }
    EXPECT_LE(sum, 1 + 1e-9) << rig;
}

}  // namespace

TEST(RulesOnRandomRigs, HoldAndFreshRunsArePredictedNoWorse) {
    const std::size_t first = asked("UNDERBODY_FIRST_RIG", 1), count = asked("UNDERBODY_RIGS", 6);
    const core::TemporaryFolder folder("rigs");
    const dynamics::Model model = test::heave_model(folder.path());
    std::size_t said = 0;
    for (std::size_t k = first; k < first + count; ++k) {
        core::Random random(9000, k);
        const Lacking lacking = drawn(random);
        test::HeaveRig rig;
        rig.seconds = 20 + 20 * random.uniform();
        rig.noise = 1e-4 * std::pow(10.0, random.uniform());
        rig.velocity = random.uniform() < 0.3;
        const std::uint64_t seed = 100 + 2 * k;
        const dynamics::Measurements data = test::heave_runs(lacking.force, 6, 50, seed, rig);
        rig.continuous = false;
        const dynamics::Measurements fresh = test::heave_runs(lacking.force, 3, 50, seed + 1, rig);
        DiscoverOptions options;
        options.figures = options.consequence = false;
        const Discovery found = discover(model, data, options);
        const double before = error_of(model, fresh), after = error_of(found.model, fresh);
        const std::string name = "rig " + std::to_string(k) + ", " + lacking.kind + ", noise " +
                                 test::written(rig.noise) + ": " + found.sentence + " fresh " +
                                 test::written(after / before);
        check_rules(found, name);
        EXPECT_LE(after, 1.05 * before) << name;
        said += found.verdict != "none" && lacking.kind == "nothing" ? 1 : 0;
    }
    EXPECT_LE(said, count / 20) << "clean rigs with something found";
}
