// Stability regions against CVODE, closed forms and each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "surrogates/dynamics/basin/region.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

/// Where CVODE at 1e-9 takes a start, without any argument about energy: followed until it rests, touches or leaves.
std::string by_cvode(const Model& model, double gap, double velocity, double escape, double duration) {
    TrajectoryOptions options;
    options.duration = duration;
    options.stop_at_contact = true;
    options.stop_at_equilibrium = false;
    options.escape_gap = escape;
    options.output_step = duration;
    const Trajectory motion = simulate(model, gap, velocity, {}, options);
    if (motion.end != "time") {
        return motion.end;
    }
    std::string nearest = "undecided";
    double distance = 0.02;
    for (const HeaveEquilibrium& e : heave_equilibria(HeavePlant(model))) {
        if (e.stable && std::abs(motion.gap.back() - e.gap) < distance) {
            distance = std::abs(motion.gap.back() - e.gap);
            nearest = e.name;
        }
    }
    return nearest;
}

RegionOptions map_of(double low, double high, double speed, std::size_t cells) {
    RegionOptions options;
    options.axes = {{"gap", low, high}, {"heave_velocity", -speed, speed}};
    options.columns = options.rows = cells;
    return options;
}

TEST(Region, EveryClassAgreesWithCvodeOnRandomStarts) {
    const Model model = test::ref_a_model(0.3, 15);
    RegionOptions options = map_of(-0.05, 1.0, 0.1, 100);
    core::Random random(7);
    core::Table starts;
    std::vector<double> gap, velocity;
    for (int i = 0; i < 1000; ++i) {
        gap.push_back(random.uniform(-0.05, 1.0));
        velocity.push_back(random.uniform(-0.1, 0.1));
    }
    starts.add_numbers("gap", "m", gap);
    starts.add_numbers("heave_velocity", "m/s", velocity);
    options.duration = 400;
    const core::Table ends = ends_of_starts(model, starts, options).table;
    const std::vector<std::string>& found = ends.text("class");
    int wrong = 0;
    for (std::size_t i = 0; i < gap.size(); ++i) {
        const std::string expected = by_cvode(model, gap[i], velocity[i], 1.8, 400);
        wrong += expected != found[i] ? 1 : 0;
        EXPECT_EQ(expected, found[i]) << "gap " << gap[i] << " velocity " << velocity[i];
    }
    EXPECT_EQ(wrong, 0);
}

TEST(Region, TheBasinOfALinearSpringOverTheGroundIsAHalfSpiral) {
    // Lightly damped: everything with less energy than it takes to the ground at gap 0 is kept.
    const Model model = test::spring_model(100.0, 4.0, 1e-6, 0);
    RegionOptions options = map_of(0, 0.3, 1.0, 200);
    options.escape_gap = 10;
    const StabilityRegion region = stability_region(model, options);
    // Ellipse |h - 0.1| < 0.1, |w| < 0.1 * 5 of area pi 0.1 0.5 within the box of 0.3 x 2.
    EXPECT_NEAR(region.fraction("A"), 3.14159265 * 0.1 * 0.5 / 0.6, 2e-3);
    EXPECT_EQ(region.count(EndKind::undecided), 0U);
}

TEST(Region, ASecondTableThatEndsElsewhereAndIsSwitchedOffChangesNothing) {
    const Model alone = test::ref_a_model(.3, 15, .002);
    core::Table other;
    other.source = "other.csv";
    other.add_numbers("gap", "m", {.0006, .002, .01, .1});
    other.add_numbers("lift_force", "N", {.3, -.02, .01, 0});
    Model both = alone;
    tables::FitOptions fit;
    fit.kind = tables::FitOptions::Kind::interpolation;
    both.forces.push_back({"lift_force",
                           "other.csv",
                           "other.csv",
                           tables::ForceTable::fit(other, "lift_force", fit),
                           {Channel::gap},
                           {{Channel::jet_voltage, 12, 2, 0}},
                           1.0});
    both.contact.gap = -.05;
    RegionOptions options;
    options.axes = {{"gap", -.04, 1}, {"heave_velocity", -.1, .1}};
    options.columns = options.rows = 30;
    options.escape_gap = 1.8;
    const StabilityRegion a = stability_region(alone, options);
    for (const double volts : {0.0, 1e-3}) {
        options.held[Channel::jet_voltage] = volts;
        const StabilityRegion b = stability_region(both, options);
        EXPECT_EQ(a.count(EndKind::attractor), b.count(EndKind::attractor)) << volts;
        EXPECT_EQ(b.count(EndKind::undecided), a.count(EndKind::undecided)) << volts;
    }
}

