// Results of a study are those of its files, options and code as they are now, and of nothing else.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "cases/store.h"
#include "cases/study.h"
#include "core/file.h"
#include "core/text.h"
#include "tests/support/small_study.h"
#include "tests/support/support.h"
#ifdef UNDERBODY_WATCHES_SYSTEM_CALLS
#include "tests/cases/system_calls.h"
#endif

namespace underbody::cases {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

class TrueResults : public testing::Test {
protected:
    core::TemporaryFolder scratch;
    fs::path folder = scratch.path() / "study";

    StudyResults run(const fs::path& where = {}) {
        RunOptions options;
        options.pictures = false;
        return run_study(Study::open(where.empty() ? folder : where), options);
    }
    static std::set<std::string> in_state(const StudyResults& results, StepState state) {
        std::set<std::string> names;
        for (const auto& step : results.steps) {
            if (step.state == state) {
                names.insert(step.kind + " " + step.name);
            }
        }
        return names;
    }
    std::set<std::string> computed() { return in_state(run(), StepState::computed); }
    void put(const std::string& name, const std::string& text) { core::write_file(folder / name, text); }
    std::string get(const std::string& name) { return core::read_file(folder / name); }
    void replace(const std::string& name, const std::string& old, const std::string& by) {
        std::string text = get(name);
        const auto at = text.find(old);
        ASSERT_NE(at, std::string::npos) << old << " in " << name;
        put(name, text.replace(at, old.size(), by));
    }

