// M = -coefficient q |q|
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

namespace {

class PitchQuadraticDampingEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the =
            searched(EffectInfo{"pitch_quadratic_damping",
                                "quadratic damping missing from the drag law of pitch",
                                "M = -coefficient q |q|",
                                SeenIn::time_series,
                                {"pitch_rate"},
                                {{"coefficient", "N m s^2", -10, 10000, 0.02, 0, false, "resistance positive"}},
                                "definition"},
                     {.kin = {"pitch damping"}, .one_sign = true});
        return the;
    }

    [[nodiscard]] bool look(const SearchContext& context, std::vector<EffectParameter>& parameters,
                            double& /*prior*/) const override {
        if (context.pitches && context.model.drag_pitch.kind == DragLaw::Kind::linear_quadratic) {
            parameters.front().lower = -context.model.drag_pitch.quadratic;  // water takes energy, it does not give any
        }
        return context.pitches;
    }

    void add_to(HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) const override {
        terms.pitch.quadratic += use.values[0];
    }
};

}  // namespace

const Effect& pitch_quadratic_damping_effect() {
    static const PitchQuadraticDampingEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
