// Motion on the ground, flat on its base: surge, sway, yaw and heading (docs/physics.md sections 3.1 and 3.3, contact
// state "flat").
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "core/table.h"
#include "surrogates/dynamics/linear/linear.h"
#include "surrogates/dynamics/model/force_sources.h"
#include "surrogates/dynamics/simulate/rigid_body.h"

namespace underbody::dynamics {

/// u, v (m/s), r (rad/s), psi (rad), X, Y (m) of the centre of gravity.
using SurfaceState = std::array<double, 6>;

/// S_x u' = X + S_y r v,  S_y v' = Y - S_x r u,  S_r r' = N + (A_x - A_y) u v. The normal force balances the vertical
/// forces; its point x_n balances the pitch moments, and friction acts there against the slip.
class SurfaceMotion {
public:
    /// Throws core::InputError: no yaw inertia, a table axis that nothing supplies.
    explicit SurfaceMotion(const Model& model, const Conditions& held = {}, const std::vector<Channel>& varying = {});

    struct Contact {
        double normal = 0;                      ///< N; negative: nothing presses the body down any more
        double forward = 0;                     ///< m, of the resultant before the centre of gravity (x_n)
        double friction_x = 0, friction_y = 0;  ///< N, body axes
    };
    [[nodiscard]] Contact contact(const SurfaceState& y, std::span<const double> thrust,
                                  const Surroundings& around = {}) const;
    void rate(const SurfaceState& y, std::span<const double> thrust, SurfaceState& dydt,
              const Surroundings& around = {}) const;

    [[nodiscard]] const std::vector<Jet>& jets() const { return model_.jets; }
    [[nodiscard]] const Model& model() const { return model_; }
    [[nodiscard]] const HeavePlant& vertical() const { return vertical_; }
    /// Virtual masses in surge and sway, kg, and inertia in yaw, kg m^2.
    [[nodiscard]] std::array<double, 3> inertias() const { return {mass_x_, mass_y_, inertia_}; }
    /// Nose and tail end of the base before the centre of gravity; infinite when its length is not declared.
    [[nodiscard]] double nose() const { return nose_; }
    [[nodiscard]] double tail() const { return tail_; }
    /// States u, v, r, psi; inputs the wrench X, Y, N of the jets, or each jet when the model has some and `by_jet`.
    [[nodiscard]] LinearSystem linearised(const SurfaceState& trim, const std::vector<double>& thrust,
                                          bool by_jet) const;

private:
    struct Loads {
        double x = 0, y = 0, turn = 0;  ///< N, N, N m, without friction
        double up = 0, pitch = 0;       ///< N, N m nose up about the centre of gravity, without contact
    };
    [[nodiscard]] Loads loads(const SurfaceState& y, std::span<const double> thrust, const Surroundings& around) const;
    [[nodiscard]] Contact contact(const SurfaceState& y, const Loads& loads) const;
    Model model_;
    Conditions held_;
    HeavePlant vertical_;
    std::vector<Jet> acting_;  ///< as effects of the model gain and turn them
    ForceSources lift_, drag_, side_, pitch_moment_, yaw_moment_;
    double mass_x_ = 0, mass_y_ = 0, inertia_ = 0, gap_ = 0, buoyancy_moment_ = 0;
    double nose_ = 0, tail_ = 0;
    Vector3 base_{};
};

struct SurfaceTrajectory {
    std::vector<double> time;
    std::vector<SurfaceState> state;
    std::vector<SurfaceMotion::Contact> contact;
    std::vector<std::vector<double>> thrust;
    std::vector<std::string> jets;
    std::vector<TrajectoryEvent> events;  ///< lift_off, tips over the nose or tail edge, equilibrium
    std::string end = "time";             ///< "time", "lift_off", "tips on the nose edge", ..., "equilibrium"
    core::Problems remarks;
    [[nodiscard]] core::Table table() const;
};
/// Until the body leaves the ground, tips, comes to a steady run (when asked) or the time is over. Jets as in
/// simulate_body; `command` sees the body's ten states with w, q and theta zero.
SurfaceTrajectory simulate_surface(const SurfaceMotion& motion, const SurfaceState& start, const JetCommand& command,
                                   const BodyOptions& options, core::Progress& progress = core::Progress::none(),
                                   const InputSignals& inputs = {});
core::Figure trajectory_figure(const SurfaceTrajectory& trajectory);
void to_json(nlohmann::json& json, const SurfaceTrajectory& trajectory);

/// Steady straight run at this speed: the least thrusts of the jets that balance surge (and turn nothing).
/// Throws core::InputError when the jets cannot, or when the body would lift off.
std::vector<double> surface_trim_thrusts(const SurfaceMotion& motion, double speed);

}  // namespace underbody::dynamics
