// Release experiments (thesis 5-22): the body is pushed to a gap over its bottom jet and let go.
#pragma once

#include <string>
#include <vector>

#include "core/figure.h"
#include "core/water.h"
#include "surrogates/dynamics/theory/film.h"

namespace underbody::dynamics {

struct ReleaseSetup {
    JetFilm film;                                      ///< force of the jet's film, N
    double half_length = 0.0717, half_width = 0.0536;  ///< m, of the base
    double mass = 0;                                   ///< virtual mass far from the ground, kg
    double quadratic_drag = 0;                         ///< N s^2/m^2
    double extra_force = 0;                            ///< N, up: what the body weighs too little (dB)
    double viscosity = 1e-3, density = core::default_water_density;
    bool squeeze = true;        ///< squeeze damping 12 mu G/h^3
    bool gap_mass = true;       ///< added mass rho G/h of the film
    double contact_gap = 1e-5;  ///< m; the push of 5 N means contact
    double start = 2e-4;        ///< m
    double duration = 60;       ///< s
    double escape_gap = 0.1;    ///< m
};

enum class ReleaseOutcome { settles, overshoots, oscillates, escapes };
const char* release_outcome_name(ReleaseOutcome outcome);

struct Release {
    ReleaseOutcome outcome = ReleaseOutcome::settles;
    std::vector<double> time, gap, velocity;
    double equilibrium = 0;  ///< m, of the film force with extra_force; NaN when there is none
    int swings = 0;          ///< crossings of the equilibrium
};
/// (S + rho G/h) dvz = F(h) + dB - c vz - D vz|vz| - 1/2 d(rho G/h)/dh vz^2, by CVODE.
/// Outcomes: settles (no crossing of the equilibrium), overshoots (one or two), oscillates (more, decaying), escapes.
Release release(const ReleaseSetup& setup);

/// Least extra upward force with which the body escapes, by bisection; the static threshold is -film.lowest().
double escape_threshold(ReleaseSetup setup, double upper, double precision = 1e-5);

core::Figure release_figure(const std::vector<Release>& releases, const std::vector<std::string>& names);

}  // namespace underbody::dynamics
