#include "surrogates/discovery/heave/heave_error.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "surrogates/discovery/consequence.h"
#include "surrogates/discovery/correction_table.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/simulate/predict.h"

namespace underbody::discovery {

PredictedWindows predicted_windows(const dynamics::Model& model, const dynamics::Measurements& data, double horizon,
                                   const std::string& channel, core::Progress& progress) {
    PredictedWindows out;
    dynamics::PredictOptions options;
    options.horizon = horizon;
    dynamics::Prediction prediction;
    try {
        prediction = dynamics::predict(model, data, options, progress);
    } catch (const core::InputError&) {
        return out;  // no run is long enough, or the motion has no end: there is no error over this horizon
    }
    out.horizon = prediction.horizon;
    const std::vector<std::string>& run = prediction.table.text("run");
    const std::vector<double>& window = prediction.table.numbers("window");
    const std::vector<double>& read = prediction.table.numbers(channel);
    const std::vector<double>& predicted = prediction.table.numbers(channel + "_predicted");
    WindowSquares& to = out.windows;
    for (std::size_t i = 0; i < run.size(); ++i) {
        const bool next_run = i > 0 && (run[i] != run[i - 1] || window[i] < window[i - 1]);
        if (i == 0 || next_run || window[i] != window[i - 1]) {
            to.record.push_back(i == 0 ? 0 : to.record.back() + (next_run ? 1 : 0));
            to.square.push_back(0);
            to.count.push_back(0);
        }
        const double error = read[i] - predicted[i];
        if (std::isfinite(error)) {
            to.square.back() += error * error;
            to.count.back() += 1;
            to.errors.push_back(error);
        }
    }
    return out;
}

WindowSquares window_errors(const HeaveExperiment& experiment, const std::vector<dynamics::EffectUse>& uses,
                            const HeaveNoise& fitted_noise, double horizon) {
    // a filter that takes its model for perfect would carry the model's error into the state that a window starts from
    HeaveNoise noise = fitted_noise;
    noise.process = std::max(noise.process, 1e-9);
    const double reading_noise = experiment.noise().gap;  // the same for whatever is compared
    const std::vector<std::size_t>& chosen = experiment.chosen();
    WindowSquares windows;
    std::vector<double> innovations, states, memories, input, predicted;
    // `unknown` comes as a table: the smooth force it was made from is gone by then, so the table itself is used
    for (std::size_t c = 0; c < chosen.size(); ++c) {
        const HeaveRecord& record = experiment.records().records[chosen[c]];
        const HeaveExplanation explanation = experiment.explanation(chosen[c], uses);
        innovations.clear();
        states.clear();
        memories.clear();
        filter_innovations(record, explanation, noise, innovations, &states, &memories);
        transform_input(record, explanation, input);
        const std::size_t n = record.time.size();
        std::size_t first = 0;
        // a second for the filter to find the state, less in runs of less than five
        const double lasted = record.time.back() - record.time.front();
        while (first < n && record.time[first] - record.time.front() < std::min(1.0, 0.2 * lasted)) {
            ++first;
        }
        while (first + 2 < n) {
            std::size_t last = first;
            while (last + 1 < n && record.time[last + 1] - record.time[first] <= horizon) {
                ++last;
            }
            if (last < first + 2) {
                break;
            }
            free_run(record, explanation, input, first, last, states[2 * first], states[2 * first + 1], predicted,
                     memories.data() + first * dynamics::history_states);
            windows.record.push_back(c);
            windows.square.push_back(0);
            windows.count.push_back(0);
            for (std::size_t k = first + 1; k <= last; ++k) {
                if (std::isfinite(record.gap[k])) {
                    // the average of m readings carries 1/m of their variance: the rest is put back, so that the figure
                    // is one of readings
                    const double share = record.gap_share[k] * record.gap_share[k];
                    const double difference = record.gap[k] - predicted[k - first];
                    windows.square.back() += difference * difference + (1 - share) * reading_noise * reading_noise;
                    windows.count.back() += 1;
                    windows.errors.push_back(difference);
                }
            }
            first = last;
        }
    }
    return windows;
}

BlockSquares WindowSquares::by_record(std::size_t records) const {
    BlockSquares sums{std::vector<double>(records, 0), std::vector<double>(records, 0)};
    for (std::size_t w = 0; w < record.size(); ++w) {
        sums.square[record[w]] += square[w];
        sums.count[record[w]] += count[w];
    }
    return sums;
}

BlockSquares WindowSquares::blocks(std::size_t records, std::size_t wanted) const {
    BlockSquares sums;
    const std::size_t each = std::max<std::size_t>(1, (wanted + records - 1) / std::max<std::size_t>(records, 1));
    for (std::size_t begin = 0; begin < record.size();) {
        std::size_t end = begin;
        while (end < record.size() && record[end] == record[begin]) {
            ++end;
        }
        const std::size_t parts = std::min(each, end - begin);
        for (std::size_t p = 0; p < parts; ++p) {
            sums.square.push_back(0);
            sums.count.push_back(0);
            for (std::size_t w = begin + (end - begin) * p / parts; w < begin + (end - begin) * (p + 1) / parts; ++w) {
                sums.square.back() += square[w];
                sums.count.back() += count[w];
            }
        }
        begin = end;
    }
    sums.errors = errors;
    return sums;
}

double estimator_error(const HeaveExperiment& experiment, const std::vector<dynamics::EffectUse>& uses,
                       const HeaveNoise& noise, const std::vector<dynamics::EffectUse>& better,
                       const HeaveNoise& better_noise) {
    std::vector<double> innovations, states;
    double sum = 0;
    double count = 0;
    for (const std::size_t r : experiment.chosen()) {
        const HeaveRecord& record = experiment.records().records[r];
        innovations.clear();
        states.clear();
        filter_innovations(record, experiment.explanation(r, uses), noise, innovations, &states);
        const SmoothedRun reference = smooth_with_force(record, experiment.explanation(r, better), better_noise,
                                                        usual_force_walk * record.plant->terms.mass);
        for (std::size_t k = 0; k < record.time.size(); ++k) {
            if (record.time[k] - record.time.front() >
                std::min(2.0, 0.4 * (record.time.back() - record.time.front()))) {
                const double difference = states[2 * k + 1] - reference.velocity[k];
                sum += difference * difference;
                count += 1;
            }
        }
    }
    return count > 0 ? std::sqrt(sum / count) : 0;
}

dynamics::EffectUse force_table(const FlexibleForce& force, double largest) {
    std::vector<std::string> names;
    for (const FlexibleForce::Variable variable : force.variables) {
        names.emplace_back(variable_name(variable));
    }
    return correction_table(
        names, force.lower, force.upper,
        [&](const double* along) {
            double point[4] = {0, 0, 0, 0};
            for (std::size_t v = 0; v < force.variables.size(); ++v) {
                point[static_cast<std::size_t>(force.variables[v])] = along[v];
            }
            return force(point[0], point[1], point[2], point[3]);
        },
        largest);
}

Consequence heave_consequence(const dynamics::Model& before, const dynamics::Model& after, const HeaveRecords& records,
                              core::Progress& progress) {
    Consequence result;
    const dynamics::Conditions held = records.records.front().plant->held();
    map_if_possible(result, [&] {
        const auto balances = [&](const dynamics::Model& model) {
            std::vector<Balance> list;
            for (const dynamics::HeaveEquilibrium& one :
                 dynamics::heave_equilibria(dynamics::HeavePlant(model, held))) {
                list.push_back({one.name, one.stable, one.gap});
            }
            return list;
        };
        result.equilibria = paired(balances(before), balances(after));
        double low = 1e300, high = -1e300;
        for (const HeaveRecord& record : records.records) {
            for (const double gap : record.gap) {
                if (std::isfinite(gap)) {
                    low = std::min(low, gap);
                    high = std::max(high, gap);
                }
            }
        }
        low = std::max(low, 1e-3);
        high = std::max(high, 2e-3);
        compare_regions(before, after, low, high, held, 40, progress, result);
        result.text = "Free motion (no input force) from starts with gaps of " + core::format_number(1000 * low, 3) +
                      " to " + core::format_number(1000 * high, 3) + " mm and velocities of -0.1 to 0.1 m/s.";
    });
    return result;
}

}  // namespace underbody::discovery
