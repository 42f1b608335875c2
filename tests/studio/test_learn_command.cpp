// underbody learn and underbody estimate as a user runs them.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/file.h"
#include "core/random.h"
#include "core/table.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

// A model and two runs of it under known inputs, simulated here with its own small steps.
class LearnAndEstimate : public ::testing::Test {
protected:
    static constexpr double mass = 4;
    static double lift(double h) { return 0.02 * std::sin(2 * std::numbers::pi * h); }

    void SetUp() override {
        std::ofstream(folder() / "model.toml") << "[vehicle]\nmass = 2.2\nadded_mass_heave = 1.8\nnet_weight = 0.002\n"
                                                  "[drag.heave]\nlinear = 0.02\nquadratic = 6\n"
                                                  "[[force]]\nquantity = \"lift_force\"\ntable = \"lift.csv\"\n";
        std::ofstream table(folder() / "lift.csv");
        table << "gap [m], lift_force [N]\n";
        for (int i = 0; i <= 300; ++i) {
            table << i * 0.004 << ", " << lift(i * 0.004) << "\n";
        }
        std::filesystem::create_directories(folder() / "runs");
        std::ofstream(folder() / "runs/dataset.toml")
            << "kind = \"time_series\"\n[noise]\ngap = \"0.1 mm\"\n[[run]]\nfile = \"a.csv\"\n"
               "[[run]]\nfile = \"b.csv\"\n";
        write_run("a.csv", 0.6, 1);
        write_run("b.csv", 0.45, 2);
    }

    void write_run(const char* name, double h, std::uint64_t seed) {
        core::Random random(seed);
        std::ofstream out(folder() / "runs" / name);
        out.precision(12);
        out << "time [s], gap [m], input_force [N]\n";
        double w = 0;
        for (int k = 0; k <= 1500; ++k) {
            const double t = 0.02 * k, u = 0.002 + 0.003 * std::sin(0.5 * t);
            out << t << ", " << h + 1e-4 * random.normal() << ", " << u << "\n";
            truth_[name].push_back(lift(h) - 0.02 * w - 6 * w * std::abs(w));
            for (int i = 0; i < 20; ++i) {
                const double now = 0.002 + 0.003 * std::sin(0.5 * (t + 0.001 * i));
                w += 0.001 * (lift(h) - 0.02 * w - 6 * w * std::abs(w) + now - 0.002) / mass;
                h += 0.001 * w;
            }
        }
    }

    std::filesystem::path folder() const { return folder_.path(); }
    core::TemporaryFolder folder_;
    std::map<std::string, std::vector<double>> truth_;
};

TEST_F(LearnAndEstimate, PrintsTheModelWithTheKeysOthersRead) {
    const auto run = test::run_underbody({"learn", "model.toml", "--method", "grid", "--order", "6", "--region",
                                          "gap=0:1.2,heave_velocity=-0.03:0.03", "--scan", "--json"},
                                         folder());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto json = nlohmann::json::parse(run.output);
    EXPECT_EQ(json.at("order"), 6);
    EXPECT_EQ(json.at("rank"), 7);
    EXPECT_EQ(json.at("eigenvalues").size(), 9U);
    EXPECT_EQ(json.at("states"), (std::vector<std::string>{"heave_velocity", "gap", "ground_force", "drag_force"}));
    EXPECT_EQ(json.at("inputs"), std::vector<std::string>{"input_force"});
    EXPECT_NEAR(json.at("A")[0][2].get<double>(), 1 / mass, 1e-7);
    EXPECT_NEAR(json.at("A")[0][3].get<double>(), -1 / mass, 1e-7);
    EXPECT_NEAR(json.at("A")[1][0].get<double>(), 1, 1e-7);
    EXPECT_NEAR(json.at("B")[0][0].get<double>(), 1 / mass, 1e-7);
    EXPECT_NEAR(json.at("offset")[0].get<double>(), -0.002 / mass, 1e-7);
    EXPECT_EQ(json.at("scan").size(), 9U);
    EXPECT_EQ(json.at("separability").at("labels")[0], "model-dependent");
}

