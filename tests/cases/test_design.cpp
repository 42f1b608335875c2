// [design]: plan, results, surrogates, the next case and the best, through the files that they stand in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cases/design.h"
#include "core/error.h"
#include "core/file.h"
#include "core/units.h"

namespace {

using namespace underbody;
using namespace underbody::cases;
namespace fs = std::filesystem;

constexpr const char* design_toml = R"(
title = "search"
[frame]
symmetry = "y"
[design]
shape = "evie.toml"
points = 16
gap = ["3 mm", "5 mm", "10 mm"]
pitch = ["-1 deg", "1 deg"]
quantities = ["lift_force", "pitch_moment"]
[[design.vary]]
key = "protrusion.height"
from = "0.5 mm"
to = "3 mm"
[[design.vary]]
key = "body.base_cut"
from = 0.6
to = 0.85
[[design.tie]]
key = "protrusion.length"
of = "protrusion.height"
factor = 12
[[design.fidelity]]
name = "coarse"
cell = 0.25
cost = "40 s"
[[design.fidelity]]
name = "medium"
cost = "160 s"
[[design.objective]]
name = "lift"
quantity = "lift_force"
sense = "maximise"
at = { gap = "5 mm", pitch = 0 }
[[design.objective]]
name = "stiffness"
quantity = "pitch_moment"
slope_along = "pitch"
sense = "minimise"
at = { gap = "5 mm", pitch = 0 }
[design.volume]
at_least = "0.1 L"
)";

constexpr const char* shape_toml = R"(
[body]
length = "203.2 mm"
width = "152 mm"
height = "145 mm"
base_cut = 0.75
[protrusion]
position = 0.8
height = "1 mm"
length = "20 mm"
)";

/// Smooth loads in place of a solver.
double lift(double height, double cut, double gap, double pitch) {
    return 0.3 * std::pow(gap / 5e-3, -0.5) * (1 + 60 * height - std::pow((cut - 0.72) / 0.1, 2) * 0.3) + 2 * pitch;
}
double moment(double height, double cut, double gap, double pitch) {
    return 0.4 * pitch * (1 - 300 * height) * std::pow(gap / 5e-3, -0.4) - 0.007 + 0.004 * cut;
}

class DesignFiles : public testing::Test {
protected:
    DesignFiles() {
        core::write_file(folder_.path() / "study.toml", design_toml);
        core::write_file(folder_.path() / "evie.toml", shape_toml);
    }

    [[nodiscard]] Design open() const { return Design::open(Study::open(folder_.path())); }

    /// What another solver would put there: every design at every condition.
    void compute(const Design& design, bool leave_out_last = false) const {
        std::string csv =
            "design,protrusion.height [mm],body.base_cut [1],gap [mm],pitch [deg],fidelity,lift_force "
            "[N],lift_force_sigma [N],"
            "pitch_moment [N m],pitch_moment_sigma [N m],state\n";
        std::size_t index = 0;
        for (const PlannedDesign& d : design.plan()) {
            const bool failed = leave_out_last && ++index == design.plan().size();
            for (const double gap : {3.0, 5.0, 10.0}) {
                for (const double pitch : {-1.0, 1.0}) {
                    const double a = pitch * M_PI / 180;
                    csv += d.name + "," + std::to_string(1e3 * d.at[0]) + "," + std::to_string(d.at[1]) + "," +
                           std::to_string(gap) + "," + std::to_string(pitch) + "," + d.fidelity + ",";
                    csv += failed ? ",,,,diverged\n"
                                  : std::to_string(lift(d.at[0], d.at[1], gap / 1e3, a)) + ",0.0005," +
                                        std::to_string(moment(d.at[0], d.at[1], gap / 1e3, a)) + ",0.00001,solved\n";
                }
            }
        }
        core::write_file(folder_.path() / "design" / "results.csv", csv);
    }

    core::TemporaryFolder folder_;
};

TEST_F(DesignFiles, APlanIsWrittenOnceAndGoesOn) {
    Design design = open();
    EXPECT_EQ(design.make_plan(), 16u);
    EXPECT_EQ(open().plan().size(), 16u);
    EXPECT_EQ(open().make_plan(), 0u);
    const geometry::BodyShape shape = geometry::read_shape(folder_.path() / "design/shapes/design-001.toml");
    const PlannedDesign first = open().plan().front();
    EXPECT_NEAR(shape.protrusion->height, first.at[0], 1e-9);
    EXPECT_NEAR(shape.protrusion->length, 12 * first.at[0], 1e-8);  // tied
    for (const PlannedDesign& d : open().plan()) {
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
    EXPECT_NEAR(best->at[0], 3e-3, 2e-4);  // the highest ridge
    EXPECT_NEAR(best->at[1], 0.72, 0.03);  // the cut in the middle
    const auto front = search.pareto_front(8, 1);
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
    EXPECT_THAT(refused("to = \"3 mm\"", "to = \"0.1 mm\""), testing::HasSubstr("the range is empty"));
    EXPECT_THAT(refused("quantity = \"lift_force\"", "quantity = \"lift_forc\""), testing::HasSubstr("lift_force"));
    EXPECT_THAT(refused("at = { gap = \"5 mm\", pitch = 0 }", "at = { pitch = 0 }"), testing::HasSubstr("gap"));
    EXPECT_THAT(refused("slope_along = \"pitch\"", "slope_along = \"speed\""), testing::HasSubstr("speed"));
    EXPECT_THAT(refused("sense = \"maximise\"", "sense = \"maximize\""), testing::HasSubstr("maximise"));
    EXPECT_THAT(refused("name = \"medium\"", "name = \"coarse\""), testing::HasSubstr("two fidelities"));
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
