// The controller as C closes the loop as this program's own does.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "cases/thesis/published.h"
#include "core/file.h"
#include "surrogates/estimator/control/closed_loop.h"
#include "tests/support/misra.h"

namespace underbody::estimator {
namespace {

using namespace thesis;

bool have(const char* program) {
    return std::system(("command -v " + std::string(program) + " > /dev/null 2>&1").c_str()) == 0;
}

/// The header behind functions of a shared library; `step` is null when it does not compile.
class Compiled {
public:
    Compiled(const std::string& header, const std::filesystem::path& folder, bool velocity_measured,
             const std::string& compiler) {
        static int number = 0;
        const std::string velocity = velocity_measured ? ", velocity" : "";
        core::write_file(folder / "controller.h", header);
        core::write_file(folder / "main.c",
                         "#include \"controller.h\"\nstatic controller_state state;\nvoid begin(void);\nvoid "
                         "begin(void) { controller_start(&state); }\n"
                         "double step(double gap, double velocity);\ndouble step(double gap, double velocity) { "
                         "(void)velocity; return controller_step(&state, gap" +
                             velocity +
                             "); }\ndouble acted(void);\ndouble acted(void) { return state.acted; }\n"
                             "double step_with(double gap, double velocity, double force);\ndouble step_with(double "
                             "gap, double velocity, double force) { (void)velocity; "
                             "return controller_step_with(&state, gap" +
                             velocity + ", force); }\n");
        const auto library = folder / ("controller" + std::to_string(number++) + ".so");
        const std::string command = "cd '" + folder.string() + "' && " + compiler +
                                    " -std=c99 -O2 -ffp-contract=off -Wall -Wextra -Wconversion -Werror -pedantic "
                                    "-fPIC -shared main.c -o " +
                                    library.filename().string() + " 2> errors.txt";
        if (std::system(command.c_str()) != 0) {
            ADD_FAILURE() << core::read_file(folder / "errors.txt");
            return;
        }
        library_ = ::dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
        begin = reinterpret_cast<void (*)()>(::dlsym(library_, "begin"));
        step = reinterpret_cast<double (*)(double, double)>(::dlsym(library_, "step"));
        step_with = reinterpret_cast<double (*)(double, double, double)>(::dlsym(library_, "step_with"));
        acted = reinterpret_cast<double (*)()>(::dlsym(library_, "acted"));
    }
    ~Compiled() {
        if (library_ != nullptr) {
            ::dlclose(library_);
        }
    }
    Compiled(const Compiled&) = delete;
    Compiled& operator=(const Compiled&) = delete;

    void (*begin)() = nullptr;
    double (*step)(double, double) = nullptr;
    double (*step_with)(double, double, double) = nullptr;
    double (*acted)() = nullptr;

private:
    void* library_ = nullptr;
};

/// The plant under the controller in C, beside the program's own loop; the plant moves in as many steps as the loop's.
void closes_the_loop_alike(const SeparatedPlant& plant, const ControlLaw& law, const LoopEstimator& estimator,
                           const LoopOptions& o, const std::string& compiler) {
    core::TemporaryFolder folder;
    const Compiled c(export_controller_c(plant, law, estimator, o, "controller"), folder.path(), o.velocity_measured,
                     compiler);
    ASSERT_NE(c.step, nullptr);
    const LoopRun run = close_loop(plant, law, estimator, o);
    double gap = o.gap, velocity = o.velocity;
    c.begin();
    for (std::size_t k = 0; k < run.time.size(); ++k) {
        ASSERT_NEAR(gap, run.gap[k], 1e-9) << estimator.name << " at " << run.time[k] << " s";
        ASSERT_NEAR(velocity, run.velocity[k], 1e-9) << estimator.name;
        ASSERT_NEAR(c.step(gap, velocity), run.command[k], 1e-9) << estimator.name << " at " << run.time[k] << " s";
        ASSERT_NEAR(c.acted(), run.force[k], 1e-9) << estimator.name << " at " << run.time[k] << " s";
        plant.advance(gap, velocity, c.acted() + (o.disturbance ? o.disturbance(run.time[k]) : 0), o.step, run.time[k]);
    }
    // The same with the force of the actuator measured.
    c.begin();
    for (std::size_t k = 0; k < run.time.size(); ++k) {
        ASSERT_NEAR(c.step_with(run.gap[k], run.velocity[k], k == 0 ? 0 : run.force[k - 1]), run.command[k], 1e-9);
    }
}

LoopOptions loop_options() {
    LoopOptions o;
    o.gap = 0.12;
    o.velocity = 0.03;
    o.duration = 40;
    o.disturbance = [](double t) { return 2e-3 * std::sin(0.7 * t); };
    return o;
}

class ControllerAsC : public ::testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        if (!have(GetParam())) {
            GTEST_SKIP() << "skipped: " << GetParam() << " is not installed; the controller was not compiled";
        }
    }
};

