#include "surrogates/discovery/motion/motion_filter.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace underbody::discovery {

using dynamics::MeasuredMotion;
using dynamics::MotionLoads;
using dynamics::MotionShape;
using dynamics::MotionStart;
using dynamics::MotionState;

namespace {

/// The filter of a motion of so many states and loads; each place has coloured noise of its own, as many as loads or
/// fewer. Sizes are fixed where it is compiled: the matrices are small, and all time goes there. `walking`: loads among
/// the states of the filter, all or none; without them nothing can be told of loads, and none walks.
template <int motion_states, int loads, int places, int walking = loads>
struct Filter {
    static constexpr int states = motion_states + walking + places;
    static constexpr int first_slow = motion_states + walking;
    static_assert(states <= static_cast<int>(filter_states));
    /// Of many states: products that are written out serve better than those made for large matrices.
    static constexpr bool many = motion_states > 6;
    using Vector = Eigen::Matrix<double, states, 1>;
    using Matrix = Eigen::Matrix<double, states, states>;
    using Slopes = Eigen::Matrix<double, motion_states, motion_states>;
    using Part = Eigen::Matrix<double, motion_states, 1>;
    using Loads = Eigen::Matrix<double, motion_states, loads>;

    static MotionState motion_of(const Vector& x) {
        MotionState y{};
        std::copy_n(x.data(), motion_states, y.begin());
        return y;
    }
    static MotionLoads loads_of(const Vector& x) {
        MotionLoads load{};
        std::copy_n(x.data() + motion_states, walking, load.begin());
        return load;
    }

    /// Where the coloured noise of each state stands; -1: it has none.
    static std::array<int, motion_states> slow_places(const MotionShape& shape) {
        std::array<int, motion_states> slow{};
        int next = first_slow;
        for (int i = 0; i < motion_states; ++i) {
            slow[static_cast<std::size_t>(i)] = shape.is_place(static_cast<std::size_t>(i)) ? next++ : -1;
        }
        return slow;
    }
    /// What the reading of a state sees of the states: a place that is read late, less its rate.
    static Vector seen(const MotionShape& shape, const std::array<int, motion_states>& slow, std::size_t i,
                       double delay) {
        Vector h = Vector::Zero();
        h[static_cast<int>(i)] = 1;
        if (slow[i] >= 0) {
            h[slow[i]] = 1;
        }
        for (std::size_t j = 0; delay != 0 && j < shape.states.size(); ++j) {
            if (j != i && shape.states[j].place == i) {
                h[static_cast<int>(j)] = -delay;
            }
        }
        return h;
    }

