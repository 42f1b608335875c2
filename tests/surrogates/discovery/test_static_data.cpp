// Static data that are not as they should be: said clearly, with what is still possible.
#include <gtest/gtest.h>

#include "make_data.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/wording.h"

using namespace underbody;
using namespace underbody::discovery;

namespace {

double declared(double gap, double voltage) { return test::lift_of(gap) * voltage * voltage / 100; }

struct Bench {
    core::TemporaryFolder folder{"odd"};
    dynamics::Model model;
    dynamics::Measurements data;

    explicit Bench(std::uint64_t seed = 21) {
        test::write_bench(folder.path(), declared, seed);
        model = dynamics::read_model(folder.path() / "model.toml");
        data = dynamics::read_measurements(folder.path());
    }
    /// Column `name` of a run, changed row by row.
    void change(const std::string& name, const std::function<double(std::size_t, double)>& to, std::size_t run = 0) {
        core::Table table;
        table.source = data.runs[run].table.source;
        for (const core::Column& column : data.runs[run].table.columns()) {
            std::vector<double> values = column.numbers;
            for (std::size_t i = 0; i < values.size() && column.name == name; ++i) {
                values[i] = to(i, values[i]);
            }
            table.add_numbers(column.name, column.unit, values);
        }
        data.runs[run].table = std::move(table);
    }
    Discovery found() {
        DiscoverOptions options;
        options.figures = options.consequence = false;
        return discover(model, data, options);
    }
};

bool says(const Discovery& found, const std::string& words) {
    return std::any_of(found.problems.begin(), found.problems.end(),
                       [&](const core::Problem& problem) { return problem.message.find(words) != std::string::npos; });
}

}  // namespace

TEST(OddStaticData, OneSetPointShowsThatSomethingIsMissingButNotWhat) {
    Bench bench;
    bench.change("gap", [](std::size_t, double) { return 0.02; });
    bench.change("jet_voltage", [](std::size_t, double) { return 8.0; });
    core::Random random(4);
    bench.change("lift_force", [&](std::size_t, double) { return declared(0.02, 8) + 0.004 + 1e-3 * random.normal(); });
    const Discovery found = bench.found();
    EXPECT_TRUE(says(found, "one set point"));
    EXPECT_NE(found.held_out.find("were fitted"), std::string::npos);
    ASSERT_EQ(found.verdict, "effect") << found.sentence;
    EXPECT_LT(found.effects.front().probability, 0.5) << found.sentence;
    for (const char* name : {"force_bias", "sensor_gain"}) {
        EXPECT_TRUE(
            found.effects.front().name == name ||
            std::any_of(found.alternatives.begin(), found.alternatives.end(),
                        [&](const FoundEffect& rival) { return rival.name == name && rival.probability > 0.3; }))
            << name << ": " << found.sentence;
    }
}

TEST(OddStaticData, ASensorThatStandsStillIsNamed) {
    Bench bench;
    bench.change("lift_force", [](std::size_t, double) { return -0.0123; });
    EXPECT_TRUE(says(bench.found(), "stands still"));
}

TEST(OddStaticData, AClippedSensorIsNamed) {
    Bench bench;
    bench.change("lift_force", [](std::size_t, double value) { return std::max(value, -0.02); });
    EXPECT_TRUE(says(bench.found(), "clipped"));
}

TEST(OddStaticData, AForceInThousandthsIsNamed) {
    Bench bench;
    bench.change("lift_force", [](std::size_t, double value) { return 1000 * value; });
    EXPECT_TRUE(says(bench.found(), "thousandths"));
}

TEST(OddStaticData, AGapInTheWrongUnitIsRefusedWithTheFactor) {
    Bench bench;
    bench.change("gap", [](std::size_t, double value) { return 1000 * value; });
    try {
        (void)bench.found();
        FAIL() << "nothing was refused";
    } catch (const core::InputError& error) {
        EXPECT_NE(error.message().find("outside the range of the declared tables"), std::string::npos)
            << error.message();
        EXPECT_NE(error.hint().find("1000 times too large"), std::string::npos) << error.hint();
    }
}

TEST(OddStaticData, SomeSetPointsOutsideTheDeclaredTableAreNamed) {
    Bench bench;
    bench.change("gap", [](std::size_t i, double value) { return i % 9 == 8 ? 2.5 : value; });
    const Discovery found = bench.found();
    EXPECT_TRUE(says(found, "outside the range of a declared table"));
    EXPECT_TRUE(says(found, "2.5 measured"));
}

TEST(OddStaticData, AHeldGapIsNamedWithWhatCannotBeSeen) {
    Bench bench;
    bench.change("gap", [](std::size_t, double) { return 0.02; });
    EXPECT_TRUE(says(bench.found(), "held throughout, so that effects of it cannot be seen: gap"));
}

