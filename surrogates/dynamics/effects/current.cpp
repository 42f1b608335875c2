// speed through the water = speed + velocity
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/search.h"

namespace underbody::dynamics {

namespace {

class CurrentEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(of_the_rig({"current",
                                 "water that moves along x",
                                 "speed through the water = speed + velocity",
                                 SeenIn::static_set,
                                 {"speed"},
                                 {{"velocity", "m/s", -5, 5, 0.02, 0, false, "adds to the speed through the water"}},
                                 "definition"}),
                     {.needs = {"speed"}});
        return the;
    }

    [[nodiscard]] bool look(const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                            double& /*prior*/) const override {
        return source_feels(context, Channel::speed, true);
    }

    void before(StaticPoint& point, const EffectUse& use) const override {
        point.conditions[Channel::speed] += use.values[0];
    }
};

}  // namespace

const Effect& current_effect() {
    static const CurrentEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
