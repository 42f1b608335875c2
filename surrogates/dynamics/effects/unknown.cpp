// force + table(its variables)
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

const Effect& unknown_effect() {
    static const LawEffect effect{{"unknown",
                                   "a smooth correction by a table",
                                   "force + table(its variables)",
                                   SeenIn::both,
                                   {},
                                   {},
                                   "measured residual",
                                   true,
                                   true},
                                  {.add_to =
                                       [](HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
                                           const std::string& quantity =
                                               use.quantity.empty() && use.table ? use.table->quantity() : use.quantity;
                                           if (!use.table || quantity != "lift_force") {
                                               return;  // a correction of the drag or of a moment is no force in heave
                                           }
                                           std::vector<Channel> axes;
                                           for (const tables::TableAxis& axis : use.table->axes()) {
                                               Channel channel{};
                                               find_channel(axis.name, channel);
                                               axes.push_back(channel);
                                           }
                                           terms.corrections.emplace_back(*use.table, std::move(axes));
                                       },
                                   .after =
                                       [](const std::string& quantity, double value, const StaticPoint& /*seen*/,
                                          const Conditions& set_point, const EffectUse& use) {
                                           if (!use.table || (use.quantity.empty() ? quantity != use.table->quantity()
                                                                                   : use.quantity != quantity)) {
                                               return value;
                                           }
                                           double point[tables::max_axes] = {};
                                           std::size_t i = 0;
                                           for (const tables::TableAxis& axis : use.table->axes()) {
                                               Channel channel{};
                                               find_channel(axis.name, channel);
                                               point[i++] = set_point.get(channel, 0);
                                           }
                                           return value + use.table->value(point);
                                       }}};
    return effect;
}

}  // namespace underbody::dynamics
