// Objectives and limits that are numbers of whole curves: read, searched, planned, proved, told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cases/design_curves.h"
#include "cases/design_figures.h"
#include "cases/design_proof.h"
#include "cases/shape_loads.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "surrogates/tables/analysis/equilibria.h"
#include "tests/cases/design_files.h"

namespace {

using namespace underbody;
using namespace underbody::cases;
using namespace underbody::cases::design_search;

constexpr const char* kick_toml = R"(
[[design.objective]]
name = "kick"
curve = "kick"
sense = "maximise"
at = { pitch = 0 }
)";
constexpr const char* window_toml = R"(
[[design.limit]]
name = "window"
curve = "pitch_window"
moment_at_most = "0.02 N m"
at_least = "0.2 deg"
)";

/// The study of design_files.h with kicks and windows in place of its objectives.
std::string study_toml(const std::string& wishes, const std::string& conditions =
                                                      "gap = [\"2 mm\", \"3 mm\", \"5 mm\", \"7 mm\", \"10 mm\"]\n"
                                                      "pitch = [\"-1 deg\", 0, \"1 deg\"]\n"
                                                      "net_weight = \"0.3 N\"\nvirtual_mass = \"3.954 kg\"") {
    std::string text = design_toml;
    const auto replace = [&](const std::string& from, const std::string& to, const std::string& by) {
        const auto a = text.find(from), b = text.find(to, a);
        text.replace(a, b - a, by);
    };
    replace("gap = [", "quantities", conditions + "\n");
    replace("[[design.objective]]", "[design.volume]", wishes);
    return text;
}

/// Falls, rises again beyond 6 mm or so: a balance below, an unstable one above.
double curved_lift(double height, double cut, double gap, double pitch) {
    const double deep = 2e4 * (1 - 100 * height * height / 1e-3) * (1 - std::pow((cut - 0.72) / 0.2, 2));
    return 0.3 + deep * ((gap - 6.5e-3) * (gap - 6.5e-3) - 9e-6) + 0.5 * pitch;
}

class DesignCurves : public DesignFiles {
protected:
    void write(const std::string& text) const { core::write_file(folder_.path() / "study.toml", text); }

    void compute_curved(const Design& design) const {
        compute(design, {2, 3, 5, 7, 10}, {-1, 0, 1}, curved_lift, 0.002);
    }

    [[nodiscard]] Design computed(const std::string& wishes) const {
        write(study_toml(wishes));
        Design design = open();
        design.make_plan();
        compute_curved(design);
        return open();
    }

    /// What reading or checking the study says.
    [[nodiscard]] std::string refused(const std::string& text) const {
        write(text);
        try {
            (void)open();
        } catch (const core::InputError& error) {
            return error.what();
        }
        return "nothing";
    }
};

double largest_kick(const tables::ForceTable& table, double weight, double mass) {
    tables::EquilibriumOptions options;
    options.net_weight = weight;
    options.virtual_mass = mass;
    double largest = 0;
    for (const tables::Equilibrium& e : equilibria(table, options).all) {
        largest = e.stability == tables::Stability::stable ? std::max(largest, e.kick_velocity) : largest;
    }
    return largest;
}

/// One number, whichever way it is asked for: the search, and the equilibria of the table of that shape.
TEST_F(DesignCurves, TheSearchSaysWhatTheTableOfTheShapeSays) {
    const Design design = computed(kick_toml);
    const auto search = design.search(design.surrogates());
    const auto best = search.optimum(1, 1);
    ASSERT_TRUE(best);
    EXPECT_NEAR(best->at[0], 0.5e-3, 1e-5);
    EXPECT_NEAR(best->at[1], 0.72, 0.02);
    const auto learned = learned_loads(design, {"lift_force"});
    for (const std::vector<double>& at : {best->at, design.plan()[3].at, design.plan()[7].at}) {
        AskedPoints asked{{"lift_force"}, {"gap"}, {}};
        asked.held.set("pitch", 0);
        const auto table = tables::ForceTable::fit(shape_points(*learned, design.shape_at(at), asked), "lift_force");
        const double kick = largest_kick(table, 0.3, 3.954);
        const auto said = search.evaluate(design.spec().objectives[0].response, at);
        EXPECT_NEAR(std::max(0.0, said.value), kick, 2e-3 * kick);
        EXPECT_GT(said.sigma, 0);
    }
    // Its two balances lie 6 mm apart: the work between them is deep (6 mm)^3 / 6.
    EXPECT_NEAR(best->objectives[0].value, std::sqrt(2 * 2e4 * 0.975 * std::pow(6e-3, 3) / 6 / 3.954), 1.5e-3);
    EXPECT_EQ(response_unit(design.spec().objectives[0].response), "m/s");
}

