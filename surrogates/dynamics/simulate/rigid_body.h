// The vehicle over the ground with roll held at zero: eleven states, jets, drag, ground effect, contact.
// Body frame x forward, y starboard, z down, origin at the centre of gravity; world X forward, Y right, Z down with the
// ground at Z = 0. Equations: docs/physics.md section 3.1 (Fossen; Kirchhoff's equations with a diagonal added mass and
// a full inertia tensor, projected onto the motions that keep roll at zero, which is the roll-constraint moment). Heave
// added mass may follow the gap. Effects of the heave channel act upward at the centre of gravity; those on the pitch
// (PitchTerms) and along and across the body (SurfaceTerms) act as in the motions that have only these.
#pragma once

#include <array>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "core/table.h"
#include "surrogates/dynamics/linear/linear.h"
#include "surrogates/dynamics/model/force_sources.h"
#include "surrogates/dynamics/model/jets.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/contact.h"
#include "surrogates/dynamics/plant/environment.h"

namespace underbody::dynamics {

/// u, v, w (m/s), q, r (rad/s), theta, psi (rad), X, Y, Z (m). The eleventh state is p = -r tan(theta).
using BodyState = std::array<double, 10>;
enum BodyStateIndex { state_u, state_v, state_w, state_q, state_r, state_theta, state_psi, state_x, state_y, state_z };
const std::vector<std::string>& body_state_names();

class RigidBody {
public:
    /// `varying`: channels that recorded inputs supply. The speed that tables see is the body's own along the ground.
    /// Throws core::InputError: inertia, base depth or base length not declared; not positive definite.
    explicit RigidBody(const Model& model, const Conditions& held = {}, const std::vector<Channel>& varying = {});

    /// One thrust a jet, N. `bearing`: the edges of the base that are held on the ground.
    void rate(const BodyState& y, std::span<const double> thrust, ContactState bearing, BodyState& dydt,
              const Surroundings& around = {}) const;
    /// What a force and a moment about the centre of gravity (body axes) add to the rates of u, v, w, q, r, whatever
    /// else acts; in free water.
    [[nodiscard]] std::array<double, 5> answer(const BodyState& y, const Wrench& wrench) const;
    /// Normal forces at the nose and the tail edge, N.
    [[nodiscard]] std::array<double, 2> normal_forces(const BodyState& y, std::span<const double> thrust,
                                                      ContactState bearing, const Surroundings& around = {}) const;
    /// Gaps of the two edges and how fast they open.
    [[nodiscard]] std::array<double, 2> edge_gaps(const BodyState& y) const;
    [[nodiscard]] std::array<double, 2> edge_speeds(const BodyState& y) const;
    [[nodiscard]] double gap_at_base_centre(const BodyState& y) const;
    /// heave_velocity: how fast that gap grows, m/s.
    [[nodiscard]] double rise_of_base(const BodyState& y) const;
    /// The state w that gives this heave velocity with the speed u, pitch and pitch rate of `y`.
    [[nodiscard]] double down_velocity_for(double heave_velocity, const BodyState& y) const;
    /// Slip of an edge (0 nose, 1 tail) along the ground, m/s: forward in the heading, to starboard.
    [[nodiscard]] std::array<double, 2> slip(const BodyState& y, std::size_t edge) const;
    /// Contact state that complementarity demands of edges that touch (gap and its rate zero).
    /// Throws core::Error (kind "contact") when friction leaves none.
    [[nodiscard]] ContactState settle(const BodyState& y, std::span<const double> thrust, ContactState touching,
                                      const Surroundings& around = {}) const;
    /// After an impact of the touching edges; they slide with the contact's friction, or stick where that is enough.
    [[nodiscard]] BodyState impact(const BodyState& y, ContactState touching) const;

