// Loads of a shape by the surrogates of a search: a table on the command line, a [[table]] of a study, its exports and
// maps, and what makes them anew.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cases/design.h"
#include "cases/shape_loads.h"
#include "cases/study.h"
#include "core/error.h"
#include "core/file.h"
#include "core/own_files.h"
#include "core/toml.h"
#include "surrogates/tables/analysis/equilibria.h"

namespace {

using namespace underbody;
using namespace underbody::cases;

const std::string design_toml = R"(
[design]
shape = "evie.toml"
points = 12
gap = ["2 mm", "5 mm", "12 mm"]
pitch = ["-1 deg", "1 deg"]
speed = "0.4 m/s"
quantities = ["lift_force", "pitch_moment"]
[[design.vary]]
key = "body.base_cut"
from = 0.6
to = 0.85
[[design.fidelity]]
name = "coarse"
)";

const std::string table_toml = R"(
[[table]]
name = "lift of mine"
quantity = "lift_force"
shape = "mine.toml"
axes = ["gap"]
where = { pitch = "0 deg" }
net_weight = "0.2 N"
virtual_mass = "3.9 kg"
exports = ["csv"]
[[region]]
name = "glide"
model = "model.toml"
forces = ["lift of mine"]
axes = ["gap=3mm:11mm", "heave_velocity=-0.01:0.01"]
columns = 8
rows = 8
for = "20 s"
)";

std::string shape_toml(double cut, double length = 203.2) {
    return "[body]\nlength = \"" + std::to_string(length) +
           " mm\"\nwidth = \"152 mm\"\nheight = \"145 mm\"\nbase_cut = " + std::to_string(cut) + "\n";
}

/// A smooth lift in place of a solver.
double lift(double cut, double gap, double pitch) {
    return 0.2 * std::pow(gap / 5e-3, -0.6) * (1 + 2 * (cut - 0.7)) + pitch;
}

class ShapeLoadsOfAStudy : public testing::Test {
protected:
    ShapeLoadsOfAStudy() {
        write_study(design_toml + table_toml);
        core::write_file(path("evie.toml"), shape_toml(0.75));
        core::write_file(path("mine.toml"), shape_toml(0.713));
        core::write_file(path("model.toml"),
                         "[vehicle]\nmass = \"1 kg\"\nadded_mass_heave = \"2.9 kg\"\nnet_weight = \"0.2 N\"\n"
                         "[drag.heave]\nlinear = \"3 N s/m\"\n[conditions]\nspeed = \"0.4 m/s\"\n");
        Design design = open();
        design.make_plan();
        compute(design, 0);
    }

