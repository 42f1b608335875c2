// What the estimator refuses, with what it says: shapes, ranges, names and what cannot be observed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cases/thesis/published.h"
#include "core/file.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/estimator/control/loop_region.h"
#include "surrogates/estimator/model/moments.h"
#include "surrogates/estimator/model/training.h"
#include "surrogates/estimator/observe/observer.h"
#include "surrogates/estimator/observe/surface_bank.h"

namespace underbody::estimator {
namespace {

using namespace thesis;
using testing::AllOf;
using testing::HasSubstr;

/// The message of the core::Error that `act` ends with, with its hint; "accepted" when it ends well.
template <class Act>
std::string refusal(Act&& act) {
    try {
        act();
    } catch (const core::Error& error) {
        return error.message() + " | " + error.hint();
    }
    return "accepted";
}

AugmentedModel published() { return published_8_47(); }

TEST(Refusals, OfALoopThatCannotBe) {
    const SeparatedPlant plant = reference_plant();
    const ControlLaw law = hold_at(0.02, plant.virtual_mass, -1, -1);
    const auto said = [&](const LoopEstimator& e, const LoopOptions& o) {
        return refusal([&] { (void)close_loop(plant, law, e, o); });
    };
    LoopOptions o;
    o.duration = 1;
    EXPECT_EQ(said(LoopEstimator::nothing(), o), "accepted");
    LoopOptions short_one = o;
    short_one.duration = o.step;
    EXPECT_THAT(said(LoopEstimator::nothing(), short_one), HasSubstr("a duration longer than it"));
    LoopOptions stopped = o;
    stopped.step = 0;
    EXPECT_THAT(said(LoopEstimator::nothing(), stopped), HasSubstr("a positive sample time"));
    LoopOptions blind = o;
    blind.velocity_measured = false;
    EXPECT_THAT(said(LoopEstimator::nothing(), blind),
                AllOf(HasSubstr("needs a heave velocity"), HasSubstr("extended, kalman or full")));
    blind.feedback = Feedback::estimated;
    EXPECT_THAT(said(LoopEstimator::nothing(), blind), HasSubstr("neither a sensor nor the estimator 'none'"));
    blind.feedback = Feedback::truth;
    EXPECT_EQ(said(LoopEstimator::nothing(), blind), "accepted");
    LoopEstimator empty;
    empty.source = ForceSource::filter;
    EXPECT_THAT(said(empty, o), HasSubstr("forces of a filter, but there is none"));
    const AugmentedModel m = published();
    LinearFilter filter = reduced_observer(m, reduced_gain(m, {-3, -4}), 2 * o.step).filter;
    EXPECT_THAT(said(LoopEstimator::with(filter), o), HasSubstr("the filter runs at"));
    filter = reduced_observer(m, reduced_gain(m, {-3, -4}), o.step).filter;
    EXPECT_THAT(said(LoopEstimator::with(filter), blind), HasSubstr("does not measure heave_velocity"));
    filter.measured.front() = "pitch";
    EXPECT_THAT(said(LoopEstimator::with(filter), o), HasSubstr("does not measure pitch"));
    filter.phi = Matrix(1, 1);
    EXPECT_THAT(refusal([&] { FilterRunner runner(filter); }), HasSubstr("the filter's "));
}

TEST(Refusals, OfEstimatorsByName) {
    const SeparatedPlant plant = reference_plant();
    const auto said = [&](const std::string& name, const LoopDesign& design) {
        return refusal([&] { (void)design_loop_estimator(name, plant, design); });
    };
    EXPECT_THAT(said("kalmann", {}), AllOf(HasSubstr("there is no estimator 'kalmann'"), HasSubstr("'kalman'")));
    LoopDesign still;
    still.rate = 0;
    EXPECT_THAT(said("disturbance", still), HasSubstr("the rate of the estimator must be positive"));
    LoopDesign blind;
    blind.velocity_measured = false;
    EXPECT_THAT(said("disturbance", blind), HasSubstr("disturbance"));
    EXPECT_EQ(said("extended", blind), "accepted");
    const LoopOptions o;
    EXPECT_THAT(refusal([&] {
                    (void)export_controller_c(plant, hold_at(0.02, plant.virtual_mass, -1, -1),
                                              LoopEstimator::true_force(), o, "hold");
                }),
                HasSubstr("the estimator 'truth'"));
    EXPECT_THAT(refusal([&] {
                    (void)export_controller_c(plant, hold_at(0.02, plant.virtual_mass, -1, -1),
                                              LoopEstimator::nothing(), o, "2hold");
                }),
                HasSubstr("'2hold'"));
    LoopRegionOptions region;
    region.axes = {{"gap", 0, 0.3}, {"pitch", -0.1, 0.1}};
    const ControlLaw law = hold_at(0.02, plant.virtual_mass, -1, -1);
    EXPECT_THAT(refusal([&] { (void)loop_region(plant, law, LoopEstimator::nothing(), o, region); }),
                HasSubstr("the axes gap and heave_velocity"));
    region.axes[1].name = "heave_velocity";
    EXPECT_THAT(refusal([&] { (void)loop_probability(plant, law, LoopEstimator::nothing(), o, region, 0); }),
                HasSubstr("at least one draw"));
}

TEST(Refusals, OfSamplesThatMomentsCannotBeMadeOf) {
    const auto said = [](const std::vector<double>& values, std::size_t count, std::size_t channels) {
        return refusal([&] {
            (void)moments(SampleView::samples_in_rows(values.data(), count, channels), {"gap", "input_force"});
        });
    };
    EXPECT_EQ(said({1, 2, 3, 4}, 2, 2), "accepted");
    EXPECT_THAT(said({}, 0, 2), HasSubstr("there are no samples"));
    EXPECT_THAT(said(std::vector<double>(65, 1.0), 1, 65), HasSubstr("at most 64 channels, not 65"));
    EXPECT_THAT(said({1, 1e200, 2, -1e200}, 2, 2), HasSubstr("their squares overflow"));
    EXPECT_THAT(said({1, 2, 3, INFINITY}, 2, 2), HasSubstr("sample 2 of channel 'input_force' is infinite"));
    const core::TemporaryFolder folder("samples");
    const auto of_file = [&](const std::string& bytes) {
        core::write_file(folder.path() / "s.npy", bytes);
        return refusal([&] { (void)moments_of_file(folder.path() / "s.npy"); });
    };
    EXPECT_THAT(of_file("no numbers at all"), HasSubstr("a NumPy .npy file of float64 in C order"));
    const std::vector<double> two{1, 2, 3, 4};
    write_npy(folder.path() / "good.npy", two.data(), 2, 2);
    const std::string good = core::read_file(folder.path() / "good.npy");
    EXPECT_EQ(of_file(good), "accepted");
    EXPECT_NE(of_file(good.substr(0, good.size() - 8)), "accepted") << "a value less than the shape says";
    std::string single = good;
    single.replace(single.find("<f8"), 3, "<f4");
    EXPECT_NE(of_file(single), "accepted");
    std::string columns = good;
    columns.replace(columns.find("False"), 5, "True ");
    EXPECT_NE(of_file(columns), "accepted") << "in Fortran order";
}

TEST(Refusals, OfTrainingRegionsThatCannotBe) {
    SeparatedPlant plant = reference_plant();
    plant.contact_gap = 0;
    const auto said = [&](void (*change)(TrainingOptions&)) {
        TrainingOptions o;
        o.gap_lower = 0.01;
        o.gap_upper = 0.3;
        o.velocity_lower = -0.03;
        o.velocity_upper = 0.03;
        o.samples = 100;
        change(o);
        return refusal([&] { (void)training_set(plant, o); });
    };
    EXPECT_EQ(said([](TrainingOptions&) {}), "accepted");
    EXPECT_THAT(said([](TrainingOptions& o) { o.gap_upper = o.gap_lower; }), HasSubstr("the training region is empty"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.velocity_upper = -0.1; }), HasSubstr("the training region is empty"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.gap_lower = -1; }), HasSubstr("below the contact gap"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.samples = 0; }), HasSubstr("4,000,000 samples, not 0"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.interval = 0; }), HasSubstr("must be positive"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.focus_share = 1.5; }), HasSubstr("a share within 0..1"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.focus_share = 0.5; }), HasSubstr("a band of gaps"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.auxiliaries = {"ground_forse"}; }),
                AllOf(HasSubstr("'ground_forse'"), HasSubstr("ground_force")));
}

