// What a run rests on and nobody said, where the number is read: laws that count as 0, columns without a value, noise
// that the readings contradict.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/random.h"
#include "core/table.h"
#include "core/text.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* slider =
    "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_surge = \"0.2 kg\"\nadded_mass_sway = \"0.9 kg\"\n"
    "net_weight = \"1 N\"\nyaw_inertia = \"0.0075 kg m^2\"\nadded_inertia_yaw = \"0.0012 kg m^2\"\n"
    "[[jet]]\nname = \"port\"\nposition = [\"-100 mm\", \"-60 mm\", \"0 mm\"]\ndirection = [1, 0, 0]\n"
    "maximum = \"0.5 N\"\n"
    "[[jet]]\nname = \"starboard\"\nposition = [\"-100 mm\", \"60 mm\", \"0 mm\"]\ndirection = [1, 0, 0]\n"
    "maximum = \"0.5 N\"\n";
const std::string unsaid =
    "the model does not say drag.surge, drag.sway, drag.yaw and contact.friction: they count as 0";

class Unsaid : public testing::Test {
protected:
    core::TemporaryFolder folder_;

    ProgramRun run(const std::vector<std::string>& words) { return run_underbody(words, folder_.path()); }

    /// Runs straight ahead by both jets without any resistance: 0.2 m/s^2.
    void write_slides() {
        core::write_file(folder_.path() / "model.toml", slider);
        std::string csv =
            "time [s], position_x [m], position_y [m], heading [rad], thrust_port [N], thrust_starboard [N]\n";
        core::Random random(1);
        for (int k = 0; k < 200; ++k) {
            const double t = 0.04 * k;
            csv += core::format_number(t, 6) + ", " +
                   core::format_number(0.05 * t + 0.1 * t * t + 1e-3 * random.normal(), 8) + ", " +
                   core::format_number(1e-3 * random.normal(), 6) + ", " +
                   core::format_number(2e-3 * random.normal(), 6) + ", 0.24, 0.24\n";
        }
        core::write_file(folder_.path() / "slides" / "run-01.csv", csv);
        core::write_file(folder_.path() / "slides" / "dataset.toml",
                         "kind = \"time_series\"\nmotion = \"surface\"\n[[run]]\nfile = \"run-01.csv\"\n");
    }

    /// A body that swings over a spring of lift, read with 0.2 mm of noise.
    void write_swings(const std::string& noise, bool empty_gap, bool empty_velocity) {
        core::write_file(folder_.path() / "lift.csv",
                         "gap [mm], lift_force [N], lift_force_sigma [N]\n1, 0.8, .001\n20, 0.42, .001\n"
                         "40, 0.02, .001\n");
        core::write_file(folder_.path() / "heave.toml",
                         "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.8 kg\"\nnet_weight = \"0.42 N\"\n"
                         "[drag.heave]\nlinear = \"0.5 N s/m\"\n"
                         "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n");
        core::Random random(2);
        std::string data = "kind = \"time_series\"\n" + noise;
        for (int r = 1; r <= 3; ++r) {
            const std::string name = "run-0" + std::to_string(r);
            EXPECT_EQ(run({"simulate", "heave.toml", "--from", "gap=" + std::to_string(12 + 3 * r) + "mm", "--for",
                           "12", "--step", "20ms", "--out", "swings/" + name + ".csv", "--force"})
                          .exit_code,
                      0);
            const core::Table motion = core::read_csv(folder_.path() / "swings" / (name + ".csv"));
            std::string csv = "time [s], gap [m], heave_velocity [m/s]\n";
            for (std::size_t i = 0; i < motion.rows(); ++i) {
                const std::string gap = core::format_number(motion.numbers("gap")[i] + 2e-4 * random.normal(), 8),
                                  velocity = core::format_number(
                                      motion.numbers("heave_velocity")[i] + 1e-3 * random.normal(), 8);
                csv += core::format_number(motion.numbers("time")[i], 8) + ", " + (empty_gap && r == 2 ? "" : gap) +
                       ", " + (empty_velocity ? "" : velocity) + "\n";
            }
            core::write_file(folder_.path() / "swings" / (name + ".csv"), csv);
            data += "[[run]]\nfile = \"" + name + ".csv\"\n";
        }
        core::write_file(folder_.path() / "swings" / "dataset.toml", data);
    }
};

