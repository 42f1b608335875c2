#include "surrogates/discovery/static/static_experiment.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/counted.h"

namespace underbody::discovery {

using dynamics::Channel;
using dynamics::channel_count;

namespace {

dynamics::Conditions conditions_of(const dynamics::MeasuredRun& run, std::size_t row) {
    dynamics::Conditions at;
    for (const auto& [name, value] : run.conditions) {
        Channel channel{};
        if (dynamics::find_channel(name, channel)) {
            at[channel] = value;
        }
    }
    for (std::size_t c = 0; c < channel_count; ++c) {
        const core::Column* column = run.table.find(dynamics::channel_name(static_cast<Channel>(c)));
        if (column != nullptr && !column->is_text()) {
            at.value[c] = column->numbers[row];
        }
    }
    return at;
}

}  // namespace

bool sets_the_point(Channel channel) {
    return channel == Channel::gap || channel == Channel::speed || channel == Channel::jet_voltage ||
           channel == Channel::pitch || channel == Channel::depth || channel == Channel::jet_flow;
}

StaticExperiment::StaticExperiment(const dynamics::Model& model, const dynamics::Measurements& data)
    : model_(model.resolved()) {
    const std::vector<std::string> known = model_.quantities();
    for (const std::string& quantity : dynamics::force_channels()) {
        const bool measured = std::any_of(data.runs.begin(), data.runs.end(),
                                          [&](const auto& run) { return run.table.find(quantity) != nullptr; });
        if (!measured) {
            continue;
        }
        if (std::find(known.begin(), known.end(), quantity) == known.end()) {
            problems_.push_back({core::Problem::Severity::warning,
                                 quantity + " was measured, but the model says nothing of it: left out",
                                 core::Place{data.folder.string(), {}, {}, {}}});
            continue;
        }
        quantities_.push_back(quantity);
    }
    if (quantities_.empty()) {
        throw core::InputError("missing", "the model gives none of the measured quantities",
                               core::Place{model.name, {}, {}, {}},
                               "add a [[force]] with the quantity that was measured");
    }
    collect(data);
    find_varying();
    find_set_points();
}

void StaticExperiment::collect(const dynamics::Measurements& data) {
    std::size_t without = 0;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const dynamics::MeasuredRun& run = data.runs[r];
        for (std::size_t row = 0; row < run.table.rows(); ++row) {
            const dynamics::Conditions at = conditions_of(run, row);
            for (std::size_t q = 0; q < quantities_.size(); ++q) {
                const core::Column* column = run.table.find(quantities_[q]);
                if (column == nullptr || std::isnan(column->numbers[row])) {
                    continue;
                }
                Observation one;
                one.quantity = q;
                one.run = r;
                one.row = row;
                one.at = at;
                one.value = column->numbers[row];
                const core::Column* sigma = run.table.find(quantities_[q] + "_sigma");
                if (sigma != nullptr && sigma->numbers[row] > 0) {
                    one.sigma = sigma->numbers[row];
                } else if (const auto declared = data.declared_noise(quantities_[q])) {
                    one.sigma = *declared;
                }
                try {
                    bool outside = false;
                    if (!std::isfinite(predict(one, {}, &outside))) {
                        ++without;
                        continue;
                    }
                    outside_ += outside ? 1 : 0;
                } catch (const core::InputError& error) {
                    throw core::InputError(error.kind(), error.message(), run.table.place(row, quantities_[q]),
                                           error.hint());
                }
                observations_.push_back(one);
            }
        }
    }
    if (without > 0) {
        problems_.push_back(
            {core::Problem::Severity::warning,
             core::counted(without, "row lacks", "rows lack") + " a set point that the model needs: left out",
             core::Place{data.folder.string(), {}, {}, {}}});
    }
    if (observations_.size() < 8) {
        throw core::InputError(
            "range", "only " + std::to_string(observations_.size()) + " measured values can be compared with the model",
            core::Place{data.folder.string(), {}, {}, {}}, "at least 8 are needed to say anything about a residual");
    }
}

void StaticExperiment::find_varying() {
    for (std::size_t c = 0; c < channel_count; ++c) {
        double lower = 1e300;
        double upper = -1e300;
        bool complete = true;
        for (const Observation& one : observations_) {
            complete = complete && std::isfinite(one.at.value[c]);
            lower = std::min(lower, one.at.value[c]);
            upper = std::max(upper, one.at.value[c]);
        }
        if (complete && upper - lower > 1e-9 * std::max(std::abs(lower), std::abs(upper))) {
            varying_.push_back(static_cast<Channel>(c));
        }
    }
}

void StaticExperiment::find_set_points() {
    std::array<double, channel_count> lower{};
    std::array<double, channel_count> range{};
    for (const Channel channel : varying_) {
        const auto c = static_cast<std::size_t>(channel);
        double low = 1e300;
        double high = -1e300;
        for (const Observation& one : observations_) {
            low = std::min(low, one.at.value[c]);
            high = std::max(high, one.at.value[c]);
        }
        lower[c] = low;
        range[c] = high - low;
    }
    std::map<std::vector<long>, std::size_t> seen;
    for (Observation& one : observations_) {
        std::vector<long> key;
        for (const Channel channel : varying_) {
            const auto c = static_cast<std::size_t>(channel);
            if (sets_the_point(channel)) {
                key.push_back(std::lround((one.at.value[c] - lower[c]) / range[c] * 2000));
            }
        }
        one.set_point = seen.emplace(std::move(key), seen.size()).first->second;
    }
    set_points_ = seen.size();
}

