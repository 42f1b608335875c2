// One rule for all commands: a warning stands where the result is read. In the text it is one line on stdout and stderr
// has none; with --json the document holds it. Where stdout is a table it is a comment of it and a line on stderr;
// where it is the names of files that an export wrote, a line on stderr.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/own_files.h"
#include "core/table.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

std::size_t times_in(const std::string& text, const std::string& wanted) {
    std::size_t count = 0;
    for (std::size_t at = text.find(wanted); at != std::string::npos; at = text.find(wanted, at + 1)) {
        ++count;
    }
    return count;
}

std::string field_without_shear(double gap, double gradient) {
    std::string text = cube_field(gap, gradient);
    for (const std::string part : {", Wall Shear X [ Pa ], Wall Shear Y [ Pa ], Wall Shear Z [ Pa ]", ", 0, 0, 0\n"}) {
        for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part)) {
            text.replace(at, part.size(), part.back() == '\n' ? "\n" : "");
        }
    }
    return text;
}

class Warnings : public testing::Test {
protected:
    core::TemporaryFolder folder;

    void write_files() {
        core::write_file(folder.path() / "lift.csv",
                         "gap [mm], lift_force [N], lift_force_sigma [N], settled\n5, 1, 0.01, settled\n"
                         "6, 0.9, 0.01, not settled\n7, 0.82, 0.01, settled\n8, 0.77, 0.01, settled\n"
                         "9, 0.73, 0.01, settled\n10, 0.70, 0.01, settled\n12, 0.66, 0.01, settled\n"
                         "15, 0.62, 0.01, settled\n");
        core::write_file(folder.path() / "model.toml",
                         "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.7 kg\"\nnet_weight = \"0.8 N\"\n"
                         "[drag.heave]\nquadratic = \"6 N s^2/m^2\"\n"
                         "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n");
        core::write_file(folder.path() / "cube.csv", field_without_shear(0.003, 100));
        std::filesystem::create_directories(folder.path() / "study" / "fields");
        core::write_file(folder.path() / "study" / "fields" / "cube-h3.csv", field_without_shear(0.003, 100));
        core::write_file(folder.path() / "study" / "fields" / "cube-h4.csv", field_without_shear(0.004, 90));
        core::write_file(folder.path() / "study" / "study.toml",
                         "title = \"cubes\"\n[[case]]\nfiles = \"fields/cube-h{gap:mm}.csv\"\n");
        ASSERT_EQ(run_underbody({"simulate", "model.toml", "--from", "gap=9mm", "--for", "4", "--step", "20ms", "--out",
                                 "data/run-01.csv"},
                                folder.path())
                      .exit_code,
                  0);
        core::write_file(folder.path() / "data" / "dataset.toml",
                         "kind = \"time_series\"\n[noise]\ngap = \"0.05 mm\"\n[[run]]\nfile = \"run-01.csv\"\n");
    }

    void expect_once(std::vector<std::string> words, const std::string& sentence) {
        std::string line;
        for (const auto& word : words) {
            line += word + " ";
        }
        SCOPED_TRACE(line);
        const auto text = run_underbody(words, folder.path());
        ASSERT_TRUE(text.exit_code == 0 || text.exit_code == 4) << text.errors;
        EXPECT_EQ(times_in(text.output, sentence), 1U) << text.output;
        EXPECT_THAT(text.output, testing::ContainsRegex("[Ww]arning: [^\n]*" + sentence));
        EXPECT_LE(times_in(text.errors, sentence), 1U) << text.errors;  // for who reads stderr alone
        words.insert(words.end(), {"--json", "--force"});
        const auto document = run_underbody(words, folder.path());
        ASSERT_EQ(document.exit_code, text.exit_code) << document.errors;
        EXPECT_THAT(json::parse(document.output).dump(), HasSubstr(sentence));
    }
};

