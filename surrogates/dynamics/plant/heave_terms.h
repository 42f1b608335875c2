// The heave equation with every effect, compiled to plain numbers for a tight loop.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "surrogates/dynamics/model/channels.h"
#include "surrogates/dynamics/model/mixed_drag.h"
#include "surrogates/dynamics/model/source_shares.h"
#include "surrogates/dynamics/plant/actuator.h"
#include "surrogates/dynamics/plant/curve.h"
#include "surrogates/dynamics/plant/pitch_terms.h"
#include "surrogates/dynamics/plant/surface_terms.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::dynamics {

/// A source of lift: curve(gap) times the power laws of its scales, or a table of several varying channels.
struct HeaveSource {
    Curve curve;                            ///< used when `table` is empty
    std::vector<tables::ForceTable> table;  ///< none or one: its axes vary with time beside the gap
    std::vector<Channel> axes;              ///< of `table`
    struct Scale {
        Channel channel;
        double reference = 1;
        double exponent = 1;
        double dead_band = 0;
        double held = 0;       ///< value of the channel when nobody supplies it
        bool shelter = false;  ///< the coupling law instead of a power: 1/(1 + (value/reference)^2)
        [[nodiscard]] double factor(double value) const;
    };
    std::vector<Scale> scales;
    double factor = 1;
    /// Where effects of the model act on its tables: the share of this one, in place of scales and factor.
    std::shared_ptr<const SourceShares> shares;
    std::size_t share = 0;  ///< number of this source there
    Conditions held;        ///< of channels that nobody supplies

    /// What multiplies the table, with the channels `given(channel, held value)` supplies.
    template <typename Given>
    [[nodiscard]] double multiplier(const Given& given) const {
        if (shares) {
            Conditions at = held;
            for (std::size_t c = 0; c < channel_count; ++c) {
                at.value[c] = given(static_cast<Channel>(c), held.value[c]);
            }
            return (*shares)(share, at);
        }
        double product = factor;
        for (const Scale& scale : scales) {
            product *= scale.factor(given(scale.channel, scale.held));
        }
        return product;
    }
    /// The same with everything as held.
    [[nodiscard]] double multiplier() const {
        return multiplier([](Channel, double value) { return value; });
    }
};

/// M(h) dw/dt + 1/2 M'(h) w^2 = F(t, h, w), dh/dt = w   (Lagrange: kinetic energy 1/2 M(h) w^2)
///   M = mass + sum of growth L/(h + L)
///   F = -net_weight + lift(h, channels) + input - drag(w - current) - linear (w - current)
///       - quadratic (w - current)|w - current| + constant - friction sgn(w) - film/h^3 w
///       - input loss exp(-h/length)
///       - stiffness (h - reference) + amplitude sin(2 pi f t + phase) + growth t + corrections + history
/// All damping by the water, declared or an effect, acts on the velocity through the water; friction of a guide and the
/// film over the ground act on the velocity itself. Evaluated in surrogates/dynamics/plant/heave_equation.h, nowhere
/// else.
struct HeaveTerms {
    PitchTerms pitch;      ///< what acts on the pitch of a body that moves in heave and pitch
    SurfaceTerms surface;  ///< what acts on a body that moves on the ground
    double mass = 1;       ///< virtual mass, kg, far from the ground
    struct Growth {
        double mass = 0;    ///< kg, at the ground
        double length = 1;  ///< m
    };
    std::vector<Growth> growth;
    Curve added_mass;  ///< kg over gap, replaces the constant when not empty (mass then excludes it)

    std::vector<HeaveSource> sources;

    double constant = 0;   ///< N, up; holds -net_weight and constant_force
    double linear = 0;     ///< N s/m on w - current (declared drag)
    double quadratic = 0;  ///< N s^2/m^2 on w - current
    bool mixed = false;    ///< mixed law instead of linear + quadratic (drag.h)
    MixedDrag mixed_law;
    double current = 0;       ///< m/s, water that rises with it
    double extra_linear = 0;  ///< linear_damping: on w - current, N s/m
    double extra_quadratic = 0;
    double friction = 0;           ///< N, against the motion: friction w/sqrt(w^2 + width^2)
    double friction_width = 1e-4;  ///< m/s
    double film = 0;               ///< N s m^2: -film w/h^3
    double stiffness = 0;          ///< N/m: -stiffness (h - stiffness_gap)
    double stiffness_gap = 0;
    struct Wave {
        double amplitude = 0, frequency = 0, phase = 0;
    };
    std::vector<Wave> waves;
    double growth_of_force = 0;  ///< N/s: growth t
    [[nodiscard]] bool forced_in_time() const { return !waves.empty() || growth_of_force != 0; }
    double rough_near = 0, rough_far = 0;  ///< on the sum of lift sources (surface_roughness)
    double rough_length = 1, rough_sharpness = 2;
    struct Correction {
        tables::ForceTable table;
        std::vector<Channel> axes;
        Curve curve;  ///< the table along its only axis where that is gap or heave_velocity; else empty
        Correction(tables::ForceTable of, std::vector<Channel> over);
        [[nodiscard]] bool along(Channel channel) const { return !curve.empty() && axes[0] == channel; }
    };
    std::vector<Correction> corrections;  ///< unknown
    double history = 0;                   ///< N s^1/2 s/m: -history * integral of w'(s)/sqrt(t - s) ds
    /// Anything else a new effect brings: called each step; keep it cheap.
    using Extra = double (*)(const double* parameters, double t, double h, double w);
    struct ExtraTerm {
        Extra force;
        double parameters[6];
    };
    std::vector<ExtraTerm> extras;

    Actuator actuator;  ///< between the input, recorded or commanded, and the body

    double thrust_loss = 0;    ///< input times 1 - loss exp(-h/length): a thruster that the ground weakens
    double thrust_length = 1;  ///< m
    [[nodiscard]] double thrust_lost(double h) const {
        return thrust_loss != 0 ? thrust_loss * std::exp(-h / thrust_length) : 0;
    }

    // What the sensor makes of the gap: reading(t) = gap(t - delay) + bias + drift t, t on the record's clock.
    double sensor_bias = 0;   ///< m
    double sensor_drift = 0;  ///< m/s
    double sensor_delay = 0;  ///< s
    [[nodiscard]] double sensor_offset(double t) const { return sensor_bias + sensor_drift * t; }

    double contact_gap = 0;                   ///< the body touches the ground there
    double restitution = 0;                   ///< 0: stays until the force lifts it off
    double table_lower = 0, table_upper = 0;  ///< gaps that every table covers; outside they hold end values
};

}  // namespace underbody::dynamics
