// force times (speed/reference)^(exponent - declared exponent)
#include <cmath>

#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/model.h"

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

class Kind final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the{"speed_exponent",
                                    "force grows with another power of the speed",
                                    "force times (speed/reference)^(exponent - declared exponent)",
                                    SeenIn::static_set,
                                    {"speed"},
                                    {{"exponent", "1", -2, 6, 0.2, 2, false, "true exponent"}},
                                    "definition",
                                    true};
        return the;
    }

    [[nodiscard]] double after(const std::string& quantity, double value, const StaticPoint& seen,
                               const Conditions& /*set_point*/, const EffectUse& use) const override {
        if (!concerns(use, quantity) || !seen.conditions.has(Channel::speed)) {
            return value;
        }
        const ForceScale declared = declared_speed_law(*seen.model, quantity);
        const double ratio = std::abs(seen.conditions[Channel::speed]) / declared.reference;
        return ratio > 0 ? value * std::pow(ratio, use.values[0] - declared.exponent) : value;
    }
};

}  // namespace

const Effect& speed_exponent_effect() {
    static const Kind kind;
    return kind;
}

}  // namespace underbody::dynamics