TEST_F(Warnings, StandOnceWithTheResultOfEveryCommand) {
    write_files();
    const std::string unsettled = "1 of 8 points is of a solution that has not settled: row 2";
    const std::vector<std::vector<std::string>> on_the_table = {
        {"table", "fit", "lift.csv"},
        {"table", "at", "lift.csv", "gap=6mm"},
        {"table", "at", "model.toml", "gap=6mm"},
        {"table", "equilibria", "lift.csv", "--weight", "0.8 N"},
        {"table", "equilibria", "model.toml"},
        {"simulate", "model.toml", "--from", "gap=7mm", "--for", "1"},
        {"region", "model.toml", "--axes", "gap=6mm:12mm,heave_velocity=-0.01:0.01", "--grid", "6x6"},
        {"linear", "model.toml", "--at", "gap=8mm"},
        {"predict", "model.toml", "--data", "data"},
        {"estimate", "model.toml", "--data", "data"},
        {"learn", "model.toml"},
        {"control", "model.toml", "--hold", "8mm", "--from", "gap=9mm", "--for", "2"},
    };
    for (const auto& words : on_the_table) {
        expect_once(words, unsettled);
    }
    const std::string no_shear = "zone 'base' has no wall shear vector: its viscous part is left out";
    expect_once({"loads", "cube.csv"}, no_shear);
    expect_once({"study", "run", "study", "--no-pictures"}, no_shear);
    expect_once({"study", "list", "study"}, no_shear);
}

TEST_F(Warnings, StandOnceWhereOneReaderHasBothStreams) {
    write_files();
    core::write_file(folder.path() / "cube2.csv", field_without_shear(0.004, 90));
    const std::string program = (program_folder() / "underbody").string();
    const std::string unsettled = "1 of 8 points is of a solution that has not settled: row 2";
    const std::string no_shear = "zone 'base' has no wall shear vector: its viscous part is left out";
    const auto once = [&](const std::string& words, const std::string& sentence) {
        SCOPED_TRACE(words);
        const auto pipe = run_program("/bin/sh", {"-c", program + " " + words + " 2>&1"}, folder.path());
        EXPECT_EQ(times_in(pipe.output, sentence), 1U) << pipe.output;
        (void)run_program("/bin/sh", {"-c", program + " " + words + " > both.txt 2>&1"}, folder.path());
        EXPECT_EQ(times_in(core::read_file(folder.path() / "both.txt"), sentence), 1U);
        const std::string apart = " > out.txt 2> errors.txt";
        (void)run_program("/bin/sh", {"-c", program + " " + words + apart}, folder.path());
        EXPECT_EQ(times_in(core::read_file(folder.path() / "errors.txt"), sentence), 1U);
        return pipe.output;
    };
    once("table at lift.csv gap=6mm", unsettled);
    once("export lift.csv --format csv --out once.csv", unsettled);
    once("loads cube.csv cube2.csv", no_shear);
    once("table equilibria lift.csv --weight 0.8N --picture no/folder.png", unsettled);  // ends by an error
    const std::string document = once("table at lift.csv gap=6mm --json", unsettled);
    EXPECT_NO_THROW((void)json::parse(document)) << document;
    once("table equilibria lift.csv --json --weight 0.8N --picture no/folder.png", unsettled);
}

TEST_F(Warnings, StandInBothStreamsOfAScriptAndOnceOnATerminal) {
    write_files();
    const std::string unsettled = "1 of 8 points is of a solution that has not settled: row 2";
    const auto apart = run_underbody({"table", "at", "lift.csv", "gap=6mm"}, folder.path());
    EXPECT_EQ(times_in(apart.output, unsettled), 1U) << apart.output;
    EXPECT_EQ(times_in(apart.errors, unsettled), 1U) << apart.errors;
    const std::string program = (program_folder() / "underbody").string();
    const auto terminal =
        run_program("/usr/bin/script", {"-qec", program + " table at lift.csv gap=6mm", "/dev/null"}, folder.path());
    ASSERT_EQ(terminal.exit_code, 0) << terminal.errors;
    EXPECT_EQ(times_in(terminal.output, unsettled), 1U) << terminal.output;
}

