// One force, whoever says it: what `simulate` sees, `table at` and every export of a model agree, and all of them say
// where there is no CFD.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "core/random.h"
#include "core/table.h"
#include "tests/support/support.h"
#include "tests/surrogates/tables/fmu_loader.h"
#include "tests/surrogates/tables/jsbsim_evaluator.h"
#include "tests/surrogates/tables/json_evaluator.h"

namespace underbody {
namespace {

using test::run_underbody;

const std::array<std::string, 3> quantities = {"lift_force", "drag_force", "pitch_moment"};

bool have(const char* program) {
    return std::system(("command -v " + std::string(program) + " > /dev/null 2>&1").c_str()) == 0;
}

/// Value of each quantity, and whether there is no data.
struct Said {
    std::array<double, 3> value{};
    bool no_data = false;
};

/// The shipped vehicle at 0.5 m/s and 6 V, exported once into every format.
class OneForce : public ::testing::Test {
protected:
    static void SetUpTestSuite() {
        folder_ = new core::TemporaryFolder;
        core::Random random(20);
        places_ = {{0.005, 3 * M_PI / 180}, {0.001, -4 * M_PI / 180}};
        for (int i = 0; i < 10; ++i) {
            places_.push_back({random.uniform(0.001, 0.02), random.uniform(-0.08, 0.08)});
        }
        errors_ = export_as("c", "hull.h");
    }
    static void TearDownTestSuite() {
        delete folder_;
        folder_ = nullptr;
    }

    static std::string model() { return (test::source_folder() / "cases" / "evie" / "model.toml").string(); }