    /// Everything that a study can have, each with the files that it rests on.
    void write_large_study() {
        test::write_small_study(folder);
        replace("glide.toml", "added_mass_heave = \"2 kg\"", "added_mass_heave = \"added.csv\"");
        replace("glide.toml", "[conditions]",
                "[[force]]\nquantity = \"lift_force\"\ntable = \"tables/more.csv\"\n[conditions]");
        put("added.csv", "gap [mm], added_mass_heave [kg]\n1, 2.1\n6, 2\n20, 1.9\n");
        put("tables/more.csv", "gap [mm], lift_force [N]\n1, 0.01\n3, 0.005\n6, 0\n");
        put("shapes/body.toml",
            "[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 mm\"\nbase_cut = 0.75\n");
        put("rig/dataset.toml",
            "kind = \"static\"\ntitle = \"t\"\n[conditions]\nspeed = \"0.5 m/s\"\n[[run]]\nfile = \"a.csv\"\n");
        std::string rows = "gap [mm], lift_force [N], lift_force_sigma [N]\n";
        for (int i = 0; i < 30; ++i) {
            rows += core::format_number(1 + i / 6.0, 6) + ", " +
                    core::format_number(0.01 - i * 3e-4 + (i % 3) * 1e-4, 6) + ", 0.0002\n";
        }
        put("rig/a.csv", rows);
        put("rig/notes.txt", "nobody reads this");
        put("static.toml",
            "[vehicle]\nmass = \"2 kg\"\nnet_weight = \"0.35 N\"\n[drag.heave]\nlinear = \"0.5 N s/m\"\nquadratic = "
            "\"10 N s^2/m^2\"\n"
            "[[force]]\nquantity = \"lift_force\"\ntable = \"tables/more.csv\"\n");
        core::write_file(folder / "study.toml",
                         get("study.toml") +
                             "[[body]]\nname = \"hull\"\nshape = \"shapes/body.toml\"\n"
                             "[[table]]\nname = \"second\"\nquantity = \"lift_force\"\naxes = [\"gap\"]\n"
                             "[[compare]]\nname = \"both\"\ntables = [\"lift\", \"second\"]\n"
                             "[[measurement]]\nname = \"rig\"\nmodel = \"static.toml\"\ndata = \"rig\"\n");
    }
};

const std::set<std::string> of_lift = {"table lift", "export lift as c", "export lift as csv",
                                       "region map", "model map",        "compare both"};

std::set<std::string> together(std::set<std::string> a, const std::set<std::string>& b) {
    a.insert(b.begin(), b.end());
    return a;
}

TEST_F(TrueResults, OneByteOfAnyFileMakesExactlyWhatRestsOnItNew) {
    write_large_study();
    const StudyResults first = run();
    ASSERT_EQ(first.failed, 0U) << testing::PrintToString(in_state(first, StepState::failed));
    EXPECT_THAT(computed(), IsEmpty());
    const struct {
        std::string file, old, by;
        std::set<std::string> made;
    } changes[] = {
        // A value: the loads, and all that is made of them. A byte that changes no number: the loads alone.
        {"fields/cube-h4.csv", "-0.05, -0.05, 0.004, 100", "-0.05, -0.05, 0.004, 101",
         together(of_lift, {"table second", "loads cube-h4", "verify solver"})},
        {"fields/cube-h3.csv", "[Name]\nhull", "[Name]\nhulk", {"loads cube-h3"}},
        {"forces.csv", "2, 0.5, 0", "2, 0.6, 0", {"verify solver"}},
        {"glide.toml", "mass = \"2 kg\"", "mass = \"3 kg\"", {"region map", "model map"}},
        {"added.csv", "20, 1.9", "20, 1.8", {"region map", "model map"}},
        {"tables/more.csv", "3, 0.005", "3, 0.006", {"region map", "model map", "residual rig"}},
        {"static.toml", "10 N s^2", "11 N s^2", {"residual rig"}},
        {"shapes/body.toml", "0.75", "0.76", {"body hull"}},
        {"rig/dataset.toml", "0.5 m/s", "0.6 m/s", {"residual rig"}},
        {"rig/a.csv", "1, 0.01, 0.0002", "1, 0.02, 0.0002", {"residual rig"}},
        {"rig/notes.txt", "nobody", "nobodY", {}},
        {"study.toml", "title = \"a cube\"", "title = \"A cube\"", {"model map"}},
    };
    RunOptions looking;
    looking.pictures = false;
    for (const auto& change : changes) {
        const std::string whole = get(change.file);
        replace(change.file, change.old, change.by);
        EXPECT_EQ(in_state(stored_results(Study::open(folder), looking), StepState::changed).empty(),
                  change.made.empty())
            << change.file;
        EXPECT_EQ(computed(), change.made) << change.file;
        put(change.file, whole);
        EXPECT_THAT(computed(), IsEmpty()) << change.file << ", put back";
    }
}

TEST_F(TrueResults, AnotherFileInStudyTomlMakesWhatRestsOnItNew) {
    write_large_study();
    ASSERT_EQ(run().failed, 0U);
    // The old files stay as they are: only the study's word for them changes.
    put("forces2.csv", get("forces.csv") + " ");
    put("glide2.toml", get("glide.toml") + "\n");
    put("static2.toml", get("static.toml") + "\n");
    put("shapes/body2.toml", get("shapes/body.toml") + "\n");
    fs::copy(folder / "rig", folder / "rig2", fs::copy_options::recursive);
    const struct {
        std::string old, by;
        std::set<std::string> made;
    } changes[] = {
        {"\"forces.csv\"", "\"forces2.csv\"", {"verify solver"}},
        {"\"glide.toml\"", "\"glide2.toml\"", {"region map", "model map"}},
        {"\"static.toml\"", "\"static2.toml\"", {"residual rig"}},
        {"\"rig\"\n", "\"rig2\"\n", {"residual rig"}},
        {"shapes/body.toml", "shapes/body2.toml", {"body hull"}},
    };
    for (const auto& change : changes) {
        const std::string whole = get("study.toml");
        // the last place: a name of a step may be the same word
        const auto at = whole.rfind(change.old);
        ASSERT_NE(at, std::string::npos) << change.old;
        put("study.toml", whole.substr(0, at) + change.by + whole.substr(at + change.old.size()));
        EXPECT_EQ(computed(), change.made) << change.by;
        put("study.toml", whole);
        EXPECT_THAT(computed(), IsEmpty()) << change.by << ", put back";
    }
}

TEST_F(TrueResults, OneOptionMakesExactlyWhatRestsOnItNew) {
    write_large_study();
    ASSERT_EQ(run().failed, 0U);
    std::set<std::string> all_loads;
    for (int gap = 1; gap <= 6; ++gap) {
        all_loads.insert("loads cube-h" + std::to_string(gap));
    }
    const struct {
        std::string old, by;
        std::set<std::string> made;
    } changes[] = {
        {"net_weight = \"0.35 N\"",
         "net_weight = \"0.34 N\"",
         {"table lift", "compare both", "export lift as c", "export lift as csv",
          "region map"}},  // the map says that the table's weight is not its model's
        {"exports = [\"c\", \"csv\"]", "exports = [\"c\", \"json\"]", {"export lift as json"}},
        {"for = \"20 s\"", "for = \"21 s\"", {"region map"}},
        {"columns = 40", "columns = 41", {"region map"}},
        {"quantities = [\"lift_force\", \"drag_force\"]", "quantities = [\"lift_force\"]", {"verify solver"}},
        {"axes = [\"gap\"]\nwhere", "axes = [\"gap\"]\nrelative_sigma = 0.01\nwhere", of_lift},
        {"title = \"a cube\"\n", "title = \"a cube\"\n[reference]\nlength = \"0.1 m\"\n",
         together(all_loads, {"verify solver"})},
        {"title = \"a cube\"\n", "title = \"a cube\"\n[reference]\ndensity = \"1000 kg/m^3\"\n",
         together(all_loads,
                  {"body hull", "verify solver", "region map", "model map"})},  // tables of a model say their water
        {"title = \"a cube\"\n", "title = \"a cube\"\n[frame]\nmoments_about = [0, 0, 0.001]\n",
         together(all_loads, {"verify solver"})},  // forces do not know the point of the moments: their tables stay
    };
    for (const auto& change : changes) {
        const std::string whole = get("study.toml");
        replace("study.toml", change.old, change.by);
        EXPECT_EQ(computed(), change.made) << change.by;
        put("study.toml", whole);
        EXPECT_THAT(computed(), IsEmpty()) << change.by << ", put back";
    }
}

TEST_F(TrueResults, CasesWhoseNamedFilesAreAlikeStayApart) {
    fs::create_directories(folder / "runs");
    for (const std::string name : {"a", "b"}) {
        fs::copy(test::data_folder() / "openfoam" / "ascii", folder / "runs" / name, fs::copy_options::recursive);
        put("runs/" + name + "/case.foam", "");
    }
    replace("runs/b/0.005/wallShearStress", "dimensions", "dimensions ");
    put("study.toml",
        "title = \"t\"\n[[case]]\nfiles = \"runs/{variant}/case.foam\"\nconditions.gap = \"5 "
        "mm\"\n[reference]\ndensity = \"998 kg/m^3\"\n");
    for (int round = 0; round < 4; ++round) {
        const StudyResults results = run();
        ASSERT_EQ(results.case_loads.size(), 2U);
        EXPECT_EQ(results.failed, 0U) << results.case_loads[0].error;
        EXPECT_EQ(results.computed, round == 0 ? 2U : 0U);
        for (const auto& loads : results.case_loads) {
            const auto document = nlohmann::json::parse(results.loads_document(loads));
            EXPECT_EQ(document.at("file"), "runs/" + loads.name + "/case.foam");
        }
        EXPECT_NE(results.case_loads[0].origin, results.case_loads[1].origin);
    }
    // Equal to the byte, they are still two.
    put("runs/b/0.005/wallShearStress", get("runs/a/0.005/wallShearStress"));
    (void)run();
    const StudyResults listed = stored_loads(Study::open(folder), {});
    EXPECT_EQ(listed.case_loads[0].state, StepState::unchanged);
    EXPECT_EQ(listed.case_loads[1].state, StepState::unchanged);
    replace("runs/a/0.005/wallShearStress", "dimensions", "dimensions ");
    const StudyResults later = stored_loads(Study::open(folder), {});
    EXPECT_EQ(later.case_loads[0].state, StepState::changed);
    EXPECT_EQ(later.case_loads[1].state, StepState::unchanged);
}

/// Every byte of every file below a folder.
std::map<std::string, std::string> bytes_below(const fs::path& folder) {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) {
            all[entry.path().lexically_relative(folder).string()] = core::read_file(entry.path());
        }
    }
    return all;
}