    /// a b, written out as loops.
    template <typename A, typename B>
    static auto product(const A& a, const B& b) {
        constexpr int rows = A::RowsAtCompileTime, inner = A::ColsAtCompileTime, columns = B::ColsAtCompileTime;
        Eigen::Matrix<double, rows, columns> c;
        for (int j = 0; j < columns; ++j) {
            std::array<double, rows> sum{};
            for (int k = 0; k < inner; ++k) {
                const double factor = b(k, j);
                for (int i = 0; i < rows; ++i) {
                    sum[static_cast<std::size_t>(i)] += a(i, k) * factor;
                }
            }
            for (int i = 0; i < rows; ++i) {
                c(i, j) = sum[static_cast<std::size_t>(i)];
            }
        }
        return c;
    }
    /// p less x y^T.
    template <typename Covariance, typename Column>
    static void subtract(const Column& x, const Column& y, Covariance& p) {
        if constexpr (many) {
            constexpr int rows = Covariance::RowsAtCompileTime;
            for (int j = 0; j < rows; ++j) {
                const double factor = y[j];
                for (int i = 0; i < rows; ++i) {
                    p(i, j) -= x[i] * factor;
                }
            }
        } else {
            p -= x * y.transpose();
        }
    }
    /// p of motion and coloured noise after a step: a p a^T, the noise fades.
    template <typename Covariance>
    static void propagate(const Slopes& a, double decay, Covariance& p) {
        constexpr int colours = Covariance::RowsAtCompileTime - motion_states;
        const Slopes motion = p.template topLeftCorner<motion_states, motion_states>(), turned = a.transpose();
        p.template topLeftCorner<motion_states, motion_states>() = product(product(a, motion), turned);
        if constexpr (colours > 0) {
            const Eigen::Matrix<double, motion_states, colours> between =
                p.template topRightCorner<motion_states, colours>();
            const Eigen::Matrix<double, motion_states, colours> moved = decay * product(a, between);
            p.template topRightCorner<motion_states, colours>() = moved;
            p.template bottomLeftCorner<colours, motion_states>() = moved.transpose();
            p.template bottomRightCorner<colours, colours>() *= decay * decay;
        }
    }
    /// p h, where h (see seen()) has a 1 at the state and at its coloured noise, and the rates of a place read late.
    template <typename Covariance, typename Seen>
    static auto seen_column(const Covariance& p, const Seen& h, int state, int slow, double delay) {
        using Column = Eigen::Matrix<double, Covariance::RowsAtCompileTime, 1>;
        if (!many || delay != 0) {
            return Column(p * h);
        }
        return slow >= 0 && slow < p.cols() ? Column(p.col(state) + p.col(slow)) : Column(p.col(state));
    }

    static Loads load_rates(const MeasuredMotion& run, const MotionState& y) {
        std::array<MotionState, dynamics::most_loads> rates{};
        run.load_rates(y, rates);
        Loads g;
        for (int l = 0; l < loads; ++l) {
            g.col(l) = Eigen::Map<const Part>(rates[static_cast<std::size_t>(l)].data());
        }
        return g;
    }

    static Slopes slopes(MeasuredMotion& run, std::size_t k, const MotionState& y, const MotionLoads& load) {
        const double t = run.time()[k];
        MotionState base{}, there{};
        run.rate(k, t, y, base, load);
        Slopes a;
        for (std::size_t j = 0; j < motion_states; ++j) {
            const double small = run.shape().states[j].small;
            if (run.shape().states[j].ignorable) {
                a.col(static_cast<int>(j)).setZero();
                continue;
            }
            MotionState moved = y;
            moved[j] += small;
            run.rate(k, t, moved, there, load);
            for (std::size_t i = 0; i < motion_states; ++i) {
                a(static_cast<int>(i), static_cast<int>(j)) = (there[i] - base[i]) / small;
            }
        }
        return a;
    }

    static Slopes random_part(const Loads& random, const MotionNoise& noise) {
        if constexpr (many) {
            Loads sized = random;
            for (int l = 0; l < loads; ++l) {
                sized.col(l) *= noise.load[static_cast<std::size_t>(l)];
            }
            const Eigen::Matrix<double, loads, motion_states> turned = sized.transpose();
            return product(sized, turned);
        }
        Slopes sum = Slopes::Zero();
        for (int l = 0; l < loads; ++l) {
            sum += std::pow(noise.load[static_cast<std::size_t>(l)], 2) * random.col(l) * random.col(l).transpose();
        }
        return sum;
    }

