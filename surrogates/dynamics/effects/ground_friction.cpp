// F = -coefficient N against the slip
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& ground_friction_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"ground_friction",
                            "friction on the ground beside the declared",
                            "F = -coefficient N against the slip",
                            SeenIn::time_series,
                            {},
                            {{"coefficient", "1", -2, 2, 0.05, 0, false, "added to contact.friction"}},
                            "Coulomb 1785"},
                 {.adds_to = "contact", .kin = {"surge"}}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 parameters[0].lower = -context.model.contact.friction;  // less than none is none
                 return context.slides;
             },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.surface.friction += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
