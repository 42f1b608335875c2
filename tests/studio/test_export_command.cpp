#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/child_process.h"
#include "core/file.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

using test::run_underbody;
using ::testing::HasSubstr;

TEST(ExportCommand, WritesEveryFormatAndLeavesFilesOfOthersAlone) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv",
                     "gap [mm], lift_force [N]\n1, .66\n2, .4\n3, .296\n5, .27\n10, .297\n");
    for (const char* format : {"c", "csv", "json", "mat", "jsbsim", "simulink", "modelica", "fmu"}) {
        const std::string out = std::string("out.") + format;
        const auto run = run_underbody({"export", "lift.csv", "--format", format, "--out", out}, folder.path());
        EXPECT_EQ(run.exit_code, 0) << format << run.errors;
        EXPECT_THAT(run.output, HasSubstr(out));
        EXPECT_TRUE(std::filesystem::exists(folder.path() / out)) << format;
    }
    core::write_file(folder.path() / "mine.h", "int precious;\n");
    const auto run = run_underbody({"export", "lift.csv", "--format", "c", "--out", "mine.h"}, folder.path());
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_THAT(run.errors, HasSubstr("no force table that Underbody wrote"));
    EXPECT_EQ(core::read_file(folder.path() / "mine.h"), "int precious;\n");
    EXPECT_EQ(run_underbody({"export", "lift.csv", "--format", "d", "--out", "x"}, folder.path()).exit_code, 2);
    std::filesystem::create_directory(folder.path() / "inside");
    const auto into = run_underbody({"export", "lift.csv", "--format", "c", "--out", "inside"}, folder.path());
    EXPECT_EQ(into.exit_code, 3);
    EXPECT_THAT(into.errors, HasSubstr("name a file in it, such as inside/lift"));
    EXPECT_THAT(into.errors, testing::Not(HasSubstr("--force")));
}

TEST(ExportCommand, ProvesAHeaderBeforeItIsWritten) {
    if (!cases::find_program("cc")) {
        GTEST_SKIP() << "skipped: cc is not installed";
    }
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv",
                     "gap [mm], lift_force [N]\n1, .66\n2, .4\n3, .296\n5, .27\n10, .297\n");
    const auto run = run_underbody({"export", "lift.csv", "--out", "lift.h", "--prove", "--json"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto proof = nlohmann::json::parse(run.output).at("proof");
    EXPECT_EQ(proof.at("points"), 10000);
    EXPECT_EQ(proof.at("equal"), true);
    EXPECT_THAT(run.errors, HasSubstr("equal: value, slope and error at 10,000 points"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "lift.h"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "lift_test.c")) << "it is no self-test";
    EXPECT_EQ(run_underbody({"export", "lift.csv", "--out", "lift.json", "--prove"}, folder.path()).exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "lift.json"));
}

