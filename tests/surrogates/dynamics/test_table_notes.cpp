#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/model/table_notes.h"
#include "surrogates/dynamics/plant/heave.h"

namespace underbody::dynamics {
namespace {

class TableNotes : public testing::Test {
protected:
    core::TemporaryFolder folder;
    [[nodiscard]] Model model(const std::string& fit = "") const {
        std::string points = "gap [mm], speed [m/s], lift_force [N], lift_force_sigma [N]\n";
        for (int g = 1; g <= 6; ++g) {
            for (const double u : {0.4, 0.6, 0.8}) {
                points +=
                    std::to_string(g) + "," + std::to_string(u) + "," + std::to_string(u * u * (7 - g)) + ",0.01\n";
            }
        }
        core::write_file(folder.path() / "lift.csv", points);
        core::write_file(folder.path() / "model.toml",
                         "[vehicle]\nmass = \"2 kg\"\nnet_weight = \"1 N\"\n[drag.heave]\nlinear = \"5 N "
                         "s/m\"\n[conditions]\nspeed = \"0.6 m/s\"\n"
                         "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n" +
                             fit);
        return read_model(folder.path() / "model.toml");
    }
};

TEST_F(TableNotes, SayWhichFitWasChosenAndTakeTheOlderWords) {
    EXPECT_EQ(fits_json(model("fit = \"gp\"\n"))[0]["kind"], "Gaussian process");
    EXPECT_EQ(fits_json(model("fit = \"auto\"\n")), fits_json(model("fit = \"automatic\"\n")));
    EXPECT_EQ(fits_json(model("fit = \"gaussian_process\"\n"))[0]["kind"], "Gaussian process");
    EXPECT_EQ(fit_lines(model("fit = \"interpolation\"\n")).at(0),
              "lift_force of lift.csv: monotone cubic, two axes through 18 points");
    EXPECT_THROW((void)model("fit = \"gass\"\n"), core::InputError);
}

TEST_F(TableNotes, AModelHasTheTableThatTheTableCommandsShow) {
    const Model m = model();
    const auto alone = tables::ForceTable::read(folder.path() / "lift.csv", "lift_force");
    EXPECT_EQ(m.forces.at(0).table.kind(), alone.kind());
    for (double g = 0.001; g < 0.006; g += 0.0003) {
        const double at[2] = {g, 0.55};
        EXPECT_DOUBLE_EQ(m.forces[0].table.value(at), alone.value(at));
    }
}

TEST_F(TableNotes, WarnOfAConditionOutsideTheTableInMapAndMotion) {
    const Model m = model();
    EXPECT_TRUE(held_outside(m, m.conditions).empty());
    Conditions fast;
    fast[Channel::speed] = 3;
    const auto found = held_outside(m, fast);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NE(
        found[0].message.find("speed 3 m/s is outside the lift_force table lift.csv, which covers 0.4 to 0.8 m/s"),
        std::string::npos)
        << found[0].message;
    const auto warned = [](const core::Problems& remarks) {
        return std::any_of(remarks.begin(), remarks.end(),
                           [](const auto& r) { return r.message.find("speed 3 m/s is outside") != std::string::npos; });
    };
    RegionOptions options;
    options.held = fast;
    options.axes = core::parse_ranges("gap=1mm:6mm,heave_velocity=-0.05:0.05");
    options.columns = options.rows = 8;
    EXPECT_TRUE(warned(stability_region(m, options).remarks));
    InputSignals inputs;
    inputs.held = fast;
    EXPECT_TRUE(warned(simulate(m, 0.003, 0, inputs, {}).remarks));
}

TEST_F(TableNotes, SayWhichConditionsChangeNothing) {
    const Model m = model();
    Conditions given;
    given[Channel::speed] = 0.5;
    EXPECT_TRUE(held_in_vain(m, given).empty());
    given[Channel::jet_voltage] = 12;
    const auto found = held_in_vain(m, given);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NE(found[0].message.find("nothing in the model depends on jet_voltage: 12 V changes no force"),
              std::string::npos)
        << found[0].message;
    const auto told = [](const core::Problems& remarks) {
        return std::any_of(remarks.begin(), remarks.end(), [](const auto& remark) {
            return remark.message.find("nothing in the model depends on jet_voltage") != std::string::npos;
        });
    };
    InputSignals inputs;
    inputs.held = given;
    EXPECT_TRUE(told(simulate(m, 0.003, 0, inputs, {}).remarks));
    Conditions warm;
    warm[Channel::temperature] = 290;
    EXPECT_EQ(held_in_vain(m, warm).size(), 1U);
    EXPECT_TRUE(held_in_vain(m.with_effect(make_use("temperature", {})), warm).empty());
}

TEST_F(TableNotes, SayThatAScaleKnowsNoSpeedAstern) {
    core::write_file(folder.path() / "scaled.csv", "gap [mm], lift_force [N]\n1, 3\n2, 2\n3, 1.5\n4, 1\n");
    const Model m = read_model_text(
        "[vehicle]\nmass = \"2 kg\"\n[[force]]\nquantity = \"lift_force\"\ntable = \"scaled.csv\"\n"
        "[force.scale.speed]\nreference = \"0.5 m/s\"\n",
        "scaled.toml", folder.path());
    Conditions given;
    given[Channel::speed] = 0.5;
    EXPECT_TRUE(held_in_vain(m, given).empty());
    given[Channel::speed] = -0.5;
    const auto found = held_in_vain(m, given);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NE(found[0].message.find("the speed is -0.5 m/s, astern"), std::string::npos) << found[0].message;
}

TEST_F(TableNotes, SayThatGapsOfAHundredLengthsWereMillimetres) {
    const std::string start =
        "[vehicle]\nmass = \"2 kg\"\nlength = \"203.2 mm\"\n[[force]]\nquantity = "
        "\"lift_force\"\ntable = \"gaps.csv\"\n";
    for (const auto& [unit, faults] : {std::pair<std::string, std::size_t>{"m", 1}, {"mm", 0}}) {
        core::write_file(folder.path() / "gaps.csv",
                         "gap [" + unit + "], lift_force [N]\n1, 3\n2, 2\n5, 1.5\n20, 1\n100, 0.5\n");
        const auto found = gaps_of_another_size(read_model_text(start, "far.toml", folder.path()));
        ASSERT_EQ(found.size(), faults) << unit;
        if (faults > 0) {
            EXPECT_NE(found[0].message.find("1 to 100 m, are mostly more than 10 lengths of the vehicle (0.2032 m)"),
                      std::string::npos)
                << found[0].message;
        }
    }
}

}  // namespace
}  // namespace underbody::dynamics
