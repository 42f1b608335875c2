// The model against measured runs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "core/table.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"

namespace underbody::dynamics {

struct PredictOptions {
    double horizon = 2;  ///< s, length of a prediction
    double past =
        0;  ///< s of measurements before a window's start that its state is estimated from; 0: the horizon, at most 2 s
    double max_step = 0.02;  ///< s, of the integrator
};

struct ChannelError {
    std::string name;
    std::string unit;
    double rmse = 0;
    double noise = 0;  ///< one standard deviation of the channel
    bool noise_declared = false;
    double in_noise = 0;  ///< rmse / noise; 0 when the noise is unknown
    std::size_t count = 0;
};

/// Sum of squares of one channel over all runs.
struct ChannelScore {
    double sum = 0;
    std::size_t count = 0;
    std::vector<double> noises;
    void take(double error);  ///< what is not finite does not count
};
/// Root mean square in units of the declared noise, else of the median of `score.noises`.
ChannelError error_of(const std::string& name, const std::string& unit, const ChannelScore& score,
                      const Measurements& data);
/// One standard deviation of a reading: declared, else from the scatter of the run, else the fallback.
double channel_noise(const Measurements& data, const MeasuredRun& run, const std::string& channel, double fallback);

struct Prediction {
    core::Table table;  ///< static: run, set points, measured and predicted; time series: run, window, time, gap,
                        ///< gap_predicted, ...
    std::vector<ChannelError> channels;
    bool time_series = false;
    std::string motion = "heave";           ///< of a time series: heave, heave_pitch, surface, body
    double horizon = 0;                     ///< s, of the windows: as asked for, less where no run is as long
    std::size_t windows = 0, diverged = 0;  ///< windows in all, and those that leave every bound (time series)
    std::string input_between;  ///< "held" or "linear": how the input was read between its samples; empty: none varies
    std::string input_between_from;  ///< "declared" or "data"
    RecordReading records;           ///< how the logs were read
    core::Problems remarks;
};

/// What a recorded input did between its samples: as declared; where nothing is declared, held (as a digital controller
/// does), unless the measured motion says otherwise: `held` and `linear` are -2 log likelihood of what was measured
/// with the input read so. The one rule of predictions, the estimator and discovery.
RecordReading::Between between_samples(RecordReading::Between declared, double held, double linear);

/// The same by the errors of predictions that read the input held and linear, in noise, in one order.
RecordReading::Between between_by_errors(const std::vector<double>& held, const std::vector<double>& linear);

/// How the logs of a data set are read: as the model's [records] say, and where they do not say whether input_force is
/// held or linear between its samples, by between_samples() of the predicted windows. What predict() and the estimator
/// take.
struct InputReading {
    RecordReading records;
    std::string between;  ///< "held" or "linear"; empty: no input varies
    std::string from;     ///< "declared" or "data"
};
InputReading input_reading(const Model& model, const Measurements& data, const PredictOptions& options = {},
                           core::Progress& progress = core::Progress::none());
/// What the logs say and how it is read instead, for people: "input_force times -1; ..."; empty: as logged.
std::string reading_text(const RecordReading& records);
/// For who puts a controller or an observer of a model on the rig that its logs are of: that it needs the same reading
/// of forces and gaps as the logs. Empty where logs are read as they stand.
std::string reading_on_the_rig(RecordReading records);

/// Throws core::InputError when the model lacks what the data need (a static quantity without a force source, ...);
/// a predicted motion that is not finite (kind "integration").
Prediction predict(const Model& model, const Measurements& data, const PredictOptions& options = {},
                   core::Progress& progress = core::Progress::none());

/// Measured and predicted: against time for the first windows, or one against the other for a static set.
core::Figure prediction_figure(const Prediction& prediction);
void to_json(nlohmann::json& json, const Prediction& prediction);

}  // namespace underbody::dynamics