TEST(Refusals, OfPolesThatCannotBePlaced) {
    const Matrix a = Matrix::diagonal({-1, -2, -3});
    Matrix seen(1, 3), blind(1, 3), two(2, 3);
    seen(0, 0) = seen(0, 1) = seen(0, 2) = 1;
    blind(0, 0) = blind(0, 1) = 1;
    two(0, 0) = two(1, 1) = two(1, 2) = 1;
    const std::vector<std::string> names{"gap", "heave_velocity", "force"};
    EXPECT_THAT(refusal([&] { (void)place_single_output(Matrix(2, 3), seen, {-1, -2, -3}); }), HasSubstr("square"));
    Matrix wild = a;
    wild(0, 0) = NAN;
    EXPECT_THAT(refusal([&] { (void)place_single_output(wild, seen, {-1, -2, -3}); }), HasSubstr("not finite"));
    EXPECT_THAT(refusal([&] { (void)place_single_output(a, seen, {-1, -2}); }), HasSubstr("are wanted: 3"));
    EXPECT_THAT(refusal([&] {
                    (void)place_single_output(a, blind, {-4, -5, -6}, names);
                }),
                AllOf(HasSubstr("cannot see the direction"), HasSubstr("force")));
    EXPECT_THAT(refusal([&] {
                    (void)place_single_output(a, seen, {{-4, 1}, {-4, 2}, {-5, 0}});
                }),
                HasSubstr("conjugate pairs"));
    EXPECT_THAT(refusal([&] { (void)place(a, two, {-4, -5}); }), HasSubstr("are wanted: 3"));
    EXPECT_THAT(refusal([&] { (void)place(a, blind, {-4, -5, -6}, names); }), HasSubstr("cannot see the direction"));
    EXPECT_THAT(refusal([&] { (void)place(a, two, {-4, -4, -4}); }), HasSubstr("repeats more often"));
    EXPECT_EQ(direction_text({0.5, -0.5, 0}, {"gap"}), "0.5 gap - 0.5 state 2");
    EXPECT_EQ(direction_text({-0.5, 0, 0.5}, {}), "-0.5 state 1 + 0.5 state 3");
    EXPECT_THAT(refusal([&] { (void)discrete_lyapunov(Matrix::identity(2), Matrix::identity(2)); }),
                HasSubstr("inside the unit circle"));
    // a mode that grows and that no sensor sees is named
    Matrix phi = Matrix::identity(2), c(1, 2);
    phi(1, 1) = 1.1;
    c(0, 0) = 1;
    EXPECT_THAT(refusal([&] { (void)discrete_riccati(phi, c, Matrix::identity(2), Matrix::identity(1), names); }),
                HasSubstr("cannot see the direction 1 heave_velocity"));
}

