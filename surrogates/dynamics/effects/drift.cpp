// reading = force + rate time
#include "surrogates/dynamics/effects/catalogue.h"

namespace underbody::dynamics {

namespace {

class DriftEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(of_the_rig({"drift",
                                 "drift of the load cell",
                                 "reading = force + rate time",
                                 SeenIn::static_set,
                                 {"time"},
                                 {{"rate", "N/s", -10, 10, 1e-06, 0, false, "growth of the reading"}},
                                 "definition",
                                 true}),
                     {.needs = {"time"}});
        return the;
    }

    [[nodiscard]] double after(const std::string& quantity, double value, const StaticPoint& /*seen*/,
                               const Conditions& set_point, const EffectUse& use) const override {
        return concerns(use, quantity) ? value + use.values[0] * set_point.get(Channel::time, 0) : value;
    }
};

}  // namespace

const Effect& drift_effect() {
    static const DriftEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
