#include "surrogates/dynamics/simulate/measured_motion.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/no_limit.h"
#include "surrogates/dynamics/simulate/clean_readings.h"
#include "surrogates/dynamics/simulate/pitch_run.h"
#include "surrogates/dynamics/simulate/read_records.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"
#include "surrogates/dynamics/simulate/start_state.h"

namespace underbody::dynamics {

const Motion* motion_of(const Model& model, const Measurements& data) {
    for (const Motion* const said : {&surface_motion(), &body_motion()}) {
        if (data.kind == MeasurementKind::time_series && data.motion == said->shape().name) {
            return said;
        }
    }
    return moves_in_pitch(model, data) ? &heave_pitch_motion() : nullptr;
}

void forget_after(const std::vector<double>& time, double known, std::vector<double>& values) {
    const auto last = std::upper_bound(time.begin(), time.end(), known + 1e-9) - time.begin();
    std::fill(values.begin() + std::min(last, static_cast<std::ptrdiff_t>(values.size())), values.end(), std::nan(""));
}

void MeasuredMotion::take_readings(const MeasuredRun& run, const RecordReading& records,
                                   std::initializer_list<std::size_t> needed) {
    known_until_ = time().back() - std::max(0.0, records.last_unknown());
    for (std::size_t i = 0; i < shape().states.size(); ++i) {
        const std::string& channel = shape().states[i].channel;
        std::vector<double> values =
            run.table.find(channel) != nullptr ? as_read(run, channel, records) : std::vector<double>{};
        if (std::any_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); })) {
            readings_.value[i] = std::move(values);
            forget_after(time(), known_until_, readings_.value[i]);
        } else if (std::find(needed.begin(), needed.end(), i) != needed.end()) {
            throw core::InputError("missing", "run " + run.name + " has no value of " + channel,
                                   {run.table.source, {}, {}, {}}, shape().words + " is not told without it");
        }
    }
}

std::vector<std::string> MeasuredMotion::clean_after(std::vector<std::string> said, const std::string& name,
                                                     const Model& model) {
    const GapRange tables = lift_gap_range(model);
    for (std::size_t i = 0; i < shape().states.size(); ++i) {
        std::vector<double>& values = readings_.value[i];
        if (values.empty()) {
            continue;
        }
        const bool gap = shape().states[i].channel == channel_name(Channel::gap);
        if (const std::size_t saturated = gap ? drop_saturated(time(), values) : 0; saturated > 0) {
            said.push_back(saturated_text(name, saturated));
        }
        const double own = sensor_noise(time(), values);
        if (const std::size_t outliers = drop_outliers(values, std::max(own, 1e-9)); outliers > 0) {
            said.push_back(outliers_text(name, outliers, shape().states[i].channel));
        }
        const InsideTables inside = gap ? longest_inside(values, tables, own) : InsideTables{};
        if (inside.outside > 0) {
            said.push_back(outside_text(name, inside, tables) + "; the tables' end values are taken for it");
        }
    }
    return said;
}

bool column_moves(const MeasuredRun& run, const std::string& column) {
    const core::Column* found = run.table.find(column);
    if (found == nullptr || found->is_text() || found->numbers.empty()) {
        return false;
    }
    double low = core::no_limit, high = -core::no_limit;
    for (const double value : found->numbers) {
        low = std::isfinite(value) ? std::min(low, value) : low;
        high = std::isfinite(value) ? std::max(high, value) : high;
    }
    return high > low;
}

bool Motion::driven(const Model& model, const MeasuredRun& run) const {
    const std::vector<std::string> columns = inputs(model);
    return std::any_of(columns.begin(), columns.end(), [&](const auto& column) { return column_moves(run, column); });
}

std::vector<MotionState> motion_from(MeasuredMotion& run, const MotionState& state, std::size_t from, std::size_t end,
                                     bool* lost) {
    std::vector<MotionState> motion{state};
    motion.reserve(end - from + 1);
    MotionState y = state;
    ContactState bearing = ContactState::free;
    bool goes_on = run.goes_on(y);
    for (std::size_t k = from; k < end; ++k) {
        MotionState next = y;
        try {
            if (goes_on) {
                run.advance(k, next, bearing, {});
            }
        } catch (const core::Error& error) {
            if (error.kind() != "contact") {
                throw;
            }
            goes_on = false;
        }
        goes_on = goes_on && run.goes_on(next);
        y = goes_on ? next : y;
        motion.push_back(y);
    }
    if (lost != nullptr) {
        *lost = !goes_on;
    }
    return motion;
}

