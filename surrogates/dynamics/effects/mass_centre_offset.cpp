// forward coordinates of base and buoyancy fall by distance: M = -distance cos(pitch) (lift + buoyancy), dh/dt = w + a
// q with the new a
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& mass_centre_offset_effect() {
    static const LawEffect effect{
        searched(
            EffectInfo{"mass_centre_offset",
                       "centre of gravity ahead of the declared one",
                       "forward coordinates of base and buoyancy fall by distance: M = -distance cos(pitch) (lift + "
                       "buoyancy), dh/dt = w + a q with the new a",
                       SeenIn::time_series,
                       {"lift_force"},
                       {{"distance", "m", -5, 5, 0.003, 0, false, "centre of gravity forward of the declared one"}},
                       "rigid body: moments about the centre of gravity"},
            {.kin = {"trim"}}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 if (context.pitches) {  // within the base
                     parameters.front().lower = -context.model.vehicle.base_half_length;
                     parameters.front().upper = context.model.vehicle.base_half_length;
                 }
                 return context.pitches;
             },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.pitch.mass_forward += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
