// u = gain u_recorded
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

namespace {

class InputGainEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(EffectInfo{"input_gain",
                                "gain of the actuator",
                                "u = gain u_recorded",
                                SeenIn::time_series,
                                {"input_force"},
                                {{"gain", "1", -5, 10, 0.2, 1, false, "one is a healthy actuator"}},
                                "definition"},
                     {.kin = {"input"}});
        return the;
    }

    void add_to(HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) const override {
        terms.actuator.gain *= use.values[0];
    }
};

}  // namespace

const Effect& input_gain_effect() {
    static const InputGainEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
