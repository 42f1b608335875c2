// Heave and pitch over the ground, coupled through tables of lift and pitch moment over (gap, pitch), with contact at
// both edges. gap: centre of the base, up; heave_velocity: of the centre of gravity, up; pitch nose up. Moments of
// tables about the centre of the base.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "core/table.h"
#include "surrogates/dynamics/contact.h"
#include "surrogates/dynamics/heave.h"
#include "surrogates/dynamics/linear.h"
#include "surrogates/dynamics/model.h"

namespace underbody::dynamics {

/// gap (m), heave_velocity (m/s), pitch (rad), pitch_rate (rad/s).
using PitchState = std::array<double, 4>;

/// S_z dw/dt = -W + F(h, theta) - D_w(w) + N1 + N2 + input
/// S_q dq/dt = M(h, theta) + L F sin(theta) - F_b L_b sin(theta) - D_q(q) + contact + drag moment of the speed
/// dh/dt = w + L sin(theta) q, dtheta/dt = q; L is the depth of the base below the centre of gravity.
class HeavePitch {
public:
    /// Throws core::InputError: pitch inertia, base depth or base length not declared, a table axis that nothing
    /// supplies.
    explicit HeavePitch(const Model& model, const Conditions& held = {});

    void rate(const PitchState& y, ContactState bearing, PitchState& dydt) const;
    [[nodiscard]] std::array<double, 2> normal_forces(const PitchState& y, ContactState bearing) const;
    /// Of nose and tail edge.
    [[nodiscard]] std::array<double, 2> edge_gaps(const PitchState& y) const;
    [[nodiscard]] std::array<double, 2> edge_speeds(const PitchState& y) const;
    [[nodiscard]] ContactState settle(const PitchState& y, ContactState touching) const;
    [[nodiscard]] PitchState impact(const PitchState& y, ContactState touching) const;

    /// Force up and moment nose up at rest, about the centre of gravity.
    void statics(double gap, double pitch, double& force, double& moment) const;
    [[nodiscard]] double lift(double gap, double pitch) const;
    [[nodiscard]] double contact_gap() const { return contact_gap_; }
    [[nodiscard]] double table_lower() const { return table_lower_; }
    [[nodiscard]] double table_upper() const { return table_upper_; }
    [[nodiscard]] double pitch_lower() const { return pitch_lower_; }
    [[nodiscard]] double pitch_upper() const { return pitch_upper_; }
    [[nodiscard]] double mass() const { return mass_; }
    [[nodiscard]] double inertia() const { return inertia_; }
    /// Equilibria in free water within the tables, from the ground up.
    [[nodiscard]] std::vector<HeaveEquilibrium> equilibria() const;
    /// A of (gap, heave_velocity, pitch, pitch_rate), inputs force up and moment nose up.
    [[nodiscard]] LinearSystem linearised(double gap, double pitch) const;

private:
    struct Source {
        tables::ForceTable table;
        double factor = 1;
        int gap_axis = -1, pitch_axis = -1;
        std::array<double, tables::max_axes> held{};
        [[nodiscard]] double value(double gap, double pitch) const;
    };
    struct Loads {
        double force = 0, moment = 0;
    };
    void forces(const PitchState& y, Loads& loads) const;
    [[nodiscard]] ContactProblem problem(const PitchState& y) const;
    void accelerations(const PitchState& y, const std::array<double, 2>& normal, double& up, double& turn) const;
    std::vector<Source> lift_, moment_;
    DragLaw drag_heave_, drag_pitch_;
    Environment water_;
    double mass_, inertia_, depth_, half_length_, weight_, buoyancy_, buoyancy_height_, friction_, restitution_, speed_,
        input_;
    double drag_moment_ = 0;
    double contact_gap_ = 0, table_lower_ = -1e300, table_upper_ = 1e300, pitch_lower_ = -1e300, pitch_upper_ = 1e300;
};

struct PitchTrajectory {
    std::vector<double> time;
    std::vector<PitchState> state;
    std::vector<ContactState> contact;
    std::vector<TrajectoryEvent> events;
    std::string end = "time";
    [[nodiscard]] core::Table table() const;
};
/// By CVODE, through contact (inelastic unless the model says otherwise).
PitchTrajectory simulate(const HeavePitch& plant, const PitchState& start, const TrajectoryOptions& options,
                         core::Progress& progress = core::Progress::none());
core::Figure trajectory_figure(const PitchTrajectory& trajectory);

}  // namespace underbody::dynamics
