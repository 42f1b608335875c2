// One number along the whole way, by the command line as a user goes it: files of CFD-Post whose lift is known in
// closed form, to a table, a model, a header for a controller that gcc compiles; a rig with an effect that the model
// does not declare; the effect found, the model mended, exported again. The error before and after is that of the
// numbers of the headers themselves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/random.h"
#include "core/table.h"
#include "core/text.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

/// Lift over a moving ground as the CFD has it, N.
double cfd_lift(double gap) { return 0.5 * std::exp(-gap / 0.010); }

/// The ground of the rig is rough: more lift near it, less far from it.
constexpr double near = 0.3;
constexpr double far = 0.2;
constexpr double rough_gap = 0.012;  // m
const char* const rough =
    "name = \"surface_roughness\"\nnear = { value = \"0.3\" }\nfar = { value = \"0.2\" }\nlength = { value = \"12 mm\" "
    "}\n";
double true_lift(double gap) {
    const double x = gap / rough_gap;
    return cfd_lift(gap) * (1 + (near - far * x * x) / (1 + x * x));
}

/// A cable of the rig pulls toward a gap of 20 mm.
constexpr double cable = 0.8;  // N/m
const char* const tied =
    "name = \"tether_stiffness\"\nstiffness = { value = \"0.8 N/m\" }\ngap = { value = \"20 mm\" }\n";

class EndToEnd : public testing::Test {
protected:
    core::TemporaryFolder scratch;
    const fs::path folder = scratch.path();

    /// stdout of a command that has to work.
    std::string run(const std::vector<std::string>& arguments) {
        const auto result = run_underbody(arguments, folder);
        EXPECT_EQ(result.exit_code, 0) << testing::PrintToString(arguments) << "\n" << result.errors;
        return result.output;
    }
    void put(const std::string& file, const std::string& text) { core::write_file(folder / file, text); }

    void write_fields() {
        for (const double mm : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 18.0, 22.0, 26.0, 30.0, 35.0,
                                40.0, 45.0, 50.0}) {
            put("study/fields/hull-h" + core::format_number(mm) + ".csv",
                cube_field(1e-3 * mm, cfd_lift(1e-3 * mm) / 1e-3));
        }
    }

    void make_study() {
        write_fields();
        run({"study", "add", "study", "--files", "fields/{variant}-h{gap:mm}.csv", "--condition", "speed=0.5m/s"});
        put("study/glide.toml",
            "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.8 kg\"\nnet_weight = \"0.1 N\"\n"
            "[drag.heave]\nlinear = \"0.4 N s/m\"\nquadratic = \"8 N s^2/m^2\"\n[conditions]\nspeed = \"0.5 m/s\"\n");
        put("study/study.toml",
            core::read_file(folder / "study/study.toml") +
                "[[table]]\nname = \"lift\"\nquantity = \"lift_force\"\naxes = [\"gap\"]\nwhere = { speed = 0.5 }\n"
                "net_weight = \"0.1 N\"\nvirtual_mass = \"4 kg\"\nexports = [\"c\"]\n"
                "[[region]]\nname = \"glide\"\nmodel = \"glide.toml\"\nforces = [\"lift\"]\n"
                "axes = [\"gap=1mm:50mm\", \"heave_velocity=-0.05:0.05\"]\nfor = \"30 s\"\ncolumns = 30\nrows = 30\n");
        run({"study", "run", "study", "--no-pictures"});
    }

    /// Runs of the true rig, with an effect that its model lacks, seen through a sensor with noise.
    void simulate_rig(const std::string& effect) {
        const fs::path declared = folder / "study/report/models/glide";
        fs::copy(declared, folder / "truth", fs::copy_options::recursive);
        put("truth/model.toml", core::read_file(declared / "model.toml") + "\n[[effect]]\n" + effect);
        std::string set = "kind = \"time_series\"\ntitle = \"a rig\"\n[noise]\ngap = \"0.05 mm\"\n";
        core::Random random(20261122);
        const std::array<const char*, 6> starts = {"gap=6mm,heave_velocity=0",      "gap=12mm,heave_velocity=0.02",
                                                   "gap=25mm,heave_velocity=-0.02", "gap=32mm,heave_velocity=0",
                                                   "gap=38mm,heave_velocity=-0.01", "gap=9mm,heave_velocity=0.01"};
        for (std::size_t i = 0; i < starts.size(); ++i) {
            const std::string name = "run-" + std::to_string(i + 1) + ".csv";
            run({"simulate", "truth/model.toml", "--from", starts[i], "--for", "20 s", "--step", "20 ms", "--out",
                 "clean.csv"});
            const core::Table motion = core::read_csv(folder / "clean.csv");
            std::string rows = "time [s], gap [m]\n";
            for (std::size_t row = 0; row < motion.rows(); ++row) {
                rows += core::format_number(motion.numbers("time")[row], 9) + ", " +
                        core::format_number(motion.numbers("gap")[row] + 5e-5 * random.normal(), 9) + "\n";
            }
            put("rig/" + name, rows);
            set += "[[run]]\nfile = \"" + name + "\"\n";
        }
        put("rig/dataset.toml", set);
    }

    /// The lift that a header gives, compiled by gcc, at gaps in mm.
    std::vector<double> lift_of(const std::string& header, const std::string& name, const std::vector<double>& gaps) {
        put(name + ".c", "#include <stdio.h>\n#include \"" + header + "\"\nint main(void) {\n    double mm;\n" +
                             "    while (scanf(\"%lf\", &mm) == 1) {\n        " + name +
                             "_real point[1] = {mm / 1000};\n        " + name + "_result r;\n        " + name +
                             "_at(point, &r);\n        printf(\"%.17g %d\\n\", (double)r.value, r.outside);\n    }\n" +
                             "    return 0;\n}\n");
        const auto built =
            run_program("gcc", {"-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", "-o", name, name + ".c"}, folder);
        EXPECT_EQ(built.exit_code, 0) << built.errors;
        std::string asked;
        for (const double gap : gaps) {
            asked += core::format_number(gap) + "\n";
        }
        put("gaps.txt", asked);
        const auto said = run_program("/bin/sh", {"-c", "./" + name + " < gaps.txt"}, folder);
        std::vector<double> lift;
        for (const auto line : core::split(said.output, '\n')) {
            const auto words = core::split(core::trimmed(line), ' ');
            if (words.size() == 2) {
                lift.push_back(core::parse_number(words[0]).value_or(std::nan("")));
                EXPECT_EQ(words[1], "0") << "outside at gap number " << lift.size();
            }
        }
        EXPECT_EQ(lift.size(), gaps.size());
        return lift;
    }

    static double error_of(const std::vector<double>& lift, const std::vector<double>& gaps, double (*truth)(double)) {
        double squares = 0;
        for (std::size_t i = 0; i < lift.size(); ++i) {
            squares += std::pow(lift[i] - truth(1e-3 * gaps[i]), 2);
        }
        return std::sqrt(squares / static_cast<double>(lift.size()));
    }
};

