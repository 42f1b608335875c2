// What the lift of a shape rests on: CFD of it, the surrogate over the shapes of a search, or the nearest shape.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cases/design.h"
#include "cases/known_lift.h"
#include "core/file.h"
#include "geometry/body/variants.h"
#include "tests/cases/design_files.h"

namespace underbody::cases {
namespace {

using design_search::lift;
using design_search::shape_toml;

constexpr const char* study_toml = R"(
title = "search"
[frame]
symmetry = "y"
[[body]]
name = "evie"
shape = "evie.toml"
[[case]]
files = "{variant}-h{gap:mm}-p{pitch:deg}.csv"
[[table]]
name = "lift"
quantity = "lift_force"
axes = ["gap"]
where = { variant = "evie", pitch = 0 }
[design]
shape = "evie.toml"
points = 12
gap = ["3 mm", "5 mm", "10 mm"]
pitch = "0 deg"
quantities = ["lift_force"]
[[design.vary]]
key = "protrusion.height"
from = "0.5 mm"
to = "3 mm"
[[design.vary]]
key = "body.base_cut"
from = 0.6
to = 0.85
[[design.fidelity]]
name = "coarse"
cell = 0.25
cost = "40 s"
[[design.objective]]
quantity = "lift_force"
sense = "maximise"
at = { gap = "5 mm" }
)";

class KnownLiftOfShapes : public testing::Test {
protected:
    KnownLiftOfShapes() {
        core::write_file(folder_.path() / "study.toml", study_toml);
        core::write_file(folder_.path() / "evie.toml", shape_toml);
        core::write_file(folder_.path() / "evie-h5-p0.csv", "not read here");
        shape_ = geometry::read_shape(folder_.path() / "evie.toml");
        shapes_ = {{"evie", folder_.path() / "evie.toml", shape_}};
    }
    void compute() {
        Design design = Design::open(study());
        design.make_plan();
        std::string csv =
            "design,protrusion.height [mm],body.base_cut [1],gap [mm],fidelity,lift_force [N],lift_force_sigma "
            "[N],state\n";
        for (const PlannedDesign& d : design.plan()) {
            for (const double gap : {3.0, 5.0, 10.0}) {
                csv += d.name + "," + std::to_string(1e3 * d.at[0]) + "," + std::to_string(d.at[1]) + "," +
                       std::to_string(gap) + "," + d.fidelity + "," +
                       std::to_string(lift(d.at[0], d.at[1], gap / 1e3, 0)) + ",0.0005,solved\n";
            }
        }
        core::write_file(folder_.path() / "design" / "results.csv", csv);
    }
    [[nodiscard]] Study study() const { return Study::open(folder_.path()); }
    [[nodiscard]] geometry::BodyShape changed(const std::string& name, const std::string& value) const {
        geometry::BodyShape other = shape_;
        geometry::set_parameter(other, name, value);
        return other;
    }

    core::TemporaryFolder folder_;
    geometry::BodyShape shape_;
    std::vector<NamedShape> shapes_;
};

TEST_F(KnownLiftOfShapes, CfdOfTheShapeComesFirstThenTheSearchThenTheNearestShape) {
    using Basis = KnownLift::Basis;
    const Study study = this->study();
    std::string why;
    EXPECT_EQ(lift_surrogate(study, why), nullptr);
    EXPECT_FALSE(why.empty()) << "nothing is computed yet";

    EXPECT_EQ(known_lift(study, shapes_, nullptr, shape_).basis, Basis::this_shape);
    const auto other = changed("body.base_cut", "0.7");
    const KnownLift nearest = known_lift(study, shapes_, nullptr, other);
    EXPECT_EQ(nearest.basis, Basis::nearest_shape);
    EXPECT_EQ(nearest.words(), "CFD of evie, the nearest shape; not CFD of this one");
    EXPECT_EQ(known_lift(study, {}, nullptr, other).basis, Basis::nothing);

    compute();
    const auto surrogate = lift_surrogate(study, why);
    ASSERT_TRUE(surrogate) << why;
    EXPECT_EQ(known_lift(study, shapes_, surrogate.get(), shape_).basis, Basis::this_shape)
        << "its own CFD counts more";
    const KnownLift learned = known_lift(study, shapes_, surrogate.get(), other);
    ASSERT_EQ(learned.basis, Basis::surrogate);
    EXPECT_EQ(learned.words(), "surrogate over the 12 shapes of the search; not CFD of this one");
    ASSERT_EQ(learned.design.size(), 2U);
    EXPECT_NEAR(learned.design[1], 0.7, 1e-12);
    // What is not varied makes it a shape that the search does not know.
    EXPECT_EQ(known_lift(study, shapes_, surrogate.get(), changed("body.width", "150 mm")).basis, Basis::nearest_shape);
    const KnownLift beyond = known_lift(study, shapes_, surrogate.get(), changed("body.base_cut", "0.55"));
    EXPECT_THAT(beyond.words(), testing::HasSubstr("body.base_cut beyond the searched range"));

    const auto run = geometry::read_shape(folder_.path() / "design" / "shapes" / "design-003.toml");
    EXPECT_THAT(known_lift(study, shapes_, surrogate.get(), run).words(),
                testing::HasSubstr("this shape is one of them"));
}

TEST_F(KnownLiftOfShapes, TheCurveOfTheSearchFollowsTheLawWithinItsBand) {
    const Study study = this->study();
    compute();
    std::string why;
    const auto surrogate = lift_surrogate(study, why);
    ASSERT_TRUE(surrogate) << why;
    const KnownLift known = known_lift(study, shapes_, surrogate.get(), changed("body.base_cut", "0.7"));
    const core::Figure figure = surrogate_lift_figure(*surrogate, known, 0, 0.5);
    ASSERT_EQ(figure.curves.size(), 1U);
    EXPECT_TRUE(figure.curves.front().dashed) << "not CFD of this shape";
    const auto& curve = figure.curves.front();
    const auto& band = figure.bands.front();
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        const double truth = lift(1e-3, 0.7, 1e-3 * curve.x[i], 0);
        const double half = 0.5 * (band.upper[i] - band.lower[i]);
        EXPECT_NEAR(curve.y[i], truth, std::max(2 * half, 0.01)) << "at " << curve.x[i] << " mm";
    }
    EXPECT_NEAR(curve.x.front(), 3, 1e-9);
    EXPECT_NEAR(curve.x.back(), 10, 1e-9);
    EXPECT_THAT(figure.caption, testing::HasSubstr("pitch 0 deg (the only one that was computed)"));
}

}  // namespace
}  // namespace underbody::cases
