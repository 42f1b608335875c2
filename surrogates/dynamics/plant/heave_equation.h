// The heave equation of motion, evaluated here and nowhere else: simulation, stability regions, predictions,
// discovery's filter and the estimator all call these functions. Forces in N, positive up; gap h in m, velocity w =
// dh/dt in m/s.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "surrogates/dynamics/model/channels.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

/// Below this gap the damping of the film no longer grows. It only keeps 1/h^3 finite where a body lies on the ground:
/// thinner than any surface here is flat, so no law depends on it.
inline constexpr double least_film_gap = 1e-5;

/// The Basset kernel 1/sqrt(t) as a sum of exponentials: error below 0.5 % from 20 ms to 200 s; what is faster acts as
/// mass.
inline constexpr std::size_t history_states = 10;
struct HistoryKernel {
    double rate[history_states];    ///< 1/s
    double weight[history_states];  ///< s^-1/2
    double mass;                    ///< s^1/2: kernel that is faster than the last rate, times history gives kg
};
const HistoryKernel& history_kernel();

/// What a moment brings from outside.
struct HeaveMoment {
    double t = 0;
    double input = 0;                  ///< N, as it reaches the body
    const double* factors = nullptr;   ///< one per varying source
    const double* channels = nullptr;  ///< channel_count values, for tables over other channels
    double velocity_variance = 0;      ///< m^2/s^2, of a filter's belief: blurs the step of Coulomb's law
};

/// A force and how it changes along gap and velocity, the other held.
struct HeaveLoad {
    double force = 0, slope_h = 0, slope_w = 0;
};

/// Virtual mass M(h), kg, and its first two derivatives.
struct HeaveInertia {
    double mass = 0, slope = 0, curvature = 0;
};

/// Memory of the history force: what it pulls, how that changes with w, and the mass by which its fast part acts.
struct HeaveMemory {
    double force = 0, slope_w = 0, mass = 0;
};

/// Slopes of dw/dt along gap (1/s^2) and velocity (1/s), and the mass it was divided by.
struct HeaveSlopes {
    double gap = 0, velocity = 0, mass = 1;
};

/// By what the roughness of the ground multiplies the lift, with its slope along the gap.
inline double roughness_factor(double near, double far, double length, double sharpness, double h, double& slope) {
    const bool square = sharpness == 2;
    const double x = square ? h / length : std::max(h, 0.0) / length;
    const double power = square ? x * x : std::pow(x, sharpness), base = 1 + power;
    const double steep = square ? 2 * x : sharpness * std::pow(x, sharpness - 1);
    slope = -steep * (near + far) / (base * base) / length;
    return 1 + (near - far * power) / base;
}

inline void roughen(const HeaveTerms& terms, double h, HeaveLoad& lift) {
    if (terms.rough_near != 0 || terms.rough_far != 0) {
        double slope = 0;
        const double factor =
            roughness_factor(terms.rough_near, terms.rough_far, terms.rough_length, terms.rough_sharpness, h, slope);
        lift.slope_h = lift.slope_h * factor + lift.force * slope;
        lift.slope_w *= factor;
        lift.force *= factor;
    }
}

/// Drag of the water, declared and of effects, on the velocity through the water w - current.
template <bool Slopes = true>
inline void add_water_drag(const HeaveTerms& terms, double w, HeaveLoad& load) {
    const double v = w - terms.current, size = std::abs(v);
    const double declared = terms.mixed ? terms.mixed_law(v) : (terms.linear + terms.quadratic * size) * v;
    load.force -= declared + (terms.extra_linear + terms.extra_quadratic * size) * v;
    if constexpr (Slopes) {
        load.slope_w -= (terms.mixed ? terms.mixed_law.slope(v) : terms.linear + 2 * terms.quadratic * size) +
                        terms.extra_linear + 2 * terms.extra_quadratic * size;
    }
}

/// What follows the velocity over the ground: friction of a guide, the film, corrections over the velocity.
/// `variance`: of the velocity, where a filter knows it no better (statistical linearisation of Coulomb's step).
template <bool Slopes = true>
inline void add_guided_resistance(const HeaveTerms& terms, double h, double w, double variance, HeaveLoad& load) {
    if (terms.friction != 0) {
        constexpr double half_pi = std::numbers::pi / 2;
        const double width = terms.friction_width * terms.friction_width + half_pi * variance;
        const double root = std::sqrt(w * w + width);
        load.force -= terms.friction * w / root;
        if constexpr (Slopes) {
            load.slope_w -= terms.friction * width / (root * root * root);
        }
    }
    if (terms.film != 0) {
        const double gap = std::max(h, least_film_gap), damping = terms.film / (gap * gap * gap);
        load.force -= damping * w;
        if constexpr (Slopes) {
            load.slope_w -= damping;
            load.slope_h += h > least_film_gap ? 3 * damping * w / gap : 0;
        }
    }
    for (const HeaveTerms::Correction& correction : terms.corrections) {
        if (correction.along(Channel::heave_velocity)) {
            double slope = 0;
            load.force += correction.curve.value(w, slope);
            load.slope_w += slope;
        }
    }
}

