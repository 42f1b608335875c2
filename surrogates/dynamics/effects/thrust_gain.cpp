// thrust = gain times the recorded
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& thrust_gain_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"thrust_gain",
                            "jets that push more or less than their recorded thrust",
                            "thrust = gain times the recorded",
                            SeenIn::time_series,
                            {},
                            {{"gain", "1", 0.05, 20, 0.1, 1, false, "1: as recorded"}},
                            "definition"},
                 {.kin = {"surge"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.turns && !context.model.jets.empty(); },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.surface.thrust_gain *= use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