TEST_F(LearnAndEstimate, LearnsAlongTrajectoriesFromRunsAndFromAStreamedFile) {
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{"--method", "time", "--samples", "5000"},
          {"--data", "runs"},
          {"--auxiliaries", "total_force"},
          {"--samples-out", "s.npy"},
          {"--moments-of", "s.npy"},
          {"--method", "dmdc"},
          {"--method", "edmd", "--step", "0.05 s", "--compare", "--plot", "peers.png"},
          {"--data", "runs", "--compare", "--horizon", "5 s", "--auxiliaries", "total_force"},
          {"--data", "runs", "--method", "edmd", "--auxiliaries", "gap_squared"},
          {"--correction", "p3"},
          {"--offset", "equilibrium"}}) {
        std::vector<std::string> arguments{"learn", "model.toml", "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const auto run = test::run_underbody(arguments, folder());
        ASSERT_EQ(run.exit_code, 0) << more[0] << run.errors;
        EXPECT_TRUE(nlohmann::json::parse(run.output).contains("A"));
    }
}

TEST_F(LearnAndEstimate, HoldsAGapAndDrawsWhereTheSensorsAreBlind) {
    const auto with =
        test::run_underbody({"control", "model.toml", "--hold", "0.6", "--from", "gap=0.5", "--json"}, folder());
    ASSERT_EQ(with.exit_code, 0) << with.errors;
    EXPECT_NEAR(nlohmann::json::parse(with.output).at("final_gap").get<double>(), 0.6, 1e-4);
    const auto limited =
        test::run_underbody({"control", "model.toml", "--hold", "0.6", "--from", "gap=0.5", "--observer", "reduced",
                             "--limit", "20 mN", "--lag", "0.1 s", "--gap-noise", "0.1 mm", "--out", "loop.csv"},
                            folder());
    ASSERT_EQ(limited.exit_code, 0) << limited.errors;
    EXPECT_GT(core::read_csv(folder() / "loop.csv").rows(), 100U);
    EXPECT_EQ(test::run_underbody({"control", "model.toml", "--hold", "0.6", "--from", "gap=0.5", "--observer", "ful"},
                                  folder())
                  .exit_code,
              2);
    EXPECT_EQ(
        test::run_underbody({"control", "model.toml", "--hold", "0.6", "--from", "gap=0.5", "--limit", "-1"}, folder())
            .exit_code,
        2);
    const auto all = test::run_underbody(
        {"control", "model.toml", "--hold", "0.6", "--from", "gap=0.5", "--for", "40 s", "--compare", "--json"},
        folder());
    ASSERT_EQ(all.exit_code, 0) << all.errors;
    const auto estimators = nlohmann::json::parse(all.output).at("estimators");
    EXPECT_EQ(estimators.size(), 8U);
    for (const auto& e : estimators) {
        EXPECT_NEAR(e.at("final_gap").get<double>(), 0.6, e.at("estimator") == "none" ? 5e-3 : 2e-4)
            << e.at("estimator");
        EXPECT_EQ(e.at("total_force_error").is_null(), e.at("estimator") == "none") << "what nobody estimates";
    }
    const auto region = test::run_underbody({"control",    "model.toml", "--hold",
                                             "0.6",        "--from",     "gap=0.5",
                                             "--observer", "extended",   "--no-velocity",
                                             "--limit",    "20 mN",      "--gap-noise",
                                             "0.1 mm",     "--step",     "0.1 s",
                                             "--columns",  "8",          "--rows",
                                             "6",          "--axes",     "gap=0.3:0.9,heave_velocity=-0.02:0.02",
                                             "--region",   "loop.png",   "--json"},
                                            folder());
    ASSERT_EQ(region.exit_code, 0) << region.errors;
    double sum = 0;
    const auto classes = nlohmann::json::parse(region.output).at("region").at("classes");
    for (const auto& c : classes) {
        sum += c.at("fraction").get<double>();
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    EXPECT_TRUE(std::filesystem::exists(folder() / "loop.png"));
    const auto blind = test::run_underbody(
        {"estimate", "model.toml", "--data", "runs", "--blind-zones", "blind.png", "--json"}, folder());
    ASSERT_EQ(blind.exit_code, 0) << blind.errors;
    EXPECT_TRUE(std::filesystem::exists(folder() / "blind.png"));
    EXPECT_TRUE(nlohmann::json::parse(blind.output).at("along_gap").at("consistency").contains("nees"));
}

TEST_F(LearnAndEstimate, RefusesWrongRequestsWithThePlaceAndAHint) {
    EXPECT_EQ(test::run_underbody({"learn", "model.toml", "--method", "gird"}, folder()).exit_code, 2);
    const auto order = test::run_underbody({"learn", "model.toml", "--order", "8", "--json"}, folder());
    EXPECT_EQ(order.exit_code, 3);
    EXPECT_EQ(nlohmann::json::parse(order.output).at("error").at("kind"), "order");
    EXPECT_EQ(test::run_underbody({"learn", "model.toml", "--auxiliaries", "ground_forse"}, folder()).exit_code, 3);
    EXPECT_EQ(test::run_underbody({"learn", "missing.toml"}, folder()).exit_code, 3);
    EXPECT_EQ(test::run_underbody({"learn", "model.toml", "--region", "gap=-1:0.2"}, folder()).exit_code, 3);
    EXPECT_EQ(
        test::run_underbody({"estimate", "model.toml", "--data", "runs", "--observer", "reduced"}, folder()).exit_code,
        3);
    EXPECT_EQ(test::run_underbody({"estimate", "model.toml", "--data", "runs", "--poles", "x"}, folder()).exit_code, 2);
}

TEST_F(LearnAndEstimate, AModelWithoutATableIsAskedForItsGaps) {
    std::ofstream(folder() / "bare.toml") << "[vehicle]\nmass = 2.2\nadded_mass_heave = 1.8\nnet_weight = 0.002\n"
                                             "[drag.heave]\nlinear = 0.02\nquadratic = 6\n";
    const auto run = test::run_underbody({"learn", "bare.toml"}, folder());
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.errors.find("--region gap=0:0.1"), std::string::npos) << run.errors;
}

