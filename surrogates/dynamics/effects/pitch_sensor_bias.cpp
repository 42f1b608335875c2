// reading = pitch + bias
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

namespace {

class PitchSensorBiasEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(EffectInfo{"pitch_sensor_bias",
                                "bias of the pitch sensor",
                                "reading = pitch + bias",
                                SeenIn::time_series,
                                {},
                                {{"bias", "rad", -1, 1, 0.005, 0, false, "reading too large when positive"}},
                                "definition"},
                     {.kin = {"trim"}});
        return the;
    }

    [[nodiscard]] bool look(const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                            double& /*prior*/) const override {
        return context.pitches;
    }

    void add_to(HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) const override {
        terms.pitch.sensor_bias += use.values[0];
    }
};

}  // namespace

const Effect& pitch_sensor_bias_effect() {
    static const PitchSensorBiasEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
