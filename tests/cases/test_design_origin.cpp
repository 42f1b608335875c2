// Of which conditions, shape and water the rows of results.csv are: those of others are not learned from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cases/design.h"
#include "cases/design_origin.h"
#include "cases/sweep_parts.h"
#include "core/error.h"
#include "core/file.h"
#include "core/own_files.h"
#include "core/text.h"

namespace underbody::cases {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* search_toml = R"(
title = "search"
[frame]
symmetry = "y"
[reference]
density = "998 kg/m^3"
[design]
shape = "evie.toml"
points = 8
gap = ["5 mm"]
quantities = ["lift_force"]
kinematic_viscosity = "1e-6 m^2/s"
[[design.vary]]
key = "body.base_cut"
from = 0.6
to = 0.85
[[design.fidelity]]
name = "draft"
[[design.objective]]
quantity = "lift_force"
sense = "maximise"
)";
constexpr const char* shape_toml =
    "[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 mm\"\nbase_cut = 0.75\n";

class OriginsOfRows : public testing::Test {
protected:
    /// Results as 0.1.0 wrote them: with a single gap and speed they have no column of either.
    void SetUp() override {
        core::write_file(folder_.path() / "study.toml", search_toml);
        core::write_file(folder_.path() / "evie.toml", shape_toml);
        Design design = open();
        design.make_plan();
        std::string csv = "design, body.base_cut [1], fidelity, lift_force [N], lift_force_sigma [N], state\n";
        for (const PlannedDesign& d : design.plan()) {
            csv += d.name + ", " + std::to_string(d.at[0]) + ", draft, " + std::to_string(2 * d.at[0] - 1) +
                   ", 0.001, solved\n";
            // The case that it was read from, as far as its record goes.
            const fs::path run = runs() / (d.name + "-h5-p0-u0.5");
            fs::create_directories(run);
            core::write_file(run / solved_marker, "{\"walls\": [\"base\"]}");
            write_record(run, asked_for(design.spec(), geometry::read_shape(folder_.path() / "evie.toml"),
                                        {998.0, true}, {d.at[0]}, "draft"));
        }
        core::write_file(results(), csv);
    }

    [[nodiscard]] Design open() const { return Design::open(Study::open(folder_.path())); }
    [[nodiscard]] fs::path results() const { return folder_.path() / "design" / "results.csv"; }
    [[nodiscard]] fs::path runs() const { return folder_.path() / "design" / "runs" / "draft"; }
    void put(const std::string& file, const std::string& from, const std::string& to) const {
        std::string text = core::read_file(folder_.path() / file);
        ASSERT_NE(text.find(from), std::string::npos) << from;
        text.replace(text.find(from), from.size(), to);
        core::write_file(folder_.path() / file, text);
    }
    static std::size_t usable(const Design& design) {
        return static_cast<std::size_t>(std::count_if(design.runs().begin(), design.runs().end(),
                                                      [](const DesignRun& run) { return run.usable(); }));
    }
    /// What is said of rows that are left out, and that none of them is learned from.
    static std::string said(const Design& design) {
        EXPECT_EQ(usable(design), 0u);
        EXPECT_THROW((void)design.surrogates(), core::InputError);
        EXPECT_EQ(design.known().failed.size() + design.known().solved.size(), 0u) << "nothing failed";
        EXPECT_EQ(design.known().planned.size(), 8u) << "all are to be run";
        EXPECT_FALSE(design.notes.empty());
        return design.notes.empty() ? "" : design.notes.front().message;
    }

    core::TemporaryFolder folder_;
};