TEST_F(Warnings, StandInTheCommentsOfATableAndOnStderr) {
    write_files();
    core::write_file(folder.path() / "cube2.csv", field_without_shear(0.004, 90));
    const std::string no_shear = "zone 'base' has no wall shear vector: its viscous part is left out";
    const auto text = run_underbody({"loads", "cube.csv", "cube2.csv"}, folder.path());
    ASSERT_EQ(text.exit_code, 0) << text.errors;
    EXPECT_EQ(times_in(text.output, no_shear), 1U) << text.output;
    EXPECT_THAT(text.output, testing::ContainsRegex("# warning: [^\n]*" + no_shear));
    EXPECT_EQ(times_in(text.errors, no_shear), 1U) << text.errors;
    const auto document = run_underbody({"loads", "cube.csv", "cube2.csv", "--json"}, folder.path());
    EXPECT_THAT(json::parse(document.output).dump(), HasSubstr(no_shear));
    core::write_file(folder.path() / "none.csv", "no table of CFD\n1\n");
    const auto kept = run_underbody({"loads", "cube.csv", "none.csv", "--keep-going"}, folder.path());
    EXPECT_EQ(kept.exit_code, 3);
    EXPECT_THAT(kept.output, HasSubstr("# warning: without 1 of 2 files"));
}

/// What changes the meaning of numbers goes with them into the file.
TEST_F(Warnings, StandInTheTablesThatMotionsLeave) {
    write_files();
    const std::string unsettled = "1 of 8 points is of a solution that has not settled: row 2";
    const std::vector<std::vector<std::string>> commands = {
        {"simulate", "model.toml", "--from", "gap=7mm", "--for", "1"},
        {"control", "model.toml", "--hold", "8mm", "--from", "gap=9mm", "--for", "2"},
        {"predict", "model.toml", "--data", "data"},
        {"estimate", "model.toml", "--data", "data"},
        {"region", "model.toml", "--axes", "gap=6mm:12mm,heave_velocity=-0.01:0.01", "--grid", "6x6"}};
    for (std::vector<std::string> words : commands) {
        const std::string out = words[0] + ".csv";
        words.insert(words.end(), {words[0] == "region" ? "--table" : "--out", out});
        const auto run = run_underbody(words, folder.path());
        ASSERT_EQ(run.exit_code, 0) << words[0] << run.errors;
        const std::string text = core::read_file(folder.path() / out);
        EXPECT_EQ(times_in(text, unsettled), 1U) << words[0] << text.substr(0, 400);
        EXPECT_THAT(text, testing::ContainsRegex("^# warning: [^\n]*" + unsettled)) << words[0];
        EXPECT_NO_THROW((void)core::read_csv(folder.path() / out)) << words[0];
    }
    const auto weak = run_underbody(
        {"control", "model.toml", "--hold", "8mm", "--from", "gap=9mm", "--for", "1", "--limit", "1e-6 N", "--json"},
        folder.path());
    EXPECT_THAT(json::parse(weak.output)["warnings"].dump(), HasSubstr("cannot hold this gap"));
}

TEST_F(Warnings, OfWhatADiscoveryCouldNotTellApartStandWithWhatTheModelGives) {
    write_files();
    const auto file = folder.path() / "model.toml";
    const core::ReplacingAllowed again;
    core::write_file(
        file, core::read_file(file) + "[lineage]\nmade_from = [\"tied: coulomb_friction, or linear_damping\"]\n");
    const std::string tied = "its data could not well tell what was found from other effects .coulomb_friction, or";
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"predict", "model.toml", "--data", "data"}, {"linear", "model.toml"}}) {
        EXPECT_THAT(run_underbody(words, folder.path()).output, testing::ContainsRegex("arning: [^\n]*" + tied))
            << words.front();
    }
}

TEST_F(Warnings, OfAnExportStandOnStderrForStdoutListsItsFiles) {
    write_files();
    const std::string unsettled = "1 of 8 points is of a solution that has not settled: row 2";
    const std::vector<std::vector<std::string>> exports = {
        {"export", "lift.csv", "--format", "csv", "--out", "once.csv"},
        {"export", "once.csv", "--format", "c", "--out", "lift.h"},
        {"export", "model.toml", "--format", "json", "--out", "model.json"},
        {"export", "model.json", "--format", "c", "--out", "model.h"},
        {"export", "model.toml", "--motion", "heave", "--from", "gap=8mm", "--format", "fmu", "--out", "m.fmu"},
    };
    for (std::vector<std::string> words : exports) {
        const auto text = run_underbody(words, folder.path());
        ASSERT_EQ(text.exit_code, 0) << text.errors;
        EXPECT_THAT(text.output, Not(HasSubstr("arning"))) << words[1];
        EXPECT_EQ(times_in(text.errors, unsettled), 1U) << words[1] << text.errors;
        words.insert(words.end(), {"--json", "--force"});
        EXPECT_THAT(json::parse(run_underbody(words, folder.path()).output)["warnings"].dump(), HasSubstr(unsettled));
    }
}

