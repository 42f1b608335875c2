// [design]: plan, results, surrogates, the next case and the best, through the files that they stand in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cases/design.h"
#include "cases/shape_loads.h"
#include "core/error.h"
#include "core/file.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/search/limits_alone.h"
#include "tests/cases/design_files.h"

namespace {

using namespace underbody;
using namespace underbody::cases;
using namespace underbody::cases::design_search;
namespace fs = std::filesystem;

TEST_F(DesignFiles, APlanIsWrittenOnceAndGoesOn) {
    Design design = open();
    EXPECT_EQ(design.make_plan(), 16u);
    EXPECT_EQ(open().plan().size(), 16u);
    EXPECT_EQ(open().make_plan(), 0u);
    const geometry::BodyShape shape = geometry::read_shape(folder_.path() / "design/shapes/design-001.toml");
    const PlannedDesign first = open().plan().front();
    EXPECT_NEAR(shape.protrusion->height, first.at[0], 1e-9);
    EXPECT_NEAR(shape.protrusion->length, 12 * first.at[0], 1e-8);  // tied
    const Design planned = open();                                  // lives as long as the loop
    for (const PlannedDesign& d : planned.plan()) {
        EXPECT_EQ(d.state, "planned") << d.name;
    }
    // More points later: those that are there stay.
    std::string text = design_toml;
    text.replace(text.find("points = 16"), 11, "points = 20");
    core::write_file(folder_.path() / "study.toml", text);
    Design more = open();
    EXPECT_EQ(more.make_plan(), 4u);
    for (std::size_t i = 0; i < 16; ++i) {
        EXPECT_NEAR(more.plan()[i].at[1], design.plan()[i].at[1], 1e-9);
    }
}

TEST_F(DesignFiles, ResultsOfAnySolverAreLearned) {
    Design design = open();
    design.make_plan();
    compute(design);
    const Design known = open();
    EXPECT_EQ(known.runs().size(), 96u);
    const auto surrogates = known.surrogates();
    const auto& surrogate = surrogates.at("lift_force");
    EXPECT_EQ(surrogate.check().shapes, 16u);
    EXPECT_LT(surrogate.check().root_mean_square, 0.5 * surrogate.check().nearest_shape);
    const std::vector<double> x = {1.7e-3, 0.7, 4e-3, 0.005};
    const auto p = surrogate.at(x);
    EXPECT_NEAR(p.value, lift(x[0], x[1], x[2], x[3]), std::max(0.005, 3 * p.sigma));

    const auto search = known.search(surrogates);
    const auto best = search.optimum(0, 1);
    ASSERT_TRUE(best);
    EXPECT_NEAR(best->at[0], highest(known, best->at[1]), 2e-5);  // the highest ridge that clears the ground
    EXPECT_NEAR(best->at[1], 0.72, 0.03);                         // the cut in the middle
    const auto front = search.pareto_front(8, 1, 1);
    EXPECT_GE(front.size(), 1u);
    const auto next = search.next_designs(known.known());
    ASSERT_EQ(next.size(), 1u);
    EXPECT_GT(next.front().at[0], 2e-3);

    Design grown = open();
    grown.add(next, "expected improvement");
    EXPECT_EQ(open().plan().size(), 17u);
    EXPECT_EQ(open().plan().back().why, "expected improvement");
    EXPECT_TRUE(fs::exists(folder_.path() / "design/shapes/design-017.toml"));

    const auto indices = known.sensitivity(surrogate);
    EXPECT_GT(indices.total[2].value, indices.total[3].value);  // the gap says more than a degree of pitch
    const std::string report = design_report(known, {});
    EXPECT_THAT(report, testing::HasSubstr("How surrogates do on shapes they have not seen"));
    EXPECT_THAT(report, testing::HasSubstr("It is a prediction"));
}

TEST_F(DesignFiles, AFailedRunIsKeptAsFailed) {
    Design design = open();
    design.make_plan();
    compute(design, true);
    const Design known = open();
    const auto options = known.known();
    EXPECT_EQ(options.solved.size(), 15u);
    EXPECT_EQ(options.failed.size(), 1u);
    EXPECT_EQ(known.surrogates().at("lift_force").check().shapes, 15u);
}

TEST_F(DesignFiles, WhatIsPlannedIsNotProposedAgain) {
    const std::string text = design_toml;
    core::write_file(folder_.path() / "study.toml",
                     text.substr(0, text.find("[design.volume]")));  // costs a volume each
    Design design = open();
    design.make_plan();
    compute(design);
    std::vector<std::vector<double>> proposed;
    for (std::size_t times = 0; times < 2; ++times) {
        Design known = open();
        EXPECT_EQ(known.known().planned.size(), 2 * times);
        const auto search = known.search(known.surrogates());
        auto options = known.known();
        options.count = 2;
        const auto next = search.next_designs(options);
        ASSERT_EQ(next.size(), 2u);
        for (const auto& c : next) {
            for (const auto& other : proposed) {
                EXPECT_GT(std::abs(c.at[0] - other[0]) / 2.5e-3 + std::abs(c.at[1] - other[1]) / 0.25, 0.0099);
            }
            proposed.push_back(c.at);
        }
        known.add(next, "expected improvement");
    }
    EXPECT_EQ(open().plan().size(), 20u);
}

TEST_F(DesignFiles, AnUnknownStandardDeviationStaysUnknown) {
    Design design = open();
    design.make_plan();
    compute(design);
    const fs::path file = folder_.path() / "design" / "results.csv";
    std::string text = core::read_file(file);
    const std::string stated = "," + core::format_number(0.0005) + ",";
    const std::size_t first = text.find(stated);
    ASSERT_NE(first, std::string::npos);
    text.insert(first + 1, "-");
    core::write_file(file, text);
    try {
        (void)open();
        FAIL() << "a negative standard deviation";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("results.csv:2"));
        EXPECT_THAT(error.what(), testing::HasSubstr("-0.0005: below nought"));
    }
    text.replace(first, stated.size() + 1, ",,");
    core::write_file(file, text);
    const Design known = open();
    EXPECT_FALSE(known.runs().front().sigmas.contains("lift_force"));
    EXPECT_TRUE(known.runs().back().sigmas.contains("lift_force"));
    EXPECT_TRUE(std::isnan(known.results_table().numbers("lift_force_sigma").front())) << "not zero";
    ASSERT_EQ(known.notes.size(), 2u) << "the other: rows do not say of which shape they are";
    EXPECT_THAT(known.notes.front().message,
                testing::HasSubstr("lift_force: of 1 run the standard deviation is unknown"));
    EXPECT_EQ(known.surrogates().at("lift_force").check().points, 96u);
    // Nobody states one at all.
    text.erase(text.find(",lift_force_sigma [N]"), 21);
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1)) {
        std::size_t comma = at + 1;
        for (int column = 0; column < 7 && comma < text.size(); ++column) {
            comma = text.find(',', comma) + 1;
        }
        if (comma < text.size()) {
            text.erase(comma, text.find(',', comma) + 1 - comma);
        }
    }
    core::write_file(file, text);
    const Design none = open();
    EXPECT_THAT(none.notes.front().message, testing::HasSubstr("estimated"));
    EXPECT_EQ(none.surrogates().at("lift_force").check().points, 96u);
}

