#include "surrogates/discovery/heave_pitch/pitch_filter.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/simulate/start_state.h"

namespace underbody::discovery {

using dynamics::pitch_states;
using dynamics::PitchState;

namespace {

constexpr int states = filter_states;
using Vector = Eigen::Matrix<double, states, 1>;
using Matrix = Eigen::Matrix<double, states, states>;
using Matrix4 = Eigen::Matrix4d;
using Loads = Eigen::Matrix<double, 4, 2>;

PitchState motion_of(const Vector& x) { return {x[0], x[1], x[2], x[3]}; }

/// What a force and a moment do to the rates.
Loads load_rates(const dynamics::PitchRun& run, const PitchState& y) {
    const dynamics::HeavePitch& plant = run.plant();
    Loads g = Loads::Zero();
    g(1, 0) = 1 / plant.mass(y[0]);
    g(1, 1) = plant.arm(y[2]) / plant.inertia();
    g(3, 1) = 1 / plant.inertia();
    return g;
}

Matrix4 slopes(dynamics::PitchRun& run, std::size_t k, const PitchState& y, double force, double moment) {
    constexpr std::array<double, pitch_states> small{1e-5, 1e-5, 1e-5, 1e-4};
    const double t = run.time()[k];
    PitchState base{}, there{};
    run.rate(k, t, y, dynamics::ContactState::free, base, force, moment);
    Matrix4 a = Matrix4::Zero();
    for (int j = 0; j < 4; ++j) {
        PitchState moved = y;
        moved[static_cast<std::size_t>(j)] += small[static_cast<std::size_t>(j)];
        run.rate(k, t, moved, dynamics::ContactState::free, there, force, moment);
        for (int i = 0; i < 4; ++i) {
            a(i, j) = (there[static_cast<std::size_t>(i)] - base[static_cast<std::size_t>(i)]) /
                      small[static_cast<std::size_t>(j)];
        }
    }
    return a;
}

/// The linear step over an interval and what noise adds to it.
void linear_step(dynamics::PitchRun& run, std::size_t k, const Vector& x, const PitchNoise& noise, Matrix& step,
                 Matrix& added) {
    const double dt = run.time()[k + 1] - run.time()[k];
    const PitchState y = motion_of(x);
    const Matrix4 a = slopes(run, k, y, x[4], x[5]) * dt;
    const Loads g = load_rates(run, y);
    const Matrix4 one = Matrix4::Identity();
    step.setIdentity();
    step.topLeftCorner<4, 4>() = one + a * (one + a * (one / 2 + a * (one / 6 + a / 24)));
    step.block<4, 2>(0, 4) = dt * (one + a * (one / 2 + a / 6)) * g;
    const double decay = std::exp(-dt / noise.slow_time);
    step(6, 6) = step(7, 7) = decay;
    const Loads random = (one + 0.5 * a) * g;
    added.setZero();
    added.topLeftCorner<4, 4>() = dt * (noise.force * noise.force * random.col(0) * random.col(0).transpose() +
                                        noise.moment * noise.moment * random.col(1) * random.col(1).transpose());
    added(4, 4) = dt * noise.force_walk * noise.force_walk;
    added(5, 5) = dt * noise.moment_walk * noise.moment_walk;
    added(6, 6) = (1 - decay * decay) * noise.gap_slow * noise.gap_slow;
    added(7, 7) = (1 - decay * decay) * noise.pitch_slow * noise.pitch_slow;
}

/// How loosely a filter begins about lines through the first readings: variances of gap, velocity, pitch and rate.
std::array<double, 4> begin_variances(const PitchNoise& noise, double gap_slope, double pitch_slope) {
    const double gap = noise.total(0), pitch = noise.total(2);
    return {std::pow(20 * gap, 2), std::pow(0.05 + 10 * gap * std::sqrt(gap_slope), 2), std::pow(20 * pitch, 2),
            std::pow(0.3 + 10 * pitch * std::sqrt(pitch_slope), 2)};
}

/// Where the filter begins.
void begin(const dynamics::PitchRun& run, const PitchRecord& record, const PitchNoise& noise, Vector& x, Matrix& p) {
    const dynamics::StartState gap = dynamics::start_state(run.time(), record.value[0], record.first, record.last),
                               pitch = dynamics::start_state(run.time(), record.value[2], record.first, record.last);
    const dynamics::HeaveTerms& terms = run.plant().vertical().terms;
    x.setZero();
    x[0] = gap.gap - terms.sensor_offset(run.time()[record.first]);
    x[1] = gap.velocity;
    x[2] = pitch.gap - terms.pitch.sensor_bias;
    x[3] = pitch.velocity;
    p.setZero();
    const std::array<double, 4> loose = begin_variances(noise, gap.slope_factor, pitch.slope_factor);
    p.diagonal().head<4>() = Eigen::Map<const Eigen::Vector4d>(loose.data());
    const double unknown = 10;  // s: the walk of a force over that long
    p(4, 4) = unknown * noise.force_walk * noise.force_walk;
    p(5, 5) = unknown * noise.moment_walk * noise.moment_walk;
    p(6, 6) = noise.gap_slow * noise.gap_slow;
    p(7, 7) = noise.pitch_slow * noise.pitch_slow;
}

/// Coloured noise that stands beside a state's reading: its place among the states, or none.
int slow_of(std::size_t channel) { return channel == 0 ? 6 : channel == 2 ? 7 : -1; }

void store(PitchTrace::Column& to, const Vector& from) { Eigen::Map<Vector>(to.data()) = from; }
void store(PitchTrace::Square& to, const Matrix& from) { Eigen::Map<Matrix>(to.data()) = from; }

}  // namespace

double PitchNoise::total(std::size_t state) const {
    return std::hypot(white[state], state == 0 ? gap_slow : state == 2 ? pitch_slow : 0.0);
}

double filter_pitch(dynamics::PitchRun& run, const PitchRecord& record, const PitchNoise& noise,
                    std::vector<double>& innovations, PitchTrace* trace) {
    Vector x;
    Matrix p, step, added;
    begin(run, record, noise, x, p);
    const double delay = run.plant().vertical().terms.sensor_delay;
    double cost = 0;
    for (std::size_t k = record.first; k <= record.last; ++k) {
        if (trace != nullptr) {
            store(trace->predicted.emplace_back(), x);
            store(trace->predicted_covariance.emplace_back(), p);
            trace->updates.emplace_back();
        }
        for (std::size_t i = 0; i < pitch_states; ++i) {
            if (record.value[i].empty()) {
                continue;
            }
            const double read = record.value[i][k];
            const auto own = static_cast<int>(i);
            const int slow = slow_of(i);
            Vector h = Vector::Zero();
            h[own] = 1;
            if (i == 0) {
                h[1] = -delay;
            }
            if (slow >= 0) {
                h[slow] = 1;
            }
            const Vector ph = p * h;
            const double variance = h.dot(ph) + noise.white[i] * noise.white[i];
            if (!std::isfinite(read) || !(variance > 0)) {
                innovations.push_back(0);
                continue;
            }
            const double expected = run.reading(k, i, motion_of(x)) + (slow >= 0 ? x[slow] : 0.0);
            const double root = std::sqrt(variance), error = (read - expected) / root;
            const Vector gain = ph / variance;
            x += gain * (error * root);
            p -= gain * ph.transpose();
            innovations.push_back(error);
            cost += error * error + std::log(variance);
            if (trace != nullptr) {
                PitchTrace::Update update{i, i == 0 ? delay : 0, root, {}};
                store(update.gain, gain);
                trace->updates.back().push_back(update);
            }
        }
        p = 0.5 * (p + p.transpose()).eval();
        if (trace != nullptr) {
            store(trace->state.emplace_back(), x);
            store(trace->covariance.emplace_back(), p);
        }
        if (k == record.last) {
            break;
        }
        linear_step(run, k, x, noise, step, added);
        PitchState y = motion_of(x);
        dynamics::ContactState bearing = dynamics::ContactState::free;
        run.advance(k, y, bearing, x[4], x[5]);
        const Vector linear = step * x;
        x << y[0], y[1], y[2], y[3], x[4], x[5], linear[6], linear[7];
        p = step * p * step.transpose() + added;
        if (!x.allFinite() || !p.allFinite()) {
            return 1e300;
        }
        if (trace != nullptr) {
            store(trace->step.emplace_back(), step);
        }
    }
    return std::isfinite(cost) ? cost : 1e300;
}

LinearPitchRun linear_pitch(dynamics::PitchRun& run, const PitchRecord& record, const PitchNoise& noise) {
    LinearPitchRun out;
    std::vector<double> innovations;
    out.cost = filter_pitch(run, record, noise, innovations, &out.trace);
    out.trace.covariance = {};
    out.trace.predicted_covariance = {};
    out.trace.updates = {};
    out.delay = run.plant().vertical().terms.sensor_delay;
    out.slope_factor = {dynamics::start_state(run.time(), record.value[0], record.first, record.last).slope_factor,
                        dynamics::start_state(run.time(), record.value[2], record.first, record.last).slope_factor};
    for (std::size_t k = 0; k < out.trace.state.size(); ++k) {
        const std::size_t sample = record.first + k;
        const PitchTrace::Column& x = out.trace.state[k];
        out.residual.emplace_back().fill(std::nan(""));
        for (std::size_t i = 0; i < pitch_states; ++i) {
            if (!record.value[i].empty()) {
                out.residual.back()[i] = record.value[i][sample] - run.reading(sample, i, {x[0], x[1], x[2], x[3]});
            }
        }
        if (k < out.trace.step.size()) {
            out.width.push_back(run.time()[sample + 1] - run.time()[sample]);
        }
    }
    return out;
}

double linear_cost(const LinearPitchRun& run, const PitchNoise& noise) {
    // motion less that of the path, then coloured noise of gap and pitch
    Eigen::Matrix<double, 6, 1> x = Eigen::Matrix<double, 6, 1>::Zero(), h, ph;
    Eigen::Matrix<double, 6, 6> p = Eigen::Matrix<double, 6, 6>::Zero();
    const auto off_path = [&](std::size_t k) -> Eigen::Vector4d {
        return Eigen::Map<const Vector>(run.trace.predicted[k].data()).head<4>() -
               Eigen::Map<const Vector>(run.trace.state[k].data()).head<4>();
    };
    const std::array<double, 4> loose = begin_variances(noise, run.slope_factor[0], run.slope_factor[1]);
    p.diagonal() << loose[0], loose[1], loose[2], loose[3], noise.gap_slow * noise.gap_slow,
        noise.pitch_slow * noise.pitch_slow;
    x.head<4>() = off_path(0);
    double cost = 0;
    for (std::size_t k = 0; k < run.residual.size(); ++k) {
        for (std::size_t i = 0; i < pitch_states; ++i) {
            if (!std::isfinite(run.residual[k][i])) {
                continue;
            }
            h.setZero();
            h[static_cast<int>(i)] = 1;
            h[1] -= i == 0 ? run.delay : 0;
            if (slow_of(i) >= 0) {
                h[slow_of(i) - 2] = 1;
            }
            ph = p * h;
            const double variance = h.dot(ph) + noise.white[i] * noise.white[i];
            const double error = run.residual[k][i] - h.dot(x);
            if (!(variance > 0)) {
                continue;
            }
            cost += error * error / variance + std::log(variance);
            x += ph * (error / variance);
            p -= ph * (ph / variance).transpose();
        }
        if (k == run.width.size()) {
            break;
        }
        const double dt = run.width[k], decay = std::exp(-dt / noise.slow_time);
        const Eigen::Map<const Matrix> step(run.trace.step[k].data());
        const Matrix4 a = step.topLeftCorner<4, 4>();
        const Loads random = step.block<4, 2>(0, 4) / dt;
        x.head<4>() = (a * x.head<4>() + off_path(k + 1)).eval();
        x.tail<2>() *= decay;
        p.topLeftCorner<4, 4>() = (a * p.topLeftCorner<4, 4>() * a.transpose()).eval();
        p.topLeftCorner<4, 4>() += dt * (noise.force * noise.force * random.col(0) * random.col(0).transpose() +
                                         noise.moment * noise.moment * random.col(1) * random.col(1).transpose());
        p.topRightCorner<4, 2>() = (decay * a * p.topRightCorner<4, 2>()).eval();
        p.bottomLeftCorner<2, 4>() = p.topRightCorner<4, 2>().transpose();
        p.bottomRightCorner<2, 2>() *= decay * decay;
        p(4, 4) += (1 - decay * decay) * noise.gap_slow * noise.gap_slow;
        p(5, 5) += (1 - decay * decay) * noise.pitch_slow * noise.pitch_slow;
    }
    return std::isfinite(cost) ? cost : 1e300;
}

void linear_answer(const PitchTrace& trace, const PitchRecord& record, std::size_t axis,
                   const std::vector<double>& load, std::vector<double>& answer) {
    Vector x = Vector::Zero();
    for (std::size_t k = 0; k < trace.state.size(); ++k) {
        auto update = trace.updates[k].begin();
        for (std::size_t i = 0; i < pitch_states; ++i) {
            if (record.value[i].empty()) {
                continue;
            }
            if (update == trace.updates[k].end() || update->channel != i) {
                answer.push_back(0);
                continue;
            }
            const int slow = slow_of(i);
            const double seen =
                x[static_cast<int>(i)] - update->delay * (i == 0 ? x[1] : 0.0) + (slow >= 0 ? x[slow] : 0.0);
            answer.push_back(-seen / update->root);
            x -= Eigen::Map<const Vector>(update->gain.data()) * seen;
            ++update;
        }
        if (k < trace.step.size()) {
            const Eigen::Map<const Matrix> step(trace.step[k].data());
            x = (step * x + step.col(static_cast<int>(4 + axis)) * load[k]).eval();
            x[4] = x[5] = 0;  // the load is no state
        }
    }
}

void walk_of_loads(const dynamics::HeavePitch& plant, PitchNoise& noise) {
    noise.force_walk = 0.001 * plant.mass();     // m/s^2 in a second
    noise.moment_walk = 0.05 * plant.inertia();  // rad/s^2 in a second
}

SmoothedPitchRun smooth_pitch(dynamics::PitchRun& run, const PitchRecord& record, const PitchNoise& noise) {
    PitchTrace trace;
    std::vector<double> innovations;
    filter_pitch(run, record, noise, innovations, &trace);
    SmoothedPitchRun out;
    const std::size_t n = trace.state.size();
    std::vector<Vector> x(n);
    std::vector<Matrix> p(n);
    for (std::size_t k = n; k-- > 0;) {
        x[k] = Eigen::Map<const Vector>(trace.state[k].data());
        p[k] = Eigen::Map<const Matrix>(trace.covariance[k].data());
        if (k + 1 < n && k < trace.step.size()) {
            const Eigen::Map<const Matrix> step(trace.step[k].data());
            const Matrix ahead = Eigen::Map<const Matrix>(trace.predicted_covariance[k + 1].data());
            const Vector expected = Eigen::Map<const Vector>(trace.predicted[k + 1].data());
            // states without noise of their own make it singular: scaled and solved in the least-squares sense
            const Vector scale = ahead.diagonal().unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 1.0; });
            const Matrix scaled = scale.asDiagonal() * ahead * scale.asDiagonal();
            const Matrix right = scale.asDiagonal() * (step * p[k]);
            const Matrix solved = scaled.completeOrthogonalDecomposition().solve(right);
            const Matrix gain = (scale.asDiagonal() * solved).transpose();
            x[k] += gain * (x[k + 1] - expected);
            p[k] += gain * (p[k + 1] - ahead) * gain.transpose();
        }
    }
    for (std::size_t k = 0; k < n; ++k) {
        out.time.push_back(run.time()[record.first + k]);
        out.force.push_back(x[k][4]);
        out.moment.push_back(x[k][5]);
        out.force_sigma.push_back(std::sqrt(std::max(0.0, p[k](4, 4))));
        out.moment_sigma.push_back(std::sqrt(std::max(0.0, p[k](5, 5))));
        out.state.push_back(motion_of(x[k]));
    }
    return out;
}

}  // namespace underbody::discovery
