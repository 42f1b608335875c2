// The named numbers that forces, effects and measurements share, as one flat array.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace underbody::dynamics {

/// What a force table, a scale or an effect may depend on. Names, units and signs as core::quantity_names().
enum class Channel {
    time,
    gap,
    heave_velocity,
    pitch,
    pitch_rate,
    speed,
    jet_voltage,
    jet_flow,
    input_force,
    temperature,
    depth,
    approach_direction,
};
inline constexpr std::size_t channel_count = 12;

const char* channel_name(Channel channel);
const char* channel_unit(Channel channel);  ///< SI
/// False when the name is not a channel.
bool find_channel(std::string_view name, Channel& channel);
std::vector<std::string> channel_names();

/// Values of the channels, SI; NaN where nothing is known.
struct Conditions {
    std::array<double, channel_count> value;

    Conditions() { value.fill(std::numeric_limits<double>::quiet_NaN()); }

    double& operator[](Channel channel) { return value[static_cast<std::size_t>(channel)]; }
    double operator[](Channel channel) const { return value[static_cast<std::size_t>(channel)]; }
    [[nodiscard]] bool has(Channel channel) const { return !std::isnan((*this)[channel]); }
    [[nodiscard]] double get(Channel channel, double fallback) const {
        return has(channel) ? (*this)[channel] : fallback;
    }
    /// Throws core::InputError with the nearest name when the name is not a channel.
    void set(std::string_view name, double value_si);
    /// Where this has no value, the one of `fallback`.
    [[nodiscard]] Conditions over(const Conditions& fallback) const;
};

}  // namespace underbody::dynamics
