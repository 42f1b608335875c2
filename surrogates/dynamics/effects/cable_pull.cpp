// (X, Y) = R(-heading) (along, across)
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& cable_pull_effect() {
    static const LawEffect effect{
        of_the_rig(searched(EffectInfo{"cable_pull",
                                       "constant pull of a cable in the directions of the ground",
                                       "(X, Y) = R(-heading) (along, across)",
                                       SeenIn::time_series,
                                       {"heading"},
                                       {{"along", "N", -1000, 1000, 0.02, 0, false, "in the direction of heading 0"},
                                        {"across", "N", -1000, 1000, 0.02, 0, false, "to starboard of heading 0"}},
                                       "definition"},
                            {.kin = {"surge"}})),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.turns; },
         .add_to =
             [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
                 terms.surface.pull_x += use.values[0];
                 terms.surface.pull_y += use.values[1];
             }}};
    return effect;
}

}  // namespace underbody::dynamics