TEST_F(Unsaid, LawsThatCountAsZeroOnTheGroundAreSaid) {
    write_slides();
    const std::vector<std::string> simulate = {"simulate", "model.toml",
                                               "--motion", "surface",
                                               "--from",   "speed=0.1m/s",
                                               "--thrust", "port=0.1N,starboard=0.1N",
                                               "--for",    "2"};
    EXPECT_THAT(run(simulate).output, HasSubstr("warning: ")) << run(simulate).errors;
    for (const std::vector<std::string>& words :
         {simulate, {"predict", "model.toml", "--data", "slides", "--horizon", "1s"}}) {
        SCOPED_TRACE(words.front());
        EXPECT_THAT(run(words).output, HasSubstr(unsaid));
        auto as_json = words;
        as_json.emplace_back("--json");
        EXPECT_THAT(json::parse(run(as_json).output)["warnings"].dump(), HasSubstr(unsaid));
    }
    const std::string said =
        "[drag.surge]\nlinear = \"0 N s/m\"\n[drag.sway]\nquadratic = \"12 N s^2/m^2\"\n"
        "[drag.yaw]\nlinear = \"0 N m s\"\n[contact]\nfriction = 0\n";
    core::write_file(folder_.path() / "model.toml", said + slider);
    EXPECT_THAT(run(simulate).output, Not(HasSubstr("does not say"))) << "a declared 0 is one";
}

TEST_F(Unsaid, DiscoveryOnTheGroundSaysThemToo) {
    write_slides();
    core::write_file(folder_.path() / "slides" / "run-02.csv",
                     core::read_file(folder_.path() / "slides" / "run-01.csv") + "8, 7, 0, 0, 0.24, 0.24\n");
    core::write_file(folder_.path() / "slides" / "dataset.toml",
                     "kind = \"time_series\"\nmotion = \"surface\"\n[[run]]\nfile = \"run-01.csv\"\n[[run]]\nfile = "
                     "\"run-02.csv\"\n");
    const auto found = run({"discover", "model.toml", "--data", "slides", "--out", "found", "--candidates",
                            "ground_friction", "--placebo", "0"});
    EXPECT_THAT(found.output, HasSubstr(unsaid)) << found.errors;
}

TEST_F(Unsaid, AnFmuOfTheBodySaysThem) {
    core::write_file(folder_.path() / "model.toml",
                     std::string(slider).insert(
                         std::string(slider).find("[[jet]]"),
                         "length = \"200 mm\"\nroll_inertia = \"0.004 kg m^2\"\npitch_inertia = \"0.006 kg m^2\"\n"
                         "base_depth = \"50 mm\"\nbase_half_length = \"80 mm\"\n"));
    const auto made = run({"export", "model.toml", "--motion", "body", "--from", "gap=20mm,speed=0.1m/s", "--format",
                           "fmu", "--out", "body.fmu", "--json"});
    if (made.exit_code == 3 && made.errors.find("compiler") != std::string::npos) {
        GTEST_SKIP() << made.errors;
    }
    ASSERT_EQ(made.exit_code, 0) << made.errors;
    EXPECT_THAT(json::parse(made.output)["warnings"].dump(),
                HasSubstr("the model does not say drag.surge, drag.sway, drag.heave, drag.pitch, drag.yaw and "
                          "contact.friction: they count as 0 in the motion of the whole body"));
}

TEST_F(Unsaid, AChannelWithoutAValueIsNamedWithItsRun) {
    write_swings("", true, true);
    const auto predicted = run({"predict", "heave.toml", "--data", "swings"});
    ASSERT_EQ(predicted.exit_code, 0) << predicted.errors;
    EXPECT_THAT(predicted.output, HasSubstr("run run-02 has no value of gap: it is left out"));
    EXPECT_THAT(predicted.output, HasSubstr("the column 'heave_velocity' has no value: it counts as not measured"));
    EXPECT_THAT(predicted.output, Not(HasSubstr("shorter than")));
    EXPECT_THAT(predicted.output, Not(HasSubstr("heave_velocity: RMSE")));
    const auto found = run({"discover", "heave.toml", "--data", "swings", "--out", "found", "--candidates",
                            "constant_force", "--placebo", "0"});
    ASSERT_EQ(found.exit_code, 0) << found.errors;
    EXPECT_THAT(found.output, HasSubstr("run run-02 has no value of gap: it is left out"));
    EXPECT_THAT(found.output, Not(HasSubstr("nan m in the middle")));
    const std::string only = "kind = \"time_series\"\n[[run]]\nfile = \"run-02.csv\"\n";
    core::write_file(folder_.path() / "swings" / "dataset.toml", only);
    for (const std::vector<std::string>& words : {std::vector<std::string>{"predict", "heave.toml", "--data", "swings"},
                                                  {"discover", "heave.toml", "--data", "swings", "--out", "none"}}) {
        const auto none = run(words);
        EXPECT_EQ(none.exit_code, 3) << words.front();
        EXPECT_THAT(none.errors, HasSubstr("value of gap")) << words.front();
    }
}

