// The force tables of one quantity, made ready for a motion: what is held is folded in, what varies is looked up.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// max(0, |value| - dead_band)/(reference - dead_band) to the power `exponent`; 1 where nothing is known of the value.
inline double scale_factor(double reference, double exponent, double dead_band, double value) {
    if (std::isnan(value)) {
        return 1;
    }
    const double above = std::max(0.0, std::abs(value) - dead_band) / (reference - dead_band);
    return above > 0 ? std::pow(above, exponent) : (exponent == 0 ? 1.0 : 0.0);
}
inline double scale_factor(const ForceScale& scale, double value) {
    return scale_factor(scale.reference, scale.exponent, scale.dead_band, value);
}

/// A force that a jet drives: it has jet_voltage or jet_flow among its axes or scales.
bool driven_by_jet(const ForceSource& source);
/// What the coupling law "sheltered" leaves of a jet's force in a cross-flow: 1/(1 + (speed/limit)^2).
inline double shelter_factor(double speed, double limit_speed) {
    const double ratio = std::isnan(speed) ? 0.0 : speed / limit_speed;
    return 1 / (1 + ratio * ratio);
}

/// Sum of the sources of one quantity in a motion, with the effects that act on its tables (effects_on_tables).
/// Immutable, safe to use from many threads.
class ForceSources {
public:
    ForceSources() = default;
    /// `held` has the values of channels that stay; `varying` names those that the motion or its inputs supply with
    /// every look-up. Throws core::InputError: an axis that neither holds nor varies.
    ForceSources(const Model& model, const std::string& quantity, const Conditions& held,
                 const std::vector<Channel>& varying);

    [[nodiscard]] bool empty() const { return sources_.empty(); }
    /// N or N m.
    [[nodiscard]] double operator()(const Conditions& at) const;
    /// Range of a channel that every table with this axis covers; infinite where none has it.
    [[nodiscard]] double lower(Channel channel) const { return lower_[static_cast<std::size_t>(channel)]; }
    [[nodiscard]] double upper(Channel channel) const { return upper_[static_cast<std::size_t>(channel)]; }

private:
    struct Source {
        tables::ForceTable table;
        double factor = 1;
        std::array<double, tables::max_axes> held{};
        std::vector<std::pair<std::size_t, Channel>> axes;  ///< index and channel of those that vary
        std::vector<ForceScale> scales;                     ///< that vary
        double shelter_speed = 0;                           ///< 0: not sheltered, or folded
    };
    [[nodiscard]] double sum(const Conditions& seen) const;
    std::vector<Source> sources_;
    std::array<double, channel_count> lower_{}, upper_{};
    std::shared_ptr<const StaticModel> with_effects_;  ///< nullptr: no effect acts on the tables
    Conditions held_;
};

}  // namespace underbody::dynamics