/// A run that stands twice counts once, and it is said which.
TEST_F(DesignFiles, ARunThatStandsTwiceCountsOnce) {
    Design design = open();
    design.make_plan();
    compute(design);
    const fs::path file = folder_.path() / "design" / "results.csv";
    const std::string whole = core::read_file(file);
    const std::size_t begin = whole.find('\n') + 1, end = whole.find('\n', begin) + 1;
    const std::string first = whole.substr(begin, end - begin);
    const auto read_with = [&](const std::string& row) {
        core::write_file(file, whole + row);
        return open();
    };
    const auto counted = [&](const Design& one) { return one.surrogates().at("lift_force").check().points; };
    EXPECT_EQ(counted(read_with("")), 96u);
    const Design copied = read_with(first);
    EXPECT_EQ(counted(copied), 96u);
    ASSERT_EQ(copied.notes.size(), 2u);
    EXPECT_THAT(copied.notes.front().message,
                testing::HasSubstr("rows 1 and 97 are of the same case (design-001): it counts once"));
    EXPECT_THAT(copied.notes.front().place.text(), testing::HasSubstr("results.csv:98"));
    std::string other_name = first;
    other_name.replace(0, other_name.find(','), "typed");
    EXPECT_EQ(counted(read_with(other_name)), 96u) << "the same loads under another name";
    std::string again = first;  // computed again, with another lift
    std::size_t lift_at = 0;
    for (int column = 0; column < 6; ++column) {
        lift_at = again.find(',', lift_at) + 1;
    }
    again.replace(lift_at, again.find(',', lift_at) - lift_at, "0.5");
    const Design changed = read_with(again);
    EXPECT_EQ(counted(changed), 96u);
    EXPECT_TRUE(changed.runs().front().repeated);
    EXPECT_FALSE(changed.runs().back().repeated);
    EXPECT_THAT(changed.notes.front().message, testing::HasSubstr("the last counts, their loads differ"));
    EXPECT_EQ(changed.results_table().rows(), 97u) << "what somebody wrote stays";
}