    /// The linear step over an interval and what noise adds to it.
    static void linear_step(MeasuredMotion& run, std::size_t k, const Vector& x, const MotionNoise& noise,
                            const std::array<int, motion_states>& slow, Matrix& step, Matrix& added) {
        const double dt = run.time()[k + 1] - run.time()[k];
        const MotionState y = motion_of(x);
        const Slopes a = slopes(run, k, y, loads_of(x)) * dt;
        const Loads g = load_rates(run, y);
        const Slopes one = Slopes::Identity();
        step.setIdentity();
        step.template topLeftCorner<motion_states, motion_states>() =
            one + a * (one + a * (one / 2 + a * (one / 6 + a / 24)));
        if constexpr (walking > 0) {
            step.template block<motion_states, loads>(0, motion_states) = dt * (one + a * (one / 2 + a / 6)) * g;
        }
        const double decay = std::exp(-dt / noise.slow_time);
        added.setZero();
        added.template topLeftCorner<motion_states, motion_states>() = dt * random_part((one + 0.5 * a) * g, noise);
        for (int l = 0; l < walking; ++l) {
            added(motion_states + l, motion_states + l) = dt * std::pow(noise.walk[static_cast<std::size_t>(l)], 2);
        }
        for (std::size_t i = 0; i < motion_states; ++i) {
            if (slow[i] >= 0) {
                step(slow[i], slow[i]) = decay;
                added(slow[i], slow[i]) = (1 - decay * decay) * noise.slow[i] * noise.slow[i];
            }
        }
    }

    /// How loosely a filter begins about lines through the first readings.
    static Part begin_variances(const MotionShape& shape, const MotionStart& start, const MotionNoise& noise) {
        Part variance;
        for (std::size_t i = 0; i < motion_states; ++i) {
            const MotionShape::State& state = shape.states[i];
            const double reading = noise.total(state.place);
            variance[static_cast<int>(i)] = std::pow(
                shape.is_place(i) ? 20 * reading : state.begin_width + 10 * reading * std::sqrt(start.slope_factor[i]),
                2);
        }
        return variance;
    }

    static void begin(const MeasuredMotion& run, const MotionRecord& record, const MotionNoise& noise,
                      const std::array<int, motion_states>& slow, Vector& x, Matrix& p) {
        const MotionStart start = run.start(record.readings, record.first, record.last).value_or(MotionStart{});
        x.setZero();
        x.template head<motion_states>() = Eigen::Map<const Part>(start.state.data());
        p.setZero();
        p.diagonal().template head<motion_states>() = begin_variances(run.shape(), start, noise);
        const double unknown = 10;  // s: the walk of a load over that long
        for (int l = 0; l < walking; ++l) {
            p(motion_states + l, motion_states + l) = unknown * std::pow(noise.walk[static_cast<std::size_t>(l)], 2);
        }
        for (std::size_t i = 0; i < motion_states; ++i) {
            if (slow[i] >= 0) {
                p(slow[i], slow[i]) = noise.slow[i] * noise.slow[i];
            }
        }
    }

    static void store(MotionTrace::Column& to, const Vector& from) { Eigen::Map<Vector>(to.data()) = from; }
    static void store(MotionTrace::Square& to, const Matrix& from) { Eigen::Map<Matrix>(to.data()) = from; }
    static auto column(const MotionTrace::Column& from) { return Eigen::Map<const Vector>(from.data()); }
    static auto square(const MotionTrace::Square& from) { return Eigen::Map<const Matrix>(from.data()); }

    /// The readings of one sample, one after the other.
    static double read(const MeasuredMotion& run, const MotionRecord& record, const MotionNoise& noise,
                       const std::array<int, motion_states>& slow, std::size_t k, Vector& x, Matrix& p,
                       std::vector<double>& innovations, MotionTrace* trace) {
        double cost = 0;
        for (std::size_t i = 0; i < motion_states; ++i) {
            if (record.readings.value[i].empty()) {
                continue;
            }
            const double value = record.readings.value[i][k];
            const double delay = run.delay(i);
            const Vector h = seen(run.shape(), slow, i, delay);
            const Vector ph = seen_column(p, h, static_cast<int>(i), slow[i], delay);
            const double variance = h.dot(ph) + noise.white[i] * noise.white[i];
            if (!std::isfinite(value) || !(variance > 0)) {
                innovations.push_back(0);
                continue;
            }
            const double expected = run.reading(k, i, motion_of(x)) + (slow[i] >= 0 ? x[slow[i]] : 0.0);
            const double root = std::sqrt(variance), error = (value - expected) / root;
            const Vector gain = ph / variance;
            x += gain * (error * root);
            subtract(gain, ph, p);
            innovations.push_back(error);
            cost += error * error + std::log(variance);
            if (trace != nullptr) {
                MotionTrace::Update update{i, delay, root, {}};
                store(update.gain, gain);
                trace->updates.back().push_back(update);
            }
        }
        return cost;
    }

