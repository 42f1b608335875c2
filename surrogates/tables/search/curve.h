// Numbers that a body has by whole curves of its forces over gap and pitch, not by a force at one place: the kick that
// a balance survives, the window of pitch in which the body is held. What they mean: docs/glossary.md.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/no_limit.h"

namespace underbody::tables {

enum class Curve {
    kick,         ///< m/s, the largest `kick_velocity` of the stable equilibria over the gap
    pitch_window  ///< rad, the largest pitch either way from a given one up to which everything asked for holds
};

/// "kick", "pitch_window".
std::string to_string(Curve curve);
std::optional<Curve> curve_named(std::string_view name);
std::vector<std::string> curve_names();
/// SI.
std::string unit_of(Curve curve);

/// What is asked of curves.
struct CurveAsked {
    Curve curve = Curve::kick;
    /// N, weight less buoyancy. Of a pitch window: a stable equilibrium over the gap is asked for at every pitch, and
    /// the moment is that at its gap; without, the gap is a condition.
    std::optional<double> net_weight;
    double virtual_mass = 0;  ///< kg, mass + added mass in heave, of a kick
    double about = 0;         ///< rad, the pitch that a window lies about
    bool restoring = false;   ///< of a window: that the moment falls as the nose rises (along the equilibria)
    double most_moment = core::no_limit;  ///< N m, of a window: that the size of the moment is at most this
    std::string moment;                   ///< the quantity that `restoring` and `most_moment` are of

    /// "gap", "pitch".
    [[nodiscard]] std::vector<std::string> runs_over() const;
    [[nodiscard]] bool of_moment() const { return restoring || core::is_limit(most_moment); }
    friend bool operator==(const CurveAsked&, const CurveAsked&) = default;
};

}  // namespace underbody::tables