TEST(ExportCommand, TakesAModelWithWhatWasFoundInIt) {
    core::TemporaryFolder folder;
    core::write_file(folder.path() / "lift.csv",
                     "gap [mm], lift_force [N]\n1, .66\n2, .4\n3, .296\n5, .27\n10, .297\n");
    core::write_file(folder.path() / "model.toml",
                     "[vehicle]\nmass = \"2.2 kg\"\n[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n"
                     "scale.speed = { reference = \"0.5 m/s\", exponent = 2 }\n"
                     "[[effect]]\nname = \"sensor_gain\"\ngain = 1.1\n"
                     "[[effect]]\nname = \"speed_exponent\"\nexponent = { value = 1.5, sigma = 0.1 }\n");
    const auto run = run_underbody(
        {"export", "model.toml", "--where", "speed=1m/s", "--format", "c", "--out", "lift.h"}, folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_THAT(run.errors, HasSubstr("sensor_gain"));
    const std::string header = core::read_file(folder.path() / "lift.h");
    EXPECT_THAT(header, HasSubstr("Holds for speed = 1 m/s"));
    EXPECT_THAT(header, HasSubstr("Of mass = 2.2 kg"));
    const auto at =
        run_underbody({"table", "at", "model.toml", "gap=5mm", "--where", "speed=1m/s", "--json"}, folder.path());
    ASSERT_EQ(at.exit_code, 0) << at.errors;
    EXPECT_THAT(at.output, HasSubstr("0.7636"));  // .27 N * 2^1.5
    EXPECT_EQ(
        run_underbody({"export", "model.toml", "--where", "sped=1", "--format", "c", "--out", "x.h"}, folder.path())
            .exit_code,
        2);
}

/// A model of a passive and a jet's force, and a moment, over gap and pitch.
void write_model(const std::filesystem::path& folder) {
    std::string lift = "gap [mm], pitch [deg], lift_force [N], lift_force_sigma [N]\n",
                moment = "gap [mm], pitch [deg], pitch_moment [N m]\n";
    for (const double gap : {1.0, 2.0, 4.0, 7.0, 12.0, 20.0}) {
        for (const double pitch : {-5.0, -2.0, 0.0, 2.0, 5.0}) {
            const std::string at = std::to_string(gap) + ", " + std::to_string(pitch) + ", ";
            lift += at + std::to_string(2 / (gap + 1) + 0.05 * pitch - 0.4) + ", 0.01\n";
            moment += at + std::to_string(0.002 * pitch - 0.01 / gap) + "\n";
        }
    }
    core::write_file(folder / "lift.csv", lift);
    core::write_file(folder / "moment.csv", moment);
    core::write_file(folder / "jet.csv", "gap [mm], lift_force [N]\n1, .66\n2, .4\n3, .296\n5, .27\n10, .297\n");
    core::write_file(folder / "model.toml",
                     "[vehicle]\nmass = \"2.2 kg\"\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 "
                     "mm\"\nbase_depth = \"54 mm\"\n"
                     "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\nscale.speed = { reference = \"0.5 "
                     "m/s\", exponent = 2 }\n"
                     "[[force]]\nquantity = \"lift_force\"\ntable = \"jet.csv\"\nscale.jet_voltage = { reference = "
                     "\"10 V\", exponent = 2 }\n"
                     "[[force]]\nquantity = \"pitch_moment\"\ntable = \"moment.csv\"\nscale.speed = { reference = "
                     "\"0.5 m/s\", exponent = 2 }\n");
}

TEST(ExportCommand, WritesAWholeModelIntoOneHeader) {
    core::TemporaryFolder folder;
    write_model(folder.path());
    const auto run = run_underbody({"export", "model.toml", "--quantity", "all", "--axes",
                                    "gap,pitch,speed=0:0.8,jet_voltage=0:12V", "--out", "body.h", "--json"},
                                   folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto json = nlohmann::json::parse(run.output);
    ASSERT_EQ(json["quantities"].size(), 2u);
    EXPECT_LT(json["quantities"][0]["max_error"].get<double>(), 1e-9)
        << "tables times squares are given back but for the kink where the jet's table ends";
    EXPECT_LT(json["quantities"][1]["max_error"].get<double>(), 1e-15);
    core::write_file(
        folder.path() / "main.c",
        "#include <stdio.h>\n#include \"body.h\"\nint main(void) {\n    const double p[4] = {0.0053, 0.031, 0.66, "
        "7};\n    body_result r;\n    body_at(p, &r);\n"
        "    printf(\"%.15g %.15g %d\", r.lift_force.value, r.pitch_moment.value, r.outside);\n    return 0;\n}\n");
    if (std::system("command -v gcc > /dev/null 2>&1") != 0) {
        GTEST_SKIP() << "skipped: gcc is not installed; the header was not compiled";
    }
    ASSERT_EQ(
        std::system(("cd '" + folder.path().string() +
                     "' && gcc -std=c99 -Wall -Wextra -Werror -Wno-unused-function main.c -o main && ./main > out.txt")
                        .c_str()),
        0);
    double lift = 0, moment = 0;
    int outside = 1;
    ASSERT_EQ(std::sscanf(core::read_file(folder.path() / "out.txt").c_str(), "%lf %lf %d", &lift, &moment, &outside),
              3);
    EXPECT_EQ(outside, 0);
    // The same place by another command; the model's own tables and squares, each by the fit that a table and a model
    // take by one rule.
    const auto at = run_underbody(
        {"table", "at", "model.toml", "gap=5.3mm,pitch=0.031", "--where", "speed=0.66,jet_voltage=7V", "--json"},
        folder.path());
    ASSERT_EQ(at.exit_code, 0) << at.errors;
    const auto values = nlohmann::json::parse(at.output)["values"];
    EXPECT_NEAR(values[0]["value"].get<double>(), lift, 1e-12);
    EXPECT_NEAR(values[1]["value"].get<double>(), moment, 1e-12);
    const auto own = [&](const char* file, const char* place, const char* quantity, const char* what = "value") {
        const auto one = run_underbody({"table", "at", file, place, "--quantity", quantity, "--json"}, folder.path());
        return nlohmann::json::parse(one.output)[what].get<double>();
    };
    EXPECT_NEAR(lift,
                1.7424 * own("lift.csv", "gap=5.3mm,pitch=0.031", "lift_force") +
                    0.49 * own("jet.csv", "gap=5.3mm", "lift_force"),
                1e-12);
    EXPECT_NEAR(moment, 1.7424 * own("moment.csv", "gap=5.3mm,pitch=0.031", "pitch_moment"), 1e-12);
    // The errors of both tables come along; sampled, an error is held from below.
    const double sigma = std::hypot(1.7424 * own("lift.csv", "gap=5.3mm,pitch=0.031", "lift_force", "sigma"),
                                    0.49 * own("jet.csv", "gap=5.3mm", "lift_force", "sigma"));
    EXPECT_GT(sigma, 0.002);
    EXPECT_GE(values[0]["sigma"].get<double>(), sigma * (1 - 1e-9));
    EXPECT_LT(values[0]["sigma"].get<double>(), 1.1 * sigma);
    EXPECT_FALSE(values[0]["outside"].get<bool>());
    // Between 10 mm, where the jet's table ends, and 20 mm, where the other does, the point is outside, and the sum
    // goes on.
    const auto beyond = run_underbody(
        {"table", "at", "model.toml", "gap=15mm,pitch=0", "--where", "speed=0.5,jet_voltage=10V", "--json"},
        folder.path());
    const auto far = nlohmann::json::parse(beyond.output)["values"][0];
    EXPECT_TRUE(far["outside"].get<bool>());
    EXPECT_TRUE(far["no_data"].get<bool>());
    EXPECT_NEAR(far["value"].get<double>(), own("lift.csv", "gap=15mm,pitch=0", "lift_force") + 0.297, 1e-12);
}

TEST(ExportCommand, AppliesAModelToTheBodyOfJsbsim) {
    core::TemporaryFolder folder;
    write_model(folder.path());
    const auto run = run_underbody({"export", "model.toml", "--quantity", "all", "--out", "hull.xml"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const std::string xml = core::read_file(folder.path() / "hull.xml");
    EXPECT_THAT(xml, HasSubstr("<force name=\"hull_z\" frame=\"BODY\">"));
    EXPECT_THAT(xml, HasSubstr("<z> -0.054 </z>"));
    EXPECT_THAT(xml, HasSubstr("<moment name=\"hull_pitch_moment\""));
    EXPECT_EQ(run_underbody({"export", "lift.csv", "--out", "lift.xml", "--base-centre", "0,0,54 mm"}, folder.path())
                  .exit_code,
              0);
    EXPECT_THAT(core::read_file(folder.path() / "lift.xml"), HasSubstr("<z> -0.054 </z>"));
    EXPECT_EQ(
        run_underbody({"export", "lift.csv", "--out", "lift.xml", "--base-centre", "0,54 mm"}, folder.path()).exit_code,
        2);
}

TEST(ExportCommand, RefusesWhatAModelCannotGive) {
    core::TemporaryFolder folder;
    write_model(folder.path());
    for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--axes", "gap,speed=0.8:0"},
                                                  {"--axes", "gap,speed=0.8"},
                                                  {"--axes", "gap,sped=0:1"},
                                                  {"--axes", "gap,temperature=280:290"},
                                                  {"--quantity", "drag_force"},
                                                  {"--kind", "gp"}}) {
        std::vector<std::string> words{"export", "model.toml", "--out", "x.h"};
        words.insert(words.end(), wrong.begin(), wrong.end());
        EXPECT_EQ(run_underbody(words, folder.path()).exit_code, 2) << wrong[1];
        EXPECT_FALSE(std::filesystem::exists(folder.path() / "x.h"));
    }
}

TEST(ExportCommand, WritesTheMotionOfAModelAsAnFmu) {
    core::TemporaryFolder folder;
    const std::string model = (test::source_folder() / "cases/evie/model.toml").string();
    const auto run = run_underbody(
        {"export", model, "--motion", "heave-pitch", "--from", "gap=20mm,pitch=1deg", "--out", "motion.fmu", "--json"},
        folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto json = nlohmann::json::parse(run.output);
    EXPECT_EQ(json["motion"], "heave-pitch");
    EXPECT_EQ(json["inputs"][0]["name"], "input_force");
    ASSERT_EQ(json["states"].size(), 4u);
    EXPECT_EQ(json["states"][0]["name"], "gap");
    EXPECT_EQ(json["states"][0]["start"], 0.02);
    EXPECT_EQ(json["outputs"][0]["unit"], "N");
    EXPECT_THAT(json["warnings"].dump(), HasSubstr("the speed is held at 0.35 m/s"));
    EXPECT_EQ(json["bytes"], std::filesystem::file_size(folder.path() / "motion.fmu"));

    core::write_file(folder.path() / "notes.fmu", "notes");
    for (const auto& [words, says] : std::vector<std::pair<std::vector<std::string>, std::string>>{
             {{model, "--motion", "heav", "--from", "gap=1mm", "--out", "w.fmu"}, "did you mean 'heave'"},
             {{model, "--motion", "heave", "--out", "w.fmu"}, "--from needs the gap"},
             {{model, "--motion", "heave", "--from", "gap=-1mm", "--out", "w.fmu"}, "the start lies in the ground"},
             {{model, "--motion", "heave", "--from", "gap=5mm", "--out", "w.h"}, "a motion is written as an FMU"},
             {{model, "--motion", "heave", "--from", "gap=5mm", "--out", "w.fmu", "--points", "gap=4"}, "of tables"},
             {{model, "--from", "gap=5mm", "--out", "w.fmu"}, "say --motion too"},
             {{model, "--motion", "heave", "--from", "gap=5mm", "--out", "notes.fmu"}, "no FMU that Underbody wrote"},
             {{"forces.csv", "--motion", "heave", "--from", "gap=5mm", "--out", "w.fmu"}, "the motion of a model"}}) {
        std::vector<std::string> all{"export"};
        all.insert(all.end(), words.begin(), words.end());
        const auto wrong = run_underbody(all, folder.path());
        EXPECT_TRUE(wrong.exit_code == 2 || wrong.exit_code == 3) << wrong.exit_code;
        EXPECT_THAT(wrong.errors, HasSubstr(says));
        EXPECT_FALSE(std::filesystem::exists(folder.path() / "w.fmu"));
    }
    EXPECT_EQ(core::read_file(folder.path() / "notes.fmu"), "notes");
}

}  // namespace
}  // namespace underbody
