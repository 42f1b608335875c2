#include "surrogates/dynamics/exports/motion_fmu.h"

#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "core/text.h"
#include "surrogates/dynamics/exports/motion_code.h"
#include "surrogates/dynamics/exports/motion_description.h"
#include "surrogates/dynamics/model/force_sources.h"
#include "surrogates/dynamics/model/source_shares.h"
#include "surrogates/dynamics/model/taken_as_zero.h"
#include "surrogates/dynamics/plant/environment.h"
#include "surrogates/dynamics/plant/pitch_effects.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/rigid_body.h"
#include "surrogates/dynamics/simulate/trajectory_parts.h"
#include "surrogates/tables/exports/export.h"
#include "surrogates/tables/exports/fmu_package.h"

namespace underbody::dynamics {

namespace {

void warn(MotionFmu& fmu, std::string text) {
    fmu.remarks.push_back({core::Problem::Severity::warning, std::move(text), {}});
}

std::vector<Channel> own_channels(FmuMotion motion) {
    std::vector<Channel> own{Channel::gap, Channel::heave_velocity, Channel::time, Channel::input_force};
    if (motion != FmuMotion::heave) {
        own.insert(own.end(), {Channel::pitch, Channel::pitch_rate});
    }
    if (motion == FmuMotion::body) {
        own.push_back(Channel::speed);
    }
    return own;
}

std::vector<std::string> quantities_of(FmuMotion motion) {
    if (motion == FmuMotion::heave) {
        return {"lift_force"};
    }
    if (motion == FmuMotion::heave_pitch) {
        return {"lift_force", "pitch_moment", "drag_force"};
    }
    return {"lift_force", "drag_force", "side_force", "roll_moment", "pitch_moment", "yaw_moment"};
}

/// Channels that a force of the motion depends on and that the motion does not bring: where one is an axis of a table
/// or scales it, and the speed that shelters a jet's.
std::vector<Channel> varying_of(const Model& model, FmuMotion motion) {
    std::vector<Channel> found;
    const std::vector<Channel> own = own_channels(motion);
    const std::vector<std::string> quantities = quantities_of(motion);
    const auto add = [&](Channel channel) {
        // Drag and friction of a run in heave and pitch are those of a held speed.
        const bool held = motion == FmuMotion::heave_pitch && channel == Channel::speed;
        if (!held && std::find(own.begin(), own.end(), channel) == own.end() &&
            std::find(found.begin(), found.end(), channel) == found.end()) {
            found.push_back(channel);
        }
    };
    for (const ForceSource& source : model.forces) {
        if (std::find(quantities.begin(), quantities.end(), source.quantity) == quantities.end()) {
            continue;
        }
        for (const Channel channel : source.axes) {
            add(channel);
        }
        for (const ForceScale& scale : source.scales) {
            add(scale.channel);
        }
        if (model.coupling.kind == Coupling::Kind::sheltered && driven_by_jet(source)) {
            add(Channel::speed);
        }
    }
    return found;
}

double start_of(const Model& model, const Conditions& held, Channel channel) {
    if (held.has(channel)) {
        return held[channel];
    }
    for (const ForceSource& source : model.forces) {
        for (const ForceScale& scale : source.scales) {
            if (scale.channel == channel) {
                return scale.reference;
            }
        }
        for (std::size_t k = 0; k < source.axes.size(); ++k) {
            if (source.axes[k] == channel && source.table.axes()[k].lower > 0) {
                return source.table.axes()[k].lower;
            }
        }
    }
    return 0;
}

void add_inputs(MotionSource& of) {
    auto& inputs = of.fmu.inputs;
    const Actuator& actuator = of.vertical.terms.actuator;
    inputs.push_back(
        {"input_force", "N", "force commanded, up, before the actuator", of.held.get(Channel::input_force, 0)});
    if (actuator.delay > 0) {
        inputs.back().meaning += ", which it reaches " + core::format_number(actuator.delay, 6) +
                                 " s later; before the start it is that of the start";
    }
    if (of.motion == FmuMotion::body) {
        for (const Jet& jet : of.model.jets) {
            inputs.push_back({tables::identifier(jet.name) + "_command", "N",
                              "thrust commanded of the jet, " + core::format_number(jet.minimum, 6) + " to " +
                                  core::format_number(jet.maximum, 6) + " N",
                              0});
        }
    }
    for (const Channel channel : of.varying) {
        inputs.push_back({channel_name(channel), channel_unit(channel),
                          "that scales a force or is an axis of its table", start_of(of.model, of.held, channel)});
    }
}

void add_states(MotionSource& of, const std::vector<double>& start) {
    auto& states = of.fmu.states;
    if (of.motion == FmuMotion::body) {
        static const char* const units[] = {"m/s", "m/s", "m/s", "rad/s", "rad/s", "rad", "rad", "m", "m", "m"};
        static const char* const meanings[] = {
            "forward, body axes", "to starboard", "down",  "pitch rate", "yaw rate",
            "pitch, nose up",     "heading",      "north", "east",       "down, ground at 0, of the centre of gravity"};
        for (std::size_t i = 0; i < body_state_names().size(); ++i) {
            states.push_back({body_state_names()[i], units[i], meanings[i], start.at(i)});
        }
    } else {
        states.push_back({"gap", "m", "height of the base's centre over the ground", start.at(0)});
        states.push_back({"heave_velocity", "m/s", "rate of the gap", start.at(1)});
        if (of.motion == FmuMotion::heave_pitch) {
            states.push_back({"pitch", "rad", "nose up", start.at(2)});
            states.push_back({"pitch_rate", "rad/s", "nose up", start.at(3)});
        }
    }
    of.fmu.start_states = states.size();
    for (const Jet& jet : of.motion == FmuMotion::body ? of.model.jets : std::vector<Jet>{}) {
        if (jet.lag > 0) {
            states.push_back({tables::identifier(jet.name) + "_thrust", "N", "thrust of the jet after its lag", 0});
        }
    }
    if (of.vertical.terms.actuator.lag > 0) {
        states.push_back({"acting_force", "N", "input force after the actuator's lag", 0});
    }
    for (std::size_t i = 0; of.vertical.terms.history != 0 && i < history_states; ++i) {
        states.push_back({"memory_" + std::to_string(i + 1), "m/s", "memory of the water (history force)", 0});
    }
}

void add_outputs(MotionSource& of) {
    auto& outputs = of.fmu.outputs;
    const MotionFmuVariable lift{"lift_force", "N", "of the force tables, up", 0},
        moment{"pitch_moment", "N m", "of the force tables about the base's centre, nose up", 0},
        input{"applied_force", "N", "input force as it reaches the body, up", 0},
        nose{"nose_edge_force", "N", "of the ground on the nose edge", 0},
        tail{"tail_edge_force", "N", "of the ground on the tail edge", 0},
        contact{"contact", "1",
                of.motion == FmuMotion::heave ? "1 on the ground" : "0 free, 1 nose edge, 2 tail edge, 3 flat", 0},
        outside{"outside_table", "1", "1 where a force table is asked beyond its range", 0};
    if (of.motion == FmuMotion::heave) {
        outputs = {lift, input, contact, outside};
    } else if (of.motion == FmuMotion::heave_pitch) {
        outputs = {lift, moment, input, nose, tail, contact, outside};
    } else {
        outputs = {{"gap", "m", "height of the base's centre over the ground", 0},
                   {"heave_velocity", "m/s", "rate of the gap", 0},
                   {"p", "rad/s", "roll rate that keeps roll at zero", 0},
                   lift,
                   {"drag_force", "N", "of the force tables, against the speed", 0},
                   moment,
                   input,
                   nose,
                   tail,
                   contact,
                   outside};
    }
}

[[noreturn]] void refuse_start(const Model& model, double lowest) {
    throw core::InputError("range",
                           "the start lies in the ground: an edge of the base is " +
                               core::format_number(-1e3 * lowest, 4) + " mm below it",
                           {model.name, {}, {}, {}}, "start higher, or set [contact] gap in the model");
}

/// What the motion needs of the model is checked where the motion is made.
void check(const MotionSource& of, const std::vector<double>& start) {
    if (of.motion == FmuMotion::heave) {
        if (start.at(0) < of.vertical.terms.contact_gap) {
            refuse_start(of.model, start[0] - of.vertical.terms.contact_gap);
        }
        for (const HeaveSource& source : of.vertical.terms.sources) {
            if (source.shares && !source.table.empty()) {
                throw core::InputError("effect",
                                       "effects of the model act on a force table over the heave velocity: "
                                       "this motion cannot be written as an FMU",
                                       {of.model.name, {}, {}, {}});
            }
        }
    } else {
        std::array<double, 2> gaps{};
        if (of.motion == FmuMotion::heave_pitch) {
            PitchState y{};
            std::copy_n(start.begin(), y.size(), y.begin());
            gaps = HeavePitch(of.model, of.held, of.varying).edge_gaps(y);
        } else {
            BodyState y{};
            std::copy_n(start.begin(), y.size(), y.begin());
            gaps = RigidBody(of.model, of.held, of.varying).edge_gaps(y);
        }
        if (std::min(gaps[0], gaps[1]) < -start_depth) {
            refuse_start(of.model, std::min(gaps[0], gaps[1]));
        }
    }
    if (!of.vertical.terms.extras.empty()) {
        throw core::InputError("effect",
                               "an effect of the model is known as a function of this program alone: its "
                               "motion cannot be written as an FMU",
                               {of.model.name, {}, {}, {}});
    }
}

/// In heave, shares of tables are functions of the program: what they depend on is held.
void hold_what_effects_need(const Model& model, FmuMotion motion, std::vector<Channel>& varying, MotionFmu& fmu) {
    if (motion != FmuMotion::heave || varying.empty()) {
        return;
    }
    std::string effects, held;
    for (const EffectUse& use : effects_on_tables(model, "lift_force")) {
        effects += (effects.empty() ? "" : ", ") + use.name;
    }
    if (effects.empty()) {
        return;
    }
    for (const Channel channel : varying) {
        held += (held.empty() ? "" : ", ") + std::string(channel_name(channel));
    }
    warn(fmu, "held, no inputs of the FMU, because " + effects + " of the model changes the force with them: " + held);
    varying.clear();
}

/// Drag, friction and the scales of forces of a run in heave and pitch are those of one speed.
void say_held_speed(const Model& model, const Conditions& held, MotionFmu& fmu) {
    const bool scales = std::any_of(model.forces.begin(), model.forces.end(), [](const ForceSource& source) {
        return std::find(source.axes.begin(), source.axes.end(), Channel::speed) != source.axes.end() ||
               std::any_of(source.scales.begin(), source.scales.end(),
                           [](const ForceScale& scale) { return scale.channel == Channel::speed; });
    });
    if (scales || held.get(Channel::speed, 0) != 0) {
        warn(fmu, "the speed is held at " + core::format_number(start_of(model, held, Channel::speed), 6) +
                      " m/s, no input: this motion is that of one speed");
    }
}

void check_file(const std::filesystem::path& path, bool overwrite) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored) || overwrite) {
        return;
    }
    if (std::filesystem::is_directory(path, ignored) ||
        core::read_file(path).substr(0, 4096).find("by Underbody") == std::string::npos) {
        throw core::InputError("exists", "the file is there and is no FMU that Underbody wrote",
                               {path.string(), {}, {}, {}}, "choose another name, or say option 'overwrite'");
    }
}

}  // namespace