namespace {

/// Readings less motion in units of noise, channel by channel; 0 where nothing was read.
std::vector<double> misfit(MeasuredMotion& run, const MotionReadings& readings, const MotionState& state,
                           std::size_t from, std::size_t start) {
    const std::vector<MotionState> motion = motion_from(run, state, from, start);
    std::vector<double> out;
    for (std::size_t i = 0; i < run.shape().states.size(); ++i) {
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

/// fitted_state() of a motion of at most so many states.
template <int most>
std::optional<MotionState> fit_state(MeasuredMotion& run, const MotionReadings& readings, std::size_t from,
                                     std::size_t start) {
    using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;
    using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
    const std::vector<MotionShape::State>& states = run.shape().states;
    const std::optional<MotionStart> line = run.start(readings, from, start);
    if (!line) {
        return {};
    }
    const std::size_t count = states.size();
    MotionState state = line->state, loose{};
    for (std::size_t i = 0; i < count; ++i) {
        loose[i] = states[i].fit_width + 10 * readings.noise[states[i].place] * std::sqrt(line->slope_factor[i]);
    }
    // what the motion does not show of the rates is taken from the line, loosely
    const auto prior = [&](const MotionState& y) {
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i) {
            sum += run.shape().is_place(i) ? 0 : std::pow((y[i] - line->state[i]) / loose[i], 2);
        }
        return sum;
    };
    std::vector<double> base = misfit(run, readings, state, from, start);
    double cost = square(base) + prior(state);
    double damping = 1e-9;
    for (int iteration = 0; iteration < 12; ++iteration) {
        std::array<std::vector<double>, most_states> slope;
        for (std::size_t i = 0; i < count; ++i) {
            MotionState moved = state;
            moved[i] += states[i].small;
            slope[i] = misfit(run, readings, moved, from, start);
        }
        const auto size = static_cast<Eigen::Index>(count);
        Square normal = Square::Zero(size, size);
        Column right = Column::Zero(size);
        for (std::size_t n = 0; n < base.size(); ++n) {
            Column row(size);
            for (std::size_t i = 0; i < count; ++i) {
                row[static_cast<Eigen::Index>(i)] = (slope[i][n] - base[n]) / states[i].small;
            }
            if (row.allFinite() && std::isfinite(base[n])) {
                normal += row * row.transpose();
                right -= row * base[n];
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (!run.shape().is_place(i)) {
                const auto k = static_cast<Eigen::Index>(i);
                normal(k, k) += 1 / (loose[i] * loose[i]);
                right[k] -= (state[i] - line->state[i]) / (loose[i] * loose[i]);
            } else if (readings.value[i].empty()) {
                normal(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) += 1;  // stays where it begins
            }
        }
        bool better = false;
        double change = 0;
        for (int attempt = 0; attempt < 6 && !better; ++attempt) {
            Square damped = normal;
            damped.diagonal() *= 1 + damping;
            const Column step = damped.ldlt().solve(right);
            MotionState moved = state;
            change = 0;
            for (std::size_t i = 0; i < count; ++i) {
                const double largest = states[i].largest,
                             by = std::clamp(step[static_cast<Eigen::Index>(i)], -largest, largest);
                moved[i] += by;
                change = std::max(change, std::abs(by) / largest);
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

}  // namespace

std::optional<MotionState> fitted_state(MeasuredMotion& run, const MotionReadings& readings, std::size_t from,
                                        std::size_t start) {
    constexpr std::size_t of_few = 6;
    return run.shape().states.size() <= of_few ? fit_state<of_few>(run, readings, from, start)
                                               : fit_state<most_states>(run, readings, from, start);
}

std::vector<MotionWindow> predict_windows(MeasuredMotion& run, double horizon, double past) {
    const std::vector<double>& t = run.time();
    const auto at = [&t](double time) {
        return static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), time - 1e-9) - t.begin());
    };
    std::vector<MotionWindow> windows;
    const double known = run.known_until();
    for (double begin = t.front() + past; begin < known; begin += horizon) {
        MotionWindow window;
        window.from = at(begin - past);
        window.start = at(begin);
        window.end = std::max<std::size_t>(std::min(at(std::min(begin + horizon, known) + 1e-6), t.size()), 1) - 1;
        if (window.end <= window.start || window.start <= window.from + 2) {
            continue;
        }
        const std::optional<MotionState> state = fitted_state(run, run.readings(), window.from, window.start);
        if (state) {
            window.state = *state;
            window.motion = motion_from(run, *state, window.from, window.end, &window.lost);
            windows.push_back(std::move(window));
        }
    }
    return windows;
}

}  // namespace underbody::dynamics
