// A model's forces at the command line: its conditions hold, its errors stand beside its trims, its logs are read as it
// says, and the loop with its estimator has a map.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/random.h"
#include "core/table.h"
#include "tests/support/support.h"
#include "tests/surrogates/discovery/make_data.h"

namespace underbody::test {

namespace {

using testing::HasSubstr;

class ModelForces : public testing::Test {
protected:
    core::TemporaryFolder folder_;

    /// Lift over gap and speed with errors: at 0.5 m/s two stable balances with 10 mN and an unstable one between; gaps
    /// close enough to be sure of their kinds.
    void SetUp() override {
        std::string rows = "gap [mm], speed [m/s], lift_force [mN], lift_force_sigma [mN]\n";
        for (const double speed : {0.4, 0.5, 0.6, 0.8}) {
            for (const double gap : {1., 2., 3., 5., 8., 12., 15., 18., 22., 26., 31., 36., 43., 50.}) {
                const double force =
                    speed * speed / 0.25 * (80 / gap + 40 * std::exp(-std::pow((gap - 25) / 8, 2))) - 2;
                rows += std::to_string(gap) + ", " + std::to_string(speed) + ", " + std::to_string(force) + ", 0.4\n";
            }
        }
        core::write_file(folder_.path() / "lift.csv", rows);
        model("model.toml", "[conditions]\nspeed = \"0.5 m/s\"\n");
        model("bare.toml", "");
    }
    void model(const std::string& file, const std::string& more) {
        core::write_file(folder_.path() / file,
                         "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.754 kg\"\nnet_weight = \"10 mN\"\n"
                         "[drag.heave]\nlinear = 0.3\nquadratic = 6\n"
                         "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\nfit = \"interpolation\"\n" +
                             more);
    }
    nlohmann::json json(std::vector<std::string> arguments) {
        arguments.emplace_back("--json");
        const auto run = run_underbody(arguments, folder_.path());
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        return nlohmann::json::parse(run.output);
    }
};

TEST_F(ModelForces, TableAndLinearStateOneErrorOfAStiffness) {
    const nlohmann::json table = json({"table", "equilibria", "model.toml"}), linear = json({"linear", "model.toml"});
    const nlohmann::json &of_table = table["equilibria"], &of_linear = linear["heave"];
    ASSERT_EQ(of_table.size(), of_linear.size());
    for (std::size_t i = 0; i < of_table.size(); ++i) {
        const double k = of_linear[i]["stiffness"];
        EXPECT_NEAR(of_table[i]["stiffness"].get<double>(), k, 0.01 * std::abs(k));
        EXPECT_NEAR(of_table[i]["stiffness_sigma"].get<double>(), of_linear[i]["stiffness_sigma"].get<double>(),
                    1e-6 * of_linear[i]["stiffness_sigma"].get<double>());  // the same draws
    }
}

TEST_F(ModelForces, EquilibriaOfAModelAreThoseOfItsLinearAnalysis) {
    core::write_file(folder_.path() / "mass.csv",
                     "gap [mm], added_mass_heave [kg]\n1, 3.2\n5, 2.5\n20, 1.9\n50, 1.75\n");
    const std::string held = "[conditions]\nspeed = \"0.5 m/s\"\n";
    const auto effect = [](const std::string& text) { return "[[effect]]\nname = " + text + "\n"; };
    model("trim.toml", held + effect("\"constant_force\"\nforce = { value = \"1 mN\", sigma = \"0.1 mN\" }"));
    model("heavy.toml", held + effect("\"added_mass\"\nmass = \"0.9 kg\""));
    model("rough.toml", held + effect("\"surface_roughness\"\nnear = 0.2\nfar = 0.1\nlength = \"5 mm\""));
    model("tied.toml", held + effect("\"tether_stiffness\"\nstiffness = \"0.05 N/m\"\ngap = \"20 mm\""));
    model("table.toml", held);
    std::string text = core::read_file(folder_.path() / "table.toml");
    text.replace(text.find("\"1.754 kg\""), 10, "\"mass.csv\"");
    core::write_file(folder_.path() / "table.toml", text);
    for (const char* file : {"model.toml", "trim.toml", "heavy.toml", "rough.toml", "tied.toml", "table.toml"}) {
        const nlohmann::json of_model = json({"table", "equilibria", file}), table = of_model["equilibria"],
                             linear = json({"linear", file})["heave"];
        ASSERT_EQ(table.size(), linear.size()) << file;
        const auto near = [&](const nlohmann::json& a, const nlohmann::json& b, double part) {
            EXPECT_NEAR(a.get<double>(), b.get<double>(), part * std::abs(b.get<double>())) << file;
        };
        for (std::size_t i = 0; i < table.size(); ++i) {
            near(table[i]["gap"], linear[i]["gap"], 1e-8);
            near(table[i]["sigma"], linear[i]["sigma"], 1e-6);
            near(table[i]["stiffness"], linear[i]["stiffness"], 1e-4);
            near(table[i]["stiffness_sigma"], linear[i]["stiffness_sigma"], 1e-6);
            near(table[i].value("virtual_mass", of_model["virtual_mass"]), linear[i]["virtual_mass"], 1e-9);
            const nlohmann::json& mode = linear[i]["modes"][0];
            if (mode["imaginary"].get<double>() > 0) {
                near(table[i]["angular_frequency"], mode["frequency"], 1e-4);
                near(table[i]["damping_ratio"], mode["damping_ratio"], 1e-4);
                EXPECT_GT(table[i]["damping_ratio"].get<double>(), 0) << file;
                if (mode["frequency_sigma"].is_number()) {
                    near(table[i]["frequency_sigma"], mode["frequency_sigma"].get<double>() / (2 * 3.141592653589793),
                         0.05);
                }
            }
        }
    }
    const auto of_table = run_underbody({"table", "equilibria", "table.toml"}, folder_.path());
    EXPECT_THAT(of_table.output, HasSubstr("virtual mass by the gap"));
    run_underbody({"export", "table.toml", "--out", "table.h"}, folder_.path());
    EXPECT_THAT(
        core::read_file(folder_.path() / "table.h"),
        testing::AllOf(HasSubstr("added_mass_heave_lowest = 1.75"), HasSubstr("added_mass_heave_highest = 3.2")));
}

/// Also where draws move the balance past the end of the table, and over a bend of it.
TEST_F(ModelForces, AModelOfOneTableHasTheErrorsOfThatTable) {
    std::string rows = "gap [mm], lift_force [mN], lift_force_sigma [mN]\n";
    for (const auto& [gap, force] : {std::pair{1, 60.}, {3, 24.}, {10, 13.}, {20, 16.}, {50, 18.}, {100, 6.5}}) {
        rows += std::to_string(gap) + ", " + std::to_string(force) + ", 2\n";
    }
    core::write_file(folder_.path() / "lift.csv", rows);
    model("one.toml", "");
    const nlohmann::json of_model = json({"table", "equilibria", "one.toml"})["equilibria"];
    const nlohmann::json of_table = json({"table", "equilibria", "lift.csv", "--kind", "interpolation", "--weight",
                                          "10 mN", "--mass", "3.954 kg"})["equilibria"];
    ASSERT_EQ(of_model.size(), of_table.size());
    ASSERT_FALSE(of_table.empty());
    EXPECT_GT(of_table.back()["gap"].get<double>(), 0.07);
    for (std::size_t i = 0; i < of_table.size(); ++i) {
        for (const char* name : {"gap", "sigma", "stiffness", "stiffness_sigma", "frequency", "frequency_sigma"}) {
            const double own = of_table[i][name].is_null() ? 0 : of_table[i][name].get<double>();
            const double here = of_model[i][name].is_null() ? 0 : of_model[i][name].get<double>();
            EXPECT_NEAR(here, own, 2e-3 * std::abs(own)) << name << " of " << i;
        }
    }
}

TEST_F(ModelForces, GainsKnowTheActuatorOrSayThatTheyDoNot) {
    const std::string held = "[conditions]\nspeed = \"0.5 m/s\"\n";
    const auto effect = [](const std::string& text) { return "[[effect]]\nname = " + text + "\n"; };
    model("gain.toml", held + effect("\"input_gain\"\ngain = 0.2"));
    model("late.toml", held + effect("\"input_delay\"\ndelay = \"3 s\""));
    model("slow.toml", held + effect("\"actuator_lag\"\ntime_constant = \"0.2 s\""));
    const nlohmann::json plain = json({"linear", "model.toml"}), gain = json({"linear", "gain.toml"});
    EXPECT_GT(gain["heave"][0]["lqr"]["velocity_gain"].get<double>(),
              1.3 * plain["heave"][0]["lqr"]["velocity_gain"].get<double>());
    EXPECT_EQ(gain["warnings"].dump().find("actuator"), std::string::npos) << gain["warnings"];
    EXPECT_THAT(json({"linear", "late.toml"})["warnings"].dump(),
                HasSubstr("designed without the actuator's delay of 3 s; with it the loop is unstable"));
    EXPECT_THAT(json({"linear", "slow.toml"})["warnings"].dump(),
                HasSubstr("designed without the actuator's lag of 0.2 s; with it the loop is stable"));
    for (const std::string command : {"simulate", "region"}) {
        std::vector<std::string> words{command, "late.toml", "--lqr", "reference=20mm"};
        for (const std::string& word : command == "simulate"
                                           ? std::vector<std::string>{"--from", "gap=21mm", "--for", "5"}
                                           : std::vector<std::string>{"--grid", "4x4", "--for", "5"}) {
            words.push_back(word);
        }
        EXPECT_THAT(run_underbody(words, folder_.path()).output + run_underbody(words, folder_.path()).errors,
                    HasSubstr("with it the loop is unstable about 20 mm"))
            << command;
    }
}

TEST_F(ModelForces, SetPointsThatCannotBeMeantAreTold) {
    const auto told = [&](const std::vector<std::string>& words) {
        const auto run = run_underbody(words, folder_.path());
        return run.output + run.errors;
    };
    EXPECT_THAT(told({"simulate", "model.toml", "--from", "gap=20mm", "--for", "2", "--feedback",
                      "gap_gain=10,velocity_gain=9,reference=20"}),
                HasSubstr("reference 20000 mm lies outside the force tables, 1 to 50 mm: 20 mm would fit"));
    EXPECT_THAT(told({"simulate", "model.toml", "--from", "gap=20mm", "--for", "2", "--feedback",
                      "gap_gain=-10,velocity_gain=9,reference=20mm"}),
                HasSubstr("gap_gain -10 N/m is negative as it reaches the body: it drives away from the reference"));
    EXPECT_THAT(told({"control", "model.toml", "--hold", "20mm", "--from", "gap=25mm", "--step", "20"}),
                HasSubstr("a sample time of 20 s is long beside the loop"));
    EXPECT_THAT(told({"table", "at", "model.toml", "gap=5 Mm"}), HasSubstr("with m (milli) for M (mega)"));
    EXPECT_THAT(told({"table", "equilibria", "lift.csv", "--held", "speed=0.5", "--weight", "300"}),
                HasSubstr("a net weight of 300 N is "));
}

TEST_F(ModelForces, AStiffnessOutsideTheTablesIsSaidToBeThatOfTheirEnds) {
    for (const auto& [at, outside] : {std::pair{"gap=20mm", false}, {"gap=80mm", true}}) {
        const auto text = run_underbody({"linear", "model.toml", "--at", at}, folder_.path());
        EXPECT_EQ(text.output.find("N/m (outside the tables") != std::string::npos, outside) << text.output;
        EXPECT_EQ(text.output.find("is outside the lift_force table") != std::string::npos, outside) << text.output;
        EXPECT_THAT(text.output, testing::Not(HasSubstr("stiffness -0 ")));
        const nlohmann::json document = json({"linear", "model.toml", "--at", at});
        EXPECT_EQ(document["heave"][0]["outside"], outside);
        EXPECT_EQ(document.value("warnings", nlohmann::json::array()).dump().find("is outside") != std::string::npos,
                  outside);
    }
    EXPECT_EQ(json({"linear", "model.toml"})["heave"][0]["outside"], false);
}

TEST_F(ModelForces, WhatHoldsAForceAtItsReferenceIsSaid) {
    core::write_file(folder_.path() / "one.csv", "gap [mm], lift_force [mN]\n1, 80\n5, 20\n20, 2\n");
    core::write_file(folder_.path() / "scaled.toml",
                     "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.754 kg\"\nnet_weight = \"10 mN\"\n"
                     "[[force]]\nquantity = \"lift_force\"\ntable = \"one.csv\"\n"
                     "scale.speed = { reference = \"0.5 m/s\", exponent = 2 }\n");
    const std::string said = "speed is not given: lift_force is that at its reference, speed 0.5 m/s";
    for (const std::vector<std::string>& command : {std::vector<std::string>{"linear", "scaled.toml"},
                                                    {"simulate", "scaled.toml", "--from", "gap=5mm", "--for", "1"},
                                                    {"control", "scaled.toml", "--hold", "5mm", "--from", "gap=6mm"},
                                                    {"learn", "scaled.toml", "--method", "grid"}}) {
        EXPECT_EQ(json(command)["held_at_reference"], nlohmann::json({said})) << command.front();
        EXPECT_THAT(run_underbody(command, folder_.path()).output, HasSubstr(said));
        std::vector<std::string> given = command;
        given.insert(given.end(), {"--conditions", "speed=0.4"});
        EXPECT_EQ(json(given)["held_at_reference"], nlohmann::json::array()) << command.front();
    }
}

TEST_F(ModelForces, ATableInAxesThatPointDownHasNoBalance) {
    const auto written = run_underbody(
        {"export", "lift.csv", "--frame", "ned", "--format", "json", "--out", "down.json", "--where", "speed=0.5"},
        folder_.path());
    ASSERT_EQ(written.exit_code, 0) << written.errors;
    const auto run = run_underbody({"table", "equilibria", "down.json", "--weight", "10 mN"}, folder_.path());
    EXPECT_EQ(run.exit_code, 2) << run.output;
    EXPECT_THAT(run.errors, HasSubstr("z_force = -lift_force"));
}

TEST_F(ModelForces, TableAtTakesTheConditionsOfTheModelUnlessThePointSaysOtherwise) {
    const nlohmann::json held = json({"table", "at", "model.toml", "gap=4mm"}),
                         given = json({"table", "at", "bare.toml", "gap=4mm,speed=0.5"}),
                         other = json({"table", "at", "model.toml", "gap=4mm,speed=0.6", "gap=4mm"});
    EXPECT_NEAR(held["value"].get<double>(), given["value"].get<double>(), 1e-12);
    EXPECT_EQ(held["held"]["speed"]["from"], "condition of the model");
    EXPECT_NEAR(held["held"]["speed"]["value"].get<double>(), 0.5, 1e-12);
    EXPECT_GT(other["values"][0]["value"].get<double>(), 1.2 * held["value"].get<double>());
    EXPECT_NEAR(other["values"][1]["value"].get<double>(), held["value"].get<double>(), 1e-9)
        << "each point holds what it says, the model the rest";
    const auto text = run_underbody({"table", "at", "model.toml", "gap=4mm"}, folder_.path());
    EXPECT_THAT(text.output, HasSubstr("speed 0.5 m/s (condition of the model)"));
    const auto wrong = run_underbody({"table", "at", "model.toml", "gap=4mm,depth=1"}, folder_.path());
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.errors, HasSubstr("no force of the model depends on depth"));
    model("outside.toml", "[conditions]\nspeed = \"3 m/s\"\n");
    EXPECT_THAT(run_underbody({"table", "at", "outside.toml", "gap=4mm"}, folder_.path()).output,
                HasSubstr("speed 3 m/s is outside the lift_force table"));
    const nlohmann::json outside = json({"table", "at", "outside.toml", "gap=4mm"});
    EXPECT_EQ(std::count_if(outside["warnings"].begin(), outside["warnings"].end(),
                            [](const nlohmann::json& warning) {
                                return warning.get<std::string>().find("speed 3 m/s is outside the lift_force table") !=
                                       std::string::npos;
                            }),
              1)
        << outside["warnings"];
}

TEST_F(ModelForces, EquilibriaAndLinearAgreeWithTheTableOnGapAndError) {
    const nlohmann::json by_table = json(
        {"table", "equilibria", "lift.csv", "--kind", "interpolation", "--held", "speed=0.5", "--weight", "10 mN"});
    const nlohmann::json by_model = json({"table", "equilibria", "model.toml"}),
                         linear = json({"linear", "model.toml"});
    ASSERT_EQ(by_table["equilibria"].size(), 3U);
    ASSERT_EQ(by_model["equilibria"].size(), by_table["equilibria"].size());
    ASSERT_EQ(linear["heave"].size(), by_table["equilibria"].size());
    EXPECT_EQ(by_model["net_weight_from"], "model");
    EXPECT_NEAR(by_model["virtual_mass"].get<double>(), 3.954, 1e-9);
    for (std::size_t i = 0; i < by_table["equilibria"].size(); ++i) {
        const double gap = by_table["equilibria"][i]["gap"], sigma = by_table["equilibria"][i]["sigma"],
                     stiffness = by_table["equilibria"][i]["stiffness"];
        EXPECT_GT(sigma, 0);
        EXPECT_NEAR(by_model["equilibria"][i]["gap"].get<double>(), gap, 1e-6);
        EXPECT_NEAR(by_model["equilibria"][i]["sigma"].get<double>(), sigma, 0.03 * sigma);
        EXPECT_NEAR(linear["heave"][i]["gap"].get<double>(), gap, 1e-6);
        EXPECT_NEAR(linear["heave"][i]["sigma"].get<double>(), sigma, 0.03 * sigma);
        EXPECT_NEAR(linear["heave"][i]["stiffness"].get<double>(), stiffness, 1e-3 * std::abs(stiffness));
        EXPECT_GT(linear["heave"][i]["stiffness_sigma"].get<double>(), 0);
        const nlohmann::json& mode = linear["heave"][i]["modes"][0];
        if (mode["imaginary"].get<double>() > 0) {
            EXPECT_GT(mode["frequency_sigma"].get<double>(), 0);
            EXPECT_GT(mode["damping_ratio_sigma"].get<double>(), 0);
        }
    }
    const auto text = run_underbody({"linear", "model.toml"}, folder_.path());
    EXPECT_THAT(text.output,
                testing::ContainsRegex("at [0-9.]+ \\+- [0-9.]+ mm: stiffness -?[0-9.]+ \\+- [0-9.]+ N/m"));
    // Effects of the motion count too: a constant force with an error moves the balance.
    model(
        "pushed.toml",
        "[conditions]\nspeed = \"0.5 m/s\"\n[[effect]]\nname = \"constant_force\"\nforce = { value = \"0 N\", sigma = "
        "\"2 mN\" }\n");
    const nlohmann::json pushed = json({"linear", "pushed.toml"})["heave"][0];
    const double k = pushed["stiffness"], table_sigma = linear["heave"][0]["sigma"];
    EXPECT_NEAR(pushed["sigma"].get<double>(), std::hypot(table_sigma, 2e-3 / k), 1e-3 * table_sigma);
}

TEST_F(ModelForces, ExportHoldsTheConditionsOfTheModelAndSaysSo) {
    const nlohmann::json held = json({"export", "model.toml", "--out", "lift.json"});
    EXPECT_EQ(held["grid"].size(), 1U);
    EXPECT_NEAR(held["held"]["speed"]["value"].get<double>(), 0.5, 1e-12);
    EXPECT_GT(held["bytes"].get<double>(), 100);
    const nlohmann::json all = json({"export", "model.toml", "--axes", "gap,speed", "--out", "both.json"});
    EXPECT_EQ(all["grid"].size(), 2U);
    const nlohmann::json one = json({"table", "at", "lift.json", "gap=4mm"}),
                         two = json({"table", "at", "both.json", "gap=4mm,speed=0.5"});
    EXPECT_NEAR(one["value"].get<double>(), two["value"].get<double>(), 1e-12);
    const auto text = run_underbody({"export", "model.toml", "--out", "again.h"}, folder_.path());
    EXPECT_THAT(text.errors, HasSubstr("speed 0.5 m/s (condition of the model)"));
    EXPECT_THAT(text.errors, HasSubstr(" kB"));
}

TEST_F(ModelForces, TheLoopWithItsEstimatorAndSensorsHasAMapAndChances) {
    const std::vector<std::string> loop{"region", "model.toml",
                                        "--axes", "gap=2mm:40mm,heave_velocity=-0.03:0.03",
                                        "--grid", "8x6",
                                        "--for",  "20",
                                        "--lqr",  "reference=20mm,gap=1000"};
    const auto with = [&](std::vector<std::string> more) {
        std::vector<std::string> all = loop;
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    const nlohmann::json map =
        json(with({"--observer", "extended", "--gap-noise", "0.1mm", "--step", "0.05", "--no-velocity"}));
    EXPECT_EQ(map["loop"]["observer"], "extended");
    EXPECT_EQ(map["loop"]["feedback_on"], "estimated");
    EXPECT_NEAR(map["loop"]["sample_time"].get<double>(), 0.05, 1e-12);
    double sum = 0, held = 0;
    for (const auto& end : map["classes"]) {
        sum += end["fraction"].get<double>();
        held += end["name"] == "held" ? end["fraction"].get<double>() : 0;
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    EXPECT_GT(held, 0.2);
    const nlohmann::json chance = json(
        with({"--observer", "extended", "--gap-noise", "0.1mm", "--step", "0.05", "--no-velocity", "--draws", "3"}));
    EXPECT_EQ(chance["draws"], 3);
    EXPECT_EQ(chance["safe"].size(), 48U);
    EXPECT_NEAR(chance["area_mean"].get<double>(), held, 0.15);
    EXPECT_EQ(run_underbody(with({"--observer", "disturbance"}), folder_.path()).exit_code, 2);
    EXPECT_EQ(run_underbody(with({"--gap-noise", "1mm"}), folder_.path()).exit_code, 2);
    EXPECT_EQ(run_underbody({"region", "model.toml", "--observer", "extended"}, folder_.path()).exit_code, 2);
}

TEST_F(ModelForces, ADelayedActuatorChangesTheMapOfALoop) {
    model("slow.toml",
          "[conditions]\nspeed = \"0.5 m/s\"\n[[effect]]\nname = \"input_delay\"\ndelay = { value = \"1.5 s\" }\n");
    const auto held = [&](const std::string& file) {
        double sum = 0;
        const nlohmann::json map = json({"region", file, "--axes", "gap=2mm:40mm,heave_velocity=-0.05:0.05", "--grid",
                                         "20x20", "--feedback", "gap_gain=20,velocity_gain=15,reference=20mm"});
        for (const auto& end : map["classes"]) {
            sum += end["kind"] == "attractor" ? end["fraction"].get<double>() : 0;
        }
        return sum;
    };
    EXPECT_LT(held("slow.toml"), held("model.toml") - 0.1);
}

/// The logs of a simulated rig that its model knows whole, as CSV: input_force times `factor`, `late` seconds behind.
void write_rig(const std::filesystem::path& folder, double factor, double late) {
    heave_model(folder);
    const auto data = heave_runs([](double, double, double) { return 0.0; }, 6, 25, 81);
    std::string set = "kind = \"time_series\"\n[noise]\ngap = \"0.2 mm\"\n";
    for (const auto& run : data.runs) {
        const std::vector<double>& time = run.table.numbers("time");
        std::vector<double> input = run.values("input_force");
        const auto behind = static_cast<std::size_t>(late * 25 + 0.5);
        for (std::size_t i = input.size(); i-- > 0;) {
            input[i] = factor * input[i >= behind ? i - behind : 0];
        }
        core::Table logged;
        logged.add_numbers("time", "s", time);
        logged.add_numbers("gap", "m", run.values("gap"));
        logged.add_numbers("input_force", "N", input);
        core::write_csv(folder / (run.name + ".csv"), logged);
        set += "[[run]]\nfile = \"" + run.name + ".csv\"\n";
    }
    core::write_file(folder / "dataset.toml", set);
}

TEST_F(ModelForces, WhatDiscoverFindsWrongWithTheLogsPredictReadsToo) {
    struct Mistake {
        const char* name;
        double factor, late;
        const char* read_as;
    };
    for (const Mistake& mistake : {Mistake{"sign", -1, 0, "input_force times -1"},
                                   {"unit", 1000, 0, "input_force times 0.001"},
                                   {"clock", 1, 0.4, "s earlier than logged"}}) {
        const std::string name = mistake.name;
        write_rig(folder_.path() / name, mistake.factor, mistake.late);
        const nlohmann::json found =
            json({"discover", name + "/model.toml", "--data", name, "--out", name + "-found", "--placebo", "0",
                  "--candidates", "linear_damping,constant_force,added_mass"});
        EXPECT_EQ(found["verdict"], "none") << name;
        EXPECT_TRUE(found.contains("records_mended")) << name;
        const nlohmann::json predicted = json({"predict", name + "-found/model.toml", "--data", name});
        EXPECT_THAT(predicted["logs_read_as"].get<std::string>(), HasSubstr(mistake.read_as)) << name;
        EXPECT_EQ(predicted["input_between"]["from"], "declared") << name;
        EXPECT_LT(predicted["channels"]["gap"]["in_noise"].get<double>(), 1.4) << name;
        const nlohmann::json before = json({"predict", name + "/model.toml", "--data", name});
        EXPECT_GT(before["channels"]["gap"]["in_noise"].get<double>(), 5) << name;
    }
    const std::string told = run_underbody({"discover", "sign/model.toml", "--data", "sign", "--out", "told",
                                            "--placebo", "0", "--candidates", "linear_damping"},
                                           folder_.path())
                                 .output;
    EXPECT_THAT(told, HasSubstr("New model: told/model.toml"));
    EXPECT_THAT(told, HasSubstr(" mm -> ")) << "the error before and after";
}

TEST_F(ModelForces, ATurnedInputBesideAnEffectIsReadSoByPredictToo) {
    UNDERBODY_NEEDS_SHARED("examples/loop/example-00/model.toml");
    const std::filesystem::path rig = folder_.path() / "rig";
    std::filesystem::copy(shared_folder() / "examples/loop/example-00", rig, std::filesystem::copy_options::recursive);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(rig)) {
        if (entry.path().filename().string().starts_with("run-")) {  // a log whose input has the other sign
            const core::Table table = core::read_csv(entry.path());
            core::Table turned;
            for (const core::Column& column : table.columns()) {
                std::vector<double> values = column.numbers;
                for (double& v : values) {
                    v *= column.name == "input_force" ? -1 : 1;
                }
                turned.add_numbers(column.name, column.unit, values);
            }
            std::filesystem::remove(entry.path());
            core::write_csv(entry.path(), turned);
        }
    }
    const nlohmann::json found =
        json({"discover", "rig/model.toml", "--data", "rig", "--out", "found", "--placebo", "0"});
    EXPECT_EQ(found["effects"][0]["name"], "coulomb_friction");
    EXPECT_TRUE(found["consequence"].contains("separation"));
    EXPECT_LT(found["consequence"]["separation"]["after"]["departure_rms"].get<double>(),
              0.5 * found["consequence"]["separation"]["before"]["departure_rms"].get<double>());
    EXPECT_FALSE(found["consequence"]["map"]["after"]["classes"].empty());
    const nlohmann::json predicted = json({"predict", "found/model.toml", "--data", "rig/held-out"});
    EXPECT_THAT(predicted["logs_read_as"].get<std::string>(), HasSubstr("input_force times -1"));
    const double stated = found["error"]["after"]["rmse"];
    EXPECT_NEAR(predicted["channels"]["gap"]["rmse"].get<double>(), stated, 0.03 * stated);
    EXPECT_GT(json({"predict", "rig/model.toml", "--data", "rig/held-out"})["channels"]["gap"]["rmse"].get<double>(),
              10 * stated);
}

}  // namespace

}  // namespace underbody::test