TEST_F(DesignFiles, APlannedDesignStandsOnce) {
    Design design = open();
    design.make_plan();
    const fs::path file = folder_.path() / "design" / "plan.csv";
    std::string text = core::read_file(file);
    text.replace(text.find("design-002"), 10, "design-001");
    core::write_file(file, text);
    try {
        (void)open();
        FAIL() << "two designs of one name";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("plan.csv:3"));
        EXPECT_THAT(error.what(), testing::HasSubstr("the design design-001 stands twice"));
    }
}

/// plan.csv and results.csv are written by people, too: with --force or without.
TEST_F(DesignFiles, FilesOfPeopleAreWrittenOnAsTheyAreRead) {
    Design design = open();
    design.make_plan();
    const fs::path plan = folder_.path() / "design" / "plan.csv";
    std::string text = core::read_file(plan), typed = "# ours\n";
    std::size_t line = 0;
    for (std::size_t at = 0, end = 0; (end = text.find('\n', at)) != std::string::npos; at = end + 1, ++line) {
        typed += text.substr(at, end - at) + (line == 0 ? ",remark,price [N]\n" : ",good,1.5\n");
    }
    typed += "by hand,2,0.7,coarse,typed,planned,perhaps,2.5\n";
    fs::remove(plan);
    std::ofstream(plan) << typed;
    core::protect_other_files(true);
    std::string toml = design_toml;
    toml.replace(toml.find("points = 16"), 11, "points = 18");
    fs::remove(folder_.path() / "study.toml");
    std::ofstream(folder_.path() / "study.toml") << toml;
    Design more = open();
    EXPECT_EQ(more.make_plan(), 2u);
    // Changed by somebody while a command is under way: left as it is.
    const std::string after = core::read_file(plan);
    std::ofstream(plan, std::ios::app) << "late,2.5,0.7,coarse,typed,planned,,\n";
    EXPECT_THROW(more.add({}, "expected improvement"), core::InputError);
    EXPECT_THAT(core::read_file(plan), testing::HasSubstr("late"));
    core::protect_other_files(false);
    const core::Table table = core::read_csv(after, "plan.csv");
    EXPECT_EQ(table.comments, std::vector<std::string>{"ours"});
    ASSERT_EQ(table.rows(), 19u);
    EXPECT_EQ(table.text("remark")[16], "perhaps");
    EXPECT_EQ(table.text("remark")[17], "");
    EXPECT_DOUBLE_EQ(table.numbers("price")[0], 1.5);
    EXPECT_TRUE(fs::exists(folder_.path() / "design/shapes/by hand.toml"));
}

TEST_F(DesignFiles, RowsAreAddedToTheFileThatIsThere) {
    DesignTable file;
    const auto rows = [](double from, std::size_t count) {
        core::Table table;
        std::vector<double> numbers;
        for (std::size_t i = 0; i < count; ++i) {
            numbers.push_back(from + static_cast<double>(i));
        }
        table.add_text("design", std::vector<std::string>(count, "a"));
        table.add_numbers("gap", "m", numbers, "mm");
        return table;
    };
    const fs::path path = folder_.path() / "rows.csv";
    EXPECT_FALSE(file.ours());
    file.write(path, rows(0, 2));
    EXPECT_TRUE(file.ours());
    fs::create_hard_link(path, folder_.path() / "the same file");
    for (int i = 2; i < 50; ++i) {
        file.append(rows(i, 1));
    }
    EXPECT_TRUE(fs::equivalent(path, folder_.path() / "the same file")) << "a row costs a row, not the whole file";
    EXPECT_EQ(core::read_file(path), core::write_csv(rows(0, 50)));
    EXPECT_TRUE(core::may_replace(path)) << "it is still the program's own";
    std::ofstream(path, std::ios::app) << "b,1\n";
    EXPECT_THROW(file.append(rows(50, 1)), core::InputError);
    EXPECT_EQ(core::read_csv(path).rows(), 51u);
}

