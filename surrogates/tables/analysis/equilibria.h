// Where lift and net weight balance: every equilibrium in the range of a table, how stiff, how fast, and what it
// survives.
//
// The force is scale * table(gap, held others) - net_weight, positive up. Sources: docs/physics.md section 4.5
// (stiffness k = -dF/dh, frequency sqrt(k/S_z)); the energy barrier is the integral of that force, exact for the
// piecewise cubic of the table.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/line.h"

namespace underbody::tables {

/// Tables drawn for the errors that equilibria are told with, wherever they are told: one number of draws, one error.
constexpr int usual_draws = 200;

struct EquilibriumOptions {
    double net_weight = 0;    ///< N, weight less buoyancy less constant thrust up; positive sinks
    double virtual_mass = 0;  ///< kg, mass + added mass in heave (S_z); 0: no frequency and no kick velocity
    double damping = 0;       ///< N s/m, linear; 0: no damping ratio
    double scale = 1;         ///< on the table's force: (speed/reference)^2 and the like
    Held held;                ///< values of the other axes, SI
    std::string axis;         ///< empty: gap, or the only axis
    int draws = 0;            ///< > 0: probabilities from that many tables drawn from the error (seeds 0, 1, ...)
};

enum class Stability { stable, unstable, marginal };
std::string to_string(Stability stability);

/// A probability above which nothing is said of it.
constexpr double sure_enough = 0.995;

struct Equilibrium {
    double gap = 0;  ///< value along the axis, SI
    Stability stability = Stability::stable;
    double stiffness = 0;  ///< N/m, -dF/dh: positive restores
    double sigma =
        0;  ///< m, one standard deviation of the gap from the table's error; 0 without errors, infinite when marginal
    double frequency = 0;  ///< Hz, sqrt(k/S)/(2 pi) of a stable one
    /// One standard deviation of both from as many drawn tables as asked for; nothing without draws or errors.
    std::optional<double> stiffness_sigma, frequency_sigma;
    double growth_rate = 0;    ///< 1/s, sqrt(-k/S) of an unstable one
    double damping_ratio = 0;  ///< of a stable one, from options.damping
    /// Largest work it survives without drag, J: the barrier to the nearer unstable equilibrium. Where there is none on
    /// either side: the work to the end of the table (`limited_by_range`).
    double barrier = 0;
    double barrier_up = 0;    ///< J, upward to the next unstable equilibrium or the upper end
    double barrier_down = 0;  ///< J, downward likewise
    bool limited_by_range = false;
    bool up_to_end = false;  ///< no unstable one above: what is survived upward leads past the table, where its policy
                             ///< for the outside decides, or up to there
    bool down_to_end = false;  ///< likewise below
    double kick_velocity =
        0;  ///< m/s, sqrt(2 barrier/S): the largest sudden heave velocity it survives in either direction
    double kick_velocity_up = 0;    ///< m/s, sqrt(2 barrier_up/S): upward to the next unstable equilibrium or the end
    double kick_velocity_down = 0;  ///< m/s, downward likewise
    double kick_gap = 0;            ///< m, largest displacement either way from which it returns when let go at rest
    double kick_gap_up = 0;         ///< m
    double kick_gap_down = 0;       ///< m
    double contact_velocity = 0;    ///< m/s, downward kick that just reaches the lower end of the table
    double extent = 0;              ///< m, > 0: a stretch of balance of that width around `gap`
    std::optional<double> probability;  ///< share of the drawn tables that have one like it within 4 sigma
    /// Not so sure that it could pass in silence.
    [[nodiscard]] bool doubtful() const { return probability && *probability < sure_enough; }
};

struct Equilibria {
    std::string axis;
    std::string axis_unit;
    double net_weight = 0;
    double virtual_mass = 0;
    double scale = 1;
    Held held;
    std::vector<Equilibrium> all;         ///< ascending
    std::vector<Line::Extreme> extremes;  ///< of the net force in the range, ascending
    std::string quantity;
    std::string source;
    double lower = 0, upper = 0;                    ///< range looked at
    double force_at_lower = 0, force_at_upper = 0;  ///< N, net force at its ends
    core::Problems remarks;

    [[nodiscard]] std::vector<double> gaps(Stability stability) const;
};

/// All equilibria in the table's range. Throws core::UsageError for a held value that is missing or no axis, a mass
/// that is negative, a table of what no net weight balances (a drag, a moment, a lift in axes that point down). Cheap
/// enough for every move of a mouse (microseconds for a table of one axis) when `draws` is 0.
Equilibria equilibria(const ForceTable& table, const EquilibriumOptions& options);

/// Throws core::UsageError for a table of what no net weight balances: a drag, a moment, a lift in axes that point
/// down.
void require_lift(const ForceTable& table);

/// The net force along the axis whose zeros these are.
Line net_force(const ForceTable& table, const EquilibriumOptions& options);

/// Keys of docs/conventions.md section 7 (`equilibria`: gap, stable, stiffness, frequency in Hz, kick_velocity, sigma,
/// ...).
void to_json(nlohmann::json& json, const Equilibrium& equilibrium);
void to_json(nlohmann::json& json, const Equilibria& equilibria);

}  // namespace underbody::tables
