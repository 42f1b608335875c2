// reading = force + friction approach_direction
#include "surrogates/dynamics/effects/catalogue.h"

namespace underbody::dynamics {

namespace {

class GuideFrictionEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(of_the_rig({"guide_friction",
                                 "friction of the guide",
                                 "reading = force + friction approach_direction",
                                 SeenIn::static_set,
                                 {"approach_direction"},
                                 {{"friction", "N", -100, 100, 0.01, 0, false,
                                   "sign follows the direction of approach (hysteresis of the slide)"}},
                                 "Coulomb",
                                 true}),
                     {.needs = {"approach_direction"}});
        return the;
    }

    [[nodiscard]] double after(const std::string& quantity, double value, const StaticPoint& /*seen*/,
                               const Conditions& set_point, const EffectUse& use) const override {
        return concerns(use, quantity) ? value + use.values[0] * set_point.get(Channel::approach_direction, 0) : value;
    }
};

}  // namespace

const Effect& guide_friction_effect() {
    static const GuideFrictionEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
