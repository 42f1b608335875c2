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

/// The catalogue speaks of lift; where something else was measured the hypothesis speaks of that. Numbers that are
/// forces are moments where all that they act on are moments.
void speak_of(Hypothesis& hypothesis, const std::vector<std::string>& quantities) {
    const auto lift = std::find(hypothesis.depends_on.begin(), hypothesis.depends_on.end(), "lift_force");
    if (lift != hypothesis.depends_on.end() &&
        std::find(quantities.begin(), quantities.end(), "lift_force") == quantities.end()) {
        *lift = quantities.front();
    }
    for (std::size_t j = 0; j < hypothesis.parameters.size(); ++j) {
        const dynamics::EffectUse& use = hypothesis.uses[hypothesis.slots[j].use];
        const std::vector<std::string> concerned =
            use.quantity.empty() ? quantities : std::vector<std::string>{use.quantity};
        std::string& unit = hypothesis.parameters[j].unit;
        if ((unit == "N" || unit == "N/s") &&
            std::all_of(concerned.begin(), concerned.end(),
                        [](const std::string& name) { return name.ends_with("moment"); })) {
            unit.insert(1, " m");
        }
    }
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

/// Whether an effect can change what this model says of these quantities at all.
bool model_feels(const dynamics::Model& model, const std::string& effect, const std::vector<std::string>& quantities) {
    const auto measured = [&](const std::string& quantity) {
        return std::find(quantities.begin(), quantities.end(), quantity) != quantities.end();
    };
    const auto has_axis = [](const dynamics::ForceSource& source, Channel channel) {
        return std::find(source.axes.begin(), source.axes.end(), channel) != source.axes.end();
    };
    const auto any_source = [&](auto&& predicate) {
        return std::any_of(model.forces.begin(), model.forces.end(), [&](const dynamics::ForceSource& source) {
            return measured(source.quantity) && predicate(source);
        });
    };
    const auto scaled_by = [](const dynamics::ForceSource& source, Channel channel) {
        return std::any_of(source.scales.begin(), source.scales.end(), [&](const dynamics::ForceScale& scale) {
            return scale.channel == channel && scale.exponent != 0;
        });
    };
    if (effect == "pitch_misalignment") {
        // without a pitch axis the balance leans: that needs lift and drag, both in the model
        const std::vector<std::string> known = model.quantities();
        const auto knows = [&](const char* quantity) {
            return std::find(known.begin(), known.end(), quantity) != known.end();
        };
        return any_source([&](const auto& source) { return has_axis(source, Channel::pitch); }) ||
               (knows("lift_force") && knows("drag_force") && (measured("lift_force") || measured("drag_force")));
    }
    if (effect == "pump_curve") {
        return any_source([&](const auto& source) {
            return has_axis(source, Channel::jet_voltage) || scaled_by(source, Channel::jet_voltage);
        });
    }
    if (effect == "current") {
        return any_source(
            [&](const auto& source) { return has_axis(source, Channel::speed) || scaled_by(source, Channel::speed); });
    }
    if (effect == "speed_exponent") {
        return any_source(
            [&](const auto& source) { return has_axis(source, Channel::speed) || scaled_by(source, Channel::speed); });
    }
    if (effect == "gap_offset") {
        return any_source([&](const auto& source) { return has_axis(source, Channel::gap); });
    }
    return true;
}

/// The effect is neutral at the exponent that the model declares, not at two.
void start_at_declared_exponent(Hypothesis& hypothesis, const dynamics::Model& model,
                                const std::vector<std::string>& quantities) {
    for (std::size_t j = 0; j < hypothesis.slots.size(); ++j) {
        const std::string& wanted = hypothesis.uses[hypothesis.slots[j].use].quantity;
        for (const dynamics::ForceSource& source : model.forces) {
            const bool concerned =
                wanted.empty() ? std::find(quantities.begin(), quantities.end(), source.quantity) != quantities.end()
                               : source.quantity == wanted;
            const auto scale =
                std::find_if(source.scales.begin(), source.scales.end(),
                             [](const dynamics::ForceScale& one) { return one.channel == Channel::speed; });
            if (concerned && scale != source.scales.end()) {
                const double shift = scale->exponent - hypothesis.parameters[j].start;
                hypothesis.parameters[j].start += shift;
                hypothesis.uses[hypothesis.slots[j].use].values[hypothesis.slots[j].value] += shift;
                for (std::vector<double>& start : hypothesis.starts) {
                    start[j] += shift;
                }
                break;
            }
        }
    }
}

/// Roughness with one strength: as much deeper near the ground as it is weaker far from it.
void one_strength(Hypothesis& hypothesis) {
    for (std::size_t j = hypothesis.parameters.size(); j-- > 0;) {
        if (hypothesis.parameters[j].name == "far") {
            hypothesis.copies.push_back({j - 1, hypothesis.slots[j]});  // `near` stands before it
            hypothesis.parameters.erase(hypothesis.parameters.begin() + static_cast<std::ptrdiff_t>(j));
            hypothesis.slots.erase(hypothesis.slots.begin() + static_cast<std::ptrdiff_t>(j));
        }
    }
    for (Hypothesis::Copy& copy : hypothesis.copies) {
        const auto near = std::find_if(
            hypothesis.slots.begin(), hypothesis.slots.end(),
            [&](const Hypothesis::Slot& slot) { return slot.use == copy.to.use && slot.value + 1 == copy.to.value; });
        copy.parameter = static_cast<std::size_t>(near - hypothesis.slots.begin());
    }
    for (FitParameter& parameter : hypothesis.parameters) {
        parameter.upper = parameter.name == "near" ? std::min(parameter.upper, 1.0) : parameter.upper;
    }
    add_starts(hypothesis);
}

Hypothesis of_declared(const std::string& parameter, double declared, double lower, double upper, double typical,
                       const std::vector<std::string>& depends_on) {
    Hypothesis hypothesis;
    hypothesis.names = {"declared_parameter"};
    dynamics::EffectUse use = dynamics::neutral_use("declared_parameter");
    use.parameter = parameter;
    use.values[0] = declared;
    hypothesis.form = parameter;
    hypothesis.uses = {use};
    hypothesis.parameters = {{"value", "1", lower, upper, declared, typical}};
    hypothesis.slots = {{0, 0}};
    hypothesis.starts = {{declared + 0.2 * typical}};
    hypothesis.depends_on = depends_on;
    return hypothesis;
}

/// Declared numbers for which the catalogue has no name of its own: the factor of one of several sources of a quantity,
/// and powers of channels other than the speed and the voltage of a declared jet.
std::vector<Hypothesis> declared_numbers(const dynamics::Model& model, const std::vector<Channel>& varying,
                                         const std::vector<std::string>& quantities) {
    std::vector<Hypothesis> list;
    for (std::size_t k = 0; k < model.forces.size(); ++k) {
        const dynamics::ForceSource& source = model.forces[k];
        if (std::find(quantities.begin(), quantities.end(), source.quantity) == quantities.end()) {
            continue;
        }
        const std::string prefix = "force." + std::to_string(k + 1) + ".";
        std::vector<std::string> depends_on;
        for (const Channel axis : source.axes) {
            depends_on.emplace_back(dynamics::channel_name(axis));
        }
        const auto sources =
            std::count_if(model.forces.begin(), model.forces.end(),
                          [&](const dynamics::ForceSource& other) { return other.quantity == source.quantity; });
        for (const dynamics::ForceScale& scale : source.scales) {
            const std::string name = dynamics::channel_name(scale.channel);
            depends_on.push_back(name);
            const bool named =
                scale.channel == Channel::speed || (scale.channel == Channel::jet_voltage && scale.exponent != 0);
            if ((!named || (scale.channel == Channel::speed && sources > 1)) && varies(varying, name)) {
                list.push_back(
                    of_declared(prefix + "scale." + name + ".exponent", scale.exponent, -10, 10, 0.2, {name}));
                list.back().prior = named ? 0.05 : 1;  // the power of the speed has a name of its own
            }
        }
        if (sources > 1) {
            list.push_back(of_declared(prefix + "factor", source.factor, -1000, 1000,
                                       0.1 * std::max(std::abs(source.factor), 1e-6), depends_on));
        }
    }
    return list;
}

}  // namespace

