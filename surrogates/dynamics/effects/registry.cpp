#include <cmath>

#include "core/text.h"
#include "surrogates/dynamics/effects/catalogue.h"

namespace underbody::dynamics {

void Effect::add_to(HeaveTerms&, const EffectUse&, const Model&) const {}
void Effect::before(StaticPoint&, const EffectUse&) const {}
double Effect::after(const std::string&, double value, const StaticPoint&, const Conditions&, const EffectUse&) const {
    return value;
}

std::vector<double> Effect::kinks(Channel, const EffectUse&) const { return {}; }
bool Effect::look(const SearchContext&, std::vector<EffectParameter>&, double&) const { return true; }

namespace {

std::vector<const Effect*>& registered() {
#define UNDERBODY_LIST_EFFECT(name) &name##_effect(),
    static std::vector<const Effect*> all{UNDERBODY_EFFECTS(UNDERBODY_LIST_EFFECT)};
#undef UNDERBODY_LIST_EFFECT
    return all;
}

}  // namespace

const std::vector<const Effect*>& effects() { return registered(); }

RegisteredEffect::RegisteredEffect(const Effect& effect) : effect_(effect) {
    if (find_effect(effect.info().name) != nullptr) {
        throw core::InputError("name", "an effect is called '" + effect.info().name + "' already", {},
                               "give it another name");
    }
    registered().push_back(&effect);
}

RegisteredEffect::~RegisteredEffect() { std::erase(registered(), &effect_); }

const Effect* find_effect(std::string_view name) {
    for (const Effect* kind : effects()) {
        if (kind->info().name == name) {
            return kind;
        }
    }
    return nullptr;
}

const Effect& effect(std::string_view name) {
    if (const Effect* kind = find_effect(name)) {
        return *kind;
    }
    std::vector<std::string> known;
    for (const Effect* kind : effects()) {
        known.push_back(kind->info().name);
    }
    throw core::InputError("name", "no effect is called '" + std::string(name) + "'", {},
                           core::did_you_mean(std::string(name), known));
}

EffectUse neutral_use(std::string_view name) {
    const EffectInfo& info = effect(name).info();
    EffectUse use;
    use.name = info.name;
    for (const EffectParameter& parameter : info.parameters) {
        use.values.push_back(parameter.neutral);
        use.sigmas.push_back(0);
    }
    return use;
}

EffectUse make_use(std::string_view name, const std::vector<ParameterValue>& values) {
    EffectUse use = neutral_use(name);
    const std::vector<EffectParameter>& parameters = effect(name).info().parameters;
    for (const ParameterValue& given : values) {
        bool found = false;
        std::vector<std::string> known;
        for (std::size_t i = 0; i < parameters.size(); ++i) {
            known.push_back(parameters[i].name);
            if (parameters[i].name == given.name) {
                use.values[i] = given.value;
                use.sigmas[i] = given.sigma;
                found = true;
            }
        }
        if (!found) {
            throw core::InputError("name", "effect " + use.name + " has no parameter '" + given.name + "'", {},
                                   core::did_you_mean(given.name, known));
        }
    }
    check_use(use);
    return use;
}

void check_use(const EffectUse& use, const core::Place& place) {
    const EffectInfo& info = effect(use.name).info();
    for (std::size_t i = 0; i < info.parameters.size() && i < use.values.size(); ++i) {
        const EffectParameter& parameter = info.parameters[i];
        const double value = use.values[i];
        if (!std::isfinite(value) || value < parameter.lower || value > parameter.upper) {
            throw core::InputError("range",
                                   "effect " + use.name + ": " + parameter.name + " = " + core::format_number(value) +
                                       " " + parameter.unit + " is outside " + core::format_number(parameter.lower) +
                                       " to " + core::format_number(parameter.upper),
                                   place, "a bare number is in SI; " + parameter.meaning);
        }
    }
}

}  // namespace underbody::dynamics