TEST_F(EndToEnd, FromFilesOfCfdToAHeaderThatKnowsTheEffectOfTheRig) {
    if (run_program("gcc", {"--version"}).exit_code != 0) {
        GTEST_SKIP() << "skipped: gcc is not here";
    }
    make_study();
    const json study = json::parse(run({"study", "run", "study", "--no-pictures", "--json"}));
    EXPECT_EQ(study["computed"], 0);
    // Lift balances 0.1 N where 0.5 exp(-h/10 mm) does.
    const json equilibrium = study["results"]["table/lift"]["equilibria"][0];
    EXPECT_NEAR(equilibrium["gap"].get<double>(), 0.010 * std::log(5.0), 1e-4);
    EXPECT_TRUE(equilibrium["stable"].get<bool>());

    const std::string declared = "study/report/models/glide/model.toml";
    run({"export", declared, "--axes", "gap", "--out", "before.h", "--name", "before"});
    simulate_rig(rough);
    const json wrong = json::parse(run({"predict", declared, "--data", "rig", "--json"}));
    run({"discover", declared, "--data", "rig", "--out", "found", "--export", "lift.h"});
    const json found = json::parse(core::read_file(folder / "found/discovery.json"));
    ASSERT_EQ(found["verdict"], "effect") << found.dump(1);
    EXPECT_EQ(found["effects"].size(), 1U);
    EXPECT_EQ(found["effects"][0]["name"], "surface_roughness");
    EXPECT_NEAR(found["effects"][0]["parameters"]["near"]["value"].get<double>(), near, 0.1 * near);
    EXPECT_NEAR(found["effects"][0]["parameters"]["far"]["value"].get<double>(), far, 0.1 * far);
    const json right = json::parse(run({"predict", "found/model.toml", "--data", "rig", "--json"}));
    EXPECT_GT(wrong["channels"]["gap"]["in_noise"].get<double>(), 5);
    EXPECT_LT(right["channels"]["gap"]["in_noise"].get<double>(), 1.2);
    run({"export", "found/model.toml", "--axes", "gap", "--out", "after.h", "--name", "after"});

    // The study's own export of the table, the declared model's and the mended one's, where the rig has been.
    std::vector<double> gaps;
    for (int i = 0; i <= 200; ++i) {
        gaps.push_back(6 + 0.15 * i);
    }
    const auto table = lift_of("study/report/exports/lift.h", "lift", gaps);
    const auto before = lift_of("before.h", "before", gaps), after = lift_of("after.h", "after", gaps);
    EXPECT_LT(error_of(table, gaps, cfd_lift), 5e-4) << "what the CFD says, interpolated";
    EXPECT_LT(error_of(before, gaps, cfd_lift), 5e-4) << "through the model too";
    const double error_before = error_of(before, gaps, true_lift), error_after = error_of(after, gaps, true_lift);
    EXPECT_NEAR(error_before, 0.0140, 5e-4) << "the roughness over 6 to 36 mm";
    EXPECT_LT(error_after, 0.1 * error_before);
    EXPECT_LT(error_after, 1e-3);
    // what discover exported itself says the same, and its report compares the two
    EXPECT_LT(error_of(lift_of("found/declared/lift.h", "lift", gaps), gaps, cfd_lift), 5e-4);
    EXPECT_LT(error_of(lift_of("found/lift.h", "lift", gaps), gaps, true_lift), 1e-3);
    const json exported = found["consequence"]["exports"][0]["quantities"][0];
    EXPECT_EQ(exported["quantity"], "lift_force");
    EXPECT_NEAR(exported["largest_change"].get<double>(),
                std::abs(exported["after"].get<double>() - exported["before"].get<double>()), 1e-12);
    EXPECT_GT(exported["largest_change"].get<double>(), error_before) << "the roughness is the change";
    const std::string page = core::read_file(folder / "found/report.html");
    EXPECT_THAT(page, HasSubstr("lift_force as exported, before and after"));
    EXPECT_THAT(page, HasSubstr("declared/lift.h"));
    std::cout << "error of the exported header, N: " << error_before << " before, " << error_after << " after\n";

    // And back: from the header to the fields.
    const json way = json::parse(run({"study", "why", "study", "before.h", "--json"}));
    EXPECT_THAT(way["notes"].dump(), HasSubstr("models/glide/model.toml"));
    EXPECT_THAT(way["origins"].dump(), HasSubstr("fields/hull-h10.csv"));
    EXPECT_EQ(
        json::parse(run({"study", "why", "study", "study/report/exports/lift.h", "--json"}))["origins"][0]["name"],
        "lift");
}