std::vector<dynamics::EffectUse> Hypothesis::with(std::span<const double> p) const {
    std::vector<dynamics::EffectUse> result = uses;
    for (std::size_t j = 0; j < slots.size(); ++j) {
        result[slots[j].use].values[slots[j].value] = p[j];
    }
    for (const Copy& copy : copies) {
        result[copy.to.use].values[copy.to.value] = p[copy.parameter];
    }
    return result;
}

std::vector<double> Hypothesis::start() const {
    std::vector<double> p;
    for (const FitParameter& parameter : parameters) {
        p.push_back(parameter.start);
    }
    return p;
}

std::string Hypothesis::label() const {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : " + ") + name;
    }
    return text.empty() ? "none" : text;
}

std::vector<Hypothesis> static_hypotheses(const dynamics::Model& model, const std::vector<Channel>& varying,
                                          const std::vector<std::string>& quantities) {
    std::vector<Hypothesis> list;
    for (const dynamics::Effect* effect : dynamics::effects()) {
        const dynamics::EffectInfo& info = effect->info();
        if (info.seen_in == dynamics::SeenIn::time_series || info.takes_table || info.takes_parameter) {
            continue;
        }
        const std::vector<std::string> needed = channels_needed(info.name);
        if (!std::all_of(needed.begin(), needed.end(),
                         [&](const std::string& name) { return varies(varying, name); }) ||
            !model_feels(model, info.name, quantities)) {
            continue;
        }
        if ((info.name == "cable_buoyancy" || info.name == "strut_buoyancy") && !varies(varying, "gap") &&
            !varies(varying, "depth")) {
            continue;
        }
        const std::size_t first = list.size();
        const bool lift_only =
            info.name == "surface_roughness" || info.name == "cable_buoyancy" || info.name == "strut_buoyancy";
        list.push_back(make(info, {""}, quantities.size() > 1 && !lift_only ? "same for all measured quantities" : ""));
        if (info.takes_quantity && quantities.size() > 1) {
            for (const std::string& quantity : quantities) {
                if (!lift_only || quantity != "lift_force") {
                    list.push_back(make(info, {quantity}, quantity + " only"));
                }
            }
            list.push_back(make(info, quantities, "each measured quantity with its own number"));
        }
        if (info.name == "surface_roughness") {
            list.push_back(make(info, {""}, "as much deeper near as weaker far"));
        }
        // a cable or a strut pulls the way it hangs: both its names share one law, the rig says which is likelier
        const bool towed = varies(varying, "speed");
        for (std::size_t k = first; k < list.size(); ++k) {
            if (info.name == "surface_roughness" && k + 1 == list.size()) {
                one_strength(list[k]);
            } else if (info.name == "cable_buoyancy") {
                list[k].prior = towed ? 0.15 : 0.85;
            } else if (info.name == "strut_buoyancy") {
                list[k].prior = towed ? 0.85 : 0.15;
            } else if (info.name == "speed_exponent") {
                start_at_declared_exponent(list[k], model, quantities);
            }
            speak_of(list[k], quantities);
        }
    }
    for (Hypothesis& hypothesis : declared_numbers(model, varying, quantities)) {
        list.push_back(std::move(hypothesis));
    }
    return list;
}

