#include "surrogates/dynamics/model/force_sources.h"

#include <algorithm>
#include <limits>

#include "surrogates/dynamics/model/source_shares.h"

namespace underbody::dynamics {

bool driven_by_jet(const ForceSource& source) {
    const auto is_jet = [](Channel channel) { return channel == Channel::jet_voltage || channel == Channel::jet_flow; };
    return std::any_of(source.axes.begin(), source.axes.end(), is_jet) ||
           std::any_of(source.scales.begin(), source.scales.end(),
                       [&](const ForceScale& scale) { return is_jet(scale.channel); });
}

ForceSources::ForceSources(const Model& model, const std::string& quantity, const Conditions& held,
                           const std::vector<Channel>& varying) {
    lower_.fill(-std::numeric_limits<double>::infinity());
    upper_.fill(std::numeric_limits<double>::infinity());
    const auto varies = [&](Channel channel) {
        return std::find(varying.begin(), varying.end(), channel) != varying.end();
    };
    for (const ForceSource& declared : model.forces) {
        if (declared.quantity != quantity) {
            continue;
        }
        Source source{declared.table, declared.factor, {}, {}, {}, 0};
        for (const ForceScale& scale : declared.scales) {
            if (varies(scale.channel)) {
                source.scales.push_back(scale);
            } else {
                source.factor *= scale_factor(scale, held[scale.channel]);
            }
        }
        if (model.coupling.kind == Coupling::Kind::sheltered && driven_by_jet(declared)) {
            if (varies(Channel::speed)) {
                source.shelter_speed = model.coupling.limit_speed;
            } else {
                source.factor *= shelter_factor(held[Channel::speed], model.coupling.limit_speed);
            }
        }
        for (std::size_t i = 0; i < declared.axes.size(); ++i) {
            const Channel channel = declared.axes[i];
            const tables::TableAxis& axis = declared.table.axes()[i];
            const auto c = static_cast<std::size_t>(channel);
            lower_[c] = std::max(lower_[c], axis.lower);
            upper_[c] = std::min(upper_[c], axis.upper);
            if (varies(channel)) {
                source.axes.emplace_back(i, channel);
            } else if (held.has(channel)) {
                source.held[i] = held[channel];
            } else {
                throw core::InputError(
                    "missing",
                    std::string("nothing says the ") + channel_name(channel) + ", an axis of " + declared.table_file,
                    {model.name, {}, {}, {}}, "give it as a condition, or under [conditions] in the model");
            }
        }
        sources_.push_back(std::move(source));
    }
    Model acting = model.resolved();
    acting.effects = effects_on_tables(acting, quantity);
    if (!acting.effects.empty()) {
        with_effects_ = std::make_shared<const StaticModel>(acting, quantity);
        held_ = held;
    }
}

double ForceSources::operator()(const Conditions& at) const {
    return with_effects_ ? (*with_effects_)(at.over(held_)) : sum(at);
}

double ForceSources::sum(const Conditions& seen) const {
    double sum = 0;
    for (const Source& source : sources_) {
        std::array<double, tables::max_axes> point = source.held;
        for (const auto& [index, channel] : source.axes) {
            point[index] = seen[channel];
        }
        double factor = source.factor;
        for (const ForceScale& scale : source.scales) {
            factor *= scale_factor(scale, seen[scale.channel]);
        }
        if (source.shelter_speed > 0) {
            factor *= shelter_factor(seen[Channel::speed], source.shelter_speed);
        }
        sum += factor * source.table.value(point.data());
    }
    return sum;
}

}  // namespace underbody::dynamics
