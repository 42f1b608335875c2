// The vehicle over the ground with roll held at zero: eleven states, jets, drag, ground effect, contact.
// Body frame x forward, y starboard, z down, origin at the centre of gravity; world X forward, Y right, Z down with the
// ground at Z = 0. Equations: design notes 3.1 (Fossen; Kirchhoff's equations with a diagonal added mass;
// roll-constraint moment included).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/table.h"
#include "surrogates/dynamics/contact.h"
#include "surrogates/dynamics/jets.h"
#include "surrogates/dynamics/linear.h"
#include "surrogates/dynamics/model.h"

namespace underbody::dynamics {

/// u, v, w (m/s), q, r (rad/s), theta, psi (rad), X, Y, Z (m). The eleventh state is p = -r tan(theta).
using BodyState = std::array<double, 10>;
enum BodyStateIndex { state_u, state_v, state_w, state_q, state_r, state_theta, state_psi, state_x, state_y, state_z };
const std::vector<std::string>& body_state_names();

class RigidBody {
public:
    /// Throws core::InputError: inertia, base depth or base length not declared; not positive definite.
    explicit RigidBody(const Model& model, const Conditions& held = {});

    /// One thrust a jet, N. `bearing`: the edges of the base that are held on the ground.
    void rate(const BodyState& y, std::span<const double> thrust, ContactState bearing, BodyState& dydt) const;
    /// Normal forces at the nose and the tail edge, N.
    [[nodiscard]] std::array<double, 2> normal_forces(const BodyState& y, std::span<const double> thrust,
                                                      ContactState bearing) const;
    /// Gaps of the two edges and how fast they open.
    [[nodiscard]] std::array<double, 2> edge_gaps(const BodyState& y) const;
    [[nodiscard]] std::array<double, 2> edge_speeds(const BodyState& y) const;
    [[nodiscard]] double gap_at_base_centre(const BodyState& y) const;
    /// Contact state that complementarity demands of edges that touch (gap and its rate zero).
    /// Throws core::Error (kind "contact") when friction leaves none.
    [[nodiscard]] ContactState settle(const BodyState& y, std::span<const double> thrust, ContactState touching) const;
    /// After an impact of the touching edges.
    [[nodiscard]] BodyState impact(const BodyState& y, ContactState touching) const;

    /// Kinetic energy of body and water, J; p follows from r.
    [[nodiscard]] double kinetic_energy(const BodyState& y) const;
    [[nodiscard]] double roll_rate(const BodyState& y) const;
    /// World velocity of the centre of gravity.
    [[nodiscard]] static Vector3 world_velocity(const BodyState& y);
    /// Z of the centre of gravity at rest on the flat ground with this gap and pitch.
    [[nodiscard]] double height_for_gap(double gap, double theta) const;
    [[nodiscard]] const std::vector<Jet>& jets() const { return model_.jets; }
    [[nodiscard]] const Model& model() const { return model_; }

private:
    struct Accelerations;
    void accelerations(const BodyState& y, std::span<const double> thrust, const std::array<double, 2>& normal,
                       double* out) const;
    [[nodiscard]] ContactProblem problem(const BodyState& y, std::span<const double> thrust) const;
    [[nodiscard]] std::array<double, 2> gap_accelerations(const BodyState& y, const double* out) const;
    Model model_;
    Conditions held_;
    double sx_, sy_, sz_, sp_, sq_, sr_, ax_, ay_, az_;
    double buoyancy_, depth_, half_length_;
    bool has_lift_ = false, has_moment_ = false, has_drag_ = false;
};

struct BodyTrajectory {
    std::vector<double> time;
    std::vector<BodyState> state;
    std::vector<double> roll_rate, gap;
    std::vector<std::array<double, 2>> normal;
    std::vector<ContactState> contact;
    struct Event {
        double time = 0;
        std::string kind;  ///< "impact nose edge", "free", "flat", ...: the contact state from then on
    };
    std::vector<Event> events;
    std::string end = "time";
    [[nodiscard]] core::Table table() const;
};

struct BodyOptions {
    double duration = 10, output_step = 0.05, tolerance = 1e-9;
    double escape_gap = 0;  ///< 0: never
};

/// `command(t, state)` gives the commanded thrusts; jets follow with their lags and within their limits.
/// Throws core::InputError for a start in the ground, core::Error for contradictory contact.
BodyTrajectory simulate_body(const RigidBody& body, const BodyState& start,
                             const std::function<std::vector<double>(double, const BodyState&)>& command,
                             const BodyOptions& options, core::Progress& progress = core::Progress::none());

/// A and B of all ten independent states about a state in free water, inputs the jets.
LinearSystem linearise_body(const RigidBody& body, const BodyState& trim, const std::vector<double>& thrust);

}  // namespace underbody::dynamics
