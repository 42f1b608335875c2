// V seen by the power law = reference x^(1 + exponent/2) sqrt((1 + saturation)/(1 + saturation x^2)), x = max(0, V -
// dead_zone)/(reference - dead_zone)
#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

namespace {

double reference_voltage(const Model& model) {
    for (const ForceSource& source : model.forces) {
        for (const ForceScale& scale : source.scales) {
            if (scale.channel == Channel::jet_voltage) {
                return scale.reference;
            }
        }
    }
    return 10;
}

double seen_by_the_law(double voltage, double reference, const EffectUse& use) {
    const double dead = std::min(use.values[0], 0.99 * reference);
    const double x = std::max(0.0, voltage - dead) / (reference - dead);
    return reference * std::pow(x, 1 + use.values[2] / 2) *
           std::sqrt((1 + use.values[1]) / (1 + use.values[1] * x * x));
}

}  // namespace

const Effect& pump_curve_effect() {
    static const LawEffect effect{
        searched(
            EffectInfo{
                "pump_curve",
                "pump curve other than the declared power law",
                "V seen by the power law = reference x^(1 + exponent/2) sqrt((1 + saturation)/(1 + saturation x^2)), "
                "x = max(0, V - dead_zone)/(reference - dead_zone)",
                SeenIn::static_set,
                {"jet_voltage"},
                {{"dead_zone", "V", 0, 1000.0, 0.5, 0, false, "voltage below which no water flows"},
                 {"saturation", "1", 0, 100, 0.2, 0, false, "flow levels off at high voltage"},
                 {"exponent", "1", -1.5, 4, 0.3, 0, true, "added to the power of two"}},
                "dead-band and saturating laws for a small pump; equal to the declared law at the reference voltage"},
            {.needs = {"jet_voltage"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return source_feels(context, Channel::jet_voltage, true); },
         .before =
             [](StaticPoint& point, const EffectUse& use) {
                 if (point.conditions.has(Channel::jet_voltage)) {
                     point.conditions[Channel::jet_voltage] =
                         seen_by_the_law(point.conditions[Channel::jet_voltage], reference_voltage(*point.model), use);
                 }
             },
         .kinks =
             [](Channel channel, const EffectUse& use) {
                 return channel == Channel::jet_voltage ? std::vector<double>{use.values[0]} : std::vector<double>{};
             }}};
    return effect;
}

}  // namespace underbody::dynamics
