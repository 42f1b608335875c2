// Buoyancy of a part that hangs into the water, as a load cell reads it: one law for strut and cable.
#pragma once

#include "surrogates/dynamics/effects/catalogue.h"

namespace underbody::dynamics {

/// reading = force + slope (depth, or gap where no depth is given) + force
class ImmersedPart : public Effect {
public:
    ImmersedPart(const char* name, const char* title, const char* depends_on)
        : info_(of_the_rig(
              {name,
               title,
               "reading = force + slope (depth, or gap where no depth is given) + force",
               SeenIn::static_set,
               {depends_on},
               {{"slope", "N/m", -10000.0, 10000.0, 0.05, 0, false, "growth of the reading with depth or gap"},
                {"force", "N", -1000.0, 1000.0, 0.01, 0, true, "at depth or gap zero"}},
               "Archimedes",
               true})) {}

    [[nodiscard]] const EffectInfo& info() const override { return info_; }

    [[nodiscard]] double after(const std::string& quantity, double value, const StaticPoint& /*seen*/,
                               const Conditions& set_point, const EffectUse& use) const override {
        if (use.quantity.empty() ? quantity != "lift_force" : use.quantity != quantity) {
            return value;
        }
        const double where = set_point.get(Channel::depth, set_point.get(Channel::gap, 0));
        return value + use.values[1] + use.values[0] * where;
    }

private:
    EffectInfo info_;
};

}  // namespace underbody::dynamics
