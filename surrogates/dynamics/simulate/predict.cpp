#include "surrogates/dynamics/simulate/predict.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>

#include "core/counted.h"
#include "core/parallel.h"
#include "core/quantile.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/dynamics/model/table_notes.h"
#include "surrogates/dynamics/model/taken_as_zero.h"
#include "surrogates/dynamics/plant/contact_gap.h"
#include "surrogates/dynamics/simulate/clean_readings.h"
#include "surrogates/dynamics/simulate/declared_noise.h"
#include "surrogates/dynamics/simulate/doubtful_clock.h"
#include "surrogates/dynamics/simulate/horizon.h"
#include "surrogates/dynamics/simulate/motion_predict.h"
#include "surrogates/dynamics/simulate/read_records.h"
#include "surrogates/dynamics/simulate/start_state.h"

namespace underbody::dynamics {

void ChannelScore::take(double error) {
    if (std::isfinite(error)) {
        sum += error * error;
        ++count;
    }
}

ChannelError error_of(const std::string& name, const std::string& unit, const ChannelScore& score,
                      const Measurements& data) {
    ChannelError error{name, unit};
    error.count = score.count;
    error.rmse = score.count ? std::sqrt(score.sum / static_cast<double>(score.count)) : 0.0;
    if (const auto declared = data.declared_noise(name)) {
        error.noise = *declared;
        error.noise_declared = true;
    } else if (!score.noises.empty()) {
        error.noise = core::median(score.noises);
    }
    error.in_noise = error.noise > 0 ? error.rmse / error.noise : 0.0;
    return error;
}

double channel_noise(const Measurements& data, const MeasuredRun& run, const std::string& channel, double fallback) {
    if (const auto declared = data.declared_noise(channel)) {
        return *declared;
    }
    if (!run.has(channel)) {
        return fallback;
    }
    const double found = sensor_noise(run.table.numbers("time"), run.values(channel));
    return found > 0 ? found : fallback;
}

namespace {

Prediction predict_static(const Model& model, const Measurements& data) {
    Prediction out;
    std::vector<std::string> quantities;
    for (const std::string& name : force_channels()) {
        const bool measured = std::any_of(data.runs.begin(), data.runs.end(),
                                          [&](const MeasuredRun& run) { return run.table.find(name); });
        const std::vector<std::string> sources = model.quantities();
        if (measured && std::find(sources.begin(), sources.end(), name) != sources.end()) {
            quantities.push_back(name);
        } else if (measured) {
            out.remarks.push_back(
                {core::Problem::Severity::warning, "the model has no force source for the measured " + name, {}});
        }
    }
    if (quantities.empty()) {
        throw core::InputError("missing", "the model has no force source for anything that was measured",
                               {model.name, {}, {}, {}},
                               "declare it: [[force]] quantity = \"lift_force\", table = ...");
    }
    std::vector<std::string> names;
    std::map<std::string, std::vector<double>> columns;
    std::vector<std::string> shown;
    for (const std::string& channel : channel_names()) {
        if (std::any_of(data.runs.begin(), data.runs.end(), [&](const MeasuredRun& run) { return run.has(channel); })) {
            shown.push_back(channel);
        }
    }
    std::map<std::string, ChannelScore> scores;
    std::vector<StaticModel> models;
    for (const std::string& quantity : quantities) {
        models.emplace_back(model, quantity);
    }
    for (const MeasuredRun& run : data.runs) {
        for (std::size_t row = 0; row < run.table.rows(); ++row) {
            const Conditions point = set_point_of(run, row);
            names.push_back(run.name);
            for (const std::string& channel : shown) {
                Channel which{};
                find_channel(channel, which);
                columns[channel].push_back(point[which]);
            }
            for (std::size_t q = 0; q < quantities.size(); ++q) {
                const core::Column* column = run.table.find(quantities[q]);
                const double measured = column ? column->numbers[row] : std::nan("");
                const double predicted = models[q](point);
                columns[quantities[q]].push_back(measured);
                columns[quantities[q] + "_predicted"].push_back(predicted);
                scores[quantities[q]].take(predicted - measured);
            }
        }
    }
    out.table.add_text("run", names);
    for (const std::string& channel : shown) {
        Channel which{};
        find_channel(channel, which);
        out.table.add_numbers(channel, channel_unit(which), columns[channel]);
    }
    for (const std::string& quantity : quantities) {
        const std::string unit = core::find_quantity(quantity)->unit;
        out.table.add_numbers(quantity, unit, columns[quantity]);
        out.table.add_numbers(quantity + "_predicted", unit, columns[quantity + "_predicted"]);
        out.channels.push_back(error_of(quantity, unit, scores[quantity], data));
    }
    return out;
}

/// One measured run against the model, window by window.
class RunPredictor {
public:
    RunPredictor(const Model& model, const RecordReading& records, const MeasuredRun& run,
                 const PredictOptions& options, double gap_noise, double velocity_noise)
        : signals_(signals_of(run, records)),
          plant_(plant_for(model, signals_)),
          run_(plant_, signals_, options.max_step),
          gap_(run.values("gap")),
          velocity_(as_read(run, "heave_velocity", records)),
          options_(options),
          gap_noise_(gap_noise),
          velocity_noise_(velocity_noise) {
        if (std::none_of(velocity_.begin(), velocity_.end(), [](double value) { return std::isfinite(value); })) {
            velocity_.clear();
        }
        const std::vector<double>& time = signals_.time;
        saturated_ = drop_saturated(time, gap_);
        const double own = sensor_noise(time, gap_);
        outliers_ = drop_outliers(gap_, std::max(own, 1e-9));
        inside_ = longest_inside(gap_, lift_gap_range(model), own);
        if (!velocity_.empty()) {
            drop_outliers(velocity_, std::max(sensor_noise(time, velocity_), 1e-9));
        }
    }