namespace {

bool replaces_a_number(const dynamics::EffectUse& use) { return !use.parameter.empty(); }

/// The model with those of the uses carried out that replace a declared number.
dynamics::Model with_numbers(dynamics::Model model, const std::vector<dynamics::EffectUse>& uses) {
    for (const dynamics::EffectUse& use : uses) {
        if (replaces_a_number(use)) {
            model = model.with_parameter(use.parameter, use.values.front());
        }
    }
    return model;
}

bool any_number(const std::vector<dynamics::EffectUse>& uses) {
    return std::any_of(uses.begin(), uses.end(), replaces_a_number);
}

}  // namespace

double StaticExperiment::value_of(const dynamics::Model& model, const Observation& observation,
                                  const std::vector<dynamics::EffectUse>& uses, bool* outside) const {
    dynamics::StaticPoint point;
    point.conditions = observation.at.over(model.conditions);
    point.model = &model;
    const dynamics::Conditions set_point = point.conditions;
    const std::string& quantity = quantities_[observation.quantity];
    for (const auto* list : {&model.effects, &uses}) {
        for (const dynamics::EffectUse& use : *list) {
            dynamics::effect(use.name).before(point, use);
        }
    }
    double value = dynamics::sum_of_sources(model, quantity, point.conditions, outside);
    for (const auto* list : {&model.effects, &uses}) {
        for (const dynamics::EffectUse& use : *list) {
            value = dynamics::effect(use.name).after(quantity, value, point, set_point, use);
        }
    }
    return value;
}

double StaticExperiment::predict(const Observation& observation, const std::vector<dynamics::EffectUse>& uses,
                                 bool* outside) const {
    return any_number(uses) ? value_of(with_numbers(model_, uses), observation, uses, outside)
                            : value_of(model_, observation, uses, outside);
}

double StaticExperiment::sigma(const Observation& observation) const {
    const auto found = noise_.find(quantities_[observation.quantity]);
    if (found == noise_.end() || (found->second.from == "declared" && observation.sigma > 0)) {
        return observation.sigma;
    }
    const NoiseFigure& figure = found->second;
    return observation.sigma > 0 && figure.declared > 0 ? figure.value * observation.sigma / figure.declared
                                                        : figure.value;
}

void StaticExperiment::residuals(const std::vector<std::size_t>& chosen, const std::vector<dynamics::EffectUse>& uses,
                                 std::vector<double>& out) const {
    out.resize(chosen.size());
    const dynamics::Model* model = &model_;
    std::optional<dynamics::Model> changed;
    if (any_number(uses)) {
        changed = with_numbers(model_, uses);
        model = &*changed;
    }
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const Observation& one = observations_[chosen[i]];
        out[i] = (one.value - value_of(*model, one, uses, nullptr)) / sigma(one);
    }
    whiten(chosen, out.data());
}

namespace {

/// Of many starts the two that lead furthest down in two steps, where they arrived.
template <class FitFrom>
void keep_promising(std::vector<std::vector<double>>& starts, const FitFrom& fit_from) {
    constexpr std::size_t few = 4;
    if (starts.size() <= few) {
        return;
    }
    std::vector<Fit> begun;
    for (const std::vector<double>& start : starts) {
        begun.push_back(fit_from(start, {.iterations = 2}));
    }
    std::stable_sort(begun.begin(), begun.end(), [](const Fit& a, const Fit& b) { return a.cost < b.cost; });
    starts = {begun[0].parameters, begun[1].parameters};
}

}  // namespace

FittedHypothesis StaticExperiment::fit(const Hypothesis& hypothesis, const std::vector<std::size_t>& chosen) const {
    FittedHypothesis best;
    best.hypothesis = hypothesis;
    const WhitenedResiduals evaluate = [&](std::span<const double> p, std::vector<double>& r) {
        residuals(chosen, hypothesis.with(p), r);
        return 0.0;
    };
    std::vector<std::vector<double>> starts = hypothesis.starts;
    if (starts.empty()) {
        starts.push_back(hypothesis.start());
    }
    const auto fit_from = [&](const std::vector<double>& start, const FitOptions& options) {
        std::vector<FitParameter> parameters = hypothesis.parameters;
        for (std::size_t j = 0; j < parameters.size(); ++j) {
            parameters[j].start = start[j];
        }
        return least_squares(parameters, evaluate, options);
    };
    keep_promising(starts, fit_from);
    bool first = true;
    for (const std::vector<double>& start : starts) {
        Fit fit = fit_from(start, {});
        if (first || fit.cost < best.fit.cost) {
            best.fit = std::move(fit);
            first = false;
        }
    }
    best.cost = best.fit.cost;
    best.occam = occam_factor(hypothesis, chosen.size());
    return best;
}

}  // namespace underbody::discovery