TEST_F(OriginsOfRows, RowsOfOtherConditionsAreLeftOutByTheRunsThatAreThere) {
    EXPECT_EQ(usable(open()), 8u);
    EXPECT_TRUE(open().notes.empty()) << open().notes.front().message;
    EXPECT_EQ(open().surrogates().at("lift_force").check().points, 8u);
    const std::string shape = open().results_table().text("shape_hash").front();
    struct Change {
        const char *file, *from, *to, *said;
    };
    for (const Change& change :
         {Change{"study.toml", "points = 8", "points = 8\nspeed = \"1 m/s\"", "speed: 0.5 m/s there, 1 m/s now"},
          Change{"study.toml", "gap = [\"5 mm\"]", "gap = [\"20 mm\"]", "gap: 5 mm there, 20 mm now"},
          Change{"study.toml", "\"1e-6 m^2/s\"", "\"1.3e-6 m^2/s\"",
                 "kinematic_viscosity: 1e-06 m^2/s there, 1.3e-06 m^2/s now"},
          Change{"study.toml", "998 kg", "1025 kg", "density: 998 kg/m^3 there, 1025 kg/m^3 now"},
          Change{"study.toml", "name = \"draft\"", "name = \"draft\"\nmesh_density = \"coarse\"",
                 "mesh density: draft there, coarse now"},
          Change{"evie.toml", "203.2 mm", "300 mm", "body.length: 0.2032 m there, 0.3 m now"}}) {
        SCOPED_TRACE(change.said);
        const std::string before = core::read_file(folder_.path() / change.file);
        put(change.file, change.from, change.to);
        EXPECT_THAT(said(open()), HasSubstr(std::string("8 of 8 rows are of something else than [design] asks for "
                                                        "now, and left out: 8 (") +
                                            change.said));
        // What a row is of is written with it, whatever is asked for now.
        EXPECT_EQ(open().results_table().text("shape_hash").front(), shape);
        core::write_file(folder_.path() / change.file, before);
    }
    EXPECT_EQ(usable(open()), 8u);
}

TEST_F(OriginsOfRows, RowsSayOfThemselvesWhatTheyAreOf) {
    const core::Table table = open().results_table();
    EXPECT_DOUBLE_EQ(table.numbers("speed").front(), 0.5);
    EXPECT_DOUBLE_EQ(table.numbers("gap").front(), 5e-3);
    EXPECT_DOUBLE_EQ(table.numbers("density").front(), 998);
    EXPECT_EQ(table.text("shape_hash").front().size(), 12u);
    EXPECT_EQ(table.text("mesh_settings").front(), "blocks draft 800 iterations");
    core::write_csv(results(), table);
    fs::remove_all(folder_.path() / "design" / "runs");  // handed on without its fields
    EXPECT_EQ(usable(open()), 8u);
    EXPECT_TRUE(open().notes.empty());
    put("evie.toml", "203.2 mm", "300 mm");
    EXPECT_THAT(said(open()), HasSubstr("another shape"));
    put("evie.toml", "300 mm", "0.2032 m");
    put("study.toml", "name = \"draft\"", "name = \"draft\"\nmesh_density = \"coarse\"");
    EXPECT_THAT(said(open()), HasSubstr("mesh: blocks draft 800 iterations there, blocks coarse 800 iterations now"));
    put("study.toml", "\nmesh_density = \"coarse\"", "");
    put("study.toml", "points = 8", "points = 8\nspeed = \"1 m/s\"");
    EXPECT_THAT(said(open()), HasSubstr("speed: 0.5 m/s there, 1 m/s now"));
    // Where the condition varies, they are points of their own.
    put("study.toml", "speed = \"1 m/s\"", "speed = [\"0.5 m/s\", \"1 m/s\"]");
    put("study.toml", "sense = \"maximise\"", "sense = \"maximise\"\nat = { speed = \"1 m/s\" }");
    const Design both = open();
    EXPECT_EQ(usable(both), 8u);
    EXPECT_DOUBLE_EQ(both.runs().front().at.back(), 0.5);
}

