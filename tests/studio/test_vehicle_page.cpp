// The pieces of docs/guide/controller-on-a-vehicle.md compile with a controller that the program exports.
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "core/file.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

TEST(ControllerOnAVehicle, CompilesAgainstTheInterfacesItNames) {
    if (std::system("command -v g++ > /dev/null 2>&1") != 0) {
        GTEST_SKIP() << "skipped: g++ is not installed; the pieces of the page were not compiled";
    }
    core::TemporaryFolder folder;
    const auto model = test::source_folder() / "cases" / "evie" / "heave" / "model.toml";
    const auto run = test::run_underbody(
        {"control", model.string(), "--hold", "20mm", "--from", "gap=0.25", "--limit", "150mN", "--export-c", "hold.h"},
        folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    std::istringstream page(core::read_file(test::source_folder() / "docs" / "guide" / "controller-on-a-vehicle.md"));
    std::string name, text;
    int compiled = 0;
    for (std::string line; std::getline(page, line);) {
        if (line.starts_with("```cpp ")) {
            name = line.substr(7);
            text.clear();
        } else if (line == "```" && !name.empty()) {
            core::write_file(folder.path() / name, text);
            EXPECT_EQ(std::system(("cd '" + folder.path().string() +
                                   "' && g++ -std=c++17 -fsyntax-only -Wall -Wextra -I . -I '" +
                                   (test::data_folder() / "controllers").string() + "' " + name + " 2> errors.txt")
                                      .c_str()),
                      0)
                << name << "\n"
                << core::read_file(folder.path() / "errors.txt");
            name.clear();
            ++compiled;
        } else {
            text += line + "\n";
        }
    }
    EXPECT_EQ(compiled, 3);
}

}  // namespace
}  // namespace underbody
