// drag acts on w - velocity
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

namespace {

class AmbientHeaveCurrentEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(EffectInfo{"ambient_heave_current",
                                "water that moves in heave",
                                "drag acts on w - velocity",
                                SeenIn::time_series,
                                {"heave_velocity"},
                                {{"velocity", "m/s", -5, 5, 0.01, 0, false, "of the water, up"}},
                                "definition"},
                     {.kin = {"damping"}});
        return the;
    }

    void add_to(HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) const override {
        terms.current += use.values[0];
    }
};

}  // namespace

const Effect& ambient_heave_current_effect() {
    static const AmbientHeaveCurrentEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
