// h = set gap + offset
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"

namespace underbody::dynamics {

const Effect& gap_offset_effect() {
    static const LawEffect effect{
        searched(of_the_rig({"gap_offset",
                             "offset of the set gaps",
                             "h = set gap + offset",
                             SeenIn::static_set,
                             {"gap"},
                             {{"offset", "m", -0.1, 0.1, 0.0005, 0, false, "the true gap is larger than the set one"}},
                             "definition"}),
                 // over a curved table the way from a small offset to a large one leads over hills
                 {.needs = {"gap"},
                  .starts = {{2.5e-4}, {-2.5e-4}, {1e-3}, {-1e-3}, {4e-3}, {-4e-3}, {0.016}, {-0.016}, {0.064}}}),
        {.look = [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                    double& /*prior*/) { return source_feels(context, Channel::gap, false); },
         .before = [](StaticPoint& point, const EffectUse& use) { point.conditions[Channel::gap] += use.values[0]; }}};
    return effect;
}

}  // namespace underbody::dynamics
