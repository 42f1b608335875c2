// The README stays true: every command in its shell blocks runs, in a copy of cases/evie.
#include <gtest/gtest.h>

#include <sstream>

#include "core/file.h"
#include "core/text.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

namespace fs = std::filesystem;

/// Words of a line as a shell splits them, single quotes respected.
std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> words;
    std::string word;
    bool quoted = false;
    for (const char c : line) {
        if (c == '\'') {
            quoted = !quoted;
        } else if (c == ' ' && !quoted) {
            if (!word.empty()) {
                words.push_back(word);
            }
            word.clear();
        } else {
            word += c;
        }
    }
    if (!word.empty()) {
        words.push_back(word);
    }
    return words;
}

TEST(Readme, EveryCommandOfTheWalkRuns) {
    const core::TemporaryFolder scratch;
    const fs::path study = scratch.path() / "evie";
    fs::copy(source_folder() / "cases" / "evie", study, fs::copy_options::recursive);
    fs::remove_all(study / ".underbody");
    std::istringstream readme(core::read_file(source_folder() / "README.md"));
    std::string line;
    bool shell = false;
    int commands = 0;
    while (std::getline(readme, line)) {
        if (line.starts_with("```")) {
            shell = line == "```sh";
            continue;
        }
        if (!shell || !line.starts_with("underbody ")) {
            continue;
        }
        std::vector<std::string> arguments = words_of(line);
        arguments.erase(arguments.begin());
        const ProgramRun run = run_underbody(arguments, study);
        EXPECT_EQ(run.exit_code, 0) << line << "\n" << run.errors;
        ++commands;
    }
    EXPECT_GE(commands, 10) << "the README lost its walk";
}

TEST(Readme, NamesOnlyPresetsThatExist) {
    const std::string presets = core::read_file(source_folder() / "CMakePresets.json");
    for (const char* preset : {"dev", "release", "audit", "asan", "tidy", "bench", "fuzz"}) {
        EXPECT_NE(presets.find("\"name\": \"" + std::string(preset) + "\""), std::string::npos) << preset;
    }
}

}  // namespace
}  // namespace underbody::test
