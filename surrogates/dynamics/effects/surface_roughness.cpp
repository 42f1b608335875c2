// lift times 1 + near/(1 + x) - far x/(1 + x), x = (h/length)^sharpness
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_equation.h"

namespace underbody::dynamics {

const Effect& surface_roughness_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"surface_roughness",
                            "roughness of the surface",
                            "lift times 1 + near/(1 + x) - far x/(1 + x), x = (h/length)^sharpness",
                            SeenIn::both,
                            {"gap"},
                            {{"near", "1", -0.9, 5, 0.2, 0, false, "suction deeper by this fraction at small gaps"},
                             {"far", "1", -5, 1, 0.2, 0, false, "weaker by this fraction at large gaps"},
                             {"length", "m", 0.0001, 5, 0.1, 0.1, true, "gap between the two", true},
                             // below 1 no slope at the ground is finite, above 4 there is a step
                             {"sharpness", "1", 1, 4, 0.5, 2, true, "how sharply near passes into far"}},
                            "after the load-cell tests of the thesis, chapter 5: deeper near dip, weaker far field; "
                            "they do not say "
                            "how sharply one passes into the other",
                            true},
                 {.needs = {"gap"},
                  .starts = {{0.1, 0.1, 0.03, 2}, {0.1, 0.1, 0.1, 2}, {0.1, 0.1, 0.3, 2}},
                  .kin = {"place"},
                  .lift_unless_named = true,
                  .also_held = "sharpness",
                  .one_strength_form = "as much deeper near as weaker far"}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 if (context.time_series) {
                     parameters[0].lower = parameters[1].lower = 0;  // deeper near, weaker far: not the other way round
                 } else {
                     parameters[3].lower = parameters[3].upper = parameters[3].neutral;  // few gaps do not show it
                 }
                 return true;
             },
         .add_to =
             [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
                 if (!concerns(use, "lift_force")) {
                     return;
                 }
                 terms.rough_near = use.values[0];
                 terms.rough_far = use.values[1];
                 terms.rough_length = use.values[2];
                 terms.rough_sharpness = use.values[3];
             },
         .after =
             [](const std::string& quantity, double value, const StaticPoint& seen, const Conditions& /*set_point*/,
                const EffectUse& use) {
                 if (!concerns_lift(use, quantity)) {
                     return value;
                 }
                 double slope = 0;
                 return value * roughness_factor(use.values[0], use.values[1], use.values[2], use.values[3],
                                                 seen.conditions.get(Channel::gap, 0), slope);
             }}};
    return effect;
}

}  // namespace underbody::dynamics
