// One rule for how a table is fitted: the report of a study, its exports and the maps of its regions have the same
// force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cases/region_model.h"
#include "cases/study.h"
#include "core/file.h"
#include "core/random.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/tables/analysis/equilibria.h"

namespace underbody::cases {
namespace {

/// Fifteen gaps with noise that interpolation follows up and down across the net weight.
StudyResults noisy_results() {
    core::Random random(8);
    std::vector<double> gap, pitch, speed, lift;
    std::vector<std::string> names;
    for (int i = 0; i < 15; ++i) {
        const double h = 0.004 * std::pow(20.0, i / 14.0);
        gap.push_back(h);
        pitch.push_back(0);
        speed.push_back(0.5);
        lift.push_back(0.25 + 4e-6 / (h * h) - 0.15 * std::exp(-std::pow(std::log(h / 0.025) / 1.1, 2)) +
                       random.normal(0, 0.02));
        names.push_back("case " + std::to_string(i));
    }
    StudyResults results;
    results.loads.add_text("case", names);
    results.loads.add_numbers("gap", "m", gap);
    results.loads.add_numbers("pitch", "rad", pitch);
    results.loads.add_numbers("speed", "m/s", speed);
    results.loads.add_numbers("lift_force", "N", lift);
    return results;
}

class FitRule : public testing::Test {
protected:
    core::TemporaryFolder folder;
    Study study;
    StudyResults results = noisy_results();
    RegionSpec region;

    void SetUp() override {
        TableSpec table;
        table.name = "lift";
        table.quantity = "lift_force";
        table.axes = {"gap"};
        table.where.numbers = {{"speed", 0.5}};
        table.relative_sigma = 0.1;
        table.net_weight = 0.18;
        table.virtual_mass = 4;
        study.tables = {table};
        core::write_file(folder.path() / "model.toml",
                         "[vehicle]\nmass = \"2.2 kg\"\nadded_mass_heave = \"1.8 kg\"\nnet_weight = \"0.18 "
                         "N\"\n[conditions]\nspeed = \"0.5 m/s\"\n"
                         "[drag.heave]\nlinear = \"2 N s/m\"\n");
        region.name = "map";
        region.model = folder.path() / "model.toml";
        region.forces = {"lift"};
        region.axes = "gap=4mm:80mm, heave_velocity=-0.05:0.05";
        region.duration = 120;
        region.columns = 40;
        region.rows = 20;
    }
    [[nodiscard]] tables::Equilibria in_the_report() const {
        tables::EquilibriumOptions options;
        options.net_weight = *study.tables[0].net_weight;
        return tables::equilibria(
            tables::ForceTable::fit(table_points(study.tables[0], results), "lift_force", fit_options(study.tables[0])),
            options);
    }
};

TEST_F(FitRule, EquilibriaOfTheReportAreTheAttractorsOfTheMap) {
    for (const char* fit : {"automatic", "interpolation", "gaussian_process", "spline"}) {
        study.tables[0].fit = fit;
        const auto report = in_the_report();
        const dynamics::Model model = region_model(study, region, results);
        const auto stable = report.gaps(tables::Stability::stable);
        std::vector<double> balanced;
        for (const auto& e : dynamics::heave_equilibria(dynamics::HeavePlant(model, {}))) {
            if (e.stable) {
                balanced.push_back(e.gap);
            }
        }
        ASSERT_EQ(balanced.size(), stable.size()) << fit;
        std::vector<double> attractors;
        for (const auto& end : dynamics::stability_region(model, region_options(region)).classes) {
            if (end.kind == dynamics::EndKind::attractor && end.gap > 0.0041 && end.gap < 0.0799) {
                attractors.push_back(end.gap);
            }
        }
        std::sort(attractors.begin(), attractors.end());
        ASSERT_EQ(attractors.size(), stable.size()) << fit;
        for (std::size_t i = 0; i < stable.size(); ++i) {
            EXPECT_NEAR(balanced[i], stable[i], 1e-9) << fit;
            EXPECT_NEAR(attractors[i], stable[i], 1e-5) << fit;
        }
    }
}

TEST_F(FitRule, TheTwoFormerRulesDifferHere) {
    study.tables[0].fit = "interpolation";
    const auto followed = in_the_report().gaps(tables::Stability::stable);
    study.tables[0].fit = "automatic";
    const auto smoothed = in_the_report().gaps(tables::Stability::stable);
    EXPECT_NE(followed.size(), smoothed.size());
    EXPECT_EQ(smoothed.size(), 1U);
}

TEST_F(FitRule, AModelAtAnotherSpeedSaysThatItsForceIsScaled) {
    core::write_file(region.model,
                     "[vehicle]\nmass = \"2.2 kg\"\nnet_weight = \"0.18 N\"\n[conditions]\nspeed = \"0.6 m/s\"\n");
    const dynamics::Model model = region_model(study, region, results);
    ASSERT_FALSE(model.remarks.empty());
    EXPECT_TRUE(std::any_of(model.remarks.begin(), model.remarks.end(), [](const core::Problem& remark) {
        return remark.message.find("(0.6/0.5)^2") != std::string::npos;
    }));
    ASSERT_EQ(model.forces.at(0).scales.size(), 1U);
    study.tables[0].speed_exponent = 0;
    EXPECT_TRUE(region_model(study, region, results).forces.at(0).scales.empty());
}

TEST_F(FitRule, AForceOfASpeedThatNobodyStatesSaysSo) {
    core::Table without;
    for (const auto& column : results.loads.columns()) {
        if (column.is_text()) {
            without.add_text(column.name, column.text);
        } else if (column.name != "speed") {
            without.add_numbers(column.name, column.unit, column.numbers);
        }
    }
    const auto said = [&] {
        const dynamics::Model model = region_model(study, region, results);
        return std::count_if(model.remarks.begin(), model.remarks.end(), [](const core::Problem& remark) {
            return remark.message.find("no case of the table 'lift' states a speed, nor does [reference]") == 0;
        });
    };
    EXPECT_EQ(said(), 0);
    results.loads = without;
    study.tables[0].where.numbers.clear();
    EXPECT_EQ(said(), 1);
}

TEST_F(FitRule, WhereAndAxesMayBeTextsOrTables) {
    core::write_file(folder.path() / "a-h1.csv", "x");
    const std::string head =
        "title = \"t\"\n[[case]]\nfiles = \"{variant}-h{gap:mm}.csv\"\nconditions = \"speed=0.5 m/s, "
        "mesh=medium\"\n[[table]]\nname = \"t\"\nquantity = \"lift_force\"\n";
    core::write_file(folder.path() / "study.toml",
                     head + "axes = \"gap, pitch\"\nfit = \"gp\"\nwhere = \"variant=a, speed=0.5\"\n");
    const Study text = Study::open(folder.path());
    EXPECT_EQ(text.tables.at(0).axes, (std::vector<std::string>{"gap", "pitch"}));
    EXPECT_EQ(text.tables[0].where.text("variant"), "a");
    EXPECT_EQ(text.tables[0].where.number("speed"), 0.5);
    EXPECT_EQ(fit_options(text.tables[0]).kind, tables::FitOptions::Kind::gaussian_process);
    core::write_file(folder.path() / "study.toml", head + "axes = [\"gap\"]\nfit = \"splin\"\n");
    EXPECT_THROW((void)Study::open(folder.path()), core::InputError);
}

}  // namespace
}  // namespace underbody::cases
