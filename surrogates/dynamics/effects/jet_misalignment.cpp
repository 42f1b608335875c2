// thrust turned by angle about the vertical
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& jet_misalignment_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"jet_misalignment",
                            "jets that point beside their declared direction",
                            "thrust turned by angle about the vertical",
                            SeenIn::time_series,
                            {},
                            {{"angle", "rad", -1.5, 1.5, 0.02, 0, false, "bow to starboard"}},
                            "definition"},
                 {.kin = {"turning"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.turns && !context.model.jets.empty(); },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.surface.jet_angle += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