    /// Largest errors that the export states.
    static std::array<double, 3> export_as(const std::string& format, const std::string& file,
                                           const std::vector<std::string>& more = {}) {
        std::vector<std::string> words{"export",     model(),
                                       "--quantity", "lift_force,drag_force,pitch_moment",
                                       "--where",    "speed=0.5,jet_voltage=6V",
                                       "--axes",     "gap,pitch",
                                       "--format",   format,
                                       "--out",      file,
                                       "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const auto run = run_underbody(words, folder_->path());
        EXPECT_EQ(run.exit_code, 0) << format << run.errors;
        std::array<double, 3> errors{};
        const auto json = nlohmann::json::parse(run.output);
        for (std::size_t q = 0; q < 3; ++q) {
            errors[q] = json["quantities"][q]["max_error"];
        }
        return errors;
    }

    /// What `table at` says of the model; the truth of the others.
    static const std::vector<Said>& model_says() {
        static std::vector<Said> all;
        for (std::size_t i = all.size(); i < 12; ++i) {
            std::ostringstream place;
            place.precision(17);
            place << "gap=" << places_[i][0] << ",pitch=" << places_[i][1];
            const auto run = run_underbody({"table", "at", model(), place.str(), "--where", "speed=0.5,jet_voltage=6V",
                                            "--quantity", "lift_force,drag_force,pitch_moment", "--json"});
            EXPECT_EQ(run.exit_code, 0) << run.errors;
            const auto values = nlohmann::json::parse(run.output)["values"];
            Said said;
            for (std::size_t q = 0; q < 3; ++q) {
                said.value[q] = values[q]["value"];
                said.no_data = said.no_data || values[q]["no_data"].get<bool>();
            }
            all.push_back(said);
        }
        return all;
    }

    static void expect_said(std::size_t place, const Said& said, const std::array<double, 3>& allowed,
                            const std::string& who) {
        const Said& wanted = model_says()[place];
        for (std::size_t q = 0; q < 3; ++q) {
            EXPECT_NEAR(said.value[q], wanted.value[q], allowed[q]) << who << ", " << quantities[q] << " at " << place;
        }
        EXPECT_EQ(said.no_data, wanted.no_data) << who << " at " << place;
    }
    static std::array<double, 3> rounding() { return {1e-11, 1e-11, 1e-12}; }

    static core::TemporaryFolder* folder_;
    static std::vector<std::array<double, 2>> places_;
    static std::array<double, 3> errors_;
};
core::TemporaryFolder* OneForce::folder_ = nullptr;
std::vector<std::array<double, 2>> OneForce::places_;
std::array<double, 3> OneForce::errors_;

TEST_F(OneForce, IsTheOneThatTheMotionSees) {
    const auto run = run_underbody({"simulate", model(), "--motion", "heave-pitch", "--from", "gap=5mm,pitch=3deg",
                                    "--conditions", "speed=0.5,jet_voltage=6V", "--for", "0.05", "--out", "run.csv"},
                                   folder_->path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto motion = core::read_csv(folder_->path() / "run.csv");
    const Said& said = model_says()[0];
    EXPECT_FALSE(said.no_data);
    EXPECT_NEAR(motion.numbers("lift_force")[0], said.value[0], 1e-6) << "within what the table of the model says";
    EXPECT_NEAR(motion.numbers("pitch_moment")[0], said.value[2], 1e-6);
    EXPECT_LT(errors_[0], 1e-5);
}

TEST_F(OneForce, HasNoCfdInTheEmptyCorner) {
    EXPECT_TRUE(model_says()[1].no_data);
    const auto of_points =
        run_underbody({"table", "at", (test::source_folder() / "cases" / "evie" / "tables" / "base.csv").string(),
                       "gap=1mm,pitch=-4deg", "--quantity", "lift_force", "--json"});
    ASSERT_EQ(of_points.exit_code, 0) << of_points.errors;
    const auto json = nlohmann::json::parse(of_points.output);
    EXPECT_TRUE(json["no_data"].get<bool>());
    EXPECT_FALSE(json["outside"].get<bool>());
}

TEST_F(OneForce, IsThatOfTheHeaderInC) {
    for (const char* compiler : {"gcc", "clang"}) {
        if (!have(compiler)) {
            GTEST_SKIP() << "skipped: " << compiler << " is not installed; the header was not compiled";
        }
        std::string points;
        for (std::size_t i = 0; i < 12; ++i) {
            std::ostringstream row;
            row.precision(17);
            row << "{" << places_[i][0] << "," << places_[i][1] << "},";
            points += row.str();
        }
        core::write_file(
            folder_->path() / "main.c",
            "#include <stdio.h>\n#include \"hull.h\"\nstatic const double p[12][2] = {" + points +
                "};\nint main(void) {\n    int i;\n    for (i = 0; i < 12; ++i) {\n        hull_result r;\n"
                "        hull_at(p[i], &r);\n        printf(\"%.17g %.17g %.17g %d\\n\", "
                "r.lift_force.value, r.drag_force.value, r.pitch_moment.value, r.no_data);\n    }\n    "
                "return 0;\n}\n");
        ASSERT_EQ(std::system(("cd '" + folder_->path().string() + "' && " + compiler +
                               " -std=c99 -Wall -Wextra -Werror -Wno-unused-function main.c -o main && ./main > "
                               "out.txt")
                                  .c_str()),
                  0);
        std::istringstream out(core::read_file(folder_->path() / "out.txt"));
        for (std::size_t i = 0; i < 12; ++i) {
            Said said;
            int flag = 0;
            out >> said.value[0] >> said.value[1] >> said.value[2] >> flag;
            said.no_data = flag != 0;
            expect_said(i, said, rounding(), compiler);
        }
    }
}

TEST_F(OneForce, IsThatOfJsonAndCsv) {
    export_as("json", "hull.json");
    const auto file = nlohmann::json::parse(core::read_file(folder_->path() / "hull.json"));
    std::vector<test::JsonTable> each;
    for (std::size_t q = 0; q < 3; ++q) {
        nlohmann::json one = file;
        for (const char* key : {"hermite", "sigma", "cell_error", "growth"}) {
            one[key] = q == 0 ? file[key] : file["more"][q - 1][key];
        }
        each.push_back({one});
    }
    export_as("csv", "hull.csv");
    for (std::size_t i = 0; i < 12; ++i) {
        Said said;
        for (std::size_t q = 0; q < 3; ++q) {
            const auto v = each[q].at(places_[i].data());
            said.value[q] = v.value;
            said.no_data = said.no_data || v.no_data;
        }
        expect_said(i, said, rounding(), "json");
    }
    for (std::size_t i = 0; i < 4; ++i) {
        std::ostringstream place;
        place.precision(17);
        place << "gap=" << places_[i][0] << ",pitch=" << places_[i][1];
        const auto run = run_underbody(
            {"table", "at", "hull.csv", place.str(), "--quantity", "lift_force,drag_force,pitch_moment", "--json"},
            folder_->path());
        ASSERT_EQ(run.exit_code, 0) << run.errors;
        const auto values = nlohmann::json::parse(run.output)["values"];
        Said said;
        for (std::size_t q = 0; q < 3; ++q) {
            said.value[q] = values[q]["value"];
            said.no_data = said.no_data || values[q]["no_data"].get<bool>();
        }
        expect_said(i, said, rounding(), "csv");
    }
}

TEST_F(OneForce, IsThatOfOctave) {
    if (!have("octave-cli") && !have("octave")) {
        GTEST_SKIP() << "skipped: Octave is not installed; the .m was not run";
    }
    export_as("mat", "hull.mat");
    std::ostringstream points;
    points.precision(17);
    for (std::size_t i = 0; i < 12; ++i) {
        points << places_[i][0] << " " << places_[i][1] << ";";
    }
    core::write_file(folder_->path() / "run.m",
                     "[v,s,g,o,e]=hull_at([" + points.str() + "]);printf('%.17g %.17g %.17g %d\\n',[v e]');");
    ASSERT_EQ(std::system(("cd '" + folder_->path().string() +
                           "' && $(command -v octave-cli || command -v octave) run.m > octave.txt 2> errors.txt")
                              .c_str()),
              0)
        << core::read_file(folder_->path() / "errors.txt");
    std::istringstream out(core::read_file(folder_->path() / "octave.txt"));
    for (std::size_t i = 0; i < 12; ++i) {
        Said said;
        int flag = 0;
        out >> said.value[0] >> said.value[1] >> said.value[2] >> flag;
        said.no_data = flag != 0;
        expect_said(i, said, rounding(), "Octave");
    }
}

TEST_F(OneForce, IsThatOfTheFmu) {
    export_as("fmu", "hull.fmu");
    const auto entries = test::unzipped(core::read_file(folder_->path() / "hull.fmu"));
    if (!entries.contains("binaries/linux64/hull.so")) {
        GTEST_SKIP() << "skipped: no C compiler, so the FMU has no binary";
    }
    const std::string& xml = entries.at("modelDescription.xml");
    const auto reference = [&](const std::string& name) {
        const std::size_t at = xml.find("name=\"" + name + "\" valueReference=\"");
        return static_cast<unsigned>(std::stoul(xml.substr(at + name.size() + 24, 6)));
    };
    const std::size_t g = xml.find("guid=\"") + 6;
    core::write_file(folder_->path() / "hull.so", entries.at("binaries/linux64/hull.so"));
    test::Fmu fmu(folder_->path() / "hull.so");
    ASSERT_TRUE(fmu.loaded());
    void* instance = fmu.instantiate(1, xml.substr(g, xml.find('"', g) - g));
    ASSERT_NE(instance, nullptr);
    const unsigned inputs[2] = {reference("gap"), reference("pitch")};
    const unsigned outputs[4] = {reference("lift_force"), reference("drag_force"), reference("pitch_moment"),
                                 reference("no_data")};
    for (std::size_t i = 0; i < 12; ++i) {
        double out[4];
        ASSERT_EQ(fmu.call("fmi2SetReal", instance, static_cast<const unsigned*>(inputs), std::size_t{2},
                           static_cast<const double*>(places_[i].data())),
                  test::ok);
        ASSERT_EQ(fmu.call("fmi2GetReal", instance, static_cast<const unsigned*>(outputs), std::size_t{4},
                           static_cast<double*>(out)),
                  test::ok);
        expect_said(i, {{out[0], out[1], out[2]}, out[3] != 0}, rounding(), "FMU");
    }
    fmu.free(instance);
}

/// Straight lines, within what is stated.
TEST_F(OneForce, IsThatOfJsbsimWithinItsError) {
    const auto errors = export_as("jsbsim", "hull.xml", {"--max-error", "2%"});
    std::string xml = core::read_file(folder_->path() / "hull.xml");
    for (const char* axis : {"pitch", "gap"}) {  // from the state of the vehicle; here they are given
        const std::size_t begin = xml.find("<function name=\"underbody/hull/" + std::string(axis) + "\">");
        ASSERT_NE(begin, std::string::npos);
        xml.erase(begin, xml.find("</function>", begin) + 11 - begin);
    }
    test::Jsbsim file(xml);
    for (std::size_t i = 0; i < 12; ++i) {
        file.properties["underbody/hull/gap"] = places_[i][0];
        file.properties["underbody/hull/pitch"] = places_[i][1];
        Said said;
        for (std::size_t q = 0; q < 3; ++q) {
            said.value[q] = file.property("underbody/hull/" + quantities[q]);
        }
        said.no_data = file.property("underbody/hull/no_data") > 0.5;
        expect_said(i, said, errors, "JSBSim");
    }
}

}  // namespace
}  // namespace underbody