TEST_P(ControllerAsC, ClosesTheLoopAsTheProgramDoes) {
    const SeparatedPlant plant = reference_plant();
    ControlLaw law = hold_at(0.02, plant.virtual_mass, -1, -2);
    law.limit = 0.03;
    for (const std::string name : {"disturbance", "reduced", "full", "latent", "kalman", "none"}) {
        for (const auto feedback : {Feedback::measured, Feedback::estimated}) {
            LoopOptions o = loop_options();
            o.feedback = feedback;
            const LoopEstimator estimator = design_loop_estimator(name, plant, {});
            ASSERT_GT(close_loop(plant, law, estimator, o).saturated, 0) << "the limit is tried too";
            ASSERT_NO_FATAL_FAILURE(closes_the_loop_alike(plant, law, estimator, o, GetParam()));
        }
    }
}

TEST_P(ControllerAsC, FollowsTheActuatorThatTheModelDeclares) {
    SeparatedPlant plant = reference_plant();
    ControlLaw law = hold_at(0.02, plant.virtual_mass, -1, -2);
    law.limit = 0.05;
    for (const double delay : {0.0, 0.02, 0.05, 0.31}) {
        plant.actuator = {delay, 2e-4, 0.9, 0.1};
        LoopOptions o = loop_options();
        o.actuator_lag = 0.05;
        ASSERT_NO_FATAL_FAILURE(
            closes_the_loop_alike(plant, law, design_loop_estimator("disturbance", plant, {}), o, GetParam()));
    }
}

TEST_P(ControllerAsC, HoldsWithoutAVelocitySensor) {
    const SeparatedPlant plant = reference_plant();
    const ControlLaw law = hold_at(0.05, plant.virtual_mass, -1, -1);
    LoopDesign design;
    design.velocity_measured = false;
    LoopOptions o = loop_options();
    o.velocity_measured = false;
    o.feedback = Feedback::estimated;
    for (const std::string name : {"kalman", "full"}) {
        ASSERT_NO_FATAL_FAILURE(
            closes_the_loop_alike(plant, law, design_loop_estimator(name, plant, design), o, GetParam()));
    }
}

TEST_P(ControllerAsC, LeavesOutReadingsThatAreNoFiniteNumbers) {
    const SeparatedPlant plant = reference_plant();
    ControlLaw law = hold_at(0.02, plant.virtual_mass, -1, -2);
    law.limit = 0.03;
    const double nothing = std::nan(""), endless = std::numeric_limits<double>::infinity();
    for (const std::string name : {"disturbance", "kalman", "none"}) {
        const LoopOptions o = loop_options();
        core::TemporaryFolder folder;
        const Compiled c(export_controller_c(plant, law, design_loop_estimator(name, plant, {}), o, "controller"),
                         folder.path(), true, GetParam());
        ASSERT_NE(c.step, nullptr);
        c.begin();
        EXPECT_EQ(c.step(nothing, 0), 0) << "before the first reading nothing is commanded";
        const double first = c.step(0.12, 0.03);
        ASSERT_NE(first, 0);
        for (const auto& [gap, velocity] :
             {std::pair{nothing, 0.0}, {0.12, nothing}, {endless, 0.0}, {0.12, -endless}}) {
            EXPECT_EQ(c.step(gap, velocity), first) << name << ", " << gap << ", " << velocity;
        }
        EXPECT_TRUE(std::isfinite(c.step_with(0.12, 0.03, nothing)));
        double gap = o.gap, velocity = o.velocity;
        c.begin();
        for (int k = 0; k < 4000; ++k) {  // one reading in twenty is lost, and the gap is held all the same
            const double command = c.step(k % 20 == 7 ? nothing : gap, velocity);
            ASSERT_TRUE(std::isfinite(command)) << name << ", sample " << k;
            plant.advance(gap, velocity, c.acted(), o.step, k * o.step);
        }
        EXPECT_NEAR(gap, 0.02, 2e-3) << name;
    }
}

