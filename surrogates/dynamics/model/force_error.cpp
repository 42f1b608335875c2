#include "surrogates/dynamics/model/force_error.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/random.h"

namespace underbody::dynamics {

namespace {

std::vector<Channel> channels_of(const tables::ForceTable& table) {
    std::vector<Channel> channels;
    for (const tables::TableAxis& axis : table.axes()) {
        Channel channel{};
        find_channel(axis.name, channel);
        channels.push_back(channel);
    }
    return channels;
}

double sigma_at(const tables::ForceTable& table, const std::vector<Channel>& axes, const Conditions& at) {
    double point[tables::max_axes] = {};
    for (std::size_t k = 0; k < axes.size(); ++k) {
        point[k] = at.get(axes[k], 0);
    }
    return table.sigma(point);
}

/// Anywhere on or beyond its grid.
bool states_error(const tables::ForceTable& table) {
    constexpr double off_grid = 0.4567;  // of an axis: on no grid line
    double middle[tables::max_axes], beyond[tables::max_axes];
    for (std::size_t k = 0; k < table.axes().size(); ++k) {
        const auto& axis = table.axes()[k];
        middle[k] = axis.lower + off_grid * (axis.upper - axis.lower);
        beyond[k] = axis.upper + (axis.upper - axis.lower);
    }
    return table.sigma(middle) > 0 || table.sigma(beyond) > 0;
}

/// Tables of one file have one error.
std::string file_of(const ForceSource& source) { return source.table_path.string() + "|" + source.table_file; }

}  // namespace

ForceError::ForceError(const Model& model, const std::string& quantity)
    : model_(model, quantity), quantity_(quantity), shares_(model, quantity) {
    std::vector<std::string> files;
    for (std::size_t i = 0; i < shares_.sources().size(); ++i) {
        const ForceSource& source = model_.model().forces[shares_.sources()[i]];
        if (states_error(source.table)) {
            const std::string file = file_of(source);
            const auto group = static_cast<std::size_t>(std::find(files.begin(), files.end(), file) - files.begin());
            if (group == files.size()) {
                files.push_back(file);
            }
            sources_.push_back({i, group});
        }
    }
    groups_ = files.size();
    for (std::size_t e = 0; e < model.effects.size(); ++e) {
        const EffectUse& use = model.effects[e];
        const auto& parameters = effect(use.name).info().parameters;
        if (use.table && (use.quantity.empty() ? use.table->quantity() : use.quantity) == quantity) {
            corrections_.emplace_back(*use.table, channels_of(*use.table));
        }
        for (std::size_t p = 0; p < parameters.size(); ++p) {
            const bool of_a_force =
                use.parameter.empty() || use.parameter.starts_with("force.") || use.parameter.starts_with("coupling.");
            if (const auto beside = of_a_force ? models_beside(model, e, p) : std::nullopt) {
                parameters_.push_back(
                    {{beside->above, quantity}, {beside->below, quantity}, beside->apart / (2 * use.sigmas[p])});
            }
        }
    }
}

std::optional<ModelsBeside> models_beside(const Model& model, std::size_t effect, std::size_t parameter) {
    const EffectUse& use = model.effects[effect];
    const EffectParameter& bounds = dynamics::effect(use.name).info().parameters[parameter];
    const double sigma = use.sigmas[parameter], value = use.values[parameter];
    const double high = std::min(value + sigma, bounds.upper), low = std::max(value - sigma, bounds.lower);
    if (!(sigma > 0) || !(high > low)) {
        return {};
    }
    ModelsBeside beside{model, model, high - low};
    beside.above.effects[effect].values[parameter] = high;
    beside.below.effects[effect].values[parameter] = low;
    return beside;
}

double ForceError::operator()(const Conditions& set_point) const {
    double sum = 0;
    if (!sources_.empty()) {
        const Conditions seen = model_.seen(set_point);
        const double nothing = shares_.without_tables(set_point);
        for (std::size_t group = 0; group < groups_; ++group) {
            double sigma = 0;
            for (const Source& source : sources_) {
                const ForceSource& declared = model_.model().forces[shares_.sources()[source.share]];
                sigma += source.group == group
                             ? shares_(source.share, set_point, nothing) * sigma_at(declared.table, declared.axes, seen)
                             : 0;
            }
            sum += sigma * sigma;
        }
    }
    const Conditions asked = set_point.over(model_.model().conditions);
    for (const auto& [table, axes] : corrections_) {
        const double sigma = sigma_at(table, axes, asked);
        sum += sigma * sigma;
    }
    for (const Parameter& parameter : parameters_) {
        const double sigma = (parameter.above(set_point) - parameter.below(set_point)) / (2 * parameter.share);
        sum += sigma * sigma;
    }
    return std::sqrt(sum);
}

namespace {

/// Seed 1: the draws that the table's own equilibria take (tables::EquilibriumOptions), so that a model of one table
/// has their errors. Other seeds: others.
std::uint64_t draw_of_first_table(std::uint64_t seed, std::size_t draw) {
    constexpr std::uint64_t most_draws = 1'000'003;
    return (seed - 1) * most_draws + draw;
}

}  // namespace

Model drawn_model(const Model& model, std::uint64_t seed, std::size_t draw) {
    Model result = model;
    core::Random random(seed, draw);
    std::map<std::string, std::uint64_t> seeds;
    for (ForceSource& source : result.forces) {
        const std::uint64_t bits = random.bits();
        const auto own = seeds.try_emplace(file_of(source), seeds.empty() ? draw_of_first_table(seed, draw) : bits);
        source.table = source.table.drawn(own.first->second);
    }
    for (EffectUse& use : result.effects) {
        const std::vector<EffectParameter>& parameters = effect(use.name).info().parameters;
        for (std::size_t p = 0; p < use.values.size(); ++p) {
            if (use.sigmas[p] > 0) {
                use.values[p] = std::clamp(use.values[p] + use.sigmas[p] * random.normal(), parameters[p].lower,
                                           parameters[p].upper);
            }
        }
        if (use.table) {
            use.table = use.table->drawn(random.bits());
        }
    }
    return result;
}

}  // namespace underbody::dynamics