TEST(OddStaticData, OneWildReadingIsLeftOutAndNamed) {
    Bench bench;
    bench.change("lift_force", [](std::size_t i, double value) { return i == 40 ? value + 0.05 : value; });
    const Discovery found = bench.found();
    EXPECT_TRUE(says(found, "left out of every fit"));
    EXPECT_EQ(found.verdict, "none") << found.sentence;
    EXPECT_NEAR(found.noise.at("lift_force").value, 1e-3, 2e-4);
}

TEST(OddStaticData, RunsThatContradictEachOtherAreNamed) {
    Bench bench;
    bench.data.runs.push_back(bench.data.runs.front());
    bench.data.runs.back().name = "second";
    bench.change(
        "lift_force", [](std::size_t i, double value) { return value + (i < 45 ? 0.01 : -0.008); }, 1);
    EXPECT_TRUE(says(bench.found(), "contradict"));
}

TEST(OddStaticData, ReadingsThatStandThereTwiceAreNamed) {
    Bench bench;
    bench.data.runs.push_back(bench.data.runs.front());
    bench.data.runs.back().name = "copy";
    EXPECT_TRUE(says(bench.found(), "twice"));
}

TEST(OddStaticData, SwappedColumnsAreNamed) {
    Bench bench;
    core::write_file(bench.folder.path() / "drag.csv", "gap [m], drag_force [N]\n0.001, 0.5\n0.1, 0.3\n1.6, 0.2\n");
    const std::string text = core::read_file(bench.folder.path() / "model.toml");
    core::write_file(bench.folder.path() / "both.toml",
                     text + "[[force]]\nquantity = \"drag_force\"\ntable = \"drag.csv\"\n");
    bench.model = dynamics::read_model(bench.folder.path() / "both.toml");
    const dynamics::StaticModel drag(bench.model, "drag_force");
    std::vector<double> lifts = bench.data.runs[0].table.numbers("lift_force"), drags;
    for (const double gap : bench.data.runs[0].table.numbers("gap")) {
        dynamics::Conditions at;
        at[dynamics::Channel::gap] = gap;
        drags.push_back(drag(at));
    }
    bench.change("lift_force", [&](std::size_t i, double) { return drags[i]; });
    bench.data.runs[0].table.add_numbers("drag_force", "N", lifts);
    EXPECT_TRUE(says(bench.found(), "look swapped"));
}

TEST(OddStaticData, ADeclaredModelWithoutTheMeasuredQuantityIsRefusedWithWhatToDo) {
    Bench bench;
    core::Table table;
    table.source = "bench.csv";
    for (const core::Column& column : bench.data.runs[0].table.columns()) {
        table.add_numbers(column.name == "lift_force" ? "pitch_moment" : column.name,
                          column.name == "lift_force" ? "N m" : column.unit, column.numbers);
    }
    bench.data.runs[0].table = std::move(table);
    try {
        (void)bench.found();
        FAIL() << "nothing was refused";
    } catch (const core::InputError& error) {
        EXPECT_NE(error.message().find("none of the measured quantities"), std::string::npos);
        EXPECT_FALSE(error.hint().empty());
    }
}

TEST(OddStaticData, AChannelThatRanWithAnotherIsNamed) {
    Bench bench;
    bench.change("time", [&](std::size_t i, double) {
        return 1e4 * bench.data.runs[0].table.numbers("gap")[i] + 0.01 * static_cast<double>(i);
    });
    EXPECT_TRUE(says(bench.found(), "ran together"));
}

TEST(OddStaticData, ADeclaredNoiseTwiceTooLargeIsFoundOut) {
    Bench bench;
    bench.data.noise["lift_force"] = 0.002;
    const Discovery found = bench.found();
    EXPECT_NE(found.noise.at("lift_force").from.find("wrong"), std::string::npos);
    EXPECT_EQ(found.verdict, "none") << found.sentence;
}

namespace {

/// A bench that was at each of 12 gaps and 9 voltages once, in drawn order; readings scatter by 1 mN.
dynamics::Measurements once_each(const std::filesystem::path& folder, double offset, double declared_noise) {
    test::write_bench(folder, declared, 1);
    std::vector<std::pair<double, double>> points;
    for (const double gap : {2.0, 4.0, 6.0, 9.0, 14.0, 20.0, 30.0, 45.0, 70.0, 110.0, 200.0, 400.0}) {
        for (int voltage = 4; voltage <= 12; ++voltage) {
            points.emplace_back(gap, voltage);
        }
    }
    core::Random random(5);
    std::string rows = "time [s], gap [mm], jet_voltage [V], lift_force [N]\n";
    for (std::size_t k = 0; k < points.size(); ++k) {
        std::swap(points[k], points[k + random.below(points.size() - k)]);
        const auto [gap, voltage] = points[k];
        rows += test::written(60.0 * static_cast<double>(k)) + ", " + test::written(gap) + ", " +
                test::written(voltage) + ", " +
                test::written(declared(gap / 1000 + offset, voltage) + 1e-3 * random.normal()) + "\n";
    }
    core::write_file(folder / "bench.csv", rows);
    dynamics::Measurements data = dynamics::read_measurements(folder);
    data.noise["lift_force"] = declared_noise;
    return data;
}

}  // namespace

