// force times (speed/reference)^(exponent - declared exponent)
#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

namespace {

/// The power of the speed that the model declares for this quantity; squared at 1 m/s when it declares none.
ForceScale declared_speed_law(const Model& model, const std::string& quantity) {
    for (const ForceSource& source : model.forces) {
        if (source.quantity == quantity) {
            for (const ForceScale& scale : source.scales) {
                if (scale.channel == Channel::speed) {
                    return scale;
                }
            }
        }
    }
    return {};
}

/// What a model's other sources (a jet) give, which do not know of the speed; nothing when no source is scaled by it.
double part_without_speed(const Model& model, const std::string& quantity, const Conditions& seen) {
    const auto knows_speed = [](const ForceSource& source) {
        return std::any_of(source.scales.begin(), source.scales.end(),
                           [](const ForceScale& scale) { return scale.channel == Channel::speed; });
    };
    const auto own = [&](const ForceSource& source) { return source.quantity == quantity; };
    if (std::none_of(model.forces.begin(), model.forces.end(),
                     [&](const ForceSource& source) { return own(source) && knows_speed(source); }) ||
        std::all_of(model.forces.begin(), model.forces.end(),
                    [&](const ForceSource& source) { return !own(source) || knows_speed(source); }) ||
        model.coupling.kind != Coupling::Kind::sum) {
        return 0;
    }
    Conditions at_rest = seen;  // there the sources scaled by the speed give nothing
    at_rest[Channel::speed] = 0;
    return sum_of_sources(model, quantity, at_rest);
}

}  // namespace

const Effect& speed_exponent_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"speed_exponent",
                            "force grows with another power of the speed",
                            "force times (speed/reference)^(exponent - declared exponent)",
                            SeenIn::static_set,
                            {"speed"},
                            {{"exponent", "1", -2, 6, 0.2, 2, false, "true exponent"}},
                            "definition",
                            true},
                 {.needs = {"speed"}}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 // it does nothing at the exponent that the model declares
                 bool declared = false;
                 for (const ForceSource& source : context.model.forces) {
                     const bool asked = std::find(context.quantities.begin(), context.quantities.end(),
                                                  source.quantity) != context.quantities.end();
                     for (const ForceScale& scale : source.scales) {
                         if (asked && !declared && scale.channel == Channel::speed) {
                             parameters.front().neutral = scale.exponent;
                             declared = true;
                         }
                     }
                 }
                 return source_feels(context, Channel::speed, true);
             },
         .after =
             [](const std::string& quantity, double value, const StaticPoint& seen, const Conditions& /*set_point*/,
                const EffectUse& use) {
                 if (!concerns(use, quantity) || !seen.conditions.has(Channel::speed)) {
                     return value;
                 }
                 const ForceScale declared = declared_speed_law(*seen.model, quantity);
                 const double ratio = std::abs(seen.conditions[Channel::speed]) / declared.reference;
                 if (!(ratio > 0)) {
                     return value;
                 }
                 const double factor = std::pow(ratio, use.values[0] - declared.exponent);
                 const double still = part_without_speed(*seen.model, quantity, seen.conditions);
                 return still + (value - still) * factor;
             },
         .kinks =
             [](Channel channel, const EffectUse& /*use*/) {
                 return channel == Channel::speed ? std::vector<double>{0.0} : std::vector<double>{};
             }}};
    return effect;
}

}  // namespace underbody::dynamics
