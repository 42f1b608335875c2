// M = -stiffness sin(pitch)
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& pitch_stiffness_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"pitch_stiffness",
                            "restoring moment that is missing: centre of buoyancy higher or lower",
                            "M = -stiffness sin(pitch)",
                            SeenIn::time_series,
                            {"pitch"},
                            {{"stiffness", "N m", -1000, 100000, 0.02, 0, false, "turns back to level when positive"}},
                            "definition"},
                 {.kin = {"trim"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.pitches; },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.pitch.stiffness += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