std::vector<Hypothesis> heave_hypotheses(const dynamics::Model& model, const std::vector<Channel>& varying) {
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
            hypothesis.parameters.front().upper =
                std::min(hypothesis.parameters.front().upper, info.name == "gap_sensor_delay" ? 0.5 : 5.0);
        }
        if (info.name == "linear_damping" && model.drag_heave.kind == dynamics::DragLaw::Kind::linear_quadratic) {
            hypothesis.parameters.front().lower = -model.drag_heave.linear;  // water takes energy, it does not give any
        }
        if (info.name == "quadratic_damping" && model.drag_heave.kind == dynamics::DragLaw::Kind::linear_quadratic) {
            hypothesis.parameters.front().lower = -model.drag_heave.quadratic;
        }
        if (info.name == "added_mass") {
            hypothesis.parameters.front().lower = -0.9 * model.heave_mass();
        }
        if (info.name == "gap_dependent_added_mass") {
            start({{0.5, 0.02}, {0.5, 0.06}, {0.5, 0.2}});
            // the law with which inertia grows is not one law; with the far value free the catalogue's form bends to
            // others
            Hypothesis bent = hypothesis;
            bent.form = "far inertia free as well";
            add_use(bent, dynamics::effect("added_mass").info(), "");
            for (std::vector<double>& begin : bent.starts) {
                begin.push_back(0);
            }
            list.push_back(std::move(bent));
        } else if (info.name == "surface_roughness") {
            start({{0.1, 0.1, 0.03}, {0.1, 0.1, 0.1}, {0.1, 0.1, 0.3}});
            hypothesis.parameters[0].lower = hypothesis.parameters[1].lower =
                0;  // deeper near, weaker far: not the other way round
        } else if (info.name == "tether_stiffness") {
            start({{0.03, 0.1}, {0.5, 0.03}, {0.5, 0.15}, {4, 0.02}, {4, 0.1}});
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
        // the scale of the force table and its exponents are the declared numbers that have no name of their own in the
        // catalogue
        const dynamics::ForceSource& source = model.forces[which];
        const std::string prefix = "force." + std::to_string(which + 1) + ".";
        list.push_back(of_declared(prefix + "factor", source.factor, 0.05 * source.factor, 20 * source.factor,
                                   0.1 * source.factor, {"gap"}));
        for (const dynamics::ForceScale& scale : source.scales) {
            if (std::find(varying.begin(), varying.end(), scale.channel) != varying.end()) {
                const std::string channel = dynamics::channel_name(scale.channel);
                list.push_back(of_declared(prefix + "scale." + channel + ".exponent", scale.exponent, -6, 10, 0.2,
                                           {"gap", channel}));
            }
        }
    }
    return list;
}

