// Actions on 3D views: how a hand turned them, and what is drawn around a body.
#include <cmath>

#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/state/action_parts.h"

namespace underbody::studio::action {

using core::UsageError;

std::optional<ViewPose> pose_from(const std::string& text) {
    if (text.empty()) {
        return {};
    }
    const auto fail = [&text] {
        throw UsageError("parse", "'" + text + "' is no place to look from", {},
                         "FROM/AT/UP/HEIGHT, such as 0.3,0.2,-0.1/0,0,0/0,0,1/0.05: metres in the axes of the file");
    };
    const auto parts = core::split(text, '/');
    if (parts.size() != 4) {
        fail();
    }
    ViewPose pose{};
    for (std::size_t part = 0; part < 4; ++part) {
        const auto numbers = core::split(parts[part], ',');
        if (numbers.size() != (part < 3 ? 3U : 1U)) {
            fail();
        }
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            pose[3 * part + i] = core::parse_in(numbers[i], part == 2 ? "1" : "m");
        }
    }
    const std::array<double, 3> to = {pose[3] - pose[0], pose[4] - pose[1], pose[5] - pose[2]};
    const std::array<double, 3> across = {to[1] * pose[8] - to[2] * pose[7], to[2] * pose[6] - to[0] * pose[8],
                                          to[0] * pose[7] - to[1] * pose[6]};
    if (!(std::hypot(across[0], across[1], across[2]) > 0) || !(pose[9] > 0)) {  // there is a way to look, and an up
        fail();
    }
    return pose;
}

State turn(State state, const Words& words, const Session&) {
    need(words, 1, 2, "turn design|compare [FROM/AT/UP/HEIGHT]");
    const auto pose = pose_from(words.size() > 1 ? words[1] : std::string());
    if (words[0] == "design") {
        state.design.turned = pose;
    } else if (words[0] == "compare") {
        state.fields.turned = pose;
    } else {
        unknown_key(words[0], {"design", "compare"});
    }
    return state;
}

State outline(State state, const Words& words, const Session&) {
    need(words, 1, 1, "outline on|off");
    state.design.outline = yes_or_no(words[0]);
    return state;
}

}  // namespace underbody::studio::action

namespace underbody::studio {

std::string text_of(const ViewPose& pose) {
    std::string text;
    for (std::size_t i = 0; i < pose.size(); ++i) {
        text += (i == 0 ? "" : i % 3 == 0 ? "/" : ",") + core::format_number(pose[i], 6);
    }
    return text;
}

}  // namespace underbody::studio
