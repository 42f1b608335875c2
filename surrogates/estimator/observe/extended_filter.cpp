#include "surrogates/estimator/observe/extended_filter.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "surrogates/dynamics/simulate/start_state.h"

namespace underbody::estimator {

using Belief = ExtendedRunner::Belief;

void check_run(const RunSignals& run) {
    const std::size_t n = run.time.size();
    if (run.gap.size() != n || (!run.velocity.empty() && run.velocity.size() != n) ||
        (!run.input.empty() && run.input.size() != n)) {
        throw core::InputError("shape", "the signals of a run differ in length");
    }
    if (std::count_if(run.gap.begin(), run.gap.end(), [](double v) { return std::isfinite(v); }) < 3) {
        throw core::InputError("few", "a run needs at least three measured gaps");
    }
    for (std::size_t i = 1; i < n; ++i) {
        if (!(run.time[i] > run.time[i - 1])) {
            throw core::InputError("range", "time does not ascend at sample " + std::to_string(i + 1));
        }
    }
    for (const double u : run.input) {
        if (!std::isfinite(u)) {
            throw core::InputError("range", "the input has a missing value: interpolate it or cut the run there");
        }
    }
}

ExtendedRunner::Belief start_of_run(const ExtendedRunner& runner, const RunSignals& run, const FilterNoise& noise) {
    const dynamics::StartState start = dynamics::start_state(run.time, run.gap, 0, run.time.size() - 1);
    ExtendedRunner::Belief b;
    b.x = {start.gap, start.velocity, 0};
    const double sh2 = noise.gap * noise.gap, sw2 = start.slope_factor > 0 ? start.slope_factor * sh2 : 1;
    b.p = {4 * sh2, 0, 0, 0, 4 * sw2 + 1e-4, 0, 0, 0, runner.departure_sigma() * runner.departure_sigma()};
    return b;
}

RunSignals through_actuator(const SeparatedPlant& plant, RunSignals run) {
    if (!run.input.empty() && !plant.actuator.ideal()) {
        std::vector<double> mean;
        plant.actuator.mean_over_steps(run.time, run.input, run.held, run.time, mean);
        std::copy(mean.begin() + 1, mean.end(), run.input.begin());
        run.input.back() = mean.back();
        run.held = true;
    }
    return run;
}

double input_over(const RunSignals& run, std::size_t k) {  // mean over the step that ends at sample k
    if (run.input.empty()) {
        return 0;
    }
    return run.held ? run.input[k - 1] : 0.5 * (run.input[k - 1] + run.input[k]);
}

namespace {

using Square = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using ConstSquare = Eigen::Map<const Square>;

void smooth_back(const ExtendedRunner& filter, const std::vector<Belief>& filtered,
                 const std::vector<Belief>& predicted, const std::vector<std::array<double, 9>>& transitions,
                 std::vector<FilterEstimate>& estimates) {
    Belief next = filtered.back();
    for (std::size_t k = filtered.size() - 1; k-- > 0;) {
        const ConstSquare own(filtered[k].p.data()), ahead(predicted[k + 1].p.data()), later(next.p.data());
        const Square gain = own * ConstSquare(transitions[k + 1].data()).transpose() * ahead.inverse();
        Belief b = filtered[k];
        const Eigen::Vector3d moved = gain * (Eigen::Map<const Eigen::Vector3d>(next.x.data()) -
                                              Eigen::Map<const Eigen::Vector3d>(predicted[k + 1].x.data()));
        Eigen::Map<Eigen::Vector3d>(b.x.data()) += moved;
        Eigen::Map<Square>(b.p.data()) += gain * (later - ahead) * gain.transpose();
        filter.describe(b, estimates[k]);
        next = b;
    }
}

}  // namespace

FilterResult extended_filter(const SeparatedPlant& plant, const RunSignals& run, const FilterNoise& noise,
                             bool smooth) {
    check_run(run);
    ExtendedRunner runner(plant, noise);
    runner.start(start_of_run(runner, run, noise));
    const std::size_t n = run.time.size();
    FilterResult result;
    result.estimates.resize(n);
    std::vector<Belief> filtered, predicted;
    std::vector<std::array<double, 9>> transitions;
    double last = NAN, squares = 0, neighbours = 0;
    for (std::size_t k = 0; k < n; ++k) {
        FilterEstimate& e = result.estimates[k];
        if (k > 0) {
            runner.predict(run.time[k] - run.time[k - 1], input_over(run, k), run.time[k - 1]);
        }
        const double likelihood = runner.measure(run.gap[k], run.velocity.empty() ? NAN : run.velocity[k], e);
        result.outliers += e.outlier ? 1U : 0U;
        result.missing += std::isnan(e.innovation) ? 1U : 0U;
        const double normal = e.outlier ? NAN : e.innovation / e.innovation_sigma;
        if (k > 10 && std::isfinite(normal)) {  // the start value came from the same data
            result.log_likelihood += likelihood;
            squares += normal * normal;
            neighbours += std::isfinite(last) ? normal * last : 0;
            ++result.used;
        }
        last = normal;
        if (smooth) {
            filtered.push_back(runner.belief());
            predicted.push_back(runner.predicted());
            transitions.push_back(runner.transition());
        }
    }
    if (result.used > 0) {
        result.mean_squared_innovation = squares / static_cast<double>(result.used);
        result.innovation_correlation = squares > 0 ? neighbours / squares : 0;
    }
    if (smooth && n > 1) {
        smooth_back(runner, filtered, predicted, transitions, result.estimates);
    }
    return result;
}

double likely_force_density(const std::vector<PlantRun>& runs, FilterNoise noise) {
    const auto score = [&](double exponent) {
        noise.force_density = std::pow(10.0, exponent);
        double sum = 0;
        for (const auto& run : runs) {
            sum += extended_filter(*run.plant, *run.signals, noise).log_likelihood;
        }
        return sum;
    };
    double best = -7, highest = -INFINITY;
    for (double e = -12; e <= -2; e += 1) {
        const double s = score(e);
        if (s > highest) {
            highest = s;
            best = e;
        }
    }
    const double middle = best;
    for (const double step : {-0.66, -0.33, 0.33, 0.66}) {
        const double s = score(middle + step);
        if (s > highest) {
            highest = s;
            best = middle + step;
        }
    }
    return std::pow(10.0, best);
}

}  // namespace underbody::estimator