std::string everything(const StudyResults& results) {
    nlohmann::json json = results;
    for (const char* key : {"report", "computed", "reused", "steps"}) {
        json.erase(key);
    }
    return json.dump(1);
}

TEST_F(TrueResults, AStudyThatIsMovedOrCopiedIsUnchangedByteByByte) {
    write_large_study();
    replace("study.toml", "data = \"rig\"", "data = \"rig\"\ndiscover = true");
    const StudyResults first = run();
    ASSERT_EQ(first.failed, 0U) << testing::PrintToString(in_state(first, StepState::failed));
    const std::string before = everything(first);
    const auto report = bytes_below(folder / "report");
    EXPECT_GT(report.size(), 4U);
    const fs::path copy = scratch.path() / "deeper" / "down" / "copy";
    fs::create_directories(copy.parent_path());
    fs::copy(folder, copy, fs::copy_options::recursive);
    const StudyResults of_copy = run(copy);
    EXPECT_EQ(of_copy.computed, 0U) << testing::PrintToString(in_state(of_copy, StepState::computed));
    EXPECT_EQ(everything(of_copy), before);
    EXPECT_EQ(bytes_below(copy / "report"), report);
    const fs::path moved = scratch.path() / "moved";
    fs::rename(folder, moved);
    const StudyResults of_moved = run(moved);
    EXPECT_EQ(of_moved.computed, 0U);
    EXPECT_EQ(everything(of_moved), before);
    // Computed anew in the new place, it is the same too, and no result knows the place.
    fs::remove_all(moved / ".underbody");
    fs::remove_all(moved / "report");
    const StudyResults anew = run(moved);
    EXPECT_EQ(anew.reused, 0U);
    EXPECT_EQ(everything(anew), before);
    EXPECT_EQ(bytes_below(moved / "report"), report);
    Store store(moved / ".underbody" / "store.sqlite", Store::Access::read);
    for (const auto& result : store.results()) {
        const std::string place = scratch.path().string();
        EXPECT_EQ(store.value(result.id).value_or("").find(place), std::string::npos)
            << result.kind << " " << result.name;
        EXPECT_EQ(store.made(result.id).value().about.find(place), std::string::npos)
            << result.kind << " " << result.name;
        EXPECT_EQ(store.value(result.id).value_or("").find(fs::temp_directory_path().string() + "/underbody"),
                  std::string::npos)
            << result.kind << " " << result.name;
        for (const auto& input : result.inputs.all()) {
            EXPECT_FALSE(fs::path(input.path).is_absolute()) << result.kind << " " << result.name << ": " << input.path;
        }
    }
}