    [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
    void write_study(const std::string& rest) const {
        core::write_file(path("study.toml"), "title = \"search\"\n[frame]\nsymmetry = \"y\"\n" + rest);
    }
    [[nodiscard]] Design open() const { return Design::open(Study::open(folder_.path())); }
    void compute(const Design& design, double more, const std::string& density = "") const {
        std::string csv =
            "design,body.base_cut [1],gap [mm],pitch [deg],fidelity,lift_force [N],lift_force_sigma [N],pitch_moment "
            "[N "
            "m],pitch_moment_sigma [N m],density [kg/m^3],state\n";
        for (const PlannedDesign& d : design.plan()) {
            for (const double gap : {2.0, 5.0, 12.0}) {
                for (const double pitch : {-1.0, 1.0}) {
                    const double a = pitch * M_PI / 180;
                    csv += d.name + "," + std::to_string(d.at[0]) + "," + std::to_string(gap) + "," +
                           std::to_string(pitch) + ",coarse," + std::to_string(lift(d.at[0], gap / 1e3, a) + more) +
                           ",0.0005," + std::to_string(0.3 * a) + ",0.0001," + density + ",solved\n";
                }
            }
        }
        const core::ReplacingAllowed by_hand;
        core::write_file(path("design/results.csv"), csv);
    }
    [[nodiscard]] StudyResults run() const {
        RunOptions options;
        options.pictures = false;
        return run_study(Study::open(folder_.path()), options);
    }

    core::TemporaryFolder folder_;
};

TEST_F(ShapeLoadsOfAStudy, PointsAreTheSurrogatesOwn) {
    const Design design = open();
    const auto known = learned_loads(design, {});
    ASSERT_EQ(known->surrogates.size(), 2U);
    AskedPoints asked;
    asked.held.set("pitch", 0.5 * M_PI / 180);
    const core::Table points = shape_points(*known, geometry::read_shape(path("mine.toml")), asked);
    ASSERT_GT(points.rows(), 40U);
    EXPECT_THAT(points.numbers("speed"), testing::Each(0.4));
    EXPECT_THAT(points.comments.front(),
                testing::HasSubstr("surrogate over the 12 shapes of the search; not CFD of this one"));
    EXPECT_EQ(points.numbers("gap").front(), 2e-3);
    EXPECT_NEAR(points.numbers("gap").back(), 12e-3, 1e-12);
    for (std::size_t i = 0; i < points.rows(); ++i) {
        const double gap = points.numbers("gap")[i], pitch = points.numbers("pitch")[i];
        const auto p = known->find("lift_force")->at(std::vector<double>{0.713, gap, pitch});
        EXPECT_DOUBLE_EQ(points.numbers("lift_force")[i], p.value);
        EXPECT_DOUBLE_EQ(points.numbers("lift_force_sigma")[i], p.sigma);
        EXPECT_NEAR(p.value, lift(0.713, gap, pitch), 4 * p.sigma);
    }
    asked = {{"lift_force"}, {"gap", "pitch"}, {}};
    const core::Table two = shape_points(*known, geometry::read_shape(path("mine.toml")), asked);
    EXPECT_EQ(two.rows(), 31U * 9U);
    EXPECT_EQ(two.find("pitch_moment"), nullptr);
}

TEST_F(ShapeLoadsOfAStudy, WhatIsNotKnownIsRefusedWithItsReason) {
    const Design design = open();
    const auto known = learned_loads(design, {"lift_force"});
    const auto refusal = [&](const geometry::BodyShape& shape, const AskedPoints& asked) {
        try {
            (void)shape_points(*known, shape, asked);
        } catch (const core::InputError& error) {
            return error.message() + " | " + error.hint();
        }
        return std::string("nothing was refused");
    };
    const auto mine = geometry::read_shape(path("mine.toml"));
    AskedPoints over_gap{{"lift_force"}, {"gap"}, {}};
    EXPECT_THAT(refusal(mine, over_gap), testing::HasSubstr("vary over the pitch, and it is neither an axis nor held"));
    over_gap.held.set("pitch", 0.1);
    EXPECT_THAT(refusal(mine, over_gap), testing::HasSubstr("computes -1 to 1 deg"));
    over_gap.held.set("pitch", 0);
    EXPECT_THAT(refusal(geometry::parse_shape(shape_toml(0.7, 250)), over_gap),
                testing::HasSubstr("body.length is 250 mm, 203.2 mm in the search"));
    over_gap.axes = {"gpa"};
    EXPECT_THAT(refusal(mine, over_gap), testing::HasSubstr("gap"));
    over_gap.axes = {"gap"};
    over_gap.quantities = {"drag_force"};
    EXPECT_THAT(refusal(mine, over_gap), testing::HasSubstr("does not compute drag_force"));
}

/// The table of a study, its equilibria, its export and the map that rests on it say the same, of the same surrogate.
TEST_F(ShapeLoadsOfAStudy, AStudyTakesItAsATable) {
    const StudyResults results = run();
    for (const auto& step : results.steps) {
        EXPECT_EQ(step.error, "") << step.kind << " " << step.name;
    }
    const TableResult* table = find_result(results.tables, "lift of mine");
    ASSERT_NE(table, nullptr);
    EXPECT_THAT(table->remarks, testing::Contains(testing::HasSubstr("not CFD of this one")));
    ASSERT_EQ(table->equilibria.size(), 1U);
    // 0.2 (gap/5 mm)^-0.6 (1 + 2 (0.713 - 0.7)) = 0.2
    const double exact = 5e-3 * std::pow(1 + 2 * 0.013, 1 / 0.6);
    EXPECT_NEAR(table->equilibria[0].gap, exact, 3 * table->equilibria[0].sigma);
    EXPECT_LT(table->equilibria[0].sigma, 0.3e-3);

    const RegionResult* map = find_result(results.regions, "glide");
    ASSERT_NE(map, nullptr);
    ASSERT_FALSE(map->ends.empty());
    double attractor = 0;
    for (const auto& end : map->ends) {
        attractor = end.kind == "attractor" ? end.gap : attractor;
    }
    EXPECT_NEAR(attractor, table->equilibria[0].gap, 1e-6);

    const auto exported = tables::ForceTable::read(path("report/exports/lift_of_mine.csv"), "lift_force");
    tables::EquilibriumOptions options;
    options.net_weight = 0.2;
    const auto again = tables::equilibria(exported, options);
    ASSERT_EQ(again.all.size(), 1U);
    EXPECT_NEAR(again.all[0].gap, table->equilibria[0].gap, 1e-9);
}

/// A shape, a result of the search and [design] are what the table rests on; its picture is not.
TEST_F(ShapeLoadsOfAStudy, WhatItRestsOnMakesItAnew) {
    (void)run();
    EXPECT_EQ(run().computed, 0U);
    const auto gap = [](const StudyResults& results) {
        return find_result(results.tables, "lift of mine")->equilibria[0].gap;
    };
    const double before = gap(run());

    core::write_file(path("mine.toml"), shape_toml(0.8));
    StudyResults results = run();
    EXPECT_GT(gap(results), before);
    EXPECT_GE(results.computed, 3U);

    core::write_file(path("mine.toml"), shape_toml(0.713));
    results = run();
    EXPECT_EQ(gap(results), before);

    compute(open(), 0.01);
    results = run();
    EXPECT_GT(gap(results), before);
    compute(open(), 0);

    std::string text = design_toml;
    text.replace(text.find("from = 0.6"), 10, "from = 0.5");
    write_study(text + table_toml);
    results = run();
    EXPECT_GE(results.computed, 1U);
    EXPECT_NEAR(gap(results), before, 0.2e-3);
}

/// What tells the rows of a search from those of something else is a part of it: other water, no row counts.
TEST_F(ShapeLoadsOfAStudy, OtherWaterAndAnotherFolderMakeItAnew) {
    write_study("[reference]\ndensity = \"998 kg/m^3\"\n" + design_toml + table_toml);
    compute(open(), 0, "998");  // rows that say their water
    EXPECT_EQ(run().tables.size(), 1U);
    EXPECT_EQ(run().computed, 0U);
    write_study("[reference]\ndensity = \"1025 kg/m^3\"\n" + design_toml + table_toml);
    EXPECT_TRUE(run().tables.empty()) << "all rows are of other water";
    write_study("[reference]\ndensity = \"998 kg/m^3\"\n" + design_toml + table_toml);
    EXPECT_EQ(run().computed, 0U);
    std::string other = design_toml;
    other.replace(other.find("shape = "), 0, "folder = \"elsewhere\"\n");
    write_study("[reference]\ndensity = \"998 kg/m^3\"\n" + other + table_toml);
    EXPECT_TRUE(run().tables.empty()) << "nothing was computed there";
}

TEST_F(ShapeLoadsOfAStudy, AShapeThatIsNotThereFailsItsStepAlone) {
    std::filesystem::remove(path("mine.toml"));
    const StudyResults results = run();
    const auto& steps = results.steps;
    EXPECT_TRUE(std::any_of(steps.begin(), steps.end(), [](const StepResult& step) {
        return step.kind == "shape loads" && step.error.find("mine.toml") != std::string::npos;
    }));
    EXPECT_TRUE(results.tables.empty());
}

TEST_F(ShapeLoadsOfAStudy, WrongTablesAreRefusedWithTheirPlace) {
    const auto refusal = [&](const std::string& from, const std::string& to, bool with_design = true) {
        std::string text = table_toml;
        if (!from.empty()) {
            text.replace(text.find(from), from.size(), to);
        }
        write_study((with_design ? design_toml : "") + text);
        try {
            (void)Study::open(folder_.path());
        } catch (const core::InputError& error) {
            return error.message() + " | " + error.hint();
        }
        return std::string("nothing was refused");
    };
    EXPECT_THAT(refusal("", "", false), testing::HasSubstr("the study has no [design]"));
    EXPECT_THAT(refusal("axes = [\"gap\"]", "axes = [\"speed\"]"), testing::HasSubstr("takes no several values"));
    EXPECT_THAT(refusal("where = { pitch = \"0 deg\" }\n", ""), testing::HasSubstr("neither an axis nor held"));
    EXPECT_THAT(refusal("pitch = \"0 deg\"", "pitch = \"3 deg\""), testing::HasSubstr("computes -1 to 1 deg"));
    EXPECT_THAT(refusal("pitch = \"0 deg\"", "variant = \"a\""), testing::HasSubstr("variant is no condition"));
    EXPECT_THAT(refusal("\"lift_force\"", "\"drag_force\""), testing::HasSubstr("does not compute drag_force"));
    EXPECT_THAT(refusal("net_weight", "mesh_uncertainty = \"x\"\nnet_weight"),
                testing::HasSubstr("errors are the surrogate's"));
}

}  // namespace
