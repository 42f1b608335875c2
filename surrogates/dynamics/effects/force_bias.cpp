// reading = force + bias
#include "surrogates/dynamics/effects/catalogue.h"

namespace underbody::dynamics {

namespace {

class ForceBiasEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            of_the_rig({"force_bias",
                        "bias of the load cell",
                        "reading = force + bias",
                        SeenIn::static_set,
                        {},
                        {{"bias", "N", -1000.0, 1000.0, 0.01, 0, false, "reading too large when positive"}},
                        "definition",
                        true});
        return the;
    }

    [[nodiscard]] double after(const std::string& quantity, double value, const StaticPoint& /*seen*/,
                               const Conditions& /*set_point*/, const EffectUse& use) const override {
        return concerns(use, quantity) ? value + use.values[0] : value;
    }
};

}  // namespace

const Effect& force_bias_effect() {
    static const ForceBiasEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
