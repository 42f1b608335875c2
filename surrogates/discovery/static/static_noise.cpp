// Noise of static readings: from the scatter between repeats and smooth neighbours, and its colour.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/no_limit.h"
#include "core/random.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/discovery/flexible.h"
#include "surrogates/discovery/static/static_experiment.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

using dynamics::Channel;

namespace {

constexpr double waves_chance = 1e-6;  ///< of what long waves explain beside a drift: several in a day are no noise
constexpr double colour_chance =
    0.003;                             ///< of the autocorrelation seen (Ljung and Box 1978): above, the noise is white
constexpr double least_left = 0.02;    ///< share of the variance that the neighbours must leave
constexpr double least_noise = 1e-12;  ///< in the quantity's unit, of readings that do not scatter at all

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

/// The scatter of one quantity's readings that no smooth law of the varying channels explains.
class Scatter {
public:
    Scatter(const StaticExperiment& experiment, std::size_t quantity) : experiment_(experiment) {
        std::vector<std::pair<std::size_t, std::size_t>> cells;
        for (const Observation& one : experiment.observations()) {
            if (one.quantity == quantity && !one.accident) {
                own_.push_back(&one);
                force_.push_back(experiment.predict(one, {}));
                raw_.push_back(one.value - force_.back());
                set_point_.push_back(one.set_point);
                cells.emplace_back(one.set_point, one.run);
                declared_square_ += one.sigma * one.sigma;
            }
        }
        // repeats within one run where there are enough of them: runs may contradict each other
        std::map<std::pair<std::size_t, std::size_t>, std::size_t> cell_index;
        for (const auto& cell : cells) {
            cell_index.emplace(cell, cell_index.size());
        }
        const std::size_t n = own_.size();
        if (n >= cell_index.size() + 20) {
            for (std::size_t i = 0; i < n; ++i) {
                set_point_[i] = cell_index.at(cells[i]);
            }
        }
        repeats_ = n >= std::set<std::size_t>(set_point_.begin(), set_point_.end()).size() + 20;
        fit_out(repeats_ ? 4 : 6);
        if (repeats_ && n >= 120) {
            // several waves in a day of measuring are no noise; colour alone does not make the difference that is asked
            // for here
            const double few_rest = rest_;
            const double few_degrees = degrees_;
            fit_out(14);
            const double columns = few_degrees - degrees_;
            const bool waves = columns > 0 && degrees_ > 20 &&
                               f_tail((few_rest - rest_) / columns / core::never_zero(rest_ / degrees_), columns,
                                      degrees_) < waves_chance;
            if (!waves) {
                fit_out(4);
            }
        }
    }

    [[nodiscard]] double declared() const { return std::sqrt(declared_square_ / static_cast<double>(own_.size())); }
    /// 0: could not be had.
    [[nodiscard]] double estimated() const { return degrees_ >= 6 ? std::sqrt(std::max(rest_, 0.0) / degrees_) : 0; }
    /// Relative error of estimated().
    [[nodiscard]] double spread() const { return degrees_ > 0 ? 1 / std::sqrt(2 * degrees_) : 1; }
    /// True where it is the scatter of repeats; else of what smooth laws leave, which a law without that form inflates.
    [[nodiscard]] bool of_repeats() const { return repeats_; }
    [[nodiscard]] double of_all() const { return root_mean_square(left_); }

private:
    /// What may change between repeats: time, temperature, direction, each alone and in proportion to the force.
    [[nodiscard]] DesignMatrix design(std::size_t time_columns) const {
        const std::size_t n = own_.size();
        DesignMatrix design;
        design.rows = n;
        for (const Channel channel : experiment_.varying()) {
            if (repeats_ && sets_the_point(channel)) {
                continue;
            }
            std::vector<double> variable;
            for (const Observation* one : own_) {
                variable.push_back(one->at[channel]);
            }
            const SplineBasis splines(variable, channel == Channel::time ? time_columns : repeats_ ? 4 : 6);
            std::vector<double> out(splines.columns());
            const std::size_t first = design.columns;
            design.columns += 2 * splines.columns();
            design.values.resize(design.columns * n);
            for (std::size_t i = 0; i < n; ++i) {
                splines.evaluate(variable[i], out.data());
                for (std::size_t k = 0; k < out.size(); ++k) {
                    design.at(i, first + k) = out[k];
                    design.at(i, first + out.size() + k) = out[k] * force_[i];
                }
            }
        }
        return design;
    }

    void fit_out(std::size_t time_columns) {
        DesignMatrix columns = design(time_columns);
        left_ = raw_;
        const std::size_t lost = repeats_ ? take_means_off(set_point_, columns, left_) : 1;
        const DesignMatrix basis = orthonormal(columns);
        rest_ = sum_of_squares(left_) - explained_square(basis, left_);
        degrees_ = static_cast<double>(own_.size()) - static_cast<double>(lost + basis.columns);
    }

    const StaticExperiment& experiment_;
    std::vector<const Observation*> own_;
    std::vector<double> force_, raw_, left_;
    std::vector<std::size_t> set_point_;
    double declared_square_ = 0, rest_ = 0, degrees_ = 0;
    bool repeats_ = false;
};

}  // namespace

void StaticExperiment::estimate_noise(bool overrule) {
    std::erase_if(problems_,
                  [](const core::Problem& problem) { return problem.message.rfind("the declared noise of ", 0) == 0; });
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
        const Scatter scatter(*this, q);
        NoiseFigure figure;
        figure.unit = core::find_quantity(quantities_[q])->unit;
        figure.declared = scatter.declared();
        figure.estimated = scatter.estimated();
        const double ratio = figure.declared > 0 && figure.estimated > 0 ? figure.estimated / figure.declared : 1;
        const bool apart = std::abs(std::log(ratio)) > std::max(0.15, 3.5 * scatter.spread());
        const bool wrong = apart && (ratio < 1 || scatter.of_repeats() || overrule);
        figure.doubted = apart && !wrong;
        if (figure.doubted) {
            problems_.push_back({core::Problem::Severity::note,
                                 "the declared noise of " + quantities_[q] + " (" +
                                     core::format_number(figure.declared, 3) + " " + figure.unit +
                                     ") is less than what smooth laws leave (" +
                                     core::format_number(figure.estimated, 3) + " " + figure.unit +
                                     "); without repeats of set points that is no measure of noise: the declared "
                                     "figure is used",
                                 {}});
        }
        if (figure.declared > 0 && !wrong) {
            figure.value = figure.declared;
            figure.from = "declared";
        } else if (figure.estimated > 0) {
            figure.value = figure.estimated;
            figure.from = figure.declared > 0 ? "estimated: the declared figure is wrong by a factor of " +
                                                    core::format_number(ratio, 3)
                                              : "estimated";
            if (figure.declared > 0) {
                problems_.push_back(
                    {core::Problem::Severity::warning,
                     "the declared noise of " + quantities_[q] + " (" + core::format_number(figure.declared, 3) + " " +
                         figure.unit + ") disagrees with the scatter of the data (" +
                         core::format_number(figure.estimated, 3) + " " + figure.unit + "): the scatter is used",
                     {}});
            }
        } else {
            figure.value = std::max(scatter.of_all(), least_noise);
            figure.from = "estimated";
        }
        noise_[quantities_[q]] = figure;
    }
}

void StaticExperiment::mark_accidents(const std::vector<std::size_t>& observations) {
    for (const std::size_t i : observations) {
        observations_[i].accident = true;
    }
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
        if (chi_squared_tail(portmanteau, 6) > colour_chance) {
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
        if (share > least_left && share < 1) {
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

}  // namespace underbody::discovery