    static double run(MeasuredMotion& run, const MotionRecord& record, const MotionNoise& noise,
                      std::vector<double>& innovations, MotionTrace* trace) {
        const std::array<int, motion_states> slow = slow_places(run.shape());
        Vector x;
        Matrix p, step, added;
        begin(run, record, noise, slow, x, p);
        double cost = 0;
        for (std::size_t k = record.first; k <= record.last; ++k) {
            if (trace != nullptr) {
                store(trace->predicted.emplace_back(), x);
                store(trace->predicted_covariance.emplace_back(), p);
                trace->updates.emplace_back();
            }
            cost += read(run, record, noise, slow, k, x, p, innovations, trace);
            p = 0.5 * (p + p.transpose()).eval();
            if (trace != nullptr) {
                store(trace->state.emplace_back(), x);
                store(trace->covariance.emplace_back(), p);
            }
            if (k == record.last) {
                break;
            }
            linear_step(run, k, x, noise, slow, step, added);
            MotionState y = motion_of(x);
            dynamics::ContactState bearing = dynamics::ContactState::free;
            run.advance(k, y, bearing, loads_of(x));
            const Vector linear = step * x;
            x.template head<motion_states>() = Eigen::Map<const Part>(y.data());
            x.template tail<places>() = linear.template tail<places>();
            if constexpr (many && walking == 0) {
                propagate(step.template topLeftCorner<motion_states, motion_states>(),
                          std::exp(-(run.time()[k + 1] - run.time()[k]) / noise.slow_time), p);
                p += added;
            } else {
                p = step * p * step.transpose() + added;
            }
            if (!x.allFinite() || !p.allFinite()) {
                return 1e300;
            }
            if (trace != nullptr) {
                store(trace->step.emplace_back(), step);
            }
        }
        return std::isfinite(cost) ? cost : 1e300;
    }

    static double linear(const LinearMotionRun& run, const MotionNoise& noise) {
        return many && !noise.coloured() ? linear_with<(many ? 0 : places)>(run, noise)
                                         : linear_with<places>(run, noise);
    }