TEST(Refusals, OfObserversOfAModel) {
    const AugmentedModel m = published();
    EXPECT_THAT(refusal([&] { (void)m.state("grund_force"); }), HasSubstr("'ground_force'"));
    EXPECT_THAT(refusal([&] { (void)full_gain(m, {}, {-1, -2, -3, -4}); }), HasSubstr("at least one sensor"));
    EXPECT_THAT(refusal([&] { (void)full_gain(m, {"pitch"}, {-1, -2, -3, -4}); }), HasSubstr("'pitch'"));
    const Matrix gain = reduced_gain(m, {-3, -4});
    EXPECT_THAT(refusal([&] { (void)reduced_observer(m, gain, 0); }), HasSubstr("must be positive"));
    EXPECT_THAT(refusal([&] { (void)reduced_observer(m, -1.0 * gain, 0.02); }), HasSubstr("poles of its error"));
    EXPECT_THAT(refusal([&] { (void)disturbance_observer(3, 0, 0, 0.02); }), HasSubstr("must be positive"));
    EXPECT_THAT(refusal([&] { (void)kalman_observer(m, {"gap"}, {1}, {1e-3}, 0.02); }),
                HasSubstr("one process density per state"));
    EXPECT_THAT(refusal([&] {
                    (void)kalman_observer(m, {"gap"}, {1, 1, 1, 1}, {0}, 0.02);
                }),
                HasSubstr("the noise of a sensor must be positive"));
    LearnOptions o;
    o.offset = OffsetMode::equilibrium;
    o.point = {1};
    const TrainingSet set = [] {
        TrainingOptions few;
        few.samples = 500;
        return training_set(reference_plant(), few);
    }();
    EXPECT_THAT(refusal([&] { (void)learn(moments(set.view()), set.layout, o); }),
                HasSubstr("one value per input and state"));
    Layout other = set.layout;
    other.states.pop_back();
    EXPECT_THAT(refusal([&] { (void)learn(moments(set.view()), other, {}); }), HasSubstr("the samples have"));
    LearnOptions high;
    high.order = 99;
    EXPECT_THAT(refusal([&] { (void)learn(moments(set.view()), set.layout, high); }), HasSubstr("order 99"));
    const std::vector<double> same(set.layout.channels() * 40, 0.5);
    EXPECT_THAT(refusal([&] {
                    (void)learn(moments(SampleView::samples_in_rows(same.data(), 40, set.layout.channels())),
                                set.layout, {});
                }),
                HasSubstr("nothing to learn"));
    EXPECT_THAT(refusal([&] {
                    (void)heave_rows(Layout{{"input_force"}, {"heave_velocity", "gap"}, 2}, 3, 0);
                }),
                HasSubstr("total_force, or ground_force and drag_force"));
    EXPECT_THAT(refusal([&] {
                    (void)heave_rows(Layout{{"input_force"}, {"total_force"}, 0}, 3, 0);
                }),
                HasSubstr("heave_velocity and gap"));
}