TEST(OddStaticData, ANoiseFigureTooSmallWithoutRepeatsIsNotToldFromSomethingMissing) {
    Bench bench;
    bench.data = once_each(bench.folder.path(), 0, 5e-4);  // half of the truth
    const Discovery found = bench.found();
    EXPECT_EQ(found.verdict, "none") << found.sentence;  // "unknown" before
    EXPECT_NE(found.sentence.find("without repeats of set points this cannot be told"), std::string::npos)
        << found.sentence;
    EXPECT_EQ(headline(found), "No effect is named");
    EXPECT_DOUBLE_EQ(found.none_probability, 0.5);
    EXPECT_FALSE(found.rest.is_noise) << "the declared figure stands";
    EXPECT_EQ(found.noise.at("lift_force").from, "declared");
    for (const FoundEffect& one : found.alternatives) {
        EXPECT_LE(one.probability, 0.5);
    }
}

TEST(OddStaticData, ANoiseFigureTooSmallHidesNothingThatIsThere) {
    Bench bench;
    bench.data = once_each(bench.folder.path(), 2e-3, 5e-4);
    const Discovery found = bench.found();
    EXPECT_NE(found.verdict, "none") << found.sentence;
    EXPECT_FALSE(found.rest.or_noise_figure) << found.sentence;
}

TEST(OddStaticData, ANoiseFigureFarTooSmallIsNoNoise) {
    Bench bench;
    bench.data = once_each(bench.folder.path(), 0, 2e-4);  // a fifth of the truth: beyond any doubt of a figure
    const Discovery found = bench.found();
    EXPECT_NE(found.verdict, "effect") << found.sentence;
    EXPECT_FALSE(found.rest.or_noise_figure) << found.sentence;
}

namespace {

/// 18 sweeps over 16 gaps, each at a voltage held, with noise of 1 mN that goes together over some five readings.
dynamics::MeasuredRun sweeps(core::Random& random) {
    std::vector<double> time, gap, voltage, direction, lift;
    double slow = 0;
    for (int sweep = 0; sweep < 18; ++sweep) {
        for (int g = 0; g < 16; ++g) {
            direction.push_back(sweep % 2 == 0 ? 1 : -1);
            gap.push_back(2e-3 * std::pow(1.5, sweep % 2 == 0 ? g : 15 - g));
            voltage.push_back(4 + 7 * sweep % 9);
            time.push_back(60.0 * static_cast<double>(time.size()));
            slow = 0.8 * slow + 0.6 * random.normal();
            lift.push_back(declared(gap.back(), voltage.back()) + 8e-4 * random.normal() + 6e-4 * slow);
        }
    }
    dynamics::MeasuredRun run;
    run.name = run.table.source = "sweeps";
    run.table.add_numbers("time", "s", time);
    run.table.add_numbers("gap", "m", gap);
    run.table.add_numbers("jet_voltage", "V", voltage);
    run.table.add_numbers("approach_direction", "1", direction);
    run.table.add_numbers("lift_force", "N", lift);
    return run;
}

}  // namespace

TEST(OddStaticData, ColouredNoiseIsSeenThoughAVoltageIsHeldForAWholeSweep) {
    // what is changed as slowly as time explains slow noise as well as time does
    int seen = 0;
    Bench bench;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        core::Random random(seed);
        bench.data.runs = {sweeps(random), sweeps(random)};
        bench.data.runs.back().use = dynamics::RunUse::test;
        const Discovery found = bench.found();
        EXPECT_EQ(found.verdict, "none") << found.sentence;
        seen += says(found, "coloured noise") ? 1 : 0;
    }
    EXPECT_GE(seen, 5);
}

TEST(OddStaticData, NothingMissingThatIsNotSureIsSaid) {
    Discovery found;
    found.verdict = "none";
    found.gate = 0.3;
    found.none_probability = 0.98;
    EXPECT_EQ(headline(found), "Nothing is missing from the model");
    EXPECT_EQ(verdict_sentence(found).rfind("Nothing is missing: ", 0), 0U);
    found.gate = 0.004;
    found.none_probability = 0.2;
    EXPECT_EQ(headline(found), "No effect is named");
    EXPECT_NE(verdict_sentence(found).find("not sure that nothing is missing"), std::string::npos);
    EXPECT_NE(verdict_sentence(found).find("0.004"), std::string::npos);
}
