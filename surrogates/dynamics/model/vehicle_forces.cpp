#include "surrogates/dynamics/model/vehicle_forces.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/text.h"
#include "surrogates/dynamics/model/effect.h"

namespace underbody::dynamics {

namespace {

void remark(core::Problems& remarks, const Model& model, std::string text) {
    remarks.push_back({core::Problem::Severity::warning, std::move(text), {model.name, {}, {}, {}}});
}

bool contains(const std::vector<Channel>& list, Channel channel) {
    return std::find(list.begin(), list.end(), channel) != list.end();
}

}  // namespace

Model of_the_vehicle(const Model& model, core::Problems& remarks) {
    if (model.forces.empty()) {
        throw core::InputError("missing", "the model has no force source", {model.name, {}, {}, {}},
                               "declare it: [[force]] quantity = \"lift_force\", table = ...");
    }
    Model kept = model.resolved();
    std::string left;
    std::erase_if(kept.effects, [&left](const EffectUse& use) {
        const EffectInfo& info = effect(use.name).info();
        const bool goes = info.belongs_to_the_rig || info.seen_in == SeenIn::time_series;
        if (goes) {
            left += (left.empty() ? "" : ", ") + use.name;
        }
        return goes;
    });
    if (!left.empty()) {
        const std::string said = "left out of the force, because it belongs to the rig or to the motion: " + left;
        remark(remarks, model, said);
        remark(kept.remarks, model, said);  // what its numbers are worth, wherever they are read
    }
    return kept;
}

void hold_scales(const Model& model, const std::vector<Channel>& axes, Conditions& held, core::Problems& remarks) {
    const Conditions known = model.conditions.over(references_of(model));
    std::set<Channel> said;
    for (const ForceSource& source : model.forces) {
        for (const ForceScale& scale : source.scales) {
            const Channel channel = scale.channel;
            if (contains(axes, channel) || held.has(channel) || !said.insert(channel).second) {
                continue;
            }
            if (!known.has(channel)) {
                remark(remarks, model,
                       std::string(channel_name(channel)) +
                           " is not held: the scales of the forces have several "
                           "references, and each force is taken at its own");
                continue;
            }
            held[channel] = known[channel];
            remark(remarks, model,
                   std::string(channel_name(channel)) + " is held at " + core::format_number(held[channel], 6) + " " +
                       channel_unit(channel) +
                       (model.conditions.has(channel) ? ", the model's condition" : ", the reference of its scale"));
        }
    }
}

void add_constants(core::Table& points, const Model& model, const std::vector<Channel>& axes, const Conditions& held) {
    const auto add = [&](const char* name, const char* unit, double value) {
        if (points.find(name) == nullptr && std::isfinite(value)) {  // what the model does not state is not stated here
            points.add_numbers(name, unit, std::vector<double>(points.rows(), value));
        }
    };
    for (std::size_t i = 0; i < channel_count; ++i) {
        const auto channel = static_cast<Channel>(i);
        if (held.has(channel) && !contains(axes, channel)) {
            add(channel_name(channel), channel_unit(channel), held[channel]);
        }
    }
    add("mass", "kg", model.vehicle.mass);
    if (const auto& over_gap = model.vehicle.added_mass_heave_table) {  // no one number: its range
        const std::vector<double>& gaps = over_gap->axes()[0].points;
        std::vector<double> masses;
        for (const double gap : gaps) {
            masses.push_back(over_gap->value(&gap));
        }
        const auto ends = std::minmax_element(masses.begin(), masses.end());
        add("added_mass_heave_lowest", "kg", *ends.first);
        add("added_mass_heave_highest", "kg", *ends.second);
    } else {
        add("added_mass_heave", "kg", model.vehicle.added_mass_heave);
    }
    add("net_weight", "N", model.vehicle.net_weight);
    add("length", "m", model.vehicle.length);
    add("width", "m", model.vehicle.width);
    add("density", "kg/m^3", model.environment.density);
}

}  // namespace underbody::dynamics
