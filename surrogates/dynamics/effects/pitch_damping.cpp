// M = -coefficient q
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

namespace {

class PitchDampingEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(EffectInfo{"pitch_damping",
                                "linear damping missing from the drag law of pitch",
                                "M = -coefficient q",
                                SeenIn::time_series,
                                {"pitch_rate"},
                                {{"coefficient", "N m s", -10, 10000, 0.005, 0, false, "resistance positive"}},
                                "definition"},
                     {.kin = {"pitch damping"}, .one_sign = true});
        return the;
    }

    [[nodiscard]] bool look(const SearchContext& context, std::vector<EffectParameter>& parameters,
                            double& /*prior*/) const override {
        if (context.pitches && context.model.drag_pitch.kind == DragLaw::Kind::linear_quadratic) {
            parameters.front().lower = -context.model.drag_pitch.linear;  // water takes energy, it does not give any
        }
        return context.pitches;
    }

    void add_to(HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) const override {
        terms.pitch.linear += use.values[0];
    }
};

}  // namespace

const Effect& pitch_damping_effect() {
    static const PitchDampingEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
