#include "surrogates/discovery/static_experiment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/random.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/discovery/flexible.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

using dynamics::Channel;
using dynamics::channel_count;

namespace {

/// The channels that make a set point; the others (time, temperature, direction) come along with it.
bool sets_the_point(Channel channel) {
    return channel == Channel::gap || channel == Channel::speed || channel == Channel::jet_voltage || channel == Channel::pitch ||
           channel == Channel::depth || channel == Channel::jet_flow;
}

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

StaticExperiment::StaticExperiment(const dynamics::Model& model, const dynamics::Measurements& data) : model_(model.resolved()) {
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
        throw core::InputError("missing", "the model gives none of the measured quantities", core::Place{model.name, {}, {}, {}},
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
                    throw core::InputError(error.kind(), error.message(), run.table.place(row, quantities_[q]), error.hint());
                }
                observations_.push_back(one);
            }
        }
    }
    if (without > 0) {
        problems_.push_back({core::Problem::Severity::warning,
                             std::to_string(without) + " rows lack a set point that the model needs: left out",
                             core::Place{data.folder.string(), {}, {}, {}}});
    }
    if (observations_.size() < 8) {
        throw core::InputError("range", "only " + std::to_string(observations_.size()) + " measured values can be compared with the model",
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

bool replaces_a_number(const dynamics::EffectUse& use) { return use.name == "declared_parameter"; }

/// The model with those of the uses carried out that replace a declared number.
dynamics::Model with_numbers(dynamics::Model model, const std::vector<dynamics::EffectUse>& uses) {
    for (const dynamics::EffectUse& use : uses) {
        if (replaces_a_number(use)) {
            model = model.with_parameter(use.parameter, use.values.front());
        }
    }
    return model;
}

bool any_number(const std::vector<dynamics::EffectUse>& uses) { return std::any_of(uses.begin(), uses.end(), replaces_a_number); }

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

double StaticExperiment::predict(const Observation& observation, const std::vector<dynamics::EffectUse>& uses, bool* outside) const {
    return any_number(uses) ? value_of(with_numbers(model_, uses), observation, uses, outside) : value_of(model_, observation, uses, outside);
}

double StaticExperiment::sigma(const Observation& observation) const {
    const auto found = noise_.find(quantities_[observation.quantity]);
    if (found == noise_.end() || (found->second.from == "declared" && observation.sigma > 0)) {
        return observation.sigma;
    }
    const NoiseFigure& figure = found->second;
    return observation.sigma > 0 && figure.declared > 0 ? figure.value * observation.sigma / figure.declared : figure.value;
}

namespace {

/// Takes the mean of each set point off every column and off y; degrees lost are the number of set points seen.
std::size_t take_means_off(const std::vector<std::size_t>& set_point, DesignMatrix& columns, std::vector<double>& y) {
    const std::size_t points = set_point.empty() ? 0 : *std::max_element(set_point.begin(), set_point.end()) + 1;
    std::vector<double> count(points, 0);
    for (const std::size_t g : set_point) {
        count[g] += 1;
    }
    const auto centre = [&](double* values) {
        std::vector<double> sum(points, 0);
        for (std::size_t i = 0; i < set_point.size(); ++i) {
            sum[set_point[i]] += values[i];
        }
        for (std::size_t i = 0; i < set_point.size(); ++i) {
            values[i] -= sum[set_point[i]] / count[set_point[i]];
        }
    };
    for (std::size_t k = 0; k < columns.columns; ++k) {
        centre(columns.values.data() + k * columns.rows);
    }
    centre(y.data());
    return static_cast<std::size_t>(std::count_if(count.begin(), count.end(), [](double c) { return c > 0; }));
}

}  // namespace

void StaticExperiment::mark_accidents(const std::vector<std::size_t>& observations) {
    for (const std::size_t i : observations) {
        observations_[i].accident = true;
    }
}

void StaticExperiment::estimate_noise() {
    std::erase_if(problems_, [](const core::Problem& problem) { return problem.message.rfind("the declared noise of ", 0) == 0; });
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
        std::vector<const Observation*> own;
        for (const Observation& one : observations_) {
            if (one.quantity == q && !one.accident) {
                own.push_back(&one);
            }
        }
        std::vector<double> y;
        std::vector<double> force;
        std::vector<std::size_t> set_point;
        std::vector<std::pair<std::size_t, std::size_t>> cells;
        double declared_square = 0;
        for (const Observation* one : own) {
            force.push_back(predict(*one, {}));
            y.push_back(one->value - force.back());
            set_point.push_back(one->set_point);
            cells.emplace_back(one->set_point, one->run);
            declared_square += one->sigma * one->sigma;
        }
        const std::size_t n = own.size();
        // repeats within one run where there are enough of them: runs may contradict each other
        std::map<std::pair<std::size_t, std::size_t>, std::size_t> cell_index;
        for (const auto& cell : cells) {
            cell_index.emplace(cell, cell_index.size());
        }
        if (n >= cell_index.size() + 20) {
            for (std::size_t i = 0; i < n; ++i) {
                set_point[i] = cell_index.at(cells[i]);
            }
        }
        const std::set<std::size_t> distinct(set_point.begin(), set_point.end());
        const bool repeats = n >= distinct.size() + 20;
        // what may change between repeats: time, temperature, direction, each alone and in proportion to the force
        const auto design_of = [&](std::size_t time_columns) {
            DesignMatrix design;
            design.rows = n;
            for (const Channel channel : varying_) {
                if (repeats && sets_the_point(channel)) {
                    continue;
                }
                std::vector<double> variable;
                for (const Observation* one : own) {
                    variable.push_back(one->at[channel]);
                }
                const SplineBasis splines(variable, channel == Channel::time ? time_columns : repeats ? 4 : 6);
                std::vector<double> out(splines.columns());
                const std::size_t first = design.columns;
                design.columns += 2 * splines.columns();
                design.values.resize(design.columns * n);
                for (std::size_t i = 0; i < n; ++i) {
                    splines.evaluate(variable[i], out.data());
                    for (std::size_t k = 0; k < out.size(); ++k) {
                        design.at(i, first + k) = out[k];
                        design.at(i, first + out.size() + k) = out[k] * force[i];
                    }
                }
            }
            return design;
        };
        const std::vector<double> raw = y;
        DesignMatrix basis;
        std::size_t lost = 1;
        double rest = 0;
        double degrees = 0;
        const auto fit_out = [&](std::size_t time_columns) {
            DesignMatrix design = design_of(time_columns);
            y = raw;
            lost = repeats ? take_means_off(set_point, design, y) : 1;
            basis = orthonormal(design);
            rest = -explained_square(basis, y);
            for (const double value : y) {
                rest += value * value;
            }
            degrees = static_cast<double>(n) - static_cast<double>(lost + basis.columns);
        };
        fit_out(repeats ? 4 : 6);
        if (repeats && n >= 120) {
            // several waves in a day of measuring are no noise; colour alone does not make the difference that is asked for here
            const double few_rest = rest;
            const double few_degrees = degrees;
            fit_out(14);
            const double columns = few_degrees - degrees;
            const bool waves = columns > 0 && degrees > 20 && f_tail((few_rest - rest) / columns / std::max(rest / degrees, 1e-300), columns, degrees) < 1e-6;
            if (!waves) {
                fit_out(4);
            }
        }
        NoiseFigure figure;
        figure.unit = core::find_quantity(quantities_[q])->unit;
        figure.declared = std::sqrt(declared_square / static_cast<double>(n));
        if (degrees >= 6) {
            figure.estimated = std::sqrt(std::max(rest, 0.0) / degrees);
        }
        const double ratio = figure.declared > 0 && figure.estimated > 0 ? figure.estimated / figure.declared : 1;
        const double spread = degrees > 0 ? 1 / std::sqrt(2 * degrees) : 1;
        const bool wrong = std::abs(std::log(ratio)) > std::max(0.15, 3.5 * spread);
        if (figure.declared > 0 && !wrong) {
            figure.value = figure.declared;
            figure.from = "declared";
        } else if (figure.estimated > 0) {
            figure.value = figure.estimated;
            figure.from = figure.declared > 0 ? "estimated: the declared figure is wrong by a factor of " + core::format_number(ratio, 3)
                                              : "estimated";
            if (figure.declared > 0) {
                problems_.push_back({core::Problem::Severity::warning,
                                     "the declared noise of " + quantities_[q] + " (" + core::format_number(figure.declared, 3) + " " +
                                         figure.unit + ") disagrees with the scatter of the data (" +
                                         core::format_number(figure.estimated, 3) + " " + figure.unit + "): the scatter is used",
                                     {}});
            }
        } else {
            figure.value = std::max(root_mean_square(y), 1e-12);
            figure.from = "estimated";
        }
        noise_[quantities_[q]] = figure;
    }
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

bool StaticExperiment::find_colour(const std::vector<std::size_t>& chosen, const std::vector<double>& residuals) {
    constexpr std::size_t order = 4;
    colour_.assign(quantities_.size(), {});
    bool found = false;
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
        std::vector<double> own;
        for (std::size_t i = 0; i < chosen.size(); ++i) {
            if (observations_[chosen[i]].quantity == q) {
                own.push_back(residuals[i]);
            }
        }
        if (own.size() < 40) {
            continue;
        }
        const double n = static_cast<double>(own.size());
        double portmanteau = 0;
        Eigen::VectorXd r(order);
        for (std::size_t k = 1; k <= 6; ++k) {
            const double rho = autocorrelation(own, k);
            portmanteau += n * (n + 2) * rho * rho / (n - static_cast<double>(k));
            if (k <= order) {
                r(static_cast<Eigen::Index>(k) - 1) = rho;
            }
        }
        if (chi_squared_tail(portmanteau, 6) > 0.003) {
            continue;
        }
        Eigen::MatrixXd toeplitz(order, order);
        for (Eigen::Index i = 0; i < toeplitz.rows(); ++i) {
            for (Eigen::Index j = 0; j < toeplitz.cols(); ++j) {
                toeplitz(i, j) = i == j ? 1.0 : r(std::abs(i - j) - 1);
            }
        }
        const Eigen::VectorXd a = toeplitz.ldlt().solve(r);
        const double share = 1 - a.dot(r);
        if (share > 0.02 && share < 1) {
            colour_[q].assign(a.data(), a.data() + order);
            colour_[q].push_back(std::sqrt(share));
            found = true;
        }
    }
    return found;
}

std::vector<double> StaticExperiment::drawn_noise(std::uint64_t seed) const {
    core::Random random(seed);
    std::vector<double> noise(observations_.size());
    std::vector<std::vector<double>> past(quantities_.size());
    for (std::size_t i = 0; i < observations_.size(); ++i) {
        const std::size_t q = observations_[i].quantity;
        const std::vector<double>* colour = colour_.empty() || colour_[q].empty() ? nullptr : &colour_[q];
        double value = random.normal() * (colour != nullptr ? colour->back() : 1);
        for (std::size_t k = 1; colour != nullptr && k < colour->size() && k <= past[q].size(); ++k) {
            value += (*colour)[k - 1] * past[q][past[q].size() - k];
        }
        past[q].push_back(value);
        noise[i] = value * sigma(observations_[i]);
    }
    return noise;
}

void StaticExperiment::whiten(const std::vector<std::size_t>& chosen, double* values) const {
    if (colour_.empty()) {
        return;
    }
    for (std::size_t i = chosen.size(); i-- > 0;) {
        const Observation& one = observations_[chosen[i]];
        const std::vector<double>& colour = colour_[one.quantity];
        if (colour.empty() || i + 1 < colour.size()) {
            continue;
        }
        double value = values[i];
        bool same = true;
        for (std::size_t k = 1; k < colour.size(); ++k) {
            const Observation& before = observations_[chosen[i - k]];
            same = same && before.quantity == one.quantity && before.run == one.run;
            value -= colour[k - 1] * values[i - k];
        }
        if (same) {
            values[i] = value / colour.back();
        }
    }
}

FittedHypothesis StaticExperiment::fit(const Hypothesis& hypothesis, const std::vector<std::size_t>& chosen) const {
    FittedHypothesis best;
    best.hypothesis = hypothesis;
    const WhitenedResiduals evaluate = [&](std::span<const double> p, std::vector<double>& r) {
        residuals(chosen, hypothesis.with(p), r);
        return 0.0;
    };
    std::vector<std::vector<double>> starts = hypothesis.starts;
    if (starts.empty()) {
        starts.emplace_back();
        for (const FitParameter& parameter : hypothesis.parameters) {
            starts.back().push_back(parameter.start);
        }
    }
    bool first = true;
    for (const std::vector<double>& start : starts) {
        std::vector<FitParameter> parameters = hypothesis.parameters;
        for (std::size_t j = 0; j < parameters.size(); ++j) {
            parameters[j].start = start[j];
        }
        Fit fit = least_squares(parameters, evaluate);
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
