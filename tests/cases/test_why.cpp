// From a number back to the files, options and code that made it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "cases/code_version.h"
#include "cases/doubts.h"
#include "cases/why.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"
#include "surrogates/tables/exports/export.h"
#include "tests/support/small_study.h"

namespace underbody::cases {
namespace {

using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class Why : public testing::Test {
protected:
    void SetUp() override {
        test::write_small_study(folder);
        run();
    }
    void run() {
        const auto results = run_study(Study::open(folder), options());
        ASSERT_EQ(results.failed, 0U);
    }
    static RunOptions options() {
        RunOptions all;
        all.pictures = false;
        return all;
    }
    Way why(const std::string& what) { return way_back(Study::open(folder), options(), what); }
    /// The message of the refusal.
    std::string refusal(const std::string& what) {
        try {
            (void)why(what);
        } catch (const core::InputError& error) {
            return error.message() + " | " + error.hint();
        }
        return "none";
    }
    static const Origin* find(const Way& way, const std::string& kind, const std::string& name) {
        for (const auto& origin : way.origins) {
            if (origin.kind == kind && origin.name == name) {
                return &origin;
            }
        }
        return nullptr;
    }
    [[nodiscard]] std::string hash_of(const fs::path& file) const { return core::content_hash_of_file(folder / file); }

    core::TemporaryFolder scratch;
    fs::path folder = scratch.path() / "study";
};

TEST_F(Why, WalksFromATableToTheFacesAndFilesOfItsLoads) {
    const Way way = why("table/lift");
    ASSERT_EQ(way.origins.size(), 7U);
    const Origin& table = way.origins.front();
    ASSERT_NE(table.fact("stable gap"), nullptr);
    EXPECT_NEAR(table.fact("stable gap")->number.value(), 0.0035, 1e-9);
    EXPECT_EQ(table.fact("stable gap")->unit, "m");
    EXPECT_EQ(table.fact("stable gap")->value, "3.5 mm");
    EXPECT_EQ(table.fact("points")->value, "6");
    ASSERT_NE(table.fact("lift_force at gap 2 mm"), nullptr);
    EXPECT_EQ(table.fact("lift_force at gap 2 mm")->value, "0.5 N, cube-h2, settled: unknown");
    EXPECT_NEAR(table.fact("lift_force at gap 2 mm")->number.value(), 0.5, 1e-9);
    ASSERT_NE(table.fact("lift_force at gap 6 mm"), nullptr);
    EXPECT_EQ(table.from.size(), 6U);
    for (int gap = 1; gap <= 6; ++gap) {
        const Origin* loads = find(way, "loads", "cube-h" + std::to_string(gap));
        ASSERT_NE(loads, nullptr) << gap;
        EXPECT_NEAR(loads->fact("lift_force")->number.value(), (7 - gap) / 10.0, 1e-9);
        EXPECT_THAT(loads->fact("zone 'hull'")->value, HasSubstr("5 faces"));
        EXPECT_THAT(loads->fact("solution")->value, HasSubstr("unknown"));
        const std::string file = "fields/cube-h" + std::to_string(gap) + ".csv";
        const StoredInput read{core::Input::Kind::content, file, "", hash_of(file)};
        EXPECT_THAT(loads->files, testing::Contains(read));
        EXPECT_THAT(loads->code, testing::Contains(std::pair<const std::string, std::string>(
                                     "postproc", code_versions().at("postproc"))));
        EXPECT_EQ(loads->state, StepState::unchanged);
        EXPECT_FALSE(loads->made.empty());
    }
}

TEST_F(Why, EveryResultOfAReportHasItsWayBackToFiles) {
    const Way region = why("region/map");
    EXPECT_NE(find(region, "table", "lift"), nullptr);
    EXPECT_NE(find(region, "loads", "cube-h3"), nullptr);
    std::set<std::string> read;
    for (const auto& file : region.origins.front().files) {
        read.insert(file.path);
    }
    EXPECT_THAT(read, testing::Contains("glide.toml"));
    EXPECT_NE(find(why("verify/solver"), "loads", "cube-h6"), nullptr);
    EXPECT_NE(find(why("models/map/model.toml"), "loads", "cube-h6"), nullptr);
    // As a person names a number, and as the report prints it.
    const Way lift = why("lift_force of cube-h2");
    ASSERT_TRUE(lift.asked);
    EXPECT_NEAR(lift.asked->number.value(), 0.5, 1e-9);
    EXPECT_EQ(lift.asked->unit, "N");
    const Way gap = why("stable gap of table/lift");
    EXPECT_NEAR(gap.asked->number.value(), 0.0035, 1e-9);
    const Way printed = why("0.5 N");
    ASSERT_TRUE(printed.asked);
    EXPECT_EQ(printed.asked->name, "lift_force");
    EXPECT_EQ(printed.origins.front().name, "cube-h2");
}

TEST_F(Why, OneNumberOfSeveralResultsIsThatOfTheOneTheyRestOn) {
    const Way gap = why("3.5 mm");  // of the table, and of the map that rests on it
    ASSERT_TRUE(gap.asked);
    EXPECT_EQ(gap.asked->name, "stable gap");
    EXPECT_EQ(gap.origins.front().kind, "table");
    EXPECT_THAT(gap.notes, testing::Contains(HasSubstr("region/map, which rests on it")));
    // Without a unit: as it is printed.
    EXPECT_EQ(why("3.5").asked->name, "stable gap");
    EXPECT_EQ(why("0.5").origins.front().name, "cube-h2");
    // A frequency in hertz wherever it is told: 100 N/m on 4 kg.
    const Way map = why("region/map");
    const Fact* frequency = map.origins.front().fact("frequency at the stable gap");
    ASSERT_NE(frequency, nullptr);
    EXPECT_NEAR(frequency->number.value(), 5 / (2 * 3.14159265358979), 1e-3);
    EXPECT_NEAR(frequency->number.value(),
                why("table/lift").origins.front().fact("frequency at the stable gap")->number.value(), 1e-6);
}

TEST_F(Why, FilesBesideTheReportAndNamesOfNumbersAreUnderstood) {
    EXPECT_EQ(why("lift.h").origins.front().kind, "table") << "as exports/lift.h";
    EXPECT_EQ(why("exports/lift.h").origins.front().kind, "table");
    const fs::path model = folder / "report" / "models" / "map";
    ASSERT_TRUE(fs::exists(model / "model.toml"));
    for (const auto& entry : fs::directory_iterator(model)) {
        EXPECT_EQ(why(entry.path().string()).origins.front().kind, "model") << entry.path();
    }
    EXPECT_EQ(why("kick velocity at the stable gap").origins.front().kind, "table");
    EXPECT_THAT(refusal((folder / "report" / "index.html").string()), HasSubstr("report of many numbers"));
    EXPECT_EQ(why("largest difference").origins.front().kind, "verify");
}

TEST_F(Why, WhatAllCasesOfATableShareGoesWithIt) {
    const fs::path header = folder / "report" / "exports" / "lift.h", model = folder / "report" / "models" / "map";
    for (const bool in_where : {true, false}) {
        EXPECT_THAT(core::read_file(header), HasSubstr("Holds for speed = 0.5 m/s"));
        EXPECT_THAT(core::read_file(header), HasSubstr("Of variant cube"));
        EXPECT_THAT(core::read_file(model / "model.toml"), HasSubstr("scale.speed = { reference = \"0.5 m/s\""));
        if (in_where) {  // the cases say their speed, whether or not the table asks for it
            std::string text = core::read_file(folder / "study.toml");
            const std::string asked = ", speed = 0.5 }";
            ASSERT_NE(text.find(asked), std::string::npos);
            text.replace(text.find(asked), asked.size(), " }");
            core::write_file(folder / "study.toml", text);
            run();
        }
    }
}

/// [reference] says the speed of cases that do not: their tables hold for it, and a map scales its force from it.
TEST_F(Why, ASpeedThatOnlyTheReferenceSaysIsThatOfTheTables) {
    const auto warned = [&] {  // at study run
        const Study study = Study::open(folder);
        return warnings_of(study.regions.front(), run_study(study, options()));
    };
    EXPECT_TRUE(warned().empty());
    std::string text = core::read_file(folder / "study.toml");
    for (const std::string& away : {std::string("conditions.speed = \"0.5 m/s\"\n"), std::string(", speed = 0.5")}) {
        ASSERT_NE(text.find(away), std::string::npos);
        text.erase(text.find(away), away.size());
    }
    core::write_file(folder / "study.toml", text);
    run();
    const fs::path model = folder / "report" / "models" / "map" / "model.toml";
    const fs::path report = folder / "report" / "index.html";
    EXPECT_THAT(core::read_file(model), Not(HasSubstr("scale.speed")));
    EXPECT_THAT(core::read_file(report), HasSubstr("states a speed, nor does [reference]"));
    EXPECT_THAT(warned(), testing::ElementsAre(HasSubstr("states a speed, nor does [reference]")));
    core::write_file(folder / "study.toml", text + "[reference]\nspeed = \"0.4 m/s\"\n");
    run();
    EXPECT_THAT(core::read_file(model), HasSubstr("scale.speed = { reference = \"0.4 m/s\", exponent = 2 }"));
    EXPECT_THAT(core::read_file(folder / "report" / "exports" / "lift.h"), HasSubstr("Holds for speed = 0.4 m/s"));
    EXPECT_THAT(core::read_file(report), Not(HasSubstr("nor does [reference]")));
    EXPECT_THAT(core::read_file(report), HasSubstr("(0.5/0.4)^2"));
    EXPECT_THAT(warned(), testing::ElementsAre(HasSubstr("(0.5/0.4)^2")));
}

TEST_F(Why, TheMapSaysWhereItsModelIsNotTheOneOfTheTable) {
    EXPECT_THAT(core::read_file(folder / "report" / "index.html"), Not(HasSubstr("for a net weight of")));
    std::string text = core::read_file(folder / "glide.toml");
    text.replace(text.find("0.35 N"), 6, "0.25 N");
    core::write_file(folder / "glide.toml", text);
    run();
    const Way map = why("region/map");
    const Fact* remark = nullptr;
    for (const auto& fact : map.origins.front().facts) {
        remark = fact.value.find("not the table") != std::string::npos ? &fact : remark;
    }
    ASSERT_NE(remark, nullptr);
    EXPECT_THAT(remark->value, HasSubstr("for a net weight of 0.35 N, the model's net weight is 0.25 N"));
    EXPECT_THAT(core::read_file(folder / "report" / "index.html"), HasSubstr("for a net weight of 0.35 N"));
}

TEST_F(Why, SaysWhatIsNotThereAndWhatIsNear) {
    EXPECT_THAT(refusal("table/lfit"), HasSubstr("did you mean 'table/lift'"));
    EXPECT_THAT(refusal("lift_fore of cube-h2"), HasSubstr("did you mean 'lift_force'"));
    const std::string several = refusal("0 N m");  // of every case: none rests on another
    EXPECT_THAT(several, testing::AllOf(HasSubstr("\"pitch_moment of loads/cube-h1\""), HasSubstr("loads/cube-h2")));
    EXPECT_THAT(refusal("stable gap"), testing::AllOf(HasSubstr("\"stable gap of table/lift\" (3.5 mm)"),
                                                      HasSubstr("\"stable gap of region/map\"")));
    EXPECT_THAT(refusal("3.7 mm"), HasSubstr("with its unit"));
    EXPECT_THAT(refusal("map"), testing::AllOf(HasSubstr("model/map"), HasSubstr("region/map")));
    EXPECT_THAT(refusal("77.7 N"), HasSubstr("no result"));
    const core::TemporaryFolder other;
    test::write_small_study(other.path());
    EXPECT_THROW((void)way_back(Study::open(other.path()), options(), "table/lift"), core::InputError);
    // What is no longer true is no answer.
    core::write_file(folder / "fields" / "cube-h2.csv", test::cube_field(0.002, 510));
    EXPECT_THAT(refusal("loads/cube-h2"), HasSubstr("no result"));
}

TEST_F(Why, AnExportedFileKnowsItsResultAlsoWhenItHasBeenMadeAnewSince) {
    for (const char* file : {"lift.h", "lift.csv"}) {
        const Way way = why("exports/" + std::string(file));
        EXPECT_EQ(way.origins.front().kind, "table") << file;
        EXPECT_TRUE(way.notes.empty());
        EXPECT_THAT(core::read_file(folder / "report" / "exports" / file),
                    HasSubstr("Result: table/lift " + way.origins.front().id));
    }
    const fs::path kept = scratch.path() / "controller" / "old.h";
    fs::create_directories(kept.parent_path());
    fs::copy_file(folder / "report" / "exports" / "lift.h", kept);
    const std::string old_hash = hash_of("fields/cube-h4.csv");
    core::write_file(folder / "fields" / "cube-h4.csv", test::cube_field(0.004, 310));
    run();
    EXPECT_NE(core::read_file(folder / "report" / "exports" / "lift.h"), core::read_file(kept));
    const Way way = why(kept.string());
    ASSERT_EQ(way.notes.size(), 1U);
    EXPECT_THAT(way.notes.front(), HasSubstr("has been made anew since"));
    EXPECT_NEAR(way.origins.front().fact("stable gap")->number.value(), 0.0035, 1e-9) << "of then, not of now";
    const Origin* loads = find(way, "loads", "cube-h4");
    ASSERT_NE(loads, nullptr);
    EXPECT_NEAR(loads->fact("lift_force")->number.value(), 0.3, 1e-9);
    EXPECT_EQ(loads->state, StepState::changed);
    const StoredInput then{core::Input::Kind::content, "fields/cube-h4.csv", "", old_hash};
    EXPECT_THAT(loads->files, testing::Contains(then));
    EXPECT_EQ(find(way, "loads", "cube-h3")->state, StepState::unchanged);
    // Of another study.
    const core::TemporaryFolder other;
    test::write_small_study(other.path());
    core::write_file(other.path() / "fields" / "cube-h1.csv", test::cube_field(0.001, 650));
    (void)run_study(Study::open(other.path()), options());
    try {
        (void)way_back(Study::open(other.path()), options(), kept.string());
        ADD_FAILURE() << "it is of another study";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.message(), HasSubstr("which the store of this study does not have"));
    }
}

/// From file to file: what a table was first is said in each, and is the way back.
TEST_F(Why, AFileThatWasExportedAgainAndAgainKnowsItsResult) {
    fs::path from = folder / "report" / "exports" / "lift.csv";
    const std::string id = why("exports/lift.csv").origins.front().id;
    for (const char* format : {"json", "csv", "c"}) {
        const fs::path to = scratch.path() / (std::string("again.") + (format == std::string("c") ? "h" : format));
        (void)tables::export_table(tables::ForceTable::read(from.string(), "lift_force"), format, to, {});
        EXPECT_THAT(core::read_file(to), HasSubstr("Which holds result: table/lift " + id)) << format;
        const Way way = why(to.string());
        const Origin* table = find(way, "table", "lift");
        ASSERT_NE(table, nullptr) << format;
        EXPECT_EQ(table->id, id) << format;
        ASSERT_EQ(way.notes.size(), 1U) << format;
        EXPECT_THAT(way.notes.front(), testing::AnyOf(HasSubstr("made of exports/lift.csv of this study"),
                                                      HasSubstr("exported anew from one that held table/lift")));
        from = to;
    }
}

TEST_F(Why, ACopyThatWasChangedIsNotTakenForWhatWasExported) {
    const fs::path copy = scratch.path() / "copy.h";
    std::string text = core::read_file(folder / "report" / "exports" / "lift.h");
    core::write_file(copy, text);
    EXPECT_TRUE(why(copy.string()).notes.empty());
    const auto digit = text.find_last_of("123456789", text.rfind('}'));
    text[digit] = text[digit] == '9' ? '8' : '9';
    core::write_file(copy, text);
    const Way way = why(copy.string());
    EXPECT_EQ(way.origins.front().name, "lift");
    ASSERT_EQ(way.notes.size(), 1U);
    EXPECT_THAT(way.notes.front(), HasSubstr("this file differs from what was exported"));
}

/// Loads that were computed anew with equal forces moved nothing of what rests on them.
TEST_F(Why, NothingHasChangedSinceWhereTheNumbersAreEqual) {
    std::string text = core::read_file(folder / "study.toml");
    core::write_file(folder / "study.toml", text + "[reference]\ndensity = \"998 kg/m^3\"\nspeed = \"0.5 m/s\"\n");
    run();
    core::write_file(folder / "study.toml", text + "[reference]\ndensity = \"1025 kg/m^3\"\nspeed = \"0.5 m/s\"\n");
    run();
    for (const auto& origin : why("region/map").origins) {
        EXPECT_EQ(origin.state, StepState::unchanged) << origin.kind << " " << origin.name;
        for (const auto& [label, value] : origin.options) {
            EXPECT_TRUE(origin.kind != "loads" || label != "density" || value == "1025") << value;
        }
    }
}

TEST_F(Why, AFinishedStudyComputesNoExportAgain) {
    std::string text = core::read_file(folder / "study.toml"), formats;
    for (const auto& format : tables::export_formats()) {
        formats += (formats.empty() ? "\"" : ", \"") + format.name + "\"";
    }
    const std::string before = "exports = [\"c\", \"csv\"]";
    text.replace(text.find(before), before.size(), "exports = [" + formats + "]");
    core::write_file(folder / "study.toml", text);
    run();
    const auto again = run_study(Study::open(folder), options());
    for (const auto& step : again.steps) {
        EXPECT_EQ(step.state, StepState::unchanged) << step.kind << " " << step.name;
    }
}

TEST_F(Why, TheJsonHoldsTheWholeWay) {
    const nlohmann::json json = why("table/lift").origins;
    ASSERT_EQ(json.size(), 7U);
    for (const auto& origin : json) {
        for (const char* key : {"kind", "name", "id", "state", "made", "facts", "options", "code", "files", "from"}) {
            EXPECT_TRUE(origin.contains(key)) << key;
        }
    }
    EXPECT_EQ(json[0]["options"]["fit"], "automatic");
}

TEST_F(Why, AMatExportHasItsFunctionBesideIt) {
    std::string text = core::read_file(folder / "study.toml");
    const std::string formats = "exports = [\"c\", \"csv\"]";
    text.replace(text.find(formats), formats.size(), "exports = [\"mat\", \"c\", \"json\", \"jsbsim\", \"fmu\"]");
    core::write_file(folder / "study.toml", text);
    run();
    const fs::path exports = folder / "report" / "exports";
    EXPECT_THAT(core::read_file(exports / "lift_at.m"), HasSubstr("'lift.mat'"));
    for (const char* file : {"lift.mat", "lift_at.m", "lift.json", "lift.xml", "lift.fmu"}) {
        ASSERT_TRUE(fs::exists(exports / file)) << file;
        EXPECT_EQ(why("exports/" + std::string(file)).origins.front().name, "lift") << file;
    }
    fs::remove(exports / "lift_at.m");
    run();
    EXPECT_TRUE(fs::exists(exports / "lift_at.m")) << "out of the store";
}

}  // namespace
}  // namespace underbody::cases