/// The best goes into the plan with what is said of it, and that stands beside what its own runs say.
TEST_F(DesignCurves, AreProvedByTheRunsOfTheDesign) {
    Design design = computed(std::string(kick_toml) + window_toml);
    const auto search = design.search(design.surrogates());
    const auto best = search.optimum(1, 1);
    ASSERT_TRUE(best);
    EXPECT_GE(best->limits[0].value, 0.2 * M_PI / 180);
    design.add_for_proof({*best});
    design = open();
    EXPECT_NE(design.plan_table().find("kick_predicted"), nullptr);
    EXPECT_EQ(design.plan_table().find("kick_predicted")->unit, "m/s");
    ASSERT_TRUE(best->limits[0].at_least);  // a degree is what was computed
    EXPECT_TRUE(design.plan().back().predicted.at("window").at_least);
    EXPECT_FALSE(design.plan().back().predicted.at("kick").at_least);
    compute_curved(design);
    const std::string results = core::read_file(folder_.path() / "design" / "results.csv");
    design = open();
    const auto all = proofs(design);
    ASSERT_EQ(all.size(), 1U);
    ASSERT_EQ(all[0].note, "");
    ASSERT_EQ(all[0].responses.size(), 2U);
    const ProofOfResponse &kick = all[0].responses[0], &window = all[0].responses[1];
    ASSERT_TRUE(kick.computed && window.computed);
    core::Table points;
    const std::vector<double> gaps = {2e-3, 3e-3, 5e-3, 7e-3, 10e-3};
    std::vector<double> lift;
    for (const double gap : gaps) {
        lift.push_back(
            std::stod(std::to_string(curved_lift(design.plan().back().at[0], design.plan().back().at[1], gap, 0))));
    }
    points.add_numbers("gap", "m", gaps);
    points.add_numbers("lift_force", "N", lift);
    tables::FitOptions options;
    const double of_table = largest_kick(tables::ForceTable::fit(points, "lift_force", options), 0.3, 3.954);
    EXPECT_NEAR(kick.computed->value, of_table, 1e-3 * of_table);
    EXPECT_GT(kick.computed->sigma, 0);
    EXPECT_LT(kick.computed->sigma, 0.1 * of_table);
    EXPECT_EQ(window.unit, "rad");
    EXPECT_THAT(proof_text(all[0]), testing::HasSubstr("kick predicted"));
    // Without one of its gaps, at an end or within, they do not tell it.
    const std::string name = design.plan().back().name;
    for (const std::string gap : {"10.000000", "5.000000"}) {
        std::string rows;
        for (const auto line : core::split(results, '\n')) {
            const bool its_own = line.starts_with(name + ",") && line.find("," + gap + ",") != std::string_view::npos;
            rows += its_own || line.empty() ? "" : std::string(line) + "\n";
        }
        core::write_file(folder_.path() / "design" / "results.csv", rows);
        EXPECT_FALSE(proofs(open())[0].responses[0].computed) << gap;
    }
    core::write_file(folder_.path() / "design" / "results.csv", results);
    // A prediction for another weight is none.
    write(study_toml(std::string(kick_toml) + window_toml,
                     "gap = [\"2 mm\", \"3 mm\", \"5 mm\", \"7 mm\", \"10 mm\"]\npitch = [\"-1 deg\", 0, \"1 deg\"]\n"
                     "net_weight = \"0.31 N\"\nvirtual_mass = \"3.954 kg\""));
    EXPECT_THAT(proofs(open())[0].note, testing::HasSubstr("for other conditions, objectives or limits"));
}