TEST_F(TrueResults, AReportElsewhereIsThatOfTheStudy) {
    test::write_small_study(folder);
    (void)run();
    RunOptions elsewhere;
    elsewhere.pictures = false;
    elsewhere.report = scratch.path() / "out" / "r.html";
    const StudyResults results = run_study(Study::open(folder), elsewhere);
    EXPECT_EQ(results.computed, 0U);
    auto there = bytes_below(scratch.path() / "out");
    auto here = bytes_below(folder / "report");
    EXPECT_EQ(there.at("r.html"), here.at("index.html"));
    there.erase("r.html");
    here.erase("index.html");
    EXPECT_EQ(there, here);
    EXPECT_THAT(here, testing::Contains(testing::Key("models/map/model.toml")));
    EXPECT_THAT(here, testing::Contains(testing::Key("exports/lift.h")));
}

TEST_F(TrueResults, AStoreOfTheFirstVersionIsComputedAgainWithASentenceAndNothingIsDeleted) {
    test::write_small_study(folder);
    fs::create_directories(folder / ".underbody");
    fs::copy(test::data_folder() / "stores" / "0.1.0.sqlite", folder / ".underbody" / "store.sqlite");
    fs::permissions(folder / ".underbody" / "store.sqlite", fs::perms::owner_all, fs::perm_options::add);
    const auto rows = [&] {
        SQLite::Database database((folder / ".underbody" / "store.sqlite").string(), SQLite::OPEN_READONLY);
        return database.execAndGet("SELECT COUNT(*) FROM results").getInt();
    };
    const int old = rows();
    ASSERT_GT(old, 10);
    const StudyResults listed = stored_loads(Study::open(folder), {});
    EXPECT_THAT(listed.notes, ElementsAre(HasSubstr("0.1.0")));
    EXPECT_TRUE(listed.case_loads[0].values.empty());
    const StudyResults first = run();
    EXPECT_THAT(first.notes, ElementsAre(HasSubstr("computed again, once; nothing in it is deleted")));
    EXPECT_EQ(first.reused, 0U);
    EXPECT_GT(first.computed, 10U);
    EXPECT_EQ(rows(), old);
    const StudyResults second = run();
    EXPECT_THAT(second.notes, IsEmpty());
    EXPECT_EQ(second.computed, 0U);
}