    struct Row {
        std::size_t window, sample;
        double gap, velocity;
    };

    /// Of the stretch inside the tables, or of the `whole` run.
    std::vector<Row> rows(bool whole) const {
        const std::vector<double>& time = signals_.time;
        const std::size_t first = whole ? 0 : inside_.first, last = whole ? time.size() : inside_.last;
        if (last < first + 2) {
            return {};
        }
        const std::span<const double> t(time.data(), last);
        const double past = time_before(options_);
        std::vector<Row> out;
        std::size_t window = 0;
        // Beyond this nothing is known of what acted.
        const double known = std::min(t.back(), time.back() - signals_.input_advance);
        for (double begin = t[first] + past; begin < known; begin += options_.horizon) {
            const auto at = [&t](double when) {
                return static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), when - 1e-9) - t.begin());
            };
            const std::size_t from = at(begin - past), start = at(begin);
            const double until = std::min(begin + options_.horizon, known);
            const std::size_t end = std::max<std::size_t>(std::min(at(until + 1e-6), t.size()), 1) - 1;
            if (end <= start || start <= from + 2) {
                continue;
            }
            const auto state = estimate(from, start);
            if (!state) {
                continue;
            }
            std::vector<double> gap(end - from + 1), velocity(gap.size()), reading(gap.size());
            run_.simulate(plant_, from, end, state->first, state->second, gap, velocity);
            run_.sensor(plant_, from, gap, reading);
            for (std::size_t i = start; i <= end; ++i) {
                out.push_back({window, i, reading[i - from], velocity[i - from]});
            }
            ++window;
        }
        return out;
    }

    [[nodiscard]] const std::vector<double>& time() const { return signals_.time; }
    [[nodiscard]] const InsideTables& inside() const { return inside_; }
    [[nodiscard]] std::size_t saturated() const { return saturated_; }
    [[nodiscard]] std::size_t outliers() const { return outliers_; }
    /// What is judged by: NaN where a reading is missing or not used.
    [[nodiscard]] const std::vector<double>& gap() const { return gap_; }
    [[nodiscard]] const std::vector<double>& velocity() const { return velocity_; }

