// Smooth loads without a law: what they would do to the innovations, and the one that fits the runs as a table.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "surrogates/discovery/correction_table.h"
#include "surrogates/discovery/motion/motion_experiment.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::discovery {

namespace {

/// The variable's value in the middle of a step.
double value_of(const dynamics::MotionShape& shape, const std::string& variable, const MotionTrace& trace,
                std::size_t k) {
    for (const dynamics::MotionShape::Variable& one : shape.variables) {
        if (one.quantity == variable) {
            return trace.state[k][one.state];
        }
    }
    return static_cast<double>(k);  // time
}

/// What each variable was over all traces, one after the other.
std::vector<std::vector<double>> values_over(const dynamics::MotionShape& shape,
                                             const std::vector<std::string>& variables,
                                             const std::vector<MotionTrace>& traces) {
    std::vector<std::vector<double>> values(variables.size());
    for (std::size_t v = 0; v < values.size(); ++v) {
        for (const MotionTrace& trace : traces) {
            for (std::size_t k = 0; k < trace.state.size(); ++k) {
                values[v].push_back(value_of(shape, variables[v], trace, k));
            }
        }
    }
    return values;
}

/// Columns of the basis at each sample: columns[column][sample].
std::vector<std::vector<double>> loads_of(const FlexibleBasis& basis, const std::vector<std::vector<double>>& values,
                                          std::size_t samples) {
    std::vector<std::vector<double>> loads(basis.columns());
    std::vector<double> point(values.size()), out(basis.columns());
    for (std::size_t k = 0; k < samples; ++k) {
        for (std::size_t v = 0; v < values.size(); ++v) {
            point[v] = values[v][k];
        }
        basis.evaluate(point.data(), out.data());
        for (std::size_t c = 0; c < out.size(); ++c) {
            loads[c].push_back(out[c]);
        }
    }
    return loads;
}

std::size_t samples_of(const std::vector<MotionTrace>& traces) {
    return std::accumulate(traces.begin(), traces.end(), std::size_t{0},
                           [](std::size_t sum, const MotionTrace& trace) { return sum + trace.state.size(); });
}

/// Sum of coefficients times columns at each sample.
std::vector<double> combined(const std::vector<std::vector<double>>& loads, const std::vector<double>& coefficients) {
    std::vector<double> sum(loads.front().size(), 0);
    for (std::size_t c = 0; c < loads.size(); ++c) {
        for (std::size_t k = 0; k < sum.size(); ++k) {
            sum[k] += coefficients[c] * loads[c][k];
        }
    }
    return sum;
}

}  // namespace

DesignMatrix MotionExperiment::answers(std::size_t axis, const std::vector<std::vector<double>>& loads,
                                       const std::vector<MotionTrace>& traces) const {
    DesignMatrix matrix;
    matrix.rows = begins().back();
    matrix.columns = loads.size();
    for (const std::vector<double>& load : loads) {
        auto from = load.begin();
        for (std::size_t r = 0; r < traces.size(); ++r) {
            const auto to = from + static_cast<std::ptrdiff_t>(traces[r].state.size());
            linear_answer(shape(), traces[r], records_[r], axis, {from, to}, matrix.values);
            from = to;
        }
    }
    return matrix;
}

DesignMatrix MotionExperiment::answers(const MotionSmooth& smooth, const std::vector<MotionTrace>& traces) const {
    const std::vector<std::vector<double>> values = values_over(shape(), smooth.variables, traces);
    const FlexibleBasis basis(values, smooth.columns);
    return answers(smooth.axis, loads_of(basis, values, samples_of(traces)), traces);
}

std::vector<SampledRun> MotionExperiment::sampled() const {
    std::vector<SampledRun> runs;
    const std::vector<std::size_t> begin = begins();
    for (std::size_t r = 0; r < records_.size(); ++r) {
        const MotionRecord& record = records_[r];
        const std::vector<double>& time = data_.runs[record.run].table.numbers("time");
        const std::vector<double> own(time.begin() + static_cast<std::ptrdiff_t>(record.first),
                                      time.begin() + static_cast<std::ptrdiff_t>(record.last + 1));
        runs.push_back({own, (begin[r + 1] - begin[r]) / own.size(), begin[r]});
    }
    return runs;
}

