// reading = gain force
#include "surrogates/dynamics/effects/catalogue.h"

namespace underbody::dynamics {

namespace {

class SensorGainEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(of_the_rig({"sensor_gain",
                                 "scale of the load cell",
                                 "reading = gain force",
                                 SeenIn::static_set,
                                 {"lift_force"},
                                 {{"gain", "1", -5, 10, 0.05, 1, false, "one is a right scale"}},
                                 "definition",
                                 true}),
                     {.scales_reading = true});
        return the;
    }

    [[nodiscard]] double after(const std::string& quantity, double value, const StaticPoint& /*seen*/,
                               const Conditions& /*set_point*/, const EffectUse& use) const override {
        return concerns(use, quantity) ? value * use.values[0] : value;
    }
};

}  // namespace

const Effect& sensor_gain_effect() {
    static const SensorGainEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