private:
    /// The state at sample `from` whose motion fits the measurements from..start best (least squares in units of
    /// noise); nothing later than `start` is looked at.
    [[nodiscard]] std::optional<std::pair<double, double>> estimate(std::size_t from, std::size_t start) const {
        const StartState line = start_state(signals_.time, gap_, from, start);
        if (!line.found()) {
            return {};
        }
        std::pair<double, double> state{line.gap - plant_.terms.sensor_offset(signals_.time[start]), line.velocity};
        // A film forgets a velocity within a sample: what the motion does not show is taken from the line, loosely.
        const double loose = 0.05 + 10 * gap_noise_ * std::sqrt(line.slope_factor), weight = 1 / (loose * loose);
        const std::size_t count = start - from + 1;
        std::vector<double> base, changed;
        for (int iteration = 0; iteration < 6; ++iteration) {
            const double dh = 1e-5, dw = 1e-5;
            base = misfit(from, count, state.first, state.second);
            double a11 = 1e-12, a12 = 0, a22 = weight, b1 = 0, b2 = weight * (line.velocity - state.second);
            const std::vector<double> up = misfit(from, count, state.first + dh, state.second);
            changed = misfit(from, count, state.first, state.second + dw);
            for (std::size_t i = 0; i < base.size(); ++i) {
                if (!std::isfinite(base[i]) || !std::isfinite(up[i]) || !std::isfinite(changed[i])) {
                    continue;
                }
                const double j1 = (up[i] - base[i]) / dh, j2 = (changed[i] - base[i]) / dw;
                a11 += j1 * j1;
                a12 += j1 * j2;
                a22 += j2 * j2;
                b1 -= j1 * base[i];
                b2 -= j2 * base[i];
            }
            const double determinant = a11 * a22 - a12 * a12;
            if (!(determinant > 0)) {
                break;
            }
            const double step_h = (b1 * a22 - b2 * a12) / determinant, step_w = (a11 * b2 - a12 * b1) / determinant;
            state.first = std::max(state.first + std::clamp(step_h, -0.05, 0.05), plant_.terms.contact_gap);
            state.second += std::clamp(step_w, -0.2, 0.2);
            if (std::abs(step_h) < 1e-9 && std::abs(step_w) < 1e-9) {
                break;
            }
        }
        return state;
    }

    /// Residuals in units of noise, NaN where nothing was measured.
    [[nodiscard]] std::vector<double> misfit(std::size_t from, std::size_t count, double h, double w) const {
        std::vector<double> gap(count), velocity(count), out(velocity_.empty() ? count : 2 * count);
        run_.simulate(plant_, from, from + count - 1, h, w, gap, velocity);
        std::vector<double> reading(count);
        run_.sensor(plant_, from, gap, reading);
        for (std::size_t i = 0; i < count; ++i) {
            out[i] = (reading[i] - gap_[from + i]) / gap_noise_;
            if (!velocity_.empty()) {
                out[count + i] = (velocity[i] - velocity_[from + i]) / velocity_noise_;
            }
        }
        return out;
    }

    InputSignals signals_;
    HeavePlant plant_;
    HeaveRun run_;
    std::vector<double> gap_, velocity_;
    PredictOptions options_;
    double gap_noise_, velocity_noise_;
    InsideTables inside_;
    std::size_t saturated_ = 0, outliers_ = 0;
};

using RunRows = std::vector<std::vector<RunPredictor::Row>>;

/// All runs predicted with the input read in one way.
struct SeriesPrediction {
    std::vector<std::unique_ptr<RunPredictor>> predictors;
    RunRows rows;
    bool outside_too = false;  ///< no run has a window inside the tables: whole runs are predicted
    /// The gap's errors in units of its noise, one window after the other; 0 where nothing was measured.
    [[nodiscard]] std::vector<double> errors(const std::vector<double>& noise) const {
        std::vector<double> errors;
        for (std::size_t r = 0; r < rows.size(); ++r) {
            for (const RunPredictor::Row& row : rows[r]) {
                const double error = (row.gap - predictors[r]->gap()[row.sample]) / noise[r];
                errors.push_back(std::isfinite(error) ? error : 0);
            }
        }
        return errors;
    }
};

