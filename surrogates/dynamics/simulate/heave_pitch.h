// Heave and pitch over the ground, coupled through tables of lift and pitch moment over (gap, pitch), with contact at
// both edges. gap and heave_velocity (its rate dh/dt): of the centre of the base, up; pitch nose up. Moments of tables
// about the centre of the base.
#pragma once

#include <array>
#include <cmath>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/no_limit.h"
#include "core/progress.h"
#include "core/table.h"
#include "surrogates/dynamics/linear/linear.h"
#include "surrogates/dynamics/model/force_sources.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/contact.h"
#include "surrogates/dynamics/plant/environment.h"
#include "surrogates/dynamics/plant/heave.h"

namespace underbody::dynamics {

/// 1/s: a mode that grows no faster does not grow. Quadratic drag alone leaves the linear motion undamped, yet it
/// settles.
constexpr double no_growth = 1e-6;

/// gap (m), heave_velocity (m/s), pitch (rad), pitch_rate (rad/s).
using PitchState = std::array<double, 4>;

/// u = -gain (y - reference) as force up and moment nose up, each limited to +-limit (0: no limit).
struct PitchFeedback {
    std::array<double, 4> force_gain{}, moment_gain{};  ///< N and N m per unit of the state
    PitchState reference{};
    double force_limit = 0, moment_limit = 0;
};

/// With w the velocity of the centre of gravity, up (dh/dt = w + a q):
/// S_z(h) dw/dt = -W + F(h, theta) - D_w(w) + effects + N1 + N2 + input - S_z' (dh/dt w - w^2/2)
/// S_q dq/dt = M(h, theta) + a F - (L cos(theta) - x sin(theta)) D(h, theta) - F_b (L_b sin(theta) - x_b cos(theta)) -
/// D_q(q) + contact + drag moment + S_z' a w^2/2 + effects on the pitch (PitchTerms), dh/dt = w + a q, dtheta/dt = q, a
/// = L sin(theta) + x cos(theta); L is the depth and x the distance forward of the base's centre from the centre of
/// gravity. Effects act at the centre of gravity. Lagrange with S_z over the gap.
class HeavePitch {
public:
    /// `varying`: channels that recorded inputs supply. Throws core::InputError: pitch inertia, base depth or base
    /// length not declared, a table axis that nothing supplies.
    explicit HeavePitch(const Model& model, const Conditions& held = {}, const std::vector<Channel>& varying = {});

    /// The force passes the actuator that the model declares, as input_force does; the moment does not.
    void close_loop(const PitchFeedback& feedback);
    /// What the feedback asks of the force, N up, before the actuator; 0 without a loop.
    [[nodiscard]] double force_command(const PitchState& y) const;
    /// How far the base's centre lies ahead of the centre of gravity, along the ground, m.
    [[nodiscard]] double arm(double pitch) const { return depth_ * std::sin(pitch) + forward_ * std::cos(pitch); }
    /// Velocity of the centre of gravity, up, m/s.
    [[nodiscard]] double centre_velocity(const PitchState& y) const { return y[1] - arm(y[2]) * y[3]; }

    void rate(const PitchState& y, ContactState bearing, PitchState& dydt, const Surroundings& around = {}) const;
    [[nodiscard]] std::array<double, 2> normal_forces(const PitchState& y, ContactState bearing,
                                                      const Surroundings& around = {}) const;
    /// Of nose and tail edge.
    [[nodiscard]] std::array<double, 2> edge_gaps(const PitchState& y) const;
    [[nodiscard]] std::array<double, 2> edge_speeds(const PitchState& y) const;
    [[nodiscard]] ContactState settle(const PitchState& y, ContactState touching,
                                      const Surroundings& around = {}) const;
    [[nodiscard]] PitchState impact(const PitchState& y, ContactState touching) const;

