// Pages stay true: every command in the shell blocks of README.md, docs/guide and docs/files runs, in a copy of
// cases/evie for each page; blocks such as ```toml vehicle.toml are files that it writes before.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "core/file.h"
#include "core/text.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

namespace fs = std::filesystem;

/// Words of a line as a shell splits them, quotes respected; from " #" on it is a comment.
std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> words;
    std::string word;
    char quote = 0;
    bool any = false;
    for (const char c : line) {
        if (quote != 0 ? c == quote : c == '\'' || c == '"') {
            quote = quote != 0 ? static_cast<char>(0) : c;
            any = true;
        } else if (c == ' ' && quote == 0) {
            if (!word.empty() || any) {
                words.push_back(word);
            }
            word.clear();
            any = false;
        } else if (c == '#' && quote == 0 && word.empty()) {
            break;
        } else {
            word += c;
        }
    }
    if (!word.empty() || any) {
        words.push_back(word);
    }
    return words;
}

std::vector<std::string> pages() {
    std::vector<std::string> found{"README.md"};
    for (const char* folder : {"docs/guide", "docs/files"}) {
        for (const auto& entry : fs::directory_iterator(source_folder() / folder)) {
            if (entry.path().extension() == ".md") {
                found.push_back(std::string(folder) + "/" + entry.path().filename().string());
            }
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

class Pages : public testing::TestWithParam<std::string> {};

TEST_P(Pages, EveryCommandRuns) {
    const core::TemporaryFolder scratch;
    const fs::path study = scratch.path() / "evie";
    fs::copy(source_folder() / "cases" / "evie", study, fs::copy_options::recursive);
    fs::remove_all(study / ".underbody");
    std::istringstream page(core::read_file(source_folder() / GetParam()));
    std::string line, language, name, text;
    while (std::getline(page, line)) {
        if (line.starts_with("```")) {
            if (!name.empty()) {
                core::write_file(study / name, text);
            }
            const std::vector<std::string> said = words_of(line.substr(3));
            language = said.empty() ? "" : said[0];
            name = said.size() > 1 ? said[1] : "";
            text.clear();
            continue;
        }
        text += line + "\n";
        if (language != "sh" || !line.starts_with("underbody ")) {
            continue;
        }
        std::vector<std::string> arguments = words_of(line);
        arguments.erase(arguments.begin());
        const ProgramRun run = run_underbody(arguments, study);
        EXPECT_EQ(run.exit_code, 0) << GetParam() << ": " << line << "\n" << run.errors;
    }
}

INSTANTIATE_TEST_SUITE_P(, Pages, testing::ValuesIn(pages()), [](const auto& page) {
    std::string name = page.param;
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    return name;
});

TEST(Readme, HasItsWalk) {
    const std::string readme = core::read_file(source_folder() / "README.md");
    std::size_t commands = 0;
    for (std::size_t at = readme.find("\nunderbody "); at != std::string::npos;
         at = readme.find("\nunderbody ", at + 1)) {
        ++commands;
    }
    EXPECT_GE(commands, 10U) << "the README lost its walk";
}

TEST(Readme, FitsATerminal) {
    std::istringstream readme(core::read_file(source_folder() / "README.md"));
    std::string line;
    while (std::getline(readme, line)) {
        EXPECT_LE(line.size(), 110U) << line;
    }
}

TEST(Readme, NamesOnlyPresetsThatExist) {
    const std::string presets = core::read_file(source_folder() / "CMakePresets.json");
    for (const char* preset : {"dev", "release", "audit", "asan", "tidy", "bench", "fuzz"}) {
        EXPECT_NE(presets.find("\"name\": \"" + std::string(preset) + "\""), std::string::npos) << preset;
    }
}

}  // namespace
}  // namespace underbody::test
