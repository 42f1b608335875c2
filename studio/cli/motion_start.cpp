#include "studio/cli/motion_start.h"

#include <algorithm>
#include <tuple>

#include "core/error.h"
#include "core/units.h"

namespace underbody::studio {

namespace {

/// States of the body that have no place among the quantities that files share.
const std::vector<core::QuantityName>& body_names() {
    static const std::vector<core::QuantityName> names{{"sway_velocity", "m/s", "", ""},
                                                       {"yaw_rate", "rad/s", "", ""},
                                                       {"heading", "rad", "", ""},
                                                       {"north", "m", "", ""},
                                                       {"east", "m", "", ""}};
    return names;
}

}  // namespace

MotionStart motion_start(const std::string& text, dynamics::Conditions& held) {
    MotionStart start;
    const std::pair<const char*, std::optional<double> MotionStart::*> states[] = {
        {"gap", &MotionStart::gap},
        {"heave_velocity", &MotionStart::heave_velocity},
        {"pitch", &MotionStart::pitch},
        {"pitch_rate", &MotionStart::pitch_rate},
        {"sway_velocity", &MotionStart::sway_velocity},
        {"yaw_rate", &MotionStart::yaw_rate},
        {"heading", &MotionStart::heading},
        {"north", &MotionStart::north},
        {"east", &MotionStart::east}};
    for (const core::NamedValue& value : core::parse_assignments(text, body_names())) {
        const auto* const state = std::find_if(std::begin(states), std::end(states),
                                               [&](const auto& one) { return value.name == one.first; });
        if (state != std::end(states)) {
            start.*state->second = value.value;
        } else {
            held.set(value.name, value.value);
        }
        if (value.name == "speed") {
            start.speed = value.value;
        }
    }
    return start;
}

core::Problems MotionStart::not_used_in(const std::string& motion) const {
    const bool vertical = motion != "surface", turning = motion == "heave-pitch" || motion == "body",
               along = motion == "surface" || motion == "body";
    const std::tuple<const char*, std::optional<double>, bool> states[] = {{"gap", gap, vertical},
                                                                           {"heave_velocity", heave_velocity, vertical},
                                                                           {"pitch", pitch, turning},
                                                                           {"pitch_rate", pitch_rate, turning},
                                                                           {"sway_velocity", sway_velocity, along},
                                                                           {"yaw_rate", yaw_rate, along},
                                                                           {"heading", heading, along},
                                                                           {"north", north, along},
                                                                           {"east", east, along}};
    std::string list;
    for (const auto& [name, value, has] : states) {
        list += value.value_or(0) != 0 && !has ? (list.empty() ? "" : ", ") + std::string(name) : "";
    }
    if (list.empty()) {
        return {};
    }
    return {{core::Problem::Severity::warning,
             "of the start not used: " + list + "; the motion " +
                 (motion == "surface" ? "on the ground" : "in " + motion) + " has no such state",
             {}}};
}

double MotionStart::needed_gap() const {
    if (!gap) {
        throw core::UsageError("missing", "--from needs the gap to start at", {},
                               "for instance --from gap=20mm,heave_velocity=0");
    }
    return *gap;
}

dynamics::PitchState MotionStart::of_pitch() const {
    return {needed_gap(), heave_velocity.value_or(0), pitch.value_or(0), pitch_rate.value_or(0)};
}

dynamics::BodyState MotionStart::of_body(const dynamics::RigidBody& body, const dynamics::Conditions& held) const {
    dynamics::BodyState start{};
    start[dynamics::state_u] = speed.value_or(held.get(dynamics::Channel::speed, 0));
    start[dynamics::state_v] = sway_velocity.value_or(0);
    start[dynamics::state_q] = pitch_rate.value_or(0);
    start[dynamics::state_r] = yaw_rate.value_or(0);
    start[dynamics::state_theta] = pitch.value_or(0);
    start[dynamics::state_w] = body.down_velocity_for(heave_velocity.value_or(0), start);
    start[dynamics::state_psi] = heading.value_or(0);
    start[dynamics::state_x] = north.value_or(0);
    start[dynamics::state_y] = east.value_or(0);
    start[dynamics::state_z] = body.height_for_gap(needed_gap(), start[dynamics::state_theta]);
    return start;
}

}  // namespace underbody::studio
