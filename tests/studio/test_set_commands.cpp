// Numbers that are other than in the file: body --set, region --set, simulate --set, study set.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "core/file.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path evie() { return source_folder() / "cases" / "evie"; }

json json_of(const std::vector<std::string>& arguments) {
    const auto run = run_underbody(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return run.exit_code == 0 ? json::parse(run.output) : json();
}

TEST(SetCommands, ABodyWithOtherNumbersIsThatOfTheFileThatIsWritten) {
    const core::TemporaryFolder folder;
    const std::string shape = (evie() / "shapes" / "ellipse.toml").string();
    const std::string file = (folder.path() / "bumped.toml").string();
    const auto plain = json_of({"body", shape, "--panels", "0", "--triangles", "3000", "--json"});
    const auto changed = json_of({"body", shape, "--set", "protrusion.height=2mm", "--set", "body.base_cut=0.7", "--as",
                                  file, "--panels", "0", "--triangles", "3000", "--json"});
    EXPECT_NE(plain["volume"], changed["volume"]);
    EXPECT_EQ(json_of({"body", file, "--panels", "0", "--triangles", "3000", "--json"})["volume"], changed["volume"]);
}

TEST(SetCommands, WrongNumbersOfABodyAreSaid) {
    const std::string shape = (evie() / "shapes" / "ellipse.toml").string();
    const std::vector<std::pair<std::string, std::string>> wrong = {{"protrusion.heigth=2mm", "protrusion.height"},
                                                                    {"body.base_cut=7", "base_cut"},
                                                                    {"body.base_cut", "NAME=VALUE"}};
    for (const auto& [assignment, told] : wrong) {
        const auto run = run_underbody({"body", shape, "--set", assignment});
        EXPECT_NE(run.exit_code, 0) << assignment;
        EXPECT_NE(run.errors.find(told), std::string::npos) << run.errors;
    }
}

TEST(SetCommands, AModelWithAnotherNumberMovesAsItsFileWould) {
    const core::TemporaryFolder folder;
    fs::copy(evie() / "model.toml", folder.path() / "model.toml");
    fs::copy(evie() / "tables", folder.path() / "tables", fs::copy_options::recursive);
    std::string text = core::read_file(folder.path() / "model.toml");
    const std::string old = "net_weight = \"0.16 N\"";
    ASSERT_NE(text.find(old), std::string::npos);
    text.replace(text.find(old), old.size(), "net_weight = \"0.1 N\"");
    core::write_file(folder.path() / "other.toml", text);
    const auto ends = [&](const std::string& model, const std::vector<std::string>& more) {
        std::vector<std::string> words = {
            "simulate", (folder.path() / model).string(), "--from", "gap=10mm", "--for", "2 s", "--motion", "heave"};
        words.insert(words.end(), more.begin(), more.end());
        const auto run = run_underbody(words);
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        return run.output;
    };
    EXPECT_EQ(ends("model.toml", {"--set", "vehicle.net_weight=0.1N"}), ends("other.toml", {}));
    EXPECT_NE(ends("model.toml", {}), ends("other.toml", {}));
    const auto region = [&](const std::string& model, const std::vector<std::string>& more) {
        std::vector<std::string> words = {"region", (folder.path() / model).string(),
                                          "--axes", "gap=2mm:20mm,heave_velocity=-0.05:0.05",
                                          "--grid", "12x12",
                                          "--for",  "5 s"};
        words.insert(words.end(), more.begin(), more.end());
        return run_underbody(words).output;
    };
    EXPECT_EQ(region("model.toml", {"--set", "vehicle.net_weight=0.1N"}), region("other.toml", {}));
    const auto wrong =
        run_underbody({"region", (folder.path() / "model.toml").string(), "--set", "vehicle.net_wait=1N"});
    EXPECT_NE(wrong.exit_code, 0);
    EXPECT_NE(wrong.errors.find("vehicle.net_weight"), std::string::npos) << wrong.errors;
}

TEST(SetCommands, AStudyKeepsItsCommentsAndIsCheckedFirst) {
    const core::TemporaryFolder folder;
    write_small_study(folder.path());
    const fs::path file = folder.path() / "study.toml";
    std::string text = core::read_file(file);
    const auto at = text.find("net_weight");
    ASSERT_NE(at, std::string::npos);
    text.insert(text.find('\n', at), "   # weighed twice");
    core::write_file(file, text);
    const auto run = run_underbody(
        {"study", "set", folder.path().string(), "table.lift.net_weight=0.28N", "table.lift.virtual_mass=4 kg"});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const std::string after = core::read_file(file);
    EXPECT_NE(after.find("net_weight = \"0.28N\"   # weighed twice"), std::string::npos) << after;
    EXPECT_NE(after.find("virtual_mass = \"4 kg\""), std::string::npos);
    const auto wrong = [&](const std::string& assignment, const std::string& told) {
        const auto refused = run_underbody({"study", "set", folder.path().string(), assignment});
        EXPECT_NE(refused.exit_code, 0) << assignment;
        EXPECT_NE(refused.errors.find(told), std::string::npos) << refused.errors;
        EXPECT_EQ(core::read_file(file), after) << assignment;
    };
    wrong("table.lft.net_weight=1N", "lift");
    wrong("table.lift.net_wait=1N", "net_weight");
    wrong("table.lift.net_weight=1 kg", "net_weight");
    wrong("net_weight=1N", "net_weight");
    wrong("refrence.density=998", "reference");
    wrong("lift.net_weight=1N", "KIND.NAME.KEY");
    wrong("reference.densty=1025 kg/m^3", "density");
    wrong("reference.density=-1 kg/m^3", "density");
}

TEST(SetCommands, TablesThatAStudyHasOnceAreSetAndWhatRestsOnThemIsStale) {
    const core::TemporaryFolder folder;
    write_small_study(folder.path());
    const std::string study = folder.path().string();
    const fs::path file = folder.path() / "study.toml";
    const auto run = [&](const std::vector<std::string>& words) {
        const auto result = run_underbody(words);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        return result.output;
    };
    run({"study", "run", study, "--no-pictures"});
    run({"study", "set", study, "title=Cubes", "reference.density=1025 kg/m^3", "frame.symmetry=y=0"});
    const std::string text = core::read_file(file);
    EXPECT_NE(text.find("title = \"Cubes\""), std::string::npos) << text;
    EXPECT_NE(text.find("[reference]\ndensity = \"1025 kg/m^3\""), std::string::npos) << text;
    EXPECT_NE(text.find("[frame]\nsymmetry = \"y=0\""), std::string::npos) << text;
    run({"study", "set", study, "reference.density=998 kg/m^3"});  // where it stands by now
    EXPECT_NE(core::read_file(file).find("[reference]\ndensity = \"998 kg/m^3\""), std::string::npos);
    write_small_study(folder.path());
    EXPECT_NE(run({"study", "run", study, "--no-pictures"}).find("0 results computed"), std::string::npos);
    const auto states = [&] {
        std::set<std::string> found;
        const auto listed = nlohmann::json::parse(run({"study", "list", study, "--json"}));
        for (const auto& one : listed["cases"]) {
            found.insert(one["state"].get<std::string>());
        }
        return found;
    };
    run({"study", "set", study, "title=Other"});  // no load rests on it
    EXPECT_EQ(states(), std::set<std::string>{"unchanged"});
    run({"study", "set", study, "reference.density=1025 kg/m^3"});
    EXPECT_EQ(states(), std::set<std::string>{"changed"});
}

TEST(SetCommands, AListAndATableStayWhatTheyAre) {
    const core::TemporaryFolder folder;
    write_small_study(folder.path());
    const std::string study = folder.path().string();
    const fs::path file = folder.path() / "study.toml";
    const auto set = [&](const std::string& assignment) {
        const auto result = run_underbody({"study", "set", study, assignment});
        EXPECT_EQ(result.exit_code, 0) << assignment << result.errors;
        return core::read_file(file);
    };
    EXPECT_NE(set("table.lift.exports=[\"csv\", \"json\"]").find("\nexports = [\"csv\", \"json\"]\n"),
              std::string::npos);
    EXPECT_NE(set("table.lift.where={ variant = \"cube\" }").find("\nwhere = { variant = \"cube\" }\n"),
              std::string::npos);
    EXPECT_NE(set("title=[draft] of a cube").find("title = \"[draft] of a cube\""), std::string::npos);
    // A list over several lines is replaced as a whole; what stands behind it is found.
    std::string text = core::read_file(file);
    const std::string one = "exports = [\"csv\", \"json\"]";
    text.replace(text.find(one), one.size(), "exports = [  # for the rig\n  \"csv\",\n  \"json\",\n]  # both");
    core::write_file(file, text);
    text = set("table.lift.virtual_mass=5 kg");
    EXPECT_NE(text.find("]  # both\n"), std::string::npos) << text;
    text = set("table.lift.exports=[\"c\"]");
    EXPECT_NE(text.find("\nexports = [\"c\"]  # both\n"), std::string::npos) << text;
    EXPECT_EQ(text.find("\"json\""), std::string::npos) << text;
    EXPECT_NE(text.find("virtual_mass = \"5 kg\""), std::string::npos) << text;
}

}  // namespace
}  // namespace underbody::test
