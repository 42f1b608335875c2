#include "surrogates/dynamics/model/taken_as_zero.h"

#include <algorithm>
#include <string>
#include <vector>

namespace underbody::dynamics {

namespace {

bool declares(const Model& model, const std::string& name) {
    return std::find(model.declared.begin(), model.declared.end(), name) != model.declared.end();
}

bool has_one(const Model& model, const std::vector<const char*>& effects) {
    return std::any_of(model.effects.begin(), model.effects.end(), [&](const EffectUse& use) {
        return std::any_of(effects.begin(), effects.end(), [&](const char* name) {
            return use.name == name ||
                   (use.name == "declared_parameter" && use.parameter.starts_with(std::string(name) + "."));
        });
    });
}

struct Law {
    std::string name;  ///< "drag.surge"
    const DragLaw* law;
    std::vector<const char*> effects;  ///< in its place, and what may change it
};

core::Problems taken_as_zero(const Model& model, const std::vector<Law>& laws, bool touches,
                             const std::string& motion) {
    std::vector<std::string> unsaid;
    for (const Law& one : laws) {
        const bool said = one.law->linear != 0 || one.law->quadratic != 0 || declares(model, one.name + ".linear") ||
                          declares(model, one.name + ".quadratic") || has_one(model, one.effects);
        const std::vector<std::string> quantities = model.quantities();
        const bool by_table = one.name == "drag.surge" &&
                              std::find(quantities.begin(), quantities.end(), "drag_force") != quantities.end();
        if (!said && !by_table) {
            unsaid.push_back(one.name);
        }
    }
    if (touches && model.contact.friction == 0 && !declares(model, "contact.friction") &&
        !has_one(model, {"ground_friction", "contact"})) {
        unsaid.emplace_back("contact.friction");
    }
    if (unsaid.empty()) {
        return {};
    }
    std::string list;
    for (std::size_t i = 0; i < unsaid.size(); ++i) {
        list += (i == 0 ? "" : i + 1 < unsaid.size() ? ", " : " and ") + unsaid[i];
    }
    return {{core::Problem::Severity::warning,
             "the model does not say " + list + (unsaid.size() == 1 ? ": it counts" : ": they count") + " as 0 " +
                 motion + "; declare " + (unsaid.size() == 1 ? "it" : "them") + ", a 0 too",
             {model.name, {}, {}, {}}}};
}

}  // namespace

core::Problems taken_as_zero_on_ground(const Model& model) {
    return taken_as_zero(model,
                         {{"drag.surge", &model.drag_surge, {"surge_damping", "drag.surge"}},
                          {"drag.sway", &model.drag_sway, {"sway_damping", "drag.sway"}},
                          {"drag.yaw", &model.drag_yaw, {"yaw_damping", "drag.yaw"}}},
                         true, "on the ground");
}

core::Problems taken_as_zero_of_body(const Model& model, bool touches) {
    return taken_as_zero(model,
                         {{"drag.surge", &model.drag_surge, {"surge_damping", "drag.surge"}},
                          {"drag.sway", &model.drag_sway, {"sway_damping", "drag.sway"}},
                          {"drag.heave",
                           &model.drag_heave,
                           {"linear_damping", "quadratic_damping", "squeeze_film_damping", "drag.heave"}},
                          {"drag.pitch", &model.drag_pitch, {"pitch_damping", "pitch_quadratic_damping", "drag.pitch"}},
                          {"drag.yaw", &model.drag_yaw, {"yaw_damping", "drag.yaw"}}},
                         touches, "in the motion of the whole body");
}

core::Problems taken_as_zero(const std::string& motion, const Model& model) {
    return motion == "surface" ? taken_as_zero_on_ground(model)
           : motion == "body"  ? taken_as_zero_of_body(model, false)
                               : core::Problems{};
}

}  // namespace underbody::dynamics
