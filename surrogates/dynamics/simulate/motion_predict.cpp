#include "surrogates/dynamics/simulate/motion_predict.h"

#include <algorithm>
#include <cmath>

#include "core/counted.h"
#include "core/parallel.h"
#include "core/text.h"
#include "surrogates/dynamics/simulate/horizon.h"
#include "surrogates/dynamics/simulate/input_as_logged.h"

namespace underbody::dynamics {

std::array<double, most_states> motion_noise(const MotionShape& shape, const Measurements& data,
                                             const MeasuredRun& run) {
    std::array<double, most_states> noise{};
    for (std::size_t i = 0; i < shape.states.size(); ++i) {
        noise[i] = channel_noise(data, run, shape.states[i].channel, shape.states[i].noise);
    }
    return noise;
}

std::vector<MotionRunPrediction> predict_motion_runs(const Motion& motion, const Model& model, const Measurements& data,
                                                     const PredictOptions& options, core::Progress& progress) {
    std::vector<MotionRunPrediction> all(data.runs.size());
    const double past = time_before(options);
    core::parallel_for(
        data.runs.size(),
        [&](std::size_t r) {
            all[r].run = motion.run(model, data.runs[r], model.records);
            all[r].run->set_noise(motion_noise(motion.shape(), data, data.runs[r]));
            all[r].not_used = all[r].run->clean_readings(data.runs[r].name, model);
            all[r].windows = predict_windows(*all[r].run, options.horizon, past);
        },
        progress);
    return all;
}

namespace {

/// Windows whose places leave every bound; throws for what is no number.
void check_motion(const std::vector<MotionRunPrediction>& all, const Model& model, const Measurements& data,
                  Prediction& out) {
    for (std::size_t r = 0; r < all.size(); ++r) {
        out.windows += all[r].windows.size();
        const MotionShape& shape = all[r].run->shape();
        for (const MotionWindow& window : all[r].windows) {
            bool away = window.lost;
            for (std::size_t k = window.start; k <= window.end; ++k) {
                const MotionState& y = window.at(k);
                if (!std::all_of(y.begin(), y.end(), [](double v) { return std::isfinite(v); })) {
                    throw core::InputError("integration",
                                           "the predicted motion of run " + data.runs[r].name + " is not finite at " +
                                               core::format_number(all[r].run->time()[k], 6) + " s",
                                           {model.name, {}, {}, {}},
                                           "look at the effects and tables of the model there" +
                                               (all[r].not_used.empty() ? "" : "; " + all[r].not_used.front()));
                }
                for (std::size_t i = 0; i < shape.states.size(); ++i) {
                    away = away || std::abs(y[i]) > shape.states[i].far;
                }
            }
            out.diverged += away ? 1 : 0;
        }
        for (const std::string& text : all[r].not_used) {
            out.remarks.push_back({core::Problem::Severity::warning, text, {data.runs[r].table.source, {}, {}, {}}});
        }
        if (all[r].windows.empty()) {
            out.remarks.push_back(
                {core::Problem::Severity::warning,
                 "run " + data.runs[r].name + " is shorter than the time a prediction needs and was left out",
                 {}});
        }
    }
    if (out.diverged > 0) {
        out.remarks.push_back({core::Problem::Severity::warning,
                               core::counted_of(out.diverged, out.windows, "predicted window", "runs", "run") +
                                   " away from every bound: the error says that the model is "
                                   "wrong there, not by how much",
                               {}});
    }
}

/// All readings less predictions, in noise: state by state, one window after the other.
std::vector<double> errors_of(const std::vector<MotionRunPrediction>& all, std::size_t states) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < states; ++i) {
        for (const MotionRunPrediction& one : all) {
            const MotionReadings& read = one.run->readings();
            for (const MotionWindow& window : one.windows) {
                for (std::size_t k = window.start; !read.value[i].empty() && k <= window.end; ++k) {
                    if (std::isfinite(read.value[i][k]) && read.noise[i] > 0) {
                        errors.push_back((one.run->reading(k, i, window.at(k)) - read.value[i][k]) / read.noise[i]);
                    }
                }
            }
        }
    }
    return errors;
}

