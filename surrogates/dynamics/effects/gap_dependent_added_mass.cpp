// M(h) = M + mass length/(h + length), with its Lagrangian term 1/2 M(h)' w^2
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& gap_dependent_added_mass_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"gap_dependent_added_mass",
                            "added mass that grows toward the ground",
                            "M(h) = M + mass length/(h + length), with its Lagrangian term 1/2 M(h)' w^2",
                            SeenIn::time_series,
                            {"gap", "heave_acceleration"},
                            {{"mass", "kg", -20, 1000.0, 1, 0, false, "extra virtual mass at the ground"},
                             {"length", "m", 0.0001, 2, 0.05, 0.05, true, "gap at which half of it is left", true}},
                            "thin-gap limit rho G/h: Lamb 1932; kinetic energy 1/2 M(h) w^2"},
                 {.starts = {{0.5, 0.02}, {0.5, 0.06}, {0.5, 0.2}},
                  .kin = {"inertia"},
                  .one_sign = true,
                  .beside = "added_mass",
                  .beside_form = "far inertia free as well"}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& parameters, double& /*prior*/) {
                 if (context.time_series) {
                     parameters.front().upper = std::min(parameters.front().upper, 10 * context.model.heave_mass());
                 }
                 return true;
             },
         .add_to =
             [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
                 terms.growth.push_back({use.values[0], use.values[1]});
             }}};
    return effect;
}

}  // namespace underbody::dynamics
