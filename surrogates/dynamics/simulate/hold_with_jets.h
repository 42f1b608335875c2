// Holding a heading, a speed, a gap or a pitch with the jets: the wrench that feedback wants, allocated within limits.
#pragma once

#include <optional>

#include "surrogates/dynamics/simulate/rigid_body.h"

namespace underbody::dynamics {

/// What is held and how hard. A gain that is NaN is chosen for the model (see `complete`).
struct VehicleHold {
    std::optional<double> heading;       ///< rad: N = K2 (heading - psi) - K1 r (docs/physics.md section 3.5)
    std::optional<double> speed;         ///< m/s: X = drag at that speed + K (speed - u)
    std::optional<double> gap;           ///< m: up = weight - lift at that gap - k_h (h - gap) - k_w dh/dt
    std::optional<double> pitch;         ///< rad: M = moment that the tables leave there - k_p (theta - pitch) - k_q q
    double heading_gain, yaw_rate_gain;  ///< N m/rad, N m s/rad
    double speed_gain;                   ///< N s/m
    double gap_gain, heave_gain;         ///< N/m, N s/m
    double pitch_gain, pitch_rate_gain;  ///< N m/rad, N m s/rad
    VehicleHold();
};

/// Feedback onto the jets of a model. Immutable; it sees the body's ten states.
class JetHold {
public:
    /// Throws core::InputError: a model without jets, nothing to hold.
    JetHold(const Model& model, const VehicleHold& hold, const Conditions& held = {});

    [[nodiscard]] Wrench wanted(const BodyState& y) const;
    [[nodiscard]] std::vector<double> thrusts(const BodyState& y) const;
    /// The hold with the gains that were chosen.
    [[nodiscard]] const VehicleHold& hold() const { return hold_; }
    [[nodiscard]] JetCommand command() const {
        return [hold = *this](double, const BodyState& y) { return hold.thrusts(y); };
    }

private:
    void complete(const Model& model, const Conditions& held);
    Model model_;
    VehicleHold hold_;
    Vector3 base_{};
    double drag_at_speed_ = 0, weight_ = 0, trim_moment_ = 0;
};

}  // namespace underbody::dynamics
