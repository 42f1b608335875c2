// F = -coefficient (w - water velocity) |w - water velocity|
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& quadratic_damping_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"quadratic_damping",
                            "quadratic damping missing from the drag law",
                            "F = -coefficient (w - water velocity) |w - water velocity|",
                            SeenIn::time_series,
                            {"heave_velocity"},
                            {{"coefficient", "N s^2/m^2", -1000.0, 100000.0, 3, 0, false, "resistance positive"}},
                            "definition"},
                 {.adds_to = "drag.heave", .kin = {"damping"}, .one_sign = true}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 if (context.time_series && context.model.drag_heave.kind == DragLaw::Kind::linear_quadratic) {
                     parameters.front().lower =
                         -context.model.drag_heave.quadratic;  // water takes energy, it does not give any
                 }
                 return true;
             },
         .add_to = [](HeaveTerms& terms, const EffectUse& use,
                      const Model& /*model*/) { terms.extra_quadratic += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
