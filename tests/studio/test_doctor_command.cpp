// underbody doctor and underbody completion.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/file.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

namespace fs = std::filesystem;

/// A folder of programs that print one line each, to stand alone on the PATH.
void add_program(const fs::path& folder, const std::string& name, const std::string& says) {
    core::write_file(folder / name, "#!/bin/sh\necho '" + says + "'\n");
    fs::permissions(folder / name, fs::perms::owner_all);
}

nlohmann::json part(const nlohmann::json& document, const std::string& name) {
    for (const auto& one : document["parts"]) {
        if (one["name"] == name) {
            return one;
        }
    }
    return {};
}

TEST(Doctor, FindsWhatIsThereWithItsVersionAndSaysHowToGetTheRest) {
    const core::TemporaryFolder folder;
    for (const char* name : {"sbatch", "squeue", "scancel"}) {
        add_program(folder.path(), name, "slurm-wlm 22.05.8");
    }
    add_program(folder.path(), "simpleFoam", "Using: OpenFOAM- (1912) - visit www.openfoam.com");
    const auto run =
        run_underbody({"doctor", "--json"}, folder.path(), {{"PATH", folder.path().string()}, {"DISPLAY", ""}});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto document = nlohmann::json::parse(run.output);
    EXPECT_GE(document["machine"]["cores"].get<int>(), 1);
    EXPECT_GT(document["machine"]["memory"].get<double>(), 1e8);
    const auto slurm = part(document, "slurm");
    EXPECT_TRUE(slurm["found"].get<bool>()) << slurm;
    EXPECT_EQ(slurm["version"], "22.05.8");
    EXPECT_EQ(slurm["path"], (folder.path() / "sbatch").string());
    const auto openfoam = part(document, "openfoam");  // one of its programs alone is not enough
    EXPECT_FALSE(openfoam["found"].get<bool>());
    EXPECT_EQ(openfoam["note"], "not on the PATH: blockMesh, snappyHexMesh");
    EXPECT_EQ(openfoam["get"], "apt install openfoam");
    EXPECT_FALSE(part(document, "octave")["found"].get<bool>());
    EXPECT_FALSE(part(document, "display")["found"].get<bool>());
    for (const auto& one : document["parts"]) {
        EXPECT_FALSE(one["for"].get<std::string>().empty()) << one;
        EXPECT_FALSE(one["get"].get<std::string>().empty()) << one;
    }
}

TEST(Doctor, SlurmWithoutAClusterIsNotHere) {
    const core::TemporaryFolder folder;
    for (const char* name : {"sbatch", "squeue", "scancel"}) {
        add_program(folder.path(), name, std::string(name) + ": fatal: Could not establish a configuration source");
    }
    const auto run = run_underbody({"doctor", "--json"}, folder.path(), {{"PATH", folder.path().string()}});
    const auto slurm = part(nlohmann::json::parse(run.output), "slurm");
    EXPECT_FALSE(slurm["found"].get<bool>());
    EXPECT_EQ(slurm["note"], (folder.path() / "sbatch").string() + " is here, but not set up");
    EXPECT_THAT(slurm["get"].get<std::string>(), testing::HasSubstr("slurm.conf"));
}

TEST(Doctor, AProgramThatNeverAnswersIsThereWithoutAVersion) {
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "octave-cli", "#!/bin/sh\nexec /bin/sleep 60\n");
    fs::permissions(folder.path() / "octave-cli", fs::perms::owner_all);
    const auto run = run_underbody({"doctor", "--json"}, folder.path(), {{"PATH", folder.path().string()}});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto octave = part(nlohmann::json::parse(run.output), "octave");
    EXPECT_TRUE(octave["found"].get<bool>());
    EXPECT_EQ(octave["version"], "");
}

TEST(Doctor, WhatIsNeededAndMissingIsExitCode4) {
    const core::TemporaryFolder folder;
    add_program(folder.path(), "octave-cli", "GNU Octave, version 7.3.0");
    const std::map<std::string, std::string> alone = {{"PATH", folder.path().string()}};
    EXPECT_EQ(run_underbody({"doctor", "--need", "octave"}, folder.path(), alone).exit_code, 0);
    const auto missing = run_underbody({"doctor", "--need", "octave, slurm"}, folder.path(), alone);
    EXPECT_EQ(missing.exit_code, 4);
    EXPECT_THAT(missing.errors, testing::HasSubstr("not here: slurm"));
    EXPECT_THAT(missing.output, testing::HasSubstr("to get it: apt install slurm-client"));
    const auto wrong = run_underbody({"doctor", "--need", "slrum"}, folder.path(), alone);
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.errors, testing::HasSubstr("did you mean 'slurm'?"));
}

