// V seen by the power law = reference x^(1 + exponent/2) sqrt((1 + saturation)/(1 + saturation x^2)), x = max(0, V -
// dead_zone)/(reference - dead_zone)
#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/model.h"

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

class Kind final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the{
            "pump_curve",
            "pump curve other than the declared power law",
            "V seen by the power law = reference x^(1 + exponent/2) sqrt((1 + saturation)/(1 + saturation x^2)), x = "
            "max(0, V - dead_zone)/(reference - dead_zone)",
            SeenIn::static_set,
            {"jet_voltage"},
            {{"dead_zone", "V", 0, 1000.0, 0.5, 0, false, "voltage below which no water flows"},
             {"saturation", "1", 0, 100, 0.2, 0, false, "flow levels off at high voltage"},
             {"exponent", "1", -1.5, 4, 0.3, 0, true, "added to the power of two"}},
            "dead-band and saturating laws for a small pump; equal to the declared law at the reference voltage"};
        return the;
    }

    void before(StaticPoint& point, const EffectUse& use) const override {
        if (!point.conditions.has(Channel::jet_voltage)) {
            return;
        }
        const double reference = reference_voltage(*point.model);
        const double dead = std::min(use.values[0], 0.99 * reference);
        const double x = std::max(0.0, point.conditions[Channel::jet_voltage] - dead) / (reference - dead);
        const double levelled = std::sqrt((1 + use.values[1]) / (1 + use.values[1] * x * x));
        point.conditions[Channel::jet_voltage] = reference * std::pow(x, 1 + use.values[2] / 2) * levelled;
    }
};

}  // namespace

const Effect& pump_curve_effect() {
    static const Kind kind;
    return kind;
}

}  // namespace underbody::dynamics