std::vector<std::vector<double>> MotionExperiment::periodic_starts(const MotionNoise& noise, std::size_t count) const {
    const std::vector<dynamics::MotionShape::Load>& loads = shape().loads;
    const auto lift =
        std::find_if(loads.begin(), loads.end(), [](const auto& load) { return load.quantity == "lift_force"; });
    if (lift == loads.end()) {
        return {};
    }
    std::vector<double> innovations;
    std::vector<MotionTrace> traces;
    evaluate({}, noise, innovations, nullptr, &traces);
    const std::vector<SampledRun> runs = sampled();
    return wave_starts(
        runs, innovations,
        [&](double frequency) {
            std::vector<std::vector<double>> waves(2);  // what they take from the innovations
            for (const SampledRun& run : runs) {
                for (std::size_t k = 0; k < run.time.size(); ++k) {
                    const double middle = k + 1 < run.time.size() ? 0.5 * (run.time[k] + run.time[k + 1]) : run.time[k],
                                 angle = 2 * std::numbers::pi * frequency * middle;
                    waves[0].push_back(-std::sin(angle));
                    waves[1].push_back(-std::cos(angle));
                }
            }
            const DesignMatrix both = answers(static_cast<std::size_t>(lift - loads.begin()), waves, traces);
            const auto half = both.values.begin() + static_cast<std::ptrdiff_t>(both.rows);
            return wave_line(frequency, {both.values.begin(), half}, {half, both.values.end()}, innovations);
        },
        count);
}

MotionExperiment::SmoothForce MotionExperiment::fit_smooth(const MotionSmooth& smooth, const MotionNoise& begin,
                                                           double reach) const {
    constexpr int rounds = 6;
    constexpr double no_more = 2;   // -2 log likelihood: a round that gains less is the last
    constexpr double seen = 0.001;  // beyond these quantiles a variable counts as not seen
    std::vector<double> innovations;
    std::vector<MotionTrace> traces;
    SmoothForce best;
    best.noise = begin;
    best.cost = evaluate({}, begin, innovations, nullptr, &traces);
    std::vector<std::vector<double>> values = values_over(shape(), smooth.variables, traces);
    const FlexibleBasis basis(values, smooth.columns);
    std::vector<double> lower, upper, coefficients(basis.columns(), 0);
    for (const std::vector<double>& one : values) {
        lower.push_back(quantile(one, seen));
        upper.push_back(quantile(one, 1 - seen));
    }
    for (int round = 0; round < rounds; ++round) {
        // Gauss and Newton about the path that the filter took with the last table, the ridge by cross-validation
        const std::vector<std::vector<double>> loads = loads_of(basis, values, samples_of(traces));
        const DesignMatrix matrix = answers(smooth.axis, loads, traces);
        std::vector<double> wanted(innovations.size(), 0);
        for (std::size_t c = 0; c < matrix.columns; ++c) {
            for (std::size_t i = 0; i < wanted.size(); ++i) {
                wanted[i] += matrix.values[c * matrix.rows + i] * coefficients[c];
            }
        }
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            wanted[i] -= innovations[i];
        }
        coefficients = ridge_fit(matrix, wanted).coefficients;
        std::vector<double> force = combined(loads, coefficients);
        std::transform(force.begin(), force.end(), force.begin(), [](double f) { return std::abs(f); });
        const auto value = [&](const double* point) {
            std::vector<double> out(basis.columns());
            basis.evaluate(point, out.data());
            return std::inner_product(out.begin(), out.end(), coefficients.begin(), 0.0);
        };
        SmoothForce next;
        next.use = correction_table(smooth.variables, lower, upper, value, quantile(force, reach));
        next.noise = best.noise;
        next.cost = fit_process({*next.use}, next.noise);
        if (!(next.cost < best.cost - no_more)) {
            break;
        }
        best = std::move(next);
        traces.clear();
        evaluate({*best.use}, best.noise, innovations, nullptr, &traces);
        values = values_over(shape(), smooth.variables, traces);
    }
    return best;
}

}  // namespace underbody::discovery
