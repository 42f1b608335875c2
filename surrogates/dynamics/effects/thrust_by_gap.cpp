// input felt = input (1 - loss exp(-h/length))
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& thrust_by_gap_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"thrust_by_gap",
                            "thruster weakened by the ground",
                            "input felt = input (1 - loss exp(-h/length))",
                            SeenIn::time_series,
                            {"gap", "input_force"},
                            {{"loss", "1", -2, 1, 0.2, 0, false, "share of the thrust that is lost at the ground"},
                             {"length", "m", 0.001, 5, 0.1, 0.1, true, "gap over which it falls to 1/e", true}},
                            "own: the lost share as one exponential of the gap"},
                 {.starts = {{0.2, 0.03}, {0.2, 0.1}, {0.2, 0.3}}, .kin = {"input"}}),
        {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
            terms.thrust_loss = use.values[0];
            terms.thrust_length = use.values[1];
        }}};
    return effect;
}

}  // namespace underbody::dynamics