double sum_of_squares(const std::vector<double>& values) {
    return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

/// How many independent errors hold as much as these: the errors of a model that is wrong are as smooth as the motion,
/// and a second of them says no more than one. By the sum of their autocorrelation, up to its first zero.
double independent_count(const std::vector<double>& errors) {
    const double all = sum_of_squares(errors);
    const std::size_t most = std::min<std::size_t>(errors.size() / 2, 2000);
    double sum = 1;
    for (std::size_t lag = 1; lag < most && all > 0; ++lag) {
        const double rho =
            std::inner_product(errors.begin() + static_cast<std::ptrdiff_t>(lag), errors.end(), errors.begin(), 0.0) /
            all;
        if (rho <= 0) {
            break;
        }
        sum += 2 * rho;
    }
    return static_cast<double>(errors.size()) / sum;
}

SeriesPrediction predict_runs(const Model& model, const RecordReading& records, const Measurements& data,
                              const PredictOptions& options, core::Progress& progress) {
    SeriesPrediction all;
    all.rows.resize(data.runs.size());
    for (const MeasuredRun& run : data.runs) {
        all.predictors.push_back(std::make_unique<RunPredictor>(model, records, run, options,
                                                                channel_noise(data, run, "gap", 1e-4),
                                                                channel_noise(data, run, "heave_velocity", 1e-3)));
    }
    const auto predict_all = [&](bool whole) {
        core::parallel_for(
            data.runs.size(), [&](std::size_t r) { all.rows[r] = all.predictors[r]->rows(whole); }, progress);
    };
    predict_all(false);
    const bool none = std::all_of(all.rows.begin(), all.rows.end(), [](const auto& rows) { return rows.empty(); });
    all.outside_too = none && std::any_of(all.predictors.begin(), all.predictors.end(),
                                          [](const auto& predictor) { return predictor->inside().outside > 0; });
    if (all.outside_too) {
        predict_all(true);
    }
    return all;
}

/// Held or linear between samples: as the model says, else what the measured motion fits; held where that tells
/// nothing. The runs predicted so, where that had to be worked out or `wanted`.
std::optional<SeriesPrediction> predict_as_read(const Model& model, const Measurements& data,
                                                const PredictOptions& options, bool wanted, InputReading& reading,
                                                core::Progress& progress) {
    using Between = RecordReading::Between;
    reading.records = model.records;
    const bool varies = std::any_of(data.runs.begin(), data.runs.end(), [](const MeasuredRun& run) {
        const InputSignals signals = signals_of(run);
        return std::any_of(signals.signals.begin(), signals.signals.end(),
                           [](const auto& signal) { return signal.channel == Channel::input_force; });
    });
    reading.between = !varies ? "" : reading.records.input_between == Between::linear ? "linear" : "held";
    reading.from = !varies ? "" : reading.records.input_between == Between::unsaid ? "data" : "declared";
    if (!varies || reading.records.input_between != Between::unsaid) {
        return wanted ? std::optional(predict_runs(model, reading.records, data, options, progress)) : std::nullopt;
    }
    std::vector<double> noise;
    for (const MeasuredRun& run : data.runs) {
        noise.push_back(channel_noise(data, run, "gap", 1e-4));
    }
    reading.records.input_between = Between::held;
    SeriesPrediction held = predict_runs(model, reading.records, data, options, progress);
    RecordReading other = reading.records;
    other.input_between = Between::linear;
    SeriesPrediction linear = predict_runs(model, other, data, options, progress);
    if (between_by_errors(held.errors(noise), linear.errors(noise)) == Between::linear) {
        reading.between = "linear";
        reading.records = other;
        return linear;
    }
    return held;
}

/// Counts windows whose gap leaves every bound of tables and measurements a hundredfold. Throws for values that are no
/// numbers.
void check_bounds(const SeriesPrediction& all, const Model& model, const Measurements& data, Prediction& out) {
    const GapRange table = lift_gap_range(model);
    double reach = table.upper < 1e299 && table.lower > -1e299 ? table.upper - table.lower : 0;
    for (const auto& predictor : all.predictors) {
        for (const double gap : predictor->gap()) {
            reach = std::isfinite(gap) ? std::max(reach, std::abs(gap)) : reach;
        }
    }
    for (std::size_t r = 0; r < all.rows.size(); ++r) {
        std::size_t last_bad = std::numeric_limits<std::size_t>::max(), windows = 0;
        for (const RunPredictor::Row& row : all.rows[r]) {
            windows = row.window + 1;
            if (!std::isfinite(row.gap) || !std::isfinite(row.velocity)) {
                throw core::InputError("integration",
                                       "the predicted motion of run " + data.runs[r].name + " is not finite at " +
                                           core::format_number(all.predictors[r]->time()[row.sample], 6) +
                                           " s: no step is small enough for the forces of the model there",
                                       {model.name, {}, {}, {}},
                                       "look at the effects and tables of the model at that gap");
            }
            if (std::abs(row.gap) > 100 * reach && row.window != last_bad) {
                last_bad = row.window;
                ++out.diverged;
            }
        }
        out.windows += windows;
    }
    if (out.diverged > 0) {
        out.remarks.push_back({core::Problem::Severity::warning,
                               core::counted_of(out.diverged, out.windows, "predicted window", "runs", "run") +
                                   " away to more than a hundred times every measured gap: the "
                                   "error says that the model is wrong there, not by how much",
                               {}});
    }
}

/// What of the runs is not judged by, and why.
void remark_unused(const SeriesPrediction& all, const Model& model, const Measurements& data, Prediction& out) {
    const GapRange tables = lift_gap_range(model);
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const RunPredictor& predictor = *all.predictors[r];
        const InsideTables& inside = predictor.inside();
        const std::string& run = data.runs[r].name;
        const auto say = [&](const std::string& text) {
            out.remarks.push_back({core::Problem::Severity::warning, text, {data.runs[r].table.source, {}, {}, {}}});
        };
        if (const std::string none = empty_text(data.runs[r], "gap"); !none.empty()) {
            say(none + ": it is left out");
            continue;
        }
        const bool used = !all.rows[r].empty();
        if (used && predictor.saturated() > 0) {
            say(saturated_text(run, predictor.saturated()));
        }
        if (used && predictor.outliers() > 0) {
            say(outliers_text(run, predictor.outliers()));
        }
        if (inside.outside > 0 && !all.outside_too) {
            const std::span<const double> time(predictor.time());
            say(unused_text(run, inside, tables, time.subspan(inside.first, inside.last - inside.first)));
        } else if (!used) {
            say("run " + run + " is shorter than the time a prediction needs and was left out");
        }
    }
    if (all.outside_too) {
        out.remarks.push_back({core::Problem::Severity::warning,
                               "no run stays inside the tables of the model " + range_text(tables) +
                                   " for as long as a prediction needs: the error holds what the tables' end values "
                                   "give outside, where nothing is known of the force",
                               {}});
    }
}