INSTANTIATE_TEST_SUITE_P(Compilers, ControllerAsC, ::testing::Values("gcc", "clang"));

TEST(ControllerInC, IsRefusedWhereItIsNoLinearFilter) {
    const SeparatedPlant plant = reference_plant();
    const ControlLaw law = hold_at(0.02, plant.virtual_mass, -1, -2);
    for (const std::string name : {"extended", "truth"}) {
        EXPECT_THROW((void)export_controller_c(plant, law, design_loop_estimator(name, plant, {}), {}, "c"),
                     core::InputError)
            << name;
    }
    EXPECT_THROW((void)export_controller_c(plant, law, design_loop_estimator("disturbance", plant, {}), {}, "2c"),
                 core::InputError);
    LoopOptions slow;
    slow.step = 0.1;
    EXPECT_THROW((void)export_controller_c(plant, law, design_loop_estimator("disturbance", plant, {}), slow, "c"),
                 core::InputError)
        << "another sample time";
}

TEST(ControllerInC, SaysWhatItIsMadeOf) {
    const SeparatedPlant plant = reference_plant();
    const std::string text =
        export_controller_c(plant, hold_at(0.02, plant.virtual_mass, -1, -2),
                            design_loop_estimator("disturbance", plant, {}), {}, "hold", {"model.toml", "odd */ name"});
    EXPECT_THAT(text, ::testing::HasSubstr("holds a gap of 0.02 m, sampled every 0.02 s"));
    EXPECT_THAT(text, ::testing::HasSubstr("made from: model.toml"));
    EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("odd */")));
}

TEST(ControllerInC, KeepsToTheRequiredRulesOfMisra) {
    if (!have("cppcheck") || !have("python3")) {
        GTEST_SKIP() << "skipped: cppcheck (with python3 for its addon) is not installed";
    }
    const core::TemporaryFolder folder;
    for (const std::string name : {"disturbance", "reduced", "full", "latent", "kalman", "none"}) {
        SeparatedPlant plant = reference_plant();
        LoopOptions o = loop_options();
        if (name == "disturbance") {
            plant.actuator = {0.05, 2e-4, 0.9, 0.1};
            o.actuator_lag = 0.05;
        }
        ControlLaw law = hold_at(0.02, plant.virtual_mass, -1, -2);
        law.limit = 0.03;
        core::write_file(folder.path() / (name + ".h"),
                         export_controller_c(plant, law, design_loop_estimator(name, plant, {}), o, name));
        core::write_file(folder.path() / (name + ".c"),
                         "#include \"" + name + ".h\"\nint main(void);\nint main(void)\n{\n    return 0;\n}\n");
        const test::MisraFindings found = test::misra_findings(folder.path(), name);
        EXPECT_THAT(found.required, ::testing::IsEmpty()) << name << "\n" << found.text;
        EXPECT_FALSE(found.rules.empty()) << "the addon ran: it names advisory rules\n" << found.text;
    }
}

/// With no estimator the sensors are all there is: the feedback on estimates is that on measurements.
TEST(HoldingAGap, OnEstimatesWithoutAnEstimatorTakesTheSensors) {
    const SeparatedPlant plant = reference_plant();
    const ControlLaw law = hold_at(0.02, plant.virtual_mass, -1, -2);
    LoopOptions o = loop_options();
    const LoopRun measured = close_loop(plant, law, LoopEstimator::nothing(), o);
    o.feedback = Feedback::estimated;
    EXPECT_EQ(close_loop(plant, law, LoopEstimator::nothing(), o).gap, measured.gap);
}

}  // namespace
}  // namespace underbody::estimator