/// Seven variables: a plan cannot fill them, and the search keeps to a box about the best.
TEST_F(DesignFiles, ASearchInManyVariablesKeepsToItsTrustRegion) {
    core::write_file(folder_.path() / "study.toml", R"(
title = "many"
[design]
shape = "evie.toml"
points = 20
quantities = ["lift_force"]
vary = [{ key = "body.length", from = "190 mm", to = "220 mm" },
        { key = "body.width", from = "140 mm", to = "160 mm" },
        { key = "body.height", from = "140 mm", to = "150 mm" },
        { key = "body.base_cut", from = 0.7, to = 0.8 },
        { key = "body.taper", from = -0.1, to = 0.1 },
        { key = "body.base_pitch", from = "-1 deg", to = "1 deg" },
        { key = "body.base_offset", from = "-10 mm", to = "10 mm" }]
fidelity = [{ name = "draft" }]
objective = [{ quantity = "lift_force", sense = "minimise" }]
)");
    core::write_file(folder_.path() / "evie.toml",
                     "[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 mm\"\nbase_cut = 0.75\n");
    const auto put_results = [&] {
        const Design design = open();
        std::string csv = "design";
        for (const auto& v : design.spec().variables) {
            csv += "," + v.name + " [" + v.unit + "]";
        }
        csv += ",fidelity,lift_force [N],lift_force_sigma [N],state\n";
        for (const PlannedDesign& d : design.plan()) {
            double lift = 1;
            csv += d.name;
            for (std::size_t v = 0; v < d.at.size(); ++v) {
                lift += std::pow(design.spec().variables[v].scaled(d.at[v]) - 0.5, 2);
                csv += "," + std::to_string(d.at[v]);
            }
            csv += ",draft," + std::to_string(lift) + ",0.0001,solved\n";
        }
        fs::remove(folder_.path() / "design" / "results.csv");
        core::write_file(folder_.path() / "design" / "results.csv", csv);
    };
    Design design = open();
    design.make_plan();
    put_results();
    const auto region = [&] {
        const Design known = open();
        return known.trust_region(known.search(known.surrogates()));
    };
    ASSERT_TRUE(region());
    EXPECT_DOUBLE_EQ(region()->length, 0.8) << "nothing was chosen by the search yet";
    // Seven designs far from the best, one after the other: half the box.
    for (int i = 0; i < 7; ++i) {
        Design known = open();
        tables::Candidate bad;
        for (std::size_t v = 0; v < 7; ++v) {
            bad.at.push_back(known.spec().variables[v].unscaled((i >> (v % 3) & 1) != 0 ? 0.98 : 0.02));
        }
        bad.at[6] = known.spec().variables[6].unscaled(0.1 + 0.1 * i);
        known.add({bad}, "expected improvement");
    }
    put_results();
    EXPECT_DOUBLE_EQ(region()->length, 0.4);
    const Design known = open();
    const auto search = known.search(known.surrogates());
    auto options = known.known();
    options.count = 2;
    options.region = known.trust_region(search);
    std::vector<double> best;
    for (const auto& x : options.solved) {
        if (best.empty() || search.best_of({x}) < search.best_of({best})) {
            best = x;
        }
    }
    for (const auto& c : search.next_designs(options)) {
        for (std::size_t v = 0; v < 7; ++v) {
            const auto& variable = known.spec().variables[v];
            EXPECT_LE(std::abs(variable.scaled(c.at[v]) - variable.scaled(best[v])), 0.2 + 1e-9) << variable.name;
        }
    }
}

TEST_F(DesignFiles, TheWaterIsTheStudys) {
    EXPECT_DOUBLE_EQ(open().spec().kinematic_viscosity, 1e-6);
    std::string text = design_toml;
    text.replace(text.find("points = 16"), 11, "kinematic_viscosity = \"1.3e-6 m^2/s\"");
    core::write_file(folder_.path() / "study.toml", text);
    EXPECT_DOUBLE_EQ(open().spec().kinematic_viscosity, 1.3e-6);
    text.replace(text.find("1.3e-6"), 6, "0");
    core::write_file(folder_.path() / "study.toml", text);
    EXPECT_THROW((void)open(), core::InputError);
}

