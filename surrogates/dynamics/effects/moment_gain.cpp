// M = gain input_moment
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& moment_gain_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"moment_gain",
                            "actuator that turns the body more or less than its recorded moment",
                            "M = gain input_moment",
                            SeenIn::time_series,
                            {"input_moment"},
                            {{"gain", "1", -20, 20, 0.1, 1, false, "1: as recorded; negative: turned round"}},
                            "definition"},
                 {.kin = {"trim"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.pitches && !context.turns; },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.pitch.moment_gain *= use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