/// Inputs held or linear between samples: as the model says, else what the measured motion fits.
std::vector<MotionRunPrediction> predict_as_read(const Motion& motion, const Model& model, const Measurements& data,
                                                 const PredictOptions& options, Prediction& out,
                                                 core::Progress& progress) {
    using Between = RecordReading::Between;
    out.records = model.records;
    const bool driven = std::any_of(data.runs.begin(), data.runs.end(),
                                    [&](const MeasuredRun& run) { return motion.driven(model, run); });
    const Between declared = model.records.input_between;
    out.input_between = !driven ? "" : declared == Between::linear ? "linear" : "held";
    out.input_between_from = !driven ? "" : declared == Between::unsaid ? "data" : "declared";
    std::vector<MotionRunPrediction> all = predict_motion_runs(motion, model, data, options, progress);
    if (!driven || declared != Between::unsaid) {
        return all;
    }
    Model other = model;
    other.records.input_between = Between::linear;
    std::vector<MotionRunPrediction> linear = predict_motion_runs(motion, other, data, options, progress);
    const std::size_t states = motion.shape().states.size();
    if (between_by_errors(errors_of(all, states), errors_of(linear, states)) == Between::linear) {
        out.records = other.records;
        out.input_between = "linear";
        return linear;
    }
    out.records.input_between = Between::held;
    return all;
}

}  // namespace

Prediction predict_motion_series(const Motion& motion, const Model& model, const Measurements& data,
                                 const PredictOptions& options, core::Progress& progress) {
    const std::vector<MotionShape::State>& states = motion.shape().states;
    Prediction out;
    out.time_series = true;
    out.motion = motion.shape().name;
    out.horizon = options.horizon;
    const std::vector<MotionRunPrediction> all = predict_as_read(motion, model, data, options, out, progress);
    check_motion(all, model, data, out);
    if (out.windows == 0) {
        return predict_shorter(data, options, [&](const PredictOptions& shorter) {
            return predict_motion_series(motion, model, data, shorter, progress);
        });
    }
    remark_long_horizon(data, options, out);
    const auto doubt = doubtful_input(data, motion.inputs(model), out.records, [&](const RecordReading& records) {
        Model read = model;
        read.records = records;
        return errors_of(predict_motion_runs(motion, read, data, options, progress), states.size());
    });
    if (doubt) {
        out.remarks.push_back(*doubt);
    }
    std::vector<std::string> names;
    std::vector<double> number, time;
    std::vector<std::vector<double>> measured(states.size()), predicted(states.size());
    std::vector<ChannelScore> scores(states.size());
    std::vector<bool> shown(states.size(), false);
    for (std::size_t r = 0; r < all.size(); ++r) {
        const MotionReadings& readings = all[r].run->readings();
        for (std::size_t i = 0; i < states.size(); ++i) {
            if (!readings.value[i].empty()) {
                shown[i] = true;
                scores[i].noises.push_back(readings.noise[i]);
            }
        }
        for (std::size_t w = 0; w < all[r].windows.size(); ++w) {
            const MotionWindow& window = all[r].windows[w];
            for (std::size_t k = window.start; k <= window.end; ++k) {
                names.push_back(data.runs[r].name);
                number.push_back(static_cast<double>(w));
                time.push_back(all[r].run->time()[k] + data.runs[r].clock_offset);
                for (std::size_t i = 0; i < states.size(); ++i) {
                    measured[i].push_back(readings.value[i].empty() ? std::nan("") : readings.value[i][k]);
                    predicted[i].push_back(all[r].run->reading(k, i, window.at(k)));
                    scores[i].take(predicted[i].back() - measured[i].back());
                }
            }
        }
    }
    out.table.add_text("run", names);
    out.table.add_numbers("window", "1", number);
    out.table.add_numbers("time", "s", time);
    for (std::size_t i = 0; i < states.size(); ++i) {
        if (shown[i]) {
            const std::string &name = states[i].channel, &unit = states[i].unit;
            out.table.add_numbers(name, unit, measured[i]);
            out.table.add_numbers(name + "_predicted", unit, predicted[i]);
            out.channels.push_back(error_of(name, unit, scores[i], data));
        }
    }
    return out;
}

}  // namespace underbody::dynamics
