// F = +force
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

namespace {

class ConstantForceEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the = searched(EffectInfo{"constant_force",
                                                          "constant force (trim)",
                                                          "F = +force",
                                                          SeenIn::time_series,
                                                          {},
                                                          {{"force", "N", -100, 100, 0.01, 0, false, "up"}},
                                                          "definition"},
                                               {.kin = {"place"}});
        return the;
    }

    void add_to(HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) const override {
        terms.constant += use.values[0];
    }
};

}  // namespace

const Effect& constant_force_effect() {
    static const ConstantForceEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