    /// With so many places that have coloured noise.
    template <int colours>
    static double linear_with(const LinearMotionRun& run, const MotionNoise& noise) {
        constexpr int own = motion_states + colours;  // motion less that of the path, then coloured noise
        using Own = Eigen::Matrix<double, own, 1>;
        const MotionShape& shape = *run.shape;
        const std::array<int, motion_states> slow = slow_places(shape);
        Own x = Own::Zero(), h, ph;
        Eigen::Matrix<double, own, own> p = Eigen::Matrix<double, own, own>::Zero();
        const auto off_path = [&](std::size_t k) -> Part {
            return column(run.trace.predicted[k]).template head<motion_states>() -
                   column(run.trace.state[k]).template head<motion_states>();
        };
        Part slow_variance = Part::Zero();  // of the places, in their order
        for (std::size_t i = 0; i < motion_states; ++i) {
            if (slow[i] >= 0) {
                slow_variance[slow[i] - first_slow] = noise.slow[i] * noise.slow[i];
            }
        }
        p.diagonal().template head<motion_states>() = begin_variances(shape, run.start, noise);
        p.diagonal().template tail<colours>() = slow_variance.template head<colours>();
        x.template head<motion_states>() = off_path(0);
        double cost = 0;
        for (std::size_t k = 0; k < run.residual.size(); ++k) {
            for (std::size_t i = 0; i < motion_states; ++i) {
                if (!std::isfinite(run.residual[k][i])) {
                    continue;
                }
                const Vector all = seen(shape, slow, i, run.delay[i]);
                h.template head<motion_states>() = all.template head<motion_states>();
                h.template tail<colours>() = all.template segment<colours>(first_slow);
                const int own_slow = slow[i] >= 0 && colours > 0 ? motion_states + slow[i] - first_slow : -1;
                ph = seen_column(p, h, static_cast<int>(i), own_slow, run.delay[i]);
                const double variance = h.dot(ph) + noise.white[i] * noise.white[i];
                const double error = run.residual[k][i] - h.dot(x);
                if (!(variance > 0)) {
                    continue;
                }
                cost += error * error / variance + std::log(variance);
                x += ph * (error / variance);
                subtract(ph, Own(ph / variance), p);
            }
            if (k == run.width.size()) {
                break;
            }
            const double dt = run.width[k], decay = std::exp(-dt / noise.slow_time);
            const auto step = square(run.trace.step[k]);
            const Slopes a = step.template topLeftCorner<motion_states, motion_states>();
            const Loads random = step.template block<motion_states, loads>(0, motion_states) / dt;
            x.template head<motion_states>() = (a * x.template head<motion_states>() + off_path(k + 1)).eval();
            x.template tail<colours>() *= decay;
            auto motion = p.template topLeftCorner<motion_states, motion_states>();
            auto colour = p.template bottomRightCorner<colours, colours>();
            if constexpr (many) {
                propagate(a, decay, p);
            } else {
                auto between = p.template topRightCorner<motion_states, colours>();
                motion = (a * motion * a.transpose()).eval();
                between = (decay * a * between).eval();
                p.template bottomLeftCorner<colours, motion_states>() = between.transpose();
                colour *= decay * decay;
            }
            motion += dt * random_part(random, noise);
            colour.diagonal() += (1 - decay * decay) * slow_variance.template head<colours>();
        }
        return std::isfinite(cost) ? cost : 1e300;
    }

    static void answer(const MotionShape& shape, const MotionTrace& trace, const MotionRecord& record, std::size_t axis,
                       const std::vector<double>& load, std::vector<double>& answer) {
        const std::array<int, motion_states> slow = slow_places(shape);
        Vector x = Vector::Zero();
        for (std::size_t k = 0; k < trace.state.size(); ++k) {
            auto update = trace.updates[k].begin();
            for (std::size_t i = 0; i < motion_states; ++i) {
                if (record.readings.value[i].empty()) {
                    continue;
                }
                if (update == trace.updates[k].end() || update->channel != i) {
                    answer.push_back(0);
                    continue;
                }
                const double own = seen(shape, slow, i, update->delay).dot(x);
                answer.push_back(-own / update->root);
                x -= column(update->gain) * own;
                ++update;
            }
            if (k < trace.step.size()) {
                const auto step = square(trace.step[k]);
                x = (step * x + step.col(motion_states + static_cast<int>(axis)) * load[k]).eval();
                x.template segment<loads>(motion_states).setZero();  // the load is no state
            }
        }
    }

    static SmoothedMotion smooth(MeasuredMotion& run, const MotionRecord& record, const MotionTrace& trace) {
        SmoothedMotion out;
        const std::size_t n = trace.state.size();
        std::vector<Vector> x(n);
        std::vector<Matrix> p(n);
        for (std::size_t k = n; k-- > 0;) {
            x[k] = column(trace.state[k]);
            p[k] = square(trace.covariance[k]);
            if (k + 1 < n && k < trace.step.size()) {
                const auto step = square(trace.step[k]);
                const Matrix ahead = square(trace.predicted_covariance[k + 1]);
                const Vector expected = column(trace.predicted[k + 1]);
                // states without noise of their own make it singular: scaled and solved in the least-squares sense
                const Vector scale =
                    ahead.diagonal().unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 1.0; });
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
            out.state.push_back(motion_of(x[k]));
            out.load.push_back(loads_of(x[k]));
            MotionLoads sigma{};
            for (int l = 0; l < loads; ++l) {
                const int at = motion_states + l;
                sigma[static_cast<std::size_t>(l)] = std::sqrt(std::max(0.0, p[k](at, at)));
            }
            out.load_sigma.push_back(sigma);
        }
        return out;
    }
};

