// Where a motion starts, for the commands that take --from.
#pragma once

#include <optional>
#include <string>

#include "core/error.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/rigid_body.h"

namespace underbody::studio {

/// SI; what was not said is empty.
struct MotionStart {
    std::optional<double> gap, heave_velocity, pitch, pitch_rate, speed, sway_velocity, yaw_rate, heading, north, east;
    [[nodiscard]] bool turns() const { return pitch || pitch_rate; }
    [[nodiscard]] bool travels() const { return sway_velocity || yaw_rate || heading || north || east; }

    /// A warning that names the states which a motion has not: "heave", "heave-pitch", "surface", "body".
    [[nodiscard]] core::Problems not_used_in(const std::string& motion) const;
    /// Throws core::UsageError where it was not said.
    [[nodiscard]] double needed_gap() const;
    /// Zero where nothing was said; the speed is then that of the conditions. Throw as needed_gap().
    [[nodiscard]] dynamics::PitchState of_pitch() const;
    [[nodiscard]] dynamics::BodyState of_body(const dynamics::RigidBody& body, const dynamics::Conditions& held) const;
};

/// `gap=20 mm,heave_velocity=0,...`; a name that is no state is a condition and goes to `held`. Throws
/// core::UsageError, core::InputError: unknown names with the nearest one, units.
MotionStart motion_start(const std::string& text, dynamics::Conditions& held);

}  // namespace underbody::studio