TEST_F(DesignFiles, WrongDesignsAreRefusedWithTheirPlace) {
    const auto refused = [&](const std::string& from, const std::string& to) {
        std::string text = design_toml;
        text.replace(text.find(from), from.size(), to);
        core::write_file(folder_.path() / "study.toml", text);
        try {
            (void)open();
        } catch (const core::InputError& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("study.toml")) << error.what();
            return std::string(error.what());
        }
        return std::string("taken");
    };
    EXPECT_THAT(refused("protrusion.height\"\nfrom", "protrusion.hight\"\nfrom"),
                testing::HasSubstr("protrusion.height"));
    EXPECT_THAT(refused("to = \"3 mm\"", "to = \"0.1 mm\""),
                testing::HasSubstr("from is 0.5 mm, not below to, 0.1 mm: the range is empty"));
    EXPECT_THAT(refused("key = \"body.base_cut\"", "key = \"pitch\""), testing::HasSubstr("pitch = [...] in [design]"));
    EXPECT_THAT(refused("quantity = \"lift_force\"", "quantity = \"lift_forc\""), testing::HasSubstr("lift_force"));
    EXPECT_THAT(refused("at = { gap = \"5 mm\", pitch = 0 }", "at = { pitch = 0 }"), testing::HasSubstr("gap"));
    EXPECT_THAT(refused("slope_along = \"pitch\"", "slope_along = \"speed\""), testing::HasSubstr("speed"));
    EXPECT_THAT(refused("sense = \"maximise\"", "sense = \"maximize\""), testing::HasSubstr("maximise"));
    EXPECT_THAT(refused("name = \"medium\"", "name = \"coarse\""), testing::HasSubstr("two fidelities"));
    EXPECT_THAT(refused("key = \"body.base_cut\"", "key = \"protrusion.height\""), testing::HasSubstr("varies twice"));
    EXPECT_THAT(refused("key = \"body.base_cut\"", "key = \"body.base\""),
                testing::HasSubstr("a choice, not a number"));
    EXPECT_THAT(refused("key = \"protrusion.length\"\nof = \"protrusion.height\"",
                        "key = \"body.base_cut\"\nof = \"body.taper\""),
                testing::HasSubstr("varies by itself"));
    EXPECT_THAT(refused("name = \"stiffness\"", "name = \"lift\""), testing::HasSubstr("two objectives 'lift'"));
    EXPECT_THAT(refused("name = \"stiffness\"", "name = \"slope, mean\""), testing::HasSubstr("no commas"));
    EXPECT_THAT(refused("[design.volume]",
                        "[[design.limit]]\nname = \"lift\"\nquantity = \"lift_force\"\nat_least = \"0.1 N\"\n"
                        "at = { gap = \"3 mm\", pitch = 0 }\n[design.volume]"),
                testing::HasSubstr("an objective and a limit that are not of the same are both called 'lift'"));
    EXPECT_THAT(refused("at_least = \"0.1 L\"", "at_least = \"3 L\"\nat_most = \"2 L\""),
                testing::HasSubstr("no design can meet both"));
    EXPECT_THAT(refused("[design.volume]",
                        "[[design.limit]]\nquantity = \"lift_force\"\nat = { gap = \"5 mm\", pitch = 0 }\n"
                        "at_least = \"3 N\"\nat_most = \"1 N\"\n[design.volume]"),
                testing::HasSubstr("no design can meet both"));
    // Beyond what is computed: a place, and a slope that reaches beyond.
    EXPECT_THAT(refused("at = { gap = \"5 mm\", pitch = 0 }", "at = { gap = \"50 mm\", pitch = 0 }"),
                testing::HasSubstr("a gap of 50 mm, and [design] computes 3 mm to 10 mm"));
    EXPECT_THAT(refused("slope_along = \"pitch\"", "slope_along = \"pitch\"\nhalf_width = \"2 deg\""),
                testing::HasSubstr("0 deg +- 2 deg"));
    EXPECT_THAT(refused("\"3 mm\", \"5 mm\"", "\"-3 mm\", \"5 mm\""),
                testing::HasSubstr("-3 mm: it must be above zero"));
    EXPECT_THAT(refused("\"-1 deg\", \"1 deg\"", "\"-1 deg\", \"90 deg\""), testing::HasSubstr("within +-90 deg"));
    EXPECT_THAT(refused("points = 16", "speed = 0"), testing::HasSubstr("design.speed"));
    EXPECT_THAT(refused("quantities = [\"lift_force\"", "quantities = [\"gap\""),
                testing::HasSubstr("there is no load 'gap'"));
    EXPECT_THAT(refused("\"pitch_moment\"]", "\"lift_force\"]"), testing::HasSubstr("twice"));
    EXPECT_THAT(refused("name = \"medium\"", "name = \"medum\""), testing::HasSubstr("did you mean 'medium'?"));
    EXPECT_THAT(refused("name = \"coarse\"", "name = \"a/../b\""), testing::HasSubstr("no name of a folder"));
    EXPECT_THAT(refused("cost = \"40 s\"", "cost = \"-40 s\""), testing::HasSubstr("cost must be above zero"));
    EXPECT_THAT(refused("cell = 0.25", "iterations = -1"), testing::HasSubstr("iterations is -1"));
}

