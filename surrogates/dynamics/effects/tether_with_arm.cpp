// F = -stiffness (h + arm sin(pitch) - gap), at that point
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& tether_with_arm_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"tether_with_arm",
                            "tether or cable as a spring, fastened ahead of the middle of the base",
                            "F = -stiffness (h + arm sin(pitch) - gap), at that point",
                            SeenIn::time_series,
                            {"gap", "pitch"},
                            {{"stiffness", "N/m", -100, 100000, 0.5, 0, false, "pulls back when positive"},
                             {"gap", "m", -10, 10, 0.1, 0, false, "gap at which it does not pull"},
                             {"arm", "m", -10, 10, 0.05, 0, false, "ahead of the middle of the base"}},
                            "Hooke; rigid body"},
                 {.starts = {{0.5, 0.03, 0.05},
                             {0.5, 0.03, -0.05},
                             {2, 0.1, 0.05},
                             {2, 0.1, -0.05},
                             {0.5, 0.15, 0.05},
                             {0.5, 0.15, -0.05}},
                  .kin = {"place", "trim"}}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 if (context.pitches) {  // somewhere along the base
                     parameters[2].lower = -2 * context.model.vehicle.base_half_length;
                     parameters[2].upper = 2 * context.model.vehicle.base_half_length;
                 }
                 return context.pitches;
             },
         .add_to =
             [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
                 // what it does at the middle of the base acts in heave alone too
                 terms.constant += use.values[0] * (use.values[1] - terms.stiffness_gap);
                 terms.stiffness += use.values[0];
                 terms.pitch.add_spring(use.values[0], use.values[1], use.values[2]);
             }}};
    return effect;
}

}  // namespace underbody::dynamics