Prediction predict_series(const Model& model, const Measurements& data, const PredictOptions& options,
                          core::Progress& progress) {
    if (const Motion* const motion = motion_of(model, data)) {
        return predict_motion_series(*motion, model, data, options, progress);
    }
    if (std::none_of(data.runs.begin(), data.runs.end(),
                     [](const MeasuredRun& run) { return empty_text(run, "gap").empty(); })) {
        throw core::InputError("missing", "no run has a value of gap", {data.folder.string(), {}, {}, {}},
                               "heave is not told without it");
    }
    Prediction out;
    out.time_series = true;
    out.horizon = options.horizon;
    InputReading reading;
    const SeriesPrediction all = *predict_as_read(model, data, options, true, reading, progress);
    out.input_between = reading.between;
    out.input_between_from = reading.from;
    out.records = reading.records;
    check_bounds(all, model, data, out);
    remark_unused(all, model, data, out);
    std::vector<std::string> names;
    std::vector<double> window, time, gap, gap_predicted, velocity, velocity_predicted;
    ChannelScore gap_score, velocity_score;
    bool has_velocity = false;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const RunPredictor& predictor = *all.predictors[r];
        gap_score.noises.push_back(channel_noise(data, data.runs[r], "gap", 0));
        has_velocity = has_velocity || !predictor.velocity().empty();
        if (!predictor.velocity().empty()) {
            velocity_score.noises.push_back(channel_noise(data, data.runs[r], "heave_velocity", 0));
        }
        for (const RunPredictor::Row& row : all.rows[r]) {
            names.push_back(data.runs[r].name);
            window.push_back(static_cast<double>(row.window));
            time.push_back(predictor.time()[row.sample] + data.runs[r].clock_offset);
            gap.push_back(predictor.gap()[row.sample]);
            gap_predicted.push_back(row.gap);
            gap_score.take(row.gap - gap.back());
            velocity.push_back(predictor.velocity().empty() ? std::nan("") : predictor.velocity()[row.sample]);
            velocity_predicted.push_back(row.velocity);
            velocity_score.take(row.velocity - velocity.back());
        }
    }
    if (names.empty()) {
        return predict_shorter(data, options, [&](const PredictOptions& shorter) {
            return predict_series(model, data, shorter, progress);
        });
    }
    remark_long_horizon(data, options, out);
    out.table.add_text("run", names);
    out.table.add_numbers("window", "1", window);
    out.table.add_numbers("time", "s", time);
    out.table.add_numbers("gap", "m", gap);
    out.table.add_numbers("gap_predicted", "m", gap_predicted);
    out.channels.push_back(error_of("gap", "m", gap_score, data));
    if (has_velocity) {
        out.table.add_numbers("heave_velocity", "m/s", velocity);
        out.table.add_numbers("heave_velocity_predicted", "m/s", velocity_predicted);
        out.channels.push_back(error_of("heave_velocity", "m/s", velocity_score, data));
    }
    return out;
}

}  // namespace

