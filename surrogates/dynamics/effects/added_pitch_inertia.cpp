// (I + inertia) dq/dt
#include <algorithm>

#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& added_pitch_inertia_effect() {
    static const LawEffect effect{
        searched(
            EffectInfo{"added_pitch_inertia",
                       "inertia in pitch of the water or of the body",
                       "(I + inertia) dq/dt",
                       SeenIn::time_series,
                       {"pitch_rate"},
                       {{"inertia", "kg m^2", -50, 5000, 0.002, 0, false, "added to the declared inertia in pitch"}},
                       "definition"},
            {.kin = {"inertia in pitch"}, .one_sign = true}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 if (context.pitches) {
                     const double declared =
                         context.model.vehicle.pitch_inertia + context.model.vehicle.added_inertia_pitch;
                     parameters.front().lower = -most_taken * declared;
                     parameters.front().upper = std::min(parameters.front().upper, 5 * declared);
                 }
                 return context.pitches;
             },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.pitch.inertia += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