TEST_F(Warnings, OfPicturesImportsAndProbesStandInTheirTextAndDocument) {
    core::write_file(folder.path() / "cube.csv", field_without_shear(0.003, 100));
    const std::string absent = "there is no array 'vorticty'";
    expect_once({"import", "cube.csv", "--arrays", "pressure,vorticty", "--out", "cube.vtp"}, absent);
    const auto listed =
        run_underbody({"import", "cube.csv", "--arrays", "vorticty", "--out", "c.vtp", "--json"}, folder.path());
    EXPECT_THAT(json::parse(listed.output)["warnings"].dump(), HasSubstr(absent));
}

TEST_F(Warnings, OfViewsAndProbesStandWhereTheirNumbersAre) {
    const std::string box = (data_folder() / "openfoam/ascii").string();
    const std::string as_it_says = "its lengths are in m, as it says";
    expect_once({"views", box, "--list", "--length-unit", "mm"}, as_it_says);
    const auto text = run_underbody({"views", box, "--list", "--length-unit", "mm"}, folder.path());
    EXPECT_EQ(times_in(text.errors, as_it_says), 1U) << text.errors;

    core::write_file(folder.path() / "cube.csv", field_without_shear(0.003, 100));
    const std::string unused = "coordinate 'X' is in m: a length unit .mm. is for files that state none";
    const std::string plain = "coordinate 'X' is in m: a length unit (mm) is for files that state none";
    std::vector<std::string> words = {"probe", "cube.csv", "--point", "0,0,0.003", "--length-unit", "mm"};
    const auto table = run_underbody(words, folder.path());
    ASSERT_EQ(table.exit_code, 0) << table.errors;
    EXPECT_THAT(table.output, testing::ContainsRegex("# warning: [^\n]*" + unused));
    EXPECT_EQ(times_in(table.output, plain), 1U) << table.output;
    EXPECT_EQ(times_in(table.errors, plain), 1U) << table.errors;
    words.emplace_back("--json");
    EXPECT_THAT(json::parse(run_underbody(words, folder.path()).output)["warnings"].dump(), HasSubstr(plain));
    words.back() = "--out";
    words.emplace_back("probe-out.csv");
    const auto written = run_underbody(words, folder.path());
    EXPECT_EQ(times_in(written.output, plain), 1U) << written.output;
    EXPECT_THAT(core::read_file(folder.path() / "probe-out.csv"), testing::ContainsRegex("# warning: [^\n]*" + unused));
}