/// More variables than a surrogate learns: said before the first run, not after the last.
TEST_F(DesignFiles, MoreThanTenVariablesAreRefusedBeforeTheyCostRuns) {
    std::string text = design_toml;
    std::string more;
    for (const char* key :
         {"body.length\"\nfrom = \"190 mm\"\nto = \"220 mm\"", "body.width\"\nfrom = \"140 mm\"\nto = \"160 mm\"",
          "body.height\"\nfrom = \"140 mm\"\nto = \"150 mm\"", "body.taper\"\nfrom = -0.1\nto = 0.1",
          "body.base_pitch\"\nfrom = \"-1 deg\"\nto = \"1 deg\"",
          "body.base_offset\"\nfrom = \"-10 mm\"\nto = \"10 mm\""}) {
        more += std::string("[[design.vary]]\nkey = \"") + key + "\n";
    }
    const std::size_t tie = text.find("[[design.tie]]");
    core::write_file(folder_.path() / "study.toml", std::string(text).insert(tie, more));
    EXPECT_EQ(open().spec().all_variables().size(), 10u) << "eight numbers, gap and pitch";
    more += "[[design.vary]]\nkey = \"protrusion.position\"\nfrom = 0.7\nto = 0.8\n";
    core::write_file(folder_.path() / "study.toml", text.insert(tie, more));
    try {
        (void)open();
        FAIL() << "eleven variables";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("study.toml"));
        EXPECT_THAT(error.what(),
                    testing::HasSubstr("[design] has 11 variables: 9 numbers of the shape, gap and pitch"));
    }
}

/// What is wrong, without remarks.
std::vector<core::Problem> warnings_of(const Design& design) {
    std::vector<core::Problem> warnings;
    std::copy_if(design.notes.begin(), design.notes.end(), std::back_inserter(warnings),
                 [](const core::Problem& p) { return p.severity == core::Problem::Severity::warning; });
    return warnings;
}

/// Gaps in metres for millimetres: learned, and said. Another speed than [design] computes: left out, and said.
TEST_F(DesignFiles, RowsAtOtherConditionsAreSaid) {
    Design design = open();
    design.make_plan();
    compute(design);
    EXPECT_TRUE(warnings_of(open()).empty());
    const fs::path file = folder_.path() / "design" / "results.csv";
    const std::string text = core::read_file(file);
    std::string in_metres = text;
    in_metres.replace(in_metres.find("gap [mm]"), 8, "gap [m]");
    core::write_file(file, in_metres);
    const auto wrong = warnings_of(open());
    ASSERT_EQ(wrong.size(), 1u);
    EXPECT_THAT(wrong.front().message,
                testing::HasSubstr("gap is 3000 mm to 10000 mm in 96 rows, and [design] computes 3 mm to 10 mm"));
    EXPECT_THAT(wrong.front().place.text(), testing::HasSubstr("results.csv:2"));
    std::string faster = text;
    for (std::size_t at = 0; (at = faster.find('\n', at)) != std::string::npos && at + 1 < faster.size(); ++at) {
        faster.insert(at, at == faster.find('\n') ? ",speed [m/s]" : ",0.8");
        at = faster.find('\n', at);
    }
    faster.insert(faster.size() - 1, ",0.5");
    core::write_file(file, faster);
    const Design other = open();
    ASSERT_EQ(warnings_of(other).size(), 1u);
    EXPECT_THAT(warnings_of(other).front().message,
                testing::HasSubstr("95 of 96 rows are of something else than [design] asks for now, and left out: 95 "
                                   "(speed: 0.8 m/s there, 0.5 m/s now)"));
}