TEST_F(LearnAndEstimate, EstimatesTheForcesWithTheirErrorsAndLabels) {
    const auto run =
        test::run_underbody({"estimate", "model.toml", "--data", "runs", "--out", "est.csv", "--json"}, folder());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto json = nlohmann::json::parse(run.output);
    EXPECT_EQ(json.at("labels").at("total_force"), "observed");
    EXPECT_EQ(json.at("labels").at("ground_force"), "model-dependent");
    const core::Table table = core::read_csv(folder() / "est.csv");
    const auto& total = table.numbers("total_force");
    const auto& sigma = table.numbers("total_force_sigma");
    const auto& truth = truth_.at("a.csv");
    double square = 0;
    int inside = 0, n = 0;
    for (std::size_t k = 300; k < truth.size(); ++k, ++n) {
        square += (total[k] - truth[k]) * (total[k] - truth[k]);
        inside += std::abs(total[k] - truth[k]) < 1.96 * sigma[k] ? 1 : 0;
    }
    EXPECT_LT(std::sqrt(square / n), 1e-3);
    EXPECT_GT(inside, 0.8 * n);
    const auto kalman = test::run_underbody({"estimate", "model.toml", "--data", "runs", "--observer", "kalman",
                                             "--export-c", "observer.h", "--out", "k.csv"},
                                            folder());
    ASSERT_EQ(kalman.exit_code, 0) << kalman.errors;
    EXPECT_TRUE(std::filesystem::exists(folder() / "observer.h"));
    const auto surfaces = test::run_underbody({"estimate", "model.toml", "--data", "runs", "--surface",
                                               "smooth=model.toml", "--surface", "other=model.toml", "--json"},
                                              folder());
    EXPECT_EQ(surfaces.exit_code, 0) << surfaces.errors;
}

}  // namespace
}  // namespace underbody