/// What Tab would offer in a shell of the machine.
std::string tabbed(const std::string& line) {
    const core::TemporaryFolder folder;
    const auto script = run_underbody({"completion", "bash"});
    EXPECT_EQ(script.exit_code, 0) << script.errors;
    core::write_file(folder.path() / "completion", script.output);
    core::write_file(folder.path() / "try",
                     "source ./completion\nread -ra COMP_WORDS <<< \"$1\"\n[[ $1 == *' ' ]] && COMP_WORDS+=('')\n"
                     "COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_underbody\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
    const auto run = run_program("/bin/bash", {"try", line}, folder.path());
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_EQ(run.errors, "");
    return "\n" + run.output;
}

TEST(Completion, OffersCommandsOptionsAndTheirChoices) {
    EXPECT_THAT(tabbed("underbody lo"), testing::HasSubstr("\nloads\n"));
    EXPECT_THAT(tabbed("underbody table eq"), testing::HasSubstr("\nequilibria\n"));
    EXPECT_THAT(tabbed("underbody loads body.csv --sym"), testing::HasSubstr("\n--symmetry\n"));
    EXPECT_THAT(tabbed("underbody loads body.csv --fluid re"), testing::HasSubstr("\nreversed\n"));
    // Those that only the description names.
    EXPECT_EQ(tabbed("underbody export lift.csv --format "), "\nc\ncsv\njson\nmat\njsbsim\nsimulink\nmodelica\nfmu\n");
    EXPECT_EQ(tabbed("underbody export lift.csv --number "), "\ndouble\nfloat\nfixed\n");
    EXPECT_EQ(tabbed("underbody export lift.csv --frame "), "\nup\nned\n");
    EXPECT_EQ(tabbed("underbody export glide.toml --motion "), "\nheave\nheave-pitch\nbody\n");
    EXPECT_EQ(tabbed("underbody table fit lift.csv --range "), "\nclamp\nrefuse\nextrapolate\n");
    EXPECT_EQ(tabbed("underbody table fit lift.csv --kind g"), "\ngaussian_process\n");
    EXPECT_THAT(tabbed("underbody loads --thr"), testing::HasSubstr("\n--threads\n"));
    EXPECT_THAT(tabbed("underbody region --sym"), testing::Not(testing::HasSubstr("--symmetry")));
}

TEST(Completion, HasEveryOptionOfEveryCommandsHelp) {
    const auto script = run_underbody({"completion", "bash"}).output;
    for (const char* command : {"loads", "region", "simulate", "body", "sweep", "doctor"}) {
        const std::size_t at = script.find("\"underbody " + std::string(command) + "\")\n");
        ASSERT_NE(at, std::string::npos) << command;
        const std::string branch = script.substr(at, script.find(";;", at) - at);
        const std::string help = run_underbody({command, "--help"}).output;
        const std::regex option("\n  (?:-[a-z],)?(--[a-z-]+)");
        int count = 0;
        for (std::sregex_iterator it(help.begin(), help.end(), option), last; it != last; ++it, ++count) {
            EXPECT_NE(branch.find((*it)[1].str()), std::string::npos) << command << " " << (*it)[1];
        }
        EXPECT_GE(count, 2) << command;
    }
}

TEST(Completion, IsGoodForTheShellsThatAreHere) {
    const core::TemporaryFolder folder;
    for (const char* name : {"bash", "zsh", "fish"}) {
        const auto script = run_underbody({"completion", name});
        ASSERT_EQ(script.exit_code, 0) << script.errors;
        core::write_file(folder.path() / name, script.output);
        const fs::path program = fs::path("/usr/bin") / name;
        if (fs::exists(program)) {
            const auto run = run_program(program.string(), {"-n", name}, folder.path());
            EXPECT_EQ(run.exit_code, 0) << name << ": " << run.errors;
        } else {
            std::cout << "not tried: " << name << " is not installed\n";
        }
    }
    EXPECT_EQ(run_underbody({"completion", "tcsh"}).exit_code, 2);
}

}  // namespace
}  // namespace underbody::test
