#include "surrogates/dynamics/simulate/pitch_predict.h"

#include <algorithm>
#include <cmath>

#include "core/counted.h"
#include "core/parallel.h"
#include "core/text.h"
#include "surrogates/dynamics/simulate/horizon.h"

namespace underbody::dynamics {

std::array<double, pitch_states> pitch_noise(const Measurements& data, const MeasuredRun& run) {
    constexpr std::array<double, pitch_states> fallback{1e-4, 1e-3, 1e-3, 1e-2};
    std::array<double, pitch_states> noise{};
    for (std::size_t i = 0; i < pitch_states; ++i) {
        noise[i] = channel_noise(data, run, channel_name(pitch_channels[i]), fallback[i]);
    }
    return noise;
}

std::vector<PitchRunPrediction> predict_pitch_runs(const Model& model, const Measurements& data,
                                                   const PredictOptions& options, core::Progress& progress) {
    std::vector<PitchRunPrediction> all(data.runs.size());
    const double past = time_before(options);
    core::parallel_for(
        data.runs.size(),
        [&](std::size_t r) {
            all[r].run = std::make_unique<PitchRun>(model, data.runs[r], model.records);
            all[r].run->set_noise(pitch_noise(data, data.runs[r]));
            all[r].not_used = all[r].run->clean_readings(data.runs[r].name, lift_gap_range(model));
            all[r].windows = predict_windows(*all[r].run, options.horizon, past);
        },
        progress);
    return all;
}

namespace {

/// Windows whose gap or pitch leave every bound; throws for what is no number.
void check_motion(const std::vector<PitchRunPrediction>& all, const Model& model, const Measurements& data,
                  Prediction& out) {
    constexpr double far_gap = 100, far_pitch = 10;  // m, rad
    for (std::size_t r = 0; r < all.size(); ++r) {
        out.windows += all[r].windows.size();
        for (const PitchWindow& window : all[r].windows) {
            bool away = false;
            for (std::size_t k = window.start; k <= window.end; ++k) {
                const PitchState& y = window.at(k);
                if (!std::all_of(y.begin(), y.end(), [](double v) { return std::isfinite(v); })) {
                    throw core::InputError("integration",
                                           "the predicted motion of run " + data.runs[r].name + " is not finite at " +
                                               core::format_number(all[r].run->time()[k], 6) + " s",
                                           {model.name, {}, {}, {}},
                                           "look at the effects and tables of the model at that gap and pitch");
                }
                away = away || std::abs(y[0]) > far_gap || std::abs(y[2]) > far_pitch;
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

}  // namespace

Prediction predict_pitch_series(const Model& model, const Measurements& data, const PredictOptions& options,
                                core::Progress& progress) {
    Prediction out;
    out.time_series = true;
    out.motion = "heave_pitch";
    out.horizon = options.horizon;
    out.records = model.records;
    const bool linear = model.records.input_between == RecordReading::Between::linear;
    out.input_between = linear ? "linear" : "held";
    out.input_between_from = model.records.input_between == RecordReading::Between::unsaid ? "default" : "declared";
    const std::vector<PitchRunPrediction> all = predict_pitch_runs(model, data, options, progress);
    check_motion(all, model, data, out);
    if (out.windows == 0) {
        throw no_prediction(data, options);
    }
    remark_long_horizon(data, options, out);
    std::vector<std::string> names;
    std::vector<double> number, time;
    std::array<std::vector<double>, pitch_states> measured, predicted;
    std::array<ChannelScore, pitch_states> scores;
    std::array<bool, pitch_states> shown{};
    for (std::size_t r = 0; r < all.size(); ++r) {
        const PitchReadings& readings = all[r].run->readings();
        for (std::size_t i = 0; i < pitch_states; ++i) {
            if (!readings.value[i].empty()) {
                shown[i] = true;
                scores[i].noises.push_back(readings.noise[i]);
            }
        }
        for (std::size_t w = 0; w < all[r].windows.size(); ++w) {
            const PitchWindow& window = all[r].windows[w];
            for (std::size_t k = window.start; k <= window.end; ++k) {
                names.push_back(data.runs[r].name);
                number.push_back(static_cast<double>(w));
                time.push_back(all[r].run->time()[k]);
                for (std::size_t i = 0; i < pitch_states; ++i) {
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
    for (std::size_t i = 0; i < pitch_states; ++i) {
        if (shown[i]) {
            const std::string name = channel_name(pitch_channels[i]), unit = channel_unit(pitch_channels[i]);
            out.table.add_numbers(name, unit, measured[i]);
            out.table.add_numbers(name + "_predicted", unit, predicted[i]);
            out.channels.push_back(error_of(name, unit, scores[i], data));
        }
    }
    return out;
}

}  // namespace underbody::dynamics
