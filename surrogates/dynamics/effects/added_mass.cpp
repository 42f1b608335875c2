// (M + mass) dw/dt
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& added_mass_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"added_mass",
                            "added mass",
                            "(M + mass) dw/dt",
                            SeenIn::time_series,
                            {"heave_acceleration"},
                            {{"mass", "kg", -50, 500, 0.5, 0, false, "added to the declared virtual mass"}},
                            "definition"},
                 {.kin = {"inertia"}, .one_sign = true}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 if (context.time_series) {
                     parameters.front().lower = -most_taken * context.model.heave_mass();
                     // a body drags along no more than a few times its own: more stands for something else
                     parameters.front().upper = std::min(parameters.front().upper, 5 * context.model.heave_mass());
                 }
                 return true;
             },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.mass += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
