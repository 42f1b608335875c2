#include "surrogates/discovery/hypothesis.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace underbody::discovery {

using dynamics::Channel;

namespace {

void add_use(Hypothesis& hypothesis, const dynamics::EffectInfo& info, const std::string& quantity) {
    dynamics::EffectUse use = dynamics::neutral_use(info.name);
    use.quantity = quantity;
    const std::size_t which = hypothesis.uses.size();
    for (std::size_t k = 0; k < info.parameters.size(); ++k) {
        const dynamics::EffectParameter& p = info.parameters[k];
        hypothesis.parameters.push_back({p.name, p.unit, p.lower, p.upper, p.neutral, p.typical});
        hypothesis.slots.push_back({which, k});
    }
    hypothesis.uses.push_back(std::move(use));
}

/// Starts on both sides of neutral and, for shapes, a factor of three either way.
void add_starts(Hypothesis& hypothesis) {
    std::vector<std::vector<double>> starts{{}};
    for (std::size_t j = 0; j < hypothesis.parameters.size(); ++j) {
        const FitParameter& p = hypothesis.parameters[j];
        const dynamics::EffectInfo& info = dynamics::effect(hypothesis.uses[hypothesis.slots[j].use].name).info();
        const bool shape = info.parameters[hypothesis.slots[j].value].shape;
        std::vector<double> values;
        if (shape) {
            values = {p.start, p.start - p.typical, p.start + p.typical};
        } else {
            values = {p.start + 0.5 * p.typical, p.start - 0.5 * p.typical};
        }
        std::vector<std::vector<double>> longer;
        for (const std::vector<double>& begun : starts) {
            for (const double value : values) {
                if (value >= p.lower && value <= p.upper) {
                    longer.push_back(begun);
                    longer.back().push_back(value);
                }
            }
        }
        if (longer.size() <= 9) {
            starts = std::move(longer);
        } else {
            for (std::vector<double>& begun : starts) {
                begun.push_back(shape ? p.start : std::min(p.start + 0.5 * p.typical, p.upper));
            }
        }
    }
    hypothesis.starts = std::move(starts);
}

Hypothesis make(const dynamics::EffectInfo& info, const std::vector<std::string>& quantities, const std::string& form) {
    Hypothesis hypothesis;
    hypothesis.names = {info.name};
    hypothesis.form = form;
    hypothesis.depends_on = info.depends_on;
    for (const std::string& quantity : quantities) {
        add_use(hypothesis, info, quantity);
    }
    add_starts(hypothesis);
    return hypothesis;
}

bool varies(const std::vector<Channel>& varying, const std::string& name) {
    Channel channel{};
    return dynamics::find_channel(name, channel) && std::find(varying.begin(), varying.end(), channel) != varying.end();
}

/// The channel without whose variation an effect cannot be told from others.
std::vector<std::string> channels_needed(const std::string& effect) {
    if (effect == "speed_exponent" || effect == "current") {
        return {"speed"};
    }
    if (effect == "temperature") {
        return {"temperature"};
    }
    if (effect == "drift") {
        return {"time"};
    }
    if (effect == "guide_friction") {
        return {"approach_direction"};
    }
    if (effect == "pump_curve") {
        return {"jet_voltage"};
    }
    if (effect == "gap_offset" || effect == "surface_roughness") {
        return {"gap"};
    }
    return {};
}

}  // namespace

std::vector<dynamics::EffectUse> Hypothesis::with(std::span<const double> p) const {
    std::vector<dynamics::EffectUse> result = uses;
    for (std::size_t j = 0; j < slots.size(); ++j) {
        result[slots[j].use].values[slots[j].value] = p[j];
    }
    return result;
}

std::string Hypothesis::label() const {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : " + ") + name;
    }
    return text.empty() ? "none" : text;
}

std::vector<Hypothesis> static_hypotheses(const std::vector<Channel>& varying, const std::vector<std::string>& quantities) {
    std::vector<Hypothesis> list;
    for (const dynamics::Effect* effect : dynamics::effects()) {
        const dynamics::EffectInfo& info = effect->info();
        if (info.seen_in == dynamics::SeenIn::time_series || info.takes_table || info.takes_parameter) {
            continue;
        }
        const std::vector<std::string> needed = channels_needed(info.name);
        if (!std::all_of(needed.begin(), needed.end(), [&](const std::string& name) { return varies(varying, name); })) {
            continue;
        }
        if ((info.name == "cable_buoyancy" || info.name == "strut_buoyancy") && !varies(varying, "gap") && !varies(varying, "depth")) {
            continue;
        }
        list.push_back(make(info, {""}, quantities.size() > 1 ? "same for all measured quantities" : ""));
        // a cable or a strut pulls the way it hangs: both its names share one law, the rig says which is likelier
        const bool towed = varies(varying, "speed");
        if (info.name == "cable_buoyancy") {
            list.back().prior = towed ? 0.15 : 0.85;
        } else if (info.name == "strut_buoyancy") {
            list.back().prior = towed ? 0.85 : 0.15;
        }
        const double prior = list.back().prior;
        if (info.takes_quantity && quantities.size() > 1) {
            for (const std::string& quantity : quantities) {
                list.push_back(make(info, {quantity}, quantity + " only"));
                list.back().prior = prior;
            }
            list.push_back(make(info, quantities, "each measured quantity with its own number"));
            list.back().prior = prior;
        }
    }
    return list;
}

