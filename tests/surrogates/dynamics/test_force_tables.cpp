// The forces of a model as tables are the forces that it simulates: between the set points, over every axis, with
// effects, errors and ranges.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "surrogates/dynamics/model/force_error.h"
#include "surrogates/dynamics/model/force_tables.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/tables/fit/table_batch.h"
#include "tests/surrogates/dynamics/models.h"

namespace underbody::dynamics {

namespace {

using ::testing::HasSubstr;

tables::ForceTable grid(const std::string& quantity,
                        const std::vector<std::pair<std::string, std::vector<double>>>& axes,
                        double (*f)(const double*), double sigma,
                        tables::FitOptions::Kind kind = tables::FitOptions::Kind::interpolation) {
    core::Table table;
    table.source = quantity;
    std::size_t count = 1;
    for (const auto& [name, points] : axes) {
        count *= points.size();
    }
    std::vector<std::vector<double>> columns(axes.size());
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) {
        double point[4] = {};
        std::size_t rest = i;
        for (std::size_t k = axes.size(); k-- > 0;) {
            point[k] = axes[k].second[rest % axes[k].second.size()];
            rest /= axes[k].second.size();
            columns[k].push_back(point[k]);
        }
        values.push_back(f(point));
    }
    for (std::size_t k = 0; k < axes.size(); ++k) {
        Channel channel{};
        find_channel(axes[k].first, channel);
        table.add_numbers(axes[k].first, channel_unit(channel), columns[k]);
    }
    table.add_numbers(quantity, quantity.ends_with("moment") ? "N m" : "N", values);
    if (sigma > 0) {
        std::vector<double> sigmas;
        for (std::size_t i = 0; i < count; ++i) {
            sigmas.push_back(sigma * (1 + 0.5 * std::sin(static_cast<double>(i))));
        }
        table.add_numbers(quantity + "_sigma", "N", sigmas);
    }
    tables::FitOptions options;
    options.kind = kind;
    return tables::ForceTable::fit(table, quantity, options);
}

const std::vector<double> gaps{0.001, 0.002, 0.003, 0.005, 0.008, 0.013, 0.02, 0.035, 0.06};
const std::vector<double> jet_gaps{0.002, 0.004, 0.007, 0.012, 0.02, 0.03};
const std::vector<double> pitches{-0.08, -0.05, -0.02, 0, 0.03, 0.06, 0.09};

double passive(const double* p) { return -2e-3 / (p[0] + 0.002) + 3 * p[1] + 0.2 * std::sin(90 * p[0]); }
double jet(const double* p) { return 1.5e-3 / (p[0] + 0.003); }
double turning(const double* p) { return 0.01 * p[1] - 2e-5 / (p[0] + 0.001) * std::cos(20 * p[1]); }

/// Passive ground effect that grows as the square of the speed, a jet with its own shorter range of gaps, and a moment.
Model jet_model(double sigma = 0) {
    Model model = test::free_model(2.2, 0.03, 0.02, 6);
    model.vehicle.pitch_inertia = 0.008;
    model.vehicle.base_depth = 0.05;
    model.vehicle.base_half_length = 0.08;
    model.forces.push_back({"lift_force",
                            "passive.csv",
                            "passive.csv",
                            grid("lift_force", {{"gap", gaps}, {"pitch", pitches}}, passive, sigma),
                            {Channel::gap, Channel::pitch},
                            {{Channel::speed, 0.5, 2, 0}},
                            1.1});
    model.forces.push_back({"lift_force",
                            "jet.csv",
                            "jet.csv",
                            grid("lift_force", {{"gap", jet_gaps}}, jet, sigma / 3, tables::FitOptions::Kind::spline),
                            {Channel::gap},
                            {{Channel::jet_voltage, 10, 2, 1.5}},
                            1});
    model.forces.push_back({"pitch_moment",
                            "turn.csv",
                            "turn.csv",
                            grid("pitch_moment", {{"gap", gaps}, {"pitch", pitches}}, turning, 0),
                            {Channel::gap, Channel::pitch},
                            {{Channel::speed, 0.5, 2, 0}},
                            1});
    return model;
}

tables::ForceTable correction() {
    return grid(
        "lift_force", {{"gap", {0.001, 0.01, 0.03, 0.05}}}, [](const double* p) { return 0.02 * std::sin(150 * p[0]); },
        0.004);
}

/// Every force at random places between the nodes, on demand a third of the coordinates beyond the ends, against the
/// model itself. Beyond an end that `asked` sets the tables hold their value and count as outside, although those of
/// the model may go on.
void check(const Model& model, const ForceTables& found, const Conditions& held, double tolerance, bool and_beyond,
           const std::vector<ForceAxis>& asked = {}) {
    core::Random random(77);
    for (const tables::ForceTable& table : found.tables) {
        const StaticModel force(model, table.quantity());
        const auto& values = table.points().numbers(table.quantity());
        const auto [low, high] = std::minmax_element(values.begin(), values.end());
        const double size = *high - *low;
        EXPECT_LE(table.sampling_error(), std::max(tolerance, 1e-8) * size) << "beside a kink no cubic follows at once";
        for (int i = 0; i < 2000; ++i) {
            Conditions at = held;
            std::vector<double> point;
            bool cut = false;
            for (std::size_t k = 0; k < table.axes().size(); ++k) {
                const double first = table.knots(k).front(), last = table.knots(k).back();
                const bool scales = table.axes()[k].name == "speed" || table.axes()[k].name == "jet_voltage";
                const double beyond = and_beyond && random.below(3) == 0 && !scales ? 0.3 * (last - first) : 0;
                point.push_back(random.uniform(first - beyond, last + beyond));
                Channel channel{};
                ASSERT_TRUE(find_channel(table.axes()[k].name, channel));
                const bool cut_below = !asked.empty() && asked[k].lower && point.back() < *asked[k].lower,
                           cut_above = !asked.empty() && asked[k].upper && point.back() > *asked[k].upper;
                cut = cut || cut_below || cut_above;
                at[channel] = cut_below ? *asked[k].lower : cut_above ? *asked[k].upper : point.back();
            }
            bool outside = false;
            const double wanted = force(at, &outside);
            outside = outside || cut;
            const tables::Evaluation got = table.at(point);
            ASSERT_NEAR(got.value, wanted, tolerance * size)
                << table.quantity() << " at gap " << at[Channel::gap] << " pitch " << at[Channel::pitch];
            ASSERT_NEAR(got.value, wanted, table.sampling_error() + 1e-13 * size);
            ASSERT_EQ(got.outside, outside);
            ASSERT_GE(got.no_data, outside);
        }
    }
}

TEST(ForceTablesOfAModel, AreExactWhereTheForceIsPiecewiseCubic) {
    const Model model = jet_model();
    for (const std::vector<ForceAxis>& axes :
         {std::vector<ForceAxis>{},
          {{"gap", {}, {}}, {"pitch", {}, {}}, {"speed", 0.0, 0.8}},
          {{"gap", {}, {}}, {"pitch", -0.05, 0.05}, {"speed", {}, {}}, {"jet_voltage", 0.0, 14.0}},
          {{"jet_voltage", 0.0, 14.0}}}) {
        ForceTablesOptions options;
        options.axes = axes;
        if (axes.size() == 1) {
            options.held[Channel::gap] = 0.0071;
        }
        options.held[Channel::speed] = axes.size() < 3 ? 0.7 : std::nan("");
        Conditions held = options.held;
        held[Channel::jet_voltage] = 10;
        held[Channel::pitch] = axes.empty() ? std::nan("") : 0;
        check(model, force_tables(model, options), held, 1e-12, true, axes);
    }
}

TEST(ForceTablesOfAModel, KeepToTheToleranceWithEveryEffectOfTheVehicle) {
    const Model plain = jet_model();
    const auto rough = make_use("surface_roughness", {{"near", 0.3}, {"far", 0.1}, {"length", 0.01}});
    const auto pump = make_use("pump_curve", {{"dead_zone", 2}, {"saturation", 0.4}, {"exponent", 0.2}});
    const auto exponent = make_use("speed_exponent", {{"exponent", 1.7}});
    auto unknown = neutral_use("unknown");
    unknown.table = correction();
    unknown.quantity = "lift_force";
    auto factor = neutral_use("declared_parameter");
    factor.parameter = "force.1.factor";
    factor.values = {1.3};
    Model sheltered = plain;
    sheltered.coupling = {Coupling::Kind::sheltered, 0.6};
    for (const Model& model : {plain.with_effect(rough), plain.with_effect(pump), plain.with_effect(exponent),
                               plain.with_effect(unknown), plain.with_effect(factor), sheltered,
                               plain.with_effect(rough).with_effect(unknown).with_effect(factor).with_effect(pump)}) {
        ForceTablesOptions options;
        options.axes = {{"gap", {}, {}}, {"pitch", {}, {}}, {"speed", 0.3, 0.8}};
        Conditions held;
        held[Channel::jet_voltage] = options.held[Channel::jet_voltage] = 8;
        check(model, force_tables(model, options), held, 1e-6,
              false);  // beyond the ends tables hold theirs, but what an effect makes of the gap goes on
        options.axes = {{"gap", {}, {}}, {"jet_voltage", 0.0, 14.0}};
        options.held = {};
        held = {};
        held[Channel::speed] = options.held[Channel::speed] = 0.62;
        held[Channel::pitch] = options.held[Channel::pitch] = 0.02;
        check(model, force_tables(model, options), held, 1e-6,
              false);  // beyond the ends tables hold theirs, but what an effect makes of the gap goes on
    }
}

TEST(ForceTablesOfAModel, AreWhatTheMotionSees) {
    // The plants of the heave motion and of heave with pitch look their forces up on their own.
    auto unknown = neutral_use("unknown");
    unknown.table = correction();
    unknown.quantity = "lift_force";
    const auto rough = make_use("surface_roughness", {{"near", 0.3}, {"far", 0.1}, {"length", 0.01}});
    for (const Model& model : {jet_model(), jet_model().with_effect(rough), jet_model().with_effect(unknown)}) {
        ForceTablesOptions options;
        options.held[Channel::speed] = 0.62;
        options.held[Channel::jet_voltage] = 7;
        const ForceTables found = force_tables(model, options);
        Conditions held = options.held;
        const HeavePitch both(model, held);
        const double added = model.effects.empty() || model.effects[0].name != "unknown" ? 0 : 1;
        // Rounding and the narrow cells beside kinks, but with roughness, which is no cubic, up to the tolerance of the
        // sampling: the tables say how far they are from the forces.
        const double within = found.tables[0].sampling_error();
        const auto& values = found.tables[0].points().numbers("lift_force");
        const auto [low, high] = std::minmax_element(values.begin(), values.end());
        const bool roughness = !model.effects.empty() && model.effects[0].name == "surface_roughness";
        ASSERT_LE(within, (roughness ? options.sampling.tolerance : 1e-8) * (*high - *low));
        core::Random random(5);
        for (int i = 0; i < 500; ++i) {
            // With roughness only where the tables are: beyond their ends it goes on, and the export holds.
            const bool inside = !model.effects.empty();
            const double point[2] = {inside ? random.uniform(0.001, 0.06) : random.uniform(0, 0.07),
                                     random.uniform(-0.1, 0.1)};
            const double lift = found.tables[0].value(point), moment = found.tables[1].value(point);
            double seen_lift = 0, seen_moment = 0;
            both.table_loads({point[0], 0, point[1], 0}, {}, seen_lift, seen_moment);
            seen_lift += added * correction().value(point);
            ASSERT_NEAR(lift, seen_lift, within);
            ASSERT_NEAR(moment, seen_moment, 1e-9);
            held[Channel::pitch] = point[1];
            const HeavePlant heave(model, held);
            ASSERT_NEAR(lift - model.vehicle.net_weight, heave.static_force(point[0]), within);
        }
    }
}

TEST(ForceTablesOfAModel, HaveTheErrorsOfTablesAndEffects) {
    const Model model = jet_model(0.02);
    Conditions at;
    at[Channel::gap] = 0.0061;
    at[Channel::pitch] = 0.013;
    at[Channel::speed] = 0.7;
    at[Channel::jet_voltage] = 12;
    const double point[2] = {0.0061, 0.013};
    const double passive_part = 1.1 * 1.96 * model.forces[0].table.sigma(point),
                 jet_part = std::pow(10.5 / 8.5, 2) * model.forces[1].table.sigma(point);
    EXPECT_NEAR(ForceError(model, "lift_force")(at), std::hypot(passive_part, jet_part), 1e-12);
    // A parameter: dF/dn = F ln(v/v0), to first order.
    Model sure = jet_model();
    sure.forces.erase(sure.forces.begin() + 1);
    const auto no_cells = [](const ForceSource& source, const double* p) { return source.table.sigma(p); };
    const double own = 1.1 * std::pow(1.4, 1.7) * no_cells(sure.forces[0], point);
    const Model uncertain = sure.with_effect(make_use("speed_exponent", {{"exponent", 1.7, 0.05}}));
    const double wanted = static_value(uncertain, "lift_force", at) * std::log(1.4) * 0.05;
    EXPECT_NEAR(ForceError(uncertain, "lift_force")(at), std::hypot(wanted, own), 1e-3 * std::abs(wanted));
    // A factor that stands as a declared parameter.
    auto factor = neutral_use("declared_parameter");
    factor.parameter = "force.1.factor";
    factor.values = {1.1};
    factor.sigmas = {0.11};
    const double of_factor = ForceError(sure.with_effect(factor), "lift_force")(at);
    EXPECT_NEAR(of_factor,
                std::hypot(0.1 * static_value(sure, "lift_force", at), 1.1 * 1.96 * no_cells(sure.forces[0], point)),
                1e-9);
}

TEST(ForceTablesOfAModel, CarryTheErrorBetweenTheNodesToo) {
    for (const bool with_jet : {false, true}) {
        Model model = jet_model(0.02);
        if (!with_jet) {
            model.forces.erase(model.forces.begin() + 1);
            model.forces[0].factor = 1;
        }
        auto unknown = neutral_use("unknown");
        unknown.table = correction();
        unknown.quantity = "lift_force";
        model = with_jet ? model.with_effect(unknown) : model;
        ForceTablesOptions options;
        options.quantities = {"lift_force"};
        options.held[Channel::speed] = 0.5;
        const tables::ForceTable table = force_tables(model, options).tables[0];
        const ForceError error(model, "lift_force");
        core::Random random(3);
        double stated = 0, own = 0;
        for (int i = 0; i < 2000; ++i) {
            const double point[2] = {random.uniform(0, 0.07), random.uniform(-0.1, 0.1)};
            Conditions at = options.held;
            at[Channel::gap] = point[0];
            at[Channel::pitch] = point[1];
            const double wanted = error(at);
            if (!with_jet) {
                ASSERT_NEAR(table.sigma(point), wanted, 1e-6 * wanted)
                    << "one table's error is given back as it is, at " << point[0] << " " << point[1];
            }
            const bool inside = point[0] > 0.001 && point[0] < 0.06 && std::abs(point[1] - 0.005) < 0.085;
            if (inside) {
                ASSERT_GE(table.sigma(point), 0.93 * wanted);
                stated += table.sigma(point);
                own += wanted;
            }
        }
        EXPECT_LT(stated, 1.1 * own);
        EXPECT_GT(own, 0);
    }
}

TEST(ForceTablesOfAModel, SayWhereTheirTablesHaveNoData) {
    core::Table band;
    band.source = "band";
    std::vector<double> g, p, f;
    for (int i = 0; i < 12; ++i) {
        for (const int j : {-1, 0, 1}) {
            g.push_back(0.002 + 0.001 * i);
            p.push_back(0.01 * (i + j) - 0.05);
            f.push_back(0.3 - 20 * g.back() + p.back());
        }
    }
    band.add_numbers("gap", "m", g);
    band.add_numbers("pitch", "rad", p);
    band.add_numbers("lift_force", "N", f);
    Model model = jet_model();
    model.forces[0].table = tables::ForceTable::fit(band, "lift_force");
    ForceTablesOptions options;
    options.quantities = {"lift_force"};
    const tables::ForceTable table = force_tables(model, options).tables[0];
    for (std::size_t i = 0; i < g.size(); ++i) {
        EXPECT_FALSE(table.at(std::vector{g[i], p[i]}).no_data) << "a point of the CFD itself";
    }
    const double corner[2] = {0.0025, 0.05};
    EXPECT_TRUE(table.at(corner).no_data);
    EXPECT_FALSE(table.at(corner).outside);
    core::Random random(9);
    int marked = 0;
    for (int i = 0; i < 2000; ++i) {
        const double point[2] = {random.uniform(0.002, 0.013), random.uniform(-0.06, 0.07)};
        const bool no_data = table.at(point).no_data;
        EXPECT_EQ(no_data, model.forces[0].table.at(point).no_data);
        const double distance = tables::beyond_points(model.forces[0].table, point);
        EXPECT_TRUE(!no_data || distance > 0) << "among the points there is data";
        EXPECT_TRUE(no_data || distance < 0.05) << "a cell or two around the points count as near";
        marked += no_data ? 1 : 0;
    }
    EXPECT_GT(marked, 500);
}

TEST(ForceTablesOfAModel, AreRefusedWithAReason) {
    const Model model = jet_model();
    const auto message = [&](const ForceTablesOptions& options) {
        try {
            (void)force_tables(model, options);
        } catch (const core::Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    ForceTablesOptions options;
    options.axes = {{"gap", {}, {}}, {"temperature", 280.0, 300.0}};
    EXPECT_THAT(message(options), HasSubstr("no force of the model depends on temperature"));
    options.axes = {{"gap", {}, {}}, {"gap", {}, {}}};
    EXPECT_THAT(message(options), HasSubstr("named twice"));
    options.axes = {{"gop", {}, {}}};
    EXPECT_THAT(message(options), HasSubstr("there is no axis 'gop'"));
    options.axes = {{"gap", 0.03, 0.02}};
    EXPECT_THAT(message(options), HasSubstr("is empty"));
    options.axes = {};
    options.quantities = {"drag_force"};
    EXPECT_THAT(message(options), HasSubstr("no force source of 'drag_force'"));
    EXPECT_THROW((void)force_tables(test::free_model(1, 0, 0, 1)), core::InputError);
}

}  // namespace

}  // namespace underbody::dynamics