TEST_F(Unsaid, PredictDoubtsADeclaredNoiseInTheWordsOfDiscover) {
    const std::string doubt =
        "the declared noise of gap (0.02 mm) disagrees with the scatter from reading to reading (0.";
    write_swings("[noise]\ngap = \"0.02 mm\"\n", false, false);
    const auto predicted = run({"predict", "heave.toml", "--data", "swings"});
    EXPECT_THAT(predicted.output, HasSubstr(doubt));
    EXPECT_THAT(predicted.output, HasSubstr("times the estimated noise"));
    const auto document = json::parse(run({"predict", "heave.toml", "--data", "swings", "--json"}).output);
    EXPECT_EQ(document["channels"]["gap"]["noise_from"], "estimated");
    EXPECT_NEAR(document["channels"]["gap"]["noise"].get<double>(), 2e-4, 2e-5);
    EXPECT_THAT(document["warnings"].dump(), HasSubstr(doubt));
    const auto found = run({"discover", "heave.toml", "--data", "swings", "--out", "found", "--candidates",
                            "constant_force", "--placebo", "0"});
    EXPECT_THAT(found.output, HasSubstr(doubt));
    const auto estimated = run({"estimate", "heave.toml", "--data", "swings"});
    EXPECT_THAT(estimated.output, HasSubstr(doubt));
    const auto estimate = json::parse(run({"estimate", "heave.toml", "--data", "swings", "--json"}).output);
    EXPECT_NEAR(estimate["noise"]["gap"]["value"].get<double>(), 2e-4, 2e-5);
    write_swings("[noise]\ngap = \"0.2 mm\"\n", false, false);
    const auto held = run({"predict", "heave.toml", "--data", "swings"});
    EXPECT_THAT(held.output, Not(HasSubstr("disagrees")));
    EXPECT_THAT(held.output, HasSubstr("times the declared noise"));
}

/// Every effect that acts on the input says so where no run has one, not only those whose name begins with it.
TEST_F(Unsaid, AnEffectOnAnInputThatNoRunHasDoesNothing) {
    write_swings("", false, false);
    const std::string model = core::read_file(folder_.path() / "heave.toml");
    for (const std::string effect : {"input_gain", "actuator_lag", "thrust_by_gap"}) {
        const std::string number = effect == "input_gain"     ? "gain = 1.1"
                                   : effect == "actuator_lag" ? "time_constant = \"0.1 s\""
                                                              : "loss = 0.3";
        core::write_file(folder_.path() / (effect + ".toml"),
                         model + "[[effect]]\nname = \"" + effect + "\"\n" + number + "\n");
        const auto predicted = run({"predict", effect + ".toml", "--data", "swings"});
        EXPECT_THAT(predicted.output, HasSubstr("the model's " + effect + " acts on input_force, which no run has"))
            << predicted.errors;
    }
    EXPECT_THAT(run({"predict", "heave.toml", "--data", "swings"}).output, Not(HasSubstr("which no run has")));
}

/// The scatter of coloured noise from reading to reading is a part of it: errors are told in what was declared, and by
/// the prediction and the discovery in the same.
TEST_F(Unsaid, AScatterBelowTheDeclaredNoiseDoesNotOverruleIt) {
    write_swings("[noise]\ngap = \"0.5 mm\"\n", false, false);
    const std::string doubt = "the figure is too large or the noise is coloured";
    const auto predicted = run({"predict", "heave.toml", "--data", "swings"});
    EXPECT_THAT(predicted.output, HasSubstr(doubt));
    EXPECT_THAT(predicted.output, HasSubstr("times the declared noise of 0.0005 m"));
    const auto found = run({"discover", "heave.toml", "--data", "swings", "--out", "found", "--candidates",
                            "constant_force", "--placebo", "0", "--json"});
    ASSERT_EQ(found.exit_code, 0) << found.errors;
    const json document = json::parse(found.output);
    EXPECT_THAT(document["warnings"].dump(), HasSubstr(doubt));
    EXPECT_NEAR(
        document["error"]["before"]["rmse"].get<double>() / document["error"]["in_noise"]["before"].get<double>(), 5e-4,
        1e-9);
}

