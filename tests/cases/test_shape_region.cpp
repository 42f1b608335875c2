// The model that a shape's stability map is of: the study's vehicle with what is known of the shape's lift.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cases/region_model.h"
#include "cases/shape_region.h"
#include "core/file.h"
#include "tests/support/small_study.h"

namespace underbody::cases {
namespace {

class ShapeRegionOfACube : public testing::Test {
protected:
    ShapeRegionOfACube() { test::write_small_study(folder_.path()); }
    void run() {
        study_ = Study::open(folder_.path());
        RunOptions options;
        options.pictures = options.write_report = false;
        results_ = run_study(study_, options);
        asked_.vehicle = vehicle_of(study_);
        asked_.lift.basis = KnownLift::Basis::this_shape;
        asked_.lift.of = "cube";
        asked_.lift.table = study_.find_table("lift");
    }
    void replace(const char* file, const std::string& old, const std::string& by) {
        std::string text = core::read_file(folder_.path() / file);
        ASSERT_NE(text.find(old), std::string::npos);
        core::write_file(folder_.path() / file, text.replace(text.find(old), old.size(), by));
    }
    core::TemporaryFolder folder_;
    Study study_;
    StudyResults results_;
    ShapeRegion asked_;
};

TEST_F(ShapeRegionOfACube, IsTheStudysOwnWhereTheLiftIs) {
    run();
    const auto model = shape_model(study_, results_, asked_, nullptr);
    dynamics::RegionOptions options = region_options(asked_.vehicle);
    const auto own = dynamics::stability_region(region_model(study_, asked_.vehicle, results_), options);
    options = shape_region_options(asked_, model);
    EXPECT_EQ(options.columns, 40U);
    EXPECT_EQ(dynamics::stability_region(model, options).index, own.index);
    EXPECT_EQ(vehicle_words(asked_, model), "glide.toml, net weight 0.35 N, 4 kg with its added mass, 0.5 m/s");
    const auto figure = shape_region_figure(own, asked_.lift, vehicle_words(asked_, model));
    EXPECT_EQ(figure.title, "CFD of this shape (cube)");
    EXPECT_THAT(figure.caption, testing::StartsWith("Lift: CFD of this shape (cube). Vehicle: glide.toml, net"));

    // A weight by hand moves the equilibrium to where the lift (7 - gap) / 10 N is as large.
    asked_.net_weight = 0.25;
    const auto lighter = shape_model(study_, results_, asked_, nullptr);
    const auto region = dynamics::stability_region(lighter, options);
    ASSERT_EQ(region.equilibria.size(), 1U);
    EXPECT_NEAR(region.equilibria.front().gap, 4.5e-3, 1e-9);
}

// What the model lifts by a table of its own goes; its jet, and a force of another kind, stay.
TEST_F(ShapeRegionOfACube, ALiftOfTheModelIsReplacedAndItsJetIsNot) {
    core::write_file(folder_.path() / "own.csv", "gap [mm],lift_force [N],drag_force [N]\n1,9,1\n6,8,1\n");
    replace("glide.toml", "[conditions]\n",
            "[[force]]\nquantity = \"lift_force\"\ntable = \"own.csv\"\n"
            "[[force]]\nquantity = \"drag_force\"\ntable = \"own.csv\"\n"
            "[[force]]\nquantity = \"lift_force\"\ntable = \"own.csv\"\n"
            "scale.jet_voltage = { reference = \"12 V\", exponent = 2 }\n"
            "[conditions]\njet_voltage = \"0 V\"\n");
    replace("study.toml", "forces = [\"lift\"]\n", "");
    // The cases are at another speed than the model holds: the map is at theirs, as their curve is.
    replace("study.toml", "conditions.speed = \"0.5 m/s\"", "conditions.speed = \"0.4 m/s\"");
    replace("study.toml", "speed = 0.5 }", "speed = 0.4 }");
    run();
    const auto model = shape_model(study_, results_, asked_, nullptr);
    ASSERT_EQ(model.forces.size(), 3U);
    EXPECT_EQ(model.forces[0].quantity, "drag_force");
    EXPECT_EQ(model.forces[1].scales.front().channel, dynamics::Channel::jet_voltage);
    EXPECT_TRUE(model.forces[2].table_file.empty()) << "made of what is known of the shape";
    EXPECT_DOUBLE_EQ(model.conditions[dynamics::Channel::speed], 0.4);
    const auto region = dynamics::stability_region(model, shape_region_options(asked_, model));
    ASSERT_EQ(region.equilibria.size(), 1U);
    EXPECT_NEAR(region.equilibria.front().gap, 3.5e-3, 1e-9);
}

TEST_F(ShapeRegionOfACube, SaysWhatIsMissing) {
    run();
    asked_.lift = {};
    try {
        shape_model(study_, results_, asked_, nullptr);
        FAIL() << "no lift is known";
    } catch (const core::InputError& error) {
        EXPECT_EQ(error.kind(), "missing");
        EXPECT_FALSE(error.hint().empty());
    }
    study_.regions.clear();
    EXPECT_THROW(vehicle_of(study_), core::InputError);
    MeasurementSpec measured;
    measured.name = "heave test";
    measured.model = folder_.path() / "glide.toml";
    study_.measurements.push_back(measured);
    asked_.vehicle = vehicle_of(study_);
    EXPECT_EQ(asked_.vehicle.model, measured.model);
    asked_.lift.basis = KnownLift::Basis::nearest_shape;
    asked_.lift.table = study_.find_table("lift");
    const auto model = shape_model(study_, results_, asked_, nullptr);
    const auto options = shape_region_options(asked_, model);
    EXPECT_DOUBLE_EQ(options.axes[0].lower, 1e-3) << "all gaps of the lift";
    EXPECT_DOUBLE_EQ(options.axes[0].upper, 6e-3);
    EXPECT_EQ(dynamics::stability_region(model, options).equilibria.size(), 1U);
}

}  // namespace
}  // namespace underbody::cases
