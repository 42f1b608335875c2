// F = -area sqrt(rho mu/pi) * integral of w'(s)/sqrt(t - s) ds
#include <cmath>
#include <numbers>

#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& history_force_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"history_force",
                            "history force (Basset)",
                            "F = -area sqrt(rho mu/pi) * integral of w'(s)/sqrt(t - s) ds",
                            SeenIn::time_series,
                            {"time", "heave_acceleration"},
                            {{"area", "m^2", 0, 10000.0, 1, 0, false,
                              "wetted area of a plate that would have it; 6 pi R^2 for a sphere of radius R"}},
                            "Basset 1888; Stokes layer over a plate"},
                 {.kin = {"damping", "inertia"}, .one_sign = true}),
        {.add_to = [](HeaveTerms& terms, const EffectUse& use, const Model& model) {
            const double rho = model.environment.density;
            const double mu = rho * model.environment.kinematic_viscosity;
            terms.history += use.values[0] * std::sqrt(rho * mu / std::numbers::pi);
        }}};
    return effect;
}

}  // namespace underbody::dynamics