inline double timed_force(const HeaveTerms& terms, double t) {
    constexpr double two_pi = 2 * std::numbers::pi;
    double force = terms.growth_of_force * t;
    for (const HeaveTerms::Wave& wave : terms.waves) {
        force += wave.amplitude * std::sin(two_pi * wave.frequency * t + wave.phase);
    }
    return force;
}

/// Springs and corrections over the gap alone.
inline void add_springs(const HeaveTerms& terms, double h, HeaveLoad& load) {
    load.force -= terms.stiffness * (h - terms.stiffness_gap);
    load.slope_h -= terms.stiffness;
    for (const HeaveTerms::Correction& correction : terms.corrections) {
        if (correction.along(Channel::gap)) {
            double slope = 0;
            load.force += correction.curve.value(h, slope);
            load.slope_h += slope;
        }
    }
}

/// Corrections over anything but gap or velocity alone. Channels that `moment` does not bring are as `held`, else 0.
void add_corrections(const HeaveTerms& terms, double h, double w, const HeaveMoment& moment, const Conditions& held,
                     HeaveLoad& load);
void add_extras(const HeaveTerms& terms, double t, double h, double w, HeaveLoad& load);

/// Weight, input, springs, corrections, extras: all but lift, drag, guide, film, waves and memory.
inline void add_given_forces(const HeaveTerms& terms, double h, double w, const HeaveMoment& moment,
                             const Conditions& held, HeaveLoad& load) {
    const double lost = moment.input * terms.thrust_lost(h);
    load.force += terms.constant + moment.input - lost;
    load.slope_h += lost / terms.thrust_length;
    add_springs(terms, h, load);
    if (!terms.corrections.empty()) {
        add_corrections(terms, h, w, moment, held, load);
    }
    if (!terms.extras.empty()) {
        add_extras(terms, moment.t, h, w, load);
    }
}

/// Everything but lift and memory, N up.
template <bool Slopes = true>
inline void add_forces(const HeaveTerms& terms, double h, double w, const HeaveMoment& moment, const Conditions& held,
                       HeaveLoad& load) {
    add_given_forces(terms, h, w, moment, held, load);
    add_guided_resistance<Slopes>(terms, h, w, moment.velocity_variance, load);
    if (terms.forced_in_time()) {
        load.force += timed_force(terms, moment.t);
    }
    add_water_drag<Slopes>(terms, w, load);
}

inline HeaveInertia heave_inertia(const HeaveTerms& terms, double h) {
    HeaveInertia all{terms.mass, 0, 0};
    if (!terms.added_mass.empty()) {
        double slope = 0, curvature = 0;
        all.mass += terms.added_mass.value(h, slope, curvature);
        all.slope += slope;
        all.curvature += curvature;
    }
    for (const HeaveTerms::Growth& growth : terms.growth) {
        const double base = std::max(h, 0.0) + growth.length, mass = growth.mass * growth.length / base;
        all.mass += mass;
        all.slope -= h > 0 ? mass / base : 0.0;
        all.curvature += h > 0 ? 2 * mass / (base * base) : 0.0;
    }
    return all;
}

/// dw/dt out of all forces: (F - 1/2 M' w^2 + memory)/(M + memory's mass).
template <bool Slopes = true>
inline double heave_acceleration(const HeaveInertia& inertia, double w, const HeaveLoad& load,
                                 const HeaveMemory& memory, HeaveSlopes& slopes) {
    slopes.mass = inertia.mass + memory.mass;
    const double a = (load.force + memory.force - 0.5 * inertia.slope * w * w) / slopes.mass;
    if constexpr (Slopes) {
        slopes.gap = (load.slope_h - 0.5 * inertia.curvature * w * w - a * inertia.slope) / slopes.mass;
        slopes.velocity = (load.slope_w + memory.slope_w - inertia.slope * w) / slopes.mass;
    }
    return a;
}
template <bool Slopes = true>
inline double heave_acceleration(const HeaveTerms& terms, double h, double w, const HeaveLoad& load,
                                 const HeaveMemory& memory, HeaveSlopes& slopes) {
    const HeaveInertia inertia =
        terms.growth.empty() && terms.added_mass.empty() ? HeaveInertia{terms.mass, 0, 0} : heave_inertia(terms, h);
    return heave_acceleration<Slopes>(inertia, w, load, memory, slopes);
}

/// Pull of the history force's memory, history_states states y_i with y_i' = -rate_i (y_i + w); nullptr: none.
inline HeaveMemory heave_memory(const HeaveTerms& terms, double w, const double* memory) {
    HeaveMemory all;
    if (terms.history != 0 && memory) {
        const HistoryKernel& kernel = history_kernel();
        double sum = 0, weights = 0;
        for (std::size_t i = 0; i < history_states; ++i) {
            sum += kernel.weight[i] * (w + memory[i]);
            weights += kernel.weight[i];
        }
        all = {-terms.history * sum, -terms.history * weights, terms.history * kernel.mass};
    }
    return all;
}

}  // namespace underbody::dynamics
