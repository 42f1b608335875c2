// The man pages say what the programs do: every command and option they name exists.
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "core/file.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

/// Names that follow ".TP\n.B " in a section of a man page.
std::set<std::string> tagged(const std::string& page, const std::string& section) {
    std::set<std::string> names;
    const std::size_t begin = page.find(".SH " + section + "\n");
    const std::size_t end = page.find("\n.SH ", begin + 1);
    const std::string text = page.substr(begin, end - begin);
    const std::regex tag("\\.TP\n\\.B ([a-z]+)\n");
    for (std::sregex_iterator it(text.begin(), text.end(), tag), last; it != last; ++it) {
        names.insert((*it)[1]);
    }
    return names;
}

TEST(ManPages, NameOnlyCommandsThatExist) {
    const std::string page = core::read_file(source_folder() / "docs" / "man" / "underbody.1");
    const auto help = run_underbody({"--help"});
    ASSERT_EQ(help.exit_code, 0);
    std::set<std::string> commands;
    const std::string list = help.output.substr(help.output.find("Subcommands:"));
    const std::regex line("\n  ([a-z]+) +[^\n]*");
    const std::string block = list.substr(0, list.find("\n\n"));
    for (std::sregex_iterator it(block.begin(), block.end(), line), last; it != last; ++it) {
        commands.insert((*it)[1]);
    }
    EXPECT_GE(commands.size(), 10U) << help.output;
    const std::set<std::string> named = tagged(page, "COMMANDS");
    EXPECT_GE(named.size(), 10U);
    for (const auto& name : named) {
        EXPECT_TRUE(commands.contains(name)) << name;
    }
}

TEST(ManPages, NameOnlyOptionsThatExist) {
    for (const std::string program : {"underbody", "underbody-studio"}) {
        const std::string page = core::read_file(source_folder() / "docs" / "man" / (program + ".1"));
        const auto help = run_program((program_folder() / program).string(), {"--help"});
        ASSERT_EQ(help.exit_code, 0) << program;
        const std::size_t begin = page.find(".SH OPTIONS\n");
        const std::string options = page.substr(begin, page.find("\n.SH ", begin + 1) - begin);
        const std::regex option("\\\\-\\\\-([a-z]+)");
        int count = 0;
        for (std::sregex_iterator it(options.begin(), options.end(), option), last; it != last; ++it) {
            EXPECT_NE(help.output.find("--" + (*it)[1].str()), std::string::npos) << program << " --" << (*it)[1];
            ++count;
        }
        EXPECT_GE(count, 4) << program;
    }
}

}  // namespace
}  // namespace underbody::test
