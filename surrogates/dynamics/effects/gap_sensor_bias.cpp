// reading = h + bias
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

namespace {

class GapSensorBiasEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(EffectInfo{"gap_sensor_bias",
                                "bias of the gap sensor",
                                "reading = h + bias",
                                SeenIn::time_series,
                                {"gap"},
                                {{"bias", "m", -1, 1, 0.002, 0, false, "reading too large when positive"}},
                                "definition"},
                     {.kin = {"place"}});
        return the;
    }

    void add_to(HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) const override {
        terms.sensor_bias += use.values[0];
    }
};

}  // namespace

const Effect& gap_sensor_bias_effect() {
    static const GapSensorBiasEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
