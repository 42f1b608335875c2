// M = -coefficient q
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& pitch_damping_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"pitch_damping",
                            "linear damping missing from the drag law of pitch",
                            "M = -coefficient q",
                            SeenIn::time_series,
                            {"pitch_rate"},
                            {{"coefficient", "N m s", -10, 10000, 0.005, 0, false, "resistance positive"}},
                            "definition"},
                 {.adds_to = "drag.pitch", .kin = {"pitch damping"}, .one_sign = true}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 if (context.pitches && context.model.drag_pitch.kind == DragLaw::Kind::linear_quadratic) {
                     parameters.front().lower =
                         -context.model.drag_pitch.linear;  // water takes energy, it does not give any
                 }
                 return context.pitches;
             },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.pitch.linear += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
