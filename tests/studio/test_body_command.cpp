#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

TEST(BodyCommand, MakesTheBodyOfAShape) {
    const core::TemporaryFolder folder;
    const ProgramRun run = run_underbody(
        {"body", (source_folder() / "cases/evie/shapes/ellipse.toml").string(), "--out", "evie.stl", "--json"},
        folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const nlohmann::json document = nlohmann::json::parse(run.output);
    EXPECT_NEAR(document.at("volume").get<double>(), 0.0022442, 3e-6);
    EXPECT_TRUE(document.at("watertight").get<bool>());
    EXPECT_EQ(document.at("patches").at(0).at("name"), "base");
    const auto faces = document.at("patches").at(0).at("faces").get<std::size_t>() +
                       document.at("patches").at(1).at("faces").get<std::size_t>();
    EXPECT_EQ(std::filesystem::file_size(folder.path() / "evie.stl"), 84 + 50 * faces);
}

TEST(BodyCommand, RefusesAShapeThatCannotBe) {
    const core::TemporaryFolder folder;
    std::ofstream(folder.path() / "s.toml")
        << "[body]\nlength='203.2 mm'\nwidth='-152 mm'\nheight='145 mm'\nbase_cut=0.75\n";
    const ProgramRun run = run_underbody({"body", "s.toml", "--out", "s.stl"}, folder.path());
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_THAT(run.errors, testing::HasSubstr("s.toml:3"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "s.stl"));
}

}  // namespace
}  // namespace underbody::test
