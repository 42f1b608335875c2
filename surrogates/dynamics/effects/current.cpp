// speed through the water = speed + velocity
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"

namespace underbody::dynamics {

const Effect& current_effect() {
    static const LawEffect effect{
        searched(of_the_rig({"current",
                             "water that moves along x",
                             "speed through the water = speed + velocity",
                             SeenIn::static_set,
                             {"speed"},
                             {{"velocity", "m/s", -5, 5, 0.02, 0, false, "adds to the speed through the water"}},
                             "definition"}),
                 {.needs = {"speed"}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return source_feels(context, Channel::speed, true); },
         .before = [](StaticPoint& point,
                      const EffectUse& use) { point.conditions[Channel::speed] += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