void keep_only(std::vector<Hypothesis>& list, const std::vector<std::string>& names) {
    if (names.empty()) {
        return;
    }
    std::erase_if(list, [&](const Hypothesis& h) {
        return !std::all_of(h.names.begin(), h.names.end(), [&](const std::string& own) {
            return std::find(names.begin(), names.end(), own) != names.end();
        });
    });
    if (list.empty()) {
        throw core::InputError("option", "none of the candidates asked for can be seen in such data", {},
                               "leave the list of candidates out to have all tried");
    }
}

Hypothesis joined(const Hypothesis& a, std::span<const double> start_a, const Hypothesis& b,
                  std::span<const double> start_b) {
    const auto scales = [](const Hypothesis& h) { return h.names.front() == "sensor_gain"; };
    if (scales(b) && !scales(a)) {
        // a gain acts on the force, then comes what is added to the reading: with both linear a fit cannot get caught
        // on its way to a small gain
        return joined(b, start_b, a, start_a);
    }
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
    for (const Hypothesis::Copy& copy : b.copies) {
        both.copies.push_back({copy.parameter + a.parameters.size(), {copy.to.use + offset, copy.to.value}});
    }
    std::set<std::string> depends(a.depends_on.begin(), a.depends_on.end());
    depends.insert(b.depends_on.begin(), b.depends_on.end());
    both.depends_on.assign(depends.begin(), depends.end());
    both.form = a.form.empty() ? b.form : b.form.empty() ? a.form : a.form + "; " + b.form;
    both.prior = a.prior * b.prior;
    both.starts.clear();
    return both;
}

double occam_factor(const Hypothesis& hypothesis, std::size_t data) {
    return static_cast<double>(hypothesis.parameters.size()) *
           std::log(static_cast<double>(std::max<std::size_t>(data, 2)));
}

}  // namespace underbody::discovery
