#include "surrogates/dynamics/simulate/pitch_run.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/simulate/clean_readings.h"
#include "surrogates/dynamics/simulate/heave_pitch_contact.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"
#include "surrogates/dynamics/simulate/start_state.h"

namespace underbody::dynamics {

namespace {

constexpr double longest_step = 0.02;  ///< s
/// Standard deviations of its noise that a pitch has to move by for its motion to be one.
constexpr double moves_by = 5;

/// The inputs of a run without its states.
InputSignals inputs_of(const MeasuredRun& run, const RecordReading& records) {
    InputSignals signals = signals_of(run, records);
    std::erase_if(signals.signals, [](const InputSignals::Signal& signal) {
        return std::find(pitch_channels.begin(), pitch_channels.end(), signal.channel) != pitch_channels.end();
    });
    return signals;
}

bool pitch_moves(const MeasuredRun& run) {
    const core::Column* column = run.table.find("pitch");
    if (column == nullptr || column->is_text()) {
        return false;
    }
    const std::vector<double>& time = run.table.numbers("time");
    std::vector<double> values = column->numbers;
    const double noise = sensor_noise(time, values);
    drop_outliers(values, std::max(noise, 1e-9));
    double sum = 0, square = 0, count = 0;
    for (const double value : values) {
        if (std::isfinite(value)) {
            sum += value;
            square += value * value;
            ++count;
        }
    }
    if (count < 5) {
        return false;
    }
    const double spread = std::sqrt(std::max(0.0, square / count - sum * sum / (count * count)));
    return spread > 1e-9 && spread > moves_by * noise;
}

/// A missing value is that before it.
void fill(std::vector<double>& values) {
    double last = 0;
    for (double& value : values) {
        last = std::isfinite(value) ? value : last;
        value = last;
    }
}

}  // namespace

bool moves_in_pitch(const Model& model, const Measurements& data) {
    if (data.kind != MeasurementKind::time_series || data.motion == "heave") {
        return false;
    }
    if (data.motion == "heave_pitch") {
        for (const MeasuredRun& run : data.runs) {
            if (run.table.find("pitch") == nullptr) {
                throw core::InputError("missing", "run " + run.name + " is of heave with pitch and has no column pitch",
                                       {run.table.source, {}, {}, {}},
                                       "pitch [rad], positive nose up; or motion = "
                                       "\"heave\"");
            }
        }
        return true;
    }
    const Vehicle& v = model.vehicle;
    const std::vector<std::string> sources = model.quantities();
    return !std::isnan(v.pitch_inertia) && !std::isnan(v.base_depth) && !std::isnan(v.base_half_length) &&
           std::find(sources.begin(), sources.end(), "pitch_moment") != sources.end() && !data.runs.empty() &&
           std::all_of(data.runs.begin(), data.runs.end(), pitch_moves);
}

PitchRun::PitchRun(const Model& model, const MeasuredRun& run, const RecordReading& records)
    : signals_(inputs_of(run, records)),
      plant_(model, signals_.held, varying_channels(signals_)),
      inputs_(plant_.vertical(), signals_),
      linear_(records.input_between == RecordReading::Between::linear) {
    if (plant_.remembers()) {
        throw core::InputError("motion", "history_force cannot be predicted in heave with pitch",
                               {model.name, {}, {}, {}}, "leave the effect out, or say motion = \"heave\" of the runs");
    }
    if (run.has("input_moment")) {
        input_moment_ = run.values("input_moment");
        fill(input_moment_);
    }
    for (std::size_t i = 0; i < pitch_states; ++i) {
        if (run.table.find(channel_name(pitch_channels[i])) != nullptr) {
            readings_.value[i] = as_read(run, channel_name(pitch_channels[i]), records);
        }
    }
}

std::vector<std::string> PitchRun::clean_readings(const std::string& name, const GapRange& tables) {
    std::vector<std::string> said;
    for (std::size_t i = 0; i < pitch_states; ++i) {
        std::vector<double>& values = readings_.value[i];
        if (values.empty()) {
            continue;
        }
        const bool gap = pitch_channels[i] == Channel::gap;
        if (const std::size_t saturated = gap ? drop_saturated(time(), values) : 0; saturated > 0) {
            said.push_back(saturated_text(name, saturated));
        }
        const double own = sensor_noise(time(), values);
        if (const std::size_t outliers = drop_outliers(values, std::max(own, 1e-9)); outliers > 0) {
            said.push_back(outliers_text(name, outliers, channel_name(pitch_channels[i])));
        }
        const InsideTables inside = gap ? longest_inside(values, tables, own) : InsideTables{};
        if (inside.outside > 0) {
            said.push_back(outside_text(name, inside, tables) + "; the tables' end values are taken for it");
        }
    }
    return said;
}

void PitchRun::rate(std::size_t k, double t, const PitchState& y, ContactState bearing, PitchState& dydt, double force,
                    double moment) {
    Surroundings around = inputs_.at(t);
    around.force = force;
    around.moment = moment;
    if (!input_moment_.empty()) {
        const double part = linear_ ? (t - time()[k]) / (time()[k + 1] - time()[k]) : 0;
        around.moment += input_moment_[k] + (part > 0 ? part * (input_moment_[k + 1] - input_moment_[k]) : 0);
    }
    plant_.rate(y, bearing, dydt, around);
}

void PitchRun::advance(std::size_t k, PitchState& y, ContactState& bearing, double force, double moment) {
    const double width = time()[k + 1] - time()[k];
    const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(width / longest_step * (1 - 1e-9))));
    const double h = width / static_cast<double>(steps);
    for (std::size_t s = 0; s < steps; ++s) {
        // the last moment of a step still has the input that is held over it
        const double t = time()[k] + h * static_cast<double>(s), middle = t + 0.5 * h, last = t + h * (1 - 1e-9);
        PitchState d1{}, d2{}, d3{}, d4{}, moved{};
        const auto along = [&](const PitchState& d, double part) {
            for (std::size_t i = 0; i < pitch_states; ++i) {
                moved[i] = y[i] + part * d[i];
            }
        };
        rate(k, t, y, bearing, d1, force, moment);
        along(d1, 0.5 * h);
        rate(k, middle, moved, bearing, d2, force, moment);
        along(d2, 0.5 * h);
        rate(k, middle, moved, bearing, d3, force, moment);
        along(d3, h);
        rate(k, last, moved, bearing, d4, force, moment);
        for (std::size_t i = 0; i < pitch_states; ++i) {
            y[i] += h / 6 * (d1[i] + 2 * d2[i] + 2 * d3[i] + d4[i]);
        }
        const std::array<double, 2> gaps = plant_.edge_gaps(y);
        if (std::min(gaps[0], gaps[1]) < 0) {
            land(plant_, y, bearing, inputs_.at(last));
        } else if (bearing != ContactState::free) {
            bearing = plant_.settle(y, bearing, inputs_.at(last));
        }
    }
}

