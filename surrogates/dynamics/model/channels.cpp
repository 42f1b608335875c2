#include "surrogates/dynamics/model/channels.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "core/error.h"
#include "core/units.h"

namespace underbody::dynamics {

namespace {

/// In the order of `Channel`; what they are in, the list of quantities says (core/units.h).
constexpr std::array<const char*, channel_count> names = {
    "time",        "gap",      "heave_velocity", "pitch",       "pitch_rate", "speed",
    "jet_voltage", "jet_flow", "input_force",    "temperature", "depth",      "approach_direction"};

std::array<const char*, channel_count> units_of_names() {
    std::array<const char*, channel_count> units{};
    for (std::size_t i = 0; i < channel_count; ++i) {
        const core::QuantityName* quantity = core::find_quantity(names[i]);
        if (quantity == nullptr) {
            throw std::logic_error(std::string("the channel '") + names[i] + "' is not in the list of quantities");
        }
        units[i] = quantity->unit.c_str();
    }
    return units;
}

}  // namespace

const char* channel_name(Channel channel) { return names[static_cast<std::size_t>(channel)]; }

const char* channel_unit(Channel channel) {
    static const auto units = units_of_names();
    return units[static_cast<std::size_t>(channel)];
}

bool find_channel(std::string_view name, Channel& channel) {
    const auto found = std::find(names.begin(), names.end(), name);
    channel = found == names.end() ? channel : static_cast<Channel>(found - names.begin());
    return found != names.end();
}

std::vector<std::string> channel_names() { return {names.begin(), names.end()}; }

void Conditions::set(std::string_view name, double value_si) {
    Channel channel{};
    if (!find_channel(name, channel)) {
        throw core::InputError("name", "no condition is called '" + std::string(name) + "'", {},
                               core::did_you_mean(std::string(name), channel_names()));
    }
    (*this)[channel] = value_si;
}

Conditions Conditions::over(const Conditions& fallback) const {
    Conditions result = *this;
    for (std::size_t i = 0; i < channel_count; ++i) {
        if (std::isnan(result.value[i])) {
            result.value[i] = fallback.value[i];
        }
    }
    return result;
}

}  // namespace underbody::dynamics
