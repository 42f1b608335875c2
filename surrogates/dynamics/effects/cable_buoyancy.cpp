// reading = force + slope (depth, or gap where no depth is given) + force
#include "surrogates/dynamics/effects/catalogue.h"

namespace underbody::dynamics {

namespace {

class Kind final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the{
            "cable_buoyancy",
            "buoyancy of a cable",
            "reading = force + slope (depth, or gap where no depth is given) + force",
            SeenIn::static_set,
            {"gap"},
            {{"slope", "N/m", -10000.0, 10000.0, 0.05, 0, false, "growth of the reading with depth or gap"},
             {"force", "N", -1000.0, 1000.0, 0.01, 0, true, "at depth or gap zero"}},
            "Archimedes",
            true};
        return the;
    }

    [[nodiscard]] double after(const std::string& quantity, double value, const StaticPoint& /*seen*/,
                               const Conditions& set_point, const EffectUse& use) const override {
        if (use.quantity.empty() ? quantity != "lift_force" : use.quantity != quantity) {
            return value;
        }
        const double where = set_point.get(Channel::depth, set_point.get(Channel::gap, 0));
        return value + use.values[1] + use.values[0] * where;
    }
};

}  // namespace

const Effect& cable_buoyancy_effect() {
    static const Kind kind;
    return kind;
}

}  // namespace underbody::dynamics