// The point is no part of a case: its loads are taken about another one without solving it again.
TEST_F(OriginsOfRows, RowsSayAboutWhichPointTheirMomentsAre) {
    EXPECT_EQ(open().results_table().find("moments_about"), nullptr) << "it has no moment";
    put("study.toml", "[\"lift_force\"]", "[\"lift_force\", \"pitch_moment\"]");
    const std::string lift_only = core::read_file(results());
    std::string csv;
    for (const auto line : core::split(lift_only, '\n')) {
        if (const auto state = line.rfind(", "); state != std::string_view::npos) {
            csv += std::string(line.substr(0, state)) +
                   (csv.empty() ? ", pitch_moment [N m], pitch_moment_sigma [N m]" : ", 0.01, 0.001") +
                   std::string(line.substr(state)) + "\n";
        }
    }
    core::write_file(results(), csv);
    ASSERT_EQ(open().notes.size(), 1u) << "rows of earlier versions count";
    EXPECT_EQ(usable(open()), 8u);
    EXPECT_EQ(open().notes.front().severity, core::Problem::Severity::note);
    EXPECT_THAT(open().notes.front().message, HasSubstr("rows do not say all of moments_about: taken as what"));
    const core::Table silent = open().results_table();
    core::Table table;
    for (const core::Column& column : silent.columns()) {
        if (column.is_text()) {
            table.add_text(column.name,
                           column.name == "moments_about" ? std::vector<std::string>(8, "base_centre") : column.text);
        } else {
            table.add_numbers(column.name, column.unit, column.numbers, column.written_unit);
        }
    }
    core::write_csv(results(), table);
    EXPECT_EQ(usable(open()), 8u);
    EXPECT_TRUE(open().notes.empty());
    put("study.toml", "[frame]\n", "[frame]\nmoments_about = [\"0 m\", \"0 m\", \"5 mm\"]\n");
    EXPECT_THAT(said(open()), HasSubstr("left out: 8 (moments_about: base_centre there, 0 0 0.005 m now)"));
    EXPECT_EQ(open().results_table().text("moments_about").front(), "base_centre") << "rows stay what they are of";
    std::string of_point = core::read_file(results());
    for (auto at = of_point.find("base_centre"); at != std::string::npos; at = of_point.find("base_centre")) {
        of_point.replace(at, 11, "0 0 0.005 m");
    }
    core::write_file(results(), of_point);
    EXPECT_EQ(usable(open()), 8u);
    put("study.toml", "\"5 mm\"]\nsymmetry", "\"0.5 cm\"]\nsymmetry");
    EXPECT_EQ(usable(open()), 8u) << "the same in another unit";
    put("study.toml", "\"0.5 cm\"]\nsymmetry", "\"6 mm\"]\nsymmetry");
    EXPECT_EQ(usable(open()), 0u);
    put("study.toml", ", \"pitch_moment\"]", "]");
    EXPECT_EQ(usable(open()), 8u) << "a force has no such point";
}

TEST_F(OriginsOfRows, AConditionThatComesToVaryIsSaidByTheRuns) {
    put("study.toml", "gap = [\"5 mm\"]", "gap = [\"5 mm\", \"20 mm\"]");
    put("study.toml", "sense = \"maximise\"", "sense = \"maximise\"\nat = { gap = \"5 mm\" }");
    const Design design = open();
    EXPECT_EQ(usable(design), 8u);
    EXPECT_NEAR(design.runs().front().at.back(), 5e-3, 1e-12);
    fs::remove_all(folder_.path() / "design" / "runs");
    EXPECT_THROW((void)open(), core::InputError) << "no column gap";
}

TEST_F(OriginsOfRows, RowsThatSayNothingAreTakenAndThatIsSaid) {
    fs::remove_all(folder_.path() / "design" / "runs");
    const Design design = open();
    EXPECT_EQ(usable(design), 8u);
    ASSERT_EQ(design.notes.size(), 1u);
    EXPECT_EQ(design.notes.front().severity, core::Problem::Severity::note);
    EXPECT_THAT(design.notes.front().message,
                HasSubstr("8 of 8 rows do not say all of gap, pitch, speed, density, kinematic_viscosity, "
                          "shape_hash and mesh_settings: taken as what [design] asks for now"));
}

/// A folder that was copied has lost what says whose its files are.
TEST_F(OriginsOfRows, AShapeFileThatCannotFollowIsNamedAndItsDesignStaysPlanned) {
    const fs::path shape = folder_.path() / "design" / "shapes" / "design-001.toml";
    const std::string text = core::read_file(shape);
    fs::remove(shape);
    std::ofstream(shape) << text;
    put("evie.toml", "203.2 mm", "300 mm");
    Design design = open();
    core::protect_other_files(true);
    try {
        design.add({}, "typed");
        ADD_FAILURE() << "the file was replaced";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("design-001.toml"));
        EXPECT_THAT(error.what(), HasSubstr("the shape of this design is another one now"));
        EXPECT_THAT(error.hint(), HasSubstr("its files are made anew"));
    }
    core::protect_other_files(false);
    EXPECT_EQ(open().plan().front().state, "planned");
}

/// So has the record of a case, which another version of the program confirms.
TEST_F(OriginsOfRows, TheRecordOfACopiedCaseIsWrittenAgain) {
    const fs::path run = runs() / "design-001-h5-p0-u0.5", file = run / record_file;
    const std::string text = core::read_file(file);
    CaseRecord record = read_record(run).value();
    record.code = "another";
    fs::remove(file);
    std::ofstream(file) << text;
    core::protect_other_files(true);
    EXPECT_NO_THROW(write_record(run, record));
    core::protect_other_files(false);
    EXPECT_EQ(read_record(run)->code, "another");
}

}  // namespace
}  // namespace underbody::cases
