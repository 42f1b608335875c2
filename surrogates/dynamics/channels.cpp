#include "surrogates/dynamics/channels.h"

#include "core/error.h"

namespace underbody::dynamics {

namespace {

struct Entry {
    const char* name;
    const char* unit;
};

constexpr Entry entries[channel_count] = {
    {"time", "s"},
    {"gap", "m"},
    {"heave_velocity", "m/s"},
    {"pitch", "rad"},
    {"pitch_rate", "rad/s"},
    {"speed", "m/s"},
    {"jet_voltage", "V"},
    {"jet_flow", "m^3/s"},
    {"input_force", "N"},
    {"temperature", "K"},
    {"depth", "m"},
    {"approach_direction", "1"},
};

}  // namespace

const char* channel_name(Channel channel) { return entries[static_cast<std::size_t>(channel)].name; }
const char* channel_unit(Channel channel) { return entries[static_cast<std::size_t>(channel)].unit; }

bool find_channel(std::string_view name, Channel& channel) {
    for (std::size_t i = 0; i < channel_count; ++i) {
        if (name == entries[i].name) {
            channel = static_cast<Channel>(i);
            return true;
        }
    }
    return false;
}

std::vector<std::string> channel_names() {
    std::vector<std::string> names;
    for (const Entry& entry : entries) {
        names.emplace_back(entry.name);
    }
    return names;
}

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
