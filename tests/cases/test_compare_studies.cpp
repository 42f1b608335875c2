// Two campaigns side by side, whose differences are known in closed form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/compare_studies.h"
#include "cases/why.h"
#include "core/file.h"
#include "core/text.h"
#include "surrogates/tables/analysis/equilibria.h"
#include "tests/support/small_study.h"

namespace underbody::cases {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class CompareStudies : public testing::Test {
protected:
    /// The small study with `more` N of lift everywhere, an error of 2 % of each point and a word for its solver.
    fs::path campaign(const std::string& name, double more, const std::string& solver) {
        const fs::path folder = scratch.path() / name;
        test::write_small_study(folder);
        fs::remove(folder / "forces.csv");
        for (int gap = 1; gap <= 6; ++gap) {
            core::write_file(folder / "fields" / ("cube-h" + std::to_string(gap) + ".csv"),
                             test::cube_field(1e-3 * gap, ((7 - gap) / 10.0 + more) / 1e-3));
        }
        std::string text = core::read_file(folder / "study.toml");
        text.erase(text.find("[[verify]]"), text.find("[[table]]") - text.find("[[verify]]"));
        replace(text, "conditions.speed = \"0.5 m/s\"",
                "conditions = { speed = \"0.5 m/s\", solver = \"" + solver + "\" }");
        replace(text, "axes = [\"gap\"]\n", "axes = [\"gap\"]\nfit = \"interpolation\"\nrelative_sigma = 0.02\n");
        core::write_file(folder / "study.toml", text);
        return folder;
    }
    static void replace(std::string& text, const std::string& old, const std::string& by) {
        ASSERT_NE(text.find(old), std::string::npos) << old;
        text.replace(text.find(old), old.size(), by);
    }
    struct Side {
        Study study;
        StudyResults results;
    };
    static Side side(const fs::path& folder) {
        RunOptions options;
        options.pictures = false;
        options.write_report = false;
        const Study study = Study::open(folder);
        return {study, run_study(study, options)};
    }
    static StudyComparison compare(const Side& a, const Side& b, const Conditions& where_a = {},
                                   const Conditions& where_b = {}) {
        return compare_studies({"a", &a.study, &a.results, where_a}, {"b", &b.study, &b.results, where_b});
    }
    core::TemporaryFolder scratch;
};

TEST_F(CompareStudies, LoadsAreRankedByTheirJointErrorsTablesAndEquilibriaToo) {
    const Side a = side(campaign("a", 0, "fluent")), b = side(campaign("b", 0.05, "openfoam"));
    const StudyComparison c = compare(a, b);
    EXPECT_EQ(c.cases, 6U);
    ASSERT_EQ(c.apart.size(), 1U);
    EXPECT_EQ(c.apart[0].condition, "solver");
    EXPECT_EQ(c.apart[0].b, "openfoam");
    EXPECT_THAT(c.only_a, IsEmpty());
    // Errors of 2 % of 0.1 and 0.15 N at 6 mm: 13.9 of them; of 0.6 and 0.65 N at 1 mm: 2.8.
    std::vector<const MovedLoad*> lifts;
    for (const auto& one : c.loads) {
        if (one.load.name == "lift_force") {
            lifts.push_back(&one);
        } else {
            EXPECT_NE(one.load.shift, Shift::beyond) << one.load.name;
        }
    }
    ASSERT_EQ(lifts.size(), 6U);
    for (std::size_t i = 0; i < lifts.size(); ++i) {
        const int gap = 6 - static_cast<int>(i);
        const double lift = (7 - gap) / 10.0;
        EXPECT_EQ(lifts[i]->case_a, "cube-h" + std::to_string(gap)) << "what moved most first";
        EXPECT_EQ(lifts[i]->load.shift, Shift::beyond);
        EXPECT_NEAR(lifts[i]->load.difference(), 0.05, 1e-9);
        EXPECT_NEAR(lifts[i]->load.in_sigma(), 0.05 / (0.02 * std::hypot(lift, lift + 0.05)), 1e-6);
        EXPECT_EQ(lifts[i]->settled_b, "unknown");
        EXPECT_EQ(c.loads[i].load.name, "lift_force") << "loads that did not move come last";
    }
    // The table: 0.05 N apart everywhere, in units of the error most at 6 mm.
    ASSERT_EQ(c.tables.size(), 1U);
    EXPECT_NEAR(c.tables[0].root_mean_square, 0.05, 1e-6);
    EXPECT_EQ(c.tables[0].beyond_share, 1);
    EXPECT_EQ(c.tables[0].force.shift, Shift::beyond);
    ASSERT_EQ(c.tables[0].at.size(), 1U);
    EXPECT_GT(c.tables[0].at[0].second, 0.0055);
    // Lift falls by 100 N/m: the gap at which it holds 0.35 N moves by half a millimetre. Its error is that of the
    // force, 7 mN in both, over the slope.
    ASSERT_EQ(c.equilibria.size(), 3U);
    const Moved& gap = c.equilibria[0].value;
    EXPECT_EQ(c.equilibria[0].result, "table/lift");
    EXPECT_NEAR(gap.a, 0.0035, 1e-6);
    EXPECT_NEAR(gap.b, 0.0040, 1e-6);
    EXPECT_EQ(gap.shift, Shift::beyond);
    EXPECT_NEAR(gap.sigma(), std::sqrt(2.0) * 7e-5, 3e-5);
    // The map: all starts come back in both, to gaps half a millimetre apart.
    bool stable = false;
    for (const auto& one : c.maps) {
        stable = stable || (one.value.name == "stable gap" && std::abs(one.value.difference() - 5e-4) < 1e-5);
    }
    EXPECT_TRUE(stable);
    const nlohmann::json json = c;
    EXPECT_EQ(json["loads"][0]["case_a"], "cube-h6");
    EXPECT_EQ(json["loads"][0]["shift"], "beyond its error");
    EXPECT_EQ(json["beyond"].get<std::size_t>(), c.beyond());
    EXPECT_EQ(json["tables"][0]["at"].size(), 1U);
}

// What `table equilibria` states of the study's points is what its results, its report, the way back and a comparison
// say.
TEST_F(CompareStudies, StiffnessAndFrequencyHaveOneErrorInReportOriginAndComparison) {
    const fs::path folder = campaign("a", 0, "x");
    const Side a = side(folder), b = side(campaign("b", 0.002, "x"));
    const TableSpec& spec = a.study.tables.front();
    tables::EquilibriumOptions wanted;
    wanted.net_weight = spec.net_weight.value();
    wanted.virtual_mass = spec.virtual_mass;
    wanted.draws = tables::usual_draws;
    const auto fit = tables::ForceTable::fit(table_points(spec, a.results), spec.quantity, fit_options(spec));
    const tables::Equilibrium stated = tables::equilibria(fit, wanted).all.at(0);
    const double stiffness = stated.stiffness_sigma.value(), frequency = stated.frequency_sigma.value();
    EXPECT_GT(stiffness, 1);
    // f goes with the root of the stiffness.
    EXPECT_NEAR(frequency / stated.frequency, 0.5 * stiffness / stated.stiffness, 0.1 * frequency / stated.frequency);
    const EquilibriumResult& result = a.results.tables.at(0).equilibria.at(0);
    EXPECT_EQ(result.stiffness_sigma, stiffness);
    EXPECT_EQ(result.frequency_sigma, frequency);

    RunOptions options;
    options.pictures = false;
    const StudyResults reported = run_study(a.study, options);
    const std::string page = core::read_file(reported.report);
    const auto cell = [&](double value, int digits) {
        return "<td class=\"num\">" + core::format_number(value, digits) + "</td>";
    };
    EXPECT_THAT(page, HasSubstr(cell(stated.stiffness, 3) + cell(stiffness, 2)));
    EXPECT_THAT(page, HasSubstr(cell(stated.frequency, 3) + cell(frequency, 2)));

    const Way way = way_back(a.study, options, "table/lift");
    const auto* fact = way.origins.front().fact("standard deviation of the stiffness at the stable gap");
    ASSERT_NE(fact, nullptr);
    EXPECT_EQ(fact->number.value(), stiffness);
    fact = way.origins.front().fact("standard deviation of the frequency at the stable gap");
    ASSERT_NE(fact, nullptr);
    EXPECT_EQ(fact->number.value(), frequency);

    const StudyComparison c = compare(a, b);
    ASSERT_EQ(c.equilibria.size(), 3U);
    EXPECT_EQ(c.equilibria[1].value.name, "stiffness at the stable gap");
    EXPECT_EQ(c.equilibria[1].value.sigma_a, stiffness);
    EXPECT_EQ(c.equilibria[1].value.shift, Shift::same) << "both fall by 100 N/m";
    EXPECT_EQ(c.equilibria[2].value.name, "frequency at the stable gap");
    EXPECT_EQ(c.equilibria[2].value.sigma_a, frequency);
}

TEST_F(CompareStudies, WhatIsTheSameDoesNotMoveAndALargeErrorHidesASmallShift) {
    const Side a = side(campaign("a", 0, "x"));
    const StudyComparison same = compare(a, side(campaign("b", 0, "x")));
    EXPECT_EQ(same.beyond(), 0U);
    EXPECT_THAT(same.apart, IsEmpty());
    for (const auto& one : same.loads) {
        EXPECT_EQ(one.load.shift, Shift::same) << one.load.name << " " << one.load.a << " " << one.load.b;
    }
    const StudyComparison little = compare(a, side(campaign("c", 0.002, "x")));
    EXPECT_EQ(little.loads[0].load.shift, Shift::within);
    EXPECT_EQ(little.beyond(), 0U);
}

TEST_F(CompareStudies, CasesOfOneSideAndWhatHasNotSettledAreTold) {
    const fs::path folder = campaign("b", 0.05, "x");
    fs::remove(folder / "fields" / "cube-h2.csv");
    std::string monitor = "\"lift\"\n\"Iteration\" \"lift\"\n(\"Iteration\" \"lift\")\n";
    for (int i = 1; i <= 30; ++i) {
        monitor += std::to_string(i) + " " + (i % 2 == 0 ? "0.3" : "0.1") + "\n";
    }
    core::write_file(folder / "fields" / "cube-h5-lift.out", monitor);
    const StudyComparison c = compare(side(campaign("a", 0, "x")), side(folder));
    EXPECT_EQ(c.cases, 5U);
    EXPECT_THAT(c.only_a, ElementsAre("cube-h2"));
    EXPECT_THAT(c.only_b, IsEmpty());
    EXPECT_EQ(c.unsettled_a, 0U);
    EXPECT_EQ(c.unsettled_b, 1U);
    EXPECT_EQ(c.tables[0].unsettled_b, 1U);
    for (const auto& one : c.loads) {
        EXPECT_EQ(one.settled_b, one.case_b == "cube-h5" ? "not settled" : "unknown");
    }
    // An equilibrium that vanishes.
    const StudyComparison gone = compare(side(campaign("low", 0, "x")), side(campaign("high", 0.5, "x")));
    ASSERT_EQ(gone.equilibria.size(), 1U);
    EXPECT_EQ(gone.equilibria[0].value.shift, Shift::only_one);
    EXPECT_TRUE(std::isnan(gone.equilibria[0].value.b));
}

TEST_F(CompareStudies, MeshesOfOneStudyAndOtherMeshesOfAnotherBelongTogether) {
    const fs::path folder = scratch.path() / "meshes";
    for (int gap = 1; gap <= 4; ++gap) {
        for (const auto& [mesh, lift] : {std::pair{"coarse", 0.4}, {"fine", 0.42}}) {
            core::write_file(folder / "fields" / ("cube-h" + std::to_string(gap) + "-" + mesh + ".csv"),
                             test::cube_field(1e-3 * gap, lift / 1e-3));
        }
    }
    core::write_file(folder / "study.toml",
                     "title = \"meshes\"\n[[case]]\nfiles = \"fields/{variant}-h{gap:mm}-{mesh}.csv\"\n");
    const Side one = side(folder);
    Conditions coarse, fine;
    coarse.texts = {{"mesh", "coarse"}};
    fine.texts = {{"mesh", "fine"}};
    const StudyComparison c = compare(one, one, coarse, fine);
    EXPECT_EQ(c.cases, 4U);
    ASSERT_EQ(c.apart.size(), 1U);
    EXPECT_EQ(c.apart[0].condition, "mesh");
    EXPECT_EQ(c.loads[0].load.name, "lift_force");
    EXPECT_EQ(c.loads[0].load.shift, Shift::unjudged) << "nobody knows an error";
    EXPECT_NEAR(c.loads[0].load.of_size(), 0.02 / 0.4, 1e-9);
    EXPECT_THAT(c.tables, IsEmpty());
    try {
        Conditions none;
        none.texts = {{"mesh", "finest"}};
        (void)compare(one, one, coarse, none);
        ADD_FAILURE() << "nothing to compare";
    } catch (const core::InputError& error) {
        EXPECT_THAT(error.message(), HasSubstr("no case of 'b' that has loads has finest"));
    }
}

}  // namespace
}  // namespace underbody::cases