TEST_F(TrueResults, AHalfModelWithoutItsPlaneIsToldWhereverTheNumberIsRead) {
    test::write_small_study(folder);
    for (int gap = 1; gap <= 6; ++gap) {
        put("fields/cube-h" + std::to_string(gap) + ".csv", test::half_cube_field(1e-3 * gap, 100.0 * gap));
    }
    fs::remove(folder / "forces.csv");
    std::string text = get("study.toml");
    text.erase(text.find("[[verify]]"), text.find("[[table]]") - text.find("[[verify]]"));
    put("study.toml", text);
    const StudyResults results = run();
    ASSERT_EQ(results.failed, 0U);
    const auto warnings = results.gathered_warnings();
    ASSERT_FALSE(warnings.empty());
    EXPECT_THAT(warnings.front().message, HasSubstr("half model"));
    EXPECT_THAT(warnings.front().message, HasSubstr("5 other files"));
    const StudyResults again = run();
    EXPECT_EQ(again.computed, 0U);
    EXPECT_EQ(again.gathered_warnings().size(), warnings.size()) << "not only when it is computed";
    EXPECT_FALSE(stored_loads(Study::open(folder), {}).gathered_warnings().empty());
    const std::string report = get("report/index.html");
    EXPECT_THAT(report, HasSubstr("half model"));
    ASSERT_NE(report.find("How far to trust the numbers"), std::string::npos);
    EXPECT_NE(report.find("half model", report.find("How far to trust the numbers")), std::string::npos);
    // With the plane the lift is the whole cube's.
    put("study.toml", get("study.toml") + "[frame]\nsymmetry = \"y\"\n");
    const StudyResults whole = run();
    EXPECT_NEAR(whole.case_loads[1].value("lift_force"), 0.2, 1e-9);
    EXPECT_NEAR(results.case_loads[1].value("lift_force"), 0.1, 1e-9);
    EXPECT_TRUE(whole.gathered_warnings().empty());
}

TEST_F(TrueResults, TwoRunsAtOnceShareTheWork) {
    test::write_small_study(folder);
    StudyResults one;
    StudyResults two;
    std::thread other([&] { two = run(); });
    one = run();
    other.join();
    EXPECT_EQ(one.failed + two.failed, 0U);
    EXPECT_EQ(everything(one), everything(two));
    EXPECT_EQ(one.computed + two.computed, one.steps.size()) << "each result is made once";
    EXPECT_THAT(computed(), IsEmpty());
}

#ifdef UNDERBODY_WATCHES_SYSTEM_CALLS
TEST_F(TrueResults, AWriteThatFailsAnywhereLeavesTheStoreWhole) {
    test::write_small_study(folder);
    const std::string truth = everything(run());
    const auto report = bytes_below(folder / "report");
    long all = 0;
    {
        fs::remove_all(folder / ".underbody");
        const test::FailingWrites none(1000000);
        (void)run();
        all = test::FailingWrites::calls();
    }
    ASSERT_GT(all, 50);
    // Some of the calls in every run of the tests, all of them on demand.
    const long step = std::getenv("UNDERBODY_ALL_KILLS") != nullptr ? 1 : std::max(1L, all / 12);
    for (long n = 1; n < all; n += step) {
        fs::remove_all(folder / ".underbody");
        fs::remove_all(folder / "report");
        try {
            const test::FailingWrites full(n);
            (void)run();
        } catch (const core::SystemError&) {
        }
        for (const auto& [name, bytes] :
             fs::exists(folder / "report") ? bytes_below(folder / "report") : std::map<std::string, std::string>()) {
            ASSERT_TRUE(report.contains(name)) << "call " << n << " leaves " << name;
            EXPECT_EQ(bytes, report.at(name)) << "call " << n << ": half of " << name;
        }
        const fs::path store = folder / ".underbody" / "store.sqlite";
        if (fs::exists(store) && fs::file_size(store) > 0) {
            SQLite::Database database(store.string(), SQLite::OPEN_READWRITE);
            EXPECT_EQ(database.execAndGet("PRAGMA integrity_check").getString(), "ok") << "call " << n;
        }
        const StudyResults after = run();
        EXPECT_EQ(everything(after), truth) << "call " << n;
        EXPECT_EQ(bytes_below(folder / "report"), report) << "call " << n;
    }
}
#endif

}  // namespace
}  // namespace underbody::cases