TEST_F(Warnings, OfMapsAndOfGivenStartsStandInTheirTables) {
    write_files();
    core::write_file(folder.path() / "starts.csv", "gap [mm], heave_velocity [m/s]\n7, 0\n9, 0.001\n14, 0.2\n");
    const std::string unsettled = "1 of 8 points is of a solution that has not settled: row 2";
    const std::string beyond = "of the motions are at some time outside the range of a force table";
    const auto text =
        run_underbody({"region", "model.toml", "--starts", "starts.csv", "--escape", "30mm"}, folder.path());
    ASSERT_EQ(text.exit_code, 0) << text.errors;
    for (const std::string& told : {unsettled, beyond}) {
        EXPECT_THAT(text.output, testing::ContainsRegex("# warning: [^\n]*" + told));
        EXPECT_EQ(times_in(text.output, told), 1U) << text.output;
        EXPECT_EQ(times_in(text.errors, told), 1U) << text.errors;
    }
    const auto document =
        run_underbody({"region", "model.toml", "--starts", "starts.csv", "--escape", "30mm", "--json"}, folder.path());
    const json warnings = json::parse(document.output)["warnings"];
    EXPECT_THAT(warnings.dump(), testing::AllOf(HasSubstr(unsettled), HasSubstr(beyond)));
    const std::vector<std::string> axes = {"--axes", "gap=6mm:12mm,heave_velocity=-0.01:0.01", "--grid", "6x6"};
    for (const bool given : {true, false}) {
        std::vector<std::string> words = {"region", "model.toml", "--table", given ? "ends.csv" : "map.csv"};
        if (given) {
            words.insert(words.end(), {"--starts", "starts.csv"});
        } else {
            words.insert(words.end(), axes.begin(), axes.end());
        }
        expect_once(words, unsettled);
        EXPECT_THAT(core::read_file(folder.path() / words[3]), testing::ContainsRegex("# warning: [^\n]*" + unsettled));
    }
    std::vector<std::string> variants = {"region", "model.toml", "--with", "other.toml"};
    core::write_file(folder.path() / "other.toml", core::read_file(folder.path() / "model.toml"));
    variants.insert(variants.end(), axes.begin(), axes.end());
    const auto both = run_underbody(variants, folder.path());
    ASSERT_EQ(both.exit_code, 0) << both.errors;
    EXPECT_EQ(times_in(both.output, unsettled), 2U) << both.output;  // one of each model, by its name
}

/// A speed of 3 m/s for tables of 0.4 to 0.8 m/s.
TEST_F(Warnings, NameAConditionOutsideTheTablesInEveryCommandThatHoldsIt) {
    std::string table = "gap [mm], speed [m/s], lift_force [N]\n";
    for (const double speed : {0.4, 0.6, 0.8}) {
        for (const int gap : {5, 6, 7, 8, 9, 10, 12, 15}) {
            table += std::to_string(gap) + ", " + std::to_string(speed) + ", " +
                     std::to_string(20 * speed * speed / gap) + "\n";
        }
    }
    core::write_file(folder.path() / "lift.csv", table);
    const std::string model =
        "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.7 kg\"\nnet_weight = \"0.8 N\"\n"
        "[drag.heave]\nquadratic = \"6 N s^2/m^2\"\n"
        "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n";
    core::write_file(folder.path() / "inside.toml", model + "[conditions]\nspeed = \"0.6 m/s\"\n");
    core::write_file(folder.path() / "model.toml", model + "[conditions]\nspeed = \"3 m/s\"\n");
    std::filesystem::create_directories(folder.path() / "data");
    std::string run = "time [s], gap [mm]\n";
    for (int i = 0; i < 300; ++i) {
        run += std::to_string(0.02 * i) + ", " + std::to_string(9 + 0.3 * std::sin(0.1 * i)) + "\n";
    }
    core::write_file(folder.path() / "data" / "run.csv", run);
    core::write_file(folder.path() / "data" / "dataset.toml",
                     "kind = \"time_series\"\n[noise]\ngap = \"0.05 mm\"\n[[run]]\nfile = \"run.csv\"\n");
    const std::string held = "speed 3 m/s is outside the lift_force table lift.csv, which covers 0.4 to 0.8 m/s";
    expect_once({"learn", "model.toml"}, held);
    expect_once({"control", "model.toml", "--hold", "8mm", "--from", "gap=9mm", "--for", "1"}, held);
    const auto inside = run_underbody({"learn", "inside.toml"}, folder.path());
    EXPECT_THAT(inside.output, Not(HasSubstr("outside the"))) << inside.output;
    const std::string measured =
        "speed is 3 m/s in 300 of 300 measured rows .first in run run., outside the lift_force";
    for (const char* command : {"predict", "estimate"}) {
        const auto text = run_underbody({command, "model.toml", "--data", "data"}, folder.path());
        EXPECT_THAT(text.output, testing::ContainsRegex("warning: [^\n]*" + measured)) << command << text.errors;
        const auto document = run_underbody({command, "model.toml", "--data", "data", "--json"}, folder.path());
        EXPECT_THAT(json::parse(document.output)["warnings"].dump(), testing::ContainsRegex(measured)) << command;
    }
    core::write_file(folder.path() / "data" / "dataset.toml",
                     "kind = \"time_series\"\n[noise]\ngap = \"0.05 mm\"\n[conditions]\nspeed = \"0.5 m/s\"\n"
                     "[[run]]\nfile = \"run.csv\"\n");
    const auto own = run_underbody({"predict", "model.toml", "--data", "data"}, folder.path());
    EXPECT_THAT(own.output, Not(HasSubstr("outside the lift_force"))) << own.output;
}

