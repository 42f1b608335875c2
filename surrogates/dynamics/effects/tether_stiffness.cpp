// F = -stiffness (h - gap)
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& tether_stiffness_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"tether_stiffness",
                            "tether, cable or strut as a spring",
                            "F = -stiffness (h - gap)",
                            SeenIn::time_series,
                            {"gap"},
                            {{"stiffness", "N/m", -100, 100000.0, 0.05, 0, false, "pulls back when positive"},
                             {"gap", "m", -10, 10, 0.1, 0, false, "gap at which it does not pull"}},
                            "Hooke"},
                 {.starts = {{0.03, 0.1}, {0.5, 0.03}, {0.5, 0.15}, {4, 0.02}, {4, 0.1}}, .kin = {"place"}}),
        {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
            // Springs add: one stiffness about the common point at which they do not pull, the rest constant.
            terms.constant += use.values[0] * (use.values[1] - terms.stiffness_gap);
            terms.stiffness += use.values[0];
        }}};
    return effect;
}

}  // namespace underbody::dynamics
