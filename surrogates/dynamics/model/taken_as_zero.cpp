#include "surrogates/dynamics/model/taken_as_zero.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "core/counted.h"
#include "core/units.h"
#include "surrogates/dynamics/model/force_sources.h"

namespace underbody::dynamics {

namespace {

bool declares(const Model& model, const std::string& name) {
    return std::find(model.declared.begin(), model.declared.end(), name) != model.declared.end();
}

/// Is there an effect beside the declared numbers of this name, or in the place of one of them?
bool has_effect(const Model& model, const std::string& name) {
    return std::any_of(model.effects.begin(), model.effects.end(), [&](const EffectUse& use) {
        return effect(use.name).info().search.adds_to == name || use.parameter.starts_with(name + ".");
    });
}

struct Law {
    std::string name;  ///< "drag.surge"
    const DragLaw* law;
};

core::Problems taken_as_zero(const Model& model, const std::vector<Law>& laws, bool touches,
                             const std::string& motion) {
    std::vector<std::string> unsaid;
    for (const Law& one : laws) {
        const bool said = one.law->linear != 0 || one.law->quadratic != 0 || declares(model, one.name + ".linear") ||
                          declares(model, one.name + ".quadratic") || has_effect(model, one.name);
        const std::vector<std::string> quantities = model.quantities();
        const bool by_table = one.name == "drag.surge" &&
                              std::find(quantities.begin(), quantities.end(), "drag_force") != quantities.end();
        if (!said && !by_table) {
            unsaid.push_back(one.name);
        }
    }
    if (touches && model.contact.friction == 0 && !declares(model, "contact.friction") &&
        !has_effect(model, "contact")) {
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
    return taken_as_zero(
        model, {{"drag.surge", &model.drag_surge}, {"drag.sway", &model.drag_sway}, {"drag.yaw", &model.drag_yaw}},
        true, "on the ground");
}

core::Problems taken_as_zero_of_body(const Model& model, bool touches) {
    return taken_as_zero(model,
                         {{"drag.surge", &model.drag_surge},
                          {"drag.sway", &model.drag_sway},
                          {"drag.heave", &model.drag_heave},
                          {"drag.pitch", &model.drag_pitch},
                          {"drag.yaw", &model.drag_yaw}},
                         touches, "in the motion of the whole body");
}

namespace {

/// Columns of forces, voltages and flows, with which an input may have been meant: "lift_force" or "jet_voltage".
std::set<std::string> likely_inputs(const MeasuredRun& run) {
    std::set<std::string> names;
    for (const core::Column& column : run.table.columns()) {
        const bool alike = !column.is_text() && !column.name.ends_with("_sigma") &&
                           (core::same_dimension(column.unit, "N") || core::same_dimension(column.unit, "V") ||
                            core::same_dimension(column.unit, "m^3/s"));
        if (alike) {
            names.insert(column.name);
        }
    }
    return names;
}

}  // namespace

core::Problems input_taken_as_zero(const Model& model, const Measurements& data) {
    const bool by_jet = std::any_of(model.forces.begin(), model.forces.end(), driven_by_jet);
    std::set<std::string> instead;
    std::size_t without = 0;
    std::string first;
    for (const MeasuredRun& run : data.runs) {
        if (run.has("input_force") || (by_jet && (run.has("jet_voltage") || run.has("jet_flow")))) {
            continue;
        }
        first = without++ == 0 ? run.table.source : first;
        instead.merge(likely_inputs(run));
    }
    if (without == 0) {
        return {};
    }
    std::string list;
    for (const std::string& name : instead) {
        list += (list.empty() ? "" : ", ") + name;
    }
    return {{core::Problem::Severity::warning,
             "no input_force is recorded in " + std::to_string(without) + " of " +
                 core::counted(data.runs.size(), "run") + "; none is taken to act" +
                 (list.empty() ? ""
                               : " (" + list + (instead.size() == 1 ? " is" : " are") +
                                     " not taken for it: a force that acted is a column input_force)") +
                 ". conditions.input_force = 0 says that nothing pushes",
             {first, {}, {}, {}}}};
}

core::Problems taken_as_zero(const std::string& motion, const Model& model, const Measurements& data) {
    return motion == "surface" ? taken_as_zero_on_ground(model)
           : motion == "body"  ? taken_as_zero_of_body(model, false)
                               : input_taken_as_zero(model, data);
}

}  // namespace underbody::dynamics