TEST_F(DesignFiles, TheOnlyValueOfAConditionMayBeSaid) {
    std::string text = design_toml;
    text.replace(text.find("[\"3 mm\", \"5 mm\", \"10 mm\"]"), 25, "\"5 mm\"");
    core::write_file(folder_.path() / "study.toml", text);
    EXPECT_EQ(open().spec().objectives.front().response.conditions.size(), 1u);  // the pitch
    text.replace(text.find("gap = \"5 mm\", pitch = 0"), 12, "gap = \"6 mm\"");
    core::write_file(folder_.path() / "study.toml", text);
    EXPECT_THROW((void)open(), core::InputError);
}

TEST_F(DesignFiles, AVolumeThatIsKnownToBeWrongCostsNoRun) {
    std::string text = design_toml;
    text.replace(text.find("at_least = \"0.1 L\""), 18, "at_least = \"100 L\"");
    core::write_file(folder_.path() / "study.toml", text);
    Design design = open();
    EXPECT_EQ(design.make_plan(), 16u);
    const Design planned = open();  // lives as long as the loop
    for (const PlannedDesign& d : planned.plan()) {
        EXPECT_THAT(d.state, testing::HasSubstr("design.volume wants at least 100 L"));
    }
    const Study study = Study::open(folder_.path());
    try {
        open().solve(study, 1);
        ADD_FAILURE() << "ran";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("there is nothing to run: of 16 designs none can be"));
    }
}

TEST_F(DesignFiles, LimitsThatNobodyMeetsAreNamed) {
    std::string text = design_toml;
    text = text.substr(0, text.find("[design.volume]")) +
           "[[design.limit]]\nname = \"much lift\"\nquantity = \"lift_force\"\nat_least = \"9 N\"\n"
           "at = { gap = \"5 mm\", pitch = 0 }\n"
           "[[design.limit]]\nname = \"little moment\"\nquantity = \"pitch_moment\"\nat_most = \"1 N m\"\n"
           "at = { gap = \"5 mm\", pitch = 0 }\n";
    core::write_file(folder_.path() / "study.toml", text);
    Design design = open();
    design.make_plan();
    compute(design);
    const Design known = open();
    const auto surrogates = known.surrogates();
    const auto search = known.search(surrogates);
    EXPECT_FALSE(search.optimum(1, 1));
    const auto alone = tables::limits_alone(search.problem(), surrogates, 1, 1);
    ASSERT_EQ(alone.size(), 2u);
    ASSERT_TRUE(alone[0] && alone[1]);
    EXPECT_FALSE(alone[0]->met);
    EXPECT_NEAR(alone[0]->nearest.value, lift(highest(known, 0.72), 0.72, 5e-3, 0), 0.005)
        << "the most lift that there is";
    EXPECT_TRUE(alone[1]->met);
}

TEST_F(DesignFiles, AProtrusionOfNoHeightIsNone) {
    const Design design = open();
    const geometry::BodyShape base = geometry::read_shape(design.spec().shape);
    EXPECT_FALSE(shape_at(design.spec(), base, std::vector<double>{0, 0.75}).protrusion);
    EXPECT_TRUE(shape_at(design.spec(), base, std::vector<double>{1e-3, 0.75}).protrusion);
    // And the way back.
    const geometry::BodyShape none = shape_at(design.spec(), base, std::vector<double>{0, 0.75});
    EXPECT_EQ(varied_numbers(design.spec(), base, none), (std::vector<double>{0, 0.75}));
}

TEST_F(DesignFiles, AShapeThatCannotBeIsKeptWithItsReason) {
    std::string text = design_toml;
    text.replace(text.find("to = 0.85"), 9, "to = 1.5");
    core::write_file(folder_.path() / "study.toml", text);
    open().make_plan();
    const Design design = open();
    std::size_t refused = 0;
    for (const PlannedDesign& d : design.plan()) {
        refused += d.state != "planned" ? 1 : 0;
        EXPECT_EQ(d.state == "planned", fs::exists(folder_.path() / "design/shapes" / (d.name + ".toml")))
            << d.name << ": " << d.state;
    }
    EXPECT_GT(refused, 0u);
    EXPECT_LT(refused, design.plan().size());
}

}  // namespace