TEST_F(Warnings, OfMisnamedColumnsNameTheHeadingThatIsMeant) {
    core::write_file(folder.path() / "lift.csv",
                     "gap [mm], lift_force [N], lift_force_sgima [N], drag_froce [N], cells [1], lift_pressure [N]\n"
                     "5, 1, 0.01, 0.2, 100, 0.9\n6, 0.9, 0.01, 0.2, 110, 0.8\n7, 0.82, 0.01, 0.2, 120, 0.7\n"
                     "8, 0.77, 0.01, 0.2, 130, 0.6\n");
    expect_once({"table", "fit", "lift.csv"},
                "'lift_force_sgima' is not understood and not used: write 'lift_force_sigma");
    expect_once({"table", "fit", "lift.csv"}, "'drag_froce' is not understood and not used: write 'drag_force");
    const auto text = run_underbody({"table", "fit", "lift.csv"}, folder.path());
    EXPECT_THAT(text.output, Not(testing::ContainsRegex("warning: the column '(cells|lift_pressure)'")));
}

TEST_F(Warnings, DoNotComeOfWhatSimulateWritesItself) {
    write_files();
    const auto predicted = run_underbody({"predict", "model.toml", "--data", "data"}, folder.path());
    ASSERT_EQ(predicted.exit_code, 0) << predicted.errors;
    EXPECT_THAT(predicted.output + predicted.errors,
                Not(testing::AnyOf(HasSubstr("heave_drag"), HasSubstr("outside_table"))));
}

TEST_F(Warnings, SayThatAHeldForceShowsNeitherDelayNorLag) {
    write_files();
    const std::string model = core::read_file(folder.path() / "model.toml");
    core::write_file(folder.path() / "late.toml",
                     model +
                         "[[effect]]\nname = \"input_delay\"\ndelay = { value = \"0.5 s\" }\n"
                         "[[effect]]\nname = \"actuator_lag\"\ntime_constant = { value = \"0.3 s\" }\n");
    const std::string told = "input_force is a condition: it has acted since long before the start";
    expect_once({"simulate", "late.toml", "--from", "gap=9mm", "--for", "1", "--conditions", "input_force=0.05N"},
                told);
    // As a step over time both show: nothing for the delay, then 1 - exp(-t / lag).
    core::write_file(folder.path() / "step.csv", "time [s], input_force [N]\n0, 0\n0.1, 0\n0.1001, 0.05\n3, 0.05\n");
    const auto step = run_underbody({"simulate", "late.toml", "--from", "gap=9mm", "--for", "2", "--step", "10ms",
                                     "--inputs", "step.csv", "--out", "step-run.csv"},
                                    folder.path());
    ASSERT_EQ(step.exit_code, 0) << step.errors;
    EXPECT_THAT(step.output, Not(HasSubstr(told)));
    const auto run = core::read_csv(folder.path() / "step-run.csv");
    for (std::size_t i = 0; i < run.rows(); ++i) {
        const double t = run.numbers("time")[i];
        const double right = t < 0.6 ? 0 : 0.05 * (1 - std::exp(-(t - 0.6) / 0.3));
        EXPECT_NEAR(run.numbers("input_force")[i], right, 1e-3) << t;  // a jump is known to a step, 5 ms of 0.3 s
    }
    // And a force held from before the start leaves a body in balance where it is.
    const auto balance = run_underbody({"simulate", "late.toml", "--from", "gap=9mm", "--for", "1", "--step", "10ms",
                                        "--conditions", "input_force=0.07N", "--out", "held.csv"},
                                       folder.path());
    ASSERT_EQ(balance.exit_code, 0) << balance.errors;
    const auto still = core::read_csv(folder.path() / "held.csv");
    for (const double force : still.numbers("input_force")) {
        EXPECT_NEAR(force, 0.07, 1e-12);
    }
}

}  // namespace
}  // namespace underbody::test
