// Models that several tests share.
#pragma once

#include <string>

#include "core/text.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics::test {

inline std::string number(double value) { return core::format_number(value); }

/// No table: weight, mass and drag only.
inline Model free_model(double mass, double net_weight, double linear, double quadratic) {
    return read_model_text("[vehicle]\nmass = " + number(mass) + "\nnet_weight = " + number(net_weight) +
                               "\n[drag.heave]\nlinear = " + number(linear) + "\nquadratic = " + number(quadratic) +
                               "\n",
                           "free.toml", ".");
}

/// A spring about a gap of 0.1 m.
inline Model spring_model(double stiffness, double mass, double linear, double quadratic) {
    return free_model(mass, 0, linear, quadratic)
        .with_effect(make_use("tether_stiffness", {{"stiffness", stiffness}, {"gap", 0.1}}));
}

/// REF-A of docs/physics.md section 6.3: knots in m and mN, not-a-knot cubic spline.
inline core::Table ref_a_table() {
    const double knots[][2] = {
        {-.05, 40},   {-.04, 28.4}, {-.03, 18.8}, {-.02, 11},   {-.01, 4.9},   {0, 0},       {.01, -4.1},  {.02, -7.4},
        {.03, -10},   {.04, -12},   {.05, -13.4}, {.06, -14.2}, {.07, -14.45}, {.08, -14.2}, {.09, -13.4}, {.10, -12.2},
        {.12, -8.7},  {.14, -4.4},  {.16, 0},     {.18, 3.9},   {.20, 7.3},    {.25, 13.4},  {.30, 17},    {.35, 18.9},
        {.40, 19.75}, {.45, 20},    {.50, 19.8},  {.60, 18.4},  {.70, 16},     {.80, 13.1},  {.90, 10.2},  {1.0, 7.6},
        {1.1, 5.5},   {1.2, 3.9},   {1.3, 2.7},   {1.4, 1.9},   {1.6, .9},     {1.8, .4}};
    std::vector<double> gap, lift;
    for (const auto& knot : knots) {
        gap.push_back(knot[0]);
        lift.push_back(knot[1] * 1e-3);
    }
    core::Table table;
    table.source = "ref-a.csv";
    table.add_numbers("gap", "m", gap);
    table.add_numbers("lift_force", "N", lift);
    return table;
}

/// REF-A on a body with S = 1/0.2529 kg.
inline Model ref_a_model(double linear = 0, double quadratic = 15, double net_weight = 0) {
    Model model = free_model(2.2, net_weight, linear, quadratic);
    model.vehicle.added_mass_heave = 1 / 0.2529 - 2.2;
    tables::FitOptions options;
    options.kind = tables::FitOptions::Kind::spline;
    model.forces.push_back({"lift_force",
                            "ref-a.csv",
                            "ref-a.csv",
                            tables::ForceTable::fit(ref_a_table(), "lift_force", options),
                            {Channel::gap},
                            {},
                            1.0});
    return model;
}

}  // namespace underbody::dynamics::test
