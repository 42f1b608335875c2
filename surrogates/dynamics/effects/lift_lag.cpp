// F = -time_constant L'(h) w: the lift of a moment ago, to first order
#include <cmath>

#include "core/table.h"
#include "surrogates/dynamics/effects/catalogue.h"
#include "surrogates/dynamics/effects/law_effect.h"
#include "surrogates/dynamics/effects/search.h"
#include "surrogates/dynamics/plant/heave_terms.h"

namespace underbody::dynamics {

namespace {

constexpr int gaps = 96;         ///< of the table, closer where the gap is small
constexpr double fastest = 100;  ///< m/s, end of the table: the law is linear along the velocity

/// L'(h) of all sources of lift that follow the gap alone, N/m.
double slope_of_lift(const HeaveTerms& terms, double h) {
    double sum = 0;
    for (const HeaveSource& source : terms.sources) {
        if (!source.curve.empty()) {
            double slope = 0;
            static_cast<void>(source.curve.value(h, slope));
            sum += source.multiplier() * slope;
        }
    }
    return sum;
}

/// As a table over gap and velocity, so that everything that takes a correction takes it.
void add_lag(HeaveTerms& terms, const EffectUse& use, const Model& /*model*/) {
    if (use.values[0] == 0 || !(terms.table_upper > terms.table_lower)) {
        return;
    }
    const double low = std::max(terms.table_lower, 1e-3 * terms.table_upper);
    std::vector<double> gap, velocity, force;
    for (const double w : {-fastest, fastest}) {
        for (int k = 0; k < gaps; ++k) {
            gap.push_back(low * std::pow(terms.table_upper / low, k / (gaps - 1.0)));
            velocity.push_back(w);
            force.push_back(-use.values[0] * slope_of_lift(terms, gap.back()) * w);
        }
    }
    core::Table table;
    table.source = "lift_lag";
    table.add_numbers("gap", "m", gap);
    table.add_numbers("heave_velocity", "m/s", velocity);
    table.add_numbers("lift_force", "N", force);
    terms.corrections.emplace_back(tables::ForceTable::fit(table, "lift_force"),
                                   std::vector<Channel>{Channel::gap, Channel::heave_velocity});
}

bool lift_follows_gap(const SearchContext& context, std::vector<EffectParameter>& /*parameters*/, double& /*prior*/) {
    const std::vector<std::string> lift{"lift_force"};
    return context.time_series && !context.pitches && !context.slides && !context.turns &&
           source_feels({context.model, lift, context.varying, true, false, false, false}, Channel::gap, false);
}

}  // namespace

const Effect& lift_lag_effect() {
    static const LawEffect effect{
        searched(EffectInfo{"lift_lag",
                            "lift that follows the gap late",
                            "F = -time_constant L'(h) w, the lift of that long ago to first order",
                            SeenIn::time_series,
                            {"gap", "heave_velocity"},
                            {{"time_constant", "s", 0, 10, 0.05, 0, false,
                              "by which the flow under the body is late; short beside the motion"}},
                            "Theodorsen 1935 (lift follows its circulation); first order in time"},
                 {.kin = {"damping", "inertia"}, .one_sign = true}),
        {.look = lift_follows_gap, .add_to = add_lag}};
    return effect;
}

}  // namespace underbody::dynamics