RecordReading::Between between_samples(RecordReading::Between declared, double held, double linear) {
    using Between = RecordReading::Between;
    constexpr double clearly = 10;  // a factor of 150 in likelihood
    return declared != Between::unsaid ? declared : held - linear > clearly ? Between::linear : Between::held;
}

RecordReading::Between between_by_errors(const std::vector<double>& held, const std::vector<double>& linear) {
    const double size = static_cast<double>(held.size()), count = independent_count(held);
    const double of_held = sum_of_squares(held), of_linear = sum_of_squares(linear);
    // A model that lacks something is met better by one reading or the other for reasons of its own: that tells of the
    // input only where most of what is more than noise goes with it.
    const bool tells = of_linear - size < 0.5 * (of_held - size);
    const double by_held = tells ? count * std::log(of_held) : 0, by_linear = tells ? count * std::log(of_linear) : 0;
    return between_samples(RecordReading::Between::unsaid, by_held, by_linear);
}

InputReading input_reading(const Model& model, const Measurements& data, const PredictOptions& options,
                           core::Progress& progress) {
    InputReading reading;
    (void)predict_as_read(model, data, options, false, reading, progress);
    return reading;
}

std::string reading_text(const RecordReading& records) {
    std::string text;
    const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
    if (records.input_factor != 1) {
        add("input_force times " + core::format_number(records.input_factor, 6));
    }
    if (records.input_advance != 0) {
        add("input_force " + core::format_number(records.input_advance, 4) + " s earlier than logged");
    }
    if (records.others_advance != 0) {
        add("the other inputs " + core::format_number(records.others_advance, 4) + " s earlier than logged");
    }
    for (const auto& [column, factor] : records.factors) {
        add(column + " times " + core::format_number(factor, 6));
    }
    if (records.velocity_factor != 1) {
        add("heave_velocity times " + core::format_number(records.velocity_factor, 6));
    }
    if (records.input_between == RecordReading::Between::linear) {
        add("inputs linear between their samples");
    }
    return text;
}

std::string reading_on_the_rig(RecordReading records) {
    records.input_between = RecordReading::Between::unsaid;
    const std::string read = reading_text(records);
    return read.empty() ? std::string()
                        : "[records] of the model reads the logs of its rig with " + read +
                              ": input_force is here the force that acts; a rig that takes and gives it as its logs "
                              "hold it needs the same reading between";
}

Prediction predict(const Model& model, const Measurements& data, const PredictOptions& options,
                   core::Progress& progress) {
    if (!(options.horizon > 0)) {
        throw core::UsageError("range", "the horizon must be positive");
    }
    const bool steady = data.kind == MeasurementKind::steady;
    core::Problems before = data.problems;
    const std::optional<Measurements> without = steady ? std::nullopt : without_doubtful_noise(model, data, before);
    Prediction prediction;
    try {
        prediction =
            steady ? predict_static(model, data) : predict_series(model, without ? *without : data, options, progress);
    } catch (const core::InputError& error) {
        const bool heave = !steady && motion_of(model, data) == nullptr;
        if (const auto doubt =
                heave ? doubtful_clock(model, data) : std::nullopt) {  // why the samples lie so far apart
            throw core::InputError("unit", doubt->message + " (" + error.message() + ")", doubt->place,
                                   "mend the unit of time in the header line");
        }
        throw;
    }
    for (ChannelError& channel : prediction.channels) {
        const auto declared = data.declared_noise(channel.name);
        if (declared && unit_of_errors(declared, channel.noise) == *declared) {
            channel.noise = *declared;
            channel.noise_declared = true;
            channel.in_noise = channel.rmse / *declared;
        }
    }
    if (!steady) {
        const core::Problems unsaid = taken_as_zero(prediction.motion, model, data);
        before.insert(before.end(), unsaid.begin(), unsaid.end());
        if (const auto doubt = prediction.motion == "heave" ? doubtful_clock(model, data) : std::nullopt) {
            before.push_back(*doubt);
        }
    }
    prediction.remarks.insert(prediction.remarks.begin(), before.begin(), before.end());
    const core::Problems outside = runs_outside(model, data);
    prediction.remarks.insert(prediction.remarks.end(), outside.begin(), outside.end());
    const bool pushed =
        std::any_of(data.runs.begin(), data.runs.end(), [](const MeasuredRun& run) { return run.has("input_force"); });
    for (const EffectUse& use : model.effects) {
        const std::vector<std::string>& acts_on = effect(use.name).info().depends_on;
        if (prediction.time_series && !pushed &&
            std::find(acts_on.begin(), acts_on.end(), channel_name(Channel::input_force)) != acts_on.end()) {
            prediction.remarks.push_back(
                {core::Problem::Severity::warning,
                 "the model's " + use.name + " acts on input_force, which no run has: it does nothing here",
                 {}});
        }
    }
    return prediction;
}