const std::vector<std::string>& fmu_motions() {
    static const std::vector<std::string> names{"heave", "heave-pitch", "body"};
    return names;
}

MotionFmu export_motion_fmu(const Model& declared, const std::filesystem::path& path, const MotionFmuOptions& options) {
    check_file(path, options.overwrite);
    const Model model = declared.resolved();
    const Conditions held = options.held.over(model.conditions).over(references_of(model));
    MotionFmu fmu;
    fmu.file = path;
    fmu.remarks = motion_remarks(model, held);
    if (options.motion == FmuMotion::body) {
        const core::Problems unsaid = taken_as_zero_of_body(model, true);
        fmu.remarks.insert(fmu.remarks.end(), unsaid.begin(), unsaid.end());
    }
    std::vector<Channel> varying = varying_of(model, options.motion);
    hold_what_effects_need(model, options.motion, varying, fmu);
    if (options.motion == FmuMotion::heave_pitch) {
        say_held_speed(model, held, fmu);
    }
    const HeavePlant vertical =
        options.motion == FmuMotion::heave ? HeavePlant(model, held, varying) : vertical_channel(model, held, varying);
    if (options.motion != FmuMotion::heave) {
        refuse_pitch_effects(model, vertical.terms, options.motion == FmuMotion::body);
    }
    MotionSource source{model, options.motion, held, own_channels(options.motion), varying, vertical, fmu};
    check(source, options.start);
    add_inputs(source);
    add_states(source, options.start);
    add_outputs(source);
    const std::string name = tables::identifier(options.name.empty() ? path.stem().string() : options.name);
    const std::string code = motion_code(source), guid = tables::fmu_guid(code);
    tables::write_fmu(path, name, motion_description(source, name, guid),
                      {{"fmu.c", "#define GUID \"" + guid + "\"\n" + code}}, fmu.remarks);
    return fmu;
}

}  // namespace underbody::dynamics