std::vector<Hypothesis> heave_hypotheses(const dynamics::Model& model, bool /*velocity_measured*/) {
    std::vector<Hypothesis> list;
    for (const dynamics::Effect* effect : dynamics::effects()) {
        const dynamics::EffectInfo& info = effect->info();
        if (info.seen_in == dynamics::SeenIn::static_set || info.takes_table || info.takes_parameter) {
            continue;
        }
        Hypothesis hypothesis = make(info, {""}, "");
        hypothesis.starts.clear();
        if (info.name == "periodic_disturbance") {
            hypothesis.prior = 0.01;  // some hundred frequencies were looked at
        }
        const auto start = [&](const std::vector<std::vector<double>>& values) { hypothesis.starts = values; };
        if (info.name == "gap_sensor_delay" || info.name == "input_delay" || info.name == "actuator_lag") {
            // a reading later than that is no reading; the filter's expansion in the delay ends there as well
            hypothesis.parameters.front().upper = std::min(hypothesis.parameters.front().upper, info.name == "gap_sensor_delay" ? 0.5 : 5.0);
        }
        if (info.name == "gap_dependent_added_mass") {
            start({{0.5, 0.02}, {0.5, 0.06}, {0.5, 0.2}});
            // the law with which inertia grows is not one law; with the far value free the catalogue's form bends to others
            Hypothesis bent = hypothesis;
            bent.form = "far inertia free as well";
            add_use(bent, dynamics::effect("added_mass").info(), "");
            for (std::vector<double>& begin : bent.starts) {
                begin.push_back(0);
            }
            list.push_back(std::move(bent));
        } else if (info.name == "surface_roughness") {
            start({{0.1, 0.1, 0.03}, {0.1, 0.1, 0.1}, {0.1, 0.1, 0.3}});
        } else if (info.name == "tether_stiffness") {
            start({{0.03, 0.1}});
        } else if (info.name != "periodic_disturbance") {  // its starts come from a scan over frequency
            start({{}});
            for (const FitParameter& p : hypothesis.parameters) {
                hypothesis.starts.front().push_back(std::min(p.start + 0.3 * p.typical, p.upper));
            }
        }
        list.push_back(std::move(hypothesis));
    }
    std::size_t sources = 0;
    std::size_t which = 0;
    for (std::size_t k = 0; k < model.forces.size(); ++k) {
        if (model.forces[k].quantity == "lift_force") {
            ++sources;
            which = k;
        }
    }
    if (sources == 1) {
        // the scale of the force table is the declared number that has no name of its own in the catalogue
        Hypothesis hypothesis;
        hypothesis.names = {"declared_parameter"};
        dynamics::EffectUse use = dynamics::neutral_use("declared_parameter");
        use.parameter = "force." + std::to_string(which + 1) + ".factor";
        const double declared = model.forces[which].factor;
        use.values[0] = declared;
        hypothesis.form = use.parameter;
        hypothesis.uses = {use};
        hypothesis.parameters = {{"value", "1", 0.05 * declared, 20 * declared, declared, 0.1 * declared}};
        hypothesis.slots = {{0, 0}};
        hypothesis.starts = {{1.02 * declared}};
        hypothesis.depends_on = {"gap"};
        list.push_back(std::move(hypothesis));
    }
    return list;
}

Hypothesis joined(const Hypothesis& a, std::span<const double> start_a, const Hypothesis& b, std::span<const double> start_b) {
    Hypothesis both = a;
    for (std::size_t j = 0; j < both.parameters.size(); ++j) {
        both.parameters[j].start = start_a[j];
    }
    const std::size_t offset = a.uses.size();
    both.uses.insert(both.uses.end(), b.uses.begin(), b.uses.end());
    for (std::size_t j = 0; j < b.parameters.size(); ++j) {
        both.parameters.push_back(b.parameters[j]);
        both.parameters.back().start = start_b[j];
        both.slots.push_back({b.slots[j].use + offset, b.slots[j].value});
    }
    std::set<std::string> names(a.names.begin(), a.names.end());
    names.insert(b.names.begin(), b.names.end());
    both.names.assign(names.begin(), names.end());
    std::set<std::string> depends(a.depends_on.begin(), a.depends_on.end());
    depends.insert(b.depends_on.begin(), b.depends_on.end());
    both.depends_on.assign(depends.begin(), depends.end());
    both.form = a.form.empty() ? b.form : b.form.empty() ? a.form : a.form + "; " + b.form;
    both.prior = a.prior * b.prior;
    both.starts.clear();
    return both;
}

double occam_factor(const Hypothesis& hypothesis, std::size_t data) {
    return static_cast<double>(hypothesis.parameters.size()) * std::log(static_cast<double>(std::max<std::size_t>(data, 2)));
}

}  // namespace underbody::discovery