/// Calls `act` with the filter of a motion of this shape.
template <typename Act>
auto with_filter(const MotionShape& shape, const Act& act) {
    switch (shape.states.size()) {
        case 4:
            return act(Filter<4, 2, 2>());
        case 6:
            return act(Filter<6, 3, 3>());
        case 10:
            return act(Filter<10, 5, 5>());
        default:
            throw std::logic_error("no filter for a motion of " + std::to_string(shape.states.size()) + " states");
    }
}

}  // namespace

double MotionNoise::total(std::size_t state) const { return std::hypot(white[state], slow[state]); }

bool MotionNoise::coloured() const {
    return std::any_of(slow.begin(), slow.end(), [](double one) { return one > 0; });
}

double filter_motion(MeasuredMotion& run, const MotionRecord& record, const MotionNoise& noise,
                     std::vector<double>& innovations, MotionTrace* trace) {
    const bool still = std::all_of(noise.walk.begin(), noise.walk.end(), [](double one) { return one == 0; });
    if (run.shape().states.size() == 10 && still && trace == nullptr) {
        return Filter<10, 5, 5, 0>::run(run, record, noise, innovations, trace);  // half the time
    }
    return with_filter(run.shape(),
                       [&](const auto& filter) { return filter.run(run, record, noise, innovations, trace); });
}

LinearMotionRun linear_motion(MeasuredMotion& run, const MotionRecord& record, const MotionNoise& noise) {
    LinearMotionRun out;
    out.shape = &run.shape();
    std::vector<double> innovations;
    out.cost = filter_motion(run, record, noise, innovations, &out.trace);
    out.trace.covariance = {};
    out.trace.predicted_covariance = {};
    out.trace.updates = {};
    out.start = run.start(record.readings, record.first, record.last).value_or(MotionStart{});
    const std::size_t count = run.shape().states.size();
    for (std::size_t i = 0; i < count; ++i) {
        out.delay[i] = run.delay(i);
    }
    for (std::size_t k = 0; k < out.trace.state.size(); ++k) {
        const std::size_t sample = record.first + k;
        MotionState y{};
        std::copy_n(out.trace.state[k].begin(), count, y.begin());
        out.residual.emplace_back().fill(std::nan(""));
        for (std::size_t i = 0; i < count; ++i) {
            if (!record.readings.value[i].empty()) {
                out.residual.back()[i] = record.readings.value[i][sample] - run.reading(sample, i, y);
            }
        }
        if (k < out.trace.step.size()) {
            out.width.push_back(run.time()[sample + 1] - run.time()[sample]);
        }
    }
    return out;
}

double linear_cost(const LinearMotionRun& run, const MotionNoise& noise) {
    return with_filter(*run.shape, [&](const auto& filter) { return filter.linear(run, noise); });
}

void linear_answer(const MotionShape& shape, const MotionTrace& trace, const MotionRecord& record, std::size_t axis,
                   const std::vector<double>& load, std::vector<double>& answer) {
    with_filter(shape, [&](const auto& filter) { filter.answer(shape, trace, record, axis, load, answer); });
}

void walk_of_loads(const MeasuredMotion& run, MotionNoise& noise) {
    for (std::size_t l = 0; l < run.shape().loads.size(); ++l) {
        noise.walk[l] = run.shape().loads[l].walk * run.inertia(l);
    }
}

SmoothedMotion smooth_motion(MeasuredMotion& run, const MotionRecord& record, const MotionNoise& noise) {
    MotionTrace trace;
    std::vector<double> innovations;
    filter_motion(run, record, noise, innovations, &trace);
    return with_filter(run.shape(), [&](const auto& filter) { return filter.smooth(run, record, trace); });
}

}  // namespace underbody::discovery