TEST(Region, FractionsOfAllClassesSumToOne) {
    const StabilityRegion region = stability_region(test::ref_a_model(0.02, 6.0, 0.002), map_of(-0.04, 1.0, 0.1, 80));
    double sum = 0;
    for (const EndClass& end : region.classes) {
        sum += end.fraction;
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    EXPECT_EQ(region.index.size(), 6400U);
    EXPECT_EQ(region_table(region).rows(), 6400U);
    const SafeSet safe = largest_safe_set(region, "A");
    EXPECT_GT(safe.ellipse[0] * safe.ellipse[1], 0);
    EXPECT_GT(safe.box[0] * safe.box[1], 0);
}

// Cells of equal ratio: each start is where the table says, and shares stay those of the area.
TEST(Region, CellsOfEqualRatioShareTheSameArea) {
    const Model model = test::ref_a_model(0.02, 6.0, 0.002);
    RegionOptions even = map_of(0.005, 1.0, 0.1, 160);
    RegionOptions by_ratio = map_of(0.005, 1.0, 0.1, 80);
    by_ratio.gap_by_ratio = true;
    const StabilityRegion reference = stability_region(model, even);
    const StabilityRegion region = stability_region(model, by_ratio);
    const core::Table starts = region_table(region);
    const std::vector<double>& gap = starts.numbers("gap");
    EXPECT_NEAR(gap[1] / gap[0], std::pow(200.0, 1.0 / 80), 1e-12);
    EXPECT_NEAR(gap[79] / gap[78], gap[1] / gap[0], 1e-12);
    core::Table bare;
    bare.add_numbers("gap", "m", gap);
    bare.add_numbers("heave_velocity", "m/s", starts.numbers("heave_velocity"));
    const core::Table ends = ends_of_starts(model, bare, by_ratio).table;
    EXPECT_EQ(ends.text("class"), starts.text("class"));
    double sum = 0;
    for (const EndClass& end : region.classes) {
        sum += end.fraction;
        EXPECT_NEAR(end.fraction, reference.fraction(end.name), 2e-3) << end.name;
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    EXPECT_TRUE(region_figure(region).x.logarithmic);
    EXPECT_FALSE(region_figure(reference).x.logarithmic);
    const SafeSet safe = largest_safe_set(region, "A"), same = largest_safe_set(reference, "A");
    EXPECT_NEAR(safe.box[0] * safe.box[1], same.box[0] * same.box[1], 0.1 * same.box[0] * same.box[1]);
    const ProbabilityMap chances = probability_map(model, by_ratio, 2, 1);
    EXPECT_NEAR(chances.area_mean, probability_map(model, even, 2, 1).area_mean, 2e-2);
    EXPECT_TRUE(probability_figure(chances).maps.front().x_by_ratio);
    by_ratio.axes[0].lower = 0;
    EXPECT_THROW(stability_region(model, by_ratio), core::InputError);
}

TEST(Region, TheChanceToBeSafeSpreadsAboutTheBoundary) {
    core::Table table = test::ref_a_table();
    table.add_numbers("lift_force_sigma", "N", std::vector<double>(table.rows(), 1e-3));
    Model model = test::ref_a_model(0.3, 15);
    model.forces[0].table = tables::ForceTable::fit(
        table, "lift_force", {{tables::RangePolicy::clamp, {}}, tables::FitOptions::Kind::interpolation});
    RegionOptions options = map_of(-0.04, 0.5, 0.06, 24);
    const ProbabilityMap chances = probability_map(model, options, 8, 1);
    const ProbabilityMap again = probability_map(model, options, 8, 1);
    EXPECT_EQ(chances.safe, again.safe);
    EXPECT_GT(chances.area_sigma, 0);
    std::size_t between = 0;
    for (const float chance : chances.safe) {
        between += chance > 0 && chance < 1 ? 1 : 0;
    }
    EXPECT_GT(between, 0U);
}

TEST(Region, SaysThatAModelWithoutDragNeverSettles) {
    const StabilityRegion region = stability_region(test::ref_a_model(0, 0), map_of(-0.04, 0.5, 0.05, 40));
    EXPECT_EQ(region.count(EndKind::attractor), 0U);
    EXPECT_GT(region.count(EndKind::cycle), 100U);
    bool said = false;
    for (const core::Problem& remark : region.remarks) {
        said = said || remark.message.find("never settles") != std::string::npos;
    }
    EXPECT_TRUE(said);
}

TEST(Region, EnergyAndSettlingRulesAgree) {
    // A tiny wave makes the model depend on time: the slow rule must find nearly the same map.
    const Model calm = test::ref_a_model(1.5, 15);
    const Model waved = calm.with_effect(make_use("periodic_disturbance", {{"amplitude", 1e-9}, {"frequency", 1.0}}));
    RegionOptions options = map_of(-0.04, 0.6, 0.06, 30);
    options.duration = 120;
    const StabilityRegion a = stability_region(calm, options), b = stability_region(waved, options);
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.index.size(); ++i) {
        different +=
            a.classes[static_cast<std::size_t>(a.index[i])].name != b.classes[static_cast<std::size_t>(b.index[i])].name
                ? 1
                : 0;
    }
    EXPECT_LT(different, a.index.size() / 50);
}

/// A spring about 0.1 m given by a table from 0.02 to 0.18 m, which holds its end values beyond.
Model short_table_model() {
    core::Table table;
    table.source = "short.csv";
    table.add_numbers("gap", "m", {0.02, 0.06, 0.1, 0.14, 0.18});
    table.add_numbers("lift_force", "N", {8, 4, 0, -4, -8});
    Model model = test::free_model(4, 0, 1e-5, 0);
    tables::FitOptions fit;
    fit.kind = tables::FitOptions::Kind::interpolation;
    model.forces.push_back({"lift_force",
                            "short.csv",
                            "short.csv",
                            tables::ForceTable::fit(table, "lift_force", fit),
                            {Channel::gap},
                            {},
                            1.0});
    model.contact.gap = -0.3;
    return model;
}

TEST(Region, CountsTheMotionsThatLeaveTheTable) {
    // Every start of the map lies inside the table; the motion leaves it where (h - 0.1)^2 + (w/5)^2 > 0.08^2.
    const double half = 0.05, a = 0.08;
    const double stay = 10 * (half * std::sqrt(a * a - half * half) + a * a * std::asin(half / a)) / 0.1;
    const Model still = short_table_model();
    const Model waved = still.with_effect(make_use("periodic_disturbance", {{"amplitude", 1e-12}, {"frequency", 1.0}}));
    for (const Model& model : {still, waved}) {  // decided by energy, and by settling
        RegionOptions options = map_of(0.05, 0.15, 0.5, 60);
        options.escape_gap = 0.6;
        options.duration = 20;
        const StabilityRegion region = stability_region(model, options);
        EXPECT_EQ(region.outside_fraction, 0);
        EXPECT_NEAR(region.path_outside_fraction, 1 - stay, 4e-3);
        double sum = 0;
        for (const EndClass& end : region.classes) {
            sum += end.outside;
            EXPECT_LE(end.outside, end.fraction);
        }
        EXPECT_NEAR(sum, region.path_outside_fraction, 1e-12);
        const bool said = std::any_of(region.remarks.begin(), region.remarks.end(), [](const core::Problem& p) {
            return p.message.find(
                       "of the motions are at some time outside the range of a force table (gap 20 to "
                       "180 mm)") != std::string::npos;
        });
        EXPECT_TRUE(said);
    }
    // Escape at the table's own end is no motion beyond it; those that go down first leave it there.
    const StabilityRegion at_end = stability_region(still, map_of(0.05, 0.15, 0.5, 60));
    for (const EndClass& end : at_end.classes) {
        if (end.kind == EndKind::escape) {
            EXPECT_NEAR(end.outside, end.fraction / 2, 6e-3);
            EXPECT_GT(end.fraction, 0.2);
        }
    }
    EXPECT_EQ(at_end.count(EndKind::contact), 0U);
    RegionOptions narrow = map_of(0.08, 0.12, 0.1, 10);
    narrow.escape_gap = 0.6;
    EXPECT_EQ(stability_region(still, narrow).path_outside_fraction, 0);
}

TEST(Region, MotionsThatLeaveTheTableAreThoseOfCvode) {
    const Model model = test::ref_a_model(0.3, 15, 0.01);
    core::Random random(11);
    core::Table starts;
    std::vector<double> gap, velocity;
    for (int i = 0; i < 150; ++i) {
        gap.push_back(random.uniform(1.2, 2.0));
        velocity.push_back(random.uniform(-0.1, 0.4));
    }
    starts.add_numbers("gap", "m", gap);
    starts.add_numbers("heave_velocity", "m/s", velocity);
    RegionOptions options;
    options.duration = 200;
    options.escape_gap = 2.5;
    const core::Table ends = ends_of_starts(model, starts, options).table;
    TrajectoryOptions each;
    each.duration = 200;
    each.stop_at_contact = true;
    each.escape_gap = 2.5;
    each.output_step = 0.01;
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < gap.size(); ++i) {
        const Trajectory motion = simulate(model, gap[i], velocity[i], {}, each);
        const double highest = *std::max_element(motion.gap.begin(), motion.gap.end());
        if (std::abs(highest - 1.8) < 1e-5) {
            continue;  // too near to the table's end for either
        }
        EXPECT_EQ(ends.numbers("outside_table")[i] > 0, highest > 1.8) << gap[i] << " " << velocity[i];
        beyond += highest > 1.8 ? 1 : 0;
    }
    EXPECT_GT(beyond, 20U);
    EXPECT_LT(beyond, 130U);
}

TEST(Region, RefusesWhatCannotBe) {
    RegionOptions options = map_of(0, 1, 0.1, 10);
    options.axes[1].name = "temperature";
    EXPECT_THROW(stability_region(test::ref_a_model(), options), core::InputError);
    options = map_of(-0.06, 1, 0.1, 10);  // it touches at -0.05
    EXPECT_THROW(stability_region(test::ref_a_model(), options), core::InputError);
    options = map_of(1, 0, 0.1, 10);
    EXPECT_THROW(stability_region(test::ref_a_model(), options), core::InputError);
}

}  // namespace

}  // namespace underbody::dynamics