double PitchRun::reading(std::size_t sample, std::size_t state, const PitchState& y) const {
    const HeaveTerms& terms = plant_.vertical().terms;
    switch (state) {
        case 0:
            return y[0] - terms.sensor_delay * y[1] + terms.sensor_offset(time()[sample]);
        case 2:
            return y[2] + terms.pitch.sensor_bias;
        default:
            return y[state];
    }
}

std::vector<PitchState> motion_from(PitchRun& run, const PitchState& state, std::size_t from, std::size_t end) {
    std::vector<PitchState> motion{state};
    motion.reserve(end - from + 1);
    PitchState y = state;
    ContactState bearing = ContactState::free;
    for (std::size_t k = from; k < end; ++k) {
        run.advance(k, y, bearing);
        motion.push_back(y);
    }
    return motion;
}

namespace {

using Vector4 = Eigen::Vector4d;
using Matrix4 = Eigen::Matrix4d;

/// Readings less motion in units of noise, channel by channel; 0 where nothing was read.
std::vector<double> misfit(PitchRun& run, const PitchReadings& readings, const PitchState& state, std::size_t from,
                           std::size_t start) {
    const std::vector<PitchState> motion = motion_from(run, state, from, start);
    std::vector<double> out;
    for (std::size_t i = 0; i < pitch_states; ++i) {
        if (readings.value[i].empty() || !(readings.noise[i] > 0)) {
            continue;
        }
        for (std::size_t k = from; k <= start; ++k) {
            const double error = (readings.value[i][k] - run.reading(k, i, motion[k - from])) / readings.noise[i];
            out.push_back(std::isfinite(readings.value[i][k]) ? error : 0.0);
        }
    }
    return out;
}

double square(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) {
        sum += value * value;
    }
    return std::isfinite(sum) ? sum : 1e300;
}

}  // namespace