TEST(Refusals, OfTrainingOutsideThePlant) {
    SeparatedPlant plant = reference_plant();
    plant.contact_gap = 0;
    const auto said = [&](auto&& change) {
        TrainingOptions o;
        o.samples = 50;
        change(o);
        return refusal([&] { (void)training_set(plant, o); });
    };
    EXPECT_EQ(said([](TrainingOptions&) {}), "accepted");
    EXPECT_THAT(said([](TrainingOptions& o) { o.auxiliaries = {"drag_forze"}; }), HasSubstr("'drag_force'"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.gap_lower = o.gap_upper; }), HasSubstr("region is empty"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.velocity_upper = -1; }), HasSubstr("region is empty"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.gap_lower = -1; }), HasSubstr("below the contact gap"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.samples = 0; }), HasSubstr("between 1 and 4,000,000"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.interval = 0; }), HasSubstr("must be positive"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.focus_share = 2; }), HasSubstr("a share within 0..1"));
    EXPECT_THAT(said([](TrainingOptions& o) { o.mesh_inputs = o.mesh_velocities = o.mesh_gaps = 2000; }),
                HasSubstr("more than 4,000,000 points"));
    EXPECT_THAT(refusal([&] { (void)equilibrium_point(plant, Layout::heave(), 0.9, 1.0); }),
                HasSubstr("no stable equilibrium between"));
}

TEST(Refusals, OfRunsThatCannotBeFiltered) {
    const SeparatedPlant plant = reference_plant();
    const RunSignals good{{0, 0.1, 0.2, 0.3}, {0.1, 0.1, 0.1, 0.1}, {}, {0, 0, 0, 0}, false};
    const auto said = [&](auto&& change) {
        RunSignals run = good;
        change(run);
        return refusal([&] { (void)extended_filter(plant, run, {}); });
    };
    EXPECT_EQ(said([](RunSignals&) {}), "accepted");
    EXPECT_THAT(said([](RunSignals& r) { r.gap.pop_back(); }), HasSubstr("differ in length"));
    EXPECT_THAT(said([](RunSignals& r) { r.velocity = {0}; }), HasSubstr("differ in length"));
    EXPECT_THAT(said([](RunSignals& r) { r.input = {0}; }), HasSubstr("differ in length"));
    EXPECT_THAT(said([](RunSignals& r) { r.gap[0] = r.gap[1] = NAN; }), HasSubstr("at least three measured gaps"));
    EXPECT_THAT(said([](RunSignals& r) { r.time[2] = 0.1; }), HasSubstr("does not ascend"));
    EXPECT_THAT(said([](RunSignals& r) { r.input[1] = NAN; }), HasSubstr("a missing value"));
    FilterNoise silent;
    silent.gap = 0;
    EXPECT_THAT(refusal([&] { (void)extended_filter(plant, good, silent); }),
                HasSubstr("the noise of the gap sensor must be positive"));
    EXPECT_THAT(refusal([&] { (void)identify_surface({{"a", plant}}, good, {}); }), HasSubstr("at least two surfaces"));
    SurfaceOptions odd;
    odd.prior = {1};
    EXPECT_THAT(refusal([&] {
                    (void)identify_surface({{"a", plant}, {"b", plant}}, good, odd);
                }),
                HasSubstr("one probability per surface"));
    odd.prior = {2, -1};
    EXPECT_THAT(refusal([&] {
                    (void)identify_surface({{"a", plant}, {"b", plant}}, good, odd);
                }),
                HasSubstr("one probability per surface"));
}

}  // namespace
}  // namespace underbody::estimator