core::Figure prediction_figure(const Prediction& prediction) {
    core::Figure figure;
    if (prediction.channels.empty()) {
        return figure;
    }
    const ChannelError& channel = prediction.channels.front();
    const std::vector<double>& measured = prediction.table.numbers(channel.name);
    const std::vector<double>& predicted = prediction.table.numbers(channel.name + "_predicted");
    if (!prediction.time_series) {
        figure.title = "Measured against predicted " + channel.name;
        figure.x = {"predicted " + channel.name, channel.unit};
        figure.y = {"measured " + channel.name, channel.unit};
        figure.points.push_back({"", predicted, measured, {}, core::palette(0)});
        const auto [low, high] = std::minmax_element(predicted.begin(), predicted.end());
        figure.curves.push_back({"equal", {*low, *high}, {*low, *high}, {120, 120, 120, 255}, 1, true});
    } else {
        figure.title = "Measured and predicted gap";
        figure.x = {"time", "s"};
        figure.y = {"gap", "mm"};
        const std::vector<std::string>& runs = prediction.table.text("run");
        const std::vector<double>& time = prediction.table.numbers("time");
        const std::vector<double>& window = prediction.table.numbers("window");
        core::FigurePoints seen{"measured", {}, {}, {}, {130, 130, 130, 255}, core::FigurePoints::Shape::disc, 3};
        core::FigureCurve line{"predicted", {}, {}, core::palette(0)};
        for (std::size_t i = 0; i < time.size() && runs[i] == runs[0]; ++i) {
            seen.x.push_back(time[i]);
            seen.y.push_back(1e3 * measured[i]);
            if (i > 0 && window[i] != window[i - 1]) {
                line.x.push_back(std::nan(""));
                line.y.push_back(std::nan(""));
            }
            line.x.push_back(time[i]);
            line.y.push_back(1e3 * predicted[i]);
        }
        figure.points.push_back(seen);
        figure.curves.push_back(line);
    }
    figure.caption =
        "RMSE " + core::format_number(channel.rmse, 3) + " " + channel.unit +
        (channel.in_noise > 0 ? ", " + core::format_number(channel.in_noise, 3) + " times the noise" : "") + ".";
    return figure;
}

void to_json(nlohmann::json& json, const Prediction& prediction) {
    json = nlohmann::json::object();
    json["channels"] = nlohmann::json::object();
    for (const ChannelError& channel : prediction.channels) {
        json["channels"][channel.name] = {
            {"rmse", channel.rmse},         {"unit", channel.unit},
            {"noise", channel.noise},       {"noise_from", channel.noise_declared ? "declared" : "estimated"},
            {"in_noise", channel.in_noise}, {"count", channel.count}};
    }
    json["kind"] = prediction.time_series ? "time_series" : "static";
    if (prediction.time_series) {
        json["motion"] = prediction.motion;
        json["windows"] = prediction.windows;
        json["diverged_windows"] = prediction.diverged;
    }
    if (const std::string read = reading_text(prediction.records); !read.empty()) {
        json["logs_read_as"] = read;
    }
    if (!prediction.input_between.empty()) {
        json["input_between"] = {{"value", prediction.input_between}, {"from", prediction.input_between_from}};
    }
    json["remarks"] = nlohmann::json::array();
    for (const core::Problem& remark : prediction.remarks) {
        json["remarks"].push_back(remark.message);
    }
}

}  // namespace underbody::dynamics