std::optional<PitchState> fitted_state(PitchRun& run, const PitchReadings& readings, std::size_t from,
                                       std::size_t start) {
    const StartState gap = start_state(run.time(), readings.value[0], from, start),
                     pitch = start_state(run.time(), readings.value[2], from, start);
    if (!gap.found() || !pitch.found()) {
        return {};
    }
    const HeaveTerms& terms = run.plant().vertical().terms;
    PitchState state{gap.gap - terms.sensor_offset(run.time()[from]), gap.velocity, pitch.gap - terms.pitch.sensor_bias,
                     pitch.velocity};
    const PitchState line = state;
    // what the motion does not show is taken from the line, loosely
    const PitchState loose{0, 0.05 + 10 * readings.noise[0] * std::sqrt(gap.slope_factor), 0,
                           0.5 + 10 * readings.noise[2] * std::sqrt(pitch.slope_factor)};
    constexpr PitchState small{1e-5, 1e-5, 1e-5, 1e-4}, largest{0.05, 0.2, 0.2, 1};
    const auto prior = [&](const PitchState& y) {
        return std::pow((y[1] - line[1]) / loose[1], 2) + std::pow((y[3] - line[3]) / loose[3], 2);
    };
    std::vector<double> base = misfit(run, readings, state, from, start);
    double cost = square(base) + prior(state);
    double damping = 1e-9;
    for (int iteration = 0; iteration < 12; ++iteration) {
        std::array<std::vector<double>, pitch_states> slope;
        for (std::size_t i = 0; i < pitch_states; ++i) {
            PitchState moved = state;
            moved[i] += small[i];
            slope[i] = misfit(run, readings, moved, from, start);
        }
        Matrix4 normal = Matrix4::Zero();
        Vector4 right = Vector4::Zero();
        for (std::size_t n = 0; n < base.size(); ++n) {
            Vector4 row;
            for (std::size_t i = 0; i < pitch_states; ++i) {
                row[static_cast<int>(i)] = (slope[i][n] - base[n]) / small[i];
            }
            if (row.allFinite() && std::isfinite(base[n])) {
                normal += row * row.transpose();
                right -= row * base[n];
            }
        }
        for (const int i : {1, 3}) {
            const auto k = static_cast<std::size_t>(i);
            normal(i, i) += 1 / (loose[k] * loose[k]);
            right[i] -= (state[k] - line[k]) / (loose[k] * loose[k]);
        }
        bool better = false;
        double change = 0;
        for (int attempt = 0; attempt < 6 && !better; ++attempt) {
            Matrix4 damped = normal;
            damped.diagonal() *= 1 + damping;
            const Vector4 step = damped.ldlt().solve(right);
            PitchState moved = state;
            change = 0;
            for (std::size_t i = 0; i < pitch_states; ++i) {
                const double by = std::clamp(step[static_cast<int>(i)], -largest[i], largest[i]);
                moved[i] += by;
                change = std::max(change, std::abs(by) / largest[i]);
            }
            std::vector<double> there = misfit(run, readings, moved, from, start);
            const double cost_there = square(there) + prior(moved);
            better = cost_there < cost;
            if (better) {
                state = moved;
                base = std::move(there);
                cost = cost_there;
                damping = std::max(1e-9, 0.1 * damping);
            } else if (change < 1e-7) {
                break;
            } else {
                damping = std::max(1e-3, 10 * damping);
            }
        }
        if (!better || change < 1e-6) {
            break;
        }
    }
    return state;
}

std::vector<PitchWindow> predict_windows(PitchRun& run, double horizon, double past) {
    const std::vector<double>& t = run.time();
    const auto at = [&t](double time) {
        return static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), time - 1e-9) - t.begin());
    };
    std::vector<PitchWindow> windows;
    for (double begin = t.front() + past; begin < t.back(); begin += horizon) {
        PitchWindow window;
        window.from = at(begin - past);
        window.start = at(begin);
        window.end = std::max<std::size_t>(std::min(at(std::min(begin + horizon, t.back()) + 1e-6), t.size()), 1) - 1;
        if (window.end <= window.start || window.start <= window.from + 2) {
            continue;
        }
        const std::optional<PitchState> state = fitted_state(run, run.readings(), window.from, window.start);
        if (state) {
            window.state = *state;
            window.motion = motion_from(run, *state, window.from, window.end);
            windows.push_back(std::move(window));
        }
    }
    return windows;
}

}  // namespace underbody::dynamics