TEST_F(DesignCurves, AreInSensitivitiesAndTheReport) {
    const Design design = computed(kick_toml);
    const auto numbers = learned_numbers(design, design.surrogates());
    ASSERT_EQ(numbers.size(), 3U);
    EXPECT_EQ(numbers[2].name, "kick");
    EXPECT_EQ(numbers[2].unit, "m/s");
    ASSERT_EQ(numbers[2].variables.size(), 2U);
    const auto indices = design.sensitivity(numbers[2]);
    EXPECT_GT(indices.total[0].value + indices.total[1].value, 0.95);
    const auto figure = one_at_a_time_figure(numbers[2], middle_of(numbers[2].variables));
    EXPECT_EQ(figure.curves.size(), 2U);
    std::string drawn;
    const std::string report = design_report(design, [&](const core::Figure& picture) {
        drawn += picture.title + "\n";
        return std::string("a picture");
    });
    const auto best = design.search(design.surrogates()).optimum(1, design.spec().seed);
    ASSERT_TRUE(best);
    // The speed of the search is in m/s, and "kick" stands in its objective: the number itself is looked for.
    EXPECT_THAT(report,
                testing::HasSubstr(">" + told_response(best->objectives[0], design.spec().objectives[0].response)));
    EXPECT_THAT(drawn, testing::HasSubstr("What kick depends on"));
    EXPECT_EQ(told_response({-0.01, 0.002, false}, true, "m/s").substr(0, 6), "none (");
    EXPECT_EQ(told_response({0.01, 0.002, true}, true, "m/s").substr(0, 9), "at least ");
}

TEST_F(DesignCurves, WhatIsMissingIsSaid) {
    using testing::HasSubstr;
    const std::string gaps = "gap = [\"2 mm\", \"5 mm\", \"10 mm\"]\n",
                      pitches = "pitch = [\"-1 deg\", 0, \"1 deg\"]\n", weight = "net_weight = \"0.3 N\"\n",
                      mass = "virtual_mass = \"4 kg\"\n";
    EXPECT_EQ(refused(study_toml(std::string(kick_toml) + window_toml)), "nothing");
    EXPECT_THAT(refused(study_toml(kick_toml, gaps + pitches + mass)), HasSubstr("[design] states none"));
    EXPECT_THAT(refused(study_toml(kick_toml, gaps + pitches + weight)), HasSubstr("virtual_mass = "));
    EXPECT_THAT(refused(study_toml(kick_toml, gaps + pitches + weight + "virtual_mass = \"-1 kg\"")),
                HasSubstr("must not be negative"));
    EXPECT_THAT(refused(study_toml(kick_toml, "gap = [\"2 mm\", \"5 mm\"]\n" + pitches + weight + mass)),
                HasSubstr("of which [design] has 2 values"));
    EXPECT_THAT(refused(study_toml(window_toml, gaps + "pitch = [\"-1 deg\", \"1 deg\"]\n" + weight)),
                HasSubstr("over the pitch, of which [design] has 2 values"));
    const auto with = [&](std::string wish, const std::string& from, const std::string& to) {
        wish.replace(wish.find(from), from.size(), to);
        return refused(study_toml(wish));
    };
    EXPECT_THAT(with(kick_toml, "\"kick\"\nsense", "\"kik\"\nsense"), HasSubstr("did you mean 'kick'"));
    EXPECT_THAT(with(kick_toml, "sense = \"maximise\"\n", ""), HasSubstr("sense"));
    EXPECT_THAT(with(kick_toml, "pitch = 0", "gap = \"5 mm\", pitch = 0"), HasSubstr("runs over the gap"));
    EXPECT_THAT(with(kick_toml, "at = { pitch = 0 }", ""), HasSubstr("does not say at which pitch"));
    EXPECT_THAT(with(kick_toml, "sense", "slope_along = \"gap\"\nsense"), HasSubstr("has no slope"));
    EXPECT_THAT(with(kick_toml, "sense", "restoring = true\nsense"), HasSubstr("made of the lift alone"));
    EXPECT_THAT(with(window_toml, "\"0.02 N m\"", "\"-0.02 N m\""), HasSubstr("must be above zero"));
    EXPECT_THAT(with(window_toml, "at_least", "quantity = \"pitch_moment_at_buoyancy\"\nat_least"),
                HasSubstr("none of design.quantities"));
    EXPECT_THAT(with(window_toml, "moment_at_most = \"0.02 N m\"\n", "at = { gap = \"5 mm\" }\n"),
                HasSubstr("of which nothing is asked"));
    EXPECT_THAT(with(window_toml, "at_least", "at = { pitch = \"1 deg\" }\nat_least"),
                HasSubstr("lies about a pitch of 1 deg"));
    EXPECT_THAT(with(window_toml, "\"0.2 deg\"", "\"0.2 m\""), HasSubstr("another dimension than 'rad'"));
}

}  // namespace