    /// Force up and moment nose up at rest, about the centre of gravity, without waves.
    void statics(double gap, double pitch, double& force, double& moment) const;
    /// Force up and moment nose up of the force tables, about the centre of the base.
    void table_loads(const PitchState& y, const Surroundings& around, double& lift, double& moment) const;
    /// Kinetic energy of body and water, J.
    [[nodiscard]] double kinetic_energy(const PitchState& y) const;
    [[nodiscard]] double contact_gap() const { return contact_gap_; }
    [[nodiscard]] double half_length() const { return half_length_; }
    [[nodiscard]] double table_lower() const { return table_lower_; }
    [[nodiscard]] double table_upper() const { return table_upper_; }
    [[nodiscard]] double pitch_lower() const { return pitch_lower_; }
    [[nodiscard]] double pitch_upper() const { return pitch_upper_; }
    /// Virtual mass far from the ground, kg.
    [[nodiscard]] double mass() const { return virtual_mass(1e3); }
    [[nodiscard]] double inertia() const { return inertia_; }
    /// The same at a gap.
    [[nodiscard]] double mass(double gap) const { return virtual_mass(gap); }
    /// Weight, drag, effects: the heave channel without tables.
    [[nodiscard]] const HeavePlant& vertical() const { return vertical_; }
    /// True when the motion has memory: its integrators carry history_states more.
    [[nodiscard]] bool remembers() const { return vertical_.terms.history != 0; }
    /// Equilibria in free water within the tables, from the ground up.
    [[nodiscard]] std::vector<HeaveEquilibrium> equilibria() const;
    /// A of (gap, heave_velocity, pitch, pitch_rate), inputs force up and moment nose up; without Coulomb friction.
    [[nodiscard]] LinearSystem linearised(double gap, double pitch) const;

private:
    struct Loads {
        double force = 0, moment = 0, mass = 1;
    };
    [[nodiscard]] double virtual_mass(double gap) const {
        double slope = 0;
        return vertical_.inertia(gap, slope) + vertical_.history_mass();
    }
    [[nodiscard]] double arm_slope(double pitch) const { return depth_ * std::cos(pitch) - forward_ * std::sin(pitch); }
    [[nodiscard]] double input_force(const PitchState& y, const Surroundings& around) const;
    [[nodiscard]] Conditions seen(const PitchState& y, const Surroundings& around) const;
    void forces(const PitchState& y, const Surroundings& around, bool waves, Loads& loads) const;
    [[nodiscard]] ContactProblem problem(const PitchState& y, const Loads& loads) const;
    void accelerations(const PitchState& y, const Loads& loads, const std::array<double, 2>& normal, double& up,
                       double& turn) const;
    Conditions held_;
    HeavePlant vertical_;
    ForceSources lift_, drag_, moment_;
    DragLaw drag_pitch_;
    Environment water_;
    std::optional<PitchFeedback> feedback_;
    Vector3 buoyancy_centre_{};
    double inertia_ = 0, depth_ = 0, forward_ = 0, half_length_ = 0, buoyancy_ = 0, friction_ = 0, restitution_ = 0,
           speed_ = 0, input_ = 0;
    double drag_moment_ = 0;
    double contact_gap_ = 0, table_lower_ = -core::no_limit, table_upper_ = core::no_limit,
           pitch_lower_ = -core::no_limit, pitch_upper_ = core::no_limit;
};

struct PitchTrajectory {
    std::vector<double> time;
    std::vector<PitchState> state;
    std::vector<double> lift, moment;  ///< of the force tables, N up and N m nose up about the centre of the base
    std::vector<ContactState> contact;
    std::vector<bool> outside;            ///< a table was asked beyond its range there
    std::vector<TrajectoryEvent> events;  ///< contact, contact change, lift_off, escape, equilibrium
    std::string end = "time";             ///< "time", "contact", "escape", "equilibrium"
    core::Problems remarks;
    [[nodiscard]] core::Table table() const;
};
/// By CVODE, through contact (inelastic unless the model says otherwise). The plant must have been told which channels
/// the inputs vary. Throws core::InputError for a start in the ground.
PitchTrajectory simulate(const HeavePitch& plant, const PitchState& start, const TrajectoryOptions& options,
                         core::Progress& progress = core::Progress::none(), const InputSignals& inputs = {});
core::Figure trajectory_figure(const PitchTrajectory& trajectory);
void to_json(nlohmann::json& json, const PitchTrajectory& trajectory);

}  // namespace underbody::dynamics
