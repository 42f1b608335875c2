// pitch + angle where tables have a pitch axis; else the load cell leans: lift cos + drag sin, drag cos - lift sin
#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

const Effect& pitch_misalignment_effect() {
    static const LawEffect effect{
        of_the_rig({"pitch_misalignment",
                    "body mounted at an angle",
                    "pitch + angle where tables have a pitch axis; else the load cell leans: lift cos "
                    "+ drag sin, drag cos - lift sin",
                    SeenIn::static_set,
                    {"pitch", "lift_force", "drag_force"},
                    {{"angle", "rad", -0.6, 0.6, 0.01, 0, false, "nose up"}},
                    "rotation of the balance axes"}),
        {.look =
             [](const SearchContext& context, std::vector<EffectParameter>& /*parameters*/, double& /*prior*/) {
                 // without a pitch axis the balance leans: that needs lift and drag, both in the model
                 const std::vector<std::string> known = context.model.quantities();
                 const auto has = [](const std::vector<std::string>& list, const char* quantity) {
                     return std::find(list.begin(), list.end(), quantity) != list.end();
                 };
                 return source_feels(context, Channel::pitch, false) ||
                        (has(known, "lift_force") && has(known, "drag_force") &&
                         (has(context.quantities, "lift_force") || has(context.quantities, "drag_force")));
             },
         .before =
             [](StaticPoint& point, const EffectUse& use) {
                 point.conditions[Channel::pitch] = point.conditions.get(Channel::pitch, 0) + use.values[0];
             },
         .after =
             [](const std::string& quantity, double value, const StaticPoint& seen, const Conditions& /*set_point*/,
                const EffectUse& use) {
                 for (const ForceSource& source : seen.model->forces) {
                     if (source.quantity == quantity &&
                         std::find(source.axes.begin(), source.axes.end(), Channel::pitch) != source.axes.end()) {
                         return value;
                     }
                 }
                 const double c = std::cos(use.values[0]), s = std::sin(use.values[0]);
                 if (quantity == "lift_force") {
                     return value * c + sum_of_sources(*seen.model, "drag_force", seen.conditions) * s;
                 }
                 if (quantity == "drag_force") {
                     return value * c - sum_of_sources(*seen.model, "lift_force", seen.conditions) * s;
                 }
                 return value;
             }}};
    return effect;
}

}  // namespace underbody::dynamics
