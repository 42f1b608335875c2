// Buoyancy of a part that hangs into the water, as a load cell reads it: one law for strut and cable.
#pragma once

#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"

namespace underbody::dynamics {

/// reading = force + slope (depth, or gap where no depth is given) + force
class ImmersedPart : public Effect {
public:
    /// `same_law_as`: the other of the two; `towed`: how likely it is on a rig whose speed varies.
    ImmersedPart(const char* name, const char* title, const char* depends_on, const char* same_law_as, double towed)
        : towed_(towed),
          info_(searched(of_the_rig({name,
                                     title,
                                     "reading = force + slope (depth, or gap where no depth is given) + force",
                                     SeenIn::static_set,
                                     {depends_on},
                                     {{"slope", "N/m", -10000.0, 10000.0, 0.05, 0, false,
                                       "growth of the reading with depth or gap"},
                                      {"force", "N", -1000.0, 1000.0, 0.01, 0, true, "at depth or gap zero"}},
                                     "Archimedes",
                                     true}),
                         {.needs_one_of = {"gap", "depth"}, .lift_unless_named = true, .same_law_as = same_law_as})) {}

    [[nodiscard]] const EffectInfo& info() const override { return info_; }

    /// A cable or a strut pulls the way it hangs: the rig says which is likelier.
    [[nodiscard]] bool look(const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                            double& prior) const override {
        prior *= varies(context, Channel::speed) ? towed_ : 1 - towed_;
        return true;
    }

    [[nodiscard]] double after(const std::string& quantity, double value, const StaticPoint& /*seen*/,
                               const Conditions& set_point, const EffectUse& use) const override {
        if (!concerns_lift(use, quantity)) {
            return value;
        }
        const double where = set_point.get(Channel::depth, set_point.get(Channel::gap, 0));
        return value + use.values[1] + use.values[0] * where;
    }

private:
    double towed_;
    EffectInfo info_;
};

}  // namespace underbody::dynamics
