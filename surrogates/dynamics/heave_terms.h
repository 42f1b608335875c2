// The heave equation with every effect, compiled to plain numbers for a tight loop.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "surrogates/dynamics/channels.h"
#include "surrogates/dynamics/mixed_drag.h"
#include "surrogates/tables/force_table.h"

namespace underbody::dynamics {

/// A piecewise cubic (C1) of the gap with an index for constant-time look-up. Holds its end value outside its knots.
/// A table with one axis becomes its own cubic pieces exactly; others are refined to 1e-10 of their range.
class Curve {
public:
    Curve() = default;
    /// Hermite data: ascending x (at least two), values and slopes.
    Curve(std::vector<double> x, std::vector<double> value, std::vector<double> slope);
    /// The table along `axis` with the other axes held at `held` (one entry per axis; the entry of `axis` is ignored).
    static Curve along(const tables::ForceTable& table, std::size_t axis, std::span<const double> held);

    [[nodiscard]] bool empty() const { return x_.empty(); }
    [[nodiscard]] double lower() const { return x_.front(); }
    [[nodiscard]] double upper() const { return x_.back(); }
    [[nodiscard]] const std::vector<double>& knots() const { return x_; }

    /// The value, and its slope and integral (from lower()) when asked for.
    [[nodiscard]] double operator()(double x) const noexcept {
        if (x <= x_.front()) {
            return end_[0];
        }
        if (x >= x_.back()) {
            return end_[1];
        }
        const Piece& p = pieces_[piece(x)];
        const double d = x - p.x;
        return p.c0 + d * (p.c1 + d * (p.c2 + d * p.c3));
    }
    [[nodiscard]] double value(double x, double& slope) const noexcept;
    [[nodiscard]] double integral(double x) const noexcept;
    /// a * this + b * other on the union of the knots (beyond a curve's end its end value).
    [[nodiscard]] Curve plus(double a, const Curve& other, double b) const;
    [[nodiscard]] Curve times(double factor) const;
    /// Zeros inside the knots, ascending, to machine precision.
    [[nodiscard]] std::vector<double> zeros(double level = 0) const;

private:
    struct Piece {
        double x, c0, c1, c2, c3;
    };
    void build_index();
    [[nodiscard]] std::size_t piece(double x) const noexcept {
        auto bucket = static_cast<std::size_t>((x - x_.front()) * per_bucket_);
        bucket = bucket < first_.size() ? bucket : first_.size() - 1;
        std::size_t i = first_[bucket];
        while (i + 1 < pieces_.size() && x >= pieces_[i + 1].x) {
            ++i;
        }
        return i;
    }
    std::vector<double> x_, value_, slope_, integral_;
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> first_;
    double per_bucket_ = 0;
    double end_[2] = {0, 0};
};

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
};

/// M(h) dw/dt + 1/2 M'(h) w^2 = F(t, h, w), dh/dt = w   (Lagrange: kinetic energy 1/2 M(h) w^2)
///   M = mass + sum of growth L/(h + L)
///   F = -net_weight + lift(h, channels) + input - drag(w - current) + constant - friction sgn(w) - (linear +
///   linear_film/h^3) w
///       - quadratic w|w| - stiffness (h - reference) + amplitude sin(2 pi f t + phase) + corrections + history
struct HeaveTerms {
    double mass = 1;  ///< virtual mass, kg, far from the ground
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
    double extra_linear = 0;  ///< linear_damping: on w itself, N s/m
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
    double rough_near = 0, rough_far = 0, rough_length = 1;  ///< on the sum of lift sources (surface_roughness)
    struct Correction {
        tables::ForceTable table;
        std::vector<Channel> axes;
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

    // What happens to the recorded input on its way to the body: delay, dead zone, gain, first-order lag, in this
    // order.
    double input_delay = 0;      ///< s
    double input_dead_zone = 0;  ///< N
    double input_gain = 1;
    double input_lag = 0;  ///< s, time constant

    // What the sensor makes of the gap: reading(t) = gap(t - delay) + bias.
    double sensor_bias = 0;   ///< m
    double sensor_delay = 0;  ///< s

    double contact_gap = 0;                   ///< the body touches the ground there
    double restitution = 0;                   ///< 0: stays until the force lifts it off
    double table_lower = 0, table_upper = 0;  ///< gaps that every table covers; outside they hold end values
};

}  // namespace underbody::dynamics
