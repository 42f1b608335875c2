// M = arm cos(pitch) input
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& input_arm_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"input_arm",
                            "input that acts beside the centre of gravity (thruster off its line)",
                            "M = arm cos(pitch) input",
                            SeenIn::time_series,
                            {"input_force"},
                            {{"arm", "m", -10, 10, 0.01, 0, false, "ahead of the centre of gravity"}},
                            "rigid body: moment of a force about the centre of gravity"},
                 {.kin = {"trim"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return context.pitches && varies(context, Channel::input_force); },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.pitch.input_arm += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