TEST_F(EndToEnd, ACableOfTheRigIsFoundAndPredictedAndLeftOutOfTheHeaderAloud) {
    make_study();
    const std::string declared = "study/report/models/glide/model.toml";
    simulate_rig(tied);
    run({"discover", declared, "--data", "rig", "--out", "found"});
    const json found = json::parse(core::read_file(folder / "found/discovery.json"));
    ASSERT_EQ(found["verdict"], "effect") << found.dump(1);
    EXPECT_EQ(found["effects"][0]["name"], "tether_stiffness");
    EXPECT_NEAR(found["effects"][0]["parameters"]["stiffness"]["value"].get<double>(), cable, 0.1 * cable);
    const json right = json::parse(run({"predict", "found/model.toml", "--data", "rig", "--json"}));
    EXPECT_LT(right["channels"]["gap"]["in_noise"].get<double>(), 1.2);
    const auto exported = run_underbody({"export", "found/model.toml", "--axes", "gap", "--out", "after.h"}, folder);
    EXPECT_EQ(exported.exit_code, 0) << exported.errors;
    const std::string left = "left out of the force, because it belongs to the rig or to the motion: tether_stiffness";
    EXPECT_THAT(exported.errors, HasSubstr(left));
    // and where the numbers are read: in the files, and in the JSON of what rests on these forces
    EXPECT_THAT(core::read_file(folder / "after.h"), HasSubstr("WARNING: " + left));
    for (const char* format : {"csv", "json"}) {
        const std::string file = std::string("after.") + format;
        const json written = json::parse(run({"export", "found/model.toml", "--axes", "gap", "--out", file, "--json"}));
        EXPECT_THAT(written["warnings"].dump(), HasSubstr(left));
        EXPECT_THAT(core::read_file(folder / file), HasSubstr(left));
    }
    // The vehicle with its cable balances where it does in linear: there nothing is left out.
    const json balance = json::parse(run({"table", "equilibria", "found/model.toml", "--json"})),
               linear = json::parse(run({"linear", "found/model.toml", "--json"}));
    EXPECT_EQ(balance["warnings"].dump().find(left), std::string::npos);
    ASSERT_EQ(balance["equilibria"].size(), linear["heave"].size());
    for (std::size_t i = 0; i < linear["heave"].size(); ++i) {
        EXPECT_NEAR(balance["equilibria"][i]["gap"].get<double>(), linear["heave"][i]["gap"].get<double>(), 1e-8);
    }
}

}  // namespace
}  // namespace underbody::test
