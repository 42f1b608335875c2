// force times 1 + sensitivity (mu(T)/mu(T declared) - 1)
#include <cmath>

#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

namespace {

/// Dynamic viscosity of fresh water, Pa s, T in K.
double viscosity(double kelvin) {
    constexpr double factor = 2.414e-5, decades = 247.8, vanishes = 140.0;  // Pa s, K, K (Al-Shemmeri 2012)
    return factor * std::pow(10.0, decades / (kelvin - vanishes));
}

}  // namespace

const Effect& temperature_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"temperature",
                            "force follows the viscosity of the water",
                            "force times 1 + sensitivity (mu(T)/mu(T declared) - 1)",
                            SeenIn::static_set,
                            {"temperature"},
                            {{"sensitivity", "1", -20, 20, 0.3, 0, false, "share of the force that is viscous"}},
                            "viscosity of water: mu = 2.414e-5 Pa s 10^(247.8 K/(T - 140 K)) (Al-Shemmeri 2012)",
                            true},
                 {.needs = {"temperature"}}),
        {.after = [](const std::string& quantity, double value, const StaticPoint& seen,
                     const Conditions& /*set_point*/, const EffectUse& use) {
            if (!concerns(use, quantity) || !seen.conditions.has(Channel::temperature)) {
                return value;
            }
            const double ratio =
                viscosity(seen.conditions[Channel::temperature]) / viscosity(seen.model->environment.temperature);
            return value * (1 + use.values[0] * (ratio - 1));
        }}};
    return effect;
}

}  // namespace underbody::dynamics