    /// Kinetic energy of body and water, J; p follows from r.
    [[nodiscard]] double kinetic_energy(const BodyState& y) const;
    [[nodiscard]] double roll_rate(const BodyState& y) const;
    /// World velocity of the centre of gravity.
    [[nodiscard]] static Vector3 world_velocity(const BodyState& y);
    /// From the centre of gravity, body axes.
    [[nodiscard]] const Vector3& base_centre() const { return base_; }
    /// How far the centre of gravity lies forward and to starboard of the declared one (effects of the model), m.
    [[nodiscard]] std::array<double, 2> mass_offset() const {
        return {vertical_.terms.pitch.mass_forward, vertical_.terms.surface.mass_aside};
    }
    [[nodiscard]] double contact_gap() const { return contact_gap_; }
    [[nodiscard]] double half_length() const { return half_length_; }
    /// Z of the centre of gravity with the base's centre at this gap and this pitch.
    [[nodiscard]] double height_for_gap(double gap, double theta) const;
    /// Force up, aft and moment nose up of the force tables, about the centre of the base.
    struct TableLoads {
        double lift = 0, drag = 0, moment = 0;
    };
    [[nodiscard]] TableLoads table_loads(const BodyState& y, const Surroundings& around = {}) const;
    /// True where a table is asked beyond its range of gap, pitch or speed.
    [[nodiscard]] bool outside_tables(const BodyState& y) const;
    [[nodiscard]] const std::vector<Jet>& jets() const { return model_.jets; }
    [[nodiscard]] const Model& model() const { return model_; }
    /// Weight, drag, effects: the heave channel without tables.
    [[nodiscard]] const HeavePlant& vertical() const { return vertical_; }
    /// Coulomb friction has no slope at rest: what is linearised goes without it.
    void leave_friction_out() { vertical_.terms.friction = 0; }
    [[nodiscard]] bool remembers() const { return vertical_.terms.history != 0; }

private:
    struct Loads;
    [[nodiscard]] Conditions seen(const BodyState& y, const Surroundings& around) const;
    [[nodiscard]] TableLoads table_loads(Conditions seen) const;
    /// Effects on the pitch, and along and across the body.
    void add_effects(const BodyState& y, double input, double gap, Loads& loads) const;
    void free_loads(const BodyState& y, std::span<const double> thrust, const Surroundings& around, Loads& loads) const;
    [[nodiscard]] Vector3 edge_place(std::size_t edge) const {
        return {base_[0] + (edge == 0 ? half_length_ : -half_length_), base_[1], base_[2]};
    }
    /// After an impact with this friction; empty where it contradicts itself or turns a slip round.
    [[nodiscard]] std::optional<BodyState> struck(const BodyState& y, ContactState touching, double friction) const;
    void add_contact(const BodyState& y, const std::array<double, 2>& normal, double friction, Loads& loads) const;
    void accelerations(const BodyState& y, const Loads& loads, double* out) const;
    [[nodiscard]] ContactProblem problem(const BodyState& y, const Loads& loads, double friction) const;
    [[nodiscard]] std::array<double, 2> gap_accelerations(const BodyState& y, const double* out) const;
    Model model_;
    std::vector<Jet> acting_;  ///< the model's jets as they act
    Conditions held_;
    HeavePlant vertical_;
    ForceSources lift_, drag_, side_, roll_moment_, pitch_moment_, yaw_moment_;
    double mass_x_ = 0, mass_y_ = 0;                  ///< virtual masses in surge and sway
    std::array<std::array<double, 3>, 3> inertia_{};  ///< tensor of body and water
    Vector3 base_{}, buoyancy_centre_{};
    double buoyancy_ = 0, half_length_ = 0, contact_gap_ = 0;
};

/// Edges of the base on the ground that do not leave it.
ContactState touching_edges(const RigidBody& body, const BodyState& y);
/// Puts edges that are in the ground onto it, and carries out the impact if one strikes: the edges on the ground then;
/// free: none strikes.
ContactState strike(const RigidBody& body, BodyState& y);

struct BodyTrajectory {
    std::vector<double> time;
    std::vector<BodyState> state;
    std::vector<double> roll_rate, gap;
    std::vector<std::array<double, 2>> normal;
    std::vector<std::vector<double>> thrust;  ///< one per jet, N
    std::vector<RigidBody::TableLoads> loads;
    std::vector<ContactState> contact;
    std::vector<bool> outside;  ///< a table was asked beyond its range there
    /// "impact nose edge", "free", "flat", ...: the contact state from then on; "escape". Without gap and velocity.
    std::vector<TrajectoryEvent> events;
    std::vector<std::string> jets;
    std::string end = "time";  ///< "time", "contact", "escape", "equilibrium"
    core::Problems remarks;
    [[nodiscard]] core::Table table() const;
};

struct BodyOptions {
    double duration = 10;
    double output_step = 0.05;  ///< s; 0: the integrator's own steps
    double tolerance = 1e-9;
    double escape_gap = 0;  ///< 0: never
    bool stop_at_contact = false;
    bool stop_at_equilibrium = false;  ///< all accelerations and the rates of gap and pitch vanish
    double settle_speed = 1e-5;        ///< m/s and m/s^2; rad/s times 0.1 m
    double command_step = 0;  ///< s: a digital controller, which holds its thrusts from sample to sample; 0: continuous
};

/// Thrusts wanted of the jets at a moment, N, one a jet.
using JetCommand = std::function<std::vector<double>(double t, const BodyState& y)>;

/// `command` gives the commanded thrusts; jets follow with their lags and within their limits. The body must have been
/// told which channels the inputs vary. Throws core::InputError for a start in the ground, core::Error for
/// contradictory contact.
BodyTrajectory simulate_body(const RigidBody& body, const BodyState& start, const JetCommand& command,
                             const BodyOptions& options, core::Progress& progress = core::Progress::none(),
                             const InputSignals& inputs = {});
core::Figure trajectory_figure(const BodyTrajectory& trajectory);
void to_json(nlohmann::json& json, const BodyTrajectory& trajectory);

/// A and B of all ten independent states about a state in free water, inputs the jets.
LinearSystem linearise_body(const RigidBody& body, const BodyState& trim, const std::vector<double>& thrust);

}  // namespace underbody::dynamics
