#include "surrogates/dynamics/plant/heave_equation.h"

namespace underbody::dynamics {

HeaveTerms::Correction::Correction(tables::ForceTable of, std::vector<Channel> over)
    : table(std::move(of)), axes(std::move(over)) {
    if (axes.size() == 1 && (axes[0] == Channel::gap || axes[0] == Channel::heave_velocity)) {
        const double nothing[1] = {0};
        curve = Curve::along(table, 0, nothing);
    }
}

void add_corrections(const HeaveTerms& terms, double h, double w, const HeaveMoment& moment, const Conditions& held,
                     HeaveLoad& load) {
    for (const HeaveTerms::Correction& correction : terms.corrections) {
        if (correction.curve.empty()) {
            double point[tables::max_axes] = {}, slope[tables::max_axes] = {};
            for (std::size_t a = 0; a < correction.axes.size(); ++a) {
                const Channel channel = correction.axes[a];
                const auto index = static_cast<std::size_t>(channel);
                const double outside = moment.channels ? moment.channels[index] : held.value[index];
                point[a] = channel == Channel::gap              ? h
                           : channel == Channel::heave_velocity ? w
                           : channel == Channel::time           ? moment.t
                           : channel == Channel::input_force    ? moment.input
                                                                : (std::isnan(outside) ? 0.0 : outside);
            }
            load.force += correction.table.value(point, slope);
            for (std::size_t a = 0; a < correction.axes.size(); ++a) {
                load.slope_h += correction.axes[a] == Channel::gap ? slope[a] : 0;
                load.slope_w += correction.axes[a] == Channel::heave_velocity ? slope[a] : 0;
            }
        }
    }
}

void add_extras(const HeaveTerms& terms, double t, double h, double w, HeaveLoad& load) {
    constexpr double dh = 1e-7, dw = 1e-7;  // m and m/s: far below what a motion resolves, far above rounding
    for (const HeaveTerms::ExtraTerm& extra : terms.extras) {
        const auto force = [&](double gap, double velocity) { return extra.force(extra.parameters, t, gap, velocity); };
        load.force += force(h, w);
        load.slope_h += (force(h + dh, w) - force(h - dh, w)) / (2 * dh);
        load.slope_w += (force(h, w + dw) - force(h, w - dw)) / (2 * dw);
    }
}

}  // namespace underbody::dynamics
