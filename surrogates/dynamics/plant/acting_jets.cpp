#include "surrogates/dynamics/plant/acting_jets.h"

#include <cmath>

namespace underbody::dynamics {

std::vector<Jet> acting_jets(std::vector<Jet> jets, const SurfaceTerms& effects) {
    const double c = std::cos(effects.jet_angle), s = std::sin(effects.jet_angle);
    for (Jet& jet : jets) {
        const double along = jet.direction[0], across = jet.direction[1];
        jet.direction = {effects.thrust_gain * (c * along - s * across), effects.thrust_gain * (s * along + c * across),
                         effects.thrust_gain * jet.direction[2]};
    }
    return jets;
}

}  // namespace underbody::dynamics
