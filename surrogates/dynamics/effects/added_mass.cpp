// (M + mass) dw/dt
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

namespace {

class AddedMassEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(EffectInfo{"added_mass",
                                "added mass",
                                "(M + mass) dw/dt",
                                SeenIn::time_series,
                                {"heave_acceleration"},
                                {{"mass", "kg", -50, 500, 0.5, 0, false, "added to the declared virtual mass"}},
                                "definition"},
                     {.kin = {"inertia"}, .one_sign = true});
        return the;
    }

    [[nodiscard]] bool look(const SearchContext& context, std::vector<EffectParameter>& parameters,
                            double& /*prior*/) const override {
        if (context.time_series) {
            parameters.front().lower = -0.9 * context.model.heave_mass();
            // a body drags along no more than a few times its own: more stands for something else
            parameters.front().upper = std::min(parameters.front().upper, 5 * context.model.heave_mass());
        }
        return true;
    }

    void add_to(HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) const override {
        terms.mass += use.values[0];
    }
};

}  // namespace

const Effect& added_mass_effect() {
    static const AddedMassEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
