// M = moment
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

namespace {

class MomentOffsetEffect final : public Effect {
public:
    [[nodiscard]] const EffectInfo& info() const override {
        static const EffectInfo the = searched(EffectInfo{"moment_offset",
                                                          "constant moment",
                                                          "M = moment",
                                                          SeenIn::time_series,
                                                          {},
                                                          {{"moment", "N m", -1000, 1000, 0.002, 0, false, "nose up"}},
                                                          "definition"},
                                               {.kin = {"trim"}});
        return the;
    }

    [[nodiscard]] bool look(const SearchContext& context, std::vector<EffectParameter>& /*parameters*/,
                            double& /*prior*/) const override {
        return context.pitches;
    }

    void add_to(HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) const override {
        terms.pitch.moment += use.values[0];
    }
};

}  // namespace

const Effect& moment_offset_effect() {
    static const MomentOffsetEffect effect;
    return effect;
}

}  // namespace underbody::dynamics
