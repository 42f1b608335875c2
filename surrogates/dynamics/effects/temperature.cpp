// force times 1 + sensitivity (mu(T)/mu(T declared) - 1)
#include <cmath>

#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

namespace {

/// Dynamic viscosity of fresh water, Pa s, T in K.
double viscosity(double kelvin) { return 2.414e-5 * std::pow(10.0, 247.8 / (kelvin - 140.0)); }

class TemperatureEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(EffectInfo{"temperature",
                                "force follows the viscosity of the water",
                                "force times 1 + sensitivity (mu(T)/mu(T declared) - 1)",
                                SeenIn::static_set,
                                {"temperature"},
                                {{"sensitivity", "1", -20, 20, 0.3, 0, false, "share of the force that is viscous"}},
                                "viscosity of water: mu = 2.414e-5 Pa s 10^(247.8 K/(T - 140 K)) (Al-Shemmeri 2012)",
                                true},
                     {.needs = {"temperature"}});
        return the;
    }

    [[nodiscard]] double after(const std::string& quantity, double value, const StaticPoint& seen,
                               const Conditions& /*set_point*/, const EffectUse& use) const override {
        if (!concerns(use, quantity) || !seen.conditions.has(Channel::temperature)) {
            return value;
        }
        const double ratio =
            viscosity(seen.conditions[Channel::temperature]) / viscosity(seen.model->environment.temperature);
        return value * (1 + use.values[0] * (ratio - 1));
    }
};

}  // namespace

const Effect& temperature_effect() {
    static const TemperatureEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