TEST_F(Unsaid, ALogIsNotWhatActsWhereTheModelReadsLogsOtherwise) {
    write_swings("", false, false);
    core::write_file(folder_.path() / "push.csv", "time [s], input_force [N]\n0, 0.01\n1, 0.02\n2, 0.01\n");
    const std::vector<std::string> replay = {"simulate", "heave.toml", "--from", "gap=15mm",
                                             "--inputs", "push.csv",   "--for",  "2"};
    EXPECT_THAT(run(replay).output, Not(HasSubstr("at its word")));
    const std::string model = core::read_file(folder_.path() / "heave.toml");
    core::write_file(folder_.path() / "heave.toml", model + "[records]\ninput_force_between = \"held\"\n");
    EXPECT_THAT(run(replay).output, Not(HasSubstr("at its word"))) << "how it is held alone turns nothing round";
    core::write_file(folder_.path() / "heave.toml", model + "[records]\ninput_force_factor = -1\n");
    EXPECT_THAT(run(replay).output,
                HasSubstr("push.csv: taken at its word, as the inputs that act; [records] of the model "
                          "reads logs with input_force times -1"));
    auto as_json = replay;
    as_json.emplace_back("--json");
    EXPECT_THAT(json::parse(run(as_json).output)["warnings"].dump(), HasSubstr("at its word"));
}

TEST_F(Unsaid, EscapesThatReturnAreSaidOfDrawsToo) {
    write_swings("", false, false);
    std::vector<std::string> map = {"region", "heave.toml", "--axes", "gap=30mm:40mm,heave_velocity=0:0.1",
                                    "--grid", "5x5",        "--for",  "20"};
    const std::string said = "the force there pulls the vehicle back";
    EXPECT_THAT(run(map).output, HasSubstr(said));
    map.insert(map.end(), {"--draws", "3"});
    EXPECT_THAT(run(map).output, HasSubstr(said));
    map.emplace_back("--json");
    EXPECT_THAT(json::parse(run(map).output)["remarks"].dump(), HasSubstr(said));
}

/// What is given and cannot be used is said or refused.
TEST_F(Unsaid, WhatACommandCannotUseIsToldOrRefused) {
    write_swings("", false, false);
    const auto expect = [&](std::vector<std::string> words, int code, const std::string& text) {
        const auto got = run(words);
        EXPECT_EQ(got.exit_code, code) << words[0] << got.errors;
        EXPECT_THAT(got.output + got.errors, HasSubstr(text)) << words[0];
    };
    const std::vector<std::string> simulate = {"simulate", "heave.toml", "--for", "1", "--motion", "heave", "--from"};
    const auto from = [&](const std::string& start, const std::vector<std::string>& more = {}) {
        auto words = simulate;
        words.push_back(start);
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    expect(from("gap=9mm,pitch=3deg"), 0, "of the start not used: pitch; the motion in heave has no such state");
    EXPECT_THAT(run(from("gap=9mm,pitch=0")).output, Not(HasSubstr("not used")));
    expect(from("gap=9mm", {"--escape", "5mm"}), 2, "the start at gap 9 mm lies beyond --escape 5 mm");
    expect({"linear", "heave.toml", "--at", "gap=-2mm"}, 3, "--at lies in the ground: gap -2 mm");
    expect({"linear", "heave.toml", "--at", "gap=9mm,pitch=2deg"}, 0, "no motion in pitch: pitch 2 deg");
    expect(
        {"region", "heave.toml", "--axes", "gap=5mm:9mm,heave_velocity=-0.01:0.01", "--grid", "3x3", "--draws", "-3"},
        2, "'-3' is below 0");
    expect({"export", "lift.csv", "--quantity", "lift_force,lift_force", "--out", "l.h"}, 2,
           "'lift_force' is named twice");
    expect({"export", "heave.toml", "--axes", "gap=-5mm:30mm", "--out", "m.h"}, 0,
           "gap is asked from -5 to 30 mm, the tables of the model cover 1 to 40 mm: it ends with them");
}

}  // namespace
}  // namespace underbody::test
